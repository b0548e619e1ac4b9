"""Plates and beams with edges: when vibrations are simulated, and whether the motion is right."""

import json
import math
import pickle
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases import BALL, LAWS, STEEL, combinations

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main
from film_model.core import modal
from film_model.effects.choose import choose, problem_of
from film_model.effects.many import problems_of
from film_model.solve import structures, vibration
from film_model.solve.batch import STATUSES, simulate_many
from film_model.studies import quadrature
from film_model.targets.plate import plate_modes

SCENES = Path(__file__).parent.parent / "examples" / "scenes"
OLSSON = fm.Scene.from_toml(SCENES / "olsson_plate.toml")

CONVERGED = {  # 5476 modes, integrated to 1e-9
    "maximum_force": 331.763705,
    "maximum_indentation": 46.9055974e-6,
    "time_of_maximum_indentation": 34.832943e-6,
    "time_impactor_stops": 143.513700e-6,
    "contact_duration": 195.265177e-6,
    "rebound_velocity": -0.545207170,
}


@pytest.fixture(scope="module")
def history():
    return fm.simulate(OLSSON, accuracy=1e-3)


@pytest.mark.slow
def test_a_vibrating_history_is_pickled(history):
    again = pickle.loads(pickle.dumps(history))
    assert len(history.vibration.segments) > 1 and again == history
    times = np.linspace(0.0, 2.0 * history.duration, 101)
    assert np.array_equal(again.sample_si(times).contact_force, history.sample_si(times).contact_force)
    assert np.array_equal(again.sample_si(times).target_velocity, history.sample_si(times).target_velocity)


def _ball(velocity="0.25 m/s", **ball):
    return fm.Sphere(velocity=velocity, **{**BALL, **ball})


# ---------------------------------------------------------------- the paper's plate


@combinations(accuracy=[1e-2, 1e-3, 1e-4], fast=1)
def test_the_papers_plate(accuracy):
    got = fm.simulate(OLSSON, accuracy=accuracy)
    assert got.outcome is fm.Outcome.SEPARATED
    assert got.accuracy.estimated <= accuracy
    for name, value in CONVERGED.items():
        assert got.summary[name] == pytest.approx(value, rel=accuracy), name
        if accuracy == 1e-4:
            assert got.summary[name] == pytest.approx(value, rel=got.accuracy.estimated), name


def test_numbers_of_a_modal_solution(history):
    """331.8 N at 34.8 µs and 46.91 µm; contact is lost at 195 µs, 20 µs sooner than on an infinite plate."""
    summary = history.summary
    assert summary["maximum_force"] == pytest.approx(331.8, abs=0.1)
    assert summary["time_of_maximum_indentation"] == pytest.approx(34.8e-6, abs=0.05e-6)
    assert summary["maximum_indentation"] == pytest.approx(46.91e-6, abs=0.01e-6)
    assert summary["contact_duration"] == pytest.approx(195e-6, abs=0.5e-6)
    infinite = fm.simulate(OLSSON.replace({"effects.boundary_reflections": False})).summary
    assert summary["maximum_force"] == pytest.approx(infinite["maximum_force"], rel=1e-3)
    assert infinite["contact_duration"] == pytest.approx(214.4e-6, abs=0.1e-6)


def test_contact_is_lost_and_comes_back(history):
    names = [event.name for event in history.events]
    contact = ["contact_begins", "maximum_indentation", "contact_ends"]
    assert names == [*contact[:2], "impactor_stops", contact[2], *contact]
    assert history.summary["contact_duration"] == history.events[3].time
    assert history.summary["rebound_velocity"] == history.events[-1].impactor_velocity
    assert history.duration == history.events[-1].time
    assert any("that of the first, which ends after 0.0001953 s" in warning for warning in history.warnings)
    between = np.linspace(history.events[3].time, history.events[4].time, 50)
    apart = history.sample_si(between)
    assert set(apart.stage.tolist()[1:-1]) == {""} and not apart.contact_force[1:-1].any()
    assert (apart.indentation[1:-1] < 0.0).all()
    assert np.ptp(apart.impactor_velocity) < 1e-12


def test_more_modes_converge():
    """Twice the highest frequency, twice the modes: the peak force's error falls with their square or faster."""
    problem, plate, errors = problem_of(OLSSON), OLSSON.target, []
    for highest in (3e5, 1.2e6):
        structure = structures.structure_of(plate, highest, problem.scales.time)
        run = vibration.run(problem, structure, 1e-6, 300e-6)
        errors.append(abs(run.summary.maximum_force * problem.scales.force / CONVERGED["maximum_force"] - 1))
        bare = vibration.run(problem, replace(structure, omitted=0.0), 1e-6, 300e-6)
        assert abs(bare.summary.maximum_force * problem.scales.force / CONVERGED["maximum_force"] - 1) > 3 * errors[-1]
    modes = plate.modes(highest)
    assert modes.frequency.size > 3 * plate.modes(3e5).frequency.size
    assert errors[1] < errors[0] / 16


# ---------------------------------------------------------------- an integrator of its own


def _propagate(scene, highest, end, steps):
    """Force at equidistant times: exact modes for a force linear within each step, the contact law at its end."""
    modes, mass = scene.target.modes(highest), scene.mass
    stiffness = 4 / 3 * scene.effective_modulus * math.sqrt(scene.effective_radius)
    rest = scene.target.compliance - modes.compliance
    h = end / steps
    turn = modes.frequency * h
    cos, sin, wave = np.cos(turn), np.sin(turn) / turn, (1 - np.cos(turn)) / turn**2
    before, after = (sin - cos) * h**2 / turn**2, (1 - sin) * h**2 / turn**2
    w, u = np.zeros_like(turn), np.zeros_like(turn)
    x, v, f, forces, speeds = 0.0, scene.impactor.speed, 0.0, [0.0], [scene.impactor.speed]
    soft = h**2 / (6 * mass) + float(np.sum(modes.share * after)) + rest
    for _ in range(steps):
        w1 = w * cos + u * h * sin + modes.share * before * f
        ahead = x + v * h - f * h**2 / (3 * mass) - float(w1.sum())
        depth = max(ahead, 0.0)
        for _ in range(60 if ahead > 0.0 else 0):
            miss = depth + soft * stiffness * depth**1.5 - ahead
            depth = max(depth - miss / (1 + 1.5 * soft * stiffness * math.sqrt(depth)), 0.25 * depth)
            if abs(miss) < 1e-16 * ahead:
                break
        g = stiffness * depth**1.5
        u = u * cos - w * modes.frequency * turn * sin + modes.share * (f * (sin * h - wave * h) + g * wave * h)
        w = w1 + modes.share * after * g
        x, v, f = x + v * h - h**2 * (f / 3 + g / 6) / mass, v - h * (f + g) / (2 * mass), g
        forces.append(f)
        speeds.append(v)
    return np.array(forces), np.array(speeds)


@pytest.mark.parametrize(
    ("target", "highest"),
    [
        pytest.param(OLSSON.target, 1.2e6, marks=pytest.mark.slow),
        pytest.param(
            fm.Plate(STEEL, "4 mm", size=["150 mm", "100 mm"], position=["50 mm", "30 mm"]),
            2e6,
            marks=pytest.mark.slow,
        ),
        (fm.Beam(STEEL, "200 mm", "20 mm", "5 mm", position="80 mm"), 1e6),
    ],
)
def test_against_an_exact_propagation_of_the_modes(target, highest):
    contact = fm.Contact("hertz", effective_modulus="9.72 GPa")
    effects = fm.Effects(gravity=False, boundary_reflections=True)
    scene = fm.Scene(OLSSON.impactor, target, contact, effects)
    problem = problem_of(scene)
    end = 600e-6
    limit = end / problem.scales.time
    run = vibration.run(problem, structures.structure_of(target, highest, problem.scales.time), 1e-9, end)
    coarse, fine = (_propagate(scene, highest, end, steps) for steps in (6000, 12000))
    times = np.linspace(0.0, limit, 6001)
    values, _ = run.sample(times)
    forces = (4 * fine[0][::2] - coarse[0]) / 3
    assert np.abs(values[:, 2] * problem.scales.force - forces).max() < 2e-4 * forces.max()
    assert np.abs(values[:, 2] * problem.scales.force - forces).mean() < 2e-6 * forces.max()
    assert values[-1, 3] * problem.scales.velocity == pytest.approx(fine[1][-1], abs=1e-5)


# ---------------------------------------------------------------- balances


@combinations(
    law=["hertz", "big-alabo", "stronge", "saturating", "yigit-christoforou", "tan-sun", "walton-braun", "tabulated"],
    fast=3,
)
def test_energy_and_momentum(law):
    plate = fm.Plate(STEEL, "8 mm", size=["150 mm", "150 mm"])
    scene = fm.Scene(_ball(), plate, fm.Contact(law=LAWS[law]), fm.Effects(boundary_reflections=True))
    history = fm.simulate(scene, accuracy=1e-3)
    summary, mass = history.summary, scene.mass
    ahead, left = (0.5 * mass * v**2 for v in (0.25, summary["rebound_velocity"]))
    spent = summary["energy_absorbed"] + summary["energy_radiated"]
    assert ahead == pytest.approx(left + spent, rel=1e-4)
    times = np.linspace(0.0, history.duration, 4001)
    samples = history.sample_si(times)
    impulse = float(np.trapezoid(samples.contact_force, times))
    assert impulse == pytest.approx(mass * (0.25 - summary["rebound_velocity"]), rel=1e-4)
    work = float(np.trapezoid(samples.contact_force * samples.relative_velocity, times))
    assert work == pytest.approx(summary["energy_absorbed"], abs=2e-4 * ahead)
    np.testing.assert_allclose(
        samples.indentation + samples.target_displacement, samples.impactor_displacement, rtol=1e-12
    )
    assert summary["maximum_force"] >= samples.contact_force.max() * (1 - 1e-12)
    assert summary["maximum_force"] == pytest.approx(samples.contact_force.max(), rel=1e-3)
    if law == "hertz":
        assert summary["energy_absorbed"] == summary["permanent_indentation"] == 0.0
    else:
        assert summary["permanent_indentation"] > 0.0


@combinations(law=["tan-sun", "walton-braun", "jackson-green"], fast=1)
def test_energy_where_the_force_oscillates(law):
    """A heavy impactor on a vibrating plate: the contact opens and closes many times, on all branches."""
    plate = fm.Plate(STEEL, "4 mm", size=["150 mm", "100 mm"])
    effects = fm.Effects(boundary_reflections=True, gravity=False)
    scene = fm.Scene(fm.Sphere("12 mm", "0.3 m/s", mass="2 kg"), plate, fm.Contact(law=LAWS[law]), effects)
    history = fm.simulate(scene, accuracy=1e-3)
    summary, ahead = history.summary, scene.kinetic_energy
    assert [event.name for event in history.events].count("reloading_begins") > 5
    left = 0.5 * 2.0 * summary["rebound_velocity"] ** 2
    assert ahead == pytest.approx(left + summary["energy_absorbed"] + summary["energy_radiated"], rel=1e-6)
    times = np.linspace(0.0, history.duration, 20001)
    samples = history.sample_si(times)
    work = float(np.trapezoid(samples.contact_force * samples.relative_velocity, times))
    assert work == pytest.approx(summary["energy_absorbed"], rel=1e-4)


@pytest.mark.parametrize("law", ["hertz", "big-alabo"])
def test_the_force_follows_the_law(law, history):
    """During loading the force is that of the law at the indentation; samples at event times equal the events."""
    model = LAWS[law]
    plate = fm.Plate(STEEL, "8 mm", size=["150 mm", "150 mm"])
    scene = fm.Scene(_ball(), plate, fm.Contact(law=model), fm.Effects(boundary_reflections=True))
    got = fm.simulate(scene, accuracy=1e-2)
    top = next(event for event in got.events if event.name == "maximum_indentation")
    samples = got.sample_si(np.linspace(0.0, top.time, 40)[1:])
    length, force = model.scales(scene.kinetic_energy)
    for depth, found in zip(samples.indentation, samples.contact_force, strict=True):
        stage = next(s for s in reversed(model.stages()) if s.begin <= depth / length)
        assert found == pytest.approx(force * float(quadrature.value(stage.force, depth / length, stage)), rel=1e-9)
    for event in got.events:
        at = got.sample_si(event.time)
        assert at.indentation == pytest.approx(event.indentation, rel=1e-6, abs=1e-12)
        assert at.impactor_velocity == pytest.approx(event.impactor_velocity, rel=1e-9)


# ---------------------------------------------------------------- limits


def test_a_wide_plate_equals_an_infinite_one():
    scene = OLSSON.replace({"impactor.mass": "2 g", "target.size": ["150 mm", "150 mm"]})
    near = fm.simulate(scene.replace({"effects.boundary_reflections": True}), accuracy=1e-3).summary
    wide = fm.simulate(scene).summary
    assert fm.simulate(scene).vibration is None
    for name in ("maximum_force", "maximum_indentation", "time_impactor_stops"):
        assert near[name] == pytest.approx(wide[name], rel=2e-3), name
    assert near["contact_duration"] == pytest.approx(wide["contact_duration"], rel=1e-2)


@pytest.mark.parametrize("kind", ["plate", "beam"])
def test_a_slow_contact_feels_the_static_stiffness(kind):
    """Below the threshold of the vibration indicator, modal and static results agree within the tolerance."""
    beam = fm.Beam(STEEL, "300 mm", "20 mm", "8 mm")
    target = beam if kind == "beam" else fm.Plate(STEEL, "8 mm", size=["200 mm", "200 mm"])
    contact = fm.Contact("hertz", effective_modulus="0.5 MPa" if kind == "beam" else "0.2 GPa")
    ball = fm.Sphere("10 mm", "1 m/s", mass="5 kg")
    quiet = {"gravity": False, "boundary_reflections": True}
    auto = fm.simulate(fm.Scene(ball, target, contact, fm.Effects(**quiet)))
    effect = next(e for e in auto.effects if e.name == "target_inertia")
    assert auto.vibration is None and effect.state == "not needed" and 0.001 < effect.value < effect.threshold
    modal = fm.simulate(fm.Scene(ball, target, contact, fm.Effects(**quiet, target_inertia=True)), accuracy=1e-2)
    assert modal.accuracy.modes > 0
    for name in ("maximum_force", "maximum_indentation", "contact_duration", "rebound_velocity"):
        assert modal.summary[name] == pytest.approx(auto.summary[name], rel=effect.threshold), name


def test_modes_sum_to_the_static_compliance():
    geometry = {"size": ["150 mm", "100 mm"], "position": ["50 mm", "30 mm"]}
    for target in (OLSSON.target, fm.Plate(STEEL, "4 mm", **geometry, theory="kirchhoff")):
        for highest, part in ((1e5, 0.05), (1e6, 0.005), (1e7, 0.0005)):
            assert 0.0 < 1 - target.modes(highest).compliance / target.compliance < part
    beam = fm.Beam(STEEL, "200 mm", "20 mm", "5 mm", position="80 mm")
    assert beam.modes(1e9).compliance == pytest.approx(beam.compliance, rel=1e-6)
    stiffness = (10.0, 3.0, 10.0, 3.5)
    square = plate_modes(2.0, stiffness, (0.5, 0.5), (0.25, 0.25), 1e5)
    assert square.frequency[0] == pytest.approx(2 * math.pi**2 / 0.5**2 * math.sqrt(10 / 2), rel=1e-14)
    assert square.frequency[1] == pytest.approx(
        5 * square.frequency[0], rel=1e-14
    )  # mode (1, 3): modes with an even number have a node at the centre
    assert square.share[0] == pytest.approx(4 / (2.0 * 0.5**2), rel=1e-14)
    assert (np.diff(square.frequency) >= 0).all() and square.frequency[-1] <= 1e5


# ---------------------------------------------------------------- what is chosen


def _effects(scene):
    return {effect.name: effect for effect in choose(scene).effects}


def test_the_vibration_indicator_decides():
    chosen = _effects(OLSSON)["boundary_reflections"]
    assert (chosen.indicator, chosen.state) == ("t_c/t_return", "simulated")
    returns = 0.02 * 0.2**2 * math.sqrt(4.132 / 154.9)
    assert OLSSON.target.return_time == pytest.approx(returns, rel=1e-3)
    assert chosen.value > chosen.threshold and chosen.change > 0.01
    assert problem_of(OLSSON).vibrates
    large = _effects(OLSSON.replace({"target.size": ["500 mm", "500 mm"]}))["boundary_reflections"]
    assert large.state == "not needed" and large.value == pytest.approx(chosen.value / 6.25, rel=1e-6)
    endless = _effects(OLSSON.replace({"target.size": None}))["boundary_reflections"]
    assert endless.state == "not judged" and endless.reason == "missing: target.size"
    off = _effects(OLSSON.replace({"effects.boundary_reflections": False}))["boundary_reflections"]
    assert off.state == "needed but not modelled" and off.value == chosen.value
    still = problem_of(OLSSON.replace({"effects.target_motion": False}))
    assert not still.vibrates and still.gamma == still.curve.native.compliance == 0.0
    given = choose(OLSSON.replace({"target.static_stiffness": "1e5 N/m"}))
    assert not given.problem.vibrates and given.problem.curve.native.compliance > 0.0
    assert {e.name: e.state for e in given.effects}["target_inertia"] == "needed but not modelled"
    hanging = choose(OLSSON.replace({"target.static_stiffness": "1e5 N/m", "target.size": None}))
    assert hanging.problem.curve.native.compliance == given.problem.curve.native.compliance
    assert {e.name: e.state for e in hanging.effects}["target_inertia"] == "not judged"
    assert _effects(fm.Scene.from_toml(SCENES / "two_steel_balls.toml"))["boundary_reflections"].state == "not needed"


def test_clamped_plates_vibrate():
    light = OLSSON.replace({"target.edges": "clamped"})
    assert _effects(light)["boundary_reflections"].state == _effects(light)["target_inertia"].state == "simulated"
    assert problem_of(light).vibrates
    heavy = light.replace({"impactor.mass": "2 kg", "effects.target_inertia": False})
    summary = fm.simulate(heavy).summary
    softer = fm.simulate(heavy.replace({"target.edges": "simply supported"})).summary
    assert summary["maximum_force"] > 1.3 * softer["maximum_force"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"target.size": None, "effects.boundary_reflections": True}, "but the plate has no size"),
        (
            {"target.edges": "free", "effects.target_inertia": False, "effects.boundary_reflections": True},
            "target_inertia is false, but nothing holds the plate",
        ),
        (
            {"target.static_stiffness": "1 N/m", "effects.target_inertia": True},
            "a given static stiffness does not determine the vibrations",
        ),
    ],
)
def test_unsupported_switches_are_refused(changes, message):
    with pytest.raises(fm.SimulationError, match=message):
        fm.simulate(OLSSON.replace(changes))


def test_too_many_modes_give_a_warning():
    wide = OLSSON.replace({"target.size": ["200 m", "200 m"], "effects.boundary_reflections": True})
    with pytest.raises(fm.SimulationError, match="natural vibrations would be needed"):
        fm.simulate(wide)


def test_a_beam_without_ends_is_refused():
    beam = fm.Beam(STEEL, "1 m", "20 mm", "10 mm")
    with pytest.raises(fm.SimulationError, match="an infinite beam has no impedance"):
        fm.simulate(fm.Scene(_ball(), beam, effects=fm.Effects(boundary_reflections=False)))


def test_an_infinite_plate_can_be_stepped():
    infinite = OLSSON.replace({"effects.boundary_reflections": False})
    assert fm.ImpactComponent(infinite).phase == "approaching"


def _on_a_beam(**options):
    beam = fm.Beam(STEEL, "80 mm", "20 mm", "8 mm")
    return fm.simulate(fm.Scene(_ball(), beam, fm.Contact("hertz")), **options)


@pytest.mark.slow
def test_unreachable_accuracy_does_not_worsen_the_result(monkeypatch):
    """The tolerance of a step is at least rounding: otherwise the steps would use up the work limit."""
    monkeypatch.setattr(modal, "MOST_WORK", modal.MOST_WORK // 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", fm.ImpactWarning)
        found = {accuracy: _on_a_beam(accuracy=accuracy) for accuracy in (1e-8, 1e-13)}
    assert any("accuracy 1e-13 is not reached" in warning for warning in found[1e-13].warnings)
    assert found[1e-13].accuracy.estimated < 30.0 * found[1e-8].accuracy.estimated


@pytest.mark.parametrize("options", [{"segments": 2}, {"linearisation": "chord"}])
def test_unused_options_of_the_march_give_a_warning(options):
    assert any("segments and linearisation are not used" in warning for warning in _on_a_beam(**options).warnings)


# ---------------------------------------------------------------- scenes, and what a history is for


@pytest.mark.parametrize(
    ("target", "message"),
    [
        (lambda: fm.Plate(STEEL, "1 mm", position=["1 mm", "1 mm"]), "position: needs a size"),
        (lambda: fm.Plate(STEEL, "1 mm", edges="clamped"), "edges: needs a size"),
        (lambda: fm.Plate(STEEL, "1 mm", size=["1 m", "1 m"], position=["0 m", "1 mm"]), "0 m must be > 0 m and < 1 m"),
        (lambda: fm.Plate(STEEL, "1 mm", size=["1 m", "1 m"], position=["1 mm", "2 m"]), "2 m must be > 0 m and < 1 m"),
        (lambda: fm.Plate(STEEL, "1 mm", size=["1 m", "1 m"], edges="loose"), "edges: "),
        (lambda: fm.Plate(STEEL, "1 mm", static_stiffness="1 N"), "static_stiffness: "),
        (lambda: fm.Beam(STEEL, "1 m", "1 cm", "1 cm", position="1 m"), "a support does not deflect"),
        (lambda: fm.Beam(STEEL, "1 m", "1 cm"), "thickness: missing"),
        (lambda: fm.Beam(STEEL, "1 m", "1 cm", "1 cm", ends="loose"), "ends: "),
    ],
)
def test_impossible_geometry(target, message):
    with pytest.raises(fm.SceneError, match=message):
        target()


def test_scene_files():
    text = """
[impactor]
radius = "5 mm"
velocity = "1 m/s"
material = "mild steel"

[target]
kind = "beam"
material = "mild steel"
length = "300 mm"
width = "20 mm"
thickness = "5 mm"
ends = "cantilever"
position = "300 mm"

[effects]
boundary_reflections = true
target_inertia = "auto"
"""
    scene = fm.Scene.from_text(text)
    assert fm.Scene.from_text(scene.to_toml()) == scene
    assert scene.effects.boundary_reflections is True
    plate = OLSSON.replace({"target.position": ["50 mm", "60 mm"], "target.static_stiffness": "10 N/mm"})
    assert fm.Scene.from_text(plate.to_toml()) == plate
    with pytest.raises(fm.SceneError, match=r"target\.position: 0.4 m must be > 0 m and <= 0.3 m"):
        scene.replace({"target.position": "400 mm"})


@pytest.mark.slow
def test_a_modal_history_supports_every_operation(history, tmp_path):
    table = json.loads(json.dumps(history.to_dict(), allow_nan=False))
    assert table["accuracy"]["modes"] == history.accuracy.modes > 0
    assert [event["name"] for event in table["events"]] == [event.name for event in history.events]
    assert history.sample("20 us").contact_force.to("N").magnitude > 200.0
    ds = fd.to_dataset(history)
    assert fd.validate(ds) == []
    assert ds.sizes["segment"] == 0 and "modes of the target" in ds.attrs["source"]
    assert float(ds["maximum_force"]) == history.summary["maximum_force"]
    back = fd.read(fd.write(ds, tmp_path / "impact.nc"))
    assert fd.validate(back) == [] and back["event_time"].values.tolist() == ds["event_time"].values.tolist()
    later = history.sample_si(3 * history.duration)
    assert later.impactor_velocity == pytest.approx(history.summary["rebound_velocity"], rel=1e-12)
    again = fm.simulate(OLSSON, accuracy=1e-3)
    assert again.summary == history.summary
    with pytest.raises(ValueError, match="not before first touch"):
        history.sample_si(-1e-6)


@pytest.mark.slow
def test_picture(history, tmp_path):
    plot = pytest.importorskip("film_model.plot.history")
    pytest.importorskip("matplotlib")
    plot.plot_history(history, tmp_path / "impact.png")
    assert (tmp_path / "impact.png").stat().st_size > 10_000


# ---------------------------------------------------------------- many impacts


@pytest.mark.slow
def test_vibrating_rows_are_those_of_simulate():
    """Light and slow impactors are on an infinite plate, as in `simulate`; the others on its modes."""
    masses = np.geomspace(0.5e-3, 16e-3, 40)
    result = simulate_many(OLSSON, {"impactor.mass": masses}, fm.Solver(accuracy=1e-3))
    assert {STATUSES[code][0] for code in result.status.tolist()} == {"separated"}
    assert 5 < np.count_nonzero(result.segments[:, 0] == 0) < 35 and 0.0 < np.nanmax(result.estimated) < 1e-3
    for row in (3, 20, 39):
        one = fm.simulate(OLSSON.replace({"impactor.mass": f"{float(masses[row])!r} kg"}), accuracy=1e-4)
        assert (one.vibration is None) == (result.segments[row, 0] > 0)
        for name in ("maximum_force", "contact_duration", "rebound_velocity"):
            assert result.summary[name][row] == pytest.approx(one.summary[name], rel=1e-3), name


def test_a_batch_on_one_structure():
    """Many velocities on one structure share its tables; loads are decided for each as in `simulate`."""
    speeds = np.geomspace(0.02, 2.0, 40)
    beam = fm.Beam(STEEL, "150 mm", "20 mm", "5 mm", position="60 mm")
    scene = fm.Scene(_ball(), beam, fm.Contact("hertz"))
    result = fm.simulate_batch(scene, velocity=[f"{speed!r} m/s" for speed in speeds.tolist()], accuracy=1e-3)
    assert not result.failed.any() and 0.0 < result.estimated <= 1e-3
    few = fm.simulate_batch(scene, velocity=["0.5 m/s", "1 m/s"], accuracy=1e-3)
    for many in (result, few):
        assert (many.summary["energy_absorbed"] == 0.0).all()
    for row in (0, 17, 39):
        one = fm.simulate(scene.replace({"impactor.velocity": f"{float(speeds[row])!r} m/s"}), accuracy=1e-5).summary
        for name, value in one.items():
            expected = math.nan if value is None else value
            assert result.summary[name][row] == pytest.approx(expected, rel=2e-3, abs=1e-9, nan_ok=True), name


def test_rows_whose_edges_do_not_matter_use_arrays():
    count = 5000
    masses = np.geomspace(0.2e-3, 1e-3, count)
    whole, *others = problems_of(OLSSON, {"impactor.mass": masses}, count)
    assert whole.impacts.index.size == count and not others
    wide = problems_of(OLSSON.replace({"effects.boundary_reflections": False}), {"impactor.mass": masses}, count)
    assert bytes(whole.start) == bytes(wide[0].start)


@pytest.mark.parametrize("kind", ["beam", "plate", "given"])
def test_rows_on_static_stiffnesses(kind):
    beam, plate = fm.Beam(STEEL, "300 mm", "20 mm", "8 mm"), fm.Plate(STEEL, "8 mm", size=["200 mm", "200 mm"])
    given = fm.Plate(STEEL, "8 mm", static_stiffness="3 kN/mm")
    target = {"beam": beam, "plate": plate, "given": given}[kind]
    ball = fm.Sphere("10 mm", "1 m/s", mass="5 kg")
    contact = fm.Contact("hertz", effective_modulus="1 GPa")
    effects = fm.Effects(gravity=False, target_inertia=False, boundary_reflections=True)
    scene = fm.Scene(ball, target, contact, effects)
    speeds = np.array([0.5, 1.0, 2.0])
    result = simulate_many(scene, {"impactor.velocity": speeds})
    for row, speed in enumerate(speeds.tolist()):
        one = fm.simulate(scene.replace({"impactor.velocity": f"{speed!r} m/s"}), accuracy=1e-8)
        for name in ("maximum_force", "maximum_indentation", "contact_duration", "rebound_velocity"):
            assert result.summary[name][row] == pytest.approx(one.summary[name], rel=1e-4), name
        energy = one.summary["maximum_force"] ** 2 * target.compliance / 2
        assert 0.1 * one.scene.kinetic_energy < energy < one.scene.kinetic_energy


def test_sweeps_of_plates_with_edges(tmp_path):
    static = OLSSON.replace({"effects.target_inertia": False, "impactor.mass": "2 kg"})
    ds = fd.sweep(static, {"impactor.velocity": ["1 m/s", "2 m/s"]}, keep="segments")
    assert fd.validate(ds) == []
    for k, speed in enumerate((1.0, 2.0)):
        one = fm.simulate(static.replace({"impactor.velocity": f"{speed} m/s"}), accuracy=1e-8)
        times = np.linspace(0.0, one.duration, 7)
        motion = ds.film.sample(times, impactor_velocity=speed)
        exact = one.sample_si(times)
        np.testing.assert_allclose(
            motion["target_displacement"], exact.target_displacement, atol=1e-3 * exact.target_displacement.max()
        )
        assert float(ds["target_compliance"][k]) == one.problem.curve.native.compliance
    plates = {"target.size": [["200 mm", "200 mm"], ["2 m", "2 m"]], "impactor.velocity": ["2 m/s", "3 m/s"]}
    mixed = fd.sweep(OLSSON.replace({"solver.accuracy": 1e-2}), plates)  # the small plate vibrates, not the large one
    assert fd.validate(mixed) == []
    assert [STATUSES[code][0] for code in mixed["status"].values.ravel().tolist()] == ["separated"] * 4
    small, large = mixed["contact_duration"].values
    assert (small < 0.95 * large).all() and (mixed["maximum_force"].values > 100.0).all()


@pytest.mark.slow
def test_a_vibrating_history_is_drawn_from_its_file(history, tmp_path):
    pytest.importorskip("matplotlib")
    path = fd.write(fd.to_dataset(history), tmp_path / "impact.nc")
    ds = fd.open(path)
    assert ds.film.sample(["20 us"])["contact_force"].item() == history.sample_si([20e-6]).contact_force[0]
    assert main(["plot", str(path), "--output", str(tmp_path / "impact.png")]) == 0
    assert (tmp_path / "impact.png").stat().st_size > 10_000


# ---------------------------------------------------------------- what a user sees


@pytest.mark.slow
def test_commands_on_scenes_with_edges(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(OLSSON.to_toml(), encoding="utf-8")
    assert main(["explain", str(path), "--plot", str(tmp_path / "map.png")]) == 0
    assert "boundary reflections" in capsys.readouterr().out
    assert main(["export-fmu", str(path), "--output", str(tmp_path / "impact.fmu")]) == 0
    beam = fm.Scene(_ball(), fm.Beam(STEEL, "300 mm", "20 mm", "8 mm"), fm.Contact("hertz"))
    path.write_text(beam.to_toml(), encoding="utf-8")
    assert main(["explain", str(path)]) == 0
    assert "a beam has no wave impedance" in capsys.readouterr().out
    assert main(["explain", str(path), "--plot", str(tmp_path / "beam.png")]) == 3
    assert "a beam has no place on a map of regimes" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("target", "contact", "word"),
    [
        (fm.Beam(STEEL, "300 mm", "20 mm", "8 mm", static_stiffness="1 kN/mm"), fm.Contact("hertz"), "target inertia"),
        (
            fm.Plate(STEEL, "4 mm", size=["150 mm", "150 mm"], static_stiffness="1 kN/mm"),
            fm.Contact("hertz"),
            "target inertia",
        ),
    ],
)
def test_unmodelled_effects_are_warnings_in_every_output(target, contact, word, tmp_path, capsys):
    scene = fm.Scene(fm.Sphere("10 mm", "1 m/s", material=STEEL), target, contact)
    path = tmp_path / "scene.toml"
    path.write_text(scene.to_toml(), encoding="utf-8")
    warnings = fm.simulate(scene).warnings
    warning = next(text for text in warnings if text.startswith(f"not modelled: {word}, which would change the "))
    for command in ("run", "explain"):
        assert main([command, str(path), "--json"]) == 0
        captured = capsys.readouterr()
        assert json.loads(captured.out)["warnings"] == list(warnings) and warning in captured.err
    assert main(["run", str(path), "--verbose", "--output", str(tmp_path / "impact.nc")]) == 0
    captured = capsys.readouterr()
    assert f"{word}: needed but not modelled" in captured.out and warning in captured.err
    assert fd.open(tmp_path / "impact.nc").attrs["warnings"] == "\n".join(warnings)


def test_a_damped_law_needs_known_vibrations():
    """A static stiffness cannot be in series with a damped law: the plate vibrates, or the scene is refused."""
    scene = OLSSON.replace({"contact": {"law": "tsuji", "restitution": 0.8, "effective_modulus": "9.72 GPa"}})
    history = fm.simulate(scene, accuracy=1e-2)
    assert history.vibration is not None and 0.9 < history.summary["maximum_force"] / 303.2 < 1.1
    with pytest.raises(fm.SimulationError, match="a damped law cannot be simulated on a plate with edges"):
        fm.simulate(scene.replace({"effects.target_inertia": False, "effects.boundary_reflections": True}))


@pytest.mark.slow
@pytest.mark.parametrize("ends", ["simply supported", "free"])
def test_a_target_without_a_static_trial_still_moves(ends):
    """Damped laws, and beams that nothing holds, have no trial on a static stiffness: the vibrations are simulated."""
    beam = fm.Beam("mild steel", length="200 mm", width="10 mm", thickness="5 mm", ends=ends)
    ball = fm.Sphere("5 mm", "1 m/s", material="mild steel")
    for contact, most in ((fm.Contact("tsuji", restitution=0.7), 0.3), (fm.Contact("hertz"), 0.45)):
        history = fm.simulate(fm.Scene(ball, beam, contact), accuracy=1e-2)
        (motion,) = (effect for effect in history.effects if effect.name == "target_motion")
        assert motion.state == "simulated" and history.summary["coefficient_of_restitution"] < most


def test_passing_the_end_of_a_law_on_a_vibrating_target_is_an_error():
    law = fm.Tabulated((0.0, 1e-6), (0.0, 1.0))
    plate = fm.Plate("mild steel", thickness="2 mm", size=["100 mm", "100 mm"])
    effects = fm.Effects(boundary_reflections=True, target_inertia=True)
    ball = fm.Sphere("10 mm", velocity="2 m/s", material="mild steel")
    with pytest.raises(
        fm.SimulationError, match="law tabulated: the indentation passed the end of the law's last stage"
    ):
        fm.simulate(fm.Scene(ball, plate, fm.Contact(law, unloading="retrace"), effects))


def test_reflections_need_edges():
    assert fm.Plate("mild steel", thickness="2 mm").return_time == math.inf
