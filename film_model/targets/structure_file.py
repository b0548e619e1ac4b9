"""Files of natural vibrations: CSV tables and netCDF."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from film_model.base.errors import did_you_mean, shown
from film_model.base.files import read_bytes
from film_model.base.hdf5 import check_hdf5
from film_model.base.tables import HEADING, rows_of
from film_model.base.units import to_si
from film_model.targets.modes import Array

MOST_BYTES = 50_000_000
MOST_LISTED = 100_000
"""Most vibrations of a file, which are kept in the scene."""

COLUMNS = ("frequency", "modal_mass", "shape", "mass_normalised_shape", "damping_ratio")
EXAMPLE = '"frequency [Hz], modal_mass [kg], shape" or "frequency [Hz], mass_normalised_shape [1/sqrt(kg)]"'
NEED = f"a heading such as {EXAMPLE} is needed"

_STATIC = re.compile(r"^\s*#\s*static_compliance\s*=\s*(.*?)\s*$", re.MULTILINE)
"""The line of a CSV file with the static compliance."""

_FORTRAN = re.compile(r"([0-9.])[dD](?=[+-]?[0-9])")
"""The exponent of a number as Fortran writes it: 1.5D+03."""

_FREQUENCIES = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "rad/s": 0.5 / math.pi, "krad/s": 500.0 / math.pi}
ROOTS = {"kg": 1.0, "g": 1000.0**0.5, "t": 0.001**0.5, "Mg": 0.001**0.5}
"""√kg over the root of a unit of mass."""
_NORMALISED = {
    written: factor
    for unit, factor in ROOTS.items()
    for written in (f"1/sqrt({unit})", f"1/√{unit}", f"{unit}^-0.5", f"{unit}**-0.5", f"{unit}-0.5", f"1/{unit}^0.5")
}


class Listed(NamedTuple):
    """Vibrations by ascending frequency [Hz]: M/φ² [kg] at the struck point; damping ratios of those above 0 Hz."""

    frequency: tuple[float, ...]
    modal_mass: tuple[float, ...]
    damping_ratio: tuple[float, ...] | None
    static_compliance: float | None
    shapes: dict[str, tuple[float, ...]]
    """Of the further columns asked for: the shape there over that at the struck point."""


def read_structure(path: str, shapes: tuple[str, ...] = ()) -> Listed:
    """The vibrations in a file that move the struck point. shapes: further columns, of the shape at other points.

    CSV, or netCDF if the file begins as such a file does. Columns or variables: frequency; modal_mass and shape, the
    deflection at the struck point of the shape that has this mass, or mass_normalised_shape; damping_ratio if known.
    Units stand in the heading, `frequency [Hz]`, beside each value, or in the attribute `units`. The order of the rows
    does not matter. Raises OSError, or ValueError with the line of what is wrong.
    """
    try:
        content = read_bytes(path, MOST_BYTES)
    except ValueError as error:
        raise ValueError(f"{shown(path)} {error}") from None
    if content.startswith((b"\x89HDF\r\n", b"CDF")):
        places, columns, static = _netcdf(path, shapes)
    else:
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise ValueError(f"{shown(path)} is not a text in UTF-8: byte {error.start}") from None
        places, columns = _csv(path, text, shapes)
        static = _static_of(path, text)
    return _listed(path, places, columns, static, shapes)


def _static_of(path: str, text: str) -> float | None:
    """The static compliance of a CSV file, m/N; None if it has none."""
    found = _STATIC.search(text)
    try:
        return None if found is None else to_si(found[1], "compliance")
    except ValueError as error:
        raise ValueError(f"{shown(path)}, static_compliance: {error}") from None


def _csv(path: str, text: str, shapes: tuple[str, ...]) -> tuple[list[str], dict[str, list[float]]]:
    """Where each row is, and the columns in SI units. Where semicolons separate, numbers may have decimal commas."""
    rows = rows_of(path, text)
    line, heading = next(rows, (1, []))
    commas = len(heading) > 1 and ";" in text.splitlines()[line - 1]
    where = dict(_heading(f"{shown(path)}, line {line}", heading, shapes))
    places: list[str] = []
    columns: dict[str, list[float]] = {name: [] for name in where}
    known: dict[tuple[str, ...], int] = {}
    for line, cells in rows:
        places.append(f"{shown(path)}, line {line}")
        if (first := known.setdefault(tuple(cell.strip() for cell in cells), line)) != line:
            raise ValueError(f"{places[-1]}: the same vibration as in line {first}")
        if len(places) > MOST_LISTED:
            raise ValueError(f"{places[-1]}: more than {MOST_LISTED} vibrations")
        if any(cell.strip() for cell in cells[len(heading) :]):
            raise ValueError(f"{places[-1]}: {len(cells)} values for {len(heading)} columns")
        for name, (k, unit) in where.items():
            cell = cells[k].strip() if k < len(cells) else ""
            cell = _FORTRAN.sub(r"\1e", cell.replace(",", ".") if commas else cell)
            columns[name].append(_value(places[-1], name, cell, unit))
    return places, columns


def _heading(place: str, cells: list[str], shapes: tuple[str, ...]) -> Iterator[tuple[str, tuple[int, str]]]:
    """Column name → its number and unit."""
    seen: set[str] = set()
    for k, cell in enumerate(cells):
        match = HEADING.fullmatch(cell)
        name = "" if match is None else match[1].lower()
        if match is None or name not in (*COLUMNS, *shapes):
            if match is not None and name.startswith(("shape", "strain")):
                continue  # of a sensor that is not asked for
            hint = did_you_mean(name, COLUMNS) or f": {NEED}"
            raise ValueError(f"{place}: unknown column {shown(cell.strip())}{hint}")
        if name in seen:
            raise ValueError(f"{place}: there are two columns {name}")
        seen.add(name)
        if match[2]:
            _factor(f"{place}: {name}", name, match[2])
        yield name, (k, match[2] or "")
    _check_columns(place, seen, shapes)


def _check_columns(place: str, seen: set[str], shapes: tuple[str, ...], word: str = "column", need: str = NEED) -> None:
    """A ValueError unless there are frequencies, and shapes in one of two ways."""
    if "frequency" not in seen:
        raise ValueError(f"{place}: no {word} frequency: {need}")
    if "mass_normalised_shape" in seen and seen & {"modal_mass", "shape"}:
        raise ValueError(f"{place}: give mass_normalised_shape, or modal_mass and shape, not both")
    missing = {"modal_mass", "shape"} - seen
    if "mass_normalised_shape" not in seen and missing:
        raise ValueError(f"{place}: no {word} {min(missing)}: {need}")
    for name in shapes:
        if name not in seen:
            raise ValueError(f"{place}: no {word} {shown(name)}, which a sensor names")


def _factor(place: str, name: str, unit: str) -> float:
    """The SI value of a unit of a column."""
    unit = unit.strip()
    if name in ("frequency", "mass_normalised_shape"):
        known = _FREQUENCIES if name == "frequency" else _NORMALISED
        if unit.replace(" ", "") in known:
            return known[unit.replace(" ", "")]
        need = " or ".join(_FREQUENCIES) if name == "frequency" else "1/sqrt(kg), 1/sqrt(g) or 1/sqrt(t)"
        raise ValueError(f"{place}: the unit {shown(unit)} is not understood: {need} is needed")
    if name == "modal_mass":
        try:
            return to_si(f"1 {unit}", "mass")
        except ValueError as error:
            raise ValueError(f"{place}: {error}") from None
    if unit not in ("", "1", "-", "1/m")[: 4 if name.startswith("strain") else 3]:
        raise ValueError(f"{place}: the unit {shown(unit)} is not allowed: {name} is a plain number")
    return 1.0


def _value(place: str, name: str, cell: str, unit: str) -> float:
    """A cell in SI units; its unit is that of the heading, or beside the number."""
    number, _, own = cell.partition(" ")
    if own.strip() and unit:
        raise ValueError(f"{place}: {name} is {shown(cell)}, but the unit stands in the heading")
    unit = unit or own
    if not unit.strip() and name in ("frequency", "modal_mass", "mass_normalised_shape"):
        example = {"frequency": "Hz", "modal_mass": "kg"}.get(name, "1/sqrt(kg)")
        raise ValueError(
            f'{place}: {name} is {shown(cell)}, without a unit: a heading such as "{name} [{example}]" is needed'
        )
    try:
        value = to_si(number, "dimensionless")
    except ValueError:
        raise ValueError(f"{place}: {name} is {shown(cell)}, a number is needed") from None
    return value * _factor(f"{place}: {name}", name, unit)


def _netcdf(path: str, shapes: tuple[str, ...]) -> tuple[list[str], dict[str, list[float]], float | None]:
    """Where each vibration is, the variables in SI units, and the static compliance if the file has it."""
    most_named = 12  # most variables that a sentence lists
    import netCDF4

    try:
        check_hdf5(path)
    except ValueError as error:
        raise ValueError(f"{shown(path)} cannot be read as netCDF: {error}") from None
    try:
        with netCDF4.Dataset(path, "r") as file:
            found: dict[str, Any] = {
                name: _variable(path, file, name) for name in (*COLUMNS, *shapes) if name in file.variables
            }
            names = [shown(name) for name in file.variables]
            has = ", ".join([*names[:most_named], *["..."] * (len(names) > most_named)]) or "none"
            need = f"frequency, and modal_mass and shape or mass_normalised_shape, are needed; the file has {has}"
            static = None
            if "static_compliance" in file.variables:
                value = _numbers(path, file.variables["static_compliance"], "static_compliance")
                unit = str(getattr(file.variables["static_compliance"], "units", ""))
                static = to_si(f"{float(value.ravel()[0])!r} {unit}", "compliance")
    except (OSError, RuntimeError) as error:
        raise ValueError(f"{shown(path)} cannot be read as netCDF: {error}") from None
    _check_columns(shown(path), set(found), shapes, "variable", need)
    sizes = {name: len(values) for name, values in found.items()}
    if len(set(sizes.values())) > 1:
        raise ValueError(f"{shown(path)}: " + ", ".join(f"{size} values of {name}" for name, size in sizes.items()))
    return [f"{shown(path)}, vibration {k}" for k in range(1, sizes["frequency"] + 1)], found, static


def _variable(path: str, file: Any, name: str) -> list[float]:
    variable = file.variables[name]
    if len(variable.dimensions) != 1 or variable.size > MOST_LISTED:
        raise ValueError(f"{shown(path)}: {name} must have one dimension and at most {MOST_LISTED} values")
    unit = str(getattr(variable, "units", ""))
    place = f"{shown(path)}: {name}"
    if not unit and name in ("frequency", "modal_mass", "mass_normalised_shape"):
        raise ValueError(f"{place}: the attribute units is missing")
    return (_numbers(path, variable, name) * _factor(place, name, unit)).tolist()


def _numbers(path: str, variable: Any, name: str) -> Array:
    if variable.dtype is str or np.dtype(variable.dtype).kind not in "iuf" or variable.size == 0:
        raise ValueError(f"{shown(path)}: {name} must be numbers")
    return np.ma.filled(np.ma.asarray(variable[...], dtype=np.float64), np.nan)


def _listed(
    path: str, places: list[str], columns: dict[str, list[float]], static: float | None, shapes: tuple[str, ...]
) -> Listed:
    """The vibrations, checked and sorted."""
    if not places:
        raise ValueError(f"{shown(path)} has no vibrations")
    ranges = {"frequency": (0.0, 1e12), "modal_mass": (1e-28, 1e12), "damping_ratio": (0.0, 0.999)}
    for name, values in columns.items():
        low, high = ranges.get(name, (-1e15, 1e15))
        for place, value in zip(places, values, strict=True):
            if not low <= value <= high:  # or nan
                raise ValueError(f"{place}: {name} is {value:g}, from {low:g} to {high:g} is allowed")
    if "mass_normalised_shape" in columns:
        share = np.array(columns["mass_normalised_shape"]) ** 2
    else:
        share = np.array(columns["shape"]) ** 2 / np.array(columns["modal_mass"])
    frequency = np.array(columns["frequency"])
    moves = share > 1e-20 * share.max()
    if not moves.any():
        raise ValueError(f"{shown(path)}: every shape is 0 at the struck point: no vibration moves it")
    order = np.argsort(frequency, kind="stable")
    order = order[moves[order]]
    bent = order[frequency[order] > 0.0]
    damping = tuple(columns["damping_ratio"][k] for k in bent.tolist()) if "damping_ratio" in columns else ()
    struck = np.array(columns["mass_normalised_shape" if "mass_normalised_shape" in columns else "shape"])[order]
    there = {name: tuple((np.array(columns[name])[order] / struck).tolist()) for name in shapes}
    return Listed(tuple(frequency[order].tolist()), tuple((1 / share[order]).tolist()), damping or None, static, there)
