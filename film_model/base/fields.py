"""Fields of the objects a scene is made of: how each is read, checked and written.

Every such class has one table `FIELDS`, name → :class:`Field`, of the entries in its body. Its constructor and the
reader and writer of scene files use that table. The constructors take quantities and store SI floats.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from inspect import signature
from typing import Any, ClassVar, Protocol, TypeVar, cast

from film_model.base.errors import Mistake, SceneError, did_you_mean, nearest, raise_all, shown
from film_model.base.units import format_si, needed, scene_unit, to_si


@dataclass(frozen=True)
class Field:
    """One entry of a table. read: converts and checks a value. need: the message if a required entry is missing.

    low, high: range of a quantity, SI; with `open_ends`, the range excludes its ends. inside: names of
    the entries of a part. write: a stored value as a scene file contains it; default :func:`written`. width: reads a
    difference of two values, where this is not a quantity of the dimension. by_name: finds a part in a catalogue.
    """

    read: Callable[[object], Any]
    need: str
    required: bool = False
    dimension: str = "dimensionless"
    low: float | None = None
    high: float | None = None
    open_ends: bool = False
    inside: tuple[str, ...] = ()
    write: Callable[[Any], Any] | None = None
    width: Callable[[object], float] | None = None
    by_name: Callable[[str], Any] | None = None

    def read_width(self, value: object) -> float:
        """A difference of two values, such as a standard deviation or a tolerance, SI."""
        return to_si(value, self.dimension) if self.width is None else self.width(value)


class Part(Protocol):
    """A frozen dataclass with a table of its fields."""

    FIELDS: ClassVar[Mapping[str, Field]]


def entry(field: Field) -> Any:
    """An entry of a class, annotated with the type that is stored."""
    return field


class InUnits:
    """Shown with the entries that differ from their defaults, six digits and units, in place of the SI floats."""

    FIELDS: ClassVar[Mapping[str, Field]]

    def __init_subclass__(cls) -> None:
        own = {name: value for name, value in vars(cls).items() if isinstance(value, Field)}
        setattr(cls, "FIELDS", {**vars(cls).get("FIELDS", {}), **own})  # noqa: B010  # a class may give the table itself
        for name in own:
            delattr(cls, name)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self.shown_entries())})"

    def shown_entries(self) -> list[str]:
        """The entries of the table `FIELDS` as arguments of the constructor."""
        entries = signature(type(self)).parameters
        return [
            f"{name}={_in_units(value, field)}"
            for name, field in cast("Part", self).FIELDS.items()
            if (value := getattr(self, name)) not in (None, math.inf, "", entries[name].default)
        ]


def _in_units(value: Any, field: Field) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(_in_units(item, field) for item in cast('tuple[Any, ...]', value))})"
    if isinstance(value, float) and field.dimension != "dimensionless":
        return repr(format_si(value, field.dimension, 6))
    name = getattr(value, "name", None)
    if field.by_name is not None and name:
        with suppress(ValueError):
            return repr(name if value == field.by_name(name) else value)
    return repr(value)


AnyPart = TypeVar("AnyPart")


@dataclass(frozen=True)
class _Measure:
    """Reads a quantity within a range; a class, so that a sweep over it can be pickled."""

    dimension: str
    low: float
    high: float
    open_ends: bool

    def __call__(self, value: object) -> float:
        low, high, result = self.low, self.high, to_si(value, self.dimension)
        if result <= 0 <= low and not low == result == 0:
            raise ValueError(f"{shown(value)} must be {'>=' if low == 0 and not self.open_ends else '>'} 0")
        if not (low < result < high if self.open_ends else low <= result <= high):
            unit = scene_unit(self.dimension)
            if self.dimension == "angle":
                low, high, unit = math.degrees(low), math.degrees(high), "deg"
            between = "between" if self.open_ends else "from"
            and_ = "and" if self.open_ends else "to"
            raise ValueError(f"{shown(value)} is out of range: {between} {low:g} {and_} {high:g} {unit}".rstrip())
        return result


def measure(dimension: str, low: float, high: float, *, required: bool = False, open_ends: bool = False) -> Field:
    """A quantity between `low` and `high` in SI units, or strictly between them."""
    read = _Measure(dimension, low, high, open_ends)
    return Field(read, needed(dimension), required, dimension, low, high, open_ends)


def choice(*choices: str | bool) -> Field:
    """One of the given words, or true or false."""
    need = " or ".join(shown(c) for c in choices) + " is needed"

    def read(value: object) -> str | bool:
        for allowed in choices:
            if type(value) is type(allowed) and value == allowed:
                return allowed
        hint = did_you_mean(value, [c for c in choices if isinstance(c, str)]) if isinstance(value, str) else ""
        raise ValueError(f"{shown(value)} is not allowed: {need}{hint}")

    return Field(read, need, required=True)


def whole(low: int, high: int) -> Field:
    """A whole number from `low` to `high`."""
    need = f"a whole number from {low} to {high} is needed"

    def read(value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, numbers.Integral) or not low <= int(value) <= high:
            raise ValueError(f"{shown(value)} is not allowed: {need}")
        return int(value)

    return Field(read, need)


def words(what: str) -> Field:
    """A text."""

    def read(value: object) -> str:
        if not isinstance(value, str):
            raise ValueError(f"{shown(value)} is not a text, {what} is needed")
        return value

    return Field(read, f"{what} is needed", required=True)


def items_of(value: object) -> Sequence[object]:
    """The items of a list; none of what is no list."""
    return cast("Sequence[object]", value) if isinstance(value, Sequence) and not isinstance(value, str) else ()


def several(field: Field, count: int) -> Field:
    """A list of `count` values."""
    need = f"a list of {count} values is needed"

    def read(value: object) -> tuple[Any, ...]:
        if isinstance(value, str) or not isinstance(value, Sequence):
            raise ValueError(f"{shown(value)} is not a list: {need}")
        items = cast("Sequence[object]", value)
        if len(items) != count:
            raise ValueError(f"{shown(value)} has {len(items)} values: {need}")
        return tuple(field.read(item) for item in items)

    return Field(read, need, dimension=field.dimension)


def part(cls: type[AnyPart], *, required: bool = False, by_name: Callable[[str], AnyPart] | None = None) -> Field:
    """An object of class `cls`: itself, a table of its fields, or, with `by_name`, its name in a catalogue."""
    what = f"a {cls.__name__}" if by_name is None else f"a name from the catalogue or a {cls.__name__}"

    def read(value: object) -> AnyPart:
        if isinstance(value, cls):
            return value
        if isinstance(value, str) and by_name is not None:
            return by_name(value)
        if isinstance(value, Mapping):
            return build(cls, cast("Mapping[str, object]", value))
        raise ValueError(f"{shown(value)} is not allowed: {what} is needed")

    return Field(read, f"{what} is needed", required, inside=tuple(cast("type[Part]", cls).FIELDS), by_name=by_name)


def mistake(owner: object, name: str, message: str) -> Mistake:
    """A mistake in the entry `name` of an object."""
    return Mistake(None, None, f"{type(owner).__name__}.{name}", message)


def one_of(owner: object, **values: object) -> list[Mistake]:
    """The mistake of giving neither or both of two entries."""
    first, second = values
    given = [name for name, value in values.items() if value is not None]
    if len(given) == 1:
        return []
    message = f"give {first} or {second}, not both" if given else f"missing: {first} or {second} is needed"
    return [mistake(owner, second if given else first, message)]


def fill(target: object, values: Mapping[str, object]) -> list[Mistake]:
    """Read `values` by the table of `target` and store them on it; missing and wrong values are stored as None.

    `values` is `locals()` in the first line of a constructor, and may contain other names.
    """
    owner = type(target).__name__
    mistakes: list[Mistake] = []
    for name, field in cast("Part", target).FIELDS.items():
        value, result = values[name], None
        key = f"{owner}.{name}"
        if value is None:
            if field.required:
                mistakes.append(Mistake(None, None, key, f"missing: {field.need}"))
        else:
            try:
                result = field.read(value)
            except SceneError as error:
                mistakes += [mistake.moved(key) for mistake in error.mistakes]
            except ValueError as error:
                mistakes.append(Mistake(None, None, key, str(error)))
        object.__setattr__(target, name, result)
    return mistakes


DIAMETER = measure("length", 2e-10, 2e3)


def fill_ball(target: object, values: Mapping[str, object]) -> list[Mistake]:
    """As :func:`fill`, for a body that is given by its radius or by its diameter; the radius is stored."""
    diameter = values["diameter"]
    if diameter is None:
        mistakes = fill(target, values)
        return [one if values["radius"] is not None else _sized(one, target) for one in mistakes]
    mistakes = one_of(target, radius=values["radius"], diameter=diameter)
    radius = 1.0
    try:
        radius = 0.5 * DIAMETER.read(diameter)
    except ValueError as error:
        mistakes.append(mistake(target, "diameter", str(error)))
    return mistakes + fill(target, {**values, "radius": f"{radius!r} m"})


def _sized(missing: Mistake, ball: Any) -> Mistake:
    """A mistake; that of a missing radius with the diameter of a solid ball of the given mass and material."""
    density = getattr(ball.material, "density", None)
    if missing.key.rpartition(".")[2] != "radius":
        return missing
    if ball.mass is None or density is None or ball.shape not in (None, "solid"):
        return replace(missing, message=f"{missing.message}, or a diameter")
    size = format_si((6.0 * ball.mass / (math.pi * density)) ** (1.0 / 3.0), "length")
    of = f"{format_si(ball.mass, 'mass')} of {ball.material.name or 'this material'}"
    return replace(missing, message=f'{missing.message}, or a diameter: a ball of {of} has "{size}"')


def build(cls: type[AnyPart], table: Mapping[str, object]) -> AnyPart:
    """An object of class `cls` from a table such as a section of a scene file."""
    fields = cast("type[Part]", cls).FIELDS
    allowed = (*fields, "diameter") if getattr(cls, "is_ball", False) else tuple(fields)
    meant = {key: _meant(key, fields, allowed) for key in table if key not in allowed}
    mistakes = [
        Mistake(None, None, f"{cls.__name__}.{key_text(key)}", "unknown key" + _instead(key, near, fields, allowed))
        for key, near in meant.items()
    ]
    given = {near: table[key] for key, near in meant.items() if near}  # so that the entry is not missing, too
    try:
        result = cls(**given | {name: table[name] for name in allowed if name in table})
    except SceneError as error:
        mistakes += error.mistakes
        raise SceneError(mistakes) from None
    raise_all(mistakes)
    return result


SYNONYMS = {"speed": "velocity", "weight": "mass", "height": "drop_height", "elastic_modulus": "youngs_modulus"}
"""Words for entries that are not similar to them."""


def _meant(key: str, fields: Mapping[str, Field], allowed: Sequence[str]) -> str:
    """The entry that an unknown key may have meant; an empty text if there is none."""
    if SYNONYMS.get(key) in fields:
        return SYNONYMS[key]
    return "" if any(key in field.inside for field in fields.values()) else nearest(key, allowed)


def _instead(key: str, near: str, fields: Mapping[str, Field], allowed: Sequence[str]) -> str:
    """What an unknown key may have meant: another entry, or one of a part such as the material; else all entries."""
    if near:
        return f'; did you mean "{near}"?'
    name = next((name for name, field in fields.items() if key in field.inside), "")
    if name:
        return f"; it is an entry of {name}: {name} = {{ {key} = ..., ... }}"
    return f"; known are {', '.join(allowed)}"


def key_text(key: str) -> str:
    """A key as messages show it."""
    return key if key.replace("-", "_").isidentifier() and len(key) <= 80 else shown(key)


def table_of(source: object, whole: bool = False) -> dict[str, Any]:
    """The table from which :func:`build` makes the same object again, to the last bit. whole: parts such as a material
    stay objects."""
    table: dict[str, Any] = {}
    for name, field in cast("Part", source).FIELDS.items():
        value = getattr(source, name)
        if whole and hasattr(value, "FIELDS"):
            table[name] = value
        elif value is not None and value != math.inf and value != "":
            table[name] = written(value, field.dimension) if field.write is None else field.write(value)
    return table


def written(value: object, dimension: str) -> Any:
    """A stored value as a scene file contains it."""
    if hasattr(value, "FIELDS"):
        return table_of(value)
    if isinstance(value, tuple):
        return [written(item, dimension) for item in cast("tuple[object, ...]", value)]
    if isinstance(value, float) and dimension != "dimensionless":
        return f"{value!r} {scene_unit(dimension)}"
    return value
