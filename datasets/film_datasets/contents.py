"""A dataset before it is one of xarray, whose import takes longer than an impact: variables and attributes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from film_model.base.foreign import Dataset

if TYPE_CHECKING:
    import os

COORDINATES = ("t", "sensor")
"""Variables of a history that are coordinates."""


@dataclass(frozen=True)
class Values:
    """One variable: names of its dimensions, values, attributes."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: dict[str, Any]

    def __getattr__(self, name: str) -> Any:
        """What a variable of xarray has of its values: dtype, ndim, shape, size and nbytes."""
        if name not in ("dtype", "ndim", "shape", "size", "nbytes"):
            raise AttributeError(name)
        return getattr(self.values, name)


@dataclass(frozen=True)
class Contents:
    """Variables by name and global attributes, of a dataset whose coordinates are `t` and `sensor`, if it has them."""

    variables: Mapping[str, Values]
    attrs: dict[str, Any]

    def __getitem__(self, name: str) -> Values:
        return self.variables[name]

    def dataset(self) -> Dataset:
        """The same as a dataset of xarray."""
        import xarray as xr

        data = {name: (one.dims, one.values, one.attrs) for name, one in self.variables.items()}
        along = {name: one for name, one in data.items() if name in COORDINATES}
        return xr.Dataset({name: one for name, one in data.items() if name not in along}, along, self.attrs)

    def write(self, path: str | os.PathLike[str], encoding: Mapping[str, Mapping[str, Any]]) -> None:
        """Write a netCDF-4 file, that which xarray writes of the dataset to the last byte."""
        import netCDF4

        along = [name for name in self.variables if name in COORDINATES]
        ordered = [*(name for name in self.variables if name not in along), *along]
        with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
            file.setncatts(self.attrs)
            sizes = {
                dim: size
                for one in self.variables.values()
                for dim, size in zip(one.dims, one.values.shape, strict=True)
            }
            for dim, size in sizes.items():
                file.createDimension(dim, size)
            for name in ordered:
                one, how = self.variables[name], dict(encoding[name])
                kind = str if one.dtype.kind == "U" else one.dtype
                made = file.createVariable(name, kind, one.dims, fill_value=how.pop("_FillValue"), **how)
                made.set_auto_maskandscale(False)
                made.setncatts(one.attrs)
                made[...] = one.values.astype(object) if kind is str else one.values
