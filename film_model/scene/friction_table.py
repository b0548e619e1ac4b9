"""A coefficient of friction that depends on how fast the contacting points slide on each other."""

from __future__ import annotations

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

    @property
    def pairs(self) -> Array:
        """The rows as an array (rows, 2)."""
        return np.array(self.rows)


def _read(value: object) -> float | FrictionTable:
    several = items_of(value) or isinstance(value, FrictionTable)
    return FrictionTable.read(value) if several else COEFFICIENT.read(value)


FRICTION = Field(_read, FrictionTable.NEED, low=COEFFICIENT.low, high=COEFFICIENT.high, write=write_table)
"""A coefficient, or a table of it."""
