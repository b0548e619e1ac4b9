"""Intervals by profile likelihood: how far a parameter can be from its best value if all others are fitted again."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from film_datasets.identification.model import NUMERICS, Array

MARGIN = 1e-9
"""Distance from the bounds, in the scaled parameters: at them rounding might make a value invalid."""


class Profile:
    """The least sum of squares as a function of parameter k, all others fitted again from the solution before.

    residuals, jacobian, bounds: of the scaled parameters. best: the solution. A sum of squares below the model's own
    rounding error counts as that.
    """

    def __init__(
        self,
        residuals: Callable[[Array], Array],
        jacobian: Callable[[Array], Array],
        bounds: tuple[Array, Array],
        best: Array,
        k: int,
    ) -> None:
        self._residuals, self._jacobian, self._best, self._k = residuals, jacobian, best, k
        self._others = np.arange(best.size) != k
        self._ends = float(bounds[0][k]) + MARGIN, float(bounds[1][k]) - MARGIN
        self._limits: Any = (bounds[0][self._others], bounds[1][self._others])
        found = residuals(best)
        self._least = max(float(found @ found), found.size * NUMERICS.accuracy**2)
        self._z = best.copy()

    def interval(self, rise: float, step: float) -> tuple[float, float]:
        """The values below and above the best at which the sum of squares is `rise` times the least; infinite, where
        it is not that large within the parameter's bounds. step: about half the width. By Brent's method."""
        low, high = (self._end(side, rise, step) for side in (-1.0, 1.0))
        return low, high

    def _end(self, side: float, rise: float, step: float) -> float:
        from scipy.optimize import brentq  # lazy: importing scipy.optimize takes 1 s

        self._z = self._best.copy()
        near, distance = float(self._best[self._k]), min(max(step, 1e-9), 1.0)
        for _ in range(12):
            far = min(max(near + side * distance, self._ends[0]), self._ends[1])
            if self._excess(far, rise) > 0.0:
                root: Any = brentq(self._excess, near, far, args=(rise,), xtol=1e-3 * distance)
                return float(root)
            if far in self._ends:
                break
            near, distance = far, 2.0 * distance
        return side * math.inf

    def _excess(self, value: float, rise: float) -> float:
        """The least sum of squares with this value of the parameter, less `rise` times that of the solution."""
        from scipy.optimize import least_squares  # lazy: importing scipy.optimize takes 1 s

        self._z[self._k] = value
        if self._others.any():
            start = np.clip(self._z[self._others], self._limits[0] + MARGIN, self._limits[1] - MARGIN)
            slopes: Any = self._slopes  # SciPy's annotation allows the name of a difference scheme only
            fitted = least_squares(self._rest, start, slopes, self._limits, xtol=1e-8)
            self._z[self._others] = fitted.x
        found = self._residuals(self._z)
        return float(found @ found) - rise * self._least

    def _placed(self, rest: Array) -> Array:
        z = self._z.copy()
        z[self._others] = rest
        return z

    def _rest(self, rest: Array) -> Array:
        return self._residuals(self._placed(rest))

    def _slopes(self, rest: Array) -> Array:
        return self._jacobian(self._placed(rest))[:, self._others]
