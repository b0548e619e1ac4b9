"""Motion of all impacts of a sweep at once, at the same times."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from film_datasets.impacts import simulate_impacts
from film_datasets.provenance import scene_of
from film_datasets.schema import has_failed, require_impacts
from film_datasets.sweeps import Sweep
from film_model.base.arrays import Array, Index
from film_model.scene import Scene
from film_model.solve.history import MOTION

if TYPE_CHECKING:
    import xarray as xr

MOST_VALUES = 20_000_000
"""Impacts times times: five numbers for each are held in memory."""


def sample_all(ds: xr.Dataset, sweep: Sweep, times: Array) -> dict[str, Array]:
    """Motion at ascending times [s] of every impact of a sweep or of a selection: arrays over its dimensions and the
    times. The impacts are simulated again; NaN for those that failed.

    Raises ValueError for too many values.
    """
    require_impacts(ds)
    status = ds["status"]
    shape, count = (*status.shape, times.size), status.size
    if count * times.size > MOST_VALUES:
        raise ValueError(
            f"{count} impacts at {times.size} times: at most {MOST_VALUES} values fit; select fewer impacts"
        )
    motion = {name: np.full((count, times.size), np.nan) for name in MOTION}
    for rows, scene, numbers in parts_of(ds, sweep):
        impacts = simulate_impacts(scene, numbers)
        for name, column in impacts.motion(np.broadcast_to(times, (rows.size, times.size))).items():
            motion[name][rows] = column
    return {name: column.reshape(shape) for name, column in motion.items()}


def parts_of(ds: xr.Dataset, sweep: Sweep) -> Iterator[tuple[Index, Scene, dict[str, Array]]]:
    """The impacts of a sweep or of a selection that did not fail, by their words: places, scene and numbers by path."""
    status = ds["status"]
    swept = {axis.path: np.ravel(ds[axis.name].broadcast_like(status).transpose(*status.dims)) for axis in sweep.axes}
    choices = {axis.path: axis for axis in sweep.axes if axis.kind == "choices"}
    ran = ~has_failed(np.ravel(status.values))
    for rows in _alike([swept[path] for path in choices], ran):
        scene = scene_of(ds).replace({path: axis.choice_at(swept[path][rows[0]]) for path, axis in choices.items()})
        numbers = {path: np.asarray(column[rows], float) for path, column in swept.items() if path not in choices}
        yield rows, scene, numbers or {"impactor.velocity": np.full(rows.size, scene.impactor.speed)}


def _alike(columns: list[Array], ran: Any) -> list[Any]:
    """The places of the impacts that ran, by their words."""
    places = np.flatnonzero(ran)
    if not columns or not places.size:
        return [places] if places.size else []
    words = np.stack([column[places].astype(str) for column in columns], axis=1)
    _, kinds = np.unique(words, axis=0, return_inverse=True)
    return [places[np.ravel(kinds) == kind] for kind in range(int(kinds.max()) + 1)]
