"""Datasets with pint quantities for values, and back to SI numbers."""

from __future__ import annotations

from typing import Any

import xarray as xr

from film_datasets.schema import dimension_of, dimension_of_unit, variables_of
from film_model.units import DIMENSIONS, quantity, scene_unit


def quantified(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with quantities for values; by pint-xarray, coordinates too, if it is installed."""
    rows = [v for v in variables_of(ds) if v.name in ds.variables]
    own = {v.name: scene_unit(dimension_of_unit(v.unit)) for v in rows if v.unit not in (None, "1")}
    try:
        import pint_xarray  # noqa: F401  # which makes the accessor `pint`
    except ImportError:
        pass
    else:
        bare = ds.copy()
        for name in own:
            bare[name].attrs = {key: value for key, value in bare[name].attrs.items() if key != "units"}
        return bare.pint.quantify(own)
    made = ds.copy()
    for name in ds.data_vars:
        if name in own:
            array = ds[name]
            attrs = {key: value for key, value in array.attrs.items() if key != "units"}
            made[name] = (array.dims, quantity(array.values, dimension_of(array)), attrs)
    return made


def in_numbers(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with SI numbers for quantities, in whatever unit they are; itself if it has none."""
    found: dict[Any, xr.Variable] = {}
    units = {v.name: v.unit for v in variables_of(ds)}
    for name, array in ds.variables.items():
        if {"units", "flag_values"} & set(array.attrs) or not hasattr(array.data, "magnitude"):
            continue
        unit = units.get(str(name)) or _unit_of(array.data)  # a swept quantity has no row of its own
        rest = {key: value for key, value in array.attrs.items() if key != "long_name"}
        attrs = {"long_name": array.attrs["long_name"], "units": unit, **rest}
        found[name] = xr.Variable(
            array.dims, array.data.to(scene_unit(dimension_of_unit(unit))).magnitude, attrs, array.encoding
        )
    if not found:
        return ds
    data, coordinates = (
        {name: found.get(name, ds.variables[name]) for name in names} for names in (ds.data_vars, ds.coords)
    )
    return xr.Dataset(data, coordinates, ds.attrs)


def _unit_of(values: Any) -> str:
    """The SI unit of a quantity; of those of its dimension (J/m2, N/m) its own, if it is one."""
    near = [name for name in DIMENSIONS if values.is_compatible_with(scene_unit(name))]
    own = next((name for name in near if str(quantity(1.0, name).units) == str(values.units)), near[0])
    return DIMENSIONS[own].unit
