"""Sensors on a structure: points at which its motion is wanted beside the struck one."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

from film_model.base.errors import Mistake, raise_all, shown
from film_model.base.fields import Field, InUnits, build, entry, fill, items_of, measure, mistake, words
from film_model.base.units import Value
from film_model.targets.modes import Modes, Points

_PLACE = measure("length", 0, 1e5)


def _read_position(value: object) -> tuple[float, ...]:
    return tuple(_PLACE.read(item) for item in items_of(value) or [value])


def _read_shape(value: object) -> Any:
    if not (items := items_of(value)):
        return words("the name of a column of the modes file").read(value)
    return tuple(measure("dimensionless", -1e15, 1e15).read(item) for item in items)


def _read_strain(value: object) -> Any:
    if isinstance(value, str) or items_of(value):
        return _read_shape(value)
    if not isinstance(value, bool):
        raise ValueError(f"{shown(value)} is not allowed: {STRAIN}")
    return value


STRAIN = "true, or on a structure the name of a column of the modes file, is needed"


@dataclass(frozen=True, init=False, repr=False)
class Sensor(InUnits):
    """A point of a structure whose motion is wanted.

    name: in results. position: on a plate two distances from a corner, m; on a beam or rod one from its first or
    struck end. shape: on a structure the name of a column of the modes file, or for each vibration the deflection there
    over that at the struck point. strain: whether strains are wanted, at the face away from the impactor; on a
    structure the name of a column, or for each vibration the strain over the deflection at the struck point, 1/m.
    """

    name: str = entry(Field(words("a name").read, "a name is needed", required=True))
    position: tuple[float, ...] | None = entry(
        Field(_read_position, 'a length such as "20 mm", or a list of two, is needed', dimension="length")
    )
    shape: str | tuple[float, ...] | None = entry(
        Field(_read_shape, "the name of a column of the modes file is needed")
    )
    strain: bool | str | tuple[float, ...] = entry(Field(_read_strain, STRAIN))

    def __init__(
        self,
        name: str | None = None,
        position: Value | Sequence[Value] | None = None,
        shape: str | Sequence[float] | None = None,
        strain: bool | str | Sequence[float] = False,
    ) -> None:
        mistakes = fill(self, locals())
        if (position is None) == (shape is None):
            mistakes.append(mistake(self, "position", "give position, or shape on a structure of given vibrations"))
        raise_all(mistakes)


CURVATURES = {1: ((2.0,),), 2: ((2.0, 0.0), (0.0, 2.0), (1.0, 1.0))}
"""Orders of the derivatives of the deflection that are the curvatures of a line, and of a surface."""


def points_of(sensors: tuple[Sensor, ...] | None, across: tuple[float, ...] = ()) -> Points:
    """The points of sensors that have positions, m, and after them those of strains with the orders of derivatives.

    across: second distance of all, of a beam that is taken for a plate.
    """
    places = [(*cast("tuple[float, ...]", sensor.position), *across) for sensor in sensors or ()]
    strained = (place for place, sensor in zip(places, sensors or (), strict=True) if sensor.strain)
    return (*places, *((*place, *orders) for place in strained for orders in CURVATURES[len(place)]))


def with_strains(modes: Modes, sensors: tuple[Sensor, ...] | None) -> Modes:
    """The modes whose rows for strains, which follow those of the sensors, are apart."""
    count = len(sensors or ())
    return replace(modes, factor=modes.factor[:count], strain=modes.factor[count:])


def sensor_words(names: Iterable[str]) -> tuple[str, ...]:
    """Names of sensors as parts of names of variables: letters, digits and _, distinct from each other."""
    words = list[str]()
    for name in names:
        word = re.sub(r"\W", "_", name, flags=re.ASCII)
        words.append(word if word not in words else f"{word}_{len(words)}")
    return tuple(words)


def replaced(sensor: Sensor, shape: tuple[float, ...], strain: tuple[float, ...] | None = None) -> Sensor:
    """The sensor with its shape, and its strain if it has one, as numbers."""
    return Sensor(sensor.name, shape=shape, strain=strain or False)


def _read_sensors(value: object) -> tuple[Sensor, ...]:
    most_sensors = 100
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise ValueError(f"{shown(value)} is not allowed: {SENSORS.need}")
    if not 1 <= len(items := cast("Sequence[Any]", value)) <= most_sensors:
        raise ValueError(f"there are {len(items)} sensors: 1 to {most_sensors} are allowed")
    found = tuple(item if isinstance(item, Sensor) else build(Sensor, item) for item in items)
    names = [sensor.name for sensor in found]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two sensors are called {shown(name)}: each needs a name of its own")
    return found


def _write(sensors: tuple[Sensor, ...]) -> Any:
    given = ({"name": s.name, "position": s.position, "shape": s.shape, "strain": s.strain or None} for s in sensors)
    return [{key: _plain(key, value) for key, value in table.items() if value is not None} for table in given]


def _plain(key: str, value: Any) -> Any:
    if isinstance(value, str | bool):
        return value
    return [f"{number!r} m" if key == "position" else number for number in value]


SENSORS = Field(_read_sensors, "a list of sensors, each with name and position, is needed", write=_write)


def sensor_mistakes(
    owner: Any, sensors: tuple[Sensor, ...] | None, sides: tuple[float, ...] | None, singular: tuple[float, ...] = ()
) -> list[Mistake]:
    """Mistakes of sensors that are not on a plate, beam or rod with these sides, m. singular: the struck point of a
    plate, where the bending moment of plate theory is infinite."""
    if not sensors:
        return []
    if sides is None:
        return [mistake(owner, "sensors", "need a target with edges: an infinite one has no vibrations")]
    found: list[Mistake] = []
    thickness: float | None = owner.whole_thickness
    for sensor in sensors:
        if sensor.strain not in (True, False):
            found.append(mistake(owner, "sensors", f"{shown(sensor.name)}: strain = true is needed, not a column"))
        elif sensor.strain and thickness is None:
            wrong = f"{shown(sensor.name)}: strain needs a plate or a beam of known thickness"
            found.append(mistake(owner, "sensors", wrong))
        elif sensor.strain and thickness and len(sensor.position or ()) == len(singular):
            near = math.dist(sensor.position or (), singular)
            if singular and near < thickness:
                wrong = f"{shown(sensor.name)}: strain needs a distance of the thickness, {thickness:g} m, "
                wrong += f"from the contact, where the moment of plate theory is infinite, not {near:g} m"
                found.append(mistake(owner, "sensors", wrong))
        if sensor.position is None:
            found.append(mistake(owner, "sensors", f"{shown(sensor.name)}: a position is needed, not a shape"))
        elif len(sensor.position) != len(sides):
            need = "one distance is" if len(sides) == 1 else f"{len(sides)} distances are"
            wrong = f"{shown(sensor.name)}: {need} needed as position, not {len(sensor.position)}"
            found.append(mistake(owner, "sensors", wrong))
        else:
            off = [(x, side) for x, side in zip(sensor.position, sides, strict=True) if x > side]
            found += [
                mistake(owner, "sensors", f"{shown(sensor.name)}: {x:g} m is beyond the edge at {side:g} m")
                for x, side in off
            ]
    return found
