"""Sobol's indices of a result, with confidence intervals: which share of its variance each number causes.

First order: the variance of the mean over all other numbers; total: with all interactions (Saltelli et al. 2010, by
`scipy.stats.sobol_indices`). They need independent numbers.
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


def indices(results: Array, confidence: float, seed: int) -> list[Indices]:
    """Indices of each number from the results of `designs` (d + 2, n); nan if the results do not vary.

    Points of which a result is nan are omitted; the others are cut to a power of two. The intervals are those of a
    percentile bootstrap with a generator of its own, because SciPy's draws from NumPy's global one.
    """
    known = np.flatnonzero(np.isfinite(results).all(axis=0))
    count = 1 << (known.size.bit_length() - 1) if known.size else 0
    if count < 4 or not np.ptp(results[0, known]) > 0.0:
        none = Interval(np.nan, np.nan, np.nan)
        return [Indices(none, none)] * (results.shape[0] - 2)
    used, generator = results[:, known[:count]], np.random.default_rng(seed)
    drawn = np.concatenate([np.arange(count)[None], generator.integers(count, size=(RESAMPLES, count))])
    estimates = _estimates(used[:, drawn])  # the sample itself first
    found = estimates[..., 0]
    low, high = np.quantile(estimates[..., 1:], [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence], axis=-1)
    both = [[Interval(*map(float, one)) for one in zip(found[k], low[k], high[k], strict=True)] for k in range(2)]
    return [Indices(first, total) for first, total in zip(*both, strict=True)]


def _estimates(results: Array) -> Array:
    """First-order and total indices from many samples (d + 2, samples, n): (2, d, samples)."""
    from scipy.stats import sobol_indices  # lazy: importing scipy.stats takes 1 s

    designs, samples, n = results.shape
    made = sobol_indices(func={"f_A": results[0], "f_B": results[1], "f_AB": results[2:]}, n=n)
    both = (made.first_order, made.total_order)
    return np.array([np.reshape(one, (samples, designs - 2)).T for one in both])
