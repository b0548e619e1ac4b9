"""Fields of structures that several kinds share: edges, elastic supports and damping."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeAlias

import numpy as np

from film_model.base.errors import Mistake, shown
from film_model.base.fields import Field, choice, items_of, measure, mistake
from film_model.base.pairs import AbstractTable, write_table
from film_model.targets.modes import Modes

SUPPORTS = "simply supported", "clamped", "free"

Edges = tuple[str, str, str, str]


def one_or(count: int, field: Field) -> Field:
    """One value, or a list with one for each of `count` places; stored as one if all are equal."""
    need = f"{field.need}, or a list of {count}"

    def read(value: object) -> Any:
        if not (items := items_of(value)):
            return field.read(value)
        if len(items) != count:
            raise ValueError(f"{shown(value)} has {len(items)} values: {need}")
        found = tuple(field.read(item) for item in items)
        return found[0] if len(set(found)) == 1 else found

    return Field(read, need, dimension=field.dimension)


EDGES = one_or(4, choice(*SUPPORTS))
IN_PLANE = replace(choice("fixed", "free"), required=False)
EDGE_STIFFNESS = one_or(4, measure("stiffness_per_length", 0, 1e18))
FOUNDATION = measure("stiffness_per_area", 0, 1e18)


_RATIO = measure("dimensionless", 0, 0.999)


@dataclass(frozen=True, repr=False)
class DampingTable(AbstractTable):
    """ζ over the natural frequency, Hz, by lines over its logarithm."""

    PAIR: ClassVar[tuple[Field, Field]] = measure("frequency", 1e-9, 1e12), _RATIO
    NEED: ClassVar[str] = (
        "a damping ratio (e.g. 0.01), a list with one for each vibration, or a list of at least two pairs "
        '[frequency, ratio] as ["1 kHz", 0.01] is needed'
    )

    def at(self, x: Any) -> Any:
        """ζ at frequencies > 0, Hz."""
        frequency, ratio = np.array(self.rows).T
        return np.interp(np.log(x), np.log(frequency), ratio)


Damping: TypeAlias = float | tuple[float, ...] | DampingTable | None
DampingLike: TypeAlias = float | Sequence[float] | Sequence[Sequence[Any]] | DampingTable | None


def _read_damping(value: object) -> Damping:
    if isinstance(value, DampingTable) or any(items_of(item) for item in items_of(value)):
        return DampingTable.read(value)
    if not (items := items_of(value)):
        return _RATIO.read(value)
    if len(items) > DampingTable.MOST:
        raise ValueError(f"{shown(value)} has {len(items)} values: 1 to {DampingTable.MOST} are allowed")
    return tuple(_RATIO.read(item) for item in items)


DAMPING = Field(_read_damping, DampingTable.NEED, write=write_table)
"""ζ of every vibration; a list by ascending frequency of those that move the struck point, the last for the rest; or a
table."""


def four(value: Any) -> Any:
    """A field of :func:`one_or` (4, …) as four values."""
    return value if isinstance(value, tuple) else (value,) * 4


def damped(modes: Modes, ratio: Damping) -> Modes:
    """The modes with given damping ratios; motions of frequency 0 have none."""
    if ratio is None:
        return modes
    flexible, found = modes.frequency > 0.0, np.zeros(modes.frequency.size)
    if isinstance(ratio, DampingTable):
        found[flexible] = ratio.at(modes.frequency[flexible] / (2.0 * math.pi))
    else:
        given = np.atleast_1d(np.asarray(ratio, dtype=np.float64))
        found[flexible] = given[np.minimum(np.arange(flexible.sum()), given.size - 1)]
    return replace(modes, damping_ratio=found)


def spring_mistakes(owner: object, springs: tuple[float, ...], edges: Edges) -> list[Mistake]:
    """The mistake of elastic supports at edges that cannot move."""
    stiff = [k for k in range(4) if springs[k] and edges[k] != "free"]
    if not stiff:
        return []
    where = ("x = 0", "x = a", "y = 0", "y = b")[stiff[0]]
    return [
        mistake(owner, "edge_stiffness", f"the edge {where} is {edges[stiff[0]]}: an elastic support needs a free edge")
    ]
