"""Many impacts of one scene: simulate_many(scene, columns) → ManyResult, and simulate_batch(scene, velocity=…)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from film_model.base import errors, units
from film_model.base.arrays import Array, Mask, index_or_all
from film_model.base.errors import VIBRATES
from film_model.base.late import Late
from film_model.core import native
from film_model.effects.effect import percent
from film_model.effects.law_range import law_warnings
from film_model.effects.many import problems_of, rows_of
from film_model.effects.plasticity import left_out
from film_model.problem.problem import Problem
from film_model.problem.summary import SUMMARY, gains_energy, gains_from_weight, summary_of, weight_warning
from film_model.scene import SLOWEST, Scene, Solver, Sphere
from film_model.solve.accuracy import solver_for
from film_model.solve.many_meshes import march_many
from film_model.solve.many_modes import Followed, on_modes

if TYPE_CHECKING:
    from film_model.solve.many_friction import ManyOblique

STATUSES = {code: (status.word, status.sentence) for code, status in errors.STATUSES.items() if status.of_row}
"""How an impact of a batch can end: word and sentence. Negative: it failed, and its values are nan."""


@dataclass(frozen=True)
class ManyResult:
    """Many impacts. summary: arrays, SI, by the names of `SUMMARY` (nan: did not happen).

    status: keys of `STATUSES`. laws: names, and law: the number of each impact's among them. segments: per loading
    stage and of unloading, for each impact, 0 if its target vibrates. estimated: bound on the relative error of every
    value, nan for an impact that failed; of vibrating targets from those impacts that were tried with two numbers of
    modes. problems: what was marched; `rows_of` gives the impacts of each. followed: the impacts on modes. oblique: the
    tangential parts; None without friction.
    """

    summary: dict[str, Array]
    status: NDArray[np.int32]
    laws: tuple[str, ...]
    law: NDArray[np.int8]
    segments: NDArray[np.int32]
    estimated: Array
    problems: tuple[Problem, ...]
    followed: tuple[Followed, ...]
    oblique: ManyOblique | None = None

    @property
    def on_modes(self) -> Mask:
        """Which impacts are on targets that vibrate: they have no segments of the march."""
        return (self.segments[:, 0] == 0) & (self.status >= 0)


@dataclass(frozen=True, eq=False)
class BatchResult:
    """Summaries of many impacts: arrays of one shape, SI, by the names of `history.SUMMARY` (nan: did not happen).

    estimated_accuracy: bound on the relative error of every value of each impact (nan: it failed); estimated: the
    largest. segments: largest numbers per loading stage and of unloading. failed: True where the impact failed (its
    values are nan). varied: the velocities [m/s] and, if given, masses [kg], in the shape of the results. oblique:
    with friction, arrays by the names of `History.oblique` (nan: nothing slides), its sliding_regime, its
    estimated_error, and sliding_after_low and sliding_after_high, bounds of the sliding velocity after the impact under
    two models of contacts that yield (nan: it does not); else empty.
    """

    summary: dict[str, Array]
    varied: dict[str, Array]
    estimated_accuracy: Array
    estimated: float
    segments: tuple[int, int]
    failed: Mask
    oblique: dict[str, NDArray[Any]]
    _many: ManyResult = field(repr=False, compare=False)

    _repr_html_ = Late("film_model.methods:batch_as_html")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, BatchResult) or self.segments != other.segments:
            return False
        mine, theirs = (
            {**of.varied, **of.summary, **of.oblique, "estimated": of.estimated_accuracy} for of in (self, other)
        )
        same = mine.keys() == theirs.keys()
        return same and all(
            np.array_equal(mine[name], theirs[name], equal_nan=mine[name].dtype.kind == "f") for name in mine
        )

    def __repr__(self) -> str:
        failed, impacts = np.count_nonzero(self.failed), " × ".join(map(str, self.failed.shape)) or "1"
        said = f"{impacts} impacts over {' and '.join(self.varied)}, {' and '.join(self._many.laws)}"
        return f"BatchResult({said}; {failed} failed, estimated relative error ≤ {self.estimated:.1e})"

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about laws: energy gained, restitution that rises with velocity, depths outside their range, and
        yielding that a law without it leaves out; and about restitution above 1 by the work of the weight."""
        said, faster = list[str](), 0
        for problem in self._many.problems:
            rows = rows_of(problem)
            own = {name: values[rows] for name, values in self._many.summary.items()}
            faster += int(np.count_nonzero(gains_from_weight(problem, own)))
            gains = np.count_nonzero(gains_energy(problem, own["energy_absorbed"]))
            if gains:
                said.append(
                    f"law {problem.law.name}: in {gains} impacts its unloading returns more energy than it stored"
                )
            said += law_warnings(problem, own["maximum_indentation"] / problem.scales.length)
            changes = left_out(problem)
            beyond = ~(changes <= problem.scene.effect_tolerance)
            if beyond.any():
                most = percent(float(changes.max()))
                said.append(
                    f"not modelled: plasticity, which would change the summary by up to {most} "
                    f"in {np.count_nonzero(beyond)} of {rows.size} impacts; law {problem.law.name} does not yield"
                )
        return (*said, *weight_warning(faster))


def _in_si(name: Literal["velocity", "mass"], values: Any) -> Array:
    """The values of an argument, which is called as its dimension, in SI. Raises ValueError that names it."""
    try:
        return units.array_to_si(values, name)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def simulate_batch(
    scene: Scene,
    *,
    velocity: Any,
    mass: Any = None,
    accuracy: float | None = None,
    segments: int | None = None,
    **others: object,
) -> BatchResult:
    """Impacts of one scene at many velocities, and masses if given; arrays with units that broadcast together.

    Effects and law "auto" are decided for every impact. For an accuracy, every impact is
    refined until its own estimate meets it.

    Raises ValueError for a velocity or mass that is not > 0 or outside the range of scenes, a velocity that is not
    above a free target's, empty arrays, or arrays that do not broadcast together; SceneError for a bad option;
    TypeError for `others`: every entry of a scene is varied by `film_datasets.sweep`.

    >>> many = fm.simulate_batch(scene, velocity=["0.1 m/s", "1 m/s"])
    >>> many.summary["coefficient_of_restitution"].round(3)
    array([0.902, 0.694])
    """
    if others:
        raise TypeError(f"simulate_batch varies velocity and mass, not {', '.join(others)}: use film_datasets.sweep")
    speeds = _in_si("velocity", velocity)
    masses = None if mass is None else _in_si("mass", mass)
    shape = speeds.shape if masses is None else _common_shape(speeds, masses)
    given = {"impactor.velocity": speeds, "impactor.mass": masses}
    columns = {path: np.broadcast_to(values, shape).ravel() for path, values in given.items() if values is not None}
    least = max(scene.target.velocity, 0.0)
    for name, values, unit, floor in (("velocity", speeds, "m/s", least), ("mass", masses, "kg", 0.0)):
        if values is None:
            continue
        if values.size == 0:
            raise ValueError(f"{name}: no values, at least one is needed")
        lowest, highest = values.min(), values.max()
        if not lowest > floor:
            whose = ", the target's" if floor > 0.0 else ""
            raise ValueError(f"{name}: {lowest:g} {unit} must be > {floor:g} {unit}{whose}")
        field = Sphere.FIELDS[name]
        low, high = max(field.low or 0.0, SLOWEST), field.high or math.inf
        if lowest < low or highest > high:
            wrong = lowest if lowest < low else highest
            raise ValueError(f"{name}: {wrong:g} {unit} is out of range: from {low:g} to {high:g} {unit}")
    solver = solver_for(scene.solver, accuracy, segments, None)
    result = simulate_many(scene, columns, solver)
    counts = result.segments.max(axis=0).tolist()
    worst = float(np.fmax.reduce(result.estimated, initial=0.0))
    varied = {path.partition(".")[2]: column.reshape(shape) for path, column in columns.items()}
    summary, each, failed = dict(result.summary), result.estimated, result.status < 0
    if len(shape) != 1:
        summary = {name: column.reshape(shape) for name, column in summary.items()}
        each, failed = each.reshape(shape), failed.reshape(shape)
    oblique = {} if result.oblique is None else {k: v.reshape(shape) for k, v in result.oblique.arrays().items()}
    return BatchResult(summary, varied, each, worst, (counts[0], counts[1]), failed, oblique, result)


def _common_shape(speeds: Array, masses: Array) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(speeds.shape, masses.shape)
    except ValueError:
        shapes = f"velocity has the shape {speeds.shape}, mass {masses.shape}"
        raise ValueError(f"{shapes}: shapes that broadcast together are needed") from None


def simulate_many(scene: Scene, columns: Mapping[str, Array], solver: Solver | None = None) -> ManyResult:
    """Impacts of one scene, in which columns replace some numbers: path such as "impactor.velocity" → SI values.

    There is at least one column. All have the same length, values within the ranges of scenes, and a path that has a
    number in `scene`. solver: default the scene's. Raises SimulationError where friction is not known.
    """
    solver = solver or scene.solver
    count = len(next(iter(columns.values())))
    status = np.full(count, native.BAD_NUMBER, np.int32)
    law = np.zeros(count, np.int8)
    segments, laws, estimated = np.zeros((count, 2), np.int32), list[str](), np.full(count, np.nan)
    known = dict[int, Problem]()
    problems = problems_of(scene, columns, count, status, known)
    all_in_one = len(problems) == 1 and rows_of(problems[0]).size == count  # its columns are those of the result
    summary = {} if all_in_one else dict(zip(SUMMARY, np.full((len(SUMMARY), count), np.nan), strict=True))
    for problem in problems:
        rows, name = index_or_all(rows_of(problem), count), problem.law.name
        if name not in laws:
            laws.append(name)
        made = march_many(problem, solver)
        law[rows] = laws.index(name)
        segments[rows] = made.segments
        status[rows] = made.status
        estimated[rows] = made.estimated + max(problem.curve.fit_error, problem.own.fit_error)
        values = summary_of(problem, made.status, made.core)
        if all_in_one:
            summary = {name: values[name] for name in SUMMARY}
        else:
            for name, column in values.items():
                summary[name][rows] = column
    vibrating, followed = (status == VIBRATES).nonzero()[0], list[Followed]()
    if vibrating.size:
        found = on_modes(scene, columns, vibrating, solver, known)
        status[vibrating] = found.status
        estimated[vibrating] = np.where(found.status >= 0, found.estimated, np.nan)
        laws += [name for name in dict.fromkeys(found.laws) if name not in laws]
        law[vibrating] = [laws.index(name) for name in found.laws]
        for name, values in found.summary.items():
            summary[name][vibrating] = values
        followed = found.followed
    oblique = None
    if scene.contact.friction is not None:
        from film_model.solve.many_friction import oblique_of_many
        from film_model.solve.many_springs import Normal

        turn, end = summary["time_of_maximum_indentation"], summary["contact_duration"]
        normal = Normal(status, summary["rebound_velocity"], turn, end, estimated)
        oblique, left = oblique_of_many(problems, normal, solver)
        for row in left.tolist():
            _one_oblique(oblique, scene, columns, row, solver)
    own = tuple(laws), law, segments, estimated, tuple(problems), tuple(followed)
    return ManyResult(summary, status, *own, oblique)


def _one_oblique(found: ManyOblique, scene: Scene, columns: Mapping[str, Array], row: int, solver: Solver) -> None:
    """The results of one impact, simulated alone."""
    from film_model.effects.choose import choose
    from film_model.oblique.result import REGIMES
    from film_model.scene.columns import scene_of_row
    from film_model.solve.simulate import simulate_chosen

    oblique = simulate_chosen(choose(scene_of_row(scene, columns, row)), solver).oblique
    if oblique is not None:
        number = REGIMES.index(oblique.sliding_regime)
        found.known(row, {**oblique.summary, **oblique.bounds}, number, oblique.estimated)
