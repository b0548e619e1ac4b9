"""Derivatives of the summary of many impacts by numbers of their scene: finite differences of fourth order.

All impacts of a stencil are marched together, with the same decisions and on meshes with the same number of segments.
On such meshes the summary is smooth to rounding, about 1e-15, so that with steps of `STEP` the differences are exact to
about 1e-12. What remains is the error of the mesh, which is estimated from two meshes and refined.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, Mask
from film_model.core import native
from film_model.effects.many import problems_of, rows_of
from film_model.problem.summary import SUMMARY, summary_of
from film_model.scene import Scene, Solver
from film_model.solve.accuracy import ORDER_FACTOR, first_segments, mesh_of

STEP = 1e-3
"""Step over the number that is varied. The error of the differences is about STEP⁴/30 of a fifth derivative, and
rounding over STEP; both are near 1e-12. Needed by tests/test_derivatives.py."""

TARGET, STALLED = 1e-9, 0.5
"""Error to which the derivatives of one impact are refined. Refinement ends, too, where an error falls by less than the
factor `STALLED`: the rest is rounding."""

FIRST_SEGMENTS, LEAST_SEGMENTS, MOST_SEGMENTS = 48, 6, 3072
"""Segments per stage of the coarser of the first two meshes, for `TARGET` and at least; and at most."""

KINK = 1e-7
"""Fourth difference of a stencil over the value: h⁴ f⁽⁴⁾ of a smooth value, and up to 2 h times the jump of its slope
at a kink. Needed by tests/test_derivatives.py."""

TOGETHER = 8192
"""Stencils that are marched at a time, which bounds the memory."""

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

    values: by the names of `SUMMARY`, SI, nan where there is none. errors: the same, estimated, relative to the larger
    of the derivative and the value over the number. side: `SMOOTH`, 1 or −1, `NO_DERIVATIVE`. kinks: values with a
    kink or a jump within the stencil, whose derivative is nan. other_end, other_stage: whether impacts of the central
    stencil end otherwise, or reach other stages of the law.
    """

    values: dict[str, Array]
    errors: dict[str, Array]
    side: NDArray[np.int8]
    kinks: dict[str, Mask]
    other_end: Mask
    other_stage: Mask


@dataclass(frozen=True)
class Pairs:
    """Impacts, each with the number that is varied.

    scene: without decisions of "auto". columns: numbers of the impacts, one each, SI. paths: what is varied; which:
    the place in `paths` of each pair. step: of each pair, SI. low, high: range of the varied number.
    """

    scene: Scene
    columns: Mapping[str, Array]
    paths: Sequence[str]
    which: Index
    step: Array
    low: Array
    high: Array

    def part(self, places: Index) -> Pairs:
        """Some of the pairs."""
        columns = {path: values[places] for path, values in self.columns.items()}
        step, low, high = (values[places] for values in (self.step, self.low, self.high))
        return Pairs(self.scene, columns, self.paths, self.which[places], step, low, high)

    @property
    def value(self) -> Array:
        """The number that is varied, of each pair."""
        return np.stack([self.columns[path] for path in self.paths])[self.which, np.arange(self.which.size)]

    def fits(self, offsets: Array) -> Mask:
        """Whether a stencil is within the range of scenes."""
        low, high = (self.value + self.step * end for end in (offsets.min(), offsets.max()))
        return (low >= self.low) & (high <= self.high) & (self.step > 0.0)

    def moved(self, offsets: Array) -> dict[str, Array]:
        """The columns of the impacts of a stencil, those of each pair together."""
        columns = {path: np.repeat(values, offsets.size) for path, values in self.columns.items()}
        for k, path in enumerate(self.paths):
            columns[path] += np.outer(np.where(self.which == k, self.step, 0.0), offsets).ravel()
        return columns


def slopes(pairs: Pairs, solver: Solver, target: float) -> Slopes:
    """The derivatives; one-sided where the central stencil leaves the stage of the law and the other side does not.

    target: estimated error up to which meshes are refined.
    """
    count = pairs.which.size
    found = Slopes(
        {name: np.full(count, np.nan) for name in SUMMARY},
        {name: np.full(count, np.nan) for name in SUMMARY},
        np.full(count, NO_DERIVATIVE, np.int8),
        {name: np.zeros(count, np.bool_) for name in SUMMARY},
        np.zeros(count, np.bool_),
        np.zeros(count, np.bool_),
    )
    left = np.arange(count)
    for side, stencil in STENCILS.items():
        tried = left[pairs.part(left).fits(stencil.offsets)]
        for first in range(0, tried.size, TOGETHER):
            places = tried[first : first + TOGETHER]
            _set(found, places, _Marches(pairs.part(places), solver, stencil, target), side)
        left = left[found.side[left] == NO_DERIVATIVE]
    return found


class _Marched(NamedTuple):
    """The impacts of stencils on one mesh: (pairs, impacts of a stencil); nan and a negative status where one fails."""

    summary: dict[str, Array]
    status: NDArray[np.int32]
    stage: NDArray[np.int32]


class _Marches:
    """The impacts of the stencils of some pairs, on any mesh."""

    def __init__(self, pairs: Pairs, solver: Solver, stencil: _Stencil, target: float) -> None:
        self.pairs, self.stencil, self.target, self._solver = pairs, stencil, target, solver
        self._shape = pairs.which.size, stencil.offsets.size
        self._problems = problems_of(pairs.scene, pairs.moved(stencil.offsets), pairs.which.size * stencil.offsets.size)

    @property
    def meshes(self) -> tuple[int, int]:
        """Segments per stage of the meshes from which error and derivative are taken first."""
        if self._solver.segments is not None:
            return 2 * self._solver.segments, self._solver.segments
        damping = max((float(np.max(problem.damping)) for problem in self._problems), default=0.0)
        wanted = math.ceil(FIRST_SEGMENTS * (TARGET / self.target) ** 0.25)
        n = first_segments(damping, max(wanted, LEAST_SEGMENTS))
        return n, 2 * n

    @property
    def fixed(self) -> bool:
        """Whether the scene gives the number of segments, so that they are not refined."""
        return self._solver.segments is not None

    @property
    def factor(self) -> float:
        """Bound on the error of the derivative over the difference of the two meshes."""
        coarse, fine = ORDER_FACTOR[self._solver.linearisation]
        return coarse if self.fixed else fine

    def on(self, n: int, places: Index) -> _Marched:
        """The stencils of the pairs at `places`, with n segments per stage."""
        count, width = self._shape
        summary = {name: np.full(count * width, np.nan) for name in SUMMARY}
        status, stage = np.full(count * width, native.BAD_NUMBER, np.int32), np.zeros(count * width, np.int32)
        for problem in self._problems:
            if places.size < count:
                problem = problem.part(np.flatnonzero(np.isin(rows_of(problem) // width, places)))
            rows = rows_of(problem)
            status[rows], core = problem.march(mesh_of(self._solver, problem.curve.segments(n)))
            stage[rows] = core.stage
            for name, column in summary_of(problem, status[rows], core).items():
                summary[name][rows] = column
        shaped = {name: column.reshape(self._shape)[places] for name, column in summary.items()}
        return _Marched(shaped, status.reshape(self._shape)[places], stage.reshape(self._shape)[places])


def _set(found: Slopes, places: Index, marches: _Marches, side: int) -> None:
    """Set the derivatives of the pairs at `places` whose impacts end alike and within one stage of the law."""
    every, base = np.arange(places.size), marches.stencil.base
    meshes = marches.meshes
    coarse, fine = (marches.on(n, every) for n in meshes)
    other_end = (fine.status != fine.status[:, [base]]).any(axis=1) | (fine.status[:, base] < 0)
    other_stage = (fine.stage != fine.stage[:, [base]]).any(axis=1)
    if side == SMOOTH:
        found.other_end[places], found.other_stage[places] = other_end, other_stage
    left = np.flatnonzero(~other_end & ~other_stage)
    found.side[places[left]] = side
    for name, column in fine.summary.items():
        found.kinks[name][places[left]] = _kinked(column[left], base)
    coarse, fine = (_picked(marched, left) for marched in (coarse, fine))
    n, last = meshes[1], np.full(left.size, np.inf)
    while left.size:
        worst = _differentiate(found, places[left], marches, left, (coarse, fine))
        n *= 2
        if n > MOST_SEGMENTS or marches.fixed:
            return
        open_ = np.flatnonzero((worst > marches.target) & (worst < STALLED * last))
        left, last = left[open_], worst[open_]
        coarse, fine = _picked(fine, open_), marches.on(n, left)


def _differentiate(
    found: Slopes, places: Index, marches: _Marches, pairs: Index, meshes: tuple[_Marched, _Marched]
) -> Array:
    """Set derivatives and errors at `places` from two meshes; the largest error of each pair."""
    weights, base, own = marches.stencil.weights, marches.stencil.base, marches.pairs.part(pairs)
    rough, fine = meshes
    worst = np.zeros(pairs.size)
    for name, column in fine.summary.items():
        slope, other = (_applied(values, weights) / own.step for values in (column, rough.summary[name]))
        with np.errstate(invalid="ignore", divide="ignore"):
            size = np.fmax(abs(slope), abs(column[:, base] / own.value))
            error = np.where(slope == other, 0.0, marches.factor * abs(slope - other) / size)
        kinked = found.kinks[name][places]
        found.values[name][places] = np.where(kinked, np.nan, slope)
        found.errors[name][places] = np.where(kinked, np.nan, error)
        worst = np.fmax(worst, found.errors[name][places])
    return worst


def _picked(marched: _Marched, places: Index) -> _Marched:
    summary = {name: column[places] for name, column in marched.summary.items()}
    return _Marched(summary, marched.status[places], marched.stage[places])


def _kinked(column: Array, base: int) -> Mask:
    """Whether the values of a stencil, where the impact itself has one, have a kink or a jump."""
    with np.errstate(invalid="ignore"):
        smooth = abs(_applied(column, _FOURTH)) <= KINK * abs(column[:, base])
    return np.isfinite(column[:, base]) & ~smooth


def _applied(column: Array, weights: Array) -> Array:
    """Weighted sums over stencils, without BLAS: the rounding is the same on every processor."""
    return (column * weights).sum(axis=-1)
