"""`ds.film`: what can be done with a dataset of ours, from the dataset alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_datasets.history import history_of, lines_of, scene_of
from film_datasets.quantities import quantified
from film_datasets.report import statistics
from film_datasets.schema import HISTORY, SWEEP, TABLE, dimension_of, kind_of
from film_datasets.sweeps import Sweep
from film_model import units
from film_model.core import native
from film_model.history import MOTION, SUMMARY, History
from film_model.problem import motion_of, problem_of
from film_model.scales import Scales
from film_model.scene import Scene
from film_model.solve import simulate
from film_model.units import to_si


@xr.register_dataset_accessor("film")
class Film:
    """Histories are sampled, drawn and run again from their file; so is each impact of a sweep.

    Where a method takes `where`, it picks one impact of a sweep, or of a selection of one: `impact=5`, or the swept
    quantities by their names in the dataset, each the nearest value or a word:
    `impactor_velocity="0.5 m/s", contact_law="stronge"`; a number alone is SI.
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

    @property
    def kind(self) -> str:
        """The attribute film_model_schema: "impact_history", … Raises ValueError for a dataset that is not ours."""
        return kind_of(self._ds)

    def scene(self, **where: Any) -> Scene:
        """The scene, ready to run again: of a history, of one impact of a sweep, or that on which a sweep is based.

        The impact of a sweep is picked by `where`, or before: `ds.isel(impact=5).film.scene()`.

        Raises ValueError where the law was an object of Python or an FMU was run with other values, KeyError for an
        impact that is not there.
        """
        if self.kind == HISTORY:
            _nothing(where)
        if "start_values" in self._ds.attrs:
            given = ", ".join(str(self._ds.attrs["start_values"]).split("\n"))
            raise ValueError(f"this run of an FMU was given {given}, which is not in the scene that was exported")
        return self._picked(where) if where or self._is_one else scene_of(self._ds)

    def _picked(self, where: Mapping[str, Any]) -> Scene:
        """The scene of one impact of a sweep."""
        row = self._ds.isel(self._places(where))
        changes: dict[str, Any] = {}
        for axis in Sweep.of_dataset(self._ds).axes:
            value = row[axis.name].item()
            number = f"{value!r} {axis.unit}" if axis.unit else value
            changes[axis.path] = axis.words[value] if axis.kind == "words" else number
        return scene_of(self._ds).replace(changes)

    def history(self, **where: Any) -> History:
        """The history: from the segments in the file, or the impact of a sweep simulated anew."""
        if self.kind == HISTORY:
            _nothing(where)
            return history_of(self._ds)
        return simulate(self._picked(where))

    def sample(self, times: Any, **where: Any) -> xr.Dataset:
        """Motion at any times, from the segments in the file: a dataset over t, SI.

        times: ["10 us", "20 us"], a pint quantity, or plain seconds; not before first touch. Of a sweep, `where`
        picks the impact, and segments must have been kept.
        """
        t = np.atleast_1d(units.array_to_si(times, "time", bare=True))
        if t.ndim > 1:
            raise ValueError(f"times must be one list, not of shape {t.shape}")
        if self.kind == HISTORY:
            samples = self.history(**where).sample_si(t)
            motion = {name: getattr(samples, name) for name in MOTION}
        else:
            motion = self._sample_row(t, where)
        table = {variable.name: variable.attributes() for variable in TABLE[HISTORY]}
        data = {name: ("t", values, table[name]) for name, values in motion.items()}
        return xr.Dataset(data, coords={"t": ("t", t, table["t"])})

    def summary(self, **where: Any) -> dict[str, Any]:
        """Summary values, SI floats, None for what did not happen; of a whole sweep, their statistics.

        Statistics are count, least, mean, standard_deviation and greatest of the impacts that have a value.
        """
        names = [name for name in SUMMARY if name in self._ds]
        if self.kind == SWEEP and not (where or self._is_one):
            return {name: statistics(self._ds[name]) for name in names}
        if self.kind == HISTORY:
            _nothing(where)
        row = self._ds if self.kind == HISTORY else self._ds.isel(self._places(where))
        return {name: None if np.isnan(row[name]) else float(row[name]) for name in names}

    def plot(self, path: str | os.PathLike[str] | None = None, **options: Any) -> Any:
        """A matplotlib figure, written to `path` (.png, .svg, .pdf) if given; see `film_datasets.plot`."""
        from film_datasets.pictures import plot

        return plot(self._ds, path, **options)

    def quantify(self) -> xr.Dataset:
        """The dataset with pint quantities for values; by pint-xarray, coordinates too, if it is installed.

        `film_datasets.write` takes it, and writes SI numbers.
        """
        return quantified(self._ds)

    @property
    def _is_one(self) -> bool:
        """Whether this is one impact of a sweep, all that was swept a scalar."""
        return self.kind == SWEEP and not self._ds["status"].dims

    def _places(self, where: Mapping[str, Any]) -> dict[str, int]:
        """The place of one impact of a sweep along each dimension."""
        if self.kind != SWEEP:
            raise ValueError(f"a dataset of kind {self.kind} has no impacts to pick")
        sizes = {str(dim): self._ds["status"].sizes[dim] for dim in self._ds["status"].dims}
        wrong = [f"{name} is none of them" for name in where if name not in sizes]
        wrong += [f"{dim} is missing" for dim, size in sizes.items() if dim not in where and size > 1]
        if wrong:
            raise KeyError(f"an impact is picked by {', '.join(sizes)}: {', '.join(wrong)}")
        return {dim: self._place(dim, size, where.get(dim)) for dim, size in sizes.items()}

    def _place(self, dim: str, size: int, value: Any) -> int:
        if value is None:
            return 0
        if dim == "impact":
            if not isinstance(value, int | np.integer) or not 0 <= value < size:
                raise KeyError(f"impact {value}: they are 0 to {size - 1}")
            return int(value)
        array = self._ds[dim]
        words = str(array.attrs.get("flag_meanings", "")).split()
        if not words:
            return int(np.abs(array.values - to_si(value, dimension_of(array), bare=True)).argmin())
        here = [words[number] for number in array.values.tolist()]  # which may be a selection
        if str(value) not in here:
            raise KeyError(f"{dim} {value}: there are {', '.join(here)}")
        return here.index(str(value))

    def _sample_row(self, t: NDArray[np.float64], where: Mapping[str, Any]) -> dict[str, Any]:
        """Motion of one impact of a sweep, from its segments."""
        if self.kind != SWEEP:
            raise ValueError(f"a dataset of kind {self.kind} has no impacts to sample")
        if "segment_count" not in self._ds.variables:
            raise ValueError('no segments were kept of this sweep (keep="segments"): use ds.film.history(…).sample')
        if t.min(initial=0.0) < 0.0:
            raise ValueError("times must not be before first touch (0 s)")
        row = self._ds.isel(self._places(where))
        begin, count = int(row["segment_begin"]), int(row["segment_count"])
        if not count:
            raise ValueError("this impact failed: it has no segments")
        lines = lines_of(self._ds.isel(segment=slice(begin, begin + count)))
        if lines.size != count or lines["time"][0] != 0.0:
            raise ValueError("the segments of this impact are not there: the dimension segment must be whole")
        scales = Scales(*(float(row[f"scale_{scale.name}"]) for scale in fields(Scales)))
        share, order = float(row["impactor_share"]), np.argsort(t, kind="stable")
        curve = problem_of(self._picked(where)).curve.native
        values, back = native.sample(curve, lines, t[order] / scales.time)[0], np.argsort(order, kind="stable")
        return motion_of(scales, float(row["drift_velocity"]), share, share < 1.0, t, values[back])


def _nothing(where: Mapping[str, Any]) -> None:
    if where:
        raise KeyError(f"a history has no impacts to pick: {', '.join(where)}")
