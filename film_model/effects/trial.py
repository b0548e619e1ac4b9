"""The change of the summary by neglecting an effect, from two marches on a coarse mesh: with it and without."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Index, Mask, ratio
from film_model.core import solving
from film_model.problem.problem import Problem

LEVELS = ((1.1, 2.0, 2.0), (1.01, 1.2, 1.1), (1.001, 1.05, 1.01))
"""Cells of similar impacts, three sizes. Each: the ratio that a cell spans in velocity, target compliance and damping;
the ratio it spans in load; and the factor by which a change, scaled with the load, must differ from the tolerance to
decide the whole cell. Impacts that are not decided go to the next size, and at the end are tried one by one."""

FEW = 32
"""Up to so many impacts are each tried: this takes less time than to sort them into cells."""


def change(full: Problem, without: Problem) -> Any:
    """Largest relative difference of two summaries; nan if one march failed, 1 if contact ends in only one of them.

    Force, maximum indentation and times are relative to the values of `full`, permanent indentations to its maximum
    indentation, velocities to the approach velocity, energies to the impact energy: film_change in film_solve.h.
    """
    p, q = full.scales, without.scales
    units = q.length / p.length, q.force / p.force, q.time / p.time, q.velocity / p.velocity
    one, other = ((each.trial.status, each.start, each.trial.summary) for each in (full, without))
    return solving.change(one, other, units)


def few(problem: Problem) -> bool:
    """Whether the impacts are each tried: one, or up to `FEW`."""
    return not problem.impacts.many or problem.approach.size <= FEW


def beyond(size: Any, tolerance: float) -> Any:
    """Whether a change is larger than the tolerance, or unknown (nan)."""
    return ~(size <= tolerance) if isinstance(size, np.ndarray) else not size <= tolerance


def matters(
    full: Problem, without: Problem, size: Callable[[Problem, Problem], Any] = change, where: Mask | None = None
) -> Any:
    """Whether neglecting an effect changes the summary by more than the scene's tolerance, or by an unknown amount.

    size: the change, from a problem with the effect and one without. Many impacts are not tried one by one: impacts
    with similar numbers form cells, and the two extreme impacts of a cell are tried. If both clearly give the same
    answer, it is taken for the whole cell. where: mask of the impacts in question; False for the others.
    """
    tolerance = full.scene.effect_tolerance
    if few(full) and where is None:
        return beyond(size(full, without), tolerance)
    found = np.zeros(full.approach.shape, np.bool_)
    left = np.arange(found.size) if where is None else np.flatnonzero(where)
    for width, load_width, clear in LEVELS:
        if left.size <= FEW:
            break
        low, high, cell = _ends_of_cells(full, left, width, load_width)
        answers: list[Mask] = []
        known = np.ones(left.size, np.bool_)
        for tried in (low, high):
            places = left[tried]
            load = full.load[places]
            sizes = size(full.part(places), without.part(places))
            found[places] = ~(sizes <= tolerance)
            scaled = sizes[cell] * np.where(full.load[left] > 0.0, ratio(full.load[left], load[cell]), 1.0)
            known &= (scaled < tolerance / clear) | (scaled > clear * tolerance)
            answers.append(~(scaled <= tolerance))
        known &= answers[0] == answers[1]
        found[left[known]] = answers[0][known]
        known[low] = known[high] = True
        left = left[~known]
    if left.size:
        tried = (full, without) if left.size == found.size else (full.part(left), without.part(left))
        found[left] = ~(size(*tried) <= tolerance)
    return found


def _ends_of_cells(full: Problem, places: Index, width: float, load_width: float) -> tuple[Index, Index, Index]:
    """Indices of the two extreme impacts of each cell, and the cell number of every impact.

    The extremes are the slowest and the fastest; under a load, those with the largest and smallest weight over force.
    """
    cells, speed = _cells(full, places, width, load_width), full.approach[places]
    if full.load.any():
        speed = speed**1.2 / np.maximum(full.load[places], 1e-300)  # decreases as weight over largest force increases
    most = int(cells.max(initial=0))
    if most > 8 * cells.size:  # the table below would be mostly empty
        _, cells = np.unique(cells, return_inverse=True)
        most = int(cells.max(initial=0))
    found: list[Index] = []
    for extreme, beyond in ((np.minimum, math.inf), (np.maximum, -math.inf)):
        ends = np.full(most + 1, beyond)
        extreme.at(ends, cells, speed)
        at = np.flatnonzero(speed == ends[cells])[::-1]
        table = np.full(most + 1, -1)
        table[cells[at]] = at  # reversed above, so that the first of equal speeds is written last
        found.append(table)
    filled = np.flatnonzero(found[0] >= 0)
    number = np.empty(most + 1, np.intp)
    number[filled] = np.arange(filled.size)
    return found[0][filled], found[1][filled], number[cells]


def _cells(full: Problem, places: Index, width: float, load_width: float) -> NDArray[np.int64]:
    """A cell number for each impact, equal for impacts with similar dimensionless numbers."""
    cells = np.zeros(places.size, np.int64)
    widths = [(full.approach, width), (full.gamma, width), (full.damping, width), (full.load, load_width)]
    widths += [] if full.own.spring is None else [(full.own.spring, width)]
    for column, step in widths:
        if column.any():
            values = column[places]
            with np.errstate(divide="ignore", invalid="ignore"):
                steps = np.floor(np.log(values) / math.log(step))
            number = np.where(np.isfinite(steps), steps, 0.0).astype(np.int64)
            number = np.where(np.isfinite(steps), number - number.min() + 1, 0)
            cells = cells * (number.max() + 1) + number
    return cells
