"""A design from the user's own table: a CSV or Parquet file, a pandas DataFrame or an xarray Dataset."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from film_datasets.csv_measurement import split_heading
from film_datasets.tables import NEEDS_PARQUET
from film_model.base.errors import Mistake, SceneError, raise_all, shown
from film_model.base.foreign import DataFrame, Dataset
from film_model.scene.toml import LARGEST_TABLE, read_text

SUFFIXES = (".csv", ".parquet")


def is_table(given: object) -> TypeGuard[DataFrame | Dataset]:
    """Whether this is a DataFrame or a Dataset."""
    import xarray as xr

    return isinstance(given, xr.Dataset) or type(given).__name__ == "DataFrame"


def over_of_file(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The lists side by side of a CSV or Parquet file. Raises SceneError with all mistakes, or an OSError."""
    return over_of_table(_read(Path(path)), str(path))


def over_of_table(table: DataFrame | Dataset, name: str = "table") -> dict[str, Any]:
    """The lists side by side of a table whose columns are scene keys: path → values as a scene file has them.

    A heading is `impactor.velocity [m/s]`; the variables of a Dataset have their unit in the attribute `units`. Cells
    are numbers in that unit, texts with units, or words.
    """
    import pandas as pd  # lazy: it takes 0.5 s
    import xarray as xr

    if isinstance(table, xr.Dataset):
        if len(table.dims) != 1:
            raise SceneError([Mistake(name, None, "", f"a Dataset with one dimension is needed, not {table.sizes}")])
        along = {key: v for key, v in table.coords.items() if "." in str(key) and v.ndim}  # not the numbers of rows
        arrays = {**table.data_vars, **along}
        table = pd.DataFrame({f"{key} [{v.attrs.get('units', '')}]": v.values for key, v in arrays.items()})
    mistakes: list[Mistake] = []
    over: dict[str, Any] = {}
    if not len(table):
        mistakes.append(Mistake(name, None, "", "no rows: a table with at least one impact is needed"))
    for place, heading in enumerate(map(str, table.columns)):
        path, unit = split_heading(heading)
        if path in ("", "nan") or path.startswith("Unnamed:"):
            what = f"column {place + 1} has no heading; if it is the index that pandas writes: to_csv(…, index=False)"
            mistakes.append(Mistake(name, None, "", what))
            continue
        column = table.iloc[:, place]
        if path in over:
            mistakes.append(Mistake(name, None, path, "is given by two columns"))
        empty = np.flatnonzero(column.isna().to_numpy())
        if empty.size:
            mistakes.append(Mistake(name, None, path, f"the cell in row {empty[0] + 1} is empty"))
        over[path] = [_cell(value, unit) for value in column.tolist()]
    raise_all(mistakes)
    return over


def _cell(value: Any, unit: str) -> Any:
    """A value as a scene file has it. A number alone takes the column's unit."""
    if isinstance(value, str):
        text = value.strip()
        try:
            float(text)
        except ValueError:
            return text
        return f"{text} {unit}" if unit else float(text)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return f"{value!r} {unit}" if unit else float(value)


def _read(path: Path) -> DataFrame:
    import pandas as pd  # lazy: it takes 0.5 s

    if path.suffix == ".parquet":
        try:
            return pd.read_parquet(path)
        except ImportError as error:
            raise ImportError(f"{path}: {NEEDS_PARQUET}") from error
    if path.suffix != ".csv":
        words = " or ".join(SUFFIXES)
        raise SceneError([Mistake(None, None, "design.file", f"{shown(path.name)}: its name must end in {words}")])
    text, name = read_text(path, LARGEST_TABLE)
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) < 2:
        raise SceneError([Mistake(name, None, "", "a heading and at least one row are needed")])
    separator = max(",;\t", key=lines[0].count)
    try:
        table = pd.read_csv(
            io.StringIO("\n".join(lines)), sep=separator, header=None, dtype=str, keep_default_na=False, na_values=[""]
        )
    except (pd.errors.ParserError, ValueError) as error:
        raise SceneError([Mistake(name, None, "", f"is not a table: {error}")]) from None
    return pd.DataFrame(table.to_numpy()[1:], columns=[str(heading) for heading in table.iloc[0].tolist()])
