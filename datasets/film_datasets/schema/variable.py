"""One variable of a dataset's schema, and the names that CF allows for it and its flags."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from film_model.base.foreign import DataArray, Dataset
from film_model.base.units import DIMENSIONS

FLOAT, BYTE, INTEGER, LONG, TEXT = (np.dtype(kind) for kind in (np.float64, np.int8, np.int32, np.int64, np.str_))

IMPACTS = "impacts"
"""Placeholder for the dimensions of a sweep: its swept quantities, or `impact`."""


@dataclass(frozen=True)
class Variable:
    """One variable. unit: SI, as UDUNITS writes it; None for flags. optional: NaN where there is no value.

    sample_dimension: that along which the variable counts the samples of each impact (CF, contiguous ragged arrays).
    flags: value → meaning. `more` names a list of further meanings that each dataset supplies ("stages" of the law,
    "laws" of a sweep, quantities "out_of_range"); their values count from `more_from`, or the list says them.
    """

    name: str
    dims: tuple[str, ...]
    dtype: np.dtype[Any]
    unit: str | None
    long_name: str
    comment: str = ""
    flags: tuple[tuple[int, str], ...] = ()
    more: str = ""
    more_from: int = 0
    optional: bool = False
    sample_dimension: str = ""

    def attributes(self, meanings: Mapping[str, Sequence[str] | Mapping[int, str]] | None = None) -> dict[str, Any]:
        """CF attributes of the variable; meanings: the lists that `more` may name."""
        own = (meanings or {}).get(self.more, ())
        flags = [*self.flags, *(own.items() if isinstance(own, Mapping) else enumerate(own, self.more_from))]
        attributes: dict[str, Any] = {"long_name": self.long_name}
        if self.unit is not None:
            attributes["units"] = self.unit
        if self.comment:
            attributes["comment"] = self.comment
        if self.sample_dimension:
            attributes["sample_dimension"] = self.sample_dimension
        if flags:
            attributes["flag_values"] = np.array([value for value, _ in flags], self.dtype)
            attributes["flag_meanings"] = " ".join(meaning for _, meaning in flags)
        return attributes

    def over(self, dims: tuple[str, ...]) -> Variable:
        """The variable with the dimensions of a sweep in place of `IMPACTS`."""
        return replace(self, dims=tuple(d for dim in self.dims for d in (dims if dim == IMPACTS else (dim,))))


def dimension_of(array: DataArray) -> str:
    """The dimension of a variable's unit; see `dimension_of_unit`."""
    return dimension_of_unit(array.attrs.get("units", "1"))


def dimension_of_unit(unit: str | None) -> str:
    """The first of `units.DIMENSIONS` with this unit; "dimensionless" if no dimension has it."""
    return next((name for name, dimension in DIMENSIONS.items() if dimension.unit == unit), "dimensionless")


def swept_name(path: str) -> str:
    """The variable of a swept quantity: impactor_velocity for impactor.velocity."""
    return path.replace(".", "_").replace("-", "_")


def swept_variable(path: str, dims: tuple[str, ...], unit: str | None, labels: Sequence[str] = ()) -> Variable:
    """The variable of a swept quantity: a number with a unit, or flags if it has labels."""
    long_name = path.replace(".", ", ").replace("_", " ")
    if labels:
        flags = tuple(enumerate(flag_words(labels)))
        return Variable(swept_name(path), dims, INTEGER, None, long_name, "swept; see attribute sweep_toml", flags)
    return Variable(swept_name(path), dims, FLOAT, unit, long_name, "swept; see attribute sweep_toml")


def swept_words(path: str, dims: tuple[str, ...]) -> Variable:
    """The variable of a swept quantity that holds words."""
    return replace(swept_variable(path, dims, None), dtype=TEXT)


def flag_words(names: Sequence[str], taken: Sequence[str] = ()) -> tuple[str, ...]:
    """Names as CF flag meanings: one word each, distinct from each other and from those `taken`."""
    words = list(taken)
    for name in names:
        word = "".join(c if c.isascii() and (c.isalnum() or c in "_.+@-") else "_" for c in name) or "none"
        words.append(word if word not in words else f"{word}_{len(words)}")
    return tuple(words[len(taken) :])


def flag_meanings(array: DataArray) -> list[str]:
    """The flag meanings of a variable in the order of their values; empty if it has no flags."""
    return str(array.attrs.get("flag_meanings", "")).split()


def holds_text(array: Any) -> bool:
    """Whether the values are texts: fixed in length, Python objects, or of variable length (from Zarr)."""
    return array.dtype.kind in "UOT"


def words_of(array: DataArray) -> list[str]:
    """The word for each value of a swept quantity; empty if its values are numbers."""
    if holds_text(array):
        return [str(word) for word in np.ravel(array.values)]
    meanings = flag_meanings(array)
    return [meanings[number] for number in np.ravel(array.values).tolist()] if meanings else []


def swept_variables(paths: list[str], ds: Dataset) -> tuple[Variable, ...]:
    """The variables of a dataset's swept quantities; their units and labels are those in the dataset."""
    found: list[Variable] = []
    for path in paths:
        name = swept_name(path)
        dims = ("impact",) if "impact" in ds.sizes else (name,)
        if name in ds.variables and holds_text(ds[name]):
            found.append(swept_words(path, dims))
        elif name in ds.variables:
            found.append(swept_variable(path, dims, ds[name].attrs.get("units"), flag_meanings(ds[name])))
        else:
            found.append(swept_variable(path, dims, None))
    return tuple(found)
