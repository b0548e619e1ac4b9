"""The argument `over` of a sweep, or the section [over] of a sweep file, read as axes; every mistake is collected."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from film_datasets.sweeps.axis import Axis, label
from film_datasets.sweeps.designs import GRID, SAMPLED, ZIP
from film_datasets.sweeps.distributions import DISTRIBUTIONS, EMPIRICAL, read_distribution
from film_model.base.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.base.fields import Field, table_of, written
from film_model.base.units import array_to_si, to_si
from film_model.scene import Scene
from film_model.scene.contact import contact_table
from film_model.scene.paths import field_at, refuse_twice, unit_of
from film_model.scene.toml import WITH_FILES

SPACINGS = ("linear", "log")
RANGE = ("from", "to", "count", "spacing")
FORMS = (*RANGE, *DISTRIBUTIONS, EMPIRICAL)
"""Keys of a table that describes a swept number."""

SECTIONS = {
    "contact.law": '"contact" = [{ law = "hertz" }, { law = "hunt-crossley", restitution = 0.7 }]',
    "target.kind": '"target" = [{ kind = "half-space", material = "mild steel" }, '
    '{ kind = "plate", material = "mild steel", thickness = "4 mm" }]',
}
"""Choices that decide which other keys their section has, each with an example that lists whole sections instead."""


def read_axes(scene: Scene, over: Mapping[str, Any], design: str) -> tuple[tuple[Axis, ...], Scene]:
    """The axes of a sweep over a scene, and the scene with the first choice of each axis that has choices.

    Raises SceneError with all mistakes; their keys begin with "over".
    """
    if not over:
        raise SceneError([Mistake(None, None, "over", "missing: at least one swept quantity is needed")])
    mistakes: list[Mistake] = []
    first = scene
    for path, given in over.items():  # choices first: they may decide which numbers the scene has
        if isinstance(given, Sequence) and not isinstance(given, str) and any(map(_is_choice, given)):
            try:
                first = first.replace({path: given[0]})
            except SceneError as error:
                mistakes += swept_mistakes(error, (path,))
    axes: dict[str, Axis] = {}
    for path, given in over.items():
        try:
            axes[path] = _axis(first, path, given, design)
            refuse_twice(first, path, over)
        except SceneError as error:
            mistakes += error.mistakes
        except ValueError as error:
            mistakes.append(Mistake(None, None, f"over.{path}", str(error)))
    mistakes += _clashes(axes)
    raise_all(list(dict.fromkeys(mistakes)))
    if design == ZIP and len({axis.count for axis in axes.values()}) > 1:
        lengths = ", ".join(f"{axis.path} {axis.count}" for axis in axes.values())
        raise SceneError([Mistake(None, None, "over", f'design "zip" needs lists of one length, not {lengths}')])
    return tuple(axes.values()), first


def _clashes(axes: Mapping[str, Axis]) -> list[Mistake]:
    """Axes of which two have the same name in a dataset, or one is a section and another an entry of it."""
    named = {axis.name: axis.path for axis in axes.values()}
    mistakes = [
        Mistake(None, None, f"over.{path}", f"is called {axis.name} in datasets, as {named[axis.name]} is")
        for path, axis in axes.items()
        if named[axis.name] != path
    ]
    for path, other in itertools.permutations(axes, 2):
        if other.startswith(path + "."):
            mistakes.append(Mistake(None, None, f"over.{other}", f"is part of {path}, which is swept too"))
    return mistakes


def swept_mistakes(error: SceneError, choices: Iterable[str]) -> list[Mistake]:
    """The mistakes of a scene as mistakes of a sweep.

    choices: paths of axes with choices; where one of them leaves keys of its section that do not fit, the message
    shows how to list whole sections.
    """
    found = [replace(mistake, key=f"over.{mistake.key}") for mistake in error.mistakes]
    for path in choices:
        section = path.partition(".")[0]
        if path in SECTIONS and any(m.key.startswith(f"{section}.") and m.key != path for m in error.mistakes):
            message = f"not all of these go with the same other keys: list whole sections, e.g. {SECTIONS[path]}"
            found.append(Mistake(None, None, f"over.{path}", message))
    return found


def _axis(scene: Scene, path: str, given: Any, design: str) -> Axis:
    field = field_at(scene, path)
    if isinstance(given, Mapping):
        if field is None:
            raise ValueError("is not a number: a list of values is needed")
        return _range_or_distribution(path, field, given, design, unit_of(scene, field))
    if isinstance(given, str) and "±" in given and field is not None:
        return _tolerance(path, field, given, design, unit_of(scene, field))
    if isinstance(given, str) or (not hasattr(given, "__len__") and not hasattr(given, "magnitude")):
        raise ValueError(f"{shown(given)} is one value: a list of values or a table with from and to is needed")
    if field is None:
        return _choices(scene, path, given, design)
    if isinstance(given, np.ndarray) or hasattr(given, "magnitude"):
        values = np.atleast_1d(array_to_si(given, field.dimension)).ravel().tolist()
        numbers = [field.read(written(value, field.dimension)) for value in values]  # a Meyer stiffness is read as text
    else:
        numbers = [field.read(value) for value in given]
    if not numbers:
        raise ValueError("an empty list: at least one value is needed")
    if design == GRID:
        steps = np.diff(numbers)
        if not ((steps > 0).all() or (steps < 0).all()):
            raise ValueError('a grid needs values that increase or decrease throughout; design "zip" takes any order')
    unit = unit_of(scene, field)
    return Axis(path, "values", tuple(numbers), count=len(numbers), dimension=field.dimension, unit=unit, field=field)


def _choices(scene: Scene, path: str, given: Iterable[Any], design: str) -> Axis:
    choices: list[Any] = []
    indices: list[int] = []
    for choice in given:
        if choice not in choices:
            choices.append(choice)
        indices.append(choices.index(choice))
    if not choices:
        raise ValueError("an empty list: at least one value is needed")
    for k, choice in enumerate(choices):
        tabulated = path in WITH_FILES and isinstance(choice, Mapping) and "file" in choice
        if design == ZIP and not tabulated:
            continue  # it may be valid only with the other choices of its impact: `Sweep` tries those together
        try:
            changed = scene.replace({path: choice})
        except SceneError as error:
            raise SceneError(swept_mistakes(error, (path,))) from None
        if tabulated:  # a dataset stores the table, not the name of its file
            own = {key: value for key, value in choice.items() if key != "file"}
            choices[k] = own | {key: value for key, value in _tables(changed, path).items() if key not in own}
    for k, choice in enumerate(choices):
        if design == GRID and indices.count(k) > 1:
            raise ValueError(f"{label(choice)} is given {indices.count(k)} times; each value once")
    return Axis(path, "choices", choices=tuple(choices), indices=tuple(indices), count=len(indices))


def _tables(scene: Scene, path: str) -> dict[str, Any]:
    """What was read from the file that a section of the scene named."""
    if path == "target":
        return table_of(scene.target)
    table = contact_table(scene.contact)
    return {key: table[key] for key in scene.contact.parameters}


def _range_or_distribution(path: str, field: Field, given: Mapping[str, Any], design: str, unit: str) -> Axis:
    unknown = [key for key in given if key not in FORMS]
    if unknown:
        raise ValueError(f"unknown key {shown(unknown[0])}{did_you_mean(unknown[0], FORMS)}")
    chosen = [key for key in given if key not in RANGE]
    if not chosen:
        return _range(path, field, given, design, unit)
    if len(given) > 1:
        raise ValueError(f"give {chosen[0]} alone")
    if design not in SAMPLED:
        raise ValueError(f'a distribution needs design {_or(SAMPLED)}, not "{design}"')
    numbers = read_distribution(chosen[0], given[chosen[0]], field)
    return Axis(path, chosen[0], numbers, dimension=field.dimension, unit=unit, field=field)


def _range(path: str, field: Field, given: Mapping[str, Any], design: str, unit: str) -> Axis:
    missing = [key for key in ("from", "to", *(() if design in SAMPLED else ("count",))) if key not in given]
    if missing:
        raise ValueError(f"missing: {' and '.join(missing)}")
    low, high = field.read(given["from"]), field.read(given["to"])
    count, spacing = given.get("count", 0), given.get("spacing", "linear")
    if spacing not in SPACINGS:
        raise ValueError(f"spacing {shown(spacing)} is not allowed: {_or(SPACINGS)} is needed")
    if spacing == "log" and not (low > 0.0 and high > 0.0):
        raise ValueError("spacing log needs from and to > 0")
    if low == high:
        raise ValueError("from and to are the same")
    if design in SAMPLED:
        if "count" in given:
            raise ValueError(f'count is not for design "{design}", which takes samples')
    elif isinstance(count, bool) or not isinstance(count, int) or count < 2:
        raise ValueError(f"count {shown(count)} is not allowed: a whole number, 2 or more, is needed")
    log = spacing == "log"
    return Axis(path, "range", (low, high), count=count, log=log, dimension=field.dimension, unit=unit, field=field)


def _tolerance(path: str, field: Field, text: str, design: str, unit: str) -> Axis:
    """A value with a tolerance, "10 mm ± 0.05 mm" or "10 mm ± 1 %": uniform between its limits."""
    if design not in SAMPLED:
        raise ValueError(f'a tolerance needs design {_or(SAMPLED)}, not "{design}"')
    value, _, width = (part.strip() for part in text.partition("±"))
    middle = field.read(value)
    try:
        half = (
            abs(middle) * to_si(width[:-1], "dimensionless") / 100 if width.endswith("%") else field.read_width(width)
        )
    except ValueError as error:
        raise ValueError(f"the tolerance {error}") from None
    if not half > 0.0:
        raise ValueError(f"the tolerance {shown(width)} must be > 0")
    numbers = tuple(field.read(written(end, field.dimension)) for end in (middle - half, middle + half))
    return Axis(path, "uniform", numbers, dimension=field.dimension, unit=unit, field=field)


def _is_choice(value: Any) -> bool:
    """Whether a value cannot be a number with a unit."""
    return isinstance(value, bool | Mapping) or (isinstance(value, str) and not re.match(r"\s*[+-]?\.?[0-9]", value))


def _or(words: Sequence[str]) -> str:
    *most, last = (f'"{word}"' for word in words)
    return f"{', '.join(most)} or {last}"
