"""Writers that take the variables of a sweep block by block: to memory, a netCDF file or a Zarr folder."""

from __future__ import annotations

import itertools
import math
import os
import shutil
import warnings
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.files import DEFLATE_FROM, NEEDS_ZARR
from film_datasets.schema import RAGGED, TEXT, Variable
from film_datasets.seal import netcdf_attributes, seal_store

Region = tuple[slice, ...]

FILE_BLOCKS = 8
"""Blocks that a file of a Zarr folder holds, in one chunk: 2 MB for each number of an impact are held in memory."""

COORDINATE_CHUNK = 1 << 18
"""Values of a chunk of a coordinate: 2 MB."""


class MemoryWriter:
    """Fills arrays in memory; `dataset` is set by `close`.

    All writers have: `create`, variables with their attributes, from the sizes of the dimensions, except the ragged
    ones, which grow, and the chunks of all; `put`, a region of a variable, a chunk or a block; `grow`, values appended
    to one along its ragged dimension, at the same time as `put` of others; `commit`, which writes what was put so far,
    in an order that does not depend on the workers; and `close`, which writes the global attributes and ends it.
    """

    def __init__(self) -> None:
        self._arrays: dict[str, Any] = {}
        self._lengths: dict[str, int] = {}
        self._variables: dict[str, tuple[Variable, dict[str, Any]]] = {}
        self.dataset: Any = None

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        for variable, attributes in variables:
            self._variables[variable.name] = variable, attributes
            if _grows(variable):
                rest = [sizes[dim] for dim in variable.dims[1:]]
                self._arrays[variable.name], self._lengths[variable.name] = np.empty((0, *rest), variable.dtype), 0
            else:
                dtype = object if variable.dtype == TEXT else variable.dtype
                self._arrays[variable.name] = np.empty([sizes[dim] for dim in variable.dims], dtype)

    def put(self, name: str, region: Region, values: Any) -> None:
        self._arrays[name][region] = values

    def grow(self, name: str, values: Any) -> None:
        array, begin = self._arrays[name], self._lengths[name]
        self._lengths[name] = end = begin + len(values)
        if end > len(array):  # in place where the system can: pieces and their concatenation take twice the memory
            array.resize((end + begin // 4, *array.shape[1:]), refcheck=False)
        array[begin:end] = values

    def commit(self) -> None:
        """Nothing is left to do: the arrays are filled."""

    def close(self, attributes: Mapping[str, Any]) -> None:
        import xarray as xr

        arrays = self._arrays
        for name, length in self._lengths.items():
            arrays[name].resize((length, *arrays[name].shape[1:]), refcheck=False)
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
    """Writes a netCDF-4 file with a chunk for each block. Long variables are shuffled and deflated at level 1.

    The netCDF library creates the file and writes its attributes. It deflates in one thread; so the chunks are deflated
    by those who put them, and written as they are, through h5py, one after the other.
    """

    def __init__(self, path: Path) -> None:
        path.unlink(missing_ok=True)
        # created here because the library does not tell why it cannot create a file
        os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        self.path = path
        self._file: Any = None
        self._variables: dict[str, Any] = {}
        self._chunks: dict[str, tuple[tuple[int, ...], np.dtype[Any], float]] = {}
        self._growth: dict[str, _Growth] = {}
        self._ready: dict[str, list[tuple[Region, Any]]] = {}
        self._described: Sequence[tuple[Variable, dict[str, Any]]] = ()

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        import h5py  # lazy: a sweep in memory does not need these
        import netCDF4

        with netCDF4.Dataset(self.path, "w", format="NETCDF4") as file:
            file.set_fill_off()
            for dim, size in sizes.items():
                file.createDimension(dim, size)
            for dim in dict.fromkeys(variable.dims[0] for variable, _ in variables if _grows(variable)):
                file.createDimension(dim, None)
            for variable, attributes in variables:
                values = math.prod(sizes[dim] if dim in sizes else chunks[dim] for dim in variable.dims)
                long = variable.dtype != TEXT and values * variable.dtype.itemsize >= DEFLATE_FROM
                shape = chunk_shape(variable, sizes, chunks)
                checked = variable.dtype != TEXT and 0 not in shape and variable.dims != ()
                created: Any = file.createVariable(
                    variable.name,
                    str if variable.dtype == TEXT else variable.dtype,
                    variable.dims,
                    chunksizes=shape if checked else None,
                    fill_value=np.nan if variable.optional else False,
                    contiguous=not checked and variable.dtype != TEXT,
                    fletcher32=checked and not long,
                    compression="zlib" if long else None,
                    complevel=1,
                    shuffle=True,
                )
                created.setncatts(attributes)
                self._ready[variable.name] = []
                if long:
                    fill = np.nan if variable.optional else 0
                    self._chunks[variable.name] = shape, variable.dtype, fill
                if _grows(variable):
                    self._growth[variable.name] = _Growth(chunks[variable.dims[0]])
        self._described = variables
        self._file = h5py.File(self.path, "r+")
        self._variables = {variable.name: self._file[variable.name] for variable, _ in variables}

    def put(self, name: str, region: Region, values: Any) -> None:
        if name in self._chunks:
            shape, dtype, fill = self._chunks[name]
            values = deflated(padded(np.asarray(values, dtype), shape, fill))
        self._ready[name].append((region, values))

    def grow(self, name: str, values: Any) -> None:
        for begin, whole in self._growth[name].add(values):
            self.put(name, _rows(begin, whole), whole)

    def commit(self) -> None:
        for name, ready in self._ready.items():
            variable = self._variables[name]
            for region, values in ready:
                if name in self._growth:
                    variable.resize(region[0].stop, 0)
                if name not in self._chunks:
                    variable[region] = values
                    continue
                variable.id.write_direct_chunk(tuple(part.start for part in region), values)
            ready.clear()

    def close(self, attributes: Mapping[str, Any]) -> None:
        import netCDF4  # lazy, as above

        for name, growth in self._growth.items():
            for begin, rest in growth.rest():
                self.put(name, _rows(begin, rest), rest)
        self.commit()
        described = [(v.name, v.dims, self._variables[v.name].shape, v, own) for v, own in self._described]
        self._file.close()
        with netCDF4.Dataset(self.path, "a") as file:
            file.setncatts(netcdf_attributes(described, attributes))

    def abandon(self) -> None:
        """Remove what was written."""
        try:
            if self._file:
                self._file.close()
        except (RuntimeError, OSError):  # closing writes, which fails on a full disk
            pass
        self.path.unlink(missing_ok=True)


class ZarrWriter:
    """Writes a Zarr folder (format 3) with a chunk, in a file of its own, for `FILE_BLOCKS` blocks, compressed by Blosc
    (LZ4, shuffled). existing: the variables are there already, and whole chunks of them are written.

    zarr creates the arrays and writes what is short. Chunks are compressed and written here: its own way takes twice
    as long, and most of that in one thread.
    """

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
        self._growth: dict[str, _Growth] = {}

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        from zarr.codecs import BloscCodec, Crc32cCodec  # lazy: an optional dependency

        for variable, attributes in variables:
            own = list(chunk_shape(variable, sizes, chunks))
            divided = [k for k, dim in enumerate(variable.dims) if own[k] < sizes.get(dim, own[k] + 1)]
            if divided and variable.dims != (variable.name,):
                own[divided[-1]] *= FILE_BLOCKS
            packed: dict[str, Any] = {} if variable.dtype == TEXT else {"compressors": (Crc32cCodec(),)}
            if packed and variable.dims:
                size = variable.dtype.itemsize
                blosc = BloscCodec(typesize=size, cname="lz4", clevel=5, shuffle="shuffle")
                packed["compressors"] = (blosc, Crc32cCodec())
            self._arrays[variable.name] = self._group.create_array(
                variable.name,
                shape=tuple(sizes.get(dim, 0) for dim in variable.dims),
                chunks=tuple(min(chunk, sizes.get(dim, chunk)) for chunk, dim in zip(own, variable.dims, strict=True)),
                dtype=str if variable.dtype == TEXT else variable.dtype,
                dimension_names=variable.dims,
                fill_value=np.nan if variable.optional else "" if variable.dtype == TEXT else 0,
                attributes={key: _plain(value) for key, value in attributes.items()},
                **packed,
            )
            if _grows(variable):
                self._growth[variable.name] = _Growth(own[0])

    def put(self, name: str, region: Region, values: Any) -> None:
        array = self._arrays[name]
        if array.dtype.kind not in "fi" or not array.shape:
            array[region] = values
            return
        partial = [k for k, part in enumerate(region) if part.stop - part.start < array.shape[k]]
        cut = partial[-1] if partial else 0
        pending = self._pending.setdefault(name, [])
        pending.append((region, values))
        stop = region[cut].stop
        if stop % array.chunks[cut] == 0 or stop == array.shape[cut]:  # whole files: a part would be written again
            self._write(name, pending[0][0], np.concatenate([part for _, part in pending], axis=cut))
            pending.clear()

    def _write(self, name: str, region: Region, values: Any) -> None:
        """Write the chunk that begins where the region does."""
        from google_crc32c import value as crc32c  # lazy: these come with zarr
        from numcodecs.blosc import SHUFFLE, Blosc

        array = self._arrays[name]
        whole = padded(np.asarray(values, array.dtype.newbyteorder("<")), array.chunks, array.fill_value)
        places = (str(part.start // chunk) for part, chunk in zip(region, array.chunks, strict=True))
        file = self.path.joinpath(name, "c", *places)
        file.parent.mkdir(parents=True, exist_ok=True)
        packed = Blosc("lz4", 5, SHUFFLE).encode(whole)
        file.write_bytes(packed + crc32c(packed).to_bytes(4, "little"))

    def read(self, name: str, region: Region) -> Any:
        """What was written to a region of a variable, in whole files."""
        return self._arrays[name][region]

    def grow(self, name: str, values: Any) -> None:
        for begin, whole in self._growth[name].add(values):
            self._write(name, _rows(begin, whole), whole)

    def commit(self) -> None:
        """Nothing is left to do: each chunk has a file of its own."""

    def close(self, attributes: Mapping[str, Any]) -> None:
        import zarr  # lazy: an optional dependency

        for name, growth in self._growth.items():
            for begin, rest in growth.rest():
                self._write(name, _rows(begin, rest), rest)
            self._arrays[name].resize((growth.length, *self._arrays[name].shape[1:]))
        self._group.attrs.update({key: _plain(value) for key, value in attributes.items()})
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore"
            )  # format 3 does not yet specify consolidated metadata, but xarray reads them
            zarr.consolidate_metadata(self.path)
        seal_store(self.path)

    def abandon(self) -> None:
        """Remove what was written."""
        shutil.rmtree(self.path, ignore_errors=True)


Writer = MemoryWriter | NetCDFWriter | ZarrWriter


def _grows(variable: Variable) -> bool:
    """Whether the length of the variable is not known before the last block."""
    return variable.dims != () and variable.dims[0] in RAGGED


def _rows(begin: int, values: NDArray[Any]) -> Region:
    """The region of values that are appended at a place."""
    return (slice(begin, begin + len(values)), *(slice(0, size) for size in values.shape[1:]))


class _Growth:
    """The values of a variable that grows, in whole chunks of `size`. length: of all values so far."""

    def __init__(self, size: int) -> None:
        self.length = 0
        self._size = size
        self._waiting: list[Any] = []

    def add(self, values: Any) -> Iterator[tuple[int, Any]]:
        """Add values; the chunks that are now whole, and where they begin."""
        waiting = self.length % self._size
        first = self.length - waiting
        self.length += len(values)
        self._waiting.append(values)
        if waiting + len(values) < self._size:
            return
        together = np.concatenate(self._waiting)
        whole = len(together) - len(together) % self._size
        self._waiting = [together[whole:].copy()]  # a view would keep all of them in memory
        for begin in range(0, whole, self._size):
            yield first + begin, together[begin : begin + self._size]

    def rest(self) -> Iterator[tuple[int, Any]]:
        """The last chunk, unless it is empty, and where it begins."""
        if last := self.length % self._size:
            yield self.length - last, np.concatenate(self._waiting)


def chunk_shape(variable: Variable, sizes: Mapping[str, int], chunks: Mapping[str, int]) -> tuple[int, ...]:
    """The chunk of a variable: a block, or many values of a coordinate."""
    if variable.dims == (variable.name,):
        return (min(sizes[variable.name], COORDINATE_CHUNK),)
    return tuple(min(chunks[dim], sizes.get(dim, chunks[dim])) for dim in variable.dims)


def padded(values: NDArray[Any], shape: Sequence[int], fill: Any) -> NDArray[Any]:
    """The values at the beginning of an array of a chunk's shape, without gaps in memory."""
    if values.shape == tuple(shape):
        return np.ascontiguousarray(values)
    whole = np.full(shape, fill, values.dtype)
    whole[tuple(slice(size) for size in values.shape)] = values
    return whole


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


SAMPLE = 1024
"""Bytes of each significance that are deflated to see whether all are worth it."""


def deflated(values: NDArray[Any]) -> bytes:
    """A zlib stream (RFC 1950) of the values' bytes, those of the same significance one after the other (shuffled).

    Bytes of a significance that shrink are deflated at level 1, the others are stored; each run of either is a deflate
    stream of its own, which a flush ends at a whole byte, so that they form one stream. The same values give the same
    bytes.
    """
    shuffled = values.reshape(-1, 1).view(np.uint8).T
    begin = max(0, (shuffled.shape[1] - SAMPLE) // 2)
    samples = [row[begin : begin + SAMPLE].tobytes() for row in shuffled]
    # the low bytes of most results are noise: to deflate them takes two thirds of the time and saves 6 % of the bytes
    worth = [len(zlib.compress(sample, 1)) < 0.8 * len(sample) for sample in samples]
    data = shuffled.tobytes()
    size, first = len(data) // len(worth), 0
    stream = [b"\x78\x01"]  # the header: window of 32 kB, fastest level
    for shrinks, run in itertools.groupby(worth):
        end = first + size * len(list(run))
        piece = zlib.compressobj(1 if shrinks else 0, zlib.DEFLATED, -zlib.MAX_WBITS)
        stream.append(piece.compress(memoryview(data)[first:end]))
        stream.append(piece.flush(zlib.Z_FINISH if end == len(data) else zlib.Z_SYNC_FLUSH))
        first = end
    return b"".join([*stream, zlib.adler32(data).to_bytes(4, "big")])
