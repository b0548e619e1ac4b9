"""Plates and beams with edges: when they are simulated, and whether the motion is right."""

import json
import math
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
from cases import BALL, LAWS, STEEL

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_model import reference, targets, vibration
from film_model.batch import STATUSES, simulate_rows
from film_model.cli import main
from film_model.problem import problem_of
from film_model.rows import VIBRATES, rows_of

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


def test_a_vibrating_history_is_pickled(history):
    again = pickle.loads(pickle.dumps(history))
    assert len(history.vibration.spans) > 1 and again == history
    times = np.linspace(0.0, 2.0 * history.duration, 101)
    assert np.array_equal(again.sample_si(times).contact_force, history.sample_si(times).contact_force)
    assert np.array_equal(again.sample_si(times).target_velocity, history.sample_si(times).target_velocity)


def _ball(velocity="0.25 m/s", **ball):
    return fm.Sphere(velocity=velocity, **{**BALL, **ball})


# ---------------------------------------------------------------- the paper's plate


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-4])
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
    assert any("contact is lost after 0.0001953 s and comes back" in warning for warning in history.warnings)
    between = np.linspace(history.events[3].time, history.events[4].time, 50)
    apart = history.sample_si(between)
    assert set(apart.stage.tolist()[1:-1]) == {""} and not apart.contact_force[1:-1].any()
    assert (apart.indentation[1:-1] < 0.0).all()
    assert np.ptp(apart.impactor_velocity) < 1e-12


def test_more_modes_converge():
    """Twice the highest frequency, twice the modes: the peak force's error falls with their square or faster."""
    problem, plate = problem_of(OLSSON), OLSSON.target
    unit = problem.scales.force / problem.scales.length
    errors = []
    for highest in (3e5, 1.2e6):
        modes = plate.modes(highest)
        rest = (plate.compliance - modes.compliance) * unit
        frequency, share = modes.frequency * problem.scales.time, modes.share * problem.mass
        run = vibration._integrate(problem, frequency, share, rest, 1.0, 300e-6 / problem.scales.time, 1e-6)
        errors.append(abs(run.summary.maximum_force * problem.scales.force / CONVERGED["maximum_force"] - 1))
        bare = vibration._integrate(problem, frequency, share, 0.0, 1.0, 300e-6 / problem.scales.time, 1e-6)
        assert abs(bare.summary.maximum_force * problem.scales.force / CONVERGED["maximum_force"] - 1) > 3 * errors[-1]
    assert modes.frequency.size > 3 * plate.modes(3e5).frequency.size
    assert errors[1] < errors[0] / 16


# ---------------------------------------------------------------- an integrator of its own


def _propagate(scene, highest, end, steps):
    """Force at even times: modes exactly, for a force that is straight within a step; the law met at its end."""
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
        (OLSSON.target, 1.2e6),
        (fm.Plate(STEEL, "4 mm", size=["150 mm", "100 mm"], position=["50 mm", "30 mm"]), 2e6),
        (fm.Beam(STEEL, "200 mm", "20 mm", "5 mm", position="80 mm"), 1e6),
    ],
)
def test_against_an_exact_propagation_of_the_modes(target, highest):
    contact = fm.Contact("hertz", effective_modulus="9.72 GPa")
    effects = fm.Effects(gravity=False, boundary_reflections=True)
    scene = fm.Scene(OLSSON.impactor, target, contact, effects)
    problem = problem_of(scene)
    modes = target.modes(highest)
    rest = (target.compliance - modes.compliance) * problem.scales.force / problem.scales.length
    frequency, share = modes.frequency * problem.scales.time, modes.share * problem.mass
    end = 600e-6
    limit = end / problem.scales.time
    run = vibration._integrate(problem, frequency, share, rest, 1.0, limit, 1e-8)
    coarse, fine = (_propagate(scene, highest, end, steps) for steps in (6000, 12000))
    times = np.linspace(0.0, limit, 6001)
    values, _ = run.sample(times)
    forces = (4 * fine[0][::2] - coarse[0]) / 3
    assert np.abs(values[:, 2] * problem.scales.force - forces).max() < 2e-4 * forces.max()
    assert np.abs(values[:, 2] * problem.scales.force - forces).mean() < 2e-6 * forces.max()
    assert values[-1, 3] * problem.scales.velocity == pytest.approx(fine[1][-1], abs=1e-5)


# ---------------------------------------------------------------- balances


@pytest.mark.parametrize(
    "law", ["hertz", "big-alabo", "stronge", "saturating", "yigit-christoforou", "tan-sun", "walton-braun", "tabulated"]
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


@pytest.mark.parametrize("law", ["tan-sun", "walton-braun", "jackson-green"])
def test_energy_where_the_force_oscillates(law):
    """A heavy impactor, under which the plate swings: the contact opens and closes many times, on all branches."""
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
def test_force_is_the_laws(law, history):
    """On the way in the force is the law's own at the indentation; at events, samples are the events."""
    model = LAWS[law]
    plate = fm.Plate(STEEL, "8 mm", size=["150 mm", "150 mm"])
    scene = fm.Scene(_ball(), plate, fm.Contact(law=model), fm.Effects(boundary_reflections=True))
    got = fm.simulate(scene, accuracy=1e-2)
    top = next(event for event in got.events if event.name == "maximum_indentation")
    samples = got.sample_si(np.linspace(0.0, top.time, 40)[1:])
    length, force = model.scales(scene.kinetic_energy)
    for depth, found in zip(samples.indentation, samples.contact_force, strict=True):
        stage = next(s for s in reversed(model.stages()) if s.begin <= depth / length)
        assert found == pytest.approx(force * float(reference.value(stage.force, depth / length, stage)), rel=1e-9)
    for event in got.events:
        at = got.sample_si(event.time)
        assert at.indentation == pytest.approx(event.indentation, rel=1e-6, abs=1e-12)
        assert at.impactor_velocity == pytest.approx(event.impactor_velocity, rel=1e-9)


# ---------------------------------------------------------------- limits


def test_a_wide_plate_is_infinite():
    scene = OLSSON.replace({"impactor.mass": "2 g", "target.size": ["150 mm", "150 mm"]})
    near = fm.simulate(scene.replace({"effects.boundary_reflections": True}), accuracy=1e-3).summary
    wide = fm.simulate(scene).summary
    assert fm.simulate(scene).vibration is None
    for name in ("maximum_force", "maximum_indentation", "time_impactor_stops"):
        assert near[name] == pytest.approx(wide[name], rel=2e-3), name
    assert near["contact_duration"] == pytest.approx(wide["contact_duration"], rel=1e-2)


@pytest.mark.parametrize("kind", ["plate", "beam"])
def test_a_soft_contact_finds_the_static_stiffness(kind):
    """Where the vibration indicator is below its threshold, modes and static stiffness agree within it."""
    beam = fm.Beam(STEEL, "300 mm", "20 mm", "8 mm")
    target = beam if kind == "beam" else fm.Plate(STEEL, "8 mm", size=["200 mm", "200 mm"])
    contact = fm.Contact("hertz", effective_modulus="0.5 MPa" if kind == "beam" else "0.2 GPa")
    ball = fm.Sphere("10 mm", "1 m/s", mass="5 kg")
    quiet = {"gravity": False, "boundary_reflections": True}
    auto = fm.simulate(fm.Scene(ball, target, contact, fm.Effects(**quiet)))
    effect = next(e for e in auto.problem.effects if e.name == "target_inertia")
    assert auto.vibration is None and effect.state == "not needed" and 0.001 < effect.value < effect.threshold
    modal = fm.simulate(fm.Scene(ball, target, contact, fm.Effects(**quiet, target_inertia=True)), accuracy=1e-2)
    assert modal.accuracy.modes > 0
    for name in ("maximum_force", "maximum_indentation", "contact_duration", "rebound_velocity"):
        assert modal.summary[name] == pytest.approx(auto.summary[name], rel=effect.threshold), name


def test_modes_and_static_compliance_belong_together():
    for target in (OLSSON.target, fm.Plate(STEEL, "4 mm", size=["150 mm", "100 mm"], position=["50 mm", "30 mm"])):
        for highest, part in ((1e5, 0.05), (1e6, 0.005), (1e7, 0.0005)):
            assert 0.0 < 1 - target.modes(highest).compliance / target.compliance < part
    beam = fm.Beam(STEEL, "200 mm", "20 mm", "5 mm", position="80 mm")
    assert beam.modes(1e9).compliance == pytest.approx(beam.compliance, rel=1e-6)
    stiffness = (10.0, 3.0, 10.0, 3.5)
    square = targets.plate_modes(2.0, stiffness, (0.5, 0.5), (0.25, 0.25), 1e5)
    assert square.frequency[0] == pytest.approx(2 * math.pi**2 / 0.5**2 * math.sqrt(10 / 2), rel=1e-14)
    assert square.frequency[1] == pytest.approx(
        5 * square.frequency[0], rel=1e-14
    )  # (1, 3): even ones have a node there
    assert square.share[0] == pytest.approx(4 / (2.0 * 0.5**2), rel=1e-14)
    assert (np.diff(square.frequency) >= 0).all() and square.frequency[-1] <= 1e5


# ---------------------------------------------------------------- what is chosen


def _effects(scene):
    return {effect.name: effect for effect in problem_of(scene).effects}


def test_the_criterion_decides():
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
    assert off.state == "switched off" and off.value == chosen.value
    still = problem_of(OLSSON.replace({"effects.target_motion": False}))
    assert not still.vibrates and still.gamma == still.curve.native.compliance == 0.0
    given = problem_of(OLSSON.replace({"target.static_stiffness": "1e5 N/m"}))
    assert not given.vibrates and given.curve.native.compliance > 0.0
    assert {e.name: e.state for e in given.effects}["target_inertia"] == "needed but not modelled"
    hanging = problem_of(OLSSON.replace({"target.static_stiffness": "1e5 N/m", "target.size": None}))
    assert hanging.curve.native.compliance == given.curve.native.compliance
    assert {e.name: e.state for e in hanging.effects}["target_inertia"] == "not judged"
    assert _effects(fm.Scene.from_toml(SCENES / "two_steel_balls.toml"))["boundary_reflections"].state == "not needed"


def test_clamped_plates():
    light = OLSSON.replace({"target.edges": "clamped"})
    assert _effects(light)["boundary_reflections"].state == "needed but not modelled"
    assert problem_of(light).gamma > 0.0
    heavy = light.replace({"impactor.mass": "2 kg"})
    assert _effects(heavy)["boundary_reflections"].state == "simulated"
    assert _effects(heavy)["target_inertia"].state == "needed but not modelled"
    summary = fm.simulate(heavy).summary
    softer = fm.simulate(heavy.replace({"target.edges": "simply supported", "effects.target_inertia": False})).summary
    assert summary["maximum_force"] > 1.3 * softer["maximum_force"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"target.size": None, "effects.boundary_reflections": True}, "but the plate has no size"),
        ({"target.edges": "clamped", "effects.boundary_reflections": True}, "clamped plate are not known"),
        (
            {"target.edges": "clamped", "effects.target_inertia": True},
            r"target_inertia is true, but .* clamped plate are not known",
        ),
        (
            {"target.static_stiffness": "1 N/m", "effects.target_inertia": True},
            "a given static stiffness says nothing about vibrations",
        ),
    ],
)
def test_what_cannot_be_had_is_refused(changes, message):
    with pytest.raises(fm.SimulationError, match=message):
        fm.simulate(OLSSON.replace(changes))


def test_more_modes_than_there_is_room_for():
    wide = OLSSON.replace({"target.size": ["200 m", "200 m"], "effects.boundary_reflections": True})
    with pytest.raises(fm.SimulationError, match="target has no edges"):
        fm.simulate(wide)


def test_a_beam_without_ends_is_refused():
    beam = fm.Beam(STEEL, "1 m", "20 mm", "10 mm")
    with pytest.raises(fm.SimulationError, match="a beam without ends has no impedance"):
        fm.simulate(fm.Scene(_ball(), beam, effects=fm.Effects(boundary_reflections=False)))


def test_what_cannot_work_on_a_vibrating_target_says_so(tmp_path):
    with pytest.raises(fm.SimulationError, match=r"an ImpactComponent is not to be had for a target that vibrates"):
        fm.ImpactComponent(OLSSON)
    with pytest.raises(fm.SimulationError, match=r"a batch is not .* boundary_reflections = false in \[effects\]"):
        fm.simulate_batch(OLSSON, velocity=["1 m/s"])
    with pytest.raises(fm.SimulationError, match="an FMU is not to be had for a target that vibrates"):
        fmu_wrapper.export(OLSSON, tmp_path / "impact.fmu")
    static = OLSSON.replace({"effects.target_inertia": False})
    with pytest.raises(fm.SimulationError, match="an FMU is not to be had for a target of a static stiffness"):
        fmu_wrapper.export(static, tmp_path / "impact.fmu")
    infinite = OLSSON.replace({"effects.boundary_reflections": False})
    assert fm.ImpactComponent(infinite).phase == "approaching"


def _on_a_beam(**options):
    beam = fm.Beam(STEEL, "80 mm", "20 mm", "8 mm")
    return fm.simulate(fm.Scene(_ball(), beam, fm.Contact("hertz")), **options)


def test_more_accuracy_than_can_be_had_costs_none(monkeypatch):
    """The integrator asks no more of a step than rounding leaves, or its work leaves none for modes."""
    monkeypatch.setattr(vibration, "MOST_WORK", vibration.MOST_WORK // 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of scipy, about a tolerance too small
        found = {accuracy: _on_a_beam(accuracy=accuracy) for accuracy in (1e-8, 1e-13)}
    assert any("accuracy 1e-13 cannot be had" in warning for warning in found[1e-13].warnings)
    assert found[1e-13].accuracy.estimated < 30.0 * found[1e-8].accuracy.estimated


@pytest.mark.parametrize("options", [{"segments": 2}, {"linearisation": "chord"}])
def test_options_of_the_march_are_not_dropped_in_silence(options):
    assert any("segments and linearisation are not used" in warning for warning in _on_a_beam(**options).warnings)


# ---------------------------------------------------------------- scenes, and what a history is for


@pytest.mark.parametrize(
    ("target", "message"),
    [
        (lambda: fm.Plate(STEEL, "1 mm", position=["1 mm", "1 mm"]), "position: needs a size"),
        (lambda: fm.Plate(STEEL, "1 mm", edges="clamped"), "edges: needs a size"),
        (lambda: fm.Plate(STEEL, "1 mm", size=["1 m", "1 m"], position=["0 m", "1 mm"]), "0 m must be > 0 m and < 1 m"),
        (lambda: fm.Plate(STEEL, "1 mm", size=["1 m", "1 m"], position=["1 mm", "2 m"]), "2 m must be > 0 m and < 1 m"),
        (lambda: fm.Plate(STEEL, "1 mm", size=["1 m", "1 m"], edges="free"), "edges: "),
        (lambda: fm.Plate(STEEL, "1 mm", static_stiffness="1 N"), "static_stiffness: "),
        (lambda: fm.Beam(STEEL, "1 m", "1 cm", "1 cm", position="1 m"), "nothing gives way on a support"),
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


def test_history_like_any_other(history, tmp_path):
    table = json.loads(json.dumps(history.to_json(), allow_nan=False))
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


def test_picture(history, tmp_path):
    plot = pytest.importorskip("film_model.plot")
    pytest.importorskip("matplotlib")
    plot.plot_history(history, tmp_path / "impact.png")
    assert (tmp_path / "impact.png").stat().st_size > 10_000


# ---------------------------------------------------------------- many impacts


def test_rows_that_vibrate_say_so_and_harm_no_other():
    """The light and slow are on an infinite plate, as one by one; the others wait for `simulate`."""
    masses = np.geomspace(0.5e-3, 16e-3, 40)
    result = simulate_rows(OLSSON, {"impactor.mass": masses})
    for row, mass in enumerate(masses.tolist()):
        problem = problem_of(OLSSON.replace({"impactor.mass": f"{mass!r} kg"}))
        assert STATUSES[int(result.status[row])][0] == ("vibrates" if problem.vibrates else "separated"), mass
    assert 5 < np.count_nonzero(result.status == VIBRATES) < 35
    one = fm.simulate(OLSSON.replace({"impactor.mass": f"{float(masses[3])!r} kg"}), accuracy=1e-7)
    assert result.summary["maximum_force"][3] == pytest.approx(one.summary["maximum_force"], rel=1e-4)
    assert np.isnan(result.summary["maximum_force"][-1])


def test_most_rows_without_edges_are_arrays():
    count = 5000
    masses = np.geomspace(0.2e-3, 1e-3, count)
    whole, *others = rows_of(OLSSON, {"impactor.mass": masses}, count)
    assert whole.index.size == count and not others
    wide = rows_of(OLSSON.replace({"effects.boundary_reflections": False}), {"impactor.mass": masses}, count)
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
    result = simulate_rows(scene, {"impactor.velocity": speeds})
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
    mixed = fd.sweep(OLSSON, plates)  # some whole cases vibrate, others do not
    assert fd.validate(mixed) == []
    assert [STATUSES[code][0] for code in mixed["status"].values.ravel().tolist()] == ["vibrates"] * 2 + [
        "separated"
    ] * 2
    assert np.isnan(mixed["maximum_force"].values[0]).all() and (mixed["maximum_force"].values[1] > 100.0).all()


def test_a_vibrating_history_is_drawn_from_its_file(history, tmp_path):
    pytest.importorskip("matplotlib")
    path = fd.write(fd.to_dataset(history), tmp_path / "impact.nc")
    ds = fd.open(path)
    assert ds.film.sample(["20 us"])["contact_force"].item() == history.sample_si([20e-6]).contact_force[0]
    assert main(["plot", str(path), "--output", str(tmp_path / "impact.png")]) == 0
    assert (tmp_path / "impact.png").stat().st_size > 10_000


# ---------------------------------------------------------------- what a user sees


def test_commands_on_scenes_with_edges(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(OLSSON.to_toml(), encoding="utf-8")
    assert main(["explain", str(path), "--plot", str(tmp_path / "map.png")]) == 0
    assert "boundary reflections" in capsys.readouterr().out
    assert main(["export-fmu", str(path), "--output", str(tmp_path / "impact.fmu")]) == 3
    assert "an FMU is not to be had for a target that vibrates" in capsys.readouterr().err
    assert main(["cost", str(path)]) == 3
    assert "a study is not to be had for a target that vibrates" in capsys.readouterr().err
    assert not (tmp_path / "impact.fmu").exists()
    beam = fm.Scene(_ball(), fm.Beam(STEEL, "300 mm", "20 mm", "8 mm"), fm.Contact("hertz"))
    path.write_text(beam.to_toml(), encoding="utf-8")
    assert main(["explain", str(path)]) == 0
    assert "an endless beam has no impedance" in capsys.readouterr().out
    assert main(["explain", str(path), "--plot", str(tmp_path / "beam.png")]) == 3
    assert "a beam has no place on a map of regimes" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("target", "word"),
    [
        (fm.Beam(STEEL, "300 mm", "20 mm", "8 mm", ends="clamped"), "target inertia"),
        (fm.Plate(STEEL, "4 mm", size=["150 mm", "150 mm"], edges="clamped"), "boundary reflections"),
    ],
)
def test_what_is_not_modelled_is_a_warning_in_every_output(target, word, tmp_path, capsys):
    scene = fm.Scene(fm.Sphere("10 mm", "1 m/s", material=STEEL), target, fm.Contact("hertz"))
    path = tmp_path / "scene.toml"
    path.write_text(scene.to_toml(), encoding="utf-8")
    warnings = fm.simulate(scene).warnings
    warning = next(text for text in warnings if text.startswith(f"not modelled: {word}, which would change the "))
    for command in ("run", "explain"):
        assert main([command, str(path), "--json"]) == 0
        captured = capsys.readouterr()
        assert json.loads(captured.out)["warnings"] == list(warnings) and warning in captured.err
    assert main(["run", str(path), "--output", str(tmp_path / "impact.nc")]) == 0
    captured = capsys.readouterr()
    assert f"{word}: needed but not modelled" in captured.out and warning in captured.err
    assert fd.open(tmp_path / "impact.nc").attrs["warnings"] == "\n".join(warnings)


def test_a_damped_law_falls_back_to_an_infinite_plate_and_says_so():
    scene = OLSSON.replace({"contact": {"law": "tsuji", "restitution": 0.8, "effective_modulus": "9.72 GPa"}})
    history = fm.simulate(scene)
    (warning,) = history.warnings
    assert "not modelled: boundary reflections" in warning and "on an infinite plate only" in warning
    assert history.vibration is None and history.problem.gamma > 0.0
    for name in ("boundary_reflections", "target_inertia"):
        with pytest.raises(fm.SimulationError, match="a damped law cannot be simulated on a plate with edges"):
            fm.simulate(scene.replace({f"effects.{name}": True}))


def test_a_law_that_ends_cannot_stop_an_impactor_on_vibrations_either():
    law = fm.Tabulated((0.0, 1e-6), (0.0, 1.0))
    plate = fm.Plate("mild steel", thickness="2 mm", size=["100 mm", "100 mm"])
    effects = fm.Effects(boundary_reflections=True, target_inertia=True)
    ball = fm.Sphere("10 mm", velocity="2 m/s", material="mild steel")
    with pytest.raises(
        fm.SimulationError, match="law tabulated: the indentation passed the end of the law's last stage"
    ):
        fm.simulate(fm.Scene(ball, plate, fm.Contact(law, unloading="retrace"), effects))


def test_a_plate_without_edges_sends_no_wave_back():
    assert fm.Plate("mild steel", thickness="2 mm").return_time == math.inf
