"""The methods of a study of cost, each ready to run one impact, and a batch where it has one, at several settings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from film_model.core import native
from film_model.problem.problem import Problem
from film_model.scene import Scene
from film_model.studies import fixed_steps, integrators, quadrature
from film_model.studies.impact_ode import INTEGRATED_VALUES, Impact, impact_of

SEGMENTS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 500)
TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
STEPS = (50, 200, 800, 3200, 12800)
FILM = ("FILM, work-preserving", "FILM, chords")
FILM_ON_MODES = "FILM, on modes"
BATCH = 2048
"""Impacts of a batch, with velocities within 5 % of the scene's."""

Result = tuple[Sequence[float], int | None]
"""Values of `INTEGRATED_VALUES`, and force evaluations."""


class Prepared(NamedTuple):
    """A method at one setting, ready to run a single impact, and a batch or None."""

    single: Callable[[], Result]
    batch: Callable[[], Any] | None = None
    batch_size: int = 1


Setting = tuple[str, Callable[[], Prepared]]


def methods_for(problem: Problem, scene: Scene) -> Iterator[tuple[str, list[Setting]]]:
    """The names of all methods, with their settings and what prepares them."""
    for kind, name in zip((native.WORK_PRESERVING, native.CHORD), FILM, strict=True):
        yield name, [(f"{n} segments", partial(_film, problem, kind, n)) for n in SEGMENTS]
    for method in ("RK45", "DOP853", "LSODA", "Radau"):
        yield (
            f"solve_ivp {method}",
            [(f"rtol {r:g}", partial(_one, problem, integrators.solve_ivp, method, r)) for r in TOLERANCES],
        )
    for method in ("Adams", "BDF"):
        yield (
            f"CVODE {method}",
            [(f"rtol {r:g}", partial(_one, problem, integrators.cvode, method, r)) for r in TOLERANCES],
        )
    yield "heyoka", [(f"tol {r:g}", partial(_heyoka, problem, r)) for r in (1e-8, 1e-12, 1e-15)]
    yield "Dormand-Prince, numba", _numba(problem)
    for name, function in (("Newmark", fixed_steps.newmark), ("small increments", fixed_steps.small_increments)):
        yield name, [(f"{n} steps", partial(_one, problem, function, n)) for n in STEPS]
    if problem.gamma == problem.load == problem.damping == 0.0:
        yield "quadrature", [("adaptive", partial(_quadrature, problem, scene))]


def _film(problem: Problem, kind: int, n: int) -> Prepared:
    ratio = problem.curve.unloading_ratio if kind == native.WORK_PRESERVING else 1
    curve, mesh, start = problem.curve.native, native.mesh(kind, n, ratio * n), problem.start

    def single() -> Result:
        status, s = native.marched(curve, mesh, start)  # by lines, as `simulate`
        if status != native.EVENT:
            raise RuntimeError(f"status {status}")
        times = s.time_of_maximum_indentation, s.time_impactor_stops, s.contact_duration
        return (s.maximum_force, s.maximum_indentation, *times, s.final_velocity), s.lines

    starts: Any = np.zeros(BATCH, native.START_DTYPE)
    for name in native.START_DTYPE.names or ():
        starts[name] = getattr(start, name)
    starts["nu"] *= np.linspace(0.95, 1.05, BATCH)
    return Prepared(single, lambda: native.batch(curve, mesh, starts), BATCH)


def _one(problem: Problem, function: Callable[..., Sequence[float]], *setting: Any) -> Prepared:
    def single() -> Result:
        equations = impact(problem)
        return function(*setting, equations), equations.evaluations

    return Prepared(single)


def impact(problem: Problem) -> Impact:
    """The equations of a problem."""
    return impact_of(problem.law, problem.approach, problem.gamma, problem.load, problem.damping)


def _heyoka(problem: Problem, tolerance: float) -> Prepared:
    compiled = integrators.heyoka(tolerance, impact(problem))
    return Prepared(lambda: (compiled(), None))


def _numba(problem: Problem) -> list[Setting]:
    compiled: list[Any] = []

    def prepare(tolerance: float) -> Prepared:
        from film_model.studies.dormand_prince import compile_solver, scalar_law

        if not compiled:
            compiled.append(compile_solver(scalar_law(problem.law), "root", problem.load))
        solver, out = compiled[0], np.full((BATCH, 6), np.nan)
        one, gamma = np.array([problem.approach]), np.full(BATCH, problem.gamma)
        many = problem.approach * np.linspace(0.95, 1.05, BATCH)

        def single() -> Result:
            evaluations = solver(one, gamma[:1], tolerance, 0.1, out)
            return tuple(out[0].tolist()), int(evaluations)

        return Prepared(single, lambda: solver(many, gamma, tolerance, 0.1, out), BATCH)

    return [(f"rtol {r:g}", partial(prepare, r)) for r in TOLERANCES]


def _quadrature(problem: Problem, scene: Scene) -> Prepared:
    s = problem.scales
    sizes = (s.force, s.length, s.time, s.time, s.time, s.velocity)

    def single() -> Result:
        found = quadrature.quadrature(problem.law, problem.mass, scene.approach_velocity)
        return tuple(found[name] / size for name, size in zip(INTEGRATED_VALUES, sizes, strict=True)), None

    return Prepared(single)
