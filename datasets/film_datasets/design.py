"""What a sweep varies, and how its impacts are laid out: the numbers of any impact from its place in the design."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
import threading
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.schema import Variable, swept_name, swept_variable
from film_model.contact import Contact, contact_table, parameter_fields, stiffness_unit
from film_model.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.fields import Field, written
from film_model.scene import Scene
from film_model.units import array_to_si, scene_unit, si_unit, to_si

Array = NDArray[np.float64]

GRID, ZIP = "grid", "zip"
SAMPLED = ("random", "sobol", "latin-hypercube")
DESIGNS = (GRID, ZIP, *SAMPLED)

SPACINGS = ("linear", "log")
DISTRIBUTIONS = {
    "normal": "mean and standard deviation",
    "lognormal": "mean and standard deviation",
    "uniform": "least and greatest value",
}
RANGE = ("from", "to", "count", "spacing")

MOST_CASES = 10_000
MOST_SAMPLES = {"random": 2**53, "sobol": 2**30, "latin-hypercube": 20_000_000}
"""Rows a design can have; a Latin hypercube is a permutation, held in memory."""

LEAST = 2.0**-53
"""Probabilities below this are taken for it, so that no design draws an infinite value: 8.1 standard deviations."""

SECTIONS = {
    "contact.law": '"contact" = [{ law = "hertz" }, { law = "hunt-crossley", restitution = 0.7 }]',
    "target.kind": '"target" = [{ kind = "half-space", material = "mild steel" }, '
    '{ kind = "plate", material = "mild steel", thickness = "4 mm" }]',
}
"""Words that decide which other keys their section has, each with a list of whole sections instead."""

LISTED = 1000
"""Longer lists of values are in the coordinates of a dataset only, not in its sweep_toml."""


@dataclass(frozen=True)
class Axis:
    """One swept quantity. kind: "values" (SI), "range", a distribution, or "words" (anything that is no number).

    numbers: the values, or the two numbers of a range or distribution, SI; unit: theirs, as scene files write it.
    words: each once, places: which of them follow each other. field: the scene's, None for words.
    """

    path: str
    kind: str
    numbers: tuple[float, ...] = ()
    words: tuple[Any, ...] = ()
    places: tuple[int, ...] = ()
    count: int = 0
    log: bool = False
    dimension: str = "dimensionless"
    unit: str = ""
    field: Field | None = None

    @property
    def name(self) -> str:
        """Of its variable in datasets."""
        return swept_name(self.path)

    @property
    def labels(self) -> tuple[str, ...]:
        """The words as texts; sections of one name with their numbers."""
        short = [_label(word) for word in self.words]
        return tuple(_label(word, short.count(label) > 1) for word, label in zip(self.words, short, strict=True))

    def variable(self, dims: tuple[str, ...]) -> Variable:
        """The row of the schema's table."""
        unit = None if self.dimension == "meyer_stiffness" else si_unit(self.dimension)
        return swept_variable(self.path, dims, unit, self.labels)

    def at(self, index: NDArray[np.intp]) -> Array | NDArray[np.int32]:
        """Values at places along the axis: SI, or numbers of words."""
        if self.kind == "words":
            return np.asarray(self.places, np.int32)[index]
        if self.kind == "values":
            return np.asarray(self.numbers)[index]
        low, high = self.numbers
        return self._between(index / max(self.count - 1, 1), low, high)

    def quantile(self, u: Array) -> Array | NDArray[np.int32]:
        """Values at probabilities: SI, or numbers of words."""
        if self.kind in ("words", "values"):
            return self.at(np.minimum((u * self.count).astype(np.intp), self.count - 1))
        low, high = self.numbers
        if self.kind in ("range", "uniform"):
            return self._between(u, low, high)
        from scipy.special import ndtri

        deviation = ndtri(np.maximum(u, LEAST))
        if self.kind == "normal":
            return low + high * deviation
        spread = math.log1p((high / low) ** 2)  # variance of the logarithm
        return low * np.exp(math.sqrt(spread) * deviation - 0.5 * spread)

    def _between(self, part: Array, low: float, high: float) -> Array:
        """From low to high, both exact."""
        if self.log:
            return np.where(part == 1.0, high, low * (high / low) ** part)
        return np.where(part == 1.0, high, low + (high - low) * part)

    def outside(self, values: Array) -> NDArray[np.bool_]:
        """Which values a scene would refuse."""
        field = self.field
        assert field is not None and field.low is not None and field.high is not None
        if field.open_ends:
            return ~((values > field.low) & (values < field.high))
        return ~((values >= field.low) & (values <= field.high))

    def text(self) -> str:
        """The axis as a sweep file has it, on one line."""

        def value(number: float) -> str:
            return json.dumps(f"{number!r} {self.unit}") if self.unit else repr(number)

        def pair() -> str:
            return f"[{value(self.numbers[0])}, {value(self.numbers[1])}]"

        if self.kind == "words":
            return "[" + ", ".join(_inline(self.words[place]) for place in self.places) + "]"
        if self.kind == "values":
            if self.count <= LISTED:
                return "[" + ", ".join(map(value, self.numbers)) + "]"
            digest = hashlib.sha256(np.asarray(self.numbers, "<f8").tobytes()).hexdigest()
            return f'{{ listed = {self.count}, sha256 = "{digest}" }}'
        if self.kind == "range":
            count = f", count = {self.count}" if self.count else ""
            spacing = ', spacing = "log"' if self.log else ""
            return f"{{ from = {value(self.numbers[0])}, to = {value(self.numbers[1])}{count}{spacing} }}"
        return f"{{ {self.kind} = {pair()} }}"


def read_axes(scene: Scene, over: Mapping[str, Any], design: str) -> tuple[tuple[Axis, ...], Scene]:
    """The axes of a sweep over a scene, and the scene with the first value of each that is a word.

    Raises SceneError with all mistakes; their keys begin with "over".
    """
    mistakes: list[Mistake] = []
    axes: dict[str, Axis] = {}
    changes: dict[str, Any] = {}
    if not over:
        raise SceneError([Mistake(None, None, "over", "missing: at least one swept quantity is needed")])
    for path, given in over.items():  # words first: they may decide which numbers there are
        if isinstance(given, Sequence) and not isinstance(given, str) and any(map(_is_word, given)):
            changes[path] = given[0]
    first = scene
    for path, word in changes.items():
        try:
            first = first.replace({path: word})
        except SceneError as error:
            mistakes += swept_mistakes(error, (path,))
    for path, given in over.items():
        try:
            axes[path] = _axis(first, path, given, design)
        except SceneError as error:
            mistakes += error.mistakes
        except ValueError as error:
            mistakes.append(Mistake(None, None, f"over.{path}", str(error)))
    named = {axis.name: axis.path for axis in axes.values()}
    mistakes += [
        Mistake(None, None, f"over.{path}", f"is called {axis.name} in datasets, as {named[axis.name]} is")
        for path, axis in axes.items()
        if named[axis.name] != path
    ]
    for path, other in itertools.permutations(axes, 2):
        if other.startswith(path + "."):
            mistakes.append(Mistake(None, None, f"over.{other}", f"is part of {path}, which is swept too"))
    raise_all(list(dict.fromkeys(mistakes)))
    if design == ZIP and len({axis.count for axis in axes.values()}) > 1:
        lengths = ", ".join(f"{axis.path} {axis.count}" for axis in axes.values())
        raise SceneError([Mistake(None, None, "over", f'design "zip" needs lists of one length, not {lengths}')])
    return tuple(axes.values()), first


def swept_mistakes(error: SceneError, words: Iterable[str]) -> list[Mistake]:
    """The mistakes of a scene as those of a sweep, and what to do if a path of `words` has one that does not fit."""
    found = [replace(mistake, key=f"over.{mistake.key}") for mistake in error.mistakes]
    for path in words:
        section = path.partition(".")[0]
        if path in SECTIONS and any(m.key.startswith(f"{section}.") and m.key != path for m in error.mistakes):
            message = f"not all words go with the same other keys: list whole sections, e.g. {SECTIONS[path]}"
            found.append(Mistake(None, None, f"over.{path}", message))
    return found


def field_at(scene: Scene, path: str) -> Field | None:
    """The scene's field at a path such as "impactor.velocity"; None if it takes words or a table, no plain number.

    Raises ValueError for a path that a scene does not have.
    """
    *sections, name = path.split(".")
    known = ("impactor", "target", "contact", "effects", "solver")
    head = sections[0] if sections else name
    if head not in known:
        raise ValueError("unknown key" + did_you_mean(path, _paths(scene)))
    if not sections:
        return None
    owner: Any = scene
    for section in sections:
        child = getattr(owner, section, None)
        if child is None or not hasattr(child, "FIELDS"):
            missing = "is not in the scene: give it there first" if child is None else "has no entries of its own"
            raise ValueError(f"{section} {missing}" + did_you_mean(path, _paths(scene)))
        owner = child
    fields: dict[str, Field] = dict(owner.FIELDS)
    if isinstance(owner, Contact):
        fields |= parameter_fields(owner)
    if head == "target" and name == "kind" and len(sections) == 1:
        return None
    if name == "exponent" and any(field.dimension == "meyer_stiffness" for field in fields.values()):
        raise ValueError("is in the unit of the stiffness: sections [contact] that have both can be listed")
    if name not in fields:
        hint = did_you_mean(name, fields) or did_you_mean(path, _paths(scene))
        raise ValueError(f"unknown key{hint}")
    return None if fields[name].low is None or head == "solver" else fields[name]


def _paths(scene: Scene) -> list[str]:
    parts = {"impactor": scene.impactor, "target": scene.target, "contact": scene.contact}
    return [f"{name}.{field}" for name, part in parts.items() for field in part.FIELDS]


def _axis(scene: Scene, path: str, given: Any, design: str) -> Axis:
    field = field_at(scene, path)
    if isinstance(given, Mapping):
        return _described(path, field, given, design, "" if field is None else unit_of(scene, field))
    if isinstance(given, str) or (not hasattr(given, "__len__") and not hasattr(given, "magnitude")):
        raise ValueError(f"{shown(given)} is one value: a list of values or a table with from and to is needed")
    if field is None:
        return _words(scene, path, given, design)
    if isinstance(given, np.ndarray) or hasattr(given, "magnitude"):
        values = np.atleast_1d(array_to_si(given, field.dimension)).ravel().tolist()
        own = [field.read(written(value, field.dimension)) for value in values]  # a stiffness of Meyer's is text only
    else:
        own = [field.read(value) for value in given]
    if not own:
        raise ValueError("an empty list: at least one value is needed")
    if design == GRID:
        _check_order(own)
    unit = unit_of(scene, field)
    return Axis(path, "values", tuple(own), count=len(own), dimension=field.dimension, unit=unit, field=field)


def _check_order(values: list[float]) -> None:
    steps = np.diff(values)
    if not ((steps > 0).all() or (steps < 0).all()):
        raise ValueError('a grid needs values that increase or decrease throughout; design "zip" takes any order')


def _words(scene: Scene, path: str, given: Iterable[Any], design: str) -> Axis:
    words: list[Any] = []
    places: list[int] = []
    for word in given:
        if word not in words:
            words.append(word)
        places.append(words.index(word))
    if not words:
        raise ValueError("an empty list: at least one value is needed")
    for k, word in enumerate(words):
        tabulated = path == "contact" and isinstance(word, Mapping) and "file" in word
        if design == ZIP and not tabulated:
            continue  # beside the other words of its row, which it may need
        try:
            changed = scene.replace({path: word})
        except SceneError as error:
            raise SceneError(swept_mistakes(error, (path,))) from None
        if tabulated:  # the dataset has the table, not the name of its file
            table = contact_table(changed.contact)
            words[k] = {key: value for key, value in word.items() if key != "file"}
            words[k] |= {key: table[key] for key in changed.contact.parameters}
    for k, word in enumerate(words):
        if design == GRID and places.count(k) > 1:
            raise ValueError(f"{_label(word)} is given {places.count(k)} times; each value once")
    return Axis(path, "words", words=tuple(words), places=tuple(places), count=len(places))


def _described(path: str, field: Field | None, given: Mapping[str, Any], design: str, unit: str) -> Axis:
    """An axis from a table: a range or a distribution."""
    if field is None:
        raise ValueError("is no number: a list of values is needed")
    unknown = [key for key in given if key not in (*RANGE, *DISTRIBUTIONS)]
    if unknown:
        raise ValueError(f"unknown key {shown(unknown[0])}{did_you_mean(unknown[0], (*RANGE, *DISTRIBUTIONS))}")
    chosen = [key for key in given if key in DISTRIBUTIONS]
    if chosen:
        if len(given) > 1:
            raise ValueError(f"give {chosen[0]} alone")
        if design not in SAMPLED:
            raise ValueError(f'a distribution needs design {_or(SAMPLED)}, not "{design}"')
        return _distribution(path, field, chosen[0], given[chosen[0]], unit)
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


def _distribution(path: str, field: Field, kind: str, given: Any, unit: str) -> Axis:
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 2:
        raise ValueError(f"{kind} needs a list of two values: {DISTRIBUTIONS[kind]}")
    low = field.read(given[0])
    if kind == "uniform":
        high = field.read(given[1])
        if not low < high:
            raise ValueError("uniform needs the least value first, and a greater one")
    else:
        high = to_si(given[1], field.dimension)
        if not high > 0.0:
            raise ValueError(f"the standard deviation {shown(given[1])} must be > 0")
        if kind == "lognormal" and not low > 0.0:
            raise ValueError(f"the mean {shown(given[0])} of a lognormal distribution must be > 0")
    return Axis(path, kind, (low, high), dimension=field.dimension, unit=unit, field=field)


def unit_of(scene: Scene, field: Field) -> str:
    """The SI unit as scene files write it."""
    if field.dimension == "meyer_stiffness":
        return stiffness_unit(scene.contact)
    return scene_unit(field.dimension)


def _is_word(value: Any) -> bool:
    """Whether a value cannot be a number with a unit."""
    return isinstance(value, bool | Mapping) or (isinstance(value, str) and not re.match(r"\s*[+-]?\.?[0-9]", value))


def _label(word: Any, whole: bool = False) -> str:
    if isinstance(word, Mapping):
        named = next((key for key in ("law", "name", "kind") if key in word), None)
        if named is not None and not whole:
            return str(word[named])
        plain = {key: _label(value) for key, value in word.items() if not isinstance(value, list | tuple)}
        return " ".join(value if key == named else f"{key}_{value}" for key, value in plain.items())
    if isinstance(word, list | tuple):
        return " ".join(map(_label, word))
    return str(word).lower() if isinstance(word, bool) else str(word)


def _inline(value: Any) -> str:
    """A value as TOML has it on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_inline(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | int | float) else json.dumps(str(value))


def _or(words: Sequence[str]) -> str:
    *most, last = (f'"{word}"' for word in words)
    return f"{', '.join(most)} or {last}"


class Points:
    """Points of a sampled design in the unit cube, from any place on: the same whoever asks, and in which order."""

    def __init__(self, design: str, dimensions: int, samples: int, seed: int) -> None:
        self._design, self._dimensions, self._samples, self._seed = design, dimensions, samples, seed
        self._lock, self._engine, self._next = threading.Lock(), None, 0

    def __call__(self, first: int, count: int) -> Array:
        """(count, dimensions) numbers between 0 and 1."""
        if self._design == "random":
            return self._random(first, count)
        if self._design == "sobol":
            return self._sobol(first, count)
        return _latin_hypercube(self._dimensions, self._samples, self._seed)[first : first + count]

    def _random(self, first: int, count: int) -> Array:
        words, each = first * self._dimensions, 4  # Philox makes four numbers at a time
        generator = np.random.Philox(key=self._seed)
        generator.advance(words // each)
        numbers = np.random.Generator(generator).random(words % each + count * self._dimensions)
        return numbers[words % each :].reshape(count, self._dimensions)

    def _sobol(self, first: int, count: int) -> Array:
        """Sobol's sequence, scrambled (Owen). The engine only goes forward: it begins anew for a place behind it."""
        from scipy.stats import qmc

        with self._lock:
            if self._engine is None or first < self._next:
                self._engine, self._next = qmc.Sobol(self._dimensions, scramble=True, rng=self._seed), 0
            if first > self._next:
                self._engine.fast_forward(first - self._next)
            self._next = first + count
            # a first point by itself: scipy warns of a first draw whose size is no power of two
            parts = (1, count - 1) if first == 0 else (count,)
            return np.concatenate([self._engine.random(part) for part in parts if part])


@lru_cache(maxsize=1)
def _latin_hypercube(dimensions: int, samples: int, seed: int) -> Array:
    from scipy.stats import qmc

    return qmc.LatinHypercube(dimensions, rng=seed).random(samples)


@lru_cache(maxsize=4)
def points(design: str, dimensions: int, samples: int, seed: int) -> Points:
    """The points of a design, one object for all who ask in this process."""
    return Points(design, dimensions, samples, seed)
