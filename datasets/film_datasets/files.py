"""Datasets in netCDF files: written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import xarray as xr

from film_datasets.schema import VARIABLES
from film_model.files import written_whole

SUFFIX = ".nc"

DEFLATE_FROM = 4096
"""Bytes of a variable from which it is deflated: below, the chunk index (2 kB) takes more than deflating saves."""


def write(ds: xr.Dataset, path: str | os.PathLike[str], overwrite: bool = False) -> Path:
    """Write `ds` to the netCDF-4 file `path` and return the path.

    The file is written beside its place, flushed to the disk and renamed, so that `path` never holds half a file; the
    same dataset gives the same bytes. Long variables are shuffled and deflated at level 1.

    Raises ValueError for a suffix other than .nc; FileExistsError if the file is there and `overwrite` is not set;
    IsADirectoryError, FileNotFoundError, PermissionError or OSError where the file cannot be written.
    """
    target = Path(path)
    _check(target, overwrite)
    try:
        with written_whole(target) as beside:
            ds.to_netcdf(beside, mode="w", format="NETCDF4", engine="netcdf4", encoding=_encoding(ds))
    except RuntimeError as error:  # what the netCDF library makes of a full disk
        raise OSError(f"{target}: cannot be written (is the disk full?): {error}") from error
    return target


def read(path: str | os.PathLike[str]) -> xr.Dataset:
    """The dataset in a netCDF file, in memory, the file closed. Raises OSError where it cannot be read."""
    return xr.load_dataset(Path(path), engine="netcdf4")


def _check(target: Path, overwrite: bool) -> None:
    if target.suffix != SUFFIX:
        raise ValueError(f'{target}: the name of a netCDF file must end in "{SUFFIX}"')
    if target.is_dir():
        raise IsADirectoryError(f"{target}: is a folder, the name of a file is needed")
    if not target.absolute().parent.is_dir():
        raise FileNotFoundError(f"{target}: there is no folder {target.absolute().parent}")
    if not overwrite and target.exists():
        raise FileExistsError(f"{target}: exists; say overwrite=True to replace it")


def _encoding(ds: xr.Dataset) -> dict[str, Any]:
    """Per variable: deflate what is long, and set a fill value only where values can be missing."""
    missing = {variable.name for variable in VARIABLES if variable.optional}
    deflate = {"zlib": True, "complevel": 1, "shuffle": True}
    return {
        str(name): {
            **(deflate if array.dims and array.nbytes >= DEFLATE_FROM else {}),
            "_FillValue": float("nan") if name in missing else None,
        }
        for name, array in ds.variables.items()
    }
