"""Rows of published values, and the scenes that they describe."""

from __future__ import annotations

import hashlib
import re
import tomllib
from typing import Any, NamedTuple

HARDNESS_OVER_STRENGTH = 2.8
"""Mean pressure of an indentation over the flow strength (Tabor 1951)."""

VICKERS_PRESSURE = 9.80665e6 / 0.927
"""Pa for 1 HV: mean pressure on the projected area. HV is a load in kgf over the area of the pyramid's faces in mm²."""


class Row(NamedTuple):
    """One value and its conditions, SI; nan: not given. See datasets/published/measured_impacts.csv."""

    value: float
    uncertainty: float
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
    def yields(self) -> bool:
        """Whether it was computed for a contact that yields."""
        return self.yield_strength == self.yield_strength and self.kind in ("finite_element", "theory")


def material(table: str) -> dict[str, Any]:
    """A material of a row, as in a scene file; its hardness becomes a strength."""
    entries: dict[str, Any] = tomllib.loads(f"material = {table}")["material"]
    if "hardness" in entries:
        entries["yield_strength"] = f"{flow_strength(entries.pop('hardness'))!r} Pa"
    return entries


def flow_strength(hardness: str) -> float:
    """Strength [Pa] of a Vickers hardness such as "600 HV". Raises ValueError for another scale."""
    number = re.fullmatch(r"([\d.]+) HV", hardness)
    if number is None:
        raise ValueError(f"hardness {hardness!r} is not a number of HV")
    return float(number[1]) * VICKERS_PRESSURE / HARDNESS_OVER_STRENGTH
