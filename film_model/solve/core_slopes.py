"""Derivatives of the core's summary by the dimensionless numbers of the core."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, Mask
from film_model.core import native
from film_model.laws import AbstractLaw
from film_model.problem.mixtures import mixed_numbers, mixture_of
from film_model.problem.own_curves import OwnCurves
from film_model.problem.problem import Problem
from film_model.problem.varied import fitted_by
from film_model.solve.slopes import KINK

_START: tuple[str, ...] = native.START_DTYPE.names or ()
_STOP, _LIMIT, _VALUES = _START.index("stop_velocity"), _START.index("time_limit"), len(native.SUMMARY)
_DEPTH = native.SUMMARY.index("maximum_indentation")


class Stencil(NamedTuple):
    """step: over the number that is varied. offsets: of the impacts beside the one itself, in steps. weights: of the
    derivative, that of the impact itself last. bend: of a difference that shows a kink, likewise; kink: the most of
    it, over the value, of a smooth value."""

    step: float
    offsets: Array
    weights: tuple[float, ...]
    bend: tuple[float, ...] = ()
    kink: float = 0.0

    def slope(self, own: Array, beside: Array) -> Array:
        """The derivative per step; beside: on the last axis, those at the offsets of each number, one after another."""
        return self._sum(own, beside, self.weights)

    def kinked(self, own: Array, beside: Array, size: Array) -> Mask:
        """Whether values have a kink or jump, where the impact itself has a value. size: of the values."""
        with np.errstate(invalid="ignore"):
            bent = ~(abs(self._sum(own, beside, self.bend)) <= self.kink * size)
        return bent & np.isfinite(own)

    def _sum(self, own: Array, beside: Array, weights: tuple[float, ...]) -> Array:
        each = self.offsets.size
        total = weights[0] * beside[..., ::each]
        for k in range(1, each):
            total += weights[k] * beside[..., k::each]
        if weights[-1]:
            total += weights[-1] * own
        return total


FINE = Stencil(
    *(1e-3, np.array([-2.0, 2.0, -1.0, 1.0]), (1 / 12, -1 / 12, -8 / 12, 8 / 12, 0.0)),
    *((1.0, 1.0, -4.0, -4.0, 6.0), KINK),
)
COARSE = Stencil(1e-5, np.array([-1.0, 1.0]), (-0.5, 0.5, 0.0), (1.0, 1.0, -2.0), 1e-7)
AHEAD = Stencil(1e-7, np.array([1.0]), (1.0, -1.0))
"""With errors of about 1e-12, 1e-10 and 1e-7; the last does not show kinks."""


class Gradient(NamedTuple):
    """On one mesh: status; values of the core's summary, (values, impacts), and their derivatives by the numbers of the
    core, (values, impacts, numbers); whether the impacts beside end alike, in one stage and without a kink."""

    status: NDArray[np.int32]
    values: Array
    by: Array
    smooth: Mask

    def part(self, places: Any) -> Gradient:
        """Of some of the impacts."""
        return Gradient(self.status[places], self.values[:, places], self.by[:, places], self.smooth[places])


class CoreSlopes:
    """Impacts that share a curve but for its numbers, by the numbers of the core.

    moved: problem of each of `count` impacts, each followed by those beside it in numbers of the scene. The core's
    numbers are those of its start, those that vary of its curve, and, at the end, those beside its shape.
    step: of the numbers of the scene, relative.
    """

    def __init__(self, moved: Problem, count: int, step: float) -> None:
        self.curve = moved.curve
        if moved.own.page is not self.curve.page and moved.own.page is not None:
            raise ValueError("the curve of one impact is not that of its page")
        start = np.ascontiguousarray(moved.start).view(np.float64).reshape(count, -1, len(_START))
        self._fitted = tuple(fitted_by(moved.impacts.law)) if moved.own.varied is None else ()
        self._law, self._varied = moved.law, moved.own.varied
        self._mixture = mixture_of(moved.law, self._fitted) if self._fitted else None
        own: list[Array] = []
        if moved.own.varied is not None:
            own = list(moved.own.varied.values.T)
        elif moved.own.shape is not None:
            own = [moved.own.shape, *(moved.impacts.law.values[name] for name in self._fitted)]
        columns = [column.reshape(count, -1, 1) for column in own]
        numbers = np.concatenate([start, *columns], axis=2) if own else start
        with np.errstate(invalid="ignore"):
            change, size = numbers - numbers[:, :1], abs(numbers[:, 0])
        change[..., _LIMIT] = 0.0
        size[:, _STOP] = size[:, 0]  # it may be 0, and is a velocity as the first
        moves = (abs(change).max(axis=1) > 1e-9 * step * size).any(axis=0)  # less is rounding
        self.axes = np.flatnonzero(moves)
        if self.axes.size > 8:  # up to 8 numbers of the core are varied one by one
            raise ValueError("differences of whole impacts need fewer marches")
        self._change = np.ascontiguousarray(change[..., moves].transpose(2, 0, 1))
        self._size, self._numbers = size[:, moves], numbers[:, 0]

    def gradient(self, mesh: native.Mesh, places: Index, stencil: Stencil) -> Gradient:
        """March the impacts at `places`, and those beside them in the numbers of the core."""
        own, step = self._numbers[places], stencil.step * self._size[places]
        each, count = stencil.offsets.size, places.size
        numbers = np.repeat(own[:, None], 1 + self.axes.size * each, axis=1)
        for k, axis in enumerate(self.axes.tolist()):
            numbers[:, 1 + k * each : 1 + (k + 1) * each, axis] += step[:, k : k + 1] * stencil.offsets
        status, table = self._march(mesh, numbers)
        smooth = (status[:, 0] >= 0) & ((status == status[:, :1]) & (table["stage"] == table["stage"][:, :1])).all(
            axis=1
        )
        values = table.view(np.float64).reshape(count, numbers.shape[1], -1)[..., :_VALUES].transpose(2, 0, 1)
        itself, beside = values[..., :1], values[..., 1:]
        with np.errstate(invalid="ignore", divide="ignore"):
            by = stencil.slope(itself, beside) / step
        by[:, step == 0.0] = 0.0
        if stencil.bend and self.axes.size:
            smooth &= ~stencil.kinked(itself, beside, _size(itself, own[:, :1])).any(axis=(0, 2))
        return Gradient(status[:, 0], itself[..., 0], by, smooth)

    def _march(self, mesh: native.Mesh, numbers: Array) -> tuple[NDArray[np.int32], NDArray[Any]]:
        """Statuses and the core's summaries, (impacts, those beside)."""
        rows = numbers.reshape(-1, numbers.shape[2])
        start = np.ascontiguousarray(rows[:, : len(_START)]).view(native.START_DTYPE)[:, 0]
        status, table = self._curves(rows[:, len(_START) :]).march(self.curve, mesh, start)
        return status.reshape(numbers.shape[:2]), table.reshape(numbers.shape[:2])

    def _curves(self, own: Array) -> OwnCurves:
        """The curves of impacts. own: the numbers of the core that follow those of its start."""
        if self._varied is not None:
            return OwnCurves(varied=self._varied._replace(values=own))
        if self._mixture is None:
            return OwnCurves(self.curve.page, own[:, 0]) if own.size else OwnCurves()

        def law_at(place: Any) -> AbstractLaw:
            shape, *values = (column[place] for column in own.T)
            return replace(cast("Any", self._law.of_shape(shape)), **dict(zip(self._fitted, values, strict=True)))

        return OwnCurves(self._mixture, mixed_numbers(self._mixture, law_at, len(own)))

    def values(self, gradient: Gradient, places: Index) -> Array:
        """(values of the core's summary, impacts, those beside): to first order."""
        change = self._change[:, places]
        values = np.repeat(gradient.values[..., None], self._change.shape[2], axis=2)
        for axis in range(self.axes.size):
            values += change[axis] * gradient.by[..., axis, None]
        return values


def _size(values: Array, approach: Array) -> Array:
    """Size of values of the core's summary, (values, …): what is a difference, or a part, over the whole."""
    size = abs(values)
    for name, whole in (
        ("permanent_indentation", values[_DEPTH]),
        ("shift", values[_DEPTH]),
        ("final_velocity", approach),
        ("work", approach**2),
    ):
        size[native.SUMMARY.index(name)] += whole
    return size
