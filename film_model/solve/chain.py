"""Derivatives of the summary by numbers of a scene, by the chain rule through the few numbers of the core.

The core's summary depends on a handful of dimensionless numbers (`AXES`). Only these are varied in marches. How they,
and the scales of the summary, depend on the numbers of the scene is found on arrays, without a march. Impacts for which
this does not serve, because a kink is near or every value of a number has a curve of its own, are left to the
differences of whole impacts (:mod:`film_model.solve.slopes`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, Mask
from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.effects.decided import decided_impacts, decided_problem
from film_model.effects.edge_effects import edged, infinite_unless_judged
from film_model.effects.many import FEW, curve_keys
from film_model.effects.rate_hardening import factor_at
from film_model.problem.law_of_scene import SceneLaw
from film_model.problem.problem import TRIAL_SEGMENTS, Columns, Impacts, Problem
from film_model.problem.varied import fitted_by
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
    differences,
    summaries,
)

AXES = ("approach", "gamma", "load", "damping", "stop_velocity")
"""Numbers of a problem on which the core's summary depends, beside those of its curve."""

TOGETHER = 16384
"""Impacts of stencils that are in memory at a time: few, so that their columns stay in the processor's cache."""

ROUGH = 1e-6
"""From this error on, differences of second order serve."""

MOVES = 1e-9
"""Relative change of a number of the core, over that of a number of the scene, below which it is rounding."""

MOST_AXES = 8
"""Numbers of the core, up to which they are varied one by one."""

_VALUES, _DEPTH, _STOP = len(native.SUMMARY), native.SUMMARY.index("maximum_indentation"), AXES.index("stop_velocity")


class _Stencil(NamedTuple):
    """step: over the number that is varied. offsets: of the impacts beside the one itself, in steps, the last of which
    is the nearest above it. weights: of the derivative. bend: of a difference that shows a kink, with `own` for the
    impact itself; kink: the most of it, over the value, of a smooth value. trial: segments per stage of the march that
    gives the strain rate."""

    step: float
    offsets: Array
    weights: tuple[float, ...]
    bend: tuple[float, ...]
    own: float
    kink: float
    trial: int

    def slope(self, beside: Array) -> Array:
        """The derivative per step; beside: values at the offsets, on the last axis but one."""
        return _sum(beside, self.weights)

    def kinked(self, own: Array, beside: Array, size: Array) -> Mask:
        """Whether values have a kink or jump, where the impact itself has a value. size: of the values."""
        with np.errstate(invalid="ignore"):
            bent = ~(abs(_sum(beside, self.bend) + self.own * own) <= self.kink * size)
        return bent & np.isfinite(own)


def _sum(beside: Array, weights: tuple[float, ...]) -> Array:
    return sum((weight * beside[..., k, :] for k, weight in enumerate(weights)), np.zeros(()))


_FINE = _Stencil(
    *(1e-3, np.array([-2.0, 2.0, -1.0, 1.0]), (1 / 12, -1 / 12, -8 / 12, 8 / 12)),
    *((1.0, 1.0, -4.0, -4.0), 6.0, KINK, TRIAL_SEGMENTS),
)
_COARSE = _Stencil(1e-5, np.array([-1.0, 1.0]), (-0.5, 0.5), (1.0, 1.0), -2.0, 1e-7, TRIAL_SEGMENTS // 2)
"""With errors of about 1e-12, and of about 1e-10."""


class _How(NamedTuple):
    """How derivatives are computed."""

    solver: Solver
    target: float
    stencil: _Stencil


def slopes(pairs: Pairs, solver: Solver, target: float) -> Slopes:
    """The derivatives of all numbers of some impacts; target: estimated error up to which meshes are refined."""
    found = Slopes.none(pairs.which.size)
    chain_rule(pairs, solver, target, found)
    differences(pairs, solver, target, found)
    return found


def chain_rule(pairs: Pairs, solver: Solver, target: float, found: Slopes) -> None:
    """Set the derivatives of impacts that are smooth and share their curve with those beside them."""
    how = _How(solver, target, _FINE if target < ROUGH else _COARSE)
    numbers = len(pairs.paths)
    together = numbers * max(TOGETHER // (1 + numbers * how.stencil.offsets.size), 1)
    for first in range(0, pairs.which.size, together):
        places = np.arange(first, min(first + together, pairs.which.size))
        try:
            for rows, chain in _chains(pairs.part(places), how):
                _set(found, places.reshape(-1, numbers)[rows], chain)
        except (TypeError, ValueError, SimulationError):  # a law or a target that accepts numbers only
            continue


def _chains(pairs: Pairs, how: _How) -> Iterator[tuple[Index, _Chain]]:
    """The impacts on each curve, with their places."""
    if edged(pairs.scene) and not infinite_unless_judged(pairs.scene):
        return  # the target's static stiffness is a part of the curve
    numbers, scale = len(pairs.paths), how.stencil.step / STEP
    step = np.where(pairs.fits(how.stencil.offsets * scale), pairs.step * scale, 0.0).reshape(-1, numbers)
    impacts = _beside(pairs, step, how.stencil)
    shared = curve_keys(impacts.law)
    keys = _stacked(shared, len(step))
    own = _stacked([*shared, *fitted_by(impacts.law).values()], len(step))
    other = (own != own[:, :1]).any(axis=2)
    if other.any():  # stencils that need more than one curve are left out
        step[other[:, 1:].reshape(len(step), numbers, -1).any(axis=2)] = 0.0
        impacts = _beside(pairs, step, how.stencil)
        keys = _keys(impacts.law, len(step))
    smooth = np.ones(len(step), np.bool_)
    if pairs.strength is not None:
        impacts, smooth = _hardened(impacts, pairs.strength[::numbers], how.stencil)
        keys = _keys(impacts.law, len(step))
        smooth &= ~(keys != keys[:, :1]).any(axis=(1, 2))
    value, width = pairs.value.reshape(-1, numbers), 1 + numbers * how.stencil.offsets.size
    for rows in _alike(keys, smooth):
        part = impacts if rows.size == len(step) else impacts.part(_inside(rows, width))
        yield rows, _Chain(part, value[rows], step[rows], how)


def _beside(pairs: Pairs, step: Array, stencil: _Stencil) -> Impacts:
    """Each impact, followed by those beside it: the places of the stencil of each number."""
    count, numbers = step.shape
    width = stencil.offsets.size
    columns = {path: np.repeat(values[::numbers], 1 + numbers * width) for path, values in pairs.columns.items()}
    for k, path in enumerate(pairs.paths):
        moved = columns[path].reshape(count, -1)[:, 1 + k * width : 1 + (k + 1) * width]
        moved += step[:, k : k + 1] * stencil.offsets
    return decided_impacts(pairs.scene, columns, count * (1 + numbers * width))


def _inside(rows: Index, width: int) -> Index:
    """The places of some impacts and those beside them."""
    return (rows[:, None] * width + np.arange(width)).ravel()


def _keys(law: SceneLaw, count: int) -> Array:
    """(impacts, those beside, keys): impacts with equal keys share a curve, though its numbers may differ."""
    return _stacked(curve_keys(law), count)


def _stacked(keys: list[Array], count: int) -> Array:
    return np.stack(keys, axis=-1).reshape(count, -1, len(keys)) if keys else np.zeros((count, 1, 0))


def _alike(keys: Array, chosen: Mask) -> Iterator[Index]:
    """The chosen impacts of each curve."""
    if (keys[:, 0] == keys[0, 0]).all():
        kind = np.zeros(len(keys), np.intp)
    else:
        kind = np.unique(keys[:, 0], axis=0, return_inverse=True)[1].ravel()
        if FEW * int(kind.max()) > kind.size:
            raise ValueError("nearly every impact has a curve of its own")
    for k in np.unique(kind[chosen]).tolist():
        yield np.flatnonzero((kind == k) & chosen)


def _hardened(impacts: Impacts, strength: Array, stencil: _Stencil) -> tuple[Impacts, Mask]:
    """The impacts with the strengths at their strain rates, and of which impacts these are known.

    strength: of each impact itself, Pa. That of those beside it follows to first order: with the factor F = φ(F) on the
    strength of slow loading, dF = ∂φ/(1 − ∂φ/∂F).
    """
    count, every = strength.size, np.arange(strength.size)
    width, each = impacts.numbers.mass.size // count, stencil.offsets.size
    settled = strength / np.broadcast_to(impacts.law.strength, impacts.numbers.mass.shape)[::width]
    places = np.concatenate([np.arange(width), np.zeros(each, np.intp)])
    factor = np.repeat(settled[:, None], places.size, axis=1)
    factor[:, width:] *= 1.0 + stencil.step * stencil.offsets
    wide = impacts.part((every[:, None] * width + places).ravel())
    wide = wide.under(wide.law.strengthened(factor.ravel()))
    keys = _keys(wide.law, count)
    known = ~(keys != keys[:, :1]).any(axis=(1, 2))
    for rows in _alike(keys, known):
        part = wide if rows.size == count else wide.part(_inside(rows, places.size))
        problem = part.problem(part.numbers.impedance, part.column(0.0))
        core, all_ = _Core(problem, rows.size, stencil), np.arange(rows.size)
        segments = problem.curve.segments(stencil.trial)
        gradient = core.gradient(native.mesh(native.WORK_PRESERVING, *segments), all_)
        table = _table(core.values(gradient, all_, slice(None)))
        found = factor_at(problem, np.repeat(gradient.status, places.size), Columns(table.ravel())).reshape(table.shape)
        by = stencil.slope(found[:, width:, None])[:, 0] / (stencil.step * settled[rows])
        factor[rows] = settled[rows, None] + (found - found[:, :1]) / (1.0 - by[:, None])
        known[rows] = gradient.smooth
    return impacts.under(impacts.law.strengthened(factor[:, :width].ravel())), known


class _Gradient(NamedTuple):
    """On one mesh: status; values of the core's summary, (impacts, values), and their derivatives by the numbers of the
    core, (impacts, numbers, values); whether the impacts beside end alike, in one stage and without a kink."""

    status: NDArray[np.int32]
    values: Array
    by: Array
    smooth: Mask

    def part(self, places: Index) -> _Gradient:
        """Of some of the impacts."""
        return _Gradient(self.status[places], self.values[places], self.by[places], self.smooth[places])


class _Core:
    """Impacts on one curve, by the numbers of the core. moved: problem of each of `count` impacts and those beside."""

    def __init__(self, moved: Problem, count: int, stencil: _Stencil) -> None:
        self.stencil = stencil
        numbers = _numbers_of(moved).reshape(count, moved.approach.size // count, -1)
        self.itself = moved.part(np.arange(count) * numbers.shape[1])
        change, size = numbers - numbers[:, :1], abs(numbers[:, 0])
        size[:, _STOP] = size[:, 0]  # it may be 0, and is a velocity as the first
        moves = (abs(change).max(axis=1) > MOVES * stencil.step * size).any(axis=0)
        self.axes = np.flatnonzero(moves)
        if self.axes.size > MOST_AXES:
            raise ValueError("differences of whole impacts need fewer marches")
        self._change, self._size, self._numbers = change[..., moves], size[:, moves], numbers[:, 0]

    def gradient(self, mesh: native.Mesh, places: Index) -> _Gradient:
        """March the impacts at `places`, and those beside them in the numbers of the core."""
        stencil = self.stencil
        step, each = stencil.step * self._size[places], stencil.offsets.size
        width = 1 + self.axes.size * each
        numbers = np.repeat(self._numbers[places][:, None], width, axis=1)
        for k, axis in enumerate(self.axes.tolist()):
            numbers[:, 1 + k * each : 1 + (k + 1) * each, axis] += step[:, k : k + 1] * stencil.offsets
        problem = _with_numbers(self.itself.part(np.repeat(places, width)), numbers.reshape(-1, numbers.shape[-1]))
        status, core = problem.march(mesh)
        values = core.table.view(np.float64).reshape(places.size, width, -1)[:, :, :_VALUES]
        status, stage = status.reshape(-1, width), core.stage.reshape(-1, width)
        smooth = (status[:, 0] >= 0) & ((status == status[:, :1]) & (stage == stage[:, :1])).all(axis=1)
        own, beside = values[:, :1], values[:, 1:].reshape(places.size, -1, each, _VALUES)
        with np.errstate(invalid="ignore", divide="ignore"):
            by = np.where(step[:, :, None] > 0.0, stencil.slope(beside) / step[:, :, None], 0.0)
        size = _size(own[:, 0], self._numbers[places, 0])[:, None]
        kinked = stencil.kinked(own, beside, size).any(axis=(1, 2))
        return _Gradient(status[:, 0], own[:, 0], by, smooth & ~kinked)

    def values(self, gradient: _Gradient, places: Index, beside: Any) -> Array:
        """(impacts, those beside, values of the core's summary): to first order."""
        change = self._change[places][:, beside]
        values = np.repeat(gradient.values[:, None], change.shape[1], axis=1)
        for axis in range(self.axes.size):
            values += change[..., axis, None] * gradient.by[:, None, axis]
        return values


class _Chain:
    """Impacts on one curve, by the numbers of the scene.

    impacts: each, followed by those beside it. value, step: (impacts, numbers of the scene), SI; the step is 0 where
    the stencil is left out.
    """

    def __init__(self, impacts: Impacts, value: Array, step: Array, how: _How) -> None:
        self.value, self.step, self.stencil, self._solver = value, step, how.stencil, how.solver
        self._moved = decided_problem(impacts)
        self._core = _Core(self._moved, len(step), how.stencil)
        self.meshes = Meshes.of([self._core.itself], how.solver, how.target)

    def gradient(self, n: int, places: Index) -> _Gradient:
        """On a mesh with n segments per stage."""
        return self._core.gradient(mesh_of(self._solver, self._core.itself.curve.segments(n)), places)

    def summaries(self, places: Index, gradient: _Gradient, beside: Any = slice(None)) -> Array:
        """(impacts, those beside, values of `SUMMARY`)."""
        values = self._core.values(gradient, places, beside)
        table = _table(values)
        width = self._moved.approach.size // len(self.step)
        inside = (places[:, None] * width + np.arange(width)[beside]).ravel()
        problem = self._moved if inside.size == self._moved.approach.size else self._moved.part(inside)
        found = summaries(problem, np.repeat(gradient.status, values.shape[1]), Columns(table.ravel()))
        return found.T.reshape(*table.shape, -1)


def _table(values: Array) -> NDArray[Any]:
    """The core's summaries, SUMMARY_DTYPE, of (impacts, those beside, values)."""
    table = np.zeros(values.shape[:2], native.SUMMARY_DTYPE)
    table.view(np.float64).reshape(*table.shape, -1)[..., :_VALUES] = values
    return table


def _numbers_of(problem: Problem) -> Array:
    """(impacts, numbers): `AXES`, and those on which the curve depends."""
    columns = [np.broadcast_to(getattr(problem, name), problem.approach.shape) for name in AXES]
    if problem.own.varied is not None:
        columns += list(problem.own.varied.values.T)
    elif problem.own.shape is not None:
        columns.append(problem.own.shape)
    return np.stack(columns, axis=-1)


def _with_numbers(problem: Problem, numbers: Array) -> Problem:
    """The problem with other numbers for the core."""
    approach, gamma, load, damping, stop, *_ = numbers.T
    drift = -stop * problem.share * problem.scales.velocity if problem.free else problem.drift
    own, (_, shape, varied, _) = numbers[:, len(AXES) :], problem.own
    return replace(
        problem,
        approach=approach,
        gamma=gamma,
        load=load,
        damping=damping,
        drift=drift,
        own=problem.own._replace(
            shape=None if shape is None else own[:, 0], varied=None if varied is None else varied._replace(values=own)
        ),
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


def _set(found: Slopes, pairs: Index, chain: _Chain) -> None:
    """Set the derivatives of impacts without kinks. pairs: (impacts, numbers of the scene), places in `found`."""
    n, meshes, stencil = chain.meshes.first[1], chain.meshes, chain.stencil
    left, numbers = np.arange(len(pairs)), pairs.shape[1]
    coarse, fine = (chain.gradient(k, left) for k in meshes.first)
    left = np.flatnonzero(coarse.smooth & fine.smooth)
    coarse, fine = coarse.part(left), fine.part(left)
    above = np.arange(numbers + 1) * stencil.offsets.size  # of each number the nearest place above, after the impact
    some = chain.summaries(left, coarse, above)
    before, last = some[:, 1:] - some[:, :1], np.full(left.size, np.inf)
    while left.size:
        every, step = chain.summaries(left, fine), chain.step[left][:, :, None]
        own, beside = every[:, :1], every[:, 1:].reshape(left.size, numbers, stencil.offsets.size, -1)
        ahead = beside[:, :, -1] - own
        with np.errstate(invalid="ignore", divide="ignore"):
            slope, change = stencil.slope(beside) / step, (before - ahead) / step
        known = (step[..., 0] > 0.0) & ~stencil.kinked(own, beside, abs(own)).any(axis=-1)
        places = pairs[left][known]
        found.side[places] = SMOOTH
        worst = np.zeros(known.shape)
        values = np.broadcast_to(own, slope.shape)[known], chain.value[left][known]
        worst[known] = found.put(places, slope[known], change[known], *values, meshes.factor)
        n, largest = 2 * n, worst.max(axis=1)
        open_ = np.flatnonzero((largest > meshes.target) & (largest < STALLED * last))
        if n > MOST_SEGMENTS or not open_.size:
            return
        left, last, before = left[open_], largest[open_], ahead[open_]
        fine = chain.gradient(n, left)
