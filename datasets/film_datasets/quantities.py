"""Datasets whose values are pint quantities, and back to SI numbers."""

from __future__ import annotations

import importlib
from typing import Any

from film_datasets.schema import dimension_of, dimension_of_unit, variables_of
from film_model.base.foreign import DataArray, Dataset
from film_model.base.units import DIMENSIONS, quantity, scene_unit


def quantified(ds: Dataset) -> Dataset:
    """The dataset with quantities as values; coordinates too if pint-xarray is installed."""
    variables = [v for v in variables_of(ds) if v.name in ds.variables]
    units = {v.name: scene_unit(dimension_of_unit(v.unit)) for v in variables if v.unit not in (None, "1")}
    result = ds.copy()
    try:
        importlib.import_module("pint_xarray")  # optional; importing it adds the accessor `pint`
    except ImportError:
        for name in ds.data_vars:
            if name in units:
                array = ds[name]
                result[name] = (array.dims, quantity(array.values, dimension_of(array)), _without_units(array))
        return result
    for name in units:
        result[name].attrs = _without_units(result[name])
    return result.pint.quantify(units)


def _without_units(array: DataArray) -> dict[Any, Any]:
    return {key: value for key, value in array.attrs.items() if key != "units"}


def in_numbers(ds: Dataset) -> Dataset:
    """The dataset with quantities of any unit converted to SI numbers; `ds` itself if it has no quantities."""
    import xarray as xr

    found: dict[Any, xr.Variable] = {}
    units = {v.name: v.unit for v in variables_of(ds)}
    for name, array in ds.variables.items():
        values: Any = array.data
        if {"units", "flag_values"} & set(array.attrs) or not hasattr(values, "magnitude"):
            continue
        unit = units.get(str(name)) or _unit_of(values)  # the unit of a swept quantity is not in the schema
        rest = {key: value for key, value in array.attrs.items() if key != "long_name"}
        attrs = {"long_name": array.attrs["long_name"], "units": unit, **rest}
        numbers = values.to(scene_unit(dimension_of_unit(unit))).magnitude
        found[name] = xr.Variable(array.dims, numbers, attrs, array.encoding)
    if not found:
        return ds
    data, coordinates = (
        {name: found.get(name, ds.variables[name]) for name in names} for names in (ds.data_vars, ds.coords)
    )
    return xr.Dataset(data, coordinates, ds.attrs)


def _unit_of(values: Any) -> str:
    """The SI unit of a quantity: its own if that is one of its dimension's SI units (J/m2, N/m), else the first."""
    near = [name for name in DIMENSIONS if values.is_compatible_with(scene_unit(name))]
    own = next((name for name in near if str(quantity(1.0, name).units) == str(values.units)), near[0])
    return DIMENSIONS[own].unit
