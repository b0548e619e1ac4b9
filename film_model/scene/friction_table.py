"""A coefficient of friction that depends on how fast the contacting points slide on each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, cast

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import shown
from film_model.base.fields import Field, measure, written

SPEED, COEFFICIENT = measure("velocity", 0.0, 1e5), measure("dimensionless", 0.0, 100.0)
NEED = 'a coefficient or a list of at least two pairs [speed, coefficient] as ["1 m/s", 0.3] is needed'


@dataclass(frozen=True, repr=False)
class FrictionTable:
    """µ over the sliding speed |v|. rows: (speed, m/s, increasing; µ); lines between, constant beyond."""

    rows: tuple[tuple[float, float], ...]

    def __repr__(self) -> str:
        return repr(self.written)

    def __format__(self, spec: str) -> str:
        coefficients = [row[1] for row in self.rows]
        return f"{min(coefficients):{spec}} to {max(coefficients):{spec}}"

    @property
    def written(self) -> list[list[Any]]:
        """The table as a scene file contains it."""
        return [[written(speed, "velocity"), coefficient] for speed, coefficient in self.rows]

    def at(self, speed: Any) -> Any:
        """µ at a speed or at many, m/s."""
        return np.interp(speed, *np.array(self.rows).T)

    def slid(self, velocity: float, impulse: float) -> float:
        """The sliding velocity after a normal impulse over m_t, m/s, in which the contact slides: v' = −µ(|v|).

        Between two rows µ = a + b v, so that µ falls or grows by e^{−b s} over the impulse s. The velocity is that of
        the far points, which turns while the contact still slides.
        """
        v, left = abs(velocity), impulse
        while left > 0.0 and (now := float(self.at(abs(v)))) > 0.0:
            low, slope = self._below(v)
            if slope == 0.0:
                whole = (v - low) / now
            else:
                end = now + slope * (low - v)  # µ at the lower row
                whole = math.log(now / end) / slope if end > 0.0 else math.inf
            if whole > left:
                v -= now * left if slope == 0.0 else -now * math.expm1(-slope * left) / slope
                break
            v, left = low, left - whole
        return math.copysign(1.0, velocity) * v

    def _below(self, v: float) -> tuple[float, float]:
        """The row of either sign below a velocity, and dµ/dv from there on; beyond the table µ is constant."""
        rows = sorted({sign * speed for speed, _ in self.rows for sign in (-1.0, 1.0)})
        low = max((row for row in rows if row < v), default=-math.inf)
        high = min((row for row in rows if row >= v), default=math.inf)
        rises = math.isfinite(low) and math.isfinite(high)
        return low, float(self.at(abs(high)) - self.at(abs(low))) / (high - low) if rises else 0.0

    @property
    def pairs(self) -> Array:
        """The rows as an array (rows, 2)."""
        return np.array(self.rows)


def _read(value: object) -> float | FrictionTable:
    if isinstance(value, FrictionTable):
        return value
    if isinstance(value, str) or not isinstance(value, Sequence):
        return COEFFICIENT.read(value)
    rows = cast("Sequence[Any]", value)
    if len(rows) < 2 or any(isinstance(row, str) or not isinstance(row, Sequence) or len(row) != 2 for row in rows):
        raise ValueError(f"{shown(value)} is not allowed: {NEED}")
    read = tuple((SPEED.read(speed), COEFFICIENT.read(mu)) for speed, mu in rows)
    for (before, _), (after, _) in pairwise(read):
        if not after > before:
            raise ValueError(f"speed {after:g} m/s must be > {before:g} m/s, that of the pair before")
    return FrictionTable(read)


def _write(value: float | FrictionTable) -> Any:
    return value.written if isinstance(value, FrictionTable) else value


FRICTION = Field(_read, NEED, low=COEFFICIENT.low, high=COEFFICIENT.high, write=_write)
"""A coefficient, or a table of it."""
