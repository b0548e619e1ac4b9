"""One swept quantity: its values, range, distribution or choices."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.schema import Variable, flag_words, swept_name, swept_variable, swept_words
from film_datasets.sweeps.designs import Array
from film_datasets.sweeps.distributions import DISTRIBUTIONS, EMPIRICAL, quantiles
from film_model.base.arrays import Index, Mask
from film_model.base.fields import Field
from film_model.base.units import si_unit


@dataclass(frozen=True)
class Axis:
    """One swept quantity. kind: "values" (SI), "range", a distribution, or "choices" (anything that is not a number).

    numbers: the values, or the two numbers of a range or distribution, SI; unit: as scene files write it. choices:
    each once; indices: the choice of each place along the axis. field: of the scene; None for choices.
    """

    path: str
    kind: str
    numbers: tuple[float, ...] = ()
    choices: tuple[Any, ...] = ()
    indices: tuple[int, ...] = ()
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
        """The choices as texts; sections of the same name with their entries."""
        short = [label(choice) for choice in self.choices]
        return tuple(label(choice, short.count(text) > 1) for choice, text in zip(self.choices, short, strict=True))

    def variable(self, dims: tuple[str, ...]) -> Variable:
        """Its variable in the schema."""
        unit = None if self.dimension == "meyer_stiffness" else si_unit(self.dimension)
        if self.kind == "choices" and dims == (self.name,):
            return swept_words(self.path, dims)
        return swept_variable(self.path, dims, unit, self.labels)

    @property
    def words(self) -> tuple[str, ...]:
        """The choices in a dataset, each another word."""
        return flag_words(self.labels)

    def choice_at(self, value: Any) -> Any:
        """The choice that a dataset has as a word or as its number."""
        return self.choices[self.words.index(str(value)) if isinstance(value, str) else int(value)]

    @property
    def meaning(self) -> str:
        """What its values in a dataset stand for: its path, and of choices what each is."""
        return "\n".join([self.path, *map(_toml_value, self.choices)])

    def coordinate(self, first: int, stop: int) -> NDArray[Any]:
        """Its values at places from `first` to before `stop` along a dimension of its own: SI, or words."""
        if self.kind == "choices":
            return np.array(self.words)[np.array(self.indices[first:stop], np.intp)]
        return self.at(np.arange(first, stop))

    def probes(self) -> Array:
        """Different values of an axis of numbers, SI, to see what depends on it."""
        if self.kind == "values":
            return np.array(self.numbers)
        return np.asarray(self.quantile(np.array([0.2, 0.5, 0.9])), np.float64)

    def at(self, index: Index) -> Array | NDArray[np.int32]:
        """Values at places along the axis: SI, or numbers of choices."""
        if self.kind == "choices":
            return np.asarray(self.indices, np.int32)[index]
        if self.kind == "values":
            return np.asarray(self.numbers)[index]
        low, high = self.numbers
        return self._between(index / max(self.count - 1, 1), low, high)

    def quantile(self, u: Array) -> Array | NDArray[np.int32]:
        """Values at probabilities: SI, or numbers of choices."""
        if self.kind in ("choices", "values"):
            return self.at(np.minimum((u * self.count).astype(np.intp), self.count - 1))
        if self.kind == "range":
            return self._between(u, *self.numbers)
        return quantiles(self.kind, u, self.numbers)

    @property
    def typical(self) -> tuple[float, ...]:
        """Values that a scene should allow: both ends of a range, the mean or median of a distribution."""
        if self.kind in ("values", "range", "uniform"):
            return self.numbers[0], self.numbers[-1]
        if self.kind in ("normal", "lognormal"):
            return self.numbers[:1]
        return tuple(self.quantile(np.array([0.5])).tolist())

    def _between(self, fraction: Array, low: float, high: float) -> Array:
        """From low to high, both exact."""
        if self.log:
            return np.where(fraction == 1.0, high, low * (high / low) ** fraction)
        return np.where(fraction == 1.0, high, low + (high - low) * fraction)

    def outside(self, values: Array) -> Mask:
        """Which values are out of the range that a scene allows."""
        field = self.field
        assert field is not None and field.low is not None and field.high is not None
        if field.open_ends:
            return ~((values > field.low) & (values < field.high))
        return ~((values >= field.low) & (values <= field.high))

    def text(self) -> str:
        """The axis in TOML, as a sweep file has it, on one line."""
        if self.kind == "choices":
            return "[" + ", ".join(_toml_value(self.choices[index]) for index in self.indices) + "]"
        if self.kind == "values":
            # longer lists are not repeated: the coordinate has the values
            if self.count <= 1000:
                return "[" + ", ".join(map(self._number_text, self.numbers)) + "]"
            digest = hashlib.sha256(np.asarray(self.numbers, "<f8").tobytes()).hexdigest()
            return f'{{ listed = {self.count}, sha256 = "{digest}" }}'
        if self.kind == "range":
            first, second = map(self._number_text, self.numbers)
            count = f", count = {self.count}" if self.count else ""
            spacing = ', spacing = "log"' if self.log else ""
            return f"{{ from = {first}, to = {second}{count}{spacing} }}"
        roles = DISTRIBUTIONS[self.kind].roles if self.kind != EMPIRICAL else ("value",) * len(self.numbers)
        texts = (
            repr(n) if role == "number" else self._number_text(n) for role, n in zip(roles, self.numbers, strict=True)
        )
        return f"{{ {self.kind} = [{', '.join(texts)}] }}"

    def _number_text(self, number: float) -> str:
        return json.dumps(f"{number!r} {self.unit}") if self.unit else repr(number)


def label(choice: Any, complete: bool = False) -> str:
    """A choice as text: of a section its name, or if `complete` its entries too."""
    if isinstance(choice, Mapping):
        named = next((key for key in ("law", "name", "kind") if key in choice), None)
        if named is not None and not complete:
            return str(choice[named])
        plain = {key: label(value) for key, value in choice.items() if not isinstance(value, list | tuple)}
        return " ".join(value if key == named else f"{key}_{value}" for key, value in plain.items())
    if isinstance(choice, list | tuple):
        return " ".join(map(label, choice))
    return str(choice).lower() if isinstance(choice, bool) else str(choice)


def _toml_value(value: Any) -> str:
    """A value in TOML on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_toml_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml_value, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | int | float) else json.dumps(str(value))
