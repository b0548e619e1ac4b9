"""Rows of published values, and the scenes that they describe."""

from __future__ import annotations

import hashlib
import re
import tomllib
from typing import Any, NamedTuple

HARDNESS = re.compile(r'hardness = "([0-9.]+) HV"')
"""Of a target, in its material."""


class Row(NamedTuple):
    """One value and its conditions, SI; nan: not given. See datasets/published/measured_impacts.csv."""

    value: float
    uncertainty: float
    input_uncertainty: float
    radius: float
    mass: float
    velocity: float
    effective_modulus: float
    yield_strength: float
    poissons_ratio: float
    target_impedance: float
    quantity: str
    source: str
    number: int
    kind: str
    sureness: str
    law: str
    complete: bool
    matter: str
    ball: str
    target: str
    note: str

    @property
    def held_out(self) -> bool:
        """Whether the row is never used to choose or fit: one third of them, by a hash of source and number."""
        return hashlib.sha256(f"{self.source} {self.number}".encode()).digest()[0] % 3 == 0

    @property
    def usable(self) -> bool:
        """Whether it is measured, and its conditions are complete."""
        return self.kind == "measured" and self.complete

    @property
    def of_steel(self) -> bool:
        """Whether it is usable, and of a steel of known hardness, so that every law can simulate it."""
        return self.usable and self.hardness is not None

    @property
    def hardness(self) -> float | None:
        """Of the target, HV; None if it is not given so."""
        found = HARDNESS.search(self.target)
        return None if found is None else float(found[1])

    @property
    def yields(self) -> bool:
        """Whether it was computed for a contact that yields."""
        return self.yield_strength == self.yield_strength and self.kind in ("finite_element", "theory")


def material(table: str) -> dict[str, Any]:
    """A material of a row, as in a scene file."""
    return tomllib.loads(f"material = {table}")["material"]
