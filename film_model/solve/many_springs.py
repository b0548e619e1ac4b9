"""Friction by springs in many impacts, beside the lines of their normal motions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, column
from film_model.core import families, native
from film_model.core import springs as core
from film_model.core.friction import COARSE, ERRORS, EXACT, QUICK
from film_model.core.solving import MOST_SEGMENTS
from film_model.oblique import springs
from film_model.oblique.friction import normal_impulse, radius_beyond_yield, results, slid
from film_model.oblique.result import BOUNDS, MODELLED, error_of_force
from film_model.problem.problem import Problem
from film_model.scene import DEFAULT_ACCURACY, Solver
from film_model.scene.rolling import sliding_of
from film_model.solve.accuracy import mesh_of
from film_model.solve.many_meshes import recorded_segments

SAMPLES = 16_384
"""Of normal motions at a time, which a processor's cache holds and with powers of 2 for steps fills lanes."""


class Normal(NamedTuple):
    """Normal motions. status: the core's. segments: of the march. rebound: m/s. duration: of contact, s. estimated:
    relative error."""

    status: NDArray[np.int32]
    segments: NDArray[np.int32]
    rebound: Array
    duration: Array
    estimated: Array

    def of(self, rows: Any) -> Normal:
        """Some of them."""
        own = self.rebound[rows], self.duration[rows], self.estimated[rows]
        return Normal(self.status[rows], self.segments[rows], *own)


def coarseness(solver: Solver) -> int:
    """How coarse the exact solution may be: EXACT, COARSE or QUICK."""
    accuracy = solver.accuracy or DEFAULT_ACCURACY
    return max(level for level in (EXACT, COARSE, QUICK) if accuracy >= 10.0 * ERRORS[level])


def by_springs(
    problem: Problem, normal: Normal, solver: Solver, bounded: bool
) -> tuple[NDArray[np.bool_], dict[str, Array], NDArray[np.int8], Array]:
    """Which impacts have a record, their results along the surface, regimes, and estimates (nan if nothing slides).
    bounded: with those of two models of a law that yields.

    Springs are doubled until the estimate meets the accuracy, or `MODELLED` if the law yields; where the exact
    solution is not coarse there are as many as possible from the start, for results that are smooth over the impacts.
    """
    accuracy = solver.accuracy or DEFAULT_ACCURACY
    tolerance = accuracy if problem.curve.reversible else max(accuracy, MODELLED)
    levels = springs.LEVELS[int(tolerance < MODELLED) :] if coarseness(solver) else springs.LEVELS[-1:]
    segments, mesh = normal.segments, mesh_of(solver, (1, 1))
    alike = problem.own.alike and bool(np.all(problem.damping > 0.0))
    if not (alike and families.by_series(problem.curve.native, mesh)):
        # twice the segments with which the ends meet the accuracy: the force between is up to 1e-3 less exact if damped
        # (tests/test_friction_estimate.py)
        segments = np.minimum(2 * recorded_segments(problem, solver, segments), MOST_SEGMENTS)
    motions = _Motions(problem, segments, normal.duration, solver)
    return _followed(motions, normal, tolerance, levels, 2 if bounded and not problem.curve.reversible else 1)


@dataclass(frozen=True)
class _Motions:
    """Normal motions of impacts, by lines on their curves. segments: of their meshes. durations: s."""

    problem: Problem
    segments: NDArray[np.int32]
    durations: Array
    solver: Solver

    def blocks(self, places: Index, steps: int) -> Iterator[Index]:
        """These impacts in parts of one mesh each, whose samples a processor's cache holds."""
        _, group = np.unique(self.segments[places], axis=0, return_inverse=True)
        at_once = max(SAMPLES // steps, 1)
        for k in range(int(group.max(initial=-1)) + 1):
            alike = places[group.ravel() == k]
            yield from np.split(alike, range(at_once, alike.size, at_once))

    def at(self, places: Index, steps: int) -> tuple[Array, Array, tuple[Array, ...], Array]:
        """Times, forces and contact radii of some impacts, (impacts, times), SI, radii of a law that yields under two
        models; nan without a record. Last the power with which the depth of each grows with its radius."""
        problem, times = self.problem.part(places), np.linspace(0.0, 1.0, steps + 1) * self.durations[places, None]
        scales = problem.scales.part((slice(None), None))
        counts = self.segments[places[0]].tolist()
        force, depth, slope, power = problem.motions(mesh_of(self.solver, (counts[0], counts[1])), times / scales.time)
        force = np.maximum(force, 0.0, out=force) * scales.force
        if slope is not None:
            modulus = column(problem.scene.effective_modulus, places.size)[:, None]
            return times, force, (slope * (scales.force / scales.length / (2.0 * modulus)),), power
        depth *= scales.length
        loading, law = int(depth.argmax(axis=1).max()) + 1, np.full(depth.shape, np.nan)
        law[:, :loading] = radius_beyond_yield(problem, depth[:, :loading].T, force[:, :loading].T).T
        first, second = core.radii(force, depth, law, 1.0)
        return times, force, (first, second / column(problem.scene.effective_modulus, places.size)[:, None]), power


def _followed(
    motions: _Motions, normal: Normal, tolerance: float, levels: tuple[tuple[int, int], ...], models: int
) -> tuple[NDArray[np.bool_], dict[str, Array], Any, Array]:
    """Which impacts have a record, their results, regimes and estimates. models: how many are followed."""
    problem, count = motions.problem, normal.rebound.size
    scene = problem.impacts.scene
    given = sliding_of(scene, at_rest=True)
    assert given is not None
    modulus, mass, velocity = (column(getattr(given, name), count) for name in ("modulus", "mass", "velocity"))
    friction = column(given.friction, count)
    pairs = np.stack([np.zeros(count), friction], axis=1)[:, None]
    after, error, slack = np.full((3, models, count), np.nan)
    peak, when, taken = np.full((3, count), np.nan)
    regime = np.full(count, -1, np.int8)
    left = np.arange(count)
    for level, steps in levels:
        for some in motions.blocks(left, steps):
            t, force, radii, power = motions.at(some, steps)
            numbers = np.stack([modulus[some], power, mass[some], velocity[some], t[:, 1]], axis=1)
            table = pairs[some] if given.table is None else given.pairs
            runs = np.stack([core.many(level, numbers, table, force, radius) for radius in radii[:models]])
            known = (runs["status"] == native.OK).all(axis=0)
            rows, runs, t = some[known], runs[:, known], t[known]
            after[:, rows], error[:, rows] = runs["velocity"], springs.SAFETY * runs["error"]
            slack[:, rows], taken[rows] = runs["slack"], steps
            peak[rows], regime[rows] = runs["force"][0], runs["regime"][0]
            when[rows] = t[np.arange(rows.size), runs["step"][0]]
        left = left[error[0, left] > tolerance * abs(velocity[left])]
        if left.size == 0:
            break
    rows = np.flatnonzero((slack <= springs.SLIDING).any(axis=0))
    impulse = column(normal_impulse(scene, problem, normal.rebound, motions.durations), count)
    sliding = given._replace(friction=friction[rows], mass=mass[rows], velocity=velocity[rows])
    after[:, rows] = np.where(slack[:, rows] <= springs.SLIDING, slid(sliding, impulse[rows]), after[:, rows])
    found = results(scene, given, normal.rebound, after[0], (peak, when))
    before, of_force = abs(velocity), error_of_force(normal.estimated)
    if models > 1:
        found |= zip(BOUNDS, springs.bracket(after, error, taken, before, of_force), strict=True)
    summary = {name: column(value, count) for name, value in found.items()}
    with np.errstate(divide="ignore", invalid="ignore"):
        return after[0] == after[0], summary, regime, error[0] / before + of_force
