"""The numbers of a scene that scatter: their moments and quantiles, and the impacts at given probabilities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.polynomial.hermite_e import hermegauss

from film_datasets.impacts import results_of
from film_datasets.sweeps.axis import Axis
from film_datasets.sweeps.definition import Sweep
from film_model.base.arrays import Array
from film_model.base.errors import Mistake, SceneError, did_you_mean, shown
from film_model.solve.derivatives import RESULTS

_WORDS = "has words, a tolerance needs a number with a distribution: keep one word in the scene"


def scattering(sweep: Sweep) -> tuple[Axis, ...]:
    """The axes of a sweep. Raises SceneError if one of them is no number, or no number scatters."""
    words = [axis.path for axis in sweep.choice_axes]
    if words:
        raise SceneError([Mistake(None, None, f"over.{path}", _WORDS) for path in words])
    return sweep.axes


def moments(axis: Axis) -> tuple[float, float]:
    """Mean and standard deviation, SI."""
    from scipy.special import ndtr  # lazy: only distributions need SciPy

    # nodes for which moments are exact for normal distributions, to 1e-9 for smooth ones
    z, weights = hermegauss(96)
    weights = weights / weights.sum()
    inside = np.clip(ndtr(z), 1e-300, 1.0 - 2.0**-53)
    values = np.asarray(axis.quantile(inside), np.float64)
    mean = float(np.sum(weights * values))
    return mean, float(np.sqrt(np.sum(weights * (values - mean) ** 2)))


def results_at(sweep: Sweep, axes: Sequence[Axis], u: Array, quantities: Sequence[str]) -> Array:
    """Results at probabilities u (impacts, axes): (quantities, impacts); nan where an impact has none."""
    columns = {axis.path: np.asarray(axis.quantile(u[:, k]), np.float64) for k, axis in enumerate(axes)}
    outside = [axis.outside(columns[axis.path]) for axis in axes]
    inside = np.flatnonzero(~np.logical_or.reduce(outside))
    found = np.full((len(quantities), u.shape[0]), np.nan)
    if inside.size:
        results = results_of(sweep.first, {path: values[inside] for path, values in columns.items()}, quantities)
        found[:, inside] = [results[name] for name in quantities]
    return found


def check_quantities(quantities: Sequence[str]) -> None:
    """Raise ValueError for a name that is no result."""
    for name in quantities:
        if name not in RESULTS:
            raise ValueError(f"quantity: {shown(name)} is not a summary value{did_you_mean(name, RESULTS)}")
