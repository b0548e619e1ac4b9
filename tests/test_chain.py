"""Chains of bodies: against single impacts, another integrator, closed forms, the solitary wave; files and command."""

from __future__ import annotations

import json
import math
import pickle
import warnings

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import film_datasets as fd
import film_model as fm
from film_datasets.reference_impacts.cases import ADHESIVE, POLYMER, STEEL, _contact
from film_model.cli.main import main
from film_model.core import chaining
from film_model.laws import LAWS
from film_model.solve import chain_motion

G = 9.80665
BALL = {"radius": "10 mm", "material": "bearing steel"}
HEAVY = {"radius": "10 mm", "mass": "1 kg"}
POWER = fm.Contact("meyer", stiffness="1e9 N/m^1.5", exponent=1.5)
CRADLE = [{**BALL, "velocity": "0.5 m/s"}, {**BALL, "count": 2}]
FILE = """title = "Newton's cradle"
[[bodies]]
radius = "10 mm"
material = "bearing steel"
velocity = "0.5 m/s"
[[bodies]]
count = 2
radius = "10 mm"
material = "bearing steel"
[contact]
law = "hertz"
"""


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fm.ImpactWarning)
        yield


@pytest.mark.parametrize("law", [law for law in LAWS if law != "hunt-crossley"])
@pytest.mark.parametrize("free", [True, False])
def test_two_bodies_collide_as_in_an_impact(law, free):
    """Every law: the chain's integrator of order 8 against the march on lines."""
    if law in ADHESIVE:
        ball, other = {"radius": "50 um", "material": POLYMER}, {"radius": "70 um", "material": POLYMER}
        given = {"yield_pressure": "96 MPa"} if law == "thornton-ning" else {}
        contact, speed = fm.Contact(law, work_of_adhesion="0.05 J/m^2", **given), "2 m/s"
    else:
        ball, other = {"radius": "10 mm", "material": STEEL}, {"radius": "15 mm", "material": STEEL}
        contact, speed = fm.Contact(**_contact(law)), "0.4 m/s"
    moving, wall = {**ball, "velocity": speed}, fm.HalfSpace(other["material"])
    off = fm.Effects(gravity=False, wave_losses=False, rate_hardening=False, material_damping=False)
    scene = fm.Scene(fm.Sphere(**moving), fm.Body(**other) if free else wall, contact, off)
    impact = fm.simulate(scene, accuracy=1e-10).summary
    motion = fm.simulate_chain(fm.Chain([moving, other] if free else [moving], contact, None if free else wall))
    for name, value in {
        "rebound_velocity": motion.values["final_velocity"][0],
        "maximum_force": motion.values["largest_force"][0],
        "maximum_indentation": motion.values["largest_indentation"][0],
        "contact_duration": motion.values["contact_ends"][0] - motion.values["contact_begins"][0],
    }.items():
        assert value == pytest.approx(impact[name], rel=3e-11), name
    assert abs(motion.energy.error) < 1e-13 * motion.energy.kinetic_before


@pytest.mark.parametrize("gaps", [(0.0, 0.0), (2e-6, 5e-6)])
def test_the_cradle_of_three_agrees_with_another_integrator(gaps):
    bodies = [{**HEAVY, "gap": f"{gap} m"} for gap in (*gaps, 0.0)]
    motion = fm.simulate_chain(fm.Chain([{**bodies[0], "velocity": "1 m/s"}, *bodies[1:]], POWER))

    def rates(t, y):
        forces = 1e9 * np.maximum(y[:2] - y[1:3] - gaps, 0.0) ** 1.5
        return [*y[3:], -forces[0], forces[0] - forces[1], forces[1]]

    ended = solve_ivp(rates, (0.0, motion.end), [0, 0, 0, 1, 0, 0], "DOP853", rtol=1e-11, atol=1e-14)
    assert motion.final_velocity.m == pytest.approx(ended.y[3:, -1], abs=2e-9)
    moved = motion.sample_si([motion.end])["displacement"][:, 0]
    assert moved == pytest.approx(ended.y[:3, -1], abs=1e-8 * moved.max())
    if not any(gaps):
        assert motion.final_velocity.m == pytest.approx([-0.0709524, 0.0764030, 0.9945493], abs=5e-8)


@pytest.mark.parametrize("seed", range(4))
def test_elastic_chains_keep_momentum_and_energy(seed):
    """Random masses, velocities, gaps and exponents; also seen from a train."""
    rng = np.random.default_rng(seed)
    bodies = [
        {
            **{"radius": "10 mm", "mass": f"{10.0 ** rng.uniform(-2.0, 0.0)} kg"},
            "gap": f"{rng.choice([0.0, 1e-6, 1e-3])} m",
            "contact": fm.Contact("meyer", exponent=(q := rng.choice([1.0, 1.5, 2.0])), stiffness=f"1e8 N/m^{q}"),
        }
        for _ in range(6)
    ]
    speeds = rng.uniform(-1.0, 1.0, 6)

    def done(shift):
        own = [{**body, "velocity": f"{v + shift} m/s"} for body, v in zip(bodies, speeds, strict=True)]
        return fm.simulate_chain(fm.Chain(own))

    motion, train = done(0.0), done(3.0)
    mass, after = motion.values["body_mass"], motion.final_velocity.m
    assert mass @ after == pytest.approx(mass @ speeds, abs=1e-14 * mass.sum())
    assert 0.5 * mass @ after**2 == pytest.approx(0.5 * mass @ speeds**2, rel=1e-12)
    assert (np.diff(after) >= 0.0).all()
    at = np.linspace(0.0, motion.end, 2001)
    sample = motion.sample_si(at)
    moved = np.trapezoid(sample["velocity"], at, axis=1)
    assert sample["displacement"][:, -1] == pytest.approx(moved, abs=1e-3 * motion.end)
    assert train.final_velocity.m - 3.0 == pytest.approx(after, abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_chains_of_all_laws_balance(seed):
    """Every contact with a law of its own, some under weight: energy, momentum, and displacements."""
    rng = np.random.default_rng(seed)
    laws = [law for law in LAWS if law not in (*ADHESIVE, "hunt-crossley", "tabulated")]
    heavy, count = seed % 2 == 1, 5
    row = [
        {
            **{
                "radius": f"{10 ** rng.uniform(-2.5, -1.5)} m",
                "material": STEEL,
                "contact": _contact(rng.choice(laws)),
            },
            **{"velocity": f"{rng.uniform(-0.5, 0.5)} m/s", "gap": f"{rng.choice([0.0, 1e-6, 1e-3])} m"},
        }
        for _ in range(count)
    ]
    motion = fm.simulate_chain(fm.Chain(row, "auto", fm.HalfSpace(STEEL) if heavy else None, heavy, "10 ms"))
    mass, energy = motion.values["body_mass"], motion.energy
    assert abs(energy.error) < 1e-12 * (energy.kinetic_before + abs(energy.weight)) and energy.absorbed > 0.0
    if not heavy:
        change = mass @ (motion.final_velocity.m - motion.values["initial_velocity"])
        assert abs(change) < 1e-13 * mass.sum()
    at = np.linspace(0.0, motion.end, 501)
    sample = motion.sample_si(at)
    moved = np.trapezoid(sample["velocity"], at, axis=1)
    assert np.abs(sample["displacement"][:, -1] - moved).max() < 5e-3 * motion.end


def test_gaps_make_collisions_of_two():
    """Equal balls far apart hand their velocity on; unequal ones by the formula of two bodies."""
    row = [{**BALL, "velocity": "0.5 m/s", "gap": "1 mm"}, {**BALL, "count": 4, "gap": "1 mm"}]
    motion = fm.simulate_chain(fm.Chain(row, "hertz"))
    assert motion.final_velocity.m == pytest.approx([0, 0, 0, 0, 0.5], abs=1e-13)
    assert np.ptp(motion.largest_force.m) < 1e-11 * motion.largest_force.m[0]
    pair = fm.Chain([{**HEAVY, "velocity": "1 m/s"}, {**HEAVY, "mass": "3 kg"}], POWER)
    assert fm.simulate_chain(pair).final_velocity.m == pytest.approx([-0.5, 0.5], abs=1e-13)


def test_the_solitary_wave_of_a_row():
    """In Nesterenko's long waves the speed is sqrt(4/5) sqrt(K/m) (F/K)^(1/6) contacts a second, and the force cos^6
    over 5 contacts. Kinetic energy: the virial theorem."""

    def row(speed):
        motion = fm.simulate_chain(fm.Chain([{**HEAVY, "velocity": f"{speed} m/s"}, {**HEAVY, "count": 79}], POWER))
        return motion, motion.largest_force.m, motion.time_of_largest_force.m

    (motion, force, time), (_, slower_force, slower_time) = row(1.0), row(0.1)
    assert np.ptp(force[45:65]) < 1e-12 * force[55] and np.ptp(np.diff(time[45:65])) < 1e-11 * time[0]
    speed = 1.0 / (time[56] - time[55])
    coefficient = speed / (math.sqrt(1e9) * (force[55] / 1e9) ** (1 / 6))
    assert coefficient == pytest.approx(0.905516, abs=1e-6) == pytest.approx(math.sqrt(4 / 5), rel=0.0125)
    rise = math.log((slower_time[56] - slower_time[55]) * speed) / math.log(force[55] / slower_force[55])
    assert rise == pytest.approx(1 / 6, rel=1e-11)
    at = np.linspace(time[55] - 4.0 / speed, time[55] + 4.0 / speed, 801)
    sample = motion.sample_si(at)
    assert sample["velocity"][55].max() == pytest.approx(0.6816, abs=5e-5)
    place = (at - time[55]) * speed
    wave = sample["contact_force"][55] / force[55]
    long_wave = np.cos(np.clip(math.sqrt(10) / 5 * place, -math.pi / 2, math.pi / 2)) ** 6
    assert np.abs(wave - long_wave).max() < 0.04
    assert np.ptp(place[wave > 1e-4]) == pytest.approx(5.0 * math.pi / math.sqrt(10), rel=0.02)
    kinetic = 0.5 * (sample["velocity"][30:] ** 2).sum(axis=0)
    stored = 0.4e9 * (np.maximum(sample["indentation"][30:], 0.0) ** 2.5).sum(axis=0)
    whole = (time[56] - time[55]) * np.arange(100) / 100 + time[55]
    assert np.ptp(kinetic + stored) < 1e-11
    again = 0.5 * (motion.sample_si(whole)["velocity"][30:] ** 2).sum(axis=0).mean()
    assert again / (kinetic + stored)[0] == pytest.approx(5 / 9, rel=1e-5)


def test_the_small_ball_on_the_large_one():
    """Far apart, they collide one after the other; together, less of the energy goes up. The weight does the work."""
    large = {"radius": "40 mm", "material": "bearing steel", "gap": "0.5 m"}
    floor = fm.HalfSpace("mild steel")

    def drop(gap):
        small = {"radius": "4 mm", "material": "bearing steel", "gap": gap}
        return fm.simulate_chain(fm.Chain([small, large], "hertz", floor, gravity=True))

    apart, together = drop("5 mm"), drop("0 m")
    share, up = 1e-3, math.sqrt(2 * G * 0.5)
    speed = -apart.final_velocity.m[0]  # 3 v for a heavy large ball
    assert speed == pytest.approx((3 - share) / (1 + share) * up, rel=0.01)
    assert -together.final_velocity.m[0] < 0.9 * speed
    assert apart.values["contact_begins"][1] == pytest.approx(math.sqrt(2 * 0.5 / G), rel=1e-9)
    for motion in (apart, together):
        assert abs(motion.energy.error) < 1e-12 * motion.energy.weight
        assert abs(motion.energy.absorbed) < 1e-11 * motion.energy.weight


def test_a_damped_column_comes_to_rest_under_its_weight():
    column = [{**BALL, "count": 3, "contact": {"law": "tsuji", "restitution": 0.4}}]
    row = [fm.ChainBody(**{**column[0], "gap": gap, "count": count}) for gap, count in (("0 m", 2), ("1 mm", 1))]
    motion = fm.simulate_chain(fm.Chain(row, target=fm.HalfSpace("mild steel"), gravity=True, duration="0.5 s"))
    weight = motion.values["body_mass"][0] * G
    forces = motion.sample_si([motion.end])["contact_force"][:, 0]
    assert forces == pytest.approx(weight * np.arange(1, 4), rel=1e-9)
    assert motion.outcome == "followed for 500 ms" and np.isnan(motion.values["contact_ends"]).all()
    assert not motion.warnings and abs(motion.energy.error) < 1e-12 * motion.energy.weight


def test_dents_are_remembered():
    """Two balls that yield: the first ball, between a wall and a heavy one, hits the dent again and again."""
    bodies = [{**BALL, "mass": "1 kg", "velocity": "2 m/s", "gap": "1 mm"}, {**BALL, "gap": "1 mm"}]
    motion = fm.simulate_chain(fm.Chain(bodies, "thornton", fm.HalfSpace("bearing steel")))
    assert min(motion.counts) >= 2 and motion.energy.absorbed > 0.1 * motion.energy.kinetic_before
    assert abs(motion.energy.error) < 1e-12 * motion.energy.kinetic_before
    assert motion.estimated <= 1e-9 and (motion.final_velocity.m < 0.0).all()


def test_samples_follow_the_motion():
    motion = fm.simulate_chain(fm.Chain(CRADLE, "hertz"))
    at = np.linspace(0.0, motion.end, 4001)
    sample = motion.sample_si(at)
    assert sample["velocity"][:, -1] == pytest.approx(motion.final_velocity.m, abs=1e-12)
    moved = np.trapezoid(sample["velocity"], at, axis=1)
    assert sample["displacement"][:, -1] == pytest.approx(moved, rel=1e-6, abs=1e-12)
    force = np.trapezoid(sample["contact_force"], at, axis=1)
    mass = motion.values["body_mass"]
    assert force == pytest.approx(
        mass[0] * np.array([0.5, 0.0]) - np.array([1, -1]) * mass[[0, 2]] * sample["velocity"][[0, 2], -1], rel=1e-5
    )
    assert sample["contact_force"].max(axis=1) == pytest.approx(motion.largest_force.m, rel=1e-6)
    beyond = motion.sample_si([motion.end, 2.0 * motion.end])["displacement"]
    assert np.diff(beyond)[:, 0] == pytest.approx(motion.final_velocity.m * motion.end, rel=1e-12)
    short = fm.simulate_chain(fm.Chain(CRADLE, "hertz", duration="50 us"))
    assert short.end == 5e-5
    for wrong in ([6e-5], [-1e-6], [2e-5, 1e-5]):
        with pytest.raises(ValueError, match="times: must ascend from 0 s to the end, 5e-05 s"):
            short.sample_si(wrong)


def test_coarse_accuracy_is_met_and_a_short_one_is_not_promised(monkeypatch):
    chain = fm.Chain(CRADLE, "hertz", accuracy=1e-4)
    motion = fm.simulate_chain(chain)
    assert 1e-12 < motion.estimated < 1e-4
    monkeypatch.setattr(chain_motion, "FINEST", 1e-4)
    with pytest.warns(fm.ImpactWarning, match="accuracy 1e-09 is not reached"):
        fm.simulate_chain(fm.Chain(CRADLE, "hertz"))
    monkeypatch.setattr(chaining, "MOST_STEPS", 3)
    with pytest.raises(fm.SimulationError, match="more than 3 steps"):
        fm.simulate_chain(chain)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('radius = "10 mm"', 'radius = "10 kg"'), 'chain:3: bodies[1].radius: "10 kg" is a mass'),
        (("count = 2", "count = 0"), "chain:7: bodies[2].count: 0 is not allowed: a whole number from 1 to 10000"),
        (("[contact]", "[effects]\nplasticity = true\n[contact]"), "effects.plasticity: unknown key of a chain"),
        (("[contact]", '[target]\nkind = "rod"\n[contact]'), 'target.kind: "rod" is not supported behind a chain'),
        (("[contact]", "[effects]\ngravity = true\n[contact]"), "effects.gravity: is true: weight needs a target"),
        (("[contact]", "[contact]\nfriction = 0.3"), "contact.friction: is given, but bodies of a chain touch without"),
        (("[contact]", "[solver]\naccuracy = 2\n[contact]"), "chain:11: solver.accuracy: 2 is out of range"),
        (("title =", "titel ="), 'chain:1: titel: unknown key; did you mean "title"?'),
        (("[[bodies]]", "[bodies]"), "not TOML"),
        (('law = "hertz"', 'law = "herz"'), 'contact.law: no contact law is called "herz"'),
    ],
)
def test_mistakes_in_a_file_are_named(change, message):
    with pytest.raises(fm.SceneError) as error:
        fm.Chain.from_text(FILE.replace(*change, 1))
    assert message in str(error.value)


def test_what_cannot_be_simulated_is_refused():
    def of(bodies, contact="hertz", **options):
        return fm.simulate_chain(fm.Chain(bodies, contact, **options))

    with pytest.raises(fm.SimulationError, match="no body of the chain approaches"):
        of([{**BALL, "count": 2}])
    with pytest.raises(fm.SimulationError, match='damping of contact law "hunt-crossley" depends on the velocity'):
        of(CRADLE, fm.Contact("hunt-crossley", restitution=0.5))
    with pytest.raises(
        fm.SceneError, match=r"give bodies\[1\].material and bodies\[2\].material, or effective_modulus"
    ):
        of([{**HEAVY, "velocity": "1 m/s"}, {**HEAVY, "count": 2}])
    with pytest.raises(fm.SceneError, match=r"bodies\[1\].mass: missing"):
        of([{"radius": "1 mm", "velocity": "1 m/s", "count": 2}])
    with pytest.raises(fm.SceneError, match="bodies: there are 1: 2 to 10000 are needed, or a target"):
        of([BALL])
    soft = {"youngs_modulus": "50 MPa", "poissons_ratio": 0.49, "density": "1100 kg/m^3", "prony": [[0.4, "1 ms"]]}
    with pytest.raises(fm.SimulationError, match="relaxation of a viscoelastic material"):
        of([{**BALL, "material": soft, "velocity": "1 m/s"}, BALL])
    with pytest.raises(fm.SceneError, match="this is a chain"):
        fm.Scene.from_text(FILE)


def test_a_chain_is_written_and_read_again():
    own = {"law": "tsuji", "restitution": 0.5}
    target = fm.HalfSpace("mild steel")
    row = [{**BALL, "velocity": "1 m/s", "contact": own, "gap": "3 um"}, {**BALL, "count": 3}]
    chain = fm.Chain(row, target=target, gravity=True, duration="2 ms", title="A row")
    again = fm.Chain.from_text(chain.to_toml())
    assert again == chain and repr(again) == "Chain(4 bodies, before a half-space; law auto)"
    motion = fm.simulate_chain(again)
    assert pickle.loads(pickle.dumps(motion)) == motion
    assert motion.laws == ("tsuji", "elastoplastic", "elastoplastic", "elastoplastic")


def run(command):
    return main(command.split())


@pytest.mark.slow
def test_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cradle.toml").write_text(FILE, encoding="utf-8")
    (tmp_path / "row.toml").write_text(FILE.replace("count = 2", "count = 19"), encoding="utf-8")
    assert run("run cradle.toml --output cradle.nc --plot cradle.png") == 0
    text = capsys.readouterr().out
    assert "Newton's cradle" in text and "438.68 N" in text and "-0.035476 m/s" in text and "absorbed 0 J" in text
    assert run("run row.toml --json --accuracy 1e-6") == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["bodies"]) == 20 and found["contacts"][18]["law"] == "hertz"
    assert found["accuracy"]["estimated"] < found["accuracy"]["requested"] == 1e-6
    assert run("run row.toml") == 0 and "... 12 more" in capsys.readouterr().out
    assert run("run cradle.toml --segments 5") == 3
    assert "--segments is not for a chain of bodies" in capsys.readouterr().err
    assert run("check cradle.nc") == 0
    assert run("plot cradle.nc --output again.png") == 0
    assert (tmp_path / "again.png").read_bytes() == (tmp_path / "cradle.png").read_bytes()
    assert run("run cradle.toml --output cradle.csv") == 0
    ds = fd.open("cradle.nc")
    assert ds.contact_force.dims == ("contact", "t") and ds.velocity.dims == ("body", "t")
    head, *rows = (tmp_path / "cradle.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("t [s],displacement_1 [m]") and "contact_force_2 [N]" in head and len(rows) == 201
    assert float(ds.final_velocity[2]) == pytest.approx(0.4972747, abs=1e-7)
