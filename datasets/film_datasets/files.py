"""Datasets in files: written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import xarray as xr

from film_datasets.quantities import in_numbers
from film_datasets.schema import HISTORY, kind_of, variables_of
from film_model.files import written_whole

SUFFIX, ZARR = ".nc", ".zarr"

STORES = ("zarr.json", ".zgroup")
"""Files by which a folder is a Zarr store, of format 3 and 2."""

MOST_INDEXED = 10_000_000
"""Values of a coordinate that `open_dataset` indexes, so that `sel` takes them."""

DEFLATE_FROM = 4096
"""Bytes of a variable from which it is deflated: below, the chunk index (2 kB) takes more than deflating saves."""


def write(ds: xr.Dataset, path: str | os.PathLike[str], overwrite: bool = False) -> Path:
    """Write `ds` to the netCDF-4 file `path` and return the path.

    The file is written beside its place, flushed to the disk and renamed, so that `path` never holds half a file; the
    same dataset gives the same bytes. Long variables are shuffled and deflated at level 1. Of a dataset with quantities
    (`ds.film.quantify()`), the SI numbers are written.

    Raises ValueError for a suffix other than .nc; FileExistsError if the file is there and `overwrite` is not set;
    IsADirectoryError, FileNotFoundError, PermissionError or OSError where the file cannot be written.
    """
    if not isinstance(ds, xr.Dataset):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"a dataset is written, not a {type(ds).__name__}: to_dataset makes one of a history")
    target = Path(path)
    check_file(target, overwrite)
    ds = in_numbers(ds)
    try:
        with written_whole(target) as beside:
            ds.to_netcdf(beside, mode="w", format="NETCDF4", engine="netcdf4", encoding=_encoding(ds))
    except RuntimeError as error:  # what the netCDF library makes of a full disk
        raise OSError(f"{target}: cannot be written (is the disk full?): {error}") from error
    return target


def read(path: str | os.PathLike[str]) -> xr.Dataset:
    """The dataset in a file, in memory, the file closed. Raises what `open_dataset` raises."""
    with open_dataset(path) as ds:
        return ds.load()


def open_dataset(path: str | os.PathLike[str]) -> xr.Dataset:
    """The dataset in a netCDF file or Zarr folder of ours; it has the accessor `film`.

    A history is read into memory; of a sweep, what is asked for is read when it is needed. A coordinate of more than
    `MOST_INDEXED` values has no index.

    Raises OSError where there is no such file or it cannot be read, ValueError for a dataset that is not ours.
    """
    source = Path(path)
    if not source.exists():
        raise FileNotFoundError(f"{source}: there is no such file")
    engine = "zarr" if source.is_dir() else "netcdf4"
    try:
        ds = _indexed(xr.open_dataset(source, engine=engine, create_default_indexes=False))
    except ImportError as error:
        raise ImportError(f"{source}: {NEEDS_ZARR}") from error
    except PermissionError as error:
        raise PermissionError(f"{source}: cannot be read: {error.strerror}") from error
    except Exception as error:  # each library has its own for a file it does not know
        kind = "a Zarr folder" if engine == "zarr" else "a netCDF file"
        raise OSError(f"{source}: is not {kind}, or is damaged ({error})") from error
    try:
        if kind_of(ds) == HISTORY:
            ds.load()
            ds.close()
    except ValueError as error:
        ds.close()
        raise ValueError(f"{source}: {error}") from None
    except Exception as error:
        ds.close()
        raise OSError(f"{source}: is damaged ({error})") from error
    return ds


NEEDS_ZARR = 'Zarr folders need zarr: install film-model[zarr] (pip install "film-model[zarr]")'


def _indexed(ds: xr.Dataset) -> xr.Dataset:
    """With an index, which is held in memory, for every coordinate that is not too long for it."""
    along = [str(name) for name, array in ds.coords.items() if array.dims == (name,) and array.size <= MOST_INDEXED]
    for name in along:
        ds = ds.set_xindex(name)
    return ds


def check_file(target: Path, overwrite: bool) -> None:
    """As :func:`check_place`, of a netCDF file."""
    if target.suffix != SUFFIX:
        raise ValueError(f'{target}: the name of a netCDF file must end in "{SUFFIX}"')
    check_place(target, overwrite)


def check_place(target: Path, overwrite: bool) -> None:
    """Say before the work what would make it useless after."""
    folder = target.absolute().parent
    if target.is_dir() and target.suffix != ZARR:
        raise IsADirectoryError(f"{target}: is a folder, the name of a file is needed")
    if target.is_dir() and not any((target / name).is_file() for name in STORES):
        raise IsADirectoryError(f"{target}: is a folder but no Zarr store, and is not replaced")
    if not folder.is_dir():
        raise FileNotFoundError(f"{target}: there is no folder {folder}")
    if not overwrite and target.exists():
        raise FileExistsError(f"{target}: exists; say overwrite=True to replace it")


def _encoding(ds: xr.Dataset) -> dict[str, Any]:
    """Per variable: deflate what is long, and set a fill value only where values can be missing."""
    missing = {variable.name for variable in variables_of(ds) if variable.optional}
    deflate = {"zlib": True, "complevel": 1, "shuffle": True}
    return {
        str(name): {
            **(deflate if array.dims and array.nbytes >= DEFLATE_FROM else {}),
            "_FillValue": float("nan") if name in missing else None,
        }
        for name, array in ds.variables.items()
    }
