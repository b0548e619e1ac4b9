"""Datasets as tables: a row for each impact or time, in CSV, Parquet and MATLAB files, and as pandas DataFrames."""

from __future__ import annotations

import importlib
import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from film_datasets.schema import (
    COST,
    HISTORY,
    SWEEP,
    TABLE,
    TEXT,
    Variable,
    dimension_of_unit,
    flag_meanings,
    has,
    kind_of,
    require,
    variables_of,
)
from film_model.base.foreign import DataFrame, Dataset
from film_model.base.units import scene_unit
from film_model.solve.history import SUMMARY
from film_model.targets.sensors import sensor_words

TABLES = (".csv", ".parquet", ".mat")
"""Suffixes of the files that hold a table."""

NEEDS_PARQUET = 'Parquet files need pyarrow: install film-model[parquet] (pip install "film-model[parquet]")'

NO_COLUMNS = frozenset(v.name for v in TABLE[f"{SWEEP} segments"]) | {"scene_key"}


def to_frame(ds: Dataset) -> DataFrame:
    """The values of a dataset as a table with units in the headings: `contact_force [N]`, SI; flags as words.

    A row is an impact of a sweep, a time of a history, a measured value or a run of a cost study. Of a sweep the
    constants are columns too; segments and histories of its impacts are left out.

    >>> list(fd.to_frame(fd.from_csv("measured.csv")))
    ['impactor_velocity [m/s]', 'coefficient_of_restitution']
    """
    import pandas as pd  # lazy: it takes 0.5 s

    return pd.DataFrame({_heading(v): values for v, values in _columns(ds)})


def write_table(ds: Dataset, target: Path, beside: Path) -> None:
    """Write a dataset to the file `beside`, in the format that the suffix of `target` says."""
    if target.suffix == ".csv":
        to_frame(ds).to_csv(beside, index=False, lineterminator="\n", encoding="utf-8")
    elif target.suffix == ".mat":
        beside.write_bytes(_mat(ds))
    else:
        check_parquet(target)
        to_frame(ds).to_parquet(beside, index=False, engine="pyarrow")


def check_parquet(target: Path) -> None:
    """Raise ImportError if a Parquet file is asked for and pyarrow is not installed."""
    if target.suffix == ".parquet":
        try:
            importlib.import_module("pyarrow")  # an optional dependency
        except ImportError as error:
            raise ImportError(f"{target}: {NEEDS_PARQUET}") from error


def left_out(ds: Dataset) -> list[str]:
    """What a table of the dataset does not hold, in words."""
    kept = str(ds.attrs.get("kept", "")).split()
    if kind_of(ds) == HISTORY:
        return ["segments", *(["friction"] if has(ds, "friction") else [])]
    return [what for what in ("segments", "samples") if what in kept]


def _columns(ds: Dataset) -> list[tuple[Variable, Any]]:
    """Variables and values of the columns, one value per row."""
    kind = kind_of(ds)
    variables = [v for v in variables_of(ds) if v.name not in NO_COLUMNS]
    require(ds, (v.name for v in variables if v.name not in SUMMARY))
    along = {HISTORY: "t", SWEEP: "status", COST: "method"}.get(kind, variables[0].name)
    rows = ds[along].dims
    sizes = {str(dim): ds.sizes[dim] for dim in rows}
    found: list[tuple[Variable, Any]] = []
    for v in variables:
        if v.name not in ds.variables:
            continue
        array = ds[v.name]
        if array.dims == ("sensor", *rows):  # a column for each sensor
            words = sensor_words(ds["sensor"].values.tolist())
            what = v.name.removeprefix("sensor_")
            found += [
                (replace(v, name=f"sensor_{word}_{what}"), own) for word, own in zip(words, array.values, strict=True)
            ]
        if array.dims in (("body", *rows), ("contact", *rows)):  # likewise for each body or contact of a chain
            found += [(replace(v, name=f"{v.name}_{number}"), own) for number, own in enumerate(array.values, 1)]
        if not set(array.dims) <= set(rows) or (not array.dims and kind != SWEEP):
            continue
        words = flag_meanings(array)
        if words:
            numbers = np.atleast_1d(array.attrs["flag_values"])
            array = array.copy(data=np.array(words, object)[np.searchsorted(numbers, array.values)])
        found.append((v, array.broadcast_like(ds[along]).transpose(*sizes).values.ravel()))
    return found


def _heading(variable: Variable) -> str:
    """The name of a column with its unit as scene files write it."""
    if variable.unit in (None, "1"):
        return variable.name
    return f"{variable.name} [{scene_unit(dimension_of_unit(variable.unit)) or variable.unit}]"


def _mat(ds: Dataset) -> bytes:
    """The content of a MATLAB 5 file: a vector for each column, texts as cells, and the struct `units`."""
    mat_header = 116  # bytes of text at the beginning of a MATLAB file, in which SciPy writes the time
    from scipy.io import savemat  # lazy: it takes 0.2 s

    columns = _columns(ds)
    content: dict[str, Any] = {
        v.name: values.astype(object) if v.dtype == TEXT or values.dtype == object else values for v, values in columns
    }
    content["units"] = {v.name: v.unit or "" for v, _ in columns}
    content |= {name: ds.attrs[name] for name in ("title", "scene_toml", "film_model_version") if name in ds.attrs}
    file = io.BytesIO()
    savemat(file, content, oned_as="column", long_field_names=True, do_compression=True)
    text = f"MATLAB 5.0 MAT-file, film-model {ds.attrs.get('film_model_version', '')}"
    return text.ljust(mat_header).encode() + file.getvalue()[mat_header:]
