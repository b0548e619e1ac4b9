"""Derivatives of the summary by numbers of a scene, by the chain rule through the few numbers of the core.

The core's summary depends on a handful of dimensionless numbers (`AXES`). Only these are varied in marches. How they, and
the scales of the summary, depend on the numbers of the scene is found on arrays, without a march. Impacts for which this
does not serve, because a kink is near or every value of a number has a curve of its own, are left to the differences of
whole impacts (:mod:`film_model.solve.slopes`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, Mask
from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.effects.decided import decided_impacts, decided_problem
from film_model.effects.edge_effects import edged, infinite_unless_judged
from film_model.effects.many import curve_keys
from film_model.problem.problem import Columns, Problem
from film_model.scene import Solver
from film_model.solve.accuracy import mesh_of
from film_model.solve.slopes import (
    KINK,
    MOST_SEGMENTS,
    SMOOTH,
    STALLED,
    STEP,
    Meshes,
    Pairs,
    Slopes,
    applied,
    differences,
    summaries,
)

AXES = ("approach", "gamma", "load", "damping", "stop_velocity")
"""Numbers of a problem on which the core's summary depends, beside those of its curve."""

TOGETHER = 65536
"""Impacts of stencils that are in memory at a time."""

ROUGH = 1e-6
"""From this error on, differences of second order serve."""

MOVES = 1e-9
"""Relative change of a number of the core, over that of a number of the scene, below which it is rounding."""

_VALUES, _DEPTH = len(native.SUMMARY), native.SUMMARY.index("maximum_indentation")


class _Stencil(NamedTuple):
    """step: over the number that is varied. offsets: in steps, first the impact itself. weights: of the derivative.
    bend: of a difference that shows a kink. kink: the most of it, over the value, of a smooth value."""

    step: float
    offsets: Array
    weights: Array
    bend: Array
    kink: float


_FINE = _Stencil(
    1e-3,
    np.array([0.0, -2.0, -1.0, 1.0, 2.0]),
    np.array([0.0, 1.0, -8.0, 8.0, -1.0]) / 12.0,
    np.array([6.0, 1.0, -4.0, -4.0, 1.0]),
    KINK,
)
_COARSE = _Stencil(1e-5, np.array([0.0, -1.0, 1.0]), np.array([0.0, -0.5, 0.5]), np.array([-2.0, 1.0, 1.0]), 1e-7)
"""With errors of about 1e-12, and of about 1e-10."""


def slopes(pairs: Pairs, solver: Solver, target: float) -> Slopes:
    """The derivatives of all numbers of some impacts; target: estimated error up to which meshes are refined."""
    found = Slopes.none(pairs.which.size)
    stencil, numbers = _FINE if target < ROUGH else _COARSE, len(pairs.paths)
    together = numbers * max(TOGETHER // (numbers * stencil.offsets.size), 1)
    for first in range(0, pairs.which.size, together):
        places = np.arange(first, min(first + together, pairs.which.size))
        try:
            for rows, chain in _chains(pairs.part(places), _How(solver, target, stencil)):
                _set(found, places.reshape(-1, numbers)[rows], chain)
        except (TypeError, ValueError, SimulationError):  # a law or a target that accepts numbers only
            continue
    differences(pairs, solver, target, found)
    return found


class _How(NamedTuple):
    """How derivatives are computed."""

    solver: Solver
    target: float
    stencil: _Stencil


def _chains(pairs: Pairs, how: _How) -> Iterator[tuple[Index, _Chain]]:
    """The impacts on each curve, with their places."""
    if edged(pairs.scene) and not infinite_unless_judged(pairs.scene):
        return  # the target's static stiffness is a part of the curve
    numbers, offsets, scale = len(pairs.paths), how.stencil.offsets, how.stencil.step / STEP
    count, inside = pairs.which.size // numbers, np.arange(numbers * offsets.size)
    step = np.where(pairs.fits(offsets * scale), pairs.step * scale, 0.0).reshape(count, numbers)
    columns = {path: np.repeat(values[::numbers], inside.size) for path, values in pairs.columns.items()}
    for k, path in enumerate(pairs.paths):
        columns[path].reshape(count, numbers, offsets.size)[:, k] += np.outer(step[:, k], offsets)
    impacts, value = decided_impacts(pairs.scene, columns, count * inside.size), pairs.value.reshape(count, numbers)
    keys = curve_keys(impacts.law)
    if not keys:
        yield np.arange(count), _Chain(decided_problem(impacts), value, step, how)
        return
    table = np.stack(keys, axis=-1).reshape(count, inside.size, -1)
    alike = np.flatnonzero((table == table[:, :1]).all(axis=(1, 2)))
    _, kind = np.unique(table[alike, 0], axis=0, return_inverse=True)
    for k in range(int(kind.max(initial=-1)) + 1):
        rows = alike[kind.ravel() == k]
        part = impacts.part((rows[:, None] * inside.size + inside).ravel())
        yield rows, _Chain(decided_problem(part), value[rows], step[rows], how)


class _Gradient(NamedTuple):
    """On one mesh: status; values of the core's summary, (impacts, values), and their derivatives by the numbers of the
    core, (impacts, numbers, values); whether the impacts beside end alike, in one stage and without a kink."""

    status: NDArray[np.int32]
    values: Array
    by: Array
    smooth: Mask

    def part(self, places: Index) -> _Gradient:
        """Of some of the impacts."""
        return _Gradient(*(column[places] for column in self))


class _Chain:
    """Impacts on one curve.

    moved: their problem: each once for each number of the scene and each place of its stencil. value, step: (impacts,
    numbers of the scene), SI; the step is 0 where the stencil is out of range.
    """

    def __init__(self, moved: Problem, value: Array, step: Array, how: _How) -> None:
        solver, target, stencil = how
        self.value, self.step, self.stencil, self._moved, self._solver = value, step, stencil, moved, solver
        self._shape = *step.shape, stencil.offsets.size
        self.itself = moved.part(np.arange(len(step)) * (step.shape[1] * stencil.offsets.size))
        self.meshes = Meshes.of([self.itself], solver, target)
        numbers = _numbers_of(moved).reshape(*self._shape, -1)
        change, size = numbers - numbers[:, :1, :1], abs(numbers[:, 0, 0])
        stop = AXES.index("stop_velocity")
        size[:, stop] = size[:, 0]  # it may be 0, and is a velocity as the first
        moves = (abs(change) > (MOVES * stencil.step) * size[:, None, None]).any(axis=(0, 1, 2))
        self._axes = np.flatnonzero(moves)
        self._change, self._size, self._numbers = change[..., moves], size[:, moves], numbers[:, 0, 0]

    def gradient(self, n: int, places: Index) -> _Gradient:
        """March the impacts at `places`, and those beside them, with n segments per stage."""
        stencil = self.stencil
        beside = stencil.offsets[1:]
        width = 1 + self._axes.size * beside.size
        step = stencil.step * self._size[places]
        numbers = np.repeat(self._numbers[places][:, None], width, axis=1)
        for k, axis in enumerate(self._axes.tolist()):
            at = slice(1 + k * beside.size, 1 + (k + 1) * beside.size)
            numbers[:, at, axis] += np.outer(step[:, k], beside)
        problem = _with_numbers(self.itself.part(np.repeat(places, width)), numbers.reshape(-1, numbers.shape[-1]))
        status, core = problem.march(mesh_of(self._solver, problem.curve.segments(n)))
        values = core.table.view(np.float64).reshape(places.size, width, -1)[:, :, :_VALUES]
        status, stage = status.reshape(-1, width), core.stage.reshape(-1, width)
        smooth = (status[:, 0] >= 0) & (status == status[:, :1]).all(axis=1) & (stage == stage[:, :1]).all(axis=1)
        whole = np.empty((places.size, self._axes.size, _VALUES, stencil.offsets.size))
        whole[..., 0] = values[:, None, 0]
        whole[..., 1:] = values[:, 1:].reshape(*whole.shape[:2], beside.size, _VALUES).swapaxes(2, 3)
        with np.errstate(invalid="ignore", divide="ignore"):
            by = np.where(step[:, :, None] > 0.0, applied(whole, stencil.weights) / step[:, :, None], 0.0)
        size = _size(values[:, 0], self._numbers[places, 0])[:, None]
        return _Gradient(status[:, 0], values[:, 0], by, smooth & ~_kinked(whole, size, stencil).any(axis=(1, 2)))

    def summaries(self, places: Index, gradients: tuple[_Gradient, ...]) -> list[Array]:
        """For each gradient: (impacts, numbers of the scene, values of `SUMMARY`, places of the stencil)."""
        _, numbers, width = self._shape
        change = self._change[places]
        table = np.zeros((len(gradients), places.size, numbers, width), native.SUMMARY_DTYPE)
        values = table.view(np.float64).reshape(*table.shape, -1)
        for k, gradient in enumerate(gradients):
            values[k, ..., :_VALUES] = gradient.values[:, None, None]
            for axis in range(self._axes.size):
                values[k, ..., :_VALUES] += change[..., axis, None] * gradient.by[:, None, None, axis]
        inside = (places[:, None] * (numbers * width) + np.arange(numbers * width)).ravel()
        problem = self._moved.part(np.tile(inside, len(gradients)))
        status = np.repeat(np.concatenate([gradient.status for gradient in gradients]), numbers * width)
        found = summaries(problem, status, Columns(table.ravel()))
        return list(found.reshape(-1, *table.shape).transpose(1, 2, 3, 0, 4))


def _numbers_of(problem: Problem) -> Array:
    """(impacts, numbers): `AXES`, and those on which the curve depends."""
    columns = [np.broadcast_to(getattr(problem, name), problem.approach.shape) for name in AXES]
    if problem.varied is not None:
        columns += list(problem.varied.values.T)
    elif problem.shape is not None:
        columns.append(problem.shape)
    return np.stack(columns, axis=-1)


def _with_numbers(problem: Problem, numbers: Array) -> Problem:
    """The problem with other numbers for the core."""
    approach, gamma, load, damping, stop, *_ = numbers.T
    drift = -stop * problem.share * problem.scales.velocity if problem.free else problem.drift
    own, varied = numbers[:, len(AXES) :], problem.varied
    return replace(
        problem,
        approach=approach,
        gamma=gamma,
        load=load,
        damping=damping,
        drift=drift,
        shape=own[:, 0] if varied is None and problem.shape is not None else problem.shape,
        varied=None if varied is None else Varied(varied.places, own),
    )


def _size(values: Array, approach: Array) -> Array:
    """Size of values of the core's summary, (impacts, values): what is a difference, or a part, over the whole."""
    size = abs(values)
    for name, whole in (
        ("permanent_indentation", values[:, _DEPTH]),
        ("shift", values[:, _DEPTH]),
        ("final_velocity", approach),
        ("work", approach**2),
    ):
        size[:, native.SUMMARY.index(name)] += whole
    return size


def _kinked(values: Array, size: Array, stencil: _Stencil) -> Mask:
    """Whether values on a stencil, on the last axis, have a kink or jump, where the impact itself has a value."""
    with np.errstate(invalid="ignore"):
        bent = ~(abs(applied(values, stencil.bend)) <= stencil.kink * size)
    return bent & np.isfinite(values[..., 0])


def _set(found: Slopes, pairs: Index, chain: _Chain) -> None:
    """Set the derivatives of impacts without kinks. pairs: (impacts, numbers of the scene), places in `found`."""
    n, meshes, weights = chain.meshes.first[1], chain.meshes, chain.stencil.weights
    left = np.arange(chain.itself.approach.size)
    gradients = tuple(chain.gradient(k, left) for k in meshes.first)
    smooth = np.flatnonzero(gradients[0].smooth & gradients[1].smooth)
    left, gradients = left[smooth], tuple(gradient.part(smooth) for gradient in gradients)
    last, before = np.full(left.size, np.inf), None
    while left.size:
        every = chain.summaries(left, gradients)
        step, summary = chain.step[left][:, :, None], every[-1]
        with np.errstate(invalid="ignore", divide="ignore"):
            by = [applied(values, weights) / step for values in every]
        rough, fine = by if before is None else (before, by[0])
        known = (step[..., 0] > 0.0) & ~_kinked(summary, abs(summary[..., 0]), chain.stencil).any(axis=-1)
        places = pairs[left][known]
        found.side[places] = SMOOTH
        worst = np.zeros(known.shape)
        own = summary[..., 0][known], chain.value[left][known]
        worst[known] = found.put(places, (rough[known], fine[known]), *own, meshes.factor)
        n, largest = 2 * n, worst.max(axis=1)
        open_ = np.flatnonzero((largest > meshes.target) & (largest < STALLED * last))
        if n > MOST_SEGMENTS or not open_.size:
            return
        left, last, before = left[open_], largest[open_], fine[open_]
        gradients = (chain.gradient(n, left),)
