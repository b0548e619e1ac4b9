"""The cost study: every method converges to the reference, and its sentences state measured values."""

import copy
import functools
import json
import math
from pathlib import Path

import numpy as np
import pytest
from cases import DAMPED, LAWS, combinations, scene

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main
from film_model.effects.choose import problem_of
from film_model.studies import (
    cost,
    fixed_steps,
    high_precision,
    impact_ode,
    integrators,
    methods,
    modal_methods,
    quadrature,
    reference,
    timing,
)

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
PAPER = ("tungsten_carbide_on_steel", "tungsten_carbide_on_steel_stronge", "olsson_plate")


REFERENCES = {}
"""What cost.reference has found, by scene."""


@pytest.fixture(autouse=True)
def short_studies(monkeypatch):
    """Timings of a millisecond, and the reference of a scene computed once for all tests."""
    compute = cost.reference

    def exact_once(on, problem):
        if on not in REFERENCES:
            REFERENCES[on] = compute(on, problem)
        return copy.deepcopy(REFERENCES[on])

    monkeypatch.setattr(cost, "reference", exact_once)
    monkeypatch.setattr(timing, "SHORTEST", 1e-5)
    monkeypatch.setattr(timing, "MOST_TIME", 1e-3)
    monkeypatch.setattr(methods, "BATCH", 32)


def paper(name):
    return fm.Scene.from_toml(SCENES / f"{name}.toml").replace({"effects.boundary_reflections": False})


METHODS = {
    "RK45": (lambda i: integrators.solve_ivp("RK45", 1e-9, i), 1e-6),
    "DOP853": (lambda i: integrators.solve_ivp("DOP853", 1e-9, i), 1e-6),
    "LSODA": (lambda i: integrators.solve_ivp("LSODA", 1e-9, i), 1e-6),
    "Radau": (lambda i: integrators.solve_ivp("Radau", 1e-7, i), 1e-5),
    "Newmark": (lambda i: fixed_steps.newmark(1600, i), 5e-6),
    "small increments": (lambda i: fixed_steps.small_increments(12800, i), 1e-3),
}


@pytest.mark.slow
@combinations(
    method=METHODS,
    law=["hertz", "meyer", "big-alabo", "stronge"],
    target=["half-space", "plate", "thin plate"],
    fast=12,
)
def test_conventional_methods_find_the_reference(method, law, target):
    on = scene(law, target)
    problem, (run, allowed) = problem_of(on), METHODS[method]
    exact = quadrature.integrate(LAWS[law], problem.mass, on.approach_velocity, on.target_impedance)
    s = problem.scales
    sizes = (s.force, s.length, s.time, s.time, s.time, s.velocity)
    impact = impact_ode.impact_of(problem.law, problem.approach, problem.gamma)
    found = run(impact)
    assert impact.evaluations > 50
    for name, value, size in zip(impact_ode.INTEGRATED_VALUES, found, sizes, strict=True):
        assert value * size == pytest.approx(exact[name], rel=allowed), name


@functools.cache
def exact(on):
    """INTEGRATED_VALUES of a scene from extended precision, which takes seconds, in SI, under the scene's own load."""
    problem = problem_of(on)
    return high_precision.impact(
        problem.law, problem.mass, on.approach_velocity, problem.given.impedance, problem.load * problem.scales.force
    )


def found_and_exact(on, run):
    """INTEGRATED_VALUES by one method, and the exact one."""
    problem = problem_of(on)
    s, impact = problem.scales, methods.impact(problem)
    sizes = (s.force, s.length, s.time, s.time, s.time, s.velocity)
    values = [value * size for value, size in zip(run(impact), sizes, strict=True)]
    return dict(zip(impact_ode.INTEGRATED_VALUES, values, strict=True)), exact(on)


ON_DAMPED = {
    "RK45": (lambda i: integrators.solve_ivp("RK45", 1e-9, i), 3e-7),
    "DOP853": (lambda i: integrators.solve_ivp("DOP853", 1e-10, i), 1e-8),
    "Newmark": (lambda i: fixed_steps.newmark(3200, i), 1e-4),
    "small increments": (lambda i: fixed_steps.small_increments(12800, i), 1e-3),
}


@pytest.mark.slow
@combinations(method=ON_DAMPED, law=DAMPED, target=["half-space", "plate"], fast=1)
def test_conventional_methods_march_damped_laws(method, law, target):
    """All summary values agree, among them the largest force and the end of contact."""
    run, allowed = ON_DAMPED[method]
    found, right = found_and_exact(scene(law, target).replace({"effects.gravity": False}), run)
    for name, value in found.items():
        assert value == pytest.approx(right[name], rel=allowed), name


@pytest.mark.slow
@pytest.mark.parametrize("law", DAMPED)
def test_cvode_marches_damped_laws(law):
    pytest.importorskip("sksundae")
    found, right = found_and_exact(scene(law), lambda impact: integrators.cvode("BDF", 1e-9, impact))
    for name, value in found.items():
        assert value == pytest.approx(right[name], rel=1e-6), name


@pytest.mark.slow
@combinations(
    method=[m for m in METHODS if m != "Radau"],
    law=["hertz", "big-alabo", "tsuji"],
    target=["half-space", "plate"],
    fast=1,
)
def test_conventional_methods_include_gravity(method, law, target):
    run, allowed = METHODS[method]
    slow = scene(law, target).replace({"impactor.velocity": "20 mm/s", "effects.gravity": True})
    assert problem_of(slow).load > 0.0
    found, right = found_and_exact(slow, run)
    for name, value in found.items():
        assert value == pytest.approx(right[name], rel=20 * allowed), name
    if law != "tsuji":
        load = problem_of(slow).load * problem_of(slow).scales.force
        tight = quadrature.integrate(
            LAWS[law], slow.effective_mass, slow.approach_velocity, slow.target_impedance, rtol=3e-14, load=load
        )
        for name, value in right.items():
            assert tight[name] == pytest.approx(value, rel=1e-11, abs=1e-20), name


@pytest.mark.parametrize(("function", "order"), [(fixed_steps.newmark, 2.0), (fixed_steps.small_increments, 1.0)])
def test_order_of_fixed_steps(function, order):
    problem = problem_of(scene("hertz", "plate"))
    values = [
        np.array(function(steps, impact_ode.impact_of(problem.law, problem.approach, problem.gamma)))
        for steps in (400, 800, 1600)
    ]
    ratio = np.abs(values[0] - values[1]).max() / np.abs(values[1] - values[2]).max()
    assert math.log2(ratio) == pytest.approx(order, abs=0.25)


@pytest.mark.slow
@combinations(name=PAPER, fast=1)
def test_film_converges_and_its_reference_is_exact(name):
    done = cost.study(paper(name), methods=["FILM"])
    assert done.reference["error"] < 1e-11
    for method, order in zip(methods.FILM, (4.0, 2.0), strict=True):
        runs = {run.setting: run for run in done.runs if run.method == method}
        assert len(runs) == len(methods.SEGMENTS)
        ratio = runs["64 segments"].error / runs["128 segments"].error
        assert math.log2(ratio) == pytest.approx(order, abs=0.2)
    assert all(run.time_single.median > 0.0 and run.time_batch.median > 0.0 for run in done.runs)
    front = done.front()
    for better, worse in zip(front[1:], front, strict=False):
        assert better.error < worse.error and better.time_single.median >= worse.time_single.median
    assert "segments take" in done.sentence()
    json.dumps(done.to_dict(), allow_nan=False)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["tsuji", "hunt-crossley"])
def test_a_damped_law_has_a_study(law):
    done = cost.study(scene(law, "plate").replace({"effects.gravity": True}))
    assert done.reference["method"] == "extrapolation in extended precision"
    runs = {(run.method, run.setting): run for run in done.runs}
    assert runs[methods.FILM[0], "128 segments"].error < 2e-9
    assert runs[methods.FILM[0], "16 segments"].error / runs[methods.FILM[0], "64 segments"].error > 60.0
    assert runs["solve_ivp DOP853", "rtol 1e-09"].error < 1e-7
    said = {run.outcome for run in done.runs if run.method in ("heyoka", "Dormand-Prince, numba")}
    assert said <= {"damping is not supported in this form", "not installed"}
    assert not any(run.method == "quadrature" for run in done.runs)


@pytest.mark.slow
def test_a_study_includes_gravity():
    ball = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml").replace({"effects.gravity": True})
    done = cost.study(ball, methods=["FILM", "Dormand-Prince, numba", "quadrature"])
    runs = {(run.method, run.setting): run for run in done.runs}
    assert runs[methods.FILM[0], "128 segments"].error < 1e-9
    rival = runs["Dormand-Prince, numba", "rtol 1e-09"]
    assert rival.outcome == "not installed" or rival.error < 1e-8
    assert not any(run.method == "quadrature" for run in done.runs)


@pytest.mark.slow
def test_a_study_of_two_balls_gives_the_relative_rebound():
    scene_of_two = fm.Scene.from_toml(SCENES / "two_steel_balls.toml")
    done = cost.study(scene_of_two, methods=["FILM, work-preserving"])
    assert min(run.error for run in done.runs) < 1e-11
    assert done.reference["values"]["rebound_velocity"] == pytest.approx(-scene_of_two.approach_velocity, rel=1e-12)


@pytest.mark.slow
def test_quadrature_is_not_compared_with_itself():
    """High precision does not support tables: quadrature is the reference, and compiled integrators are unsupported."""
    done = cost.study(scene("tabulated"), methods=["FILM, chords", "quadrature", "Dormand-Prince, numba"])
    assert "quadrature" in done.reference["method"] and done.reference["error"] < 1e-9
    rivals = [run for run in done.runs if run.method != methods.FILM[1]]
    assert {run.method for run in rivals} <= {"Dormand-Prince, numba"}
    assert all(run.outcome != "done" for run in rivals)


@pytest.mark.slow
def test_unsupported_methods_are_marked():
    pytest.importorskip("heyoka")
    done = cost.study(paper("tungsten_carbide_on_steel_stronge"), methods=["heyoka"])
    assert {run.outcome for run in done.runs} == {"the force is not a polynomial in √ξ"}
    assert all(run.errors == {} and run.error == math.inf for run in done.runs)
    assert done.sentence() == "FILM was not timed."


@pytest.mark.slow
def test_untimed_methods_are_not_compared():
    done = cost.study(paper("tungsten_carbide_on_steel"), methods=["solve_ivp RK45"])
    assert done.sentence().startswith("FILM was not timed; error 0.0001: solve_ivp RK45 takes ")
    assert done.sentence().endswith("s.")
    assert done.beaten() == []


@pytest.mark.slow
def test_an_accuracy_that_no_setting_reaches_is_reported(monkeypatch):
    monkeypatch.setattr(methods, "SEGMENTS", (1, 2))
    done = cost.study(paper("tungsten_carbide_on_steel"), methods=["FILM", "quadrature"])
    assert done.sentence() == "Error 0.0001: not reached with 2 segments."
    assert "Error 1e-06, single impact: reached by quadrature, not by FILM, work-preserving" in done.beaten()


@pytest.mark.slow
def test_a_missing_library_is_reported(capsys, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "sksundae", None)
    monkeypatch.setitem(sys.modules, "sksundae.cvode", None)
    done = cost.study(paper("tungsten_carbide_on_steel"), methods=["CVODE"])
    assert {run.outcome for run in done.runs} == {"not installed"}
    assert main(["cost", str(SCENES / "tungsten_carbide_on_steel.toml"), "--method", "CVODE"]) == 0
    said = capsys.readouterr().out  # one line, not one for each setting
    assert (
        "not compared, because not installed: CVODE Adams, CVODE BDF (pip install" in said and said.count("CVODE") == 2
    )


@pytest.mark.slow
def test_a_scene_without_reference_is_refused():
    ball = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
    with pytest.raises(fm.SimulationError, match="velocity is 0"):
        cost.study(ball.replace({"impactor.velocity": "0 m/s", "effects.gravity": False}))
    held = scene("hertz", "plate").replace({"impactor.velocity": "1 um/s", "effects.gravity": True})
    with pytest.raises(fm.SimulationError, match="a study needs a reference, which failed"):
        cost.study(held)
    thin = fm.Scene(ball.impactor, fm.Plate("mild steel", "0.2 mm"), fm.Contact("hertz"), fm.Effects(gravity=False))
    with pytest.raises(fm.SimulationError, match="a study needs a reference, which failed: DOP853"):
        cost.study(thin)


@pytest.mark.slow
def test_command_line(capsys, tmp_path):
    picture = tmp_path / "cost.svg"
    arguments = ["cost", str(SCENES / "tungsten_carbide_on_steel.toml"), "--method", "FILM", "--method", "quadrature"]
    assert main([*arguments, "--json", "--plot", str(picture)]) == 0
    table = json.loads(capsys.readouterr().out)
    assert {"reference", "runs"} <= set(table)
    keys = {"method", "setting", "time_single", "time_batch", "force_evaluations", "errors", "outcome"}
    assert keys <= set(table["runs"][0])
    assert set(table["runs"][0]["errors"]) == set(reference.COMPARED)
    assert picture.read_text("utf-8").lstrip().startswith("<?xml")
    assert main(arguments) == 0
    assert "Pareto-optimal" in capsys.readouterr().out
    assert main([*arguments[:2], "--method", "magic"]) == 3
    assert "no method begins with magic" in capsys.readouterr().err
    data = tmp_path / "cost.nc"
    assert main([*arguments[:2], "--method", "quadrature", "--output", str(data)]) == 0
    assert fd.open(data).film.kind == "impact_cost_study" and "law big-alabo" in capsys.readouterr().out
    assert main([*arguments, "--plot", str(tmp_path / "cost.gif")]) == 3
    said = capsys.readouterr().err
    assert "must end in .png" in said and "timing" not in said


def on_modes(target, law="hertz"):
    """A ball of 50 g on a target that vibrates, which it strikes several times."""
    ball = fm.Sphere("12 mm", "1 m/s", material="bearing steel", mass="50 g")
    effects = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
    return fm.Scene(ball, target, fm.Contact(law), effects, fm.Solver(accuracy=1e-2))


@pytest.mark.slow
def test_a_study_on_modes_against_their_reference(monkeypatch):
    """A structure that moves as a whole, with damped vibrations: all methods converge to DOP853 at 1e-12."""
    monkeypatch.setattr(modal_methods, "BATCH", 4)
    target = fm.Structure(
        frequency=["0 Hz", "900 Hz", "4 kHz"],
        modal_mass=["0.2 kg", "0.1 kg", "0.05 kg"],
        damping_ratio=[0.05, 0.02],
        material="mild steel",
    )
    done = cost.study(on_modes(target))
    assert done.film == "FILM, on modes" and done.reference["method"].startswith("DOP853 on 3 modes")
    assert done.reference["error"] < 1e-9
    runs = {(run.method, run.setting): run for run in done.runs}
    assert all(run.outcome == "done" and run.force_evaluations > 20 for run in done.runs)
    assert runs["FILM, on modes", "tolerance 1e-11"].error < 1e-9
    assert runs["FILM, on modes", "tolerance 1e-05"].error < 1e-4
    assert runs["solve_ivp DOP853", "rtol 1e-08"].error < 1e-5
    assert runs["solve_ivp RK45", "rtol 1e-07"].error < 1e-4
    rough, fine = (runs["Newmark", f"{n} steps"].error for n in (50, 800))
    assert math.log(rough / fine, 16.0) == pytest.approx(2.0, abs=0.3)
    assert "tolerance" in done.sentence() and "takes" in done.sentence()
    with pytest.raises(fm.SimulationError, match="which failed: damped laws on vibrating targets are not integrated"):
        cost.study(on_modes(target, LAWS["tsuji"]))


@pytest.mark.slow
def test_a_study_of_a_plate_by_command(tmp_path, capsys):
    """As on other targets: table, picture and file; several contacts, and a law that yields."""
    plate = fm.Plate("aluminium", "3 mm", size=["100 mm", "80 mm"], edges="clamped")
    path, drawn, data = (tmp_path / name for name in ("scene.toml", "cost.png", "cost.nc"))
    path.write_text(on_modes(plate, "jackson-green").to_toml(), encoding="utf-8")
    assert main(["cost", str(path), "--plot", str(drawn), "--output", str(data), "--method", "FILM"]) == 0
    said = capsys.readouterr().out
    assert "reference: DOP853 on" in said and "tolerance 1e-06" in said and "us" in said
    assert drawn.stat().st_size > 10_000
    back = fd.open(data)
    assert float(back["error_maximum_force"].min()) < 1e-9
    assert main(["plot", str(data), "--output", str(tmp_path / "again.png")]) == 0
    assert main(["cost", str(path), "--method", "magic"]) == 3
    assert "there are FILM, on modes; solve_ivp RK45" in capsys.readouterr().err


def test_times_are_shown_without_a_power_of_ten():
    assert cost._shown(timing.Timing(1.234e-7, 0.0)) == "123 ns"
