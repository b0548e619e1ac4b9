"""The cost study: every method converges to the reference, and what is said of it is measured."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from cases import LAWS, scene

import film_datasets as fd
import film_model as fm
from film_model import conventional, reference, study
from film_model.cli import main
from film_model.problem import problem_of

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
PAPER = ("tungsten_carbide_on_steel", "tungsten_carbide_on_steel_stronge", "olsson_plate")


@pytest.fixture(autouse=True)
def short_timings(monkeypatch):
    monkeypatch.setattr(study, "SHORTEST", 1e-5)
    monkeypatch.setattr(study, "MOST_TIME", 1e-3)
    monkeypatch.setattr(study, "BATCH", 32)


def paper(name):
    return fm.Scene.from_toml(SCENES / f"{name}.toml").replace({"effects.boundary_reflections": False})


METHODS = {
    "RK45": (lambda i: conventional.solve_ivp("RK45", 1e-9, i), 1e-6),
    "DOP853": (lambda i: conventional.solve_ivp("DOP853", 1e-9, i), 1e-6),
    "LSODA": (lambda i: conventional.solve_ivp("LSODA", 1e-9, i), 1e-6),
    "Radau": (lambda i: conventional.solve_ivp("Radau", 1e-7, i), 1e-5),
    "Newmark": (lambda i: conventional.newmark(1600, i), 5e-6),
    "small increments": (lambda i: conventional.small_increments(12800, i), 1e-3),
}


@pytest.mark.parametrize("target", ["half-space", "plate", "thin plate"])
@pytest.mark.parametrize("law", ["hertz", "meyer", "big-alabo", "stronge"])
@pytest.mark.parametrize("method", list(METHODS))
def test_conventional_methods_find_the_reference(method, law, target):
    on = scene(law, target)
    problem, (run, allowed) = problem_of(on), METHODS[method]
    exact = reference.integrate(LAWS[law], problem.mass, on.approach_velocity, on.target_impedance)
    s = problem.scales
    sizes = (s.force, s.length, s.time, s.time, s.time, s.velocity)
    impact = conventional.impact_of(problem.law, problem.approach, problem.gamma)
    found = run(impact)
    assert impact.evaluations > 50
    for name, value, size in zip(conventional.SUMMARY, found, sizes, strict=True):
        assert value * size == pytest.approx(exact[name], rel=allowed), name


@pytest.mark.parametrize(("function", "order"), [(conventional.newmark, 2.0), (conventional.small_increments, 1.0)])
def test_order_of_fixed_steps(function, order):
    problem = problem_of(scene("hertz", "plate"))
    values = [
        np.array(function(steps, conventional.impact_of(problem.law, problem.approach, problem.gamma)))
        for steps in (400, 800, 1600)
    ]
    ratio = np.abs(values[0] - values[1]).max() / np.abs(values[1] - values[2]).max()
    assert math.log2(ratio) == pytest.approx(order, abs=0.25)


@pytest.mark.parametrize("name", PAPER)
def test_film_converges_and_its_reference_is_exact(name):
    done = study.study(paper(name), methods=["FILM"])
    assert done.reference["error"] < 1e-11
    for method, order in zip(study.FILM, (4.0, 2.0), strict=True):
        runs = {run.setting: run for run in done.runs if run.method == method}
        assert len(runs) == len(study.SEGMENTS)
        ratio = runs["64 segments"].error / runs["128 segments"].error
        assert math.log2(ratio) == pytest.approx(order, abs=0.2)
    assert all(run.time_single.median > 0.0 and run.time_batch.median > 0.0 for run in done.runs)
    front = done.front()
    for better, worse in zip(front[1:], front, strict=False):
        assert better.error < worse.error and better.time_single.median >= worse.time_single.median
    assert "segments and" in done.sentence()
    json.dumps(done.to_json(), allow_nan=False)


def test_quadrature_is_not_held_against_itself():
    """A table is unknown to extended precision: quadrature is its reference, and compiled integrators cannot follow."""
    done = study.study(scene("tabulated"), methods=["FILM, chords", "quadrature", "Dormand-Prince, numba"])
    assert "quadrature" in done.reference["method"] and done.reference["error"] < 1e-9
    rivals = [run for run in done.runs if run.method != study.FILM[1]]
    assert {run.method for run in rivals} <= {"Dormand-Prince, numba"}
    assert all(run.outcome != "done" for run in rivals)


def test_methods_that_cannot_are_shown_as_such():
    pytest.importorskip("heyoka")
    done = study.study(paper("tungsten_carbide_on_steel_stronge"), methods=["heyoka"])
    assert {run.outcome for run in done.runs} == {"the force is no polynomial in √ξ"}
    assert all(run.errors == {} and run.error == math.inf for run in done.runs)
    assert done.sentence() == "FILM, work-preserving, was not timed."


def test_what_was_not_timed_is_not_judged():
    done = study.study(paper("tungsten_carbide_on_steel"), methods=["solve_ivp RK45"])
    assert done.sentence().startswith("FILM, work-preserving, was not timed; solve_ivp RK45 needs ")
    assert done.sentence().endswith(" for 0.0001.")
    assert done.beaten() == []


def test_what_is_not_reached_is_said(monkeypatch):
    monkeypatch.setattr(study, "SEGMENTS", (1, 2))
    done = study.study(paper("tungsten_carbide_on_steel"), methods=["FILM", "quadrature"])
    assert done.sentence() == "0.0001 is not reached with 2 segments."
    assert "1e-06, one impact: quadrature reaches it, FILM, work-preserving, does not" in done.beaten()


def test_a_library_that_is_missing(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "sksundae", None)
    monkeypatch.setitem(sys.modules, "sksundae.cvode", None)
    done = study.study(paper("tungsten_carbide_on_steel"), methods=["CVODE"])
    assert {run.outcome for run in done.runs} == {"not installed"}


def test_a_scene_without_reference():
    ball = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
    damped = {"contact.law": "hunt-crossley", "contact.restitution": 0.5}
    for changes, said in (
        ({"effects.gravity": True}, "gravity = false"),
        ({"impactor.velocity": "0 m/s", "effects.gravity": False}, "velocity is 0"),
        (damped, "law hunt-crossley"),
    ):
        with pytest.raises(fm.SimulationError, match=said):
            study.study(ball.replace(changes))
    thin = fm.Scene(ball.impactor, fm.Plate("mild steel", "0.2 mm"), fm.Contact("hertz"), fm.Effects(gravity=False))
    with pytest.raises(fm.SimulationError, match="a study needs a reference, and there is none: DOP853"):
        study.study(thin)
    with pytest.raises(fm.SimulationError, match="free body"):
        study.study(fm.Scene.from_toml(SCENES / "two_steel_balls.toml"))


def test_command_line(capsys, tmp_path):
    picture = tmp_path / "cost.svg"
    arguments = ["cost", str(SCENES / "tungsten_carbide_on_steel.toml"), "--method", "FILM", "--method", "quadrature"]
    assert main([*arguments, "--json", "--plot", str(picture)]) == 0
    table = json.loads(capsys.readouterr().out)
    assert {"reference", "runs"} <= set(table)
    keys = {"method", "setting", "time_single", "time_batch", "force_evaluations", "errors", "outcome"}
    assert keys <= set(table["runs"][0])
    assert set(table["runs"][0]["errors"]) == set(study.COMPARED)
    assert picture.read_text("utf-8").lstrip().startswith("<?xml")
    assert main(arguments) == 0
    assert "costs" in capsys.readouterr().out
    assert main([*arguments[:2], "--method", "magic"]) == 3
    assert "no method begins with magic" in capsys.readouterr().err
    data = tmp_path / "cost.nc"
    assert main([*arguments[:2], "--method", "quadrature", "--output", str(data)]) == 0
    assert fd.open(data).film.kind == "impact_cost_study" and "law big-alabo" in capsys.readouterr().out
    assert main([*arguments, "--plot", str(tmp_path / "cost.gif")]) == 3
    said = capsys.readouterr().err
    assert "must end in .png" in said and "timing" not in said


def test_times_are_shown_without_a_power_of_ten():
    assert study._shown(study.Timing(1.234e-7, 0.0)) == "123 ns"
