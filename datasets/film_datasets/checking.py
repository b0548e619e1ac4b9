"""check: whether a file is whole, matches the schema and holds what the simulation gives."""

from __future__ import annotations

import os

import numpy as np

from film_datasets.files import open_dataset
from film_datasets.schema import BOUNCES, CHAIN, COST, HISTORY, MEASUREMENT, has_failed, kind_of, validate
from film_model.base.foreign import Dataset
from film_model.solve.history import SUMMARY
from film_model.solve.simulate import simulate_quietly


def check(path: str | os.PathLike[str], rows: int = 10) -> list[str]:
    """What is wrong with a dataset in a file, one sentence each: with its hashes, the schema, or the results of `rows`
    impacts, evenly spread over a sweep, which are simulated again. An empty list if nothing is.

    Results may differ by the estimated errors of both. Impacts whose law was an object of Python, and runs of an FMU
    with other start values, are not simulated again. Raises what `film_datasets.open` raises.

    >>> fd.check(fd.write(fd.to_dataset(fm.simulate(scene)), "impact.nc"))
    []
    """
    if rows < 0:
        raise ValueError(f"rows is {rows}, which must be >= 0")
    with open_dataset(path) as ds:
        wrong = validate(ds)
        if wrong or kind_of(ds) in (MEASUREMENT, BOUNCES, CHAIN, COST):
            return wrong
        if kind_of(ds) == HISTORY:
            return _differences(ds, "") if rows else []
        shape = ds["status"].shape
        places = np.unique(np.linspace(0, ds["status"].size - 1, min(rows, ds["status"].size)).astype(int))
        found: list[str] = []
        for place in places:
            where = dict(zip(map(str, ds["status"].dims), map(int, np.unravel_index(place, shape)), strict=True))
            row = ds.isel(where)
            if not has_failed(np.asarray(row["status"])).any():
                found += _differences(row, f"impact {place}: ")
        return found


def _differences(ds: Dataset, place: str) -> list[str]:
    """Values of one impact that a new simulation of its scene does not give."""
    try:
        scene = ds.film.scene()
    except ValueError:
        return []
    history = simulate_quietly(scene)
    estimate = float(ds["estimated_accuracy"]) if "estimated_accuracy" in ds else float(ds.attrs["estimated_accuracy"])
    # equal results of two machines differ by rounding, beside the estimated errors
    allowed = 1e-9 + estimate + history.accuracy.estimated
    least = {
        "velocity": 1e-3 * scene.approach_velocity,
        "length": 1e-3 * (history.summary["maximum_indentation"] or 0.0),
        "energy": 0.5 * scene.effective_mass * scene.approach_velocity**2,
    }
    found: list[str] = []
    for name, (dimension, _) in SUMMARY.items():
        value, again = float(ds[name]) if name in ds else None, history.summary[name]
        if value is None or again is None:
            continue
        if not abs(value - again) <= allowed * max(abs(again), least.get(dimension, 0.0)):
            found.append(f"{place}{name} is {value:.9g}, and {again:.9g} if it is simulated again")
    return found
