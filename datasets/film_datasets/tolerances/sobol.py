"""Sobol's indices of a result, with confidence intervals: which share of its variance each number causes.

First order: the variance of the mean over all other numbers; total: with all interactions (Saltelli et al. 2010, table
2, b and f). They need independent numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array

RESAMPLES = 300
"""Bootstrap samples of the intervals."""


class Interval(NamedTuple):
    """An estimate, and the ends of its confidence interval."""

    value: float
    low: float
    high: float


class Indices(NamedTuple):
    """Of one number. first: share of the variance by itself; total: with its interactions."""

    first: Interval
    total: Interval


def designs(u: Array) -> Array:
    """The impacts for the indices of d numbers, from points u (n, 2 d): A, B, and for each number A with B's column.

    (d + 2, n, d) probabilities.
    """
    n, d = u.shape[0], u.shape[1] // 2
    found = np.broadcast_to(u[:, :d], (d + 2, n, d)).copy()
    found[1] = u[:, d:]
    for k in range(d):
        found[2 + k, :, k] = u[:, d + k]
    return found


def means(terms: Array, seed: int) -> Array:
    """Of each row of `terms` (rows, n): the mean, then those of bootstrap samples of the n points, the same for all
    rows: (rows, 1 + RESAMPLES)."""
    count, generator = terms.shape[1], np.random.default_rng(seed)
    found = [terms.mean(axis=1)]
    for _ in range(RESAMPLES):
        weights = np.bincount(generator.integers(count, size=count), minlength=count)
        found.append(np.einsum("kn,n->k", terms, weights) / count)
    return np.array(found).T


def indices(results: Array, confidence: float, seed: int) -> list[Indices]:
    """Indices of each number from the results of `designs` (d + 2, n); nan if the results do not vary.

    Points of which a result is nan are omitted. The intervals are those of a percentile bootstrap.
    """
    used = results[:, np.isfinite(results).all(axis=0)]
    if used.shape[1] < 4 or not np.ptp(used[0]) > 0.0:
        none = Interval(np.nan, np.nan, np.nan)
        return [Indices(none, none)] * (results.shape[0] - 2)
    used = used - used[:2].mean()
    a, b, mixed = used[0], used[1], used[2:]
    found = means(np.concatenate([[a + b, a * a + b * b], b * (mixed - a), 0.5 * (mixed - a) ** 2]), seed)
    shares = found[2:] / (0.5 * found[1] - (0.5 * found[0]) ** 2)
    ends = [interval(one, confidence) for one in shares]
    return [Indices(*pair) for pair in zip(ends[: len(mixed)], ends[len(mixed) :], strict=True)]


def interval(estimates: Array, confidence: float) -> Interval:
    """The estimate of the sample itself, which is the first, within the quantiles of the others."""
    low, high = np.quantile(estimates[1:], [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence])
    return Interval(float(estimates[0]), float(low), float(high))
