"""Measurements in CSV files, whose headings have units, as datasets."""

from __future__ import annotations

import csv
import hashlib
import math
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from film_datasets.provenance import dataset_of
from film_datasets.schema import FORCE_INTERVAL, MEASURED_CONDITIONS, MEASUREMENT, TABLE, Variable
from film_model.base.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.base.foreign import Dataset
from film_model.base.units import DIMENSIONS, to_si
from film_model.oblique.result import OBLIQUE
from film_model.scene import STANDARD_GRAVITY
from film_model.scene.toml import LARGEST_TABLE, read_text

NAMES = {
    **{"time": "t", "force": "contact_force", "velocity": "impactor_velocity", "displacement": "impactor_displacement"},
    **{"restitution": "coefficient_of_restitution", "e": "coefficient_of_restitution"},
    **{"acceleration": "impactor_acceleration", "angle": "impactor_angle", "spin": "impactor_spin"},
}
"""Short names of columns, and the variables they stand for."""


class Converted(NamedTuple):
    """A column that is stored as another quantity: the variable, the dimension of the cells, and the conversion, SI."""

    variable: str
    dimension: str
    convert: Callable[[Any], Any]
    what: str


CONVERTED = {
    "drop_height": Converted(
        *("impactor_velocity", "length", lambda height: np.sqrt(2.0 * STANDARD_GRAVITY * height)),
        "of a fall from rest, instead of the velocity",
    ),
    "rebound_height": Converted(
        *("rebound_velocity", "length", lambda height: -np.sqrt(2.0 * STANDARD_GRAVITY * height)),
        "to which the impactor rises afterwards",
    ),
    "deceleration": Converted("impactor_acceleration", "acceleration", np.negative, "positive during contact"),
}
"""Columns that are converted as they are read."""

SIGNED = (
    *("rebound_velocity", "permanent_indentation", "energy_absorbed", "energy_radiated", "impulse"),
    *("impactor_spin", *OBLIQUE),
)
"""Values of impacts that may be negative: a rebound is, and small ones with noise. The others are sizes."""

STANDARD_GRAVITIES = ("g", "G", "gn", "g0")
"""Words for the unit 9.80665 m/s² of accelerations, which elsewhere are grams or not known."""

_HEADING = re.compile(r"\s*([^\[(]+?)\s*(?:\[([^\]]*)\]|\(([^)]*)\))?\s*")

_FACTOR = re.compile(r"[+-]?[0-9.]")

_PLAIN = {"-": "", "1": "", "%": "0.01"}
"""Units of a number without dimension, and their sizes."""


def from_csv(path: str | os.PathLike[str], title: str = "", columns: Mapping[str, str] | None = None) -> Dataset:
    """A measured history, or measured impacts at several velocities, as a dataset of kind impact_measurement, SI.

    The first line that is not a comment (#) has the names of the columns, each with its unit: `time [us], force [kN]`
    and any other quantity of a history; or `velocity [m/s], restitution` and any other summary quantity. Impacts at an
    angle or with spin have `angle [deg]` or `spin [rpm]` too, and results such as `tangential_restitution`,
    `rebound_angle [deg]` or `rebound_spin [rad/s]`, whose sign is positive if the spin adds to sliding. The units may
    be a row of their own below it. Times count from first touch (an offset can be fitted, see `identify`). Cells may be
    empty, except times and velocities. Columns are separated by commas, semicolons or tabs; numbers have a decimal
    point. `acceleration [g]` is that of an accelerometer on the impactor, positive into the target; `deceleration` the
    opposite. `drop_height` and `rebound_height` are stored as the velocities √(2 g h) of a fall without drag.

    columns: headings of the file for the quantities that are to be read, {"time": "t [us]", "force": "CH1 [2.2 kN]"}; a
    unit there replaces that in the file, and may have the factor of a sensor. Other columns, and lines before the
    heading, such as those of an oscilloscope, are then ignored.

    Raises SceneError with all mistakes and their lines.

    >>> fd.from_csv("measured.csv").impactor_velocity.values
    array([0.2, 0.5, 1. ])
    """
    rows = csv_rows(path, columns)
    name, text, _, headings, body = rows
    kind = "history" if "t" in map(_variable, headings) else "impacts"
    known = {variable.name: variable for variable in TABLE[f"{MEASUREMENT} {kind}"]}
    values = values_of(rows, known)
    for one in (CONVERTED[_name(heading)] for heading in headings if _name(heading) in CONVERTED):
        if one.dimension == "length" and (wrong := np.flatnonzero(values[one.variable] < 0)).size:
            raise SceneError([Mistake(name, body[int(wrong[0])][0], "", "a height must not be negative")])
        values[one.variable] = one.convert(values[one.variable])
    along = next(iter(known))
    if kind == "impacts":
        _check_sizes(name, [line for line, _ in body], values, known, along)
    return _dataset(Path(name), text, title, kind, values, known, along)


class Rows(NamedTuple):
    """A file's name and text, the line of its heading, the headings, and the cells of each row with their line."""

    name: str
    text: str
    head: int
    headings: list[str]
    body: list[tuple[int, list[str]]]


def csv_rows(path: str | os.PathLike[str], columns: Mapping[str, str] | None = None) -> Rows:
    """The heading with units, and the rows, of a file as `from_csv` takes it. Raises SceneError."""
    text, name = read_text(path, LARGEST_TABLE)
    lines = enumerate(text.splitlines(), 1)
    numbered = [(number, line) for number, line in lines if line.strip() and line.lstrip()[0] != "#"]
    cells = _chosen_columns(name, numbered, columns) if columns else _cells(numbered)
    if len(cells) < 3:
        raise SceneError([Mistake(name, None, "", "a heading and at least two rows of numbers are needed")])
    if not any(row[-1].strip() for _, row in cells):  # every line ends with a separator
        cells = [(number, row[:-1]) for number, row in cells]
    (head, headings), body = cells[0], cells[1:]
    if not any(split_heading(heading)[1] for heading in headings) and not any(map(_is_number, body[0][1])):
        headings, body = (
            [f"{one} [{unit.strip(' []()')}]" for one, unit in zip(headings, body[0][1], strict=False)],
            body[1:],
        )
    return Rows(name, text, head, headings, body)


def values_of(rows: Rows, known: Mapping[str, Variable]) -> dict[str, np.ndarray]:
    """The numbers of each column, SI. known: the variables that columns may have, of which the first is needed. Raises
    SceneError for wrong columns, units and cells, and a time that does not increase."""
    names = [_variable(heading) for heading in rows.headings]
    units = _columns(rows.name, rows.head, rows.headings, names, known)
    values = numbers(rows.name, rows.body, names, units)
    late = np.flatnonzero(~(np.diff(values.get("t", np.zeros(0))) > 0))
    if late.size:
        raise SceneError([Mistake(rows.name, rows.body[int(late[0]) + 1][0], "", "the time does not increase")])
    return values


def doubts_of(ds: Dataset) -> list[str]:
    """Sentences on measured impacts that leave faster than they came, or into the target."""
    doubts: list[str] = []
    if "coefficient_of_restitution" in ds and float(ds["coefficient_of_restitution"].max()) > 1.0:
        most = float(ds["coefficient_of_restitution"].max())
        doubts.append(f"the measured restitution is up to {most:.3g}: above 1 an impact gains energy")
    if "rebound_velocity" in ds:
        rebound, velocity = ds["rebound_velocity"].values, ds["impactor_velocity"].values
        if (faster := rebound < -velocity).any():
            most = float((-rebound[faster] / velocity[faster]).max())
            doubts.append(f"the measured rebound is up to {most:.3g} times as fast as the impact, which gains energy")
        if (rebound[np.isfinite(rebound)] > 0).all():
            doubts.append('no measured rebound_velocity is negative, as a rebound is: the unit "-1 m/s" turns the sign')
    return doubts


def measured_over(ds: Dataset) -> tuple[str, list[str]]:
    """The variable over which a measurement was made ("t", "impactor_velocity" or, if they were made at several angles,
    "impactor_angle"), and the measured variables."""
    if ds.attrs["measured"] == "history":
        return "t", [str(name) for name in ds.data_vars if name != "t"]
    angles = ds["impactor_angle"].values if "impactor_angle" in ds.variables else np.zeros(1)
    along = "impactor_angle" if np.ptp(angles) > 0.0 else "impactor_velocity"
    return along, [str(name) for name in ds.data_vars if name not in MEASURED_CONDITIONS]


def _given(along: str) -> tuple[str, ...]:
    """Variables that are not measured: the time of a history and an interval, the conditions of impacts."""
    return (along, *FORCE_INTERVAL) if along == "t" else MEASURED_CONDITIONS


def split_heading(heading: str) -> tuple[str, str]:
    """The name and the unit of a heading such as `time [us]`; the unit may be empty."""
    match = _HEADING.fullmatch(heading)
    return (match[1].strip(), (match[2] or match[3] or "").strip()) if match else (heading.strip(), "")


def _name(heading: str) -> str:
    return split_heading(heading)[0].lower().replace(" ", "_")


def _variable(heading: str) -> str:
    """The variable in which a column is stored."""
    name = _name(heading)
    return CONVERTED[name].variable if name in CONVERTED else NAMES.get(name, name)


def _cells(numbered: Sequence[tuple[int, str]]) -> list[tuple[int, list[str]]]:
    """The cells of lines, separated as in the first of them."""
    separator = max(",;\t", key=numbered[0][1].count) if numbered else ","
    return [(number, next(csv.reader([line], delimiter=separator))) for number, line in numbered]


def _chosen_columns(
    file: str, numbered: list[tuple[int, str]], columns: Mapping[str, str]
) -> list[tuple[int, list[str]]]:
    """The cells from the heading on, of the chosen columns only and under their quantities' names.

    The heading is the first line that has all these columns. Rows without a number may follow it, first that of units.
    """
    wanted = {quantity: split_heading(heading) for quantity, heading in columns.items()}
    for place, (number, _) in enumerate(numbered):
        cells = [cell.strip() for cell in _cells(numbered[place : place + 1])[0][1]]
        names = [split_heading(cell)[0] for cell in cells]
        if not all(name in names or name in cells for name, _ in wanted.values()):
            continue
        places = [(cells if name in cells else names).index(name) for name, _ in wanted.values()]
        rows = _cells(numbered[place:])[1:]
        first = next((k for k, (_, row) in enumerate(rows) if any(map(_is_number, row))), len(rows))
        below = [*(rows[0][1] if first else ()), *[""] * len(cells)]  # a row of units
        own = [split_heading(cells[k])[1] or below[k].strip(" []()") for k in places]
        units = [unit or mine for (_, unit), mine in zip(wanted.values(), own, strict=True)]
        heading = [f"{name} [{unit}]" for name, unit in zip(wanted, units, strict=True)]
        picked = ((n, [row[k].strip() if k < len(row) else "" for k in places]) for n, row in rows[first:])
        return [(number, heading), *picked]
    missing = ", ".join(shown(heading) for heading in columns.values())
    number, longest = max(numbered, key=lambda one: len(re.findall(r"[A-Za-z]\w*", one[1])), default=(None, ""))
    hint = f"; line {number} has {shown(longest.strip())}" if longest else ""
    raise SceneError([Mistake(file, None, "", f"no line has the columns {missing}{hint}")])


def size_text(unit: str) -> str:
    """What a cell of 1 means: the unit may have a factor, such as "2.2 kN" for the volts of a sensor."""
    return unit if _FACTOR.match(unit) else f"1 {unit}"


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _columns(
    file: str, line: int, headings: list[str], names: list[str], known: Mapping[str, Variable]
) -> dict[str, tuple[str, str]]:
    """Dimension and unit of each column."""
    mistakes: list[Mistake] = []
    columns: dict[str, tuple[str, str]] = {}
    for heading, name in zip(headings, names, strict=True):
        if name not in known:
            mistakes.append(Mistake(file, line, "", f"column {shown(heading.strip())} {_why_unknown(name, known)}"))
            continue
        if name in columns:
            mistakes.append(Mistake(file, line, "", f"column {shown(heading.strip())} is given twice"))
        unit = split_heading(heading)[1]
        dimension = next(key for key, value in DIMENSIONS.items() if value.unit == known[name].unit)
        if _name(heading) in CONVERTED:
            dimension = CONVERTED[_name(heading)].dimension
        if dimension == "acceleration" and unit in STANDARD_GRAVITIES:
            unit = "standard_gravity"
        if dimension == "dimensionless":
            unit = _PLAIN.get(unit, unit)
        try:
            to_si(size_text(unit), dimension)
        except ValueError as error:
            what = str(error).replace(f'"1 {unit}"', f"unit {shown(unit)}" if unit else "").lstrip(": ")
            mistakes.append(Mistake(file, line, "", f"column {shown(heading.strip())}: {what}"))
        columns[name] = dimension, unit
    along, *others = known
    if along not in names:
        what = 'a column "time [us]", "velocity [m/s]" or "drop_height [mm]" is needed'
        mistakes.append(Mistake(file, line, "", what))
    elif set(names) <= {*_given(along)}:
        mistakes.append(Mistake(file, line, "", f"a column beside {along} is needed: {', '.join(others)}"))
    if not set(names) <= set(known):
        what = 'give the headings of another program by --columns (in Python columns): velocity="v_in [mm/s]" and so on'
        mistakes.append(Mistake(file, line, "", f"{what}; known are {', '.join((*NAMES, *CONVERTED, *known))}"))
    raise_all(mistakes)
    return columns


def _why_unknown(name: str, known: Mapping[str, Variable]) -> str:
    """What is wrong with a column that measurements of this kind have not."""
    other = ("impacts", "impacts at several velocities") if "t" in known else ("history", "a history over time")
    if name in {variable.name for variable in TABLE[f"{MEASUREMENT} {other[0]}"]}:
        return f"is of {other[1]}, which this is not"
    return f"is not known{did_you_mean(name, [*known, *NAMES, *CONVERTED])}"


def numbers(
    file: str, body: list[tuple[int, list[str]]], names: list[str], columns: dict[str, tuple[str, str]]
) -> dict[str, np.ndarray]:
    """The numbers of each column, SI. columns: dimension and unit of each. Raises SceneError for wrong cells."""
    mistakes: list[Mistake] = []
    table = np.full((len(body), len(names)), math.nan)
    for row, (line, cells) in enumerate(body):
        if len(cells) != len(names):
            mistakes.append(Mistake(file, line, "", f"{len(cells)} cells, but {len(names)} columns"))
            continue
        for column, cell in enumerate(cells):
            if not cell.strip() and names[column] not in ("t", *MEASURED_CONDITIONS):
                continue
            try:
                table[row, column] = float(cell)
                finite = math.isfinite(table[row, column])
            except ValueError:
                finite = False
            if not finite:
                hint = ": write a decimal point" if "," in cell else ""
                mistakes.append(
                    Mistake(file, line, "", f"{names[column]}: {shown(cell.strip())} is not a number{hint}")
                )
    raise_all(mistakes[:20])
    sizes = [to_si(size_text(unit), dimension) for dimension, unit in (columns[name] for name in names)]
    return {name: table[:, k] * sizes[k] for k, name in enumerate(names)}


def _check_sizes(
    file: str, lines: list[int], values: dict[str, np.ndarray], known: dict[str, Variable], along: str
) -> None:
    """Raise SceneError for values of impacts that no impact can have."""
    mistakes: list[Mistake] = []
    if (wrong := np.flatnonzero(~(values[along] > 0))).size:
        mistakes.append(Mistake(file, lines[int(wrong[0])], "", "the velocity must be > 0"))
    for name, array in values.items():
        if name not in (along, *SIGNED) and (wrong := np.flatnonzero(array < 0)).size:
            unit = known[name].unit
            value, turn = f"{array[wrong[0]]:g} {unit}", f'; "-1 {unit}" as the unit of the column turns the sign'
            what = f"{value.removesuffix(' 1')} is not allowed: it is never negative{turn if unit != '1' else ''}"
            mistakes.append(Mistake(file, lines[int(wrong[0])], "", f"{name}: {what}"))
    raise_all(mistakes)


def _dataset(
    path: Path, text: str, title: str, kind: str, values: dict[str, np.ndarray], known: Iterable[str], along: str
) -> Dataset:
    given = [name for name in known if name in values and name in _given(along)]
    measured = ", ".join(name for name in known if name in values and name not in given)
    about = {
        "title": title or f"Measurement {path.stem}",
        "summary": f"Measured {measured} of "
        + ("one impact over time." if kind == "history" else "impacts at several velocities."),
        "source": f"measurement, from the file {path.name}",
        "command": "film_datasets.from_csv",
        "comment": "Empty cells of the file are NaN. measurement_sha256 is of the file's text.",
    }
    own = {"measured": kind, "measurement_sha256": hashlib.sha256(text.encode()).hexdigest()}
    return dataset_of(MEASUREMENT, values, about, own, f"{MEASUREMENT} {kind}", coordinates=given)
