"""The accessor `ds.film`: what a dataset of film-model offers, from the dataset alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from film_datasets.dataset_plots import plot
from film_datasets.history_dataset import history_of, tables_of
from film_datasets.impacts import SEGMENT_UNITS, sample_closed_form
from film_datasets.provenance import scene_of
from film_datasets.quantities import quantified
from film_datasets.sampling import sample_all
from film_datasets.scene_constants import check_scene_key, scene_key
from film_datasets.schema import (
    HISTORY,
    SWEEP,
    TABLE,
    dimension_of,
    has_failed,
    kind_of,
    require,
    require_impacts,
    words_of,
)
from film_datasets.sweeps import Sweep, statistics
from film_model.base import units
from film_model.base.arrays import Array
from film_model.base.errors import shown
from film_model.base.foreign import Dataset
from film_model.base.units import to_si
from film_model.core.native import EVENTS
from film_model.plot.history import energies
from film_model.scene import Scene
from film_model.scene.paths import number_text
from film_model.solve.closed_form import TABLES, ClosedForm
from film_model.solve.history import MOTION, SUMMARY, Event, History
from film_model.solve.simulate import simulate


class Film:
    """Histories, and each impact of a sweep, can be sampled, plotted and run again from their file.

    The argument `where` selects one impact of a sweep: `impact=5`, or the swept quantities by their names in the
    dataset, each with a value (the nearest is taken; a plain number is SI) or a name:
    `impactor_velocity="0.5 m/s", contact_law="stronge"`.
    """

    def __init__(self, ds: Dataset) -> None:
        self._ds = ds

    @property
    def kind(self) -> str:
        """The attribute film_model_schema: "impact_history", … Raises ValueError if film-model did not write it."""
        return kind_of(self._ds)

    def scene(self, **where: Any) -> Scene:
        """The scene, to run again: of a history, of one impact of a sweep, or the scene that a sweep varies.

        The impact of a sweep is selected by `where`, or before: `ds.isel(impact=5).film.scene()`.

        Raises ValueError if the law was an object of Python or an FMU was run with other values, KeyError for an
        impact that does not exist.
        """
        if self.kind == HISTORY:
            _refuse(where)
        if "start_values" in self._ds.attrs:
            given = ", ".join(str(self._ds.attrs["start_values"]).split("\n"))
            raise ValueError(f"this run of an FMU was given {given}, which is not in the scene that was exported")
        if where or self._is_one:
            return self._impact_scene(where)
        if self.kind == SWEEP:
            check_scene_key(self._ds, _key(self._ds, Sweep.of_dataset(self._ds)))
        return scene_of(self._ds)

    def _impact_scene(self, where: Mapping[str, Any]) -> Scene:
        """The scene of one impact of a sweep."""
        impact = self._ds.isel(self._indices(where))
        changes: dict[str, Any] = {}
        sweep = Sweep.of_dataset(self._ds)
        check_scene_key(impact, _key(self._ds, sweep))
        for axis in sweep.axes:
            value = impact[axis.name].item()
            if axis.kind == "choices":
                changes[axis.path] = axis.choice_at(value)
            else:
                changes[axis.path] = number_text(value, axis.unit)
        return scene_of(self._ds).replace(changes)

    def history(self, **where: Any) -> History:
        """The history: from the segments in the file; an impact of a sweep is simulated again."""
        if self.kind == HISTORY:
            _refuse(where)
            return history_of(self._ds)
        return simulate(self._impact_scene(where))

    def sample(self, times: Any, **where: Any) -> Dataset:
        """Motion at any times: a dataset over t, SI.

        times: ["10 us", "20 us"], a pint quantity, or plain seconds; not before first touch. Of a sweep, `where`
        selects an impact whose segments were kept. Without it, two impacts or more, all or a selection, are simulated
        again and sampled together: the dataset has their dimensions, too, and its variables are those of
        `keep="samples=…"`, such as `sampled_contact_force`.

        >>> ds = fd.sweep(scene, {"impactor.velocity": ["1 m/s", "2 m/s"]})
        >>> ds.film.sample(["5 us"])["sampled_contact_force"].shape
        (2, 1)
        """
        import xarray as xr

        t = _read_times(times)
        if self.kind == HISTORY:
            samples = self.history(**where).sample_si(t)
            motion = {name: getattr(samples, name) for name in MOTION}
        elif self.kind == SWEEP and not where and self._count > 1:
            return self._sample_all(t)
        else:
            motion = self._sample_impact(t, where)
        table = {variable.name: variable.attributes() for variable in TABLE[HISTORY]}
        data = {name: ("t", values, table[name]) for name, values in motion.items()}
        return xr.Dataset(data, coords={"t": ("t", t, table["t"])})

    def intervals(self) -> Dataset:
        """How far measured values lie from those of a sweep or of a selection of its impacts.

        `coefficient_of_restitution_low` and `…_high` are the ends of the 90 % interval, NaN where there is none;
        `family` (flags) is the kind of impacts that were measured, and the attribute `evidence` says of each how many.
        The effects of each impact are decided again, which takes about half as long as the sweep. No file holds the
        ends, which follow from the family and the value, and would take a quarter more bytes.

        >>> fd.sweep(scene, {"impactor.velocity": ["0.2 m/s", "2 m/s"]}).film.intervals()["family"].values.tolist()
        [1, 2]
        """
        from film_datasets.model_intervals import sweep_intervals

        if self.kind != SWEEP:
            raise ValueError(f"a dataset of kind {self.kind} is no sweep: a history has the attribute model_interval")
        sweep = Sweep.of_dataset(self._ds)
        check_scene_key(self._ds, _key(self._ds, sweep))
        return sweep_intervals(self._ds, sweep)

    def events(self, name: str | None = None, **where: Any) -> tuple[Event, ...]:
        """The events of a history or of one impact, in order; name: only those, e.g. "maximum_indentation".

        Raises ValueError for a name that no event has.

        >>> [event.time for event in fd.load("paper_stronge").film.events("contact_begins")]
        [0.0]
        """
        if name is not None and name not in EVENTS[1:]:
            raise ValueError(f"{shown(name)} is no event: there are {', '.join(EVENTS[1:])}")
        return tuple(event for event in self.history(**where).events if name in (None, event.name))

    def energies(self, times: Any, **where: Any) -> Dataset:
        """Energies of a history or of one impact at any times, J: `impactor`, of its motion; `contact`, the work that
        the contact force has done on the indentation; `target`, what has gone into the target.

        Works are integrated by the trapezoidal rule, over 4000 steps up to the last time and all events, to 1e-6 of the
        impact energy.
        """
        import xarray as xr

        t, history = _read_times(times), self.history(**where)
        marks = [event.time for event in history.events if event.time <= t.max(initial=0.0)]
        fine = np.unique(np.concatenate([np.linspace(0.0, t.max(initial=0.0), 4001), t, marks]))
        at = np.searchsorted(fine, t)
        meaning = {"impactor": "of the impactor's motion", "contact": "work done on the indentation"}
        data = {
            name: ("t", values[at], {"units": "J", "long_name": meaning.get(name, "gone into the target")})
            for name, values in energies(history, history.sample_si(fine)).items()
        }
        return xr.Dataset(data, coords={"t": ("t", t, {"units": "s", "long_name": "time since first touch"})})

    def summary(self, **where: Any) -> dict[str, Any]:
        """Summary values, SI floats, None for what did not happen; of a complete sweep, their statistics.

        Statistics are count, least, mean, standard_deviation and greatest over the impacts that have a value.
        """
        names = [name for name in SUMMARY if name in self._ds]
        if self.kind == SWEEP and not (where or self._is_one):
            return {name: statistics(self._ds[name]) for name in names}
        if self.kind == HISTORY:
            _refuse(where)
        impact = self._ds if self.kind == HISTORY else self._ds.isel(self._indices(where))
        return {name: None if np.isnan(impact[name]) else float(impact[name]) for name in names}

    def plot(self, path: str | os.PathLike[str] | None = None, **options: Any) -> Any:
        """A matplotlib figure, written to `path` (.png, .svg, .pdf) if given; see `film_datasets.plot`."""
        return plot(self._ds, path, **options)

    def quantify(self) -> Dataset:
        """The dataset with pint quantities as values; coordinates too if pint-xarray is installed.

        `film_datasets.write` accepts it and writes SI numbers.
        """
        return quantified(self._ds)

    @property
    def _count(self) -> int:
        """Number of impacts of a sweep."""
        require_impacts(self._ds)
        return self._ds["status"].size

    @property
    def _is_one(self) -> bool:
        """Whether this is one impact of a sweep: every swept quantity is a scalar."""
        if self.kind != SWEEP:
            return False
        require_impacts(self._ds)
        return not self._ds["status"].dims

    def _indices(self, where: Mapping[str, Any]) -> dict[str, int]:
        """The index of one impact of a sweep along each dimension."""
        if self.kind != SWEEP:
            raise ValueError(f"a dataset of kind {self.kind} has no impacts to select")
        require_impacts(self._ds)
        sizes = {str(dim): self._ds["status"].sizes[dim] for dim in self._ds["status"].dims}
        wrong = [f"{shown(name)} is not one of these" for name in where if name not in sizes]
        wrong += [f"{dim} is missing" for dim, size in sizes.items() if dim not in where and size > 1]
        if wrong:
            raise KeyError(f"an impact is selected by {', '.join(sizes)}: {', '.join(wrong)}")
        return {dim: self._index(dim, size, where.get(dim)) for dim, size in sizes.items()}

    def _index(self, dim: str, size: int, value: Any) -> int:
        if value is None:
            return 0
        if dim == "impact":
            if not isinstance(value, int | np.integer) or not 0 <= value < size:
                raise KeyError(f"impact {value}: must be from 0 to {size - 1}")
            return int(value)
        array = self._ds[dim]
        present = words_of(array)  # of a selection not all
        if not present:
            wanted, values = to_si(value, dimension_of(array), bare=True), array.values
            near, least, most = int(np.abs(values - wanted).argmin()), values.min(), values.max()
            beyond = max(least - wanted, wanted - most)
            # beyond 1 % of their range no value of the sweep is meant
            if beyond > 0.01 * (most - least if most > least else abs(most)):
                raise KeyError(f"{dim} {shown(value)}: the values are from {least:g} to {most:g} {array.units}")
            return near
        if str(value) not in present:
            raise KeyError(f"{dim} {shown(value)}: there are {', '.join(present)}")
        return present.index(str(value))

    def _sample_all(self, t: Array) -> Dataset:
        """Motion of all impacts, over their dimensions and t."""
        import xarray as xr

        sweep, status = Sweep.of_dataset(self._ds), self._ds["status"]
        check_scene_key(self._ds, _key(self._ds, sweep))
        order = np.argsort(t, kind="stable")
        motion = sample_all(self._ds, sweep, t[order])
        table = {variable.name: variable.attributes() for variable in TABLE[HISTORY]}
        dims, back = (*status.dims, "t"), np.argsort(order, kind="stable")
        data = {f"sampled_{name}": (dims, values[..., back], table[name]) for name, values in motion.items()}
        swept = {axis.name: self._ds[axis.name] for axis in sweep.axes}
        return xr.Dataset(data, coords={"t": ("t", t, table["t"]), **swept})

    def _sample_impact(self, t: Array, where: Mapping[str, Any]) -> dict[str, Any]:
        """Motion of one impact of a sweep, from its segments or steps."""
        if self.kind != SWEEP:
            raise ValueError(f"a dataset of kind {self.kind} has no impacts to sample")
        if "segment_count" not in self._ds.variables:
            raise ValueError('no segments were kept of this sweep (keep="segments"): use ds.film.history(…).sample')
        dims = [dim for dim in TABLES if f"{dim}_count" in self._ds.variables]
        require(self._ds, [*(f"{dim}_begin" for dim in dims), *SEGMENT_UNITS, "target_compliance"])
        impact = self._ds.isel(self._indices(where))
        counts = {dim: int(impact[f"{dim}_count"]) for dim in dims}
        if not any(counts.values()):
            if has_failed(impact["status"].values):
                raise ValueError("this impact failed: it has no segments")
            raise ValueError("the segments of this impact are not kept: use ds.film.history(…).sample")
        begins = {dim: int(impact[f"{dim}_begin"]) for dim in dims}
        rows = {dim: slice(begins[dim], begins[dim] + counts[dim]) for dim in dims}
        tables = tables_of(self._ds.isel(rows))
        first = tables["step" if counts.get("step") else "segment"]
        if any(tables[dim].size != counts[dim] for dim in dims) or first["time"][0] != 0.0:
            raise ValueError("segments of this impact are missing: the dimension segment must be complete")
        form = ClosedForm(tables, float(impact["target_compliance"]))
        units = {name: float(impact[name]) for name in SEGMENT_UNITS}
        return sample_closed_form(self._impact_scene(where), form, units, t)


def _read_times(times: Any) -> Array:
    """Times in a list, s. Raises ValueError for another shape, or a time before first touch."""
    t = np.atleast_1d(units.array_to_si(times, "time", bare=True))
    if t.ndim > 1:
        raise ValueError(f"times must be one list, not of shape {t.shape}")
    if not (t >= 0.0).all():
        raise ValueError("times must be finite and not before first touch (0 s)")
    return t


def _key(ds: Dataset, sweep: Sweep) -> int:
    """The scene key of the impacts that `sweep`, read from the dataset, describes."""
    return scene_key(str(ds.attrs["scene_toml"]), (axis.meaning for axis in sweep.axes))


def _refuse(where: Mapping[str, Any]) -> None:
    if where:
        raise KeyError(f"a history has no impacts to select: {', '.join(map(shown, where))}")
