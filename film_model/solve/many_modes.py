"""Many impacts on vibrating targets: the rows of a sweep or batch whose target vibrates.

Rows that differ in the velocity or mass of the impactor only share one structure and are followed in the core, one
after the other on each processor. Other rows are simulated one by one; the modes of equal targets are computed once.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index
from film_model.base.errors import VIBRATES, CoreError, SimulationError
from film_model.core import modal, native
from film_model.effects.choose import problem_of
from film_model.laws import LAWS, AbstractLaw
from film_model.problem.law_of_scene import SceneLaw
from film_model.problem.problem import Columns, Impacts, Problem
from film_model.problem.summary import SUMMARY, difference, radiated, summary_of
from film_model.scene import DEFAULT_ACCURACY, Scene, Solver
from film_model.scene.columns import scene_of_columns
from film_model.solve import structures, vibration
from film_model.solve.vibration import vibrate

Table = Any  # a structured array of the core

SHARED = ("impactor.velocity", "impactor.mass")
"""Columns with which impacts still share a structure and a curve."""

TRIED = 16
"""Of the impacts that share a structure, this many are followed with more and more modes, as in `simulate`."""

_MARGIN = 1.5  # highest frequency of all over the largest of those tried


class Vibrating(NamedTuple):
    """The results of some rows: values by the names of `SUMMARY`, status, law names; estimated: error of each row."""

    summary: dict[str, Array]
    status: NDArray[np.int32]
    laws: list[str]
    estimated: Array


def on_modes(scene: Scene, columns: Mapping[str, Array], rows: Index, solver: Solver) -> Vibrating:
    """The impacts of `rows`, whose targets vibrate."""
    accuracy = solver.accuracy or DEFAULT_ACCURACY
    if rows.size > 2 * TRIED and set(columns) <= set(SHARED):
        found = _on_one_structure(scene, columns, rows, accuracy)
        if found is not None:
            return found
    return _one_by_one(scene, columns, rows, accuracy)


def _problem(scene: Scene, columns: Mapping[str, Array], row: int) -> Problem:
    own: dict[str, Any] = {path: float(values[row]) for path, values in columns.items()}
    return problem_of(scene_of_columns(scene, own))


def _one_by_one(scene: Scene, columns: Mapping[str, Array], rows: Index, accuracy: float) -> Vibrating:
    values = {name: np.full(rows.size, np.nan) for name in SUMMARY}
    status, laws = np.full(rows.size, native.BAD_NUMBER, np.int32), list[str]()
    errors = np.full(rows.size, np.nan)
    for place, row in enumerate(rows.tolist()):
        problem = _problem(scene, columns, row)
        laws.append(problem.law.name)
        try:
            found, estimated = vibrate(problem, problem.scene.target, accuracy, [])
        except CoreError as error:
            status[place] = error.status
            continue
        except SimulationError:
            status[place] = VIBRATES
            continue
        status[place] = found.status
        errors[place] = estimated + problem.curve.fit_error
        summary = summary_of(problem, int(status[place]), found.summary) | found.energies_in_si(problem)
        for name, value in summary.items():
            values[name][place] = value
    return Vibrating(values, status, laws, errors)


# ---------------------------------------------------------------- one structure


def _on_one_structure(scene: Scene, columns: Mapping[str, Array], rows: Index, accuracy: float) -> Vibrating | None:
    """The impacts on one structure; None if they need more than one law or curve."""
    own = {path: values[rows] for path, values in columns.items()}
    varied = scene_of_columns(scene, own)
    order = np.argsort(np.broadcast_to(varied.approach_velocity**2 * varied.mass, rows.shape), kind="stable")
    places = np.unique(np.linspace(0, rows.size - 1, TRIED).astype(int))
    problems = [_problem(scene, columns, int(rows[order[place]])) for place in places.tolist()]
    first = problems[0]
    if any(p.law.name != first.law.name or p.curve is not first.curve or not p.vibrates for p in problems):
        return None
    try:
        runs = [vibrate(problem, scene.target, accuracy, []) for problem in problems]
    except SimulationError:
        return None
    pressed = np.empty(rows.size, np.bool_)
    for k in range(places.size - 1):
        low, high, now = int(places[k]), int(places[k + 1]), problems[k].load > 0.0
        # where between the two does the weight begin to matter?
        while now != (problems[k + 1].load > 0.0) and high - low > 1:
            middle = (low + high) // 2
            same = (_problem(scene, columns, int(rows[order[middle]])).load > 0.0) == now
            low, high = (middle, high) if same else (low, middle)
        pressed[order[places[k] : high]] = now
        pressed[order[high : places[k + 1] + 1]] = problems[k + 1].load > 0.0
    law = scene.contact.law if isinstance(scene.contact.law, AbstractLaw) else LAWS[first.law.name]
    impacts = Impacts.several(scene, SceneLaw.of(varied, law), rows, own)
    whole = impacts.problem(impacts.column(math.inf), np.where(pressed, impacts.numbers.weight, 0.0), vibrates=True)
    highest = _MARGIN * max(float(run.frequency[-1]) for run, _ in runs)
    highest = structures.computable(scene.target, highest, float(np.max(whole.scales.time)))
    limit = max(vibration.time_limit(problem, scene.target) for problem in problems)
    tolerance = vibration.step_tolerance(accuracy) / vibration.REFINED**2
    before, change, (status, core) = _followed_thrice(whole, highest, tolerance, limit)
    estimated = vibration.error_of(whole, before, change) + tolerance
    values = summary_of(whole, status, Columns(core))
    energy = radiated(whole, Columns(core)) * whole.scales.energy
    values["energy_radiated"] = np.where(status == native.EVENT, energy, np.nan)
    if runs[0][0].reversible:
        values["energy_absorbed"] = np.where(status == native.EVENT, 0.0, values["energy_absorbed"])
    poor = ~(estimated <= accuracy)
    estimated[~poor] = np.max(estimated[~poor], initial=0.0)  # one row's runs may agree by chance
    found = Vibrating(values, status, [first.law.name] * rows.size, estimated + first.curve.fit_error)
    return _again(found, scene, columns, rows, accuracy, poor) if poor.any() else found


def _again(
    found: Vibrating, scene: Scene, columns: Mapping[str, Array], rows: Index, accuracy: float, poor: NDArray[np.bool_]
) -> Vibrating:
    """The same with the poor rows simulated one by one, with as many modes as each needs."""
    better = _one_by_one(scene, columns, rows[poor], accuracy)
    for name, column in found.summary.items():
        column[poor] = better.summary[name]
    found.status[poor], found.estimated[poor] = better.status, better.estimated
    return found


def _followed_thrice(
    whole: Problem, highest: float, tolerance: float, limit: float
) -> tuple[Array, Array, tuple[NDArray[np.int32], Table]]:
    """Differences with a quarter and half, and with half and all of the highest frequency; statuses and summaries."""
    runs = [_follow(whole, highest / 2.0**k, tolerance * vibration.REFINED**k, limit) for k in (2, 1, 0)]
    coarse, middle, fine = (Columns(core) for _, core in runs)
    return difference(whole, coarse, middle), difference(whole, middle, fine), runs[-1]


def _follow(whole: Problem, highest: float, tolerance: float, limit: float) -> tuple[NDArray[np.int32], Table]:
    """Statuses and the core's summaries; each processor has tables of its own."""
    scales, target, count = whole.scales, whole.scene.target, np.size(whole.approach)
    longest = float(np.max(scales.time))
    rest = structures.omitted_compliance(target, highest, longest) * scales.force / scales.length
    start = cast("Table", np.zeros(count, modal.START_DTYPE))
    start["nu"], start["load"], start["rest"], start["damping"] = whole.approach, whole.load, rest, whole.damping
    start["mass"], start["unit"], start["tolerance"], start["limit"] = whole.mass, scales.time, tolerance, limit

    def part(places: Index) -> tuple[NDArray[np.int32], Table]:
        made = structures.made(target, highest, longest)
        tables, used = structures.tables_of(whole, made, float(np.max(rest)))
        own = start[places]
        own["rest"] *= used > 0.0
        return modal.batch(tables, whole.curve.native, own)

    from concurrent.futures import ThreadPoolExecutor

    workers = min(os.cpu_count() or 1, max(count // TRIED, 1))
    with ThreadPoolExecutor(workers) as pool:
        found = list(pool.map(part, np.array_split(np.arange(count), workers)))
    core = cast("Table", np.concatenate([table for _, table in found])["core"].copy())
    for name in ("time_of_maximum_indentation", "time_impactor_stops", "contact_duration"):
        core[name] /= scales.time
    return np.concatenate([status for status, _ in found]), core
