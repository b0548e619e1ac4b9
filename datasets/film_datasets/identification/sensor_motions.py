"""Measured motions of the sensors of a structure, from a CSV file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from film_datasets.csv_measurement import STANDARD_GRAVITIES, csv_rows, numbers, size_text, split_heading
from film_model.base.arrays import Array
from film_model.base.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.base.units import to_si
from film_model.solve.sensed import MOTION


class Motions(NamedTuple):
    """Motions of sensors at even times. begin, dt: s. names: of the sensors. quantities: "acceleration" and so on.
    values: SI, a row for each sensor."""

    begin: float
    dt: float
    names: list[str]
    quantities: list[str]
    values: Array


def sensor_motions(
    path: str | os.PathLike[str], sensors: Sequence[str], columns: Mapping[str, str] | None = None
) -> Motions:
    """Measured motions from a file as `from_csv` takes it: `time [us], corner [m/s^2], wall [g]`, with the sensors'
    names. The unit says whether it is a displacement, a velocity or an acceleration; `g` is 9.80665 m/s². columns: as
    of `from_csv`. Raises SceneError."""
    fewest_times, most_times = 20, 20_000
    file, _, head, headings, body = csv_rows(path, columns)
    found, mistakes = dict[str, tuple[str, str]](), list[Mistake]()
    for heading in headings:
        name, unit = split_heading(heading)
        key = "t" if name.lower() in ("t", "time") else _sensor(name, sensors)
        try:
            if key in found:
                raise ValueError("is given twice")
            found[key or heading] = _quantity(unit, ("time",) if key == "t" else tuple(MOTION))
            if key is None:
                hint = did_you_mean(name, sensors) or f": it has {', '.join(sensors)}"
                raise ValueError(f"is no sensor of the scene{hint}")
        except ValueError as error:
            mistakes.append(Mistake(file, head, "", f"column {shown(heading.strip())} {error}"))
    if "t" not in found:
        mistakes.append(Mistake(file, head, "", 'a column "time [us]" is needed'))
    elif len(found) == 1:
        mistakes.append(Mistake(file, head, "", f"a column of a sensor is needed: {', '.join(sensors)}"))
    raise_all(mistakes)
    units = {key: ("time" if key == "t" else MOTION[kind][0], unit) for key, (kind, unit) in found.items()}
    values = numbers(file, body, list(found), units)
    if not fewest_times <= len(body) <= most_times:
        what = f"{len(body)} times: {fewest_times} to {most_times} are allowed; keep those from before contact on"
        raise SceneError([Mistake(file, None, "", what)])
    times = values.pop("t")
    dt = float(times[-1] - times[0]) / (times.size - 1)
    # files round times: a tenth of their distance is allowed
    uneven = np.abs(times - times[0] - dt * np.arange(times.size)) > 0.1 * abs(dt)
    for key, one in {"t": np.where(uneven, np.nan, times), **values}.items():
        if (wrong := np.flatnonzero(~np.isfinite(one))).size or dt <= 0.0:
            what = "the times must be evenly spaced" if key == "t" else f"{shown(key)} has no value"
            raise SceneError([Mistake(file, body[int(wrong[0]) if wrong.size else 0][0], "", what)])
    names = list(values)
    return Motions(float(times[0]), dt, names, [found[name][0] for name in names], np.array([*values.values()]))


def _sensor(name: str, sensors: Sequence[str]) -> str | None:
    """The sensor that a heading names, whatever the case and with _ for spaces."""
    plain = {sensor.lower().replace(" ", "_"): sensor for sensor in sensors}
    return plain.get(name.lower().replace(" ", "_"))


def _quantity(unit: str, kinds: Sequence[str]) -> tuple[str, str]:
    """The quantity of `kinds` that has a unit, which may have a factor, and the unit."""
    unit = "standard_gravity" if unit in STANDARD_GRAVITIES else unit
    for kind in kinds:
        try:
            to_si(size_text(unit), MOTION[kind][0] if kind in MOTION else kind)
        except ValueError:
            continue
        return kind, unit
    raise ValueError(f"has the unit {shown(unit)}: that of a {' or '.join(kinds)} is needed")
