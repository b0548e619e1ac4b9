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
from film_model.oblique import springs
from film_model.oblique.friction import normal_impulse, radius_beyond_yield, results, slid
from film_model.oblique.result import BOUNDS, MODELLED
from film_model.problem.problem import Problem
from film_model.scene import DEFAULT_ACCURACY, Solver
from film_model.scene.rolling import sliding_of

KNOTS, FEW = 32, 24
"""Of each leg of contact at which a motion is sampled, for accuracies from 1e-4 on; FEW under laws that yield without a
kink."""

ROUGH = 2e-3
"""Of the largest force or radius, by which knots lie beside the cubic through every other one where the law has a
second kink or a jump (tests/test_friction_estimate.py)."""

LIKELY = 0.6
"""Springs that are tried first, over (accuracy ψ₁)^(-1/2). Affects cost only: others follow if they do not do."""

MISSED = 1e-4
"""Relative error of the impulse of a record up to which it is exact enough, under laws that yield."""

SAMPLES = 65_536
"""Of normal motions at a time, which a processor's cache holds and with powers of 2 for knots fills lanes."""


class Normal(NamedTuple):
    """Normal motions. status: the core's. rebound: m/s. turn, end: times, s. estimated: relative error."""

    status: NDArray[np.int32]
    rebound: Array
    turn: Array
    end: Array
    estimated: Array

    def of(self, rows: Any) -> Normal:
        """Some of them."""
        return Normal(self.status[rows], *(values[rows] for values in self[1:]))


def coarseness(solver: Solver) -> int:
    """How coarse the exact solution may be: EXACT, COARSE or QUICK."""
    accuracy = solver.accuracy or DEFAULT_ACCURACY
    return max(level for level in (EXACT, COARSE, QUICK) if accuracy >= 10.0 * ERRORS[level])


def by_springs(
    problem: Problem, normal: Normal, solver: Solver, bounded: bool
) -> tuple[NDArray[np.bool_], dict[str, Array], NDArray[np.int8], Array]:
    """Which impacts have a record, their results along the surface, regimes, and estimates (nan if nothing slides).
    bounded: with those of two models of a law that yields.

    More springs follow impacts until the estimate meets the accuracy, or `MODELLED` if the law yields; where the exact
    solution is not coarse there are as many as possible from the start, for results that are smooth over the impacts.
    """
    accuracy, yields = solver.accuracy or DEFAULT_ACCURACY, not problem.curve.reversible
    tolerance = max(accuracy, MODELLED) if yields else accuracy
    levels = springs.LEVELS if coarseness(solver) else springs.LEVELS[-1:]
    impulse = normal_impulse(problem.impacts.scene, problem, normal.rebound, normal.end)
    legs = np.stack([normal.turn, normal.end], axis=1)
    motions = _Motions(problem, legs, column(impulse, len(legs)))
    return _followed(motions, normal, tolerance, levels, 2 if bounded and yields else 1)


class _Samples(NamedTuple):
    """Impacts at the knots of their legs, SI. legs: times of turn, end and a kink, (impacts, 3). force, radii:
    (impacts, times); radii of a law that yields under two models; nan without a record. power: with which the depth of
    each grows with its radius. missed: relative error of the impulse."""

    legs: Array
    force: Array
    radii: tuple[Array, ...]
    power: Array
    missed: Array

    @property
    def roughness(self) -> Array:
        """Of force and radius, as `core.roughness`."""
        return np.maximum(*(core.roughness(values, self.legs) for values in (self.force, self.radii[0])))

    def of(self, rows: Any) -> _Samples:
        """Some of them."""
        radii = tuple(radius[rows] for radius in self.radii)
        return _Samples(self.legs[rows], self.force[rows], radii, self.power[rows], self.missed[rows])


@dataclass(frozen=True)
class _Motions:
    """Normal motions of impacts. legs: times of turn and end, s, (impacts, 2). impulse: N·s."""

    problem: Problem
    legs: Array
    impulse: Array

    def sampled(self, places: Index, knots: int) -> Iterator[tuple[Index, _Samples]]:
        """These impacts at as many knots, or at twice as many where they are rough or their impulse is not exact."""
        left = list[Index]()
        for some in _parts(places, knots):
            found = self.at(some, knots)
            if not self.problem.curve.reversible:
                rough = (found.missed > MISSED) | (found.roughness > ROUGH)
                if rough.any():
                    left.append(some[rough])
                    some, found = some[~rough], found.of(~rough)
            yield some, found
        for some in _parts(np.concatenate([*left, np.arange(0)]), 2 * knots):
            yield some, self.at(some, 2 * knots)

    def at(self, places: Index, knots: int) -> _Samples:
        """Some impacts at the knots of their legs."""
        problem = self.problem.part(places)
        scales = problem.scales.part((slice(None), None))
        legs, force, depth, slope, power = problem.motions(self.legs[places] / scales.time, knots)
        force = np.maximum(force, 0.0, out=force) * scales.force
        legs *= scales.time
        missed = abs(core.impulses(force, legs) / self.impulse[places] - 1.0)
        if slope is not None:
            modulus = column(problem.scene.effective_modulus, places.size)[:, None]
            radii = (slope * (scales.force / scales.length / (2.0 * modulus)),)
            return _Samples(legs, force, radii, power, missed)
        depth *= scales.length
        law, to = np.full(depth.shape, np.nan), slice(knots + 1)
        law[:, to] = radius_beyond_yield(problem, depth[:, to].T, force[:, to].T, tabled=True).T
        first, second = core.radii(force, depth, law, 1.0)
        second /= column(problem.scene.effective_modulus, places.size)[:, None]
        return _Samples(legs, force, (first, second), power, missed)


def _parts(places: Index, knots: int) -> Iterator[Index]:
    """Impacts whose samples a processor's cache holds."""
    at_once = max(SAMPLES // (2 * knots + 2), 1)
    yield from np.split(places, range(at_once, places.size, at_once)) if places.size else ()


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
    peak, when = np.full((2, count), np.nan)
    regime = np.full(count, -1, np.int8)
    smooth = not problem.curve.reversible and not families.kinked(problem.curve.native)
    finer = int(KNOTS * (DEFAULT_ACCURACY / tolerance) ** 0.5) // 8 * 8
    knots = max(levels[0][1] // 8, min(finer, springs.STEPS // 8), FEW if smooth else KNOTS)
    with np.errstate(divide="ignore", invalid="ignore"):
        number = abs(velocity) / (given.ratio * friction * scene.approach_velocity)
        likely = np.fmin(LIKELY / (tolerance * number) ** 0.5, levels[-2:][0][0])
    missed = np.full(count, np.nan)
    for some, seen in motions.sampled(np.argsort(number), knots):  # slide as long in lanes
        table = pairs[some] if given.table is None else given.pairs
        numbers = np.stack([modulus[some], seen.power, mass[some], velocity[some], *seen.legs.T], axis=1)
        missed[some], allowed, wanted = seen.missed, tolerance * abs(velocity[some]), likely[some]
        if models > 1:  # once, without the runs that tell its error, which is less than that of the turn
            level, steps = levels[0]
            run = core.many(np.arange(some.size), level, steps // 2, table, numbers, seen.force, seen.radii[1], False)
            after[1, some], slack[1, some], error[1, some] = run["velocity"], run["slack"], 0.0
        for level, steps in levels:
            own = np.flatnonzero(wanted <= level)
            if not own.size:
                continue
            run = core.many(own, level, steps // 2, table, numbers, seen.force, seen.radii[0])
            wanted[own] = np.inf
            known = run["status"] == native.OK
            own, run = own[known], run[known]
            at = some[own]
            after[0, at], slack[0, at], error[0, at] = run["velocity"], run["slack"], run["error"]
            peak[at], regime[at], when[at] = run["force"], run["regime"], run["time"]
            over = springs.SAFETY * run["error"] / allowed[own]
            # the last level, of most steps by far, only where the one before does not do
            last = levels[-1 - (level < levels[-2:][0][0])][0]
            wanted[own] = np.where(over > 1.0, np.minimum(level * over**0.5, last), np.inf)
    error *= springs.SAFETY
    rows = np.flatnonzero((slack <= springs.SLIDING).any(axis=0))
    sliding = given._replace(friction=friction[rows], mass=mass[rows], velocity=velocity[rows])
    after[:, rows] = springs.ended(slack[:, rows], slid(sliding, motions.impulse[rows]), after[:, rows])
    found = results(scene, given, normal.rebound, after[0], (peak, when))
    normal_error = np.maximum(normal.estimated, missed)
    with np.errstate(divide="ignore", invalid="ignore"):
        share, bounds = springs.judged(after, error, levels[0][1], abs(velocity), normal_error)
    found |= zip(BOUNDS, bounds, strict=True) if models > 1 else {}
    summary = {name: column(value, count) for name, value in found.items()}
    return after[0] == after[0], summary, regime, share
