"""Chains that branch: against another integrator, closed forms, balances; files, command and pictures."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main

G = 9.80665
BALL = {"radius": "10 mm", "mass": "1 kg"}
POWER = fm.Contact("meyer", stiffness="1e9 N/m^1.5", exponent=1.5)
FILE = """title = "A pulse that splits"
[[bodies]]
radius = "10 mm"
mass = "1 kg"
velocity = "1 m/s"
[[bodies]]
name = "stem"
count = 2
radius = "10 mm"
mass = "1 kg"
[[bodies]]
behind = "stem"
angle = "30 deg"
count = 3
radius = "10 mm"
mass = "1 kg"
[[bodies]]
behind = "stem"
angle = "-30 deg"
count = 3
radius = "10 mm"
mass = "1 kg"
[contact]
law = "meyer"
stiffness = "1e9 N/m^1.5"
exponent = 1.5
"""


def parts(chain):
    """Product of the cosines from the first body to each."""
    found = np.ones(len(chain.row))
    for link in chain.links:
        if link.behind is not None:
            found[link.behind] = found[link.front] * math.cos(link.angle)
    return found


def test_both_branches_of_a_fork_move_alike():
    motion = fm.simulate_chain(fm.Chain.from_text(FILE))
    after = motion.final_velocity.m
    assert (after[3:6] == after[6:9]).all() and (after[5] > 0.5) and after[2] < 0.0
    assert (motion.largest_force.m[2:5] == motion.largest_force.m[5:8]).all()
    assert motion.energy.kinetic_after == pytest.approx(0.5, rel=1e-12)
    assert parts(motion.chain) @ after == pytest.approx(1.0, rel=1e-14)


def tree(rng, count):
    """A random tree with angles, masses and gaps, and the exponent of the law behind each body."""
    bodies, exponents = [], rng.choice([1.0, 1.5, 2.0], count)
    for number in range(count):
        bodies.append(
            {
                **{"radius": "10 mm", "mass": f"{10.0 ** rng.uniform(-1.0, 0.0)} kg", "name": f"n{number}"},
                **{"velocity": f"{rng.uniform(-1.0, 1.0)} m/s", "gap": f"{rng.choice([0.0, 1e-6, 1e-4])} m"},
                "contact": fm.Contact("meyer", exponent=(q := exponents[number]), stiffness=f"1e8 N/m^{q}"),
            }
        )
        if number:
            turn = {"behind": f"n{rng.integers(number)}", "angle": f"{rng.uniform(-60.0, 60.0)} deg"}
            bodies[-1] |= turn | ({"front_gap": "5 um"} if rng.random() < 0.3 else {})
    return bodies, exponents


@pytest.mark.parametrize("seed", range(4))
def test_trees_keep_momentum_and_energy(seed):
    """Momentum along the line of the first body, of which a guide takes its part at each bend."""
    chain = fm.Chain(tree(np.random.default_rng(seed), 8)[0])
    motion = fm.simulate_chain(chain)
    mass, before, after = motion.values["body_mass"], motion.values["initial_velocity"], motion.final_velocity.m
    weight = mass * parts(chain)
    assert weight @ after == pytest.approx(weight @ before, abs=1e-14 * mass.sum())
    assert 0.5 * mass @ after**2 == pytest.approx(0.5 * mass @ before**2, rel=1e-12)
    assert motion.estimated <= 1e-9 and sum(motion.counts) >= 3
    at = np.linspace(0.0, motion.end, 4001)
    sample = motion.sample_si(at)
    moved = np.trapezoid(sample["velocity"], at, axis=1)
    assert np.abs(sample["displacement"][:, -1] - moved).max() < 2e-3 * motion.end


@pytest.mark.parametrize("seed", [4, 5])
def test_trees_agree_with_another_integrator(seed):
    bodies, exponents = tree(np.random.default_rng(seed), 6)
    chain = fm.Chain(bodies)
    motion = fm.simulate_chain(chain)
    row, links = chain.row, chain.links
    mass = np.array([body.own_mass for body in row])

    def rates(t, y):
        place, velocity = y[:6], y[6:]
        push = np.zeros(6)
        for link in links:
            depth = math.cos(link.angle) * place[link.front] - place[link.behind] - link.gap
            force = 1e8 * max(depth, 0.0) ** exponents[link.front]
            push[link.behind] += force
            push[link.front] -= math.cos(link.angle) * force
        return [*velocity, *(push / mass)]

    start = [*np.zeros(6), *(body.velocity for body in row)]
    ended = solve_ivp(rates, (0.0, motion.end), start, "DOP853", rtol=1e-10, atol=1e-13, max_step=motion.end / 500)
    assert motion.final_velocity.m == pytest.approx(ended.y[6:, -1], abs=5e-8)
    moved = motion.sample_si([motion.end])["displacement"][:, 0]
    assert moved == pytest.approx(ended.y[:6, -1], abs=1e-7 * np.abs(moved).max())


def test_one_ball_strikes_two():
    """At once, and one after the other by the formula of two bodies on lines at an angle."""
    hit = {**BALL, "behind": "cue"}
    cue = {**BALL, "velocity": "1 m/s", "name": "cue"}
    both = fm.simulate_chain(fm.Chain([cue, hit, hit], POWER))
    assert both.final_velocity.m == pytest.approx([-1 / 3, 2 / 3, 2 / 3], abs=1e-12)
    away = {**hit, "mass": "2 kg", "angle": "60 deg", "front_gap": "1 mm"}
    motion = fm.simulate_chain(fm.Chain([cue, {**hit, "mass": "0.25 kg", "angle": "-45 deg"}, away], POWER))
    first, left = [1.0, 0.0, 0.0], []
    for k, angle, mass in ((1, -45.0, 0.25), (2, 60.0, 2.0)):
        c = math.cos(math.radians(angle))
        impulse = 2.0 * c * first[0] / (c * c + 1.0 / mass)
        first[0] -= c * impulse
        first[k] = impulse / mass
        left.append(first[0])
    assert motion.final_velocity.m == pytest.approx(first, abs=1e-12) and min(left) > 0.0
    assert motion.contact_begins.m[1] > motion.contact_ends.m[0] > 0.0


def test_a_damped_fork_carries_its_weight():
    """At rest M g = 2 F cos a at the fork, and each foot bears F + m g cos a."""
    own = {"law": "tsuji", "restitution": 0.3}
    steel = {"radius": "10 mm", "material": "bearing steel", "contact": own}
    top = {**steel, "mass": "0.2 kg", "name": "top"}
    legs = [{**steel, "behind": "top", "angle": f"{a} deg", "gap": "0.1 mm"} for a in (40, -40)]
    motion = fm.simulate_chain(
        fm.Chain([top, *legs], target=fm.HalfSpace("mild steel"), gravity=True, duration="0.3 s")
    )
    cosine = math.cos(math.radians(40.0))
    fork = 0.2 * G / (2.0 * cosine)
    foot = fork + motion.values["body_mass"][1] * G * cosine
    forces = motion.sample_si([motion.end])["contact_force"][:, 0]
    assert forces == pytest.approx([fork, fork, foot, foot], rel=1e-9)
    assert abs(motion.energy.error) < 1e-12 * motion.energy.weight and motion.chain.link_names[3] == "3-target"
    sunk = motion.sample_si([motion.end])["displacement"][:, 0]
    assert sunk[1] == sunk[2] == pytest.approx(1e-4, rel=0.02)


def test_a_row_written_as_a_tree_is_the_same_row():
    row = [{**BALL, "velocity": "1 m/s", "gap": "1 um"}, {**BALL, "count": 3}]
    plain = fm.simulate_chain(fm.Chain(row, POWER))
    named = [{**row[0], "name": "a"}, {**BALL, "behind": "a", "angle": "0 deg"}, {**BALL, "count": 2}]
    motion = fm.simulate_chain(fm.Chain(named, POWER))
    assert (motion.final_velocity.m == plain.final_velocity.m).all() and not motion.chain.branches


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            ('behind = "stem"', 'behind = "stme"'),
            'chain:12: bodies[3].behind: "stme" is no name of a body before it; did you mean "stem"?',
        ),
        (('name = "stem"', 'behind = "stem"'), 'bodies[2].behind: "stem" is no name of a body before it'),
        (('velocity = "1 m/s"', 'angle = "5 deg"'), "chain:5: bodies[1].angle: is not for the first body"),
        (('count = 3\nradius = "10 mm"', 'name = "stem"\nradius = "10 mm"'), '"stem" is the name of bodies[2], too'),
        (
            ('angle = "30 deg"', 'angle = "90 deg"'),
            'bodies[3].angle: "90 deg" is out of range: from -89.9544 to 89.9544 deg',
        ),
        (('angle = "30 deg"', 'front_gap = "-1 mm"'), 'bodies[3].front_gap: "-1 mm" must be >= 0'),
    ],
)
def test_mistakes_in_a_tree_are_named(change, message):
    with pytest.raises(fm.SceneError) as error:
        fm.Chain.from_text(FILE.replace(*change, 1))
    assert message in str(error.value)


@pytest.mark.slow
def test_a_tree_is_written_and_read_again(tmp_path, monkeypatch, capsys):
    chain = fm.Chain.from_text(FILE)
    assert fm.Chain.from_text(chain.to_toml()) == chain
    assert repr(chain) == "Chain(9 bodies with 2 ends; law meyer)"
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fork.toml").write_text(FILE, encoding="utf-8")
    assert main(["run", "fork.toml", "--json", "--output", "fork.nc", "--plot", "fork.png"]) == 0
    found = json.loads(capsys.readouterr().out)["contacts"]
    assert [(row["front"], row["behind"]) for row in found] == [
        *[(1, 2), (2, 3), (3, 4), (4, 5), (5, 6)],
        *[(3, 7), (7, 8), (8, 9)],
    ]
    assert main(["run", "fork.toml"]) == 0 and "\n  3-7 " in capsys.readouterr().out
    assert main(["check", "fork.nc"]) == 0
    ds = fd.open("fork.nc")
    assert ds.contact_front.values.tolist() == [1, 2, 3, 4, 5, 3, 7, 8] and ds.contact_behind.values[5] == 7
    assert main(["plot", "fork.nc", "--output", "again.png"]) == 0
    assert (tmp_path / "again.png").read_bytes() == (tmp_path / "fork.png").read_bytes()
    assert main(["run", "fork.toml", "--output", "fork.csv"]) == 0
    assert "contact_force_8 [N]" in (tmp_path / "fork.csv").read_text(encoding="utf-8").splitlines()[0]


def test_a_chain_without_a_title_is_drawn(tmp_path):
    ends = [{**BALL, "behind": "hub"} for _ in range(5)]  # more contacts than colours
    star = fm.Chain([{**BALL, "velocity": "1 m/s", "name": "hub"}, *ends], POWER, fm.HalfSpace("granite"))
    fm.simulate_chain(star).plot(tmp_path / "star.png")
    assert (tmp_path / "star.png").stat().st_size > 10_000
