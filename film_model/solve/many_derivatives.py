"""Derivatives of the summaries of many impacts, each with its own decisions held fixed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, Mask
from film_model.base.errors import SimulationError
from film_model.effects.choose import choose
from film_model.effects.decided import Decision, decisions_of
from film_model.effects.many import rows_of
from film_model.oblique.result import OBLIQUE
from film_model.problem.problem import Problem
from film_model.problem.summary import SUMMARY
from film_model.scene import DEFAULT_ACCURACY, Scene, Solver
from film_model.scene.columns import scene_of_columns
from film_model.solve.chain import slopes
from film_model.solve.derivatives import Entry, pairs_of, slopes_of
from film_model.solve.slopes import NO_DERIVATIVE, Slopes
from film_model.solve.slopes_along import slopes_along
from film_model.solve.vibration import vibrate


class ManyDerivatives(NamedTuple):
    """Derivatives of many impacts by some numbers: (impacts, numbers).

    values: by the names of `SUMMARY` and, if asked, of `OBLIQUE`, SI, nan where there is none. error, side: of the
    summary, the largest estimated relative error of each pair, and as in :class:`Slopes`.
    """

    values: dict[str, Array]
    error: Array
    side: NDArray[np.int8]


def derivatives_of_many(
    scene: Scene,
    columns: Mapping[str, Array],
    entries: Sequence[Entry],
    problems: Iterable[Problem],
    on_modes: Mask,
    solver: Solver,
    target: float,
    along: bool = False,
) -> ManyDerivatives:
    """Derivatives of impacts of a scene, in which columns replace some numbers.

    problems: of the impacts, as simulated. on_modes: which impacts were simulated on targets that vibrate; they, and
    those of viscoelastic bodies, are followed one by one. Others, which failed, have no derivatives.
    target: error to which meshes are refined. along: results along the surface, too, of impacts with friction.
    """
    count = on_modes.size
    shape = count, len(entries)
    values = {name: np.full(shape, np.nan) for name in (*SUMMARY, *(OBLIQUE if along else ()))}
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
        for name, column in zip(OBLIQUE, slopes_along(pairs).values.T, strict=True) if along else ():
            values[name][rows] = column.reshape(rows.size, -1)
        side[rows] = found.side.reshape(rows.size, -1)
        error[rows] = np.fmax.reduce(found.errors, axis=1).reshape(rows.size, -1)
    relaxing = [rows_of(problem) for problem in given if problem.relaxation is not None]
    for row in np.sort(np.concatenate([np.flatnonzero(on_modes), *relaxing])).tolist() if entries else ():
        own = {path: float(column[row]) for path, column in columns.items()}
        for k, found in enumerate(_in_steps(scene, own, entries, solver)):
            if found is None:
                continue
            for name, value in zip(SUMMARY, found.values[0].tolist(), strict=True):
                values[name][row, k] = value
            side[row, k], error[row, k] = found.side[0], np.fmax.reduce(found.errors[0])
    return ManyDerivatives(values, error, side)


def _in_steps(
    scene: Scene, numbers: Mapping[str, float], entries: Sequence[Entry], solver: Solver
) -> Iterator[Slopes | None]:
    """The derivatives of an impact that is followed in steps, by each number; None where they are not supported."""
    replaced: dict[str, Any] = dict(numbers)
    choice = choose(scene_of_columns(scene, replaced))
    problem, vibration = choice.problem, None
    if problem.vibrates:
        vibration = vibrate(problem, choice.scene.target, solver.accuracy or DEFAULT_ACCURACY, [])[0]
    for entry in entries:
        own = entry._replace(value=numbers.get(entry.path, entry.value))
        try:
            yield slopes_of(choice, solver, [own], vibration)
        except SimulationError:
            yield None


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
