"""Distributions of swept quantities, by their quantile functions, and the correlation between quantities."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import shown
from film_model.base.fields import Field
from film_model.base.units import to_si

SMALLEST_PROBABILITY = 2.0**-53
"""Smaller probabilities are raised to it, so that every drawn value is finite: it is 8.1 standard deviations."""


@dataclass(frozen=True)
class Distribution:
    """A distribution. what: its parameters, in words. roles: of each parameter, "value" of the swept quantity,
    "spread" (a difference, > 0) or "number" (> 0). increasing: places of values that must increase. quantile: values at
    probabilities, from the parameters in SI."""

    what: str
    roles: tuple[str, ...]
    increasing: tuple[int, ...]
    quantile: Callable[[Array, Sequence[float]], Array]


def _normal(u: Array, numbers: Sequence[float]) -> Array:
    mean, deviation = numbers
    return mean + deviation * _deviations(u)


def _lognormal(u: Array, numbers: Sequence[float]) -> Array:
    mean, deviation = numbers
    variance = math.log1p((deviation / mean) ** 2)  # of the logarithm
    return mean * np.exp(math.sqrt(variance) * _deviations(u) - 0.5 * variance)


def _truncated_normal(u: Array, numbers: Sequence[float]) -> Array:
    from scipy.stats import truncnorm  # lazy: importing scipy.stats takes 1 s

    mean, deviation, low, high = numbers
    found = truncnorm.ppf(u, (low - mean) / deviation, (high - mean) / deviation, loc=mean, scale=deviation)
    return np.clip(found, low, high)  # rounding


def _uniform(u: Array, numbers: Sequence[float]) -> Array:
    low, high = numbers
    return np.where(u == 1.0, high, low + (high - low) * u)


def _triangular(u: Array, numbers: Sequence[float]) -> Array:
    from scipy.stats import triang  # lazy: importing scipy.stats takes 1 s

    low, mode, high = numbers
    return triang.ppf(u, (mode - low) / (high - low), loc=low, scale=high - low)


def _weibull(u: Array, numbers: Sequence[float]) -> Array:
    from scipy.stats import weibull_min  # lazy: importing scipy.stats takes 1 s

    shape, scale = numbers
    return weibull_min.ppf(np.minimum(u, 1.0 - SMALLEST_PROBABILITY), shape, scale=scale)


DISTRIBUTIONS = {
    "normal": Distribution("mean and standard deviation", ("value", "spread"), (), _normal),
    "lognormal": Distribution("mean and standard deviation", ("value", "spread"), (), _lognormal),
    "uniform": Distribution("least and greatest value", ("value", "value"), (0, 1), _uniform),
    "truncated-normal": Distribution(
        *("mean, standard deviation, least and greatest value", ("value", "spread", "value", "value"), (2, 3)),
        _truncated_normal,
    ),
    "triangular": Distribution("least, most likely and greatest value", ("value",) * 3, (0, 1, 2), _triangular),
    "weibull": Distribution("shape and scale", ("number", "spread"), (), _weibull),
}

EMPIRICAL = "empirical"
"""A distribution given by observed values: quantiles by linear interpolation between them."""


def read_distribution(kind: str, given: Any, field: Field) -> tuple[float, ...]:
    """The parameters of a distribution, SI. Raises ValueError."""
    if isinstance(given, str) or not isinstance(given, Sequence):
        given = getattr(given, "tolist", lambda: given)()
    if kind == EMPIRICAL:
        return _observed(given, field)
    distribution = DISTRIBUTIONS[kind]
    if not isinstance(given, list | tuple) or len(given) != len(distribution.roles):
        count = {2: "two", 3: "three", 4: "four"}[len(distribution.roles)]
        raise ValueError(f"{kind} needs a list of {count} values: {distribution.what}")
    numbers: list[float] = []
    for role, value in zip(distribution.roles, given, strict=True):
        read = field.read if role == "value" else field.read_width
        numbers.append(to_si(value, "dimensionless") if role == "number" else read(value))
        if role != "value" and not numbers[-1] > 0.0:
            name = "standard deviation" if "deviation" in distribution.what else "shape or scale"
            raise ValueError(f"the {name} {shown(value)} must be > 0")
    ordered = [numbers[place] for place in distribution.increasing]
    if ordered != sorted(ordered) or (ordered and not ordered[0] < ordered[-1]):
        last = "" if kind != "uniform" else "the least value first, and a greater one"
        raise ValueError(f"{kind} needs {last or distribution.what + ', the least value first'}")
    if kind == "lognormal" and not numbers[0] > 0.0:
        raise ValueError(f"the mean {shown(given[0])} of a lognormal distribution must be > 0")
    return tuple(numbers)


def _observed(given: Any, field: Field) -> tuple[float, ...]:
    most_observed = 10_000  # values of an empirical distribution: all are stored in sweep_toml
    if not isinstance(given, list | tuple) or not 2 <= len(given) <= most_observed:
        raise ValueError(f"{EMPIRICAL} needs a list of 2 to {most_observed} observed values")
    return tuple(sorted(field.read(value) for value in given))


def quantiles(kind: str, u: Array, numbers: Sequence[float]) -> Array:
    """Values of a distribution at probabilities u, SI."""
    if kind == EMPIRICAL:
        return np.interp(u, np.linspace(0.0, 1.0, len(numbers)), np.asarray(numbers))
    return DISTRIBUTIONS[kind].quantile(u, numbers)


def correlation_factor(given: Any, names: Sequence[str]) -> Array:
    """The lower triangular factor L, L L' = C, of a correlation matrix C over the swept quantities `names`.

    Raises ValueError if C is not a correlation matrix.
    """
    size = f"{len(names)} rows and columns, for {', '.join(names)}"
    try:
        matrix = np.asarray(given, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"a matrix of numbers with {size} is needed") from None
    if matrix.shape != (len(names), len(names)):
        raise ValueError(f"a matrix with {size} is needed, not one of shape {matrix.shape}")
    if not (np.isfinite(matrix).all() and (matrix == matrix.T).all() and (np.diag(matrix) == 1.0).all()):
        raise ValueError("a correlation matrix is symmetric, with 1 on its diagonal")
    try:
        return np.asarray(np.linalg.cholesky(matrix), np.float64)
    except np.linalg.LinAlgError:
        least = float(np.linalg.eigvalsh(matrix)[0])
        raise ValueError(f"no correlations can be like this: the least eigenvalue is {least:.3g}, not > 0") from None


def correlated(u: Array, factor: Array) -> Array:
    """Probabilities with a Gaussian copula from independent ones, (impacts, quantities).

    The normal deviates of the result have the correlations L L'. Sums are formed in a fixed order, so that a row does
    not depend on the rows beside it.
    """
    z = deviates(u)
    mixed = np.empty_like(z)
    for k, row in enumerate(factor):
        mixed[:, k] = row[0] * z[:, 0]
        for j in range(1, k + 1):
            mixed[:, k] += row[j] * z[:, j]
    return probabilities(mixed)


def deviates(u: Array) -> Array:
    """Standard normal deviates at probabilities, finite at 0 and 1."""
    return _deviations(np.minimum(u, 1.0 - SMALLEST_PROBABILITY))


def probabilities(z: Array) -> Array:
    """Of standard normal deviates."""
    from scipy.special import ndtr  # lazy: only distributions need SciPy

    return ndtr(z)


def _deviations(u: Array) -> Array:
    """Standard normal deviates at probabilities."""
    from scipy.special import ndtri  # lazy: only distributions need SciPy

    return ndtri(np.maximum(u, SMALLEST_PROBABILITY))
