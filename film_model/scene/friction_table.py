"""A coefficient of friction that depends on how fast the contacting points slide on each other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from film_model.base.arrays import Array
from film_model.base.fields import Field, items_of, measure
from film_model.base.pairs import AbstractTable, write_table

COEFFICIENT = measure("dimensionless", 0.0, 100.0)


@dataclass(frozen=True, repr=False)
class FrictionTable(AbstractTable):
    """µ over the sliding speed |v|, m/s, by lines."""

    PAIR: ClassVar[tuple[Field, Field]] = measure("velocity", 0.0, 1e5), COEFFICIENT
    NEED: ClassVar[str] = (
        'a coefficient or a list of at least two pairs [speed, coefficient] as ["1 m/s", 0.3] is needed'
    )

    def __format__(self, spec: str) -> str:
        coefficients = [row[1] for row in self.rows]
        return f"{min(coefficients):{spec}} to {max(coefficients):{spec}}"

    def at(self, x: Any) -> Any:
        """µ at a speed or at many, m/s."""
        return np.interp(x, *np.array(self.rows).T)

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
    several = items_of(value) or isinstance(value, FrictionTable)
    return FrictionTable.read(value) if several else COEFFICIENT.read(value)


FRICTION = Field(_read, FrictionTable.NEED, low=COEFFICIENT.low, high=COEFFICIENT.high, write=write_table)
"""A coefficient, or a table of it."""
