"""Datasets in netCDF and Zarr files; a file is replaced by a complete one or not at all."""

from __future__ import annotations

import os
import shutil
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np

from film_datasets.csv_measurement import from_csv
from film_datasets.history_dataset import SAMPLES, history_contents
from film_datasets.quantities import in_numbers
from film_datasets.schema import ADDED, HISTORY, content_sha256, holds_text, kind_of, variables_of
from film_datasets.schema.validation import damage
from film_datasets.seal import check_seal, seal_store, sealed
from film_datasets.tables import TABLES, check_parquet, left_out, write_table
from film_model.base.files import check_folder, check_regular, check_replaceable, flush, written_whole
from film_model.base.foreign import Dataset
from film_model.base.hdf5 import check_hdf5
from film_model.solve.history import History

SUFFIX, ZARR = ".nc", ".zarr"

WRITTEN = (SUFFIX, ZARR, *TABLES)
"""Suffixes of what `write` writes."""

STORES = ("zarr.json", ".zgroup")
"""A folder that has one of these files is a Zarr store, of format 3 or 2."""

MOST_INDEXED = 10_000_000
"""A coordinate with more values than this is not indexed by `open_dataset`: the index is held in memory."""

CHECKED_AT_ONCE = 100_000_000
"""A dataset of more bytes than this is not compared with its hash when it is opened: it is read lazily. Its variables
have checksums, which every reader compares."""

NEEDS_ZARR = 'Zarr folders need zarr: install film-model[zarr] (pip install "film-model[zarr]")'

DEFLATE_FROM = 4096
"""Smaller variables (bytes) are not compressed: the chunk index (2 kB) takes more than compression saves."""


def write(ds: Dataset | History, path: str | os.PathLike[str], overwrite: bool = False) -> Path:
    """Write `ds` to the netCDF-4 file or Zarr folder `path`, or as a table (see `to_frame`) to a .csv, .parquet or .mat
    file. A history is written as its dataset (`to_dataset`), to netCDF without importing xarray.

    It is written under another name in the same folder, flushed to the disk and renamed, so that `path` is never
    incomplete; the same dataset gives the same bytes. Long variables are shuffled and deflated at level 1. Quantities
    (`ds.film.quantify()`) are written as SI numbers. The attribute content_sha256 is that of what is written; a dataset
    of which variables were dropped has none.

    Returns the path. Raises ValueError for another suffix; ImportError for Parquet without pyarrow or Zarr without
    zarr; FileExistsError if the file exists and `overwrite` is not set; IsADirectoryError, FileNotFoundError,
    PermissionError or OSError if it cannot be written.

    >>> path = fd.write(fd.to_dataset(fm.simulate(scene)), "impact.nc")
    >>> fd.read(path).attrs["outcome"]
    'contact ended'
    """
    target = Path(path)
    if isinstance(ds, History):
        check_file(target, overwrite)
        contents = history_contents(ds, SAMPLES, "film_datasets.to_dataset")
        if target.suffix == SUFFIX:
            contents = replace(contents, attrs=sealed(contents))
            return _write_netcdf(target, lambda beside: contents.write(beside, _encoding(cast("Any", contents))))
        ds = contents.dataset()
    import xarray as xr

    if not isinstance(ds, xr.Dataset):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"write takes a dataset or a history, not a {type(ds).__name__}")
    check_file(target, overwrite)
    found = _with_hash(in_numbers(ds))
    if target.suffix in TABLES:
        with written_whole(target) as beside:
            write_table(found, target, beside)
        return target
    if target.suffix == SUFFIX:
        how: dict[str, Any] = {"format": "NETCDF4", "engine": "netcdf4", "encoding": _encoding(found)}
        found = found.assign_attrs(sealed(found))
        return _write_netcdf(target, lambda beside: found.to_netcdf(beside, mode="w", **how))
    return _write_folder(found, target)


def _write_netcdf(target: Path, write_to: Callable[[Path], object]) -> Path:
    """Write a netCDF file, whole or not at all."""
    try:
        with written_whole(target) as beside:
            try:
                write_to(beside)
            except PermissionError as error:
                raise OSError(reason_of(error, target)) from error
    except RuntimeError as error:  # the netCDF library raises it for a full disk
        raise OSError(f"{target}: cannot be written (is the disk full?): {error}") from error
    return target


def _with_hash(ds: Dataset) -> Dataset:
    """The dataset with the hash of its values as they are now."""
    if "content_sha256" not in ds.attrs:
        return ds
    try:
        return ds.assign_attrs(content_sha256=content_sha256(ds))
    except ValueError:
        part = ds.copy()
        del part.attrs["content_sha256"]
        return part


def _write_folder(ds: Dataset, target: Path) -> Path:
    """Write a Zarr folder, of format 3, whole or not at all."""
    beside = temporary_path(target)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # consolidated metadata and texts are not yet in the specification
            ds.drop_encoding().to_zarr(
                beside, mode="w", zarr_format=3, consolidated=True, encoding=_zarr_encoding(ds), write_empty_chunks=True
            )
        seal_store(beside)
        put_in_place(beside, target)
    except ImportError as error:
        raise ImportError(f"{target}: {NEEDS_ZARR}") from error
    except OSError as error:
        raise OSError(f"{target}: cannot be written: {reason_of(error, target)}") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)
    return target


def read(path: str | os.PathLike[str]) -> Dataset:
    """The dataset in a file, in memory, the file closed. Raises what `open_dataset` raises."""
    with open_dataset(path) as ds:
        return ds.load()


def open_dataset(path: str | os.PathLike[str]) -> Dataset:
    """The dataset in a netCDF file or Zarr folder written by film-model, with the accessor `film`.

    A history is read into memory; a sweep is read lazily. A coordinate of more than `MOST_INDEXED` values has no
    index, so `sel` does not take it.

    Raises OSError if the file does not exist, cannot be read, does not match its hashes (values up to `CHECKED_AT_ONCE`
    bytes are compared) or leads to other files; ValueError for a file of another program or of a later version.

    >>> path = fd.write(fd.to_dataset(fm.simulate(scene)), "impact.nc")
    >>> with fd.open(path) as ds:
    ...     print(ds.attrs["outcome"])
    contact ended
    """
    import xarray as xr

    source = Path(path)
    engine = _engine_of(source)
    try:
        ds = _indexed(xr.open_dataset(source, engine=engine, create_default_indexes=False))
    except ImportError as error:
        raise ImportError(f"{source}: {NEEDS_ZARR}") from error
    except PermissionError as error:
        raise PermissionError(f"{source}: cannot be read: {error.strerror}") from error
    except Exception as error:  # each library raises its own for an unknown format
        kind = "a Zarr folder" if engine == "zarr" else "a netCDF file"
        raise OSError(f"{source}: is not {kind}, or is damaged ({error})") from error
    try:
        kind, version = kind_of(ds), ds.attrs.get("film_model_schema_version")
        if version not in ADDED[kind]:
            raise ValueError(f"version {version!r} of {kind} is not known: at most {list(ADDED[kind])[-1]!r} is")
    except ValueError as error:
        ds.close()
        raise ValueError(f"{source}: {error}") from None
    try:
        check_seal(ds, source)
        wrong = damage(ds, "content_sha256" in ds.attrs and ds.nbytes <= CHECKED_AT_ONCE)
        if wrong:
            raise OSError("; ".join(wrong))
        if kind == HISTORY:
            ds.load()
            ds.close()
    except Exception as error:
        ds.close()
        raise OSError(f"{source}: is damaged ({error})") from error
    return ds


def convert(source: str | os.PathLike[str], target: str | os.PathLike[str], overwrite: bool = False) -> list[str]:
    """Write the dataset in a netCDF file or Zarr folder, or the measurement in a CSV file, in the format of `target`.

    target: FILE.nc, .zarr, .csv, .parquet or .mat. Returns what the new file lacks. Raises what `write` raises.

    >>> ds = fd.sweep(scene, {"impactor.velocity": ["1 m/s", "2 m/s"]}, output="two.nc")
    >>> fd.convert("two.nc", "two.csv")
    []
    """
    given, wanted = Path(source), Path(target)
    check_file(wanted, overwrite)
    if given.suffix == ".csv":
        write(from_csv(given), wanted, overwrite)
        return []
    with open_dataset(given) as ds:
        if ds.nbytes > CHECKED_AT_ONCE and (wrong := damage(ds)):
            raise OSError(f"{given}: is damaged ({'; '.join(wrong)})")
        write(ds, wanted, overwrite)
        return [] if wanted.suffix in (SUFFIX, ZARR) else left_out(ds)


def _engine_of(source: Path) -> Literal["zarr", "netcdf4"]:
    """What reads a file or folder. Raises OSError or ValueError as `open_dataset` for what is not opened."""
    if not source.exists():
        raise FileNotFoundError(f"{source}: there is no such file")
    if source.suffix in TABLES and source.is_file():
        raise ValueError(f"{source}: a table does not hold the whole dataset: give the .nc or .zarr it was made from")
    try:
        if source.is_dir():
            check_folder(source)
            return "zarr"
        check_regular(source)
        check_hdf5(source)
    except ValueError as error:
        raise OSError(f"{source}: {error}") from error
    return "netcdf4"


def _indexed(ds: Dataset) -> Dataset:
    """The dataset with an index for every coordinate of at most `MOST_INDEXED` values, and texts of fixed length."""
    texts = [name for name, array in ds.variables.items() if holds_text(array)]
    ds = ds.assign({name: ds[name].copy(data=np.array(ds[name].values.tolist(), np.str_)) for name in texts})
    along = [str(name) for name, array in ds.coords.items() if array.dims == (name,) and array.size <= MOST_INDEXED]
    for name in along:
        ds = ds.set_xindex(name)
    return ds


def check_file(target: Path, overwrite: bool) -> None:
    """As `check_place`, for a file that `write` writes."""
    if target.suffix not in WRITTEN:
        others = ", ".join(f'"{suffix}"' for suffix in TABLES)
        raise ValueError(
            f'{target}: the name of a netCDF file must end in "{SUFFIX}", that of a Zarr folder in "{ZARR}", '
            f"that of a table in {others}"
        )
    check_parquet(target)
    check_place(target, overwrite)


def check_place(target: Path, overwrite: bool) -> None:
    """Raise before the computation if its result could not be written to `target`."""
    folder = target.absolute().parent
    if target.is_dir() and target.suffix != ZARR:
        raise IsADirectoryError(f"{target}: is a folder, the name of a file is needed")
    if target.is_dir() and not any((target / name).is_file() for name in STORES):
        raise IsADirectoryError(f"{target}: is a folder but not a Zarr store, and is not replaced")
    if not folder.is_dir():
        raise FileNotFoundError(f"{target}: there is no folder {folder}")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{target}: the folder {folder} cannot be written to")
    check_replaceable(target, overwrite)


def reason_of(error: Exception, target: Path) -> str:
    """Why writing failed. The netCDF library says "Permission denied" for a full disk, and RuntimeError for others;
    h5py adds lines about its own state to the system's error."""
    if shutil.disk_usage(target.absolute().parent).free < 1_000_000:
        return "the disk is full"
    number = getattr(error, "errno", None) or 0
    if number > 0:  # below 0 are the netCDF library's own
        return os.strerror(number)
    return (getattr(error, "strerror", None) or str(error)).split("\n")[0]


def temporary_path(target: Path) -> Path:
    """Where a file or folder is written before it is renamed to `target`."""
    return target.absolute().with_name(f".{target.name}.part")


def put_in_place(finished: Path, target: Path) -> None:
    """Rename a finished file (flushed to the disk) or folder to `target`, replacing an older one."""
    if not finished.is_dir():
        flush(finished, os.O_RDWR)
        os.replace(finished, target)
        return
    old = target.absolute().with_name(f".{target.name}.old")
    shutil.rmtree(old, ignore_errors=True)
    if target.is_dir():
        os.rename(target, old)
    else:
        target.unlink(missing_ok=True)
    os.rename(finished, target)
    shutil.rmtree(old, ignore_errors=True)


def size_of(path: str | os.PathLike[str]) -> int:
    """Bytes of a file, or of the files in a folder."""
    place = Path(path)
    return sum(file.stat().st_size for file in ([place] if place.is_file() else place.rglob("*")) if file.is_file())


def _encoding(ds: Dataset) -> dict[str, Any]:
    """Per variable: compression for long ones, a checksum for the others (deflate has one), a fill value only for
    optional ones."""
    missing = {variable.name for variable in variables_of(ds) if variable.optional}
    deflate = {"zlib": True, "complevel": 1, "shuffle": True}
    return {
        str(name): {**_filters(array, deflate), "_FillValue": float("nan") if name in missing else None}
        for name, array in ds.variables.items()
    }


def _filters(array: Any, deflate: dict[str, Any]) -> dict[str, Any]:
    if not array.size or not array.dims or holds_text(array):  # for which netCDF has no filters
        return {}
    return deflate if array.nbytes >= DEFLATE_FROM else {"fletcher32": True, "chunksizes": array.shape}


def _zarr_encoding(ds: Dataset) -> dict[str, Any]:
    """Per variable: compression, and a checksum of the compressed bytes."""
    from zarr.codecs import Crc32cCodec, ZstdCodec  # lazy: an optional dependency

    names = [str(name) for name, array in ds.variables.items() if not holds_text(array)]
    return {name: {"compressors": (ZstdCodec(), Crc32cCodec())} for name in names}
