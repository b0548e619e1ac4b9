"""Lists of pairs in scenes: series such as Prony's, and tables of one quantity over another."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Self, TypeAlias

from film_model.base.errors import shown
from film_model.base.fields import Field, items_of, written
from film_model.base.units import format_si

Pairs: TypeAlias = tuple[tuple[float, float], ...]


def read_pairs(value: object, pair: tuple[Field, Field], most: int, need: str, least: int = 1) -> Pairs:
    """Read `least` to `most` pairs; the two fields read the two items of each.

    need: what the error says of a value that is not such a list.
    """
    rows = items_of(value)
    if not least <= len(rows) <= most or any(len(items_of(row)) != 2 for row in rows):
        raise ValueError(f"{shown(value)} is not allowed: {need}")
    found: list[tuple[float, float]] = []
    for place, row in enumerate(rows, 1):
        try:
            first, second = (field.read(item) for field, item in zip(pair, items_of(row), strict=True))
        except ValueError as error:
            raise ValueError(f"pair {place}: {error}") from None
        found.append((first, second))
    return tuple(found)


def write_pairs(rows: Pairs, pair: tuple[Field, Field]) -> list[list[Any]]:
    """The pairs as a scene file contains them."""
    return [[written(item, field.dimension) for item, field in zip(row, pair, strict=True)] for row in rows]


@dataclass(frozen=True, repr=False)
class AbstractTable(ABC):
    """y over x. rows: at least two pairs (x, y), SI, of ascending x; y is constant beyond. PAIR: fields of x and y."""

    PAIR: ClassVar[tuple[Field, Field]]
    NEED: ClassVar[str]
    MOST: ClassVar[int] = 100_000
    rows: Pairs

    def __repr__(self) -> str:
        return repr(self.written)

    @property
    def written(self) -> list[list[Any]]:
        """The table as a scene file contains it."""
        return write_pairs(self.rows, self.PAIR)

    @abstractmethod
    def at(self, x: Any) -> Any:
        """y at one x or at many."""

    @classmethod
    def read(cls, value: object) -> Self:
        """The table of a list of pairs, or the table that is given."""
        if isinstance(value, cls):
            return value
        rows = read_pairs(value, cls.PAIR, cls.MOST, cls.NEED, least=2)
        for place, ((before, _), (after, _)) in enumerate(pairwise(rows), 2):
            if not after > before:
                x, last = (format_si(number, cls.PAIR[0].dimension, 6) for number in (after, before))
                raise ValueError(f"pair {place}: {x} must be > {last}, that of the pair before")
        return cls(rows)


def write_table(value: Any) -> Any:
    """Plain numbers or a table of them, as a scene file contains them."""
    return value.written if isinstance(value, AbstractTable) else written(value, "dimensionless")
