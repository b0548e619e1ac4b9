"""Many impacts on vibrating targets: the rows of a sweep or batch whose target vibrates.

Rows that differ in the velocity or mass of the impactor only share one structure and are followed in the core, one
after the other on each thread that is allowed. Other rows are simulated one by one; the modes of equal targets are
computed once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index
from film_model.base.errors import VIBRATES, CoreError, SimulationError, TooManyModes
from film_model.base.threads import threads_allowed
from film_model.core import modal, native
from film_model.core.columns import Columns
from film_model.core.refining import REFINED, error_of
from film_model.effects.choose import problem_of
from film_model.effects.many import rows_of
from film_model.laws import LAWS, AbstractLaw
from film_model.problem.curve import curve_of
from film_model.problem.law_of_scene import SceneLaw
from film_model.problem.problem import Impacts, Problem
from film_model.problem.summary import SUMMARY, difference, radiated, summary_of
from film_model.scene import DEFAULT_ACCURACY, Scene, Solver
from film_model.scene.columns import scene_of_columns, scene_of_row
from film_model.solve import structures, vibration
from film_model.solve.closed_form import ClosedForm
from film_model.solve.sensed import Peaks, quantities_of, replayed
from film_model.solve.vibration import Vibration, vibrate

Table = Any  # a structured array of the core

SHARED = ("impactor.velocity", "impactor.mass")
"""Columns with which impacts still share a structure and a curve."""

TRIED = 16
"""Of the impacts that share a structure, this many are followed with more and more modes, as in `simulate`."""

MOST_RUNS = 5
"""Runs of rows together, each with twice the highest frequency; rows that need more are simulated one by one."""


Modes = tuple[Array, Array, Array, float, Array]
"""The arguments of `modal.Tables`."""


class Followed(NamedTuple):
    """How impacts on the same modes were followed, so that they can be recorded. problem: of one impact, or of all.
    start: their starts (modal.START_DTYPE). highest: frequency up to which there are modes, rad/s."""

    rows: Index
    problem: Problem
    modes: Modes
    start: Table
    highest: float

    @classmethod
    def one(cls, row: int, problem: Problem, found: Vibration) -> Followed:
        """One impact, from the impact itself."""
        start: Table = np.array([tuple(getattr(found.start, name) for name in _START)], modal.START_DTYPE)
        return cls(np.array([row]), problem, _modes(found.tables), start, found.highest)

    def without(self, rows: Index) -> Followed:
        """The same except some rows."""
        kept = ~np.isin(self.rows, rows)
        return Followed(self.rows[kept], self.problem.part(kept), self.modes, self.start[kept], self.highest)


_START = modal.START_DTYPE.names or ()


def _modes(tables: modal.Tables) -> Modes:
    return tables.frequency, tables.share, tables.ratio, tables.longest, tables.forms


def closed_forms(followed: Followed) -> Iterator[ClosedForm | None]:
    """The motion of each impact, followed once more; None if its record takes more than `modal.MOST_MEMORY`."""
    tables, curve = modal.Tables(*followed.modes), curve_of(followed.problem.law).native
    for start in followed.start.tolist():
        found = modal.impact(tables, curve, modal.Start(*start))
        yield ClosedForm.of_modes(tables, found.segments, found.flights) if found.status >= 0 else None


def sensor_peaks(followed: Followed) -> Array:
    """Largest motions of the target's sensors in each impact, which is followed once more, SI, as (sensors, quantities,
    impacts); NaN if its record takes more than `modal.MOST_MEMORY`. On each thread some of the impacts."""
    problem = followed.problem
    target = problem.scene.target
    peaks = Peaks(target, followed.highest)
    curve = curve_of(problem.law).native
    force = np.broadcast_to(problem.scales.force, followed.rows.shape)
    lost = np.full((len(quantities_of(target)), len(target.sensors or ())), math.nan)

    def part(places: Index) -> list[Array]:
        tables, found = modal.Tables(*followed.modes), list[Array]()
        for place in places.tolist():
            one = modal.impact(tables, curve, modal.Start(*followed.start[place].item()))
            kept = one.status >= 0
            at = (tables, curve, modal.Start(*followed.start[place].item()), followed.highest)
            replay = partial(replayed, target, *at) if tables.forms.size else None
            own = peaks.of(one.segments, float(force[place]), float(one.events["time"][-1]), replay) if kept else lost
            found.append(own.T)
        return found

    return np.stack(_on_threads(part, followed.rows.size), axis=-1)


def _on_threads(part: Callable[[Index], Sequence[Any]], count: int) -> list[Any]:
    """What a function gives for the places 0 to count − 1, in parts for each thread that is allowed."""
    from concurrent.futures import ThreadPoolExecutor

    workers = min(threads_allowed(), max(count // TRIED, 1))
    if workers == 1:
        return list(part(np.arange(count)))
    with ThreadPoolExecutor(workers) as pool:
        return [one for found in pool.map(part, np.array_split(np.arange(count), workers)) for one in found]


class Vibrating(NamedTuple):
    """The results of some rows: values by the names of `SUMMARY`, status, law names; estimated: error of each row.
    followed: the rows that did not fail, in groups."""

    summary: dict[str, Array]
    status: NDArray[np.int32]
    laws: list[str]
    estimated: Array
    followed: list[Followed]


def on_modes(
    scene: Scene, columns: Mapping[str, Array], rows: Index, solver: Solver, known: Mapping[int, Problem]
) -> Vibrating:
    """The impacts of `rows`, whose targets vibrate. known: problems of some of them."""
    accuracy = solver.accuracy or DEFAULT_ACCURACY
    if rows.size > 2 * TRIED and set(columns) <= set(SHARED):
        found = _on_one_structure(scene, columns, rows, accuracy)
        if found is not None:
            return found
    return _one_by_one(scene, columns, rows, accuracy, known)


def _problem(scene: Scene, columns: Mapping[str, Array], row: int) -> Problem:
    return problem_of(scene_of_row(scene, columns, row))


def _one_by_one(
    scene: Scene, columns: Mapping[str, Array], rows: Index, accuracy: float, known: Mapping[int, Problem]
) -> Vibrating:
    values = {name: np.full(rows.size, np.nan) for name in SUMMARY}
    status, laws = np.full(rows.size, native.BAD_NUMBER, np.int32), list[str]()
    errors, followed = np.full(rows.size, np.nan), list[Followed]()
    for place, row in enumerate(rows.tolist()):
        problem = known.get(row) or _problem(scene, columns, row)
        laws.append(problem.law.name)
        try:
            found, estimated = vibrate(problem, problem.scene.target, accuracy, [], recorded=False)
        except CoreError as error:
            status[place] = error.status
            continue
        except SimulationError:
            status[place] = VIBRATES
            continue
        status[place] = found.status
        errors[place] = estimated + problem.curve.fit_error
        followed.append(Followed.one(row, problem, found))
        summary = summary_of(problem, int(status[place]), found.summary) | found.energies_in_si(problem)
        for name, value in summary.items():
            values[name][place] = value
    return Vibrating(values, status, laws, errors, followed)


# ---------------------------------------------------------------- one structure


def _on_one_structure(scene: Scene, columns: Mapping[str, Array], rows: Index, accuracy: float) -> Vibrating | None:
    """The impacts on one structure; None if they need more than one law or curve. Where the yield strength rises with
    the strain rate, each impact has a law of its own."""
    own = {path: values[rows] for path, values in columns.items()}
    varied = scene_of_columns(scene, own)
    order = np.argsort(np.broadcast_to(varied.approach_velocity**2 * varied.mass, rows.shape), kind="stable")
    places = np.unique(np.linspace(0, rows.size - 1, TRIED).astype(int))
    problems = [_problem(scene, columns, int(rows[order[place]])) for place in places.tolist()]
    first = problems[0]
    if any(p.law != first.law or p.curve is not first.curve or not p.vibrates or p.stretches for p in problems):
        return None
    try:
        runs = [vibrate(problem, scene.target, accuracy, [], recorded=False) for problem in problems]
    except SimulationError:
        return None
    pressed = _pressed(scene, columns, rows, order, places, [problem.load > 0.0 for problem in problems])
    tried = [run for run, _ in runs]
    highest, tolerance = np.empty(rows.size), np.empty(rows.size)
    for k in range(places.size - 1):
        between, ends = order[places[k] : places[k + 1] + 1], tried[k : k + 2]
        highest[between] = max(run.highest for run in ends)
        tolerance[between] = min(run.start.tolerance for run in ends)
    law = scene.contact.law if isinstance(scene.contact.law, AbstractLaw) else LAWS[first.law.name]

    def problem_at(at: Index) -> Problem:
        part = {path: column[at] for path, column in own.items()}
        impacts = Impacts.several(scene, SceneLaw.of(scene_of_columns(scene, part), law), rows[at], part)
        weight = np.where(pressed[at], impacts.numbers.weight, 0.0)
        return impacts.problem(impacts.column(math.inf), weight, vibrates=True)

    limit = max(vibration.time_limit(problem, scene.target) for problem in problems)
    status, core, estimated = np.empty(rows.size, np.int32), _no_summaries(rows.size), np.empty(rows.size)
    followed = list[Followed]()
    for value in np.unique(highest):
        at = np.flatnonzero(highest == value)
        status[at], core[at], estimated[at], done = _refined(
            problem_at, at, float(value), tolerance[at], limit, accuracy
        )
        followed += done
    whole = problem_at(np.arange(rows.size))
    values = summary_of(whole, status, Columns(core))
    energy = radiated(whole, Columns(core)) * whole.scales.energy
    values["energy_radiated"] = np.where(status == native.EVENT, energy, np.nan)
    if tried[0].reversible:
        values["energy_absorbed"] = np.where(status == native.EVENT, 0.0, values["energy_absorbed"])
    poor, still = ~(estimated <= accuracy), max(run.target_error for run, _ in runs)
    found = Vibrating(values, status, [first.law.name] * rows.size, estimated + still + first.curve.fit_error, followed)
    return _again(found, scene, columns, rows, accuracy, poor) if poor.any() else found


def _pressed(
    scene: Scene, columns: Mapping[str, Array], rows: Index, order: Index, places: Index, known: list[Any]
) -> NDArray[np.bool_]:
    """Whether the weight matters, of each row. known: at the `places` in their `order`."""
    pressed = np.empty(rows.size, np.bool_)
    for k in range(places.size - 1):
        low, high = int(places[k]), int(places[k + 1])
        while known[k] != known[k + 1] and high - low > 1:  # where between the two does it begin to matter?
            middle = (low + high) // 2
            same = (_problem(scene, columns, int(rows[order[middle]])).load > 0.0) == known[k]
            low, high = (middle, high) if same else (low, middle)
        pressed[order[places[k] : high]] = known[k]
        pressed[order[high : places[k + 1] + 1]] = known[k + 1]
    return pressed


def _no_summaries(count: int) -> Table:
    return cast("Table", np.zeros(count, native.SUMMARY_DTYPE))


def _again(
    found: Vibrating, scene: Scene, columns: Mapping[str, Array], rows: Index, accuracy: float, poor: NDArray[np.bool_]
) -> Vibrating:
    """The same with the poor rows simulated one by one, with as many modes as each needs."""
    better = _one_by_one(scene, columns, rows[poor], accuracy, {})
    for name, column in found.summary.items():
        column[poor] = better.summary[name]
    found.status[poor], found.estimated[poor] = better.status, better.estimated
    return found._replace(followed=[*(group.without(rows[poor]) for group in found.followed), *better.followed])


def _refined(
    problem_at: Callable[[Index], Problem], rows: Index, highest: float, tolerance: Array, limit: float, accuracy: float
) -> tuple[NDArray[np.int32], Table, Array, list[Followed]]:
    """Statuses, the core's summaries and estimates of some rows, by the rule of :func:`vibration.vibrate` from a
    quarter of a highest frequency on; the estimate of rows that need more than `MOST_RUNS` is above the accuracy, and
    how they were followed is omitted.

    Of the rows that reach the accuracy together each gets the largest estimate: one row's runs may agree by chance.
    """
    status, core, estimated = np.empty(rows.size, np.int32), _no_summaries(rows.size), np.full(rows.size, np.inf)
    left, coarse, before, followed = (
        np.arange(rows.size),
        _no_summaries(0),
        np.full(rows.size, np.inf),
        list[Followed](),
    )
    for k in range(MOST_RUNS):
        problem, steps = problem_at(rows[left]), tolerance[left] * REFINED ** (2 - k)
        try:
            run = _follow(problem, highest * 2.0 ** (k - 2), steps, limit)
        except TooManyModes:
            break
        fine = run.core
        if k > 0:
            change = difference(problem, Columns(coarse), Columns(fine))
            errors = error_of(problem.law.damped, before, change) + steps
            done = (errors <= accuracy) & (run.status >= 0)
            status[left[done]], core[left[done]], estimated[left[done]] = (
                run.status[done],
                fine[done],
                np.max(errors[done], initial=0.0),
            )
            own = rows_of(problem)[done], problem.part(done), run.modes, run.start[done]
            followed.append(Followed(*own, highest * 2.0 ** (k - 2)))
            left, fine, before = left[~done], fine[~done], change[~done]
        if not left.size:
            break
        coarse = fine
    return status, core, estimated, [group for group in followed if group.rows.size]


class _Run(NamedTuple):
    """Impacts on the same modes: statuses, the core's summaries and starts."""

    status: NDArray[np.int32]
    core: Table
    start: Table
    modes: Modes


def _follow(whole: Problem, highest: float, tolerance: Array, limit: float) -> _Run:
    """The impacts on the modes up to a frequency; each thread has tables of its own."""
    scales, target, count = whole.scales, whole.scene.target, np.size(whole.approach)
    longest = float(np.max(scales.time))
    omitted = structures.omitted_compliance(target, highest, longest) * scales.force / scales.length
    made = structures.made(target, highest, longest)
    tables, used = structures.tables_of(whole, made, float(np.max(omitted)))
    start = cast("Table", np.zeros(count, modal.START_DTYPE))
    start["nu"], start["load"], start["damping"] = whole.approach, whole.load, whole.damping
    start["mass"], start["unit"], start["tolerance"], start["limit"] = whole.mass, scales.time, tolerance, limit
    start["rest"] = omitted * (used > 0.0)
    modes = _modes(tables)

    def part(places: Index) -> tuple[NDArray[np.int32], Table]:
        return modal.batch(modal.Tables(*modes), whole.curve.native, start[places])

    found = _on_threads(lambda places: [part(places)], count)
    core = cast("Table", np.concatenate([table for _, table in found])["core"].copy())
    for name in ("time_of_maximum_indentation", "time_impactor_stops", "contact_duration"):
        core[name] /= scales.time
    return _Run(np.concatenate([status for status, _ in found]), core, start, modes)
