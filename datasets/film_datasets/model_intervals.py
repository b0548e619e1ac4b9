"""Intervals of measured values for the impacts of a sweep, from `film_model.problem.model_intervals`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from film_datasets.sampling import parts_of
from film_datasets.schema import require, require_impacts
from film_datasets.sweeps import Sweep
from film_model.base.foreign import Dataset
from film_model.effects.many import problems_of, rows_of
from film_model.problem.model_intervals import ASKED, COVERED, LARGEST, asked_number, evidence, missing, residuals_of
from film_model.problem.summary import SUMMARY

NONE = -1
"""Family of an impact of which measurements are not asked for."""


def sweep_intervals(ds: Dataset, sweep: Sweep) -> Dataset:
    """For each impact of a sweep or of a selection, the family of its measurements, and low and high of the interval of
    each summary value that has one; NaN without. See `film_datasets.accessor.Film.intervals`."""
    block = 100_000  # impacts whose decisions are held in memory at a time
    require_impacts(ds)
    names = [name for name in SUMMARY if any(residuals_of(family, name) for family in ASKED)]
    require(ds, names)
    status = ds["status"]
    family = np.full(status.size, NONE, np.int8)
    for scene, rows, numbers in parts_of(ds, sweep):
        for first in range(0, rows.size, block):
            places = rows[first : first + block]
            own = {path: values[first : first + block] for path, values in numbers.items()}
            for problem in problems_of(scene, own, places.size):
                family[places[rows_of(problem)]] = asked_number(problem)
    import xarray as xr

    meaning = {"long_name": "family of measured impacts", "flag_values": np.arange(NONE, len(ASKED), dtype=np.int8)}
    meaning["flag_meanings"] = " ".join(("none", *ASKED))
    data: dict[str, Any] = {"family": (status.dims, family.reshape(status.shape), meaning)}
    for name in names:
        value = ds[name].transpose(*status.dims)
        value = np.where(value > 0.0, value, np.nan)
        said = "\n".join(f"{one}: {text}" for one in ASKED if (text := _evidence(one, name)))
        for end in ("low", "high"):
            factors = np.array([*(_factor(one, name, end) for one in ASKED), math.nan])  # the last of family -1
            about = {"units": ds[name].attrs["units"], "evidence": said}
            about["long_name"] = f"{end} end of the {100 * COVERED:g} % interval of measured values: {name}"
            found = np.minimum(value * factors[family].reshape(status.shape), LARGEST.get(name, math.inf))
            data[f"{name}_{end}"] = (status.dims, found, about)
    coordinates = {name: ds[name] for name in ds.coords if set(ds[name].dims) <= set(status.dims)}
    return xr.Dataset(data, coords=coordinates)


def _factor(family: str, name: str, end: str) -> float:
    """An end of the interval over the value."""
    found = residuals_of(family, name)
    return math.nan if found is None else math.exp(getattr(found, end))


def _evidence(family: str, name: str) -> str:
    """The measurements of a family, or why it has no interval."""
    found = residuals_of(family, name)
    if found is None:
        return missing(family, name)
    beyond = f"; extrapolated beyond {found.most:.0f} yield velocities" if found.most > 0.0 else ""
    return evidence(family, found) + beyond
