"""Several contacts on one structure: against coupled equations, impacts, symmetry; balances, files, refusals."""

from __future__ import annotations

import json
import math
import warnings

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main

STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
BALL = {"radius": "10 mm", "material": STEEL}
STOP = {"radius": "5 mm", "material": STEEL, "behind": "target", "fixed": True}
FILE = """
[target]
kind = "plate"
material = "aluminium 6061-T6"
thickness = "3 mm"
size = ["200 mm", "150 mm"]
position = ["80 mm", "75 mm"]
[[target.sensors]]
name = "second"
position = ["130 mm", "60 mm"]
strain = true
[[bodies]]
radius = "8 mm"
material = "bearing steel"
velocity = "0.5 m/s"
at = "second"
gap = "20 um"
[[bodies]]
radius = "10 mm"
material = "bearing steel"
velocity = "0.5 m/s"
[[bodies]]
behind = "target"
at = "second"
fixed = true
radius = "5 mm"
material = "bearing steel"
front_gap = "20 um"
[contact]
law = "hertz"
[solver]
duration = "0.1 ms"
accuracy = 1e-2
"""


@pytest.fixture(autouse=True)
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fm.ImpactWarning)
        yield


def plate(sensors=(), position=("80 mm", "75 mm"), **options):
    named = [{"name": name, "position": list(place)} for name, place in dict(sensors).items()]
    options = {"size": ["200 mm", "150 mm"], "damping_ratio": 0.01, **options}
    return fm.Plate(STEEL, "3 mm", position=list(position), sensors=named or None, **options)


def run(bodies, target, duration="0.4 ms", law="hertz", **options):
    return fm.simulate_chain(fm.Chain(bodies, law, target, duration=duration, **options))


@pytest.mark.slow
def test_two_balls_and_a_stop_obey_the_coupled_equations():
    """DOP853 of SciPy on the same vibrations: within 1e-8 at all times."""
    omega, zeta = 2.0 * math.pi * np.array([300.0, 900.0, 2500.0, 8000.0, 30e3]), 0.01
    masses = np.array([0.9, 0.5, 0.4, 0.3, 0.2])
    shapes = np.array([[1.0, 1, 1, 1, 1], [0.9, -0.4, 0.7, -1.1, 0.3], [0.8, 0.9, -0.2, 0.5, -0.9]])
    named = [{"name": name, "shape": row.tolist()} for name, row in zip("ab", shapes[1:], strict=True)]
    hertz = [f"{f} Hz" for f in omega / (2.0 * math.pi)], [f"{m} kg" for m in masses]
    target = fm.Structure(None, STEEL, *hertz, damping_ratio=zeta, sensors=named)
    second = {**BALL, "radius": "8 mm", "velocity": "0.4 m/s", "gap": "20 um", "at": "a"}
    bodies = [second, {**BALL, "velocity": "0.5 m/s"}, {**STOP, "at": "b", "front_gap": "2 um"}]
    motion = run(bodies, target, "0.6 ms", accuracy=1e-9)
    (light, heavy, _), at = motion.values["body_mass"], np.linspace(0.0, motion.end, 301)
    modulus, side = 4.0 / 3.0 * 210e9 / (2.0 * (1.0 - 0.3**2)), np.array([1.0, 1.0, -1.0])
    stiffness = modulus * np.sqrt([0.008, 0.010, 0.005])
    seen = shapes[[1, 0, 2]]

    def depths(q, x):
        return side * (np.array([*x, 0.0 * x[0]]) - seen @ q) - np.array([20e-6, 0.0, 2e-6])

    def rates(_, y):
        q, rate, x, v = np.split(y, [5, 10, 12])
        force = stiffness * np.maximum(depths(q, x), 0.0) ** 1.5
        bent = (side * force) @ seen / masses - 2.0 * zeta * omega * rate - omega**2 * q
        return np.concatenate([rate, bent, v, -force[:2] / (light, heavy)])

    start = np.array([*np.zeros(12), 0.4, 0.5])
    exact = solve_ivp(rates, (0.0, motion.end), start, "DOP853", at, rtol=1e-12, atol=1e-16, max_step=5e-7).y
    found, moved = motion.sample_si(at), shapes @ exact[:5]
    force = [stiffness[k] * max(d, 0.0) ** 1.5 for q in exact.T for k, d in enumerate(depths(q[:5], q[10:12]))]
    force = np.reshape(force, (-1, 3)).T
    assert (force.max(axis=1) > 100.0).all()
    for name, value in {
        "velocity": np.vstack([exact[12:], np.zeros(at.size)]),
        "displacement": np.vstack([exact[10:12], np.zeros(at.size)]),
        "contact_force": force,
        "sensor_displacement": moved[1:],
        "sensor_velocity": shapes[1:] @ exact[5:10],
        "sensor_acceleration": shapes[1:] @ np.transpose([rates(0.0, y)[5:10] for y in exact.T]),
    }.items():
        assert np.abs(found[name] - value).max() < 1e-8 * np.abs(value).max(), name
    assert abs(motion.energy.error) < 1e-9 * motion.energy.kinetic_before


BEAM = fm.Beam(STEEL, "300 mm", "20 mm", "8 mm", ("clamped", "free"), damping_ratio=0.01, position="0.2 m")
GIVEN = {"frequency": ["180 Hz", "410 Hz", "2 kHz"], "modal_mass": ["0.9 kg", "1.4 kg", "0.2 kg"]}


@pytest.mark.slow
@pytest.mark.parametrize("law", ["hertz", "auto", {"law": "tsuji", "restitution": 0.8}])
@pytest.mark.parametrize(
    "target",
    [
        plate(),
        BEAM,
        fm.Structure(material=STEEL, **GIVEN),
        fm.Structure(None, STEEL, **GIVEN, static_compliance="1.1 um/N"),
    ],
    ids=["plate", "beam", "structure", "with compliance"],
)
def test_one_contact_is_the_impact_of_simulate(target, law):
    """Within both estimates: the other engine, the same vibrations."""
    contact = fm.Contact(law) if isinstance(law, str) else fm.Contact(**law)
    motion = run([{**BALL, "velocity": "0.5 m/s"}], target, "0.2 ms", contact, accuracy=1e-3)
    off = fm.Effects(gravity=False, rate_hardening=False, material_damping=False, wave_losses=False, small_slope=False)
    impact = fm.simulate(fm.Scene(fm.Sphere("10 mm", "0.5 m/s", material=STEEL), target, contact, off), accuracy=1e-4)
    allowed = motion.estimated + impact.accuracy.estimated
    assert motion.estimated <= 2e-3
    assert motion.values["largest_force"][0] == pytest.approx(impact.summary["maximum_force"], rel=allowed)
    there = impact.sample_si(np.array([motion.end])).impactor_velocity[0]
    assert motion.values["final_velocity"][0] == pytest.approx(there, abs=0.5 * allowed)


@pytest.mark.slow
def test_balls_at_symmetric_points_have_the_same_motion():
    places = {"left": ("60 mm", "50 mm"), "right": ("140 mm", "100 mm")}
    ball = {**BALL, "velocity": "0.5 m/s"}
    both = run([{**ball, "at": "left"}, {**ball, "at": "right"}], plate(places))
    alone = run([{**ball, "at": "left"}], plate(places))
    assert both.values["largest_force"][0] == pytest.approx(both.values["largest_force"][1], rel=1e-10)
    assert both.final_velocity.m[0] == pytest.approx(both.final_velocity.m[1], abs=1e-10)
    assert abs(both.final_velocity.m[0] - alone.final_velocity.m[0]) > 1e-3
    sensed = both.sample_si(np.linspace(0.0, both.end, 50))["sensor_displacement"]
    assert np.abs(sensed[0] - sensed[1]).max() < 1e-9 * np.abs(sensed).max()


@pytest.mark.slow
def test_a_stop_is_touched_when_the_structure_has_crossed_the_gap():
    sensors = {"stop": ("95 mm", "85 mm")}
    ball = {**BALL, "velocity": "0.5 m/s"}
    free = run([ball], plate(sensors))
    far, near = (run([ball, {**STOP, "at": "stop", "front_gap": gap}], plate(sensors)) for gap in ("1 mm", "10 um"))
    assert far.counts == (1, 0) and far.values["largest_force"][0] == pytest.approx(
        free.values["largest_force"][0], rel=1e-4
    )
    begins = near.values["contact_begins"][1]
    assert near.counts[1] >= 1 and near.values["largest_force"][1] > 50.0
    assert near.sample_si([begins])["sensor_displacement"][0, 0] == pytest.approx(10e-6, rel=1e-3)
    assert near.sample_si([near.end])["displacement"][1, 0] == pytest.approx(0.0, abs=1e-12)
    for motion in (free, near):
        assert abs(motion.energy.error) < 1e-6 * motion.energy.kinetic_before


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_a_free_body_as_structure_keeps_momentum(exponent):
    """A structure with only the motion as a whole is a body: as three bodies in a row, and momentum is kept."""
    contact = fm.Contact("meyer", stiffness=f"1e8 N/m^{exponent}", exponent=exponent)
    one, last = {"radius": "10 mm", "mass": "1 kg"}, {"radius": "10 mm", "mass": "3 kg"}
    plain = run([{**one, "velocity": "1 m/s"}, {**one, "mass": "2 kg"}, last], None, "5 ms", contact)
    target = fm.Structure(frequency=["0 Hz"], modal_mass=["2 kg"])
    pushed = run([{**one, "velocity": "1 m/s"}, {**last, "behind": "target"}], target, "5 ms", contact, accuracy=1e-8)
    assert pushed.final_velocity.m == pytest.approx(plain.final_velocity.m[[0, 2]], abs=1e-8)
    assert pushed.values["largest_force"] == pytest.approx(plain.values["largest_force"], rel=1e-8)
    rest = 1.0 - pushed.values["body_mass"] @ pushed.final_velocity.m
    assert pushed.energy.vibrations == pytest.approx(0.5 * rest**2 / 2.0, rel=1e-7)


def test_rows_in_front_and_behind_are_where_their_velocities_bring_them():
    """Two balls in a row before the plate, two behind it, under weight."""
    row = [{**BALL, "velocity": "0.3 m/s"}, {**BALL, "gap": "5 um"}, {**BALL, "behind": "target", "count": 2}]
    motion = run(row, plate(), gravity=True, accuracy=1e-2)
    assert motion.chain.link_names == ["1-2", "3-4", "2-target", "target-3"]
    at = np.linspace(0.0, motion.end, 4001)
    found = motion.sample_si(at)
    moved = np.trapezoid(found["velocity"], at, axis=1)
    assert found["displacement"][:, -1] == pytest.approx(moved, abs=1e-5 * np.abs(moved).max())
    assert abs(motion.energy.error) < 1e-5 * motion.energy.kinetic_before and motion.energy.weight > 0.0


@pytest.mark.slow
def test_files_pictures_and_datasets(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cover.toml").write_text(FILE, encoding="utf-8")
    chain = fm.Chain.from_toml("cover.toml")
    assert fm.Chain.from_text(chain.to_toml()) == chain and repr(chain) == "Chain(3 bodies, on a plate; law hertz)"
    assert main(["run", "cover.toml", "--output", "cover.nc", "--plot", "cover.png"]) == 0
    text = capsys.readouterr().out
    assert "1-target" in text and "target-3" in text and "of vibrations" in text
    assert main(["run", "cover.toml", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["bodies"][2]["body_mass"] is None and found["contacts"][2]["front"] is None
    assert main(["check", "cover.nc"]) == 0 and main(["plot", "cover.nc", "--output", "again.png"]) == 0
    assert main(["run", "cover.toml", "--output", "cover.csv"]) == 0
    assert "sensor_second_strain_x" in (tmp_path / "cover.csv").read_text(encoding="utf-8").splitlines()[0]
    ds = fd.open("cover.nc")
    assert ds.contact_front.values.tolist() == [1, 2, 0] and ds.contact_behind.values.tolist() == [0, 0, 3]
    peak = np.abs(ds.sensor_displacement).max("t").values
    assert ds.sensor_maximum_displacement.values == pytest.approx(peak, rel=1e-2)
    assert float(ds.sensor_maximum_bending_stress[0]) > 1e6


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('duration = "0.1 ms"', ""), "solver.duration: missing: how long to follow the bodies"),
        (('at = "second"', 'at = "secnd"'), 'bodies[1].at: "secnd" is no sensor of the target; did you mean "second"?'),
        (('size = ["200 mm", "150 mm"]\nposition = ["80 mm", "75 mm"]', ""), "target"),
        (
            ('position = ["80 mm"', 'in_plane = "fixed"\nposition = ["80 mm"'),
            "in_plane: membrane forces are not simulated",
        ),
        (
            ("fixed = true", 'fixed = true\nvelocity = "1 m/s"'),
            "bodies[3].fixed: is not for several bodies or one with",
        ),
        (('kind = "plate"', 'kind = "rod"'), 'target.kind: "rod" is not supported behind a chain'),
        (('["130 mm", "60 mm"]', '["130 mm", "0 mm"]'), "a support does not deflect"),
        (('behind = "target"', 'behind = "second"'), 'bodies[3].behind: "second" is no name of a body before it'),
        (('at = "second"\ngap', 'name = "target"\ngap'), 'bodies[1].name: "target" is the structure'),
        (('at = "second"\nfixed', 'angle = "3 deg"\nfixed'), "bodies[3].angle: is not for a body behind the target"),
    ],
)
def test_mistakes_are_named(change, message):
    assert change[0] in FILE
    with pytest.raises(fm.SceneError) as error:
        fm.Chain.from_text(FILE.replace(*change, 1))
    assert message in str(error.value)


def test_what_is_not_simulated_is_refused():
    ball = {**BALL, "velocity": "0.5 m/s"}
    with pytest.raises(fm.SceneError, match=r"bodies\[1\].at: needs a target that vibrates"):
        fm.Chain([{**ball, "at": "a"}], "hertz", fm.HalfSpace(STEEL))
    with pytest.raises(fm.SceneError, match=r"bodies\[1\].fixed: is not for a body with another one behind it"):
        fm.Chain([{**BALL, "fixed": True, "name": "a"}, {**ball, "behind": "a"}], "hertz", plate(), duration="1 ms")
    with pytest.raises(fm.SimulationError, match='law "tsuji" depends on a mass, and a fixed body has none'):
        run([ball, STOP], plate(), law=fm.Contact("tsuji", restitution=0.5))
    with pytest.raises(fm.SceneError, match="this is a chain"):
        fm.Scene.from_text(FILE)
