"""Derivatives of impacts that are followed in steps: on vibrating targets, and of viscoelastic bodies.

They are differences of fourth order of whole impacts, one by one. With the same modes, or for a number of the target
with as many modes, and with the same tolerance the summary is smooth to much less than the tolerance of a step. What
remains is the error of the omitted modes, or that of the tolerance. It is estimated from three runs, as that of the
summary itself (:func:`film_model.core.refining.error_of`, :mod:`film_model.solve.relaxed`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.core.refining import error_of, tightened
from film_model.effects import rate_hardening
from film_model.effects.choose import Choice
from film_model.problem.law_of_scene import SceneLaw, laws_of
from film_model.problem.problem import Impacts
from film_model.problem.relaxation import relaxation_of
from film_model.problem.summary import SUMMARY, summary_of
from film_model.scene.columns import scene_of_columns
from film_model.solve import relaxed, structures, vibration
from film_model.solve.slopes import SMOOTH, STENCILS, Pairs, Slopes, applied, kinked
from film_model.solve.vibration import Vibration
from film_model.targets import AbstractTarget

BENT = 1e-6
"""As `KINK` of impacts on lines; the differences are then exact to about 1e-7."""

BEYOND = 1.25
"""Highest frequency of the modes among which a gap is found, over that of the impact."""

LEVELS = (4.0, 2.0, 1.0)
"""Highest frequency of the impact itself over those of the runs."""

TOLERANCES = (1e-7, 1e-8, 1e-9)
"""Of a step, of the runs of viscoelastic bodies."""


class _Run(NamedTuple):
    """An impact: values of `SUMMARY`; outcome and number of contacts; the stage of the law that it reaches."""

    values: Array
    end: tuple[int, int]
    stage: int


Runs = Callable[[float], _Run]
"""The impacts whose number is some steps off."""

Error = Callable[[Array, Array], Array]
"""Bound on the error from the differences of the first two, and of the last two of three runs."""


def slopes_on_modes(choice: Choice, pairs: Pairs, found: Vibration, accuracy: float) -> Slopes:
    """The derivatives by the numbers of the impact that `found` is. pairs: of its scene with the decisions in it.

    Raises SimulationError for a number of the target, with which too many modes change.
    """

    # Step of the stencil over that of an impact on lines: after several contacts, which magnify every difference, the
    # summary bends more. Needed by tests/test_stepped_derivatives.py
    narrow = 0.2

    def error(before: Array, change: Array) -> Array:
        return error_of(choice.problem.law.damped, before, change)

    slopes = Slopes.none(len(pairs.paths))
    for k, path in enumerate(pairs.paths):
        pair = replace(pairs.part(np.array([k])), step=narrow * pairs.step[k : k + 1])
        runs = [_on_modes(choice, pair, path, found.highest / level, accuracy) for level in LEVELS]
        _set(slopes, k, pair, runs, error)
    return slopes


def slopes_of_relaxing(choice: Choice, pairs: Pairs) -> Slopes:
    """The same for viscoelastic bodies."""

    def error(before: Array, change: Array) -> Array:
        return relaxed.FACTOR * np.maximum(change, before / relaxed.FALL)

    slopes = Slopes.none(len(pairs.paths))
    for k, path in enumerate(pairs.paths):
        pair = pairs.part(np.array([k]))
        _set(slopes, k, pair, [_relaxing(choice, pair, path, tolerance) for tolerance in TOLERANCES], error)
    return slopes


def _relaxing(choice: Choice, pair: Pairs, path: str, tolerance: float) -> Runs:
    value, step = float(pair.value[0]), float(pair.step[0])

    @cache
    def run(offset: float) -> _Run:
        impacts = _impacts(choice, pair, path, value + offset * step)
        problem = impacts.problem(impacts.numbers.impedance, _load(impacts))
        problem = replace(problem, relaxation=relaxation_of(impacts.base))
        status, summary = problem.relax(tolerance)
        return _Run(_values(summary_of(problem, status, summary)), (status, 1), 0)

    return run


def _on_modes(choice: Choice, pair: Pairs, path: str, highest: float, accuracy: float) -> Runs:
    """With the modes up to a frequency."""
    steps = 1e-6  # tolerance of a step over the requested accuracy
    target, unit, count = choice.scene.target, choice.problem.scales.time, 0
    limit, tolerance = vibration.time_limit(choice.problem, target), tightened(accuracy, steps)
    carried = structures.CARRIED if choice.problem.stretches else 0
    value, step = float(pair.value[0]), float(pair.step[0])
    if _changes_modes(target, _impacts(choice, pair, path, value + step).base.target):
        highest, count = _between_modes(path, target, highest)

    @cache
    def run(offset: float) -> _Run:
        impacts = _impacts(choice, pair, path, value + offset * step)
        problem = replace(impacts.problem(math.inf, _load(impacts), vibrates=True), stretches=choice.problem.stretches)
        of = impacts.base.target if count else target
        end = _end_of_modes(of, highest, count) if count else highest
        found = vibration.run(problem, structures.structure_of(of, end, unit, carried), tolerance, limit)
        values = summary_of(problem, found.status, found.summary) | found.energies_in_si(problem)
        return _Run(_values(values), (found.status, found.contacts), int(found.summary.stage))

    return run


def _values(summary: dict[str, Any]) -> Array:
    return np.array([summary[name] for name in SUMMARY])


def _load(impacts: Impacts) -> Any:
    return impacts.numbers.weight if impacts.base.effects.gravity else 0.0


def _impacts(choice: Choice, pair: Pairs, path: str, value: float) -> Impacts:
    """The impact with another number, and the decisions of the impact itself."""
    number: dict[str, Any] = {path: value}
    scene = scene_of_columns(pair.scene, number)
    impacts = Impacts.one(scene, SceneLaw.of(scene, laws_of(scene)[0][0]))
    if choice.hard is None:
        return impacts
    compliance = (scene.target.compliance or 0.0) if choice.support.compliance else 0.0
    impedance = impacts.numbers.impedance if math.isfinite(choice.support.impedance) else math.inf
    hard = rate_hardening.hardened(impacts.problem(impedance, 0.0, compliance))
    assert hard is not None
    return hard.impacts


def _changes_modes(target: AbstractTarget, moved: AbstractTarget) -> bool:
    """Whether the lowest modes of two targets differ, and with them all others."""
    few_modes = 4.0  # frequency up to which the modes of two targets are compared, over the lowest
    if moved == target:
        return False
    lowest = few_modes * (structures.lowest_frequency(target) or 1.0)
    one, other = target.modes(lowest), moved.modes(lowest)
    columns = ((one.frequency, other.frequency), (one.share, other.share), (one.damping_ratio, other.damping_ratio))
    return not all(np.array_equal(*pair) for pair in columns)


def _between_modes(path: str, target: AbstractTarget, highest: float) -> tuple[float, int]:
    """The frequency nearest to `highest` in a gap between the modes; and the number of modes below it."""
    known = np.sort(target.modes(BEYOND * highest).frequency)
    least = 1.004  # ratio of the two frequencies of a gap: no mode passes the other within a stencil
    gaps = np.flatnonzero((known[1:] >= least * known[:-1]) & (known[:-1] > highest / BEYOND**2))
    if not gaps.size:
        raise SimulationError(
            f"a derivative by {path} is not supported: it changes the target's natural frequencies, which lie too "
            "close together for runs with equal numbers of modes; use numbers of the impactor or the contact"
        )
    middle = np.sqrt(known[gaps] * known[gaps + 1])
    nearest = int(np.argmin(abs(np.log(middle / highest))))
    return float(middle[nearest]), int(gaps[nearest]) + 1


def _end_of_modes(target: AbstractTarget, highest: float, count: int) -> float:
    """The frequency below which another target has `count` modes."""
    known = np.sort(target.modes(BEYOND * highest).frequency)
    return float(math.sqrt(known[count - 1] * known[count]))


def _set(slopes: Slopes, k: int, pair: Pairs, runs: list[Runs], error: Error) -> None:
    """Set the derivatives by one number; one-sided where contacts are lost or a stage is reached on the other side."""
    for side, stencil in STENCILS.items():
        if not pair.fits(stencil.offsets).all():
            continue
        offsets = stencil.offsets.tolist()
        own, beside = runs[-1](0.0), [runs[-1](offset) for offset in offsets]
        other_end, other_stage = (
            any(run.end != own.end for run in beside),
            any(run.stage != own.stage for run in beside),
        )
        if side == SMOOTH:
            slopes.other_end[k], slopes.other_stage[k] = other_end, other_stage
        if other_end or other_stage:
            continue
        tables = [np.stack([run(offset).values for offset in offsets], axis=-1) for run in runs]
        coarse, middle, fine = (applied(table, stencil.weights) / pair.step[0] for table in tables)
        slopes.side[k], slopes.kinks[k] = side, kinked(tables[-1], stencil.base, BENT)
        fine[slopes.kinks[k]] = np.nan
        change = error(abs(middle - coarse), abs(fine - middle))
        slopes.put(np.array([k]), fine[None], change[None], own.values[None], pair.value, 1.0)
        return
