"""Derivatives of the summary by numbers of a scene, by the chain rule through the few numbers of the core.

The core's summary depends on a handful of dimensionless numbers. Only these are varied in marches
(:mod:`film_model.solve.core_slopes`). How they, and the scales of the summary, depend on the numbers of the scene is
found on arrays, without a march. Impacts for which this does not serve, because a kink is near or every value of a
number has a curve of its own, are left to the differences of whole impacts (:mod:`film_model.solve.slopes`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array, Index, Mask
from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.core.columns import Columns
from film_model.effects.decided import decided_impacts, decided_problem
from film_model.effects.edge_effects import may_differ
from film_model.effects.many import FEW, curve_keys
from film_model.effects.rate_hardening import factor_at
from film_model.problem.curve import TRIAL_SEGMENTS
from film_model.problem.problem import Impacts
from film_model.scene import Solver
from film_model.solve.accuracy import mesh_of
from film_model.solve.core_slopes import AHEAD, COARSE, FINE, CoreSlopes, Gradient, Stencil
from film_model.solve.slopes import MOST_SEGMENTS, SMOOTH, STALLED, STEP, Meshes, Pairs, Slopes, differences, summaries


class _How(NamedTuple):
    """How derivatives are computed. rough: of the coarser of the first two meshes. trial: segments per stage of the
    march that gives the strain rate."""

    solver: Solver
    target: float
    stencil: Stencil
    rough: Stencil
    trial: int


def slopes(pairs: Pairs, solver: Solver, target: float) -> Slopes:
    """The derivatives of all numbers of some impacts; target: estimated error up to which meshes are refined."""
    found = Slopes.none(pairs.which.size)
    chain_rule(pairs, solver, target, found)
    differences(pairs, solver, target, found)
    return found


def chain_rule(pairs: Pairs, solver: Solver, target: float, found: Slopes) -> None:
    """Set the derivatives of impacts that are smooth and share their curve with those beside them."""
    # from 1e-6 on, differences of second order serve
    ways = (FINE, FINE, TRIAL_SEGMENTS) if target < 1e-6 else (COARSE, AHEAD, TRIAL_SEGMENTS // 2)
    how = _How(solver, target, *ways)
    numbers = len(pairs.paths)
    # few enough impacts of stencils that their columns stay in the processor's cache
    together = numbers * max(16384 // (1 + numbers * how.stencil.offsets.size), 1)
    for first in range(0, pairs.which.size, together):
        places = np.arange(first, min(first + together, pairs.which.size))
        try:
            for rows, chain in _chains(pairs if places.size == pairs.which.size else pairs.part(places), how):
                _set(found, places.reshape(-1, numbers)[rows], chain)
        except (TypeError, ValueError, SimulationError):  # a law or a target that accepts numbers only
            continue


def _chains(pairs: Pairs, how: _How) -> Iterator[tuple[Index, _Chain]]:
    """The impacts on each curve, with their places."""
    if may_differ(pairs.scene):
        return  # the target's static stiffness is a part of the curve
    numbers, scale = len(pairs.paths), how.stencil.step / STEP
    step = np.where(pairs.fits(how.stencil.offsets * scale), pairs.step * scale, 0.0).reshape(-1, numbers)
    impacts = _beside(pairs, step, how.stencil)
    count, each = len(step), how.stencil.offsets.size
    keys = curve_keys(impacts)
    shared = np.stack(keys, axis=-1).reshape(count, -1, len(keys)) if keys else np.zeros((count, 1, 0))
    other = (shared != shared[:, :1]).any(axis=2)
    smooth = np.ones(count, np.bool_)
    if other.any():  # stencils that need more than one curve are left out
        step[other[:, 1 : 1 + numbers * each].reshape(count, numbers, each).any(axis=2)] = 0.0
        smooth = ~other[:, 1 + numbers * each :].any(axis=1)
        impacts = _beside(pairs, step, how.stencil)
    value = pairs.value.reshape(-1, numbers)
    for rows in _alike(shared[:, 0], smooth):
        width = impacts.numbers.mass.size // count
        part = impacts if rows.size == count else impacts.part((rows[:, None] * width + np.arange(width)).ravel())
        yield rows, _Chain(part, value[rows], step[rows], how, pairs.strength is not None)


def _beside(pairs: Pairs, step: Array, stencil: Stencil) -> Impacts:
    """Each impact, followed by those beside it: the places of the stencil of each number of the scene; with rate
    hardening, the strength is that of the impact itself, and at the end are those with other strengths."""
    count, numbers = step.shape
    each = stencil.offsets.size
    hard = 0 if pairs.strength is None else each
    width = 1 + numbers * each + hard
    columns = {path: np.repeat(values[::numbers], width) for path, values in pairs.columns.items()}
    for k, path in enumerate(pairs.paths):
        moved = columns[path].reshape(count, -1)[:, 1 + k * each : 1 + (k + 1) * each]
        moved += step[:, k : k + 1] * stencil.offsets
    impacts = decided_impacts(pairs.scene, columns, count * width)
    if pairs.strength is None:
        return impacts
    slow = np.broadcast_to(impacts.law.strength, (count * width,))[::width]
    factor = np.repeat((pairs.strength[::numbers] / slow)[:, None], width, axis=1)
    factor[:, -each:] *= 1.0 + stencil.step * stencil.offsets
    return impacts.under(impacts.law.strengthened(factor.ravel()))


def _alike(keys: Array, chosen: Mask) -> Iterator[Index]:
    """The chosen impacts of each curve. keys: (impacts, keys)."""
    if (keys == keys[0]).all():
        kind = np.zeros(len(keys), np.intp)
    else:
        kind = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
        if FEW * int(kind.max()) > kind.size:
            raise ValueError("nearly every impact has a curve of its own")
    for k in np.unique(kind[chosen]).tolist():
        yield np.flatnonzero((kind == k) & chosen)


class _Chain:
    """Impacts on one curve, by the numbers of the scene.

    impacts: each, followed by those beside it. value, step: (impacts, numbers of the scene), SI; the step is 0 where
    the stencil is left out. hard: whether the strength at the strain rate is a further number.
    """

    def __init__(self, impacts: Impacts, value: Array, step: Array, how: _How, hard: bool) -> None:
        self.value, self.step, self.how, self._hard = value, step, how, hard
        self._impacts, self._moved = impacts, decided_problem(impacts)
        self._core = CoreSlopes(self._moved, len(step), how.stencil.step)
        self.meshes = Meshes.of([self._moved], how.solver, how.target)

    def gradient(self, n: int, places: Index, stencil: Stencil | None = None) -> Gradient:
        """On a mesh with n segments per stage."""
        mesh = mesh_of(self.how.solver, self._core.curve.segments(n))
        return self._core.gradient(mesh, places, stencil or self.how.stencil)

    def first(self) -> tuple[Index, tuple[Gradient, Gradient]]:
        """The impacts without kinks, and their gradients on the first two meshes."""
        every, (coarse, fine) = np.arange(len(self.step)), self.meshes.first
        gradients = self.gradient(coarse, every, self.how.rough), self.gradient(fine, every)
        smooth = gradients[0].smooth & gradients[1].smooth
        if self._hard:
            known, self._by_strength = self._strengths(every, gradients[1])
            smooth &= known
        if smooth.all():
            return every, gradients
        return np.flatnonzero(smooth), (gradients[0].part(smooth), gradients[1].part(smooth))

    def _strengths(self, every: Index, gradient: Gradient) -> tuple[Mask, Array]:
        """Whether the strain rate is smooth, and the relative change of the strength by each number of the scene.

        The factor F on the strength of slow loading solves F = φ(F): dF = ∂φ/(1 − ∂φ/∂F).
        gradient: on the finer of the first two meshes.
        """
        how, stencil, impacts = self.how, self.how.stencil, self._impacts
        problem, core = self._moved, self._core
        wanted = impacts.base.effects
        if wanted.gravity or wanted.wave_losses is True:  # the strain rate is that without weight and waves
            problem = impacts.problem(impacts.numbers.impedance, impacts.column(0.0), fitted=False)
            core = CoreSlopes(problem, every.size, stencil.step)
        if core is not self._core or (how.solver.linearisation, self.meshes.first[1]) != ("work-preserving", how.trial):
            mesh = native.mesh(native.WORK_PRESERVING, *problem.curve.segments(how.trial))
            gradient = core.gradient(mesh, every, stencil)
        values = core.values(gradient, every)
        status = np.repeat(gradient.status, values.shape[2])
        factor = factor_at(problem, status, _columns(values.reshape(len(values), -1))).reshape(values.shape[1:])
        by = stencil.slope(factor[:, :1], factor[:, 1:])
        with np.errstate(invalid="ignore", divide="ignore"):
            change = by[:, :-1] / self.step / (factor[:, :1] - by[:, -1:] / stencil.step)
        return gradient.smooth & np.isfinite(factor[:, 0]), change

    def slopes(self, places: Index, *gradients: Gradient) -> tuple[Array, Array, Mask]:
        """From the gradients on some meshes: values of `SUMMARY` on the last of them, (values, impacts); derivatives,
        (values, meshes, impacts, numbers); and which are known, (impacts, numbers)."""
        stencil, step = self.how.stencil, self.step[places]
        core = np.stack([self._core.values(gradient, places) for gradient in gradients], axis=1)
        *_, count, width = core.shape
        status = np.stack([np.repeat(gradient.status, width) for gradient in gradients])
        problem, numbers = self._moved, step.shape[1]
        if count < len(self.step):
            problem = problem.part((places[:, None] * width + np.arange(width)).ravel())
        found = summaries(problem, status, _columns(core.reshape(*core.shape[:2], -1)))
        found = found.reshape(len(found), -1, count, width)
        own, beside = found[..., :1], found[..., 1:]
        kinked = np.asarray(stencil.kinked(own[:, -1], beside[:, -1], abs(own[:, -1])).any(axis=0))
        slope = stencil.slope(own, beside)
        with np.errstate(invalid="ignore", divide="ignore"):
            by = slope[..., :numbers] / step
            if self._hard:
                by += self._by_strength[places] * (slope[..., numbers:] / stencil.step)
        known = (step > 0.0) & ~(kinked[:, :numbers] | kinked[:, numbers:].any(axis=1, keepdims=True))
        return own[:, -1, :, 0], by, known


def _columns(values: Array) -> Columns:
    """The core's summaries from their values, (values, …)."""
    return Columns(dict(zip(native.SUMMARY, values, strict=True)))


def _set(found: Slopes, pairs: Index, chain: _Chain) -> None:
    """Set the derivatives of impacts without kinks. pairs: (impacts, numbers of the scene), places in `found`."""
    n, meshes = chain.meshes.first[1], chain.meshes
    left, gradients = chain.first()
    last, before = np.full(left.size, np.inf), np.empty(0)
    while left.size:
        own, slope, known = chain.slopes(left, *gradients)
        before = slope[:, 0] if slope.shape[1] > 1 else before
        fine, chosen = slope[:, -1], slice(None) if known.all() else known.ravel()
        change, values = before - fine, np.repeat(own[..., None], known.shape[1], axis=2)
        by, change, values = (table.reshape(len(table), -1).T[chosen] for table in (fine, change, values))
        places, worst = pairs[left].ravel()[chosen], np.zeros(known.size)
        found.side[places] = SMOOTH
        worst[chosen] = found.put(places, by, change, values, chain.value[left].ravel()[chosen], meshes.factor)
        n, largest = 2 * n, worst.reshape(known.shape).max(axis=1)
        open_ = np.flatnonzero((largest > meshes.target) & (largest < STALLED * last))
        if n > MOST_SEGMENTS or not open_.size:
            return
        left, last, before = left[open_], largest[open_], fine[:, open_]
        gradients = (chain.gradient(n, left),)
