"""Chebyshev series, by which the core evaluates functions that are not powers, and the series of their means."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from film_model.base.arrays import Array
from film_model.core import native


def mean_series(series: Array, root: bool) -> Array:
    """The series of the running mean of a series over its interval; it has the same degree."""
    nodes, weights = _gauss()
    part = 0.5 * (1.0 + nodes)
    weights = weights * part if root else 0.5 * weights  # over x = u²: dx = 2 u du
    at = np.polynomial.chebyshev.chebpts1(len(series))
    values = np.polynomial.chebyshev.chebval(0.5 * (1.0 + at[:, None]) * part * 2.0 - 1.0, series) @ weights
    return coefficients(values)


@lru_cache(maxsize=1)
def _gauss() -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(native.MAX_TERMS)


def coefficients(values: Array) -> Array:
    """The Chebyshev series through values at `chebyshev.chebpts1`.

    A cosine transform, summed without BLAS: its rounding is the same on every processor.
    """
    count = len(values)
    quarters = np.outer(np.arange(count), 2 * np.arange(count) + 1) % (4 * count)  # angles in units of π/(2 count)
    cosines = np.cos(np.pi / (2 * count) * np.arange(4 * count))[quarters]
    series = (cosines * values[::-1]).sum(axis=1) * (2.0 / count)
    series[0] /= 2.0
    return series
