"""Hertz: the elastic contact of a sphere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.law import AbstractLaw, Family, Power, Stage


def hertz_stiffness(effective_modulus: float, radius: float) -> float:
    """K = (4/3) E √R [N/m^1.5], from the effective modulus [Pa] and the effective radius [m]."""
    return 4.0 / 3.0 * effective_modulus * radius**0.5


@dataclass(frozen=True)
class Hertz(AbstractLaw):
    """Hertz 1882.

        F = K δ^{3/2},  K = (4/3) E √R

    Reversible.
    """

    name: ClassVar[str] = "hertz"
    family: ClassVar[Family] = "elastic"
    summary: ClassVar[str] = "elastic sphere, F = K δ^1.5; never yields"
    source: ClassVar[str] = "Hertz 1882"
    validity: ClassVar[str] = "a/R = √(δ/R) below about 0.2, no yield"

    effective_modulus: float
    radius: float

    def scales(self, energy: float) -> tuple[float, float]:
        stiffness = hertz_stiffness(self.effective_modulus, self.radius)
        indentation = (energy / stiffness) ** 0.4
        return indentation, stiffness * indentation**1.5

    def stages(self) -> tuple[Stage, ...]:
        return (Stage("elastic", 0.0, float("inf"), Power(coefficient=1.0, exponent=1.5)),)
