"""One number at a time: a result at a low and a high value of each number, the others at their medians, given it.

Correlated numbers follow each other: the median of one, given another, moves with it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from film_datasets.sweeps.axis import Axis
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.distributions import deviates, probabilities
from film_datasets.tolerances.inputs import check_quantities, results_at, scattering

LOW, HIGH = 0.05, 0.95
"""Probabilities of the low and the high value."""


class Swing(NamedTuple):
    """A result where one number has a low and a high value, SI. median: with all numbers at their medians."""

    path: str
    low: float
    high: float
    at_low: float
    at_high: float
    median: float

    @property
    def size(self) -> float:
        """How far apart the two results are."""
        return abs(self.at_high - self.at_low)


def one_at_a_time(sweep: Sweep, quantity: str) -> tuple[Swing, ...]:
    """The swing of a summary value by each number of a sweep, largest first.

    Low and high are the 5 % and 95 % quantiles, or the ends of a list. Raises SceneError for a sweep over words,
    ValueError for an unknown quantity or if no impact at the medians has a value.
    """
    check_quantities([quantity])
    axes = scattering(sweep)
    matrix = np.array(sweep.correlation) if sweep.correlation else np.eye(len(axes))
    z = deviates(np.array([LOW, HIGH]))
    u = np.full((1 + 2 * len(axes), len(axes)), 0.5)
    for k, row in enumerate(matrix):
        u[1 + 2 * k : 3 + 2 * k] = np.where(row == 0.0, 0.5, probabilities(z[:, None] * row))
        u[1 + 2 * k, k], u[2 + 2 * k, k] = LOW, HIGH
    median, *others = results_at(sweep, axes, u, [quantity])[0].tolist()
    if not np.isfinite(median):
        raise ValueError(f"quantity: {quantity} has no value where all swept numbers have their medians")
    pairs = zip(others[::2], others[1::2], strict=True)
    found = [Swing(axis.path, *_ends(axis), *pair, median) for axis, pair in zip(axes, pairs, strict=True)]
    return tuple(sorted(found, key=lambda swing: -np.nan_to_num(swing.size)))


def _ends(axis: Axis) -> tuple[float, float]:
    low, high = np.asarray(axis.quantile(np.array([LOW, HIGH])), np.float64).tolist()
    return low, high
