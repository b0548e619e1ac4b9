"""Motion of all impacts of a sweep at once, at the same times."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from film_datasets.impacts import simulate_impacts
from film_datasets.schema import has_failed, require_impacts
from film_datasets.sweeps import Sweep
from film_model.base.arrays import Array, Index
from film_model.base.foreign import Dataset
from film_model.scene import Scene
from film_model.solve.history import MOTION


def sample_all(ds: Dataset, sweep: Sweep, times: Array) -> dict[str, Array]:
    """Motion at ascending times [s] of every impact of a sweep or of a selection: arrays over its dimensions and the
    times. The impacts are simulated again; NaN for those that failed.

    Raises ValueError for too many values.
    """
    most_values = 20_000_000  # impacts times times: five numbers for each are held in memory
    require_impacts(ds)
    status = ds["status"]
    shape, count = (*status.shape, times.size), status.size
    if count * times.size > most_values:
        raise ValueError(
            f"{count} impacts at {times.size} times: at most {most_values} values fit; select fewer impacts"
        )
    motion = {name: np.full((count, times.size), np.nan) for name in MOTION}
    for scene, rows, numbers in parts_of(ds, sweep):
        impacts = simulate_impacts(scene, numbers)
        for name, column in impacts.motion(np.broadcast_to(times, (rows.size, times.size))).items():
            motion[name][rows] = column
    return {name: column.reshape(shape) for name, column in motion.items()}


def parts_of(ds: Dataset, sweep: Sweep) -> Iterator[tuple[Scene, Index, dict[str, Array]]]:
    """The impacts of a sweep or of a selection that did not fail, as of `Sweep.parts`."""
    status, values = ds["status"], list[Any]()
    for axis in sweep.axes:
        column = np.ravel(ds[axis.name].broadcast_like(status).transpose(*status.dims))
        if axis.kind == "choices":
            words, places = np.unique(column, return_inverse=True)
            numbers = [axis.choices.index(axis.choice_at(word)) for word in words.tolist()]
            column = np.array(numbers, np.intp)[places]
        values.append(column)
    return sweep.parts(values, ~has_failed(np.ravel(status.values)))
