"""Derivatives of the summaries of many impacts, each with its own decisions held fixed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index
from film_model.effects.decided import Decision, decisions_of
from film_model.effects.many import rows_of
from film_model.problem.problem import Problem
from film_model.problem.summary import SUMMARY
from film_model.scene import Scene, Solver
from film_model.solve.derivatives import Entry, pairs_of
from film_model.solve.chain import slopes
from film_model.solve.slopes import NO_DERIVATIVE


class ManyDerivatives(NamedTuple):
    """Derivatives of many impacts by some numbers: (impacts, numbers).

    values: by the names of `SUMMARY`, SI, nan where there is none. error: largest estimated relative error of each
    pair. side: as in :class:`Slopes`.
    """

    values: dict[str, Array]
    error: Array
    side: NDArray[np.int8]


def derivatives_of_many(
    scene: Scene,
    columns: Mapping[str, Array],
    entries: Sequence[Entry],
    problems: Iterable[Problem],
    count: int,
    solver: Solver,
    target: float,
) -> ManyDerivatives:
    """Derivatives of `count` impacts of a scene, in which columns replace some numbers.

    problems: of the impacts, as simulated; others, which failed or are on vibrating targets, have no derivatives, nor
    have impacts of viscoelastic bodies.
    target: error to which meshes are refined.
    """
    shape = count, len(entries)
    values = {name: np.full(shape, np.nan) for name in SUMMARY}
    error, side = np.full(shape, np.nan), np.full(shape, NO_DERIVATIVE, np.int8)
    given = list(problems)
    strength = _strengths(given, count)
    for decision, rows in _by_decision(given).items() if entries else ():
        own = {path: values[rows] for path, values in columns.items()}
        hard = strength[rows] if decision.hard else None
        pairs = pairs_of(decision.put_into(scene), own, entries, rows.size, hard)
        found = slopes(pairs, solver, target)
        for name, column in zip(SUMMARY, found.values.T, strict=True):
            values[name][rows] = column.reshape(rows.size, -1)
        side[rows] = found.side.reshape(rows.size, -1)
        error[rows] = np.fmax.reduce(found.errors, axis=1).reshape(rows.size, -1)
    return ManyDerivatives(values, error, side)


def _by_decision(problems: Iterable[Problem]) -> dict[Decision, Index]:
    """The impacts of each decision, ascending; without those of viscoelastic bodies."""
    found: dict[Decision, list[Index]] = {}
    for problem in problems:
        for decision, mask in decisions_of(problem).items() if problem.relaxation is None else ():
            found.setdefault(decision, []).append(rows_of(problem)[mask])
    return {decision: np.sort(np.concatenate(rows)) for decision, rows in sorted(found.items())}


def _strengths(problems: Iterable[Problem], count: int) -> Array:
    """The yield strength of each impact's law, Pa; nan if it has none."""
    found = np.full(count, np.nan)
    for problem in problems:
        strength = problem.impacts.law.strength
        found[rows_of(problem)] = np.nan if strength is None else strength
    return found
