"""Fields of structures that several kinds share: edges, elastic supports and damping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from film_model.base.errors import Mistake, shown
from film_model.base.fields import Field, choice, measure, mistake
from film_model.targets.modes import Modes

SUPPORTS = "simply supported", "clamped", "free"

Edges = tuple[str, str, str, str]

MOST_DAMPED = 100_000
"""Most values of a list of damping ratios."""


def one_or(count: int, field: Field) -> Field:
    """One value, or a list with one for each of `count` places; stored as one if all are equal."""
    need = f"{field.need}, or a list of {count}"

    def read(value: object) -> Any:
        if isinstance(value, str) or not isinstance(value, Sequence):
            return field.read(value)
        items = cast("Sequence[object]", value)
        if len(items) != count:
            raise ValueError(f"{shown(value)} has {len(items)} values: {need}")
        found = tuple(field.read(item) for item in items)
        return found[0] if len(set(found)) == 1 else found

    return Field(read, need, dimension=field.dimension)


EDGES = one_or(4, choice(*SUPPORTS))
IN_PLANE = replace(choice("fixed", "free"), required=False)
EDGE_STIFFNESS = one_or(4, measure("stiffness_per_length", 0, 1e18))
FOUNDATION = measure("stiffness_per_area", 0, 1e18)


def _read_ratio(value: object) -> Any:
    if isinstance(value, str) or not isinstance(value, Sequence):
        return _RATIO.read(value)
    items = cast("Sequence[object]", value)
    if not 1 <= len(items) <= MOST_DAMPED:
        raise ValueError(f"{shown(value)} has {len(items)} values: 1 to {MOST_DAMPED} are allowed")
    return tuple(_RATIO.read(item) for item in items)


_RATIO = measure("dimensionless", 0, 0.999)
DAMPING = Field(_read_ratio, "a damping ratio (e.g. 0.01), or a list with one for each vibration, is needed")
"""ζ of every vibration; or a list by ascending frequency of those that move the struck point, the last for the rest."""


def four(value: Any) -> Any:
    """A field of :func:`one_or` (4, …) as four values."""
    return value if isinstance(value, tuple) else (value,) * 4


def damped(modes: Modes, ratio: float | tuple[float, ...] | None) -> Modes:
    """The modes with given damping ratios; motions of frequency 0 have none."""
    if ratio is None:
        return modes
    given = np.atleast_1d(np.asarray(ratio, dtype=np.float64))
    flexible = modes.frequency > 0.0
    place = np.minimum(np.cumsum(flexible) - 1, given.size - 1)
    return replace(modes, damping_ratio=np.where(flexible, given[place], 0.0))


def spring_mistakes(owner: object, springs: tuple[float, ...], edges: Edges) -> list[Mistake]:
    """The mistake of elastic supports at edges that cannot move."""
    stiff = [k for k in range(4) if springs[k] and edges[k] != "free"]
    if not stiff:
        return []
    where = ("x = 0", "x = a", "y = 0", "y = b")[stiff[0]]
    return [
        mistake(owner, "edge_stiffness", f"the edge {where} is {edges[stiff[0]]}: an elastic support needs a free edge")
    ]
