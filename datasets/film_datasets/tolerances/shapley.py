"""Shapley effects of numbers that are correlated: the share of each in the variance of a result (Owen 2014; Song,
Nelson & Staum 2016).

c(S) = E[Var(y | the others than S)] is what the numbers S add when the others are known. The effect of a number is the
mean, over all orders in which the numbers may become known, of what it adds to c. The effects are >= 0 and their sum is
the variance; without correlation each lies between the first-order and the total index. 2^d designs are needed for d
numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.sweeps.distributions import deviates, probabilities
from film_datasets.tolerances.sobol import Interval, interval, means
from film_model.base.arrays import Array

MOST_NUMBERS = 8
"""More numbers would need more than 256 designs."""

Subset = tuple[int, ...]


def subsets(count: int) -> list[Subset]:
    """All sets of `count` numbers but the empty one, the smallest first."""
    return [one for size in range(1, count + 1) for one in combinations(range(count), size)]


def designs(u: Array, correlation: Array) -> Iterator[Array]:
    """The impacts for the effects of d correlated numbers, from independent points u (n, 2 d): A, then for each subset
    A with its numbers drawn again, given the others. 2^d times (n, d) probabilities.

    Of normal deviates a, b of the correlation C, b_S + C_SO C_OO⁻¹ (a_O − b_O) are new ones of S given the others O.
    """
    d = u.shape[1] // 2
    factor = np.linalg.cholesky(correlation)
    a, b = (_mixed(deviates(part), factor) for part in (u[:, :d], u[:, d:]))
    yield probabilities(a)
    for subset in subsets(d):
        others = [k for k in range(d) if k not in subset]
        drawn = a.copy()
        drawn[:, subset] = b[:, subset]
        if others:
            weights = np.linalg.solve(correlation[np.ix_(others, others)], correlation[np.ix_(others, subset)])
            drawn[:, subset] += _mixed(a[:, others] - b[:, others], weights.T)
        yield probabilities(drawn)


def _mixed(z: Array, rows: NDArray[Any]) -> Array:
    """z times the transpose of `rows`, summed in a fixed order: a point does not depend on those beside it."""
    return np.stack([sum((row[j] * z[:, j] for j in range(1, z.shape[1])), row[0] * z[:, 0]) for row in rows], axis=1)


def effects(results: Array, confidence: float, seed: int) -> list[Interval]:
    """Share of each number in the variance, from the results of `designs` (2^d, n), with bootstrap intervals; nan if
    the results do not vary. Points of which a result is nan are omitted."""
    d = (results.shape[0] - 1).bit_length()
    used = results[:, np.isfinite(results).all(axis=0)]
    if used.shape[1] < 4 or not np.ptp(used[0]) > 0.0:
        return [Interval(np.nan, np.nan, np.nan)] * d
    added = means(0.5 * (used[1:] - used[0]) ** 2, seed)  # c(S) = E[(y − y')²]/2
    shares = shares_of(dict(zip(subsets(d), added, strict=True)), d)
    return [interval(one, confidence) for one in shares]


def linear_shares(each: NDArray[Any], correlation: Array) -> list[float]:
    """The effects where y is the sum of normal numbers of standard deviations `each` and these correlations."""
    inverse, added = np.linalg.inv(correlation), dict[Subset, Any]()
    for subset in subsets(each.size):
        given = np.linalg.inv(inverse[np.ix_(subset, subset)])  # the covariance of S, given the others
        added[subset] = float(each[list(subset)] @ given @ each[list(subset)])
    return shares_of(added, each.size).tolist()


def shares_of(added: Mapping[Subset, Any], d: int) -> Array:
    """Shapley's means of c, over c of all numbers."""
    shares = []
    for k in range(d):
        share = added[k,] / d
        for subset in added:
            if k not in subset:
                weight = 1.0 / (d * math.comb(d - 1, len(subset)))
                share = share + weight * (added[tuple(sorted((*subset, k)))] - added[subset])
        shares.append(share / added[tuple(range(d))])
    return np.array(shares)
