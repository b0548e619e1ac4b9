"""Writers that take the variables of a sweep block by block: to memory, a netCDF file or a Zarr folder."""

from __future__ import annotations

import math
import os
import shutil
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from film_datasets.files import DEFLATE_FROM, NEEDS_ZARR, ZARR, temporary_path
from film_datasets.schema import RAGGED, TEXT, Variable

Region = tuple[slice, ...]

SHARD_BLOCKS = 8
"""Blocks that a file of a Zarr folder holds: 8 MB for each number of an impact are held in memory meanwhile."""


CACHED_CHUNKS = 2
"""Chunks of a variable that the netCDF library holds: the one that is written and, where segments grow, the next."""


class Writer(Protocol):
    """What takes the variables of a dataset in pieces. parallel: different variables at the same time."""

    @property
    def parallel(self) -> bool: ...

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        """Create variables with their attributes. sizes: of the dimensions, except the ragged ones, which grow.
        chunks: of all of them."""

    def put(self, name: str, region: Region, values: Any) -> None:
        """Write a region of a variable."""

    def grow(self, name: str, values: Any) -> None:
        """Append values to a variable along its ragged dimension."""

    def close(self, attributes: Mapping[str, Any]) -> None:
        """Write the global attributes; nothing can be written afterwards."""


def writer_for(target: Path) -> NetCDFWriter | ZarrWriter:
    """The writer for a file name. Raises ImportError for a Zarr folder if zarr is not installed."""
    return ZarrWriter(temporary_path(target)) if target.suffix == ZARR else NetCDFWriter(temporary_path(target))


class MemoryWriter:
    """Fills arrays in memory; `dataset` is set by `close`."""

    parallel = True

    def __init__(self) -> None:
        self._arrays: dict[str, Any] = {}
        self._pieces: dict[str, list[Any]] = {}
        self._variables: dict[str, tuple[Variable, dict[str, Any]]] = {}
        self.dataset: Any = None

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        for variable, attributes in variables:
            self._variables[variable.name] = variable, attributes
            if _grows(variable):
                rest = [sizes[dim] for dim in variable.dims[1:]]
                self._pieces[variable.name] = [np.empty((0, *rest), variable.dtype)]
            else:
                dtype = object if variable.dtype == TEXT else variable.dtype
                self._arrays[variable.name] = np.empty([sizes[dim] for dim in variable.dims], dtype)

    def put(self, name: str, region: Region, values: Any) -> None:
        self._arrays[name][region] = values

    def grow(self, name: str, values: Any) -> None:
        self._pieces[name].append(values)

    def close(self, attributes: Mapping[str, Any]) -> None:
        import xarray as xr

        arrays = {**self._arrays, **{name: np.concatenate(pieces) for name, pieces in self._pieces.items()}}
        coordinates = {
            word for _, attrs in self._variables.values() for word in str(attrs.get("coordinates", "")).split()
        }
        coordinates |= {name for name, (variable, _) in self._variables.items() if variable.dims == (name,)}
        data: dict[bool, dict[str, Any]] = {True: {}, False: {}}
        for name, (variable, attrs) in self._variables.items():
            attrs.pop("coordinates", None)
            values = arrays[name].astype(str) if variable.dtype == TEXT else arrays[name]
            data[name in coordinates][name] = xr.Variable(variable.dims, values, attrs)
        self.dataset = xr.Dataset(data[False], data[True], dict(attributes))


class NetCDFWriter:
    """Writes a netCDF-4 file with a chunk for each block. Long variables are shuffled and deflated at level 1."""

    parallel = False  # the library is not safe in several threads

    def __init__(self, path: Path) -> None:
        import netCDF4  # lazy: a sweep in memory does not need it

        path.unlink(missing_ok=True)
        # created here because the library does not tell why it cannot create a file
        os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        self.path = path
        self._file: Any = netCDF4.Dataset(path, "w", format="NETCDF4")
        self._file.set_fill_off()
        self._variables: dict[str, Any] = {}
        self._grown: dict[str, int] = {}

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        for dim, size in sizes.items():
            self._file.createDimension(dim, size)
        for dim in dict.fromkeys(variable.dims[0] for variable, _ in variables if _grows(variable)):
            self._file.createDimension(dim, None)
        for variable, attributes in variables:
            values = math.prod(sizes[dim] if dim in sizes else chunks[dim] for dim in variable.dims)
            long = variable.dtype != TEXT and values * variable.dtype.itemsize >= DEFLATE_FROM
            chunked = long or _grows(variable)
            chunk_bytes = math.prod(chunks[dim] for dim in variable.dims) * variable.dtype.itemsize
            created = self._file.createVariable(
                variable.name,
                str if variable.dtype == TEXT else variable.dtype,
                variable.dims,
                chunksizes=[chunks[dim] for dim in variable.dims] if chunked else None,
                fill_value=np.nan if variable.optional else False,
                contiguous=not chunked and variable.dtype != TEXT,
                **({"compression": "zlib", "complevel": 1, "shuffle": True} if long else {}),
            )
            if chunked:  # the library's own cache is 16 MB for each variable
                created.set_var_chunk_cache(size=CACHED_CHUNKS * chunk_bytes)
            created.set_auto_maskandscale(False)
            created.setncatts(attributes)
            self._variables[variable.name] = created

    def put(self, name: str, region: Region, values: Any) -> None:
        self._variables[name][region] = values

    def grow(self, name: str, values: Any) -> None:
        begin = self._grown.get(name, 0)
        self._grown[name] = begin + len(values)
        if len(values):
            self._variables[name][begin : begin + len(values)] = values

    def close(self, attributes: Mapping[str, Any]) -> None:
        self._file.setncatts(dict(attributes))
        self._file.close()

    def abandon(self) -> None:
        """Remove what was written."""
        try:
            if self._file.isopen():
                self._file.close()
        except (RuntimeError, OSError):  # closing writes, which fails on a full disk
            pass
        self.path.unlink(missing_ok=True)


class ZarrWriter:
    """Writes a Zarr folder (format 3) with a chunk for each block, `SHARD_BLOCKS` of them in a file, compressed by
    Blosc (LZ4, shuffled). existing: the variables are there already, and whole files of them are written."""

    parallel = True

    def __init__(self, path: Path, existing: bool = False) -> None:
        try:
            import zarr  # lazy: an optional dependency
        except ImportError as error:
            raise ImportError(NEEDS_ZARR) from error
        if path.exists() and not existing:
            shutil.rmtree(path)
        self.path = path
        self._group: Any = zarr.open_group(path, mode="r+" if existing else "w", zarr_format=3)
        self._arrays: dict[str, Any] = dict(self._group.arrays())
        self._pending: dict[str, list[tuple[Region, Any]]] = {}

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        from zarr.codecs import BloscCodec  # lazy: an optional dependency

        for variable, attributes in variables:
            own = tuple(min(chunks[dim], sizes.get(dim, chunks[dim])) for dim in variable.dims)
            cut = self._cut(own, [sizes.get(dim, own[k] + 1) for k, dim in enumerate(variable.dims)])
            shards = tuple(size * SHARD_BLOCKS if k == cut else size for k, size in enumerate(own))
            packed: dict[str, Any] = {}
            if variable.dtype != TEXT and variable.dims:
                size = variable.dtype.itemsize
                packed["compressors"] = BloscCodec(typesize=size, cname="lz4", clevel=5, shuffle="shuffle")
                packed["shards"] = shards if cut is not None else None
            self._arrays[variable.name] = self._group.create_array(
                variable.name,
                shape=tuple(sizes.get(dim, 0) for dim in variable.dims),
                chunks=own,
                dtype=str if variable.dtype == TEXT else variable.dtype,
                dimension_names=variable.dims,
                fill_value=np.nan if variable.optional else "" if variable.dtype == TEXT else 0,
                attributes={key: _plain(value) for key, value in attributes.items()},
                **packed,
            )

    @staticmethod
    def _cut(chunks: Sequence[int], sizes: Sequence[int]) -> int | None:
        """The dimension that is divided into blocks, of which several go into a file; None if there is one block."""
        divided = [k for k, (chunk, size) in enumerate(zip(chunks, sizes, strict=True)) if chunk < size]
        return divided[-1] if divided else None

    def put(self, name: str, region: Region, values: Any) -> None:
        array = self._arrays[name]
        cut = self._cut(array.chunks, array.shape)
        if array.shards is None or cut is None:
            array[region] = values
            return
        pending = self._pending.setdefault(name, [])
        pending.append((region, values))
        stop = region[cut].stop
        if stop % array.shards[cut] == 0 or stop == array.shape[cut]:  # whole files: a part would be written again
            whole = (*region[:cut], slice(pending[0][0][cut].start, stop), *region[cut + 1 :])
            array[whole] = np.concatenate([part for _, part in pending], axis=cut)
            pending.clear()

    def read(self, name: str, region: Region) -> Any:
        """What was written to a region of a variable, in whole files."""
        return self._arrays[name][region]

    def grow(self, name: str, values: Any) -> None:
        pending, length = self._pending.setdefault(name, []), self._arrays[name].shards[0]
        pending.append(((), values))
        if (count := sum(len(part) for _, part in pending)) >= length:
            together = np.concatenate([part for _, part in pending])
            whole = count - count % length
            self._arrays[name].append(together[:whole])
            pending[:] = [((), together[whole:])]

    def close(self, attributes: Mapping[str, Any]) -> None:
        import zarr  # lazy: an optional dependency

        for name, pending in self._pending.items():
            if sum(len(part) for _, part in pending):
                self._arrays[name].append(np.concatenate([part for _, part in pending]))
        self._group.attrs.update({key: _plain(value) for key, value in attributes.items()})
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore"
            )  # format 3 does not yet specify consolidated metadata, but xarray reads them
            zarr.consolidate_metadata(self.path)

    def abandon(self) -> None:
        """Remove what was written."""
        shutil.rmtree(self.path, ignore_errors=True)


def _grows(variable: Variable) -> bool:
    """Whether the length of the variable is not known before the last block."""
    return variable.dims[:1] != () and variable.dims[0] in RAGGED


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
