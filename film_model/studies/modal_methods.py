"""The methods of a study of cost on a target that vibrates, all on the same modes, and their reference."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import Outcome, SimulationError
from film_model.core import modal, native
from film_model.problem.curve import curve_of
from film_model.problem.problem import Problem
from film_model.scene import DEFAULT_ACCURACY, Scene
from film_model.solve import structures, vibration
from film_model.studies import impact_ode
from film_model.studies.methods import FILM_ON_MODES, Prepared, Result, Setting, impact
from film_model.studies.modal_reference import ModalRun, integrate
from film_model.studies.reference import COMPARED

STEP_TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
TOLERANCES = {"RK45": (1e-5, 1e-7), "DOP853": (1e-4, 1e-6, 1e-8)}
STEPS = (50, 200, 800)
TIGHT = (1e-12, 1e-11)
"""Tolerances of the reference, and of the run that tells its error."""

BATCH = 64
"""Impacts of a batch, with velocities within 5 % of the scene's."""


class _Modes(NamedTuple):
    """The modes that `simulate` takes for the scene. start: of FILM, at the accuracy of the scene."""

    problem: Problem
    structure: structures.Structure
    tables: modal.Tables
    start: modal.Start


def _modes(problem: Problem, scene: Scene) -> _Modes:
    if problem.stretches:
        raise SimulationError("the compared methods have no membrane forces: set stretching = false in [effects]")
    asked = scene.solver.accuracy or DEFAULT_ACCURACY
    found, _ = vibration.vibrate(problem, scene.target, asked, [])
    structure = structures.structure_of(scene.target, found.highest, problem.scales.time)
    return _Modes(problem, structure, found.tables, found.start)


def _integrated(on: _Modes, tolerance: float, method: Any = "DOP853", step: float | None = None) -> ModalRun:
    tables, start = on.tables, on.start
    frequency, share = tables.frequency * start.unit, tables.share * start.mass
    depth, limit = float(impact_ode.sizes(impact(on.problem))[0]), start.limit / start.unit
    return integrate(on.problem, frequency, share, start.rest, depth, limit, tolerance, tables.ratio, method, step)


def _values(summary: native.Summary, outcome: Outcome) -> Array:
    """`INTEGRATED_VALUES`. Raises RuntimeError if the last contact has not ended."""
    if outcome is not Outcome.SEPARATED:
        raise RuntimeError("contact does not end")
    names = {"rebound_velocity": "final_velocity"}
    return np.array([getattr(summary, names.get(name, name)) for name in impact_ode.INTEGRATED_VALUES])


def reference(scene: Scene, problem: Problem) -> tuple[Array, dict[str, Any]]:
    """As `film_model.studies.reference.reference`: DOP853 at two tolerances, on the modes that `simulate` takes."""
    on = _modes(problem, scene)
    values, other = (_values(run.summary, run.outcome) for run in (_integrated(on, tolerance) for tolerance in TIGHT))
    s, at = problem.scales, [impact_ode.INTEGRATED_VALUES.index(name) for name in COMPARED]
    sizes = np.array([s.force, s.length, s.time, s.time, s.time, s.velocity])
    return values, {
        "method": f"DOP853 on {on.tables.count} modes at rtol {TIGHT[0]:g}",
        "values": dict(zip(COMPARED, (values * sizes)[at].tolist(), strict=True)),
        "error": max(1e-15, float(np.abs(other / values - 1.0)[at].max())),
    }


def methods_for(problem: Problem, scene: Scene) -> Iterator[tuple[str, list[Setting]]]:
    """As `film_model.studies.methods.methods_for`."""
    on = _modes(problem, scene)
    yield FILM_ON_MODES, [(f"tolerance {r:g}", partial(_film, on, r)) for r in STEP_TOLERANCES]
    for method, tolerances in TOLERANCES.items():
        yield f"solve_ivp {method}", [(f"rtol {r:g}", partial(_solve_ivp, on, method, r)) for r in tolerances]
    yield "Newmark", [(f"{n} steps", partial(_newmark, on, n)) for n in STEPS]


def _film(on: _Modes, tolerance: float) -> Prepared:
    curve = curve_of(on.problem.law).native
    starts: Any = np.zeros(BATCH, modal.START_DTYPE)
    for name in modal.START_DTYPE.names or ():
        starts[name] = getattr(on.start, name)
    starts["nu"] *= np.linspace(0.95, 1.05, BATCH)
    starts["tolerance"] = tolerance

    def single() -> Result:
        found = vibration.run(on.problem, on.structure, tolerance, on.start.limit)
        return _values(found.summary, found.outcome).tolist(), int(found.summary.lines)

    return Prepared(single, lambda: modal.batch(on.tables, curve, starts), BATCH)


def _result(run: ModalRun) -> Result:
    return _values(run.summary, run.outcome).tolist(), run.evaluations


def _solve_ivp(on: _Modes, method: str, tolerance: float) -> Prepared:
    return Prepared(lambda: _result(_integrated(on, tolerance, method)))


def _newmark(on: _Modes, steps: int) -> Prepared:
    """About `steps` steps in a contact on a fixed target."""
    from film_model.studies.modal_newmark import Newmark  # lazy: importing scipy.integrate takes 0.3 s

    depth, nu = impact_ode.sizes(impact(on.problem))
    step = 3.0 * float(depth / nu) / steps
    return Prepared(lambda: _result(_integrated(on, 1e-6, Newmark, step)))
