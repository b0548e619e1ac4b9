"""Rows of published values, and the scenes that they describe."""

from __future__ import annotations

import hashlib
import re
import tomllib
from typing import Any, NamedTuple

from film_model.base.flow_stress import johnson_cook_exponent
from film_model.base.hardness import VICKERS
from film_model.base.materials import catalogue

LARGEST_INPUT_UNCERTAINTY = 0.1
"""Relative uncertainty of the hardness or strength up to which the conditions of a row are complete."""

JOHNSON_COOK = {
    "1006": (350e6, 275e6, 0.36, 0.022),
    "4340": (792e6, 510e6, 0.26, 0.014),
    "S-7": (1539e6, 477e6, 0.18, 0.012),
}
"""A, B [Pa], n and C of the three steels of Johnson & Cook 1983, Proc. 7th Int. Symp. on Ballistics, 541-547."""

_HARDNESS = re.compile(r'hardness = "([0-9.]+) HV"')
_RATE = re.compile(r", strain_rate_coefficient = ([0-9.]+)")


def steels() -> dict[str, float]:
    """The steels of the catalogue whose hardness is known, HV, by name, the softest first."""
    found = {name: one.hardness / VICKERS for name, one in catalogue().items() if "steel" in name and one.hardness}
    return dict(sorted(found.items(), key=lambda steel: steel[1]))


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
    def rough(self) -> bool:
        """Whether it can be simulated, but its hardness is not known within `LARGEST_INPUT_UNCERTAINTY`."""
        able = self.hardness is not None and all(x == x for x in (self.radius, self.mass, self.velocity))
        return self.kind == "measured" and able and not self.input_uncertainty <= LARGEST_INPUT_UNCERTAINTY

    @property
    def hardness(self) -> float | None:
        """Of the target, HV; None if it is not given so."""
        found = _HARDNESS.search(self.target)
        return None if found is None else float(found[1])

    def with_rate(self, coefficient: float | None) -> Row:
        """The row with another strain rate coefficient of its target, or without one."""
        given = "" if coefficient is None else f", strain_rate_coefficient = {coefficient}"
        return self._replace(target=_RATE.sub(given, self.target))

    @property
    def hardening(self) -> Row:
        """The row with the strain hardening exponent of that steel of Johnson & Cook whose C its target has."""
        rate = _RATE.search(self.target)
        if rate is None:
            return self
        strength, coefficient, power, _ = next(steel for steel in JOHNSON_COOK.values() if steel[3] == float(rate[1]))
        exponent = johnson_cook_exponent(strength, coefficient, power, 210e9)  # Pa, of steel
        return self._replace(
            target=f"{self.target[: rate.end()]}, strain_hardening_exponent = {exponent:.6f}{self.target[rate.end() :]}"
        )

    def with_hardness(self, vickers: float) -> Row:
        """The row with another hardness of its target."""
        return self._replace(target=_HARDNESS.sub(f'hardness = "{vickers!r} HV"', self.target))

    @property
    def by_name(self) -> Row:
        """The row with the steel of the catalogue as its target of which the Vickers hardness is nearest."""
        own, known = self.hardness, steels()
        return self if own is None else self._replace(target=f'"{min(known, key=lambda name: abs(known[name] - own))}"')

    @property
    def yields(self) -> bool:
        """Whether it was computed for a contact that yields."""
        return self.yield_strength == self.yield_strength and self.kind in ("finite_element", "theory")


def material(table: str) -> dict[str, Any]:
    """A material of a row, as in a scene file."""
    return tomllib.loads(f"material = {table}")["material"]
