"""Where the columns of a sweep go: memory, a netCDF file, or a Zarr folder, block after block."""

from __future__ import annotations

import os
import shutil
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import xarray as xr

from film_datasets.files import NEEDS_ZARR, ZARR
from film_datasets.schema import Variable
from film_model.files import flush

Region = tuple[slice, ...]

GROWING = "segment"
"""The dimension whose length is known at the end only."""

GROWING_CHUNK = 1 << 16


class Store(Protocol):
    """Something that takes the variables of a dataset in pieces."""

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        """Make room for variables with their attributes; sizes: of the dimensions, chunks: of a block."""

    def put(self, name: str, region: Region, values: Any) -> None:
        """Write a part of a variable."""

    def grow(self, name: str, values: Any) -> None:
        """Append to a variable along `GROWING`."""

    def close(self, attributes: Mapping[str, Any]) -> None:
        """Write the global attributes and end."""


def store_for(target: Path) -> NetCDF | Zarr:
    """The store for a file name. Raises ImportError where zarr is missing."""
    return Zarr(beside(target)) if target.suffix == ZARR else NetCDF(beside(target))


def beside(target: Path) -> Path:
    """Where a file is made before it is renamed to `target`."""
    return target.absolute().with_name(f".{target.name}.part")


def put_in_place(made: Path, target: Path) -> None:
    """Rename a finished file, flushed to the disk, or a finished folder to `target`, in the place of an older one."""
    if not made.is_dir():
        flush(made, os.O_RDWR)
        os.replace(made, target)
        return
    old = target.absolute().with_name(f".{target.name}.old")
    shutil.rmtree(old, ignore_errors=True)
    if target.is_dir():
        os.rename(target, old)
    else:
        target.unlink(missing_ok=True)
    os.rename(made, target)
    shutil.rmtree(old, ignore_errors=True)


class Memory:
    """Arrays, and in the end an xarray.Dataset."""

    def __init__(self) -> None:
        self._arrays: dict[str, Any] = {}
        self._parts: dict[str, list[Any]] = {}
        self._variables: dict[str, tuple[Variable, dict[str, Any]]] = {}
        self.dataset: Any = None

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        for variable, attributes in variables:
            self._variables[variable.name] = variable, attributes
            if GROWING in variable.dims:
                self._parts[variable.name] = [np.empty(0, variable.dtype)]
            else:
                self._arrays[variable.name] = np.empty([sizes[dim] for dim in variable.dims], variable.dtype)

    def put(self, name: str, region: Region, values: Any) -> None:
        self._arrays[name][region] = values

    def grow(self, name: str, values: Any) -> None:
        self._parts[name].append(values)

    def close(self, attributes: Mapping[str, Any]) -> None:
        arrays = {**self._arrays, **{name: np.concatenate(parts) for name, parts in self._parts.items()}}
        named = {word for _, attrs in self._variables.values() for word in str(attrs.get("coordinates", "")).split()}
        named |= {name for name, (variable, _) in self._variables.items() if variable.dims == (name,)}
        data: dict[bool, dict[str, Any]] = {True: {}, False: {}}
        for name, (variable, attrs) in self._variables.items():
            attrs.pop("coordinates", None)
            data[name in named][name] = xr.Variable(variable.dims, arrays[name], attrs)
        self.dataset = xr.Dataset(data[False], data[True], dict(attributes))


class NetCDF:
    """A netCDF-4 file. Nothing is deflated: it would take longer than the impacts."""

    def __init__(self, path: Path) -> None:
        import netCDF4

        path.unlink(missing_ok=True)
        # Made here, not by the library, to have the reason when it cannot be.
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
        if any(GROWING in variable.dims for variable, _ in variables):
            self._file.createDimension(GROWING, None)
        for variable, attributes in variables:
            growing = GROWING in variable.dims
            made = self._file.createVariable(
                variable.name,
                variable.dtype,
                variable.dims,
                chunksizes=(GROWING_CHUNK,) if growing else None,
                fill_value=np.nan if variable.optional else False,
                contiguous=not growing,
            )
            made.set_auto_maskandscale(False)
            made.setncatts(attributes)
            self._variables[variable.name] = made

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
        """Leave nothing behind."""
        try:
            if self._file.isopen():
                self._file.close()
        except (RuntimeError, OSError):  # a full disk refuses this too
            pass
        self.path.unlink(missing_ok=True)


class Zarr:
    """A Zarr folder (format 3), each block a chunk, compressed with zarr's own default."""

    def __init__(self, path: Path) -> None:
        try:
            import zarr
        except ImportError as error:
            raise ImportError(NEEDS_ZARR) from error
        if path.exists():
            shutil.rmtree(path)
        self.path = path
        self._group: Any = zarr.open_group(path, mode="w", zarr_format=3)
        self._arrays: dict[str, Any] = {}

    def create(
        self, sizes: Mapping[str, int], chunks: Mapping[str, int], variables: Sequence[tuple[Variable, dict[str, Any]]]
    ) -> None:
        for variable, attributes in variables:
            self._arrays[variable.name] = self._group.create_array(
                variable.name,
                shape=tuple(sizes.get(dim, 0) for dim in variable.dims),
                chunks=tuple(chunks.get(dim, GROWING_CHUNK) for dim in variable.dims),
                dtype=variable.dtype,
                dimension_names=variable.dims,
                fill_value=np.nan if variable.optional else 0,
                attributes={key: _plain(value) for key, value in attributes.items()},
            )

    def put(self, name: str, region: Region, values: Any) -> None:
        self._arrays[name][region] = values

    def grow(self, name: str, values: Any) -> None:
        if len(values):
            self._arrays[name].append(values)

    def close(self, attributes: Mapping[str, Any]) -> None:
        import zarr

        self._group.attrs.update({key: _plain(value) for key, value in attributes.items()})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that format 3 does not specify it yet: xarray looks for it
            zarr.consolidate_metadata(self.path)

    def abandon(self) -> None:
        """Leave nothing behind."""
        shutil.rmtree(self.path, ignore_errors=True)


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
