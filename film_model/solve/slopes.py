"""Derivatives of the summary of many impacts by numbers of their scene: finite differences of fourth order.

All impacts of a stencil are marched together, with the same decisions and on meshes with the same number of segments.
On such meshes the summary is smooth to rounding, about 1e-15, so that with steps of `STEP` the differences are exact to
about 1e-12. What remains is the error of the mesh, which is estimated from two meshes and refined.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, Mask
from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.core.solving import first_segments
from film_model.effects.many import problems_of, rows_of
from film_model.problem.problem import Problem
from film_model.problem.summary import SUMMARY, summary_of
from film_model.scene import Scene, Solver
from film_model.solve.accuracy import mesh_of

STEP = 1e-3
"""Step over the number that is varied. The error of the differences is about STEP⁴/30 of a fifth derivative, and
rounding over STEP; both are near 1e-12. Needed by tests/test_derivatives.py."""

TARGET, STALLED = 1e-9, 0.5
"""Error to which the derivatives of one impact are refined. Refinement ends, too, where an error falls by less than the
factor `STALLED`: the rest is rounding."""

MESH_FACTOR = {"work-preserving": (1.6, 0.5), "chord": (2.4, 0.6)}
"""Bounds on the error of a derivative on n segments over the difference to 2n, and of 2n over the same."""

MOST_SEGMENTS = 3072
"""Segments per stage of the coarser of the first two meshes, for `TARGET` and at least; and at most."""

KINK = 1e-7
"""Fourth difference of a stencil over the value: h⁴ f⁽⁴⁾ of a smooth value, and up to 2 h times the jump of its slope
at a kink. Needed by tests/test_derivatives.py."""

SMOOTH, NO_DERIVATIVE = 0, 2
"""Sides of a derivative; 1 and −1 are the one-sided ones towards larger and smaller values."""


class _Stencil(NamedTuple):
    """offsets: of the impacts, in steps. weights: of the derivative. base: place of the impact itself."""

    offsets: Array
    weights: Array
    base: int


_ONE_SIDED = np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0
_FOURTH = np.array([1.0, -4.0, 6.0, -4.0, 1.0])

STENCILS = {
    SMOOTH: _Stencil(np.arange(-2.0, 3.0), np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0, 2),
    -1: _Stencil(-np.arange(0.0, 5.0), -_ONE_SIDED, 0),
    1: _Stencil(np.arange(0.0, 5.0), _ONE_SIDED, 0),
}
"""By side, in the order in which they are tried."""


@dataclass(frozen=True)
class Slopes:
    """Derivatives of many pairs of an impact and a number.

    values: the derivatives, SI; a row for each pair, a column for each value of `SUMMARY`, or of `OBLIQUE` along the
    surface; nan where there is none.
    errors: their estimated errors, over the larger of the derivative and the value divided by the number. kinks: where
    the value has a kink or jump within the stencil, and so no derivative. Of each pair, side: `SMOOTH`, 1, −1 or
    `NO_DERIVATIVE`; other_end, other_stage: whether impacts of the central stencil end otherwise, or reach other stages
    of the law.
    """

    values: Array
    errors: Array
    side: NDArray[np.int8]
    kinks: Mask
    other_end: Mask
    other_stage: Mask

    @classmethod
    def none(cls, count: int, results: int = len(SUMMARY)) -> Slopes:
        """Of `count` pairs of which nothing is known yet."""
        values, errors = np.full((2, results, count), np.nan).transpose(0, 2, 1)
        kinks, (other_end, other_stage) = np.zeros(values.shape, np.bool_), np.zeros((2, count), np.bool_)
        return cls(values, errors, np.full(count, NO_DERIVATIVE, np.int8), kinks, other_end, other_stage)

    def put(self, places: Index, slope: Array, change: Array, values: Array, number: Array, factor: float) -> Array:
        """Set derivatives and errors; the largest error of each pair.

        change: of the derivative between two meshes; both are nan at kinks. values: of the summary, and number, by
        which it is differentiated. factor: bound on the error over the change.
        """
        with np.errstate(invalid="ignore", divide="ignore"):
            size = np.fmax(abs(slope), abs(values / number[:, None]))
            error = np.where(change == 0.0, 0.0, factor * abs(change) / size)
        self.values[places], self.errors[places] = slope, error
        return np.fmax.reduce(error, axis=1, initial=0.0)


@dataclass(frozen=True)
class Pairs:
    """Impacts, each with the number that is varied.

    scene: without decisions of "auto". columns: numbers of the impacts, one each, SI. paths: what is varied; which:
    the place in `paths` of each pair. value, step: of the varied number, SI; low, high: its range. strength: of each
    impact's law at its strain rate, Pa, if the scene has rate hardening.
    """

    scene: Scene
    columns: Mapping[str, Array]
    paths: Sequence[str]
    which: Index
    value: Array
    step: Array
    low: Array
    high: Array
    strength: Array | None

    def part(self, places: Index) -> Pairs:
        """Some of the pairs."""
        columns = {path: values[places] for path, values in self.columns.items()}
        value, step, low, high = (column[places] for column in (self.value, self.step, self.low, self.high))
        strength = None if self.strength is None else self.strength[places]
        return Pairs(self.scene, columns, self.paths, self.which[places], value, step, low, high, strength)

    def fits(self, offsets: Array) -> Mask:
        """Whether a stencil is within the range of scenes."""
        low, high = (self.value + self.step * end for end in (offsets.min(), offsets.max()))
        return (low >= self.low) & (high <= self.high) & (self.step > 0.0)

    def moved(self, offset: float) -> dict[str, Array]:
        """The columns of the impacts with the varied number some steps off."""
        columns = dict(self.columns)
        for k, path in enumerate(self.paths):
            columns[path] = columns[path] + np.where(self.which == k, offset * self.step, 0.0)
        return columns


def differences(pairs: Pairs, solver: Solver, target: float, found: Slopes) -> None:
    """Set the derivatives that are not yet found; one-sided ones where the central stencil leaves the stage of the law
    and the other side does not.

    target: estimated error up to which meshes are refined.
    """
    together = 8192  # stencils at a time, which bounds the memory
    left = np.flatnonzero(found.side == NO_DERIVATIVE)
    for side, stencil in STENCILS.items() if left.size else ():
        tried = left[pairs.part(left).fits(stencil.offsets)]
        for first in range(0, tried.size, together):
            places = tried[first : first + together]
            _set(found, places, _Marches(pairs.part(places), solver, stencil, target), side)
        left = left[found.side[left] == NO_DERIVATIVE]


class Meshes(NamedTuple):
    """Segments per stage of the meshes from which error and derivative are taken first. factor: bound on the error of
    the derivative over the difference of the two. target: error up to which they are refined; infinite if the scene
    gives the number of segments."""

    first: tuple[int, int]
    factor: float
    target: float

    @classmethod
    def of(cls, problems: Sequence[Problem], solver: Solver, target: float) -> Meshes:
        """For some problems."""
        of_coarse, of_fine = MESH_FACTOR[solver.linearisation]
        if solver.segments is not None:
            return cls((2 * solver.segments, solver.segments), of_coarse, math.inf)
        damping = max((float(np.max(problem.damping)) for problem in problems), default=0.0)
        wanted = math.ceil(72 * (TARGET / target) ** 0.25)  # 72 segments for `TARGET`
        n = first_segments(damping, max(wanted, 4))
        return cls((n, 2 * n), of_fine, target)


class _Marched(NamedTuple):
    """The impacts of stencils on one mesh: summary (pairs, values, impacts of a stencil), status and stage (pairs,
    impacts); nan and a negative status where one fails."""

    summary: Array
    status: NDArray[np.int32]
    stage: NDArray[np.int32]

    def part(self, places: Index) -> _Marched:
        """Some of the pairs."""
        return _Marched(self.summary[places], self.status[places], self.stage[places])


class _Marches:
    """The impacts of the stencils of some pairs, on any mesh."""

    def __init__(self, pairs: Pairs, solver: Solver, stencil: _Stencil, target: float) -> None:
        self.pairs, self.stencil, self._solver = pairs, stencil, solver
        self._shape = count, _ = pairs.which.size, stencil.offsets.size
        self._problems: list[tuple[int, Problem]] = []  # with their places in the stencil
        for place, offset in enumerate(stencil.offsets.tolist()):  # apart, so that equal numbers share a curve
            try:
                found = problems_of(pairs.scene, pairs.moved(offset), count)
            except (ValueError, SimulationError):  # at this place no impact is possible
                continue
            self._problems += [(place, problem) for problem in found]
        self.meshes = Meshes.of([problem for _, problem in self._problems], solver, target)

    def on(self, n: int, places: Index) -> _Marched:
        """The stencils of the pairs at `places`, with n segments per stage."""
        count, width = self._shape
        summary = np.full((len(SUMMARY), count * width), np.nan)
        status, stage = np.full(count * width, native.BAD_NUMBER, np.int32), np.zeros(count * width, np.int32)
        for place, problem in self._problems:
            if places.size < count:
                problem = problem.part(np.flatnonzero(np.isin(rows_of(problem), places)))
            rows = rows_of(problem) * width + place
            status[rows], core = problem.march(mesh_of(self._solver, problem.curve.segments(n)))
            stage[rows] = core.stage
            summary[:, rows] = summaries(problem, status[rows], core)
        whole = _Marched(
            summary.reshape(-1, count, width).transpose(1, 0, 2),
            status.reshape(count, width),
            stage.reshape(count, width),
        )
        return whole.part(places)


def summaries(problem: Problem, status: Any, core: Any) -> Array:
    """The summaries of many impacts, (values of `SUMMARY`, impacts), SI; of several meshes, (values, meshes, impacts).

    core: Columns of the core's summaries.
    """
    found = summary_of(problem, status, core)
    table = np.empty((len(SUMMARY), *status.shape))
    for k, name in enumerate(SUMMARY):
        table[k] = found[name]
    return table


def _set(found: Slopes, places: Index, marches: _Marches, side: int) -> None:
    """Set the derivatives of the pairs at `places` whose impacts end alike and within one stage of the law."""
    every, base, meshes = np.arange(places.size), marches.stencil.base, marches.meshes
    coarse, fine = (marches.on(n, every) for n in meshes.first)
    other_end = (fine.status != fine.status[:, [base]]).any(axis=1) | (fine.status[:, base] < 0)
    other_stage = (fine.stage != fine.stage[:, [base]]).any(axis=1)
    if side == SMOOTH:
        found.other_end[places], found.other_stage[places] = other_end, other_stage
    left = np.flatnonzero(~other_end & ~other_stage)
    found.side[places[left]] = side
    found.kinks[places[left]] = kinked(fine.summary[left], base)
    coarse, fine = coarse.part(left), fine.part(left)
    n, last = meshes.first[1], np.full(left.size, np.inf)
    while left.size:
        worst = _differentiate(found, places[left], marches, left, (coarse, fine))
        n *= 2
        open_ = np.flatnonzero((worst > meshes.target) & (worst < STALLED * last))
        if n > MOST_SEGMENTS or not open_.size:
            return
        left, last = left[open_], worst[open_]
        coarse, fine = fine.part(open_), marches.on(n, left)


def _differentiate(
    found: Slopes, places: Index, marches: _Marches, pairs: Index, meshes: tuple[_Marched, _Marched]
) -> Array:
    """Set derivatives and errors at `places` from two meshes; the largest error of each pair."""
    weights, base, own = marches.stencil.weights, marches.stencil.base, marches.pairs.part(pairs)
    rough, fine = (applied(marched.summary, weights) / own.step[:, None] for marched in meshes)
    fine[found.kinks[places]] = np.nan
    return found.put(places, fine, rough - fine, meshes[1].summary[:, :, base], own.value, marches.meshes.factor)


def kinked(summary: Array, base: int, most: float = KINK) -> Mask:
    """Whether the values of a stencil, where the impact itself has one, have a kink or a jump."""
    with np.errstate(invalid="ignore"):
        smooth = abs(applied(summary, _FOURTH)) <= most * abs(summary[..., base])
    return np.isfinite(summary[..., base]) & ~smooth


def applied(values: Array, weights: Array) -> Array:
    """Weighted sums over stencils, without BLAS: the rounding is the same on every processor."""
    return (values * weights).sum(axis=-1)
