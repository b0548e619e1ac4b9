"""The computation of a block: its impacts simulated, as columns of the schema's variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.friction_dataset import REGIME
from film_datasets.impacts import ClosedForms, Impacts, simulate_impacts
from film_datasets.schema import OUT_OF_RANGE, accuracy_name, derivative_name, peak_name, side_name
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import GRID, Block
from film_datasets.sweeps.ragged import Columns, ragged_columns, ragged_dims
from film_model.base.arrays import Index, index_or_all
from film_model.base.errors import NO_VELOCITY
from film_model.problem.summary import SUMMARY
from film_model.solve.history import MOTION
from film_model.solve.slopes import NO_DERIVATIVE
from film_model.targets.sensors import sensor_words

ESTIMATED, MISSED, ENERGY_GAINS, FASTER = TOTALS = ("estimated", "missed", "energy_gains", "faster")
"""Columns besides the variables: the largest estimated error for each of `Sweep.accuracies`, the number of impacts that
miss each, the number of impacts of each of `Sweep.laws` whose unloading returns more energy than their loading
stored, and the number of those that leave faster than they come because of their weight."""


def compute_block(sweep: Sweep, block: Block) -> Columns:
    """The columns of a block by the names of variables, impacts in C order; and `TOTALS`."""
    return compute_impacts(sweep, sweep.values(block.first, block.count))


def compute_impacts(sweep: Sweep, values: Sequence[NDArray[Any]]) -> Columns:
    """The same of impacts that have these values along the axes, as of `Sweep.values`."""
    count = len(values[0])
    columns = _empty_columns(sweep, count)
    if sweep.design != GRID:
        columns |= {axis.name: value for axis, value in zip(sweep.axes, values, strict=True)}
    in_range = np.ones(count, np.bool_)
    for place, (axis, value) in enumerate(zip(sweep.axes, values, strict=True)):
        if axis.kind != "choices":
            outside = axis.outside(value) & in_range
            columns["status"][outside] = OUT_OF_RANGE + place
            in_range &= ~outside
    forms: list[tuple[Index, ClosedForms]] = []
    for scene, index, numbers in sweep.parts(values, in_range):
        impacts = simulate_impacts(scene, numbers)
        _put(sweep, columns, forms, impacts, index)
        if sweep.derivatives:
            _differentiate(sweep, columns, impacts, numbers, index)
        for name, peaks in impacts.sensor_peaks().items():
            word = sensor_words(sweep.sensors)[sweep.sensors.index(name)]
            for what, largest in peaks.items():
                columns[peak_name(what, word)][index] = largest
    if sweep.keep == "segments":
        columns |= ragged_columns(forms, count, ragged_dims(sweep.variables))
    return columns


def _empty_columns(sweep: Sweep, count: int) -> Columns:
    columns: Columns = {
        ESTIMATED: np.zeros(len(sweep.accuracies)),
        MISSED: np.zeros(len(sweep.accuracies), np.int64),
        ENERGY_GAINS: np.zeros(len(sweep.laws), np.int64),
        FASTER: np.zeros(1, np.int64),
    }
    for variable in sweep.variables[len(sweep.axes) :]:
        if variable.dims[: len(sweep.dims)] == sweep.dims:
            shape = (count, sweep.dense) if "normalised_time" in variable.dims else (count,)
            fill = np.array(np.nan if variable.optional else 0, variable.dtype)
            # most blocks replace their summaries as a whole: see `_put`
            columns[variable.name] = np.broadcast_to(fill, shape) if variable.name in SUMMARY else np.full(shape, fill)
    columns["status"][:] = NO_VELOCITY
    columns["law"][:] = -1
    columns["scene_key"][:] = sweep.scene_key
    if REGIME in columns:
        columns[REGIME][:] = -1
    for entry in sweep.derivatives:
        columns[side_name(entry.path)][:] = NO_DERIVATIVE
    return columns


def _put(
    sweep: Sweep, columns: Columns, forms: list[tuple[Index, ClosedForms]], impacts: Impacts, index: Index
) -> None:
    """Put simulated impacts into the columns at the places `index`; add their motions, and their places to `forms`."""
    at = index_or_all(index, columns["status"].size)
    found = {
        **impacts.summary,
        **impacts.friction,
        "status": impacts.status,
        "zener_number": impacts.zener_number,
        "estimated_accuracy": impacts.estimated,
    }
    for name in found.keys() & columns.keys():
        if isinstance(at, slice):
            columns[name] = found[name].astype(columns[name].dtype, copy=False)
            continue
        if not columns[name].flags.writeable:
            columns[name] = columns[name].copy()
        columns[name][at] = found[name]
    wanted = impacts.scene.solver.accuracy
    accuracy = sweep.accuracies.index(wanted)
    worst = float(np.nanmax(impacts.estimated, initial=columns[ESTIMATED][accuracy]))
    columns[ESTIMATED][accuracy] = worst
    if wanted is not None and worst > wanted:
        columns[MISSED][accuracy] += np.count_nonzero(impacts.estimated > wanted)
    columns[FASTER] += np.count_nonzero(impacts.faster)
    for number, law in enumerate(impacts.laws):
        own, place = impacts.law == number, sweep.laws.index(law)
        columns["law"][index[own]] = place
        columns[ENERGY_GAINS][place] += np.count_nonzero(impacts.gains_energy[own])
    if sweep.keep == "segments":
        for form in impacts.closed_forms():
            places = index[form.index]
            forms.append((places, form))
            for name, value in form.units.items():
                columns[name][places] = value
    elif sweep.keep == "samples":
        impacts.samples(sweep.dense, {name: columns[f"sampled_{name}"] for name in MOTION}, index)


def _differentiate(
    sweep: Sweep, columns: Columns, impacts: Impacts, numbers: Mapping[str, NDArray[Any]], index: Index
) -> None:
    """Put the derivatives of simulated impacts into the columns; none by a number that their scene does not have."""
    known, found = impacts.derivatives(numbers, sweep.derivatives)
    for k, entry in enumerate(known):
        for name, values in found.values.items():
            if (own := derivative_name(name, entry.path)) in columns:
                columns[own][index] = values[:, k]
        columns[accuracy_name(entry.path)][index] = found.error[:, k]
        columns[side_name(entry.path)][index] = found.side[:, k]
