"""Sensors on a structure: points at which its motion is wanted beside the struck one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, cast

from film_model.base.errors import Mistake, raise_all, shown
from film_model.base.fields import Field, InUnits, build, fill, measure, mistake, words
from film_model.base.units import Value
from film_model.targets.modes import Points

MOST_SENSORS = 100

_PLACE = measure("length", 0, 1e5)


def _read_position(value: object) -> tuple[float, ...]:
    items = [value] if isinstance(value, str) or not isinstance(value, Sequence) else cast("Sequence[object]", value)
    return tuple(_PLACE.read(item) for item in items)


def _read_shape(value: object) -> Any:
    if isinstance(value, str) or not isinstance(value, Sequence):
        return words("the name of a column of the modes file").read(value)
    return tuple(measure("dimensionless", -1e15, 1e15).read(item) for item in cast("Sequence[object]", value))


@dataclass(frozen=True, init=False, repr=False)
class Sensor(InUnits):
    """A point of a structure whose motion is wanted.

    name: in results. position: on a plate two distances from a corner, m; on a beam or rod one from its first or
    struck end. shape: on a structure the name of a column of the modes file, or for each vibration the deflection there
    over that at the struck point.
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "name": Field(words("a name").read, "a name is needed", required=True),
        "position": Field(_read_position, 'a length such as "20 mm", or a list of two, is needed', dimension="length"),
        "shape": Field(_read_shape, "the name of a column of the modes file is needed"),
    }

    name: str
    position: tuple[float, ...] | None
    shape: str | tuple[float, ...] | None

    def __init__(
        self,
        name: str | None = None,
        position: Value | Sequence[Value] | None = None,
        shape: str | Sequence[float] | None = None,
    ) -> None:
        mistakes = fill(self, locals())
        if (position is None) == (shape is None):
            mistakes.append(mistake(self, "position", "give position, or shape on a structure of given vibrations"))
        raise_all(mistakes)


def points_of(sensors: tuple[Sensor, ...] | None) -> Points:
    """The points of sensors that have positions, m."""
    return tuple(cast("tuple[float, ...]", sensor.position) for sensor in sensors or ())


def sensor_words(names: Iterable[str]) -> tuple[str, ...]:
    """Names of sensors as parts of names of variables: letters, digits and _, distinct from each other."""
    words = list[str]()
    for name in names:
        word = re.sub(r"\W", "_", name, flags=re.ASCII)
        words.append(word if word not in words else f"{word}_{len(words)}")
    return tuple(words)


def replaced(sensor: Sensor, shape: tuple[float, ...]) -> Sensor:
    """The sensor with its shape as numbers."""
    return Sensor(sensor.name, shape=shape)


def _read_sensors(value: object) -> tuple[Sensor, ...]:
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise ValueError(f"{shown(value)} is not allowed: {SENSORS.need}")
    items = cast("Sequence[Any]", value)
    if not 1 <= len(items) <= MOST_SENSORS:
        raise ValueError(f"there are {len(items)} sensors: 1 to {MOST_SENSORS} are allowed")
    found = tuple(item if isinstance(item, Sensor) else build(Sensor, item) for item in items)
    names = [sensor.name for sensor in found]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"two sensors are called {shown(name)}: each needs a name of its own")
    return found


def _write(sensors: tuple[Sensor, ...]) -> Any:
    given = ({"name": s.name, "position": s.position, "shape": s.shape} for s in sensors)
    return [{key: _plain(key, value) for key, value in table.items() if value is not None} for table in given]


def _plain(key: str, value: Any) -> Any:
    if isinstance(value, str):
        return value
    return [f"{number!r} m" if key == "position" else number for number in value]


SENSORS = Field(_read_sensors, "a list of sensors, each with name and position, is needed", write=_write)


def sensor_mistakes(
    owner: object, sensors: tuple[Sensor, ...] | None, sides: tuple[float, ...] | None
) -> list[Mistake]:
    """Mistakes of sensors that are not on a plate, beam or rod with these sides, m."""
    if not sensors:
        return []
    if sides is None:
        return [mistake(owner, "sensors", "need a target with edges: an infinite one has no vibrations")]
    found: list[Mistake] = []
    for sensor in sensors:
        if sensor.position is None:
            found.append(mistake(owner, "sensors", f"{shown(sensor.name)}: a position is needed, not a shape"))
        elif len(sensor.position) != len(sides):
            wrong = f"{shown(sensor.name)}: the position has {len(sensor.position)} distances, {len(sides)} needed"
            found.append(mistake(owner, "sensors", wrong))
        else:
            off = [(x, side) for x, side in zip(sensor.position, sides, strict=True) if x > side]
            found += [
                mistake(owner, "sensors", f"{shown(sensor.name)}: {x:g} m is beyond the edge at {side:g} m")
                for x, side in off
            ]
    return found
