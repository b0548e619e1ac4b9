"""Hertz's force with the first effect of steep surfaces: elastic balls that are pressed in far."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.base.arrays import all_of
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import AbstractLaw, Family, Power, Stage, raise_wrong

BALL = 0.976
"""c of an elastic ball on a rigid plane, fitted to its equilibrium by finite elements
(examples/finite_elements/elastic.py)."""

HALF_SPACE = 0.157
"""The same of a rigid ball on an elastic half-space."""

STEEP_FORCE = Power(square=1.0, coefficient=1.0)


@dataclass(frozen=True)
class LargeSlope(AbstractLaw):
    """Hertz's force to first order in √(δ/R):

        F = K δ^{3/2} (1 + c √(δ/R))

    c = 0.976 R/R_b of an elastic ball of radius R_b, which is compressed as a whole and has a flat contact, and 0.157
    of a half-space; each body counts by its share of the compliance. Scales δ_s = R/c² and F_s = K δ_s^{3/2}. Finite
    elements of a ball with its inertia on a rigid plane, ν = 0.2 to 0.49, differ by up to 1.7 % in force and 2.2 % in
    indentation up to √(δ/R) = 0.35 (by Hertz's law), by 3.7 and 6.5 % up to 0.5. Reversible.
    """

    name: ClassVar[str] = "large-slope"
    family: ClassVar[Family] = "elastic"
    summary: ClassVar[str] = "Hertz to first order in √(δ/R): elastic balls that are pressed in far"
    source: ClassVar[str] = "first-order fit to axisymmetric finite elements made for this package"
    validity: ClassVar[str] = "√(δ/R) up to about 0.5, no yield"
    widening: ClassVar[float] = 1.0
    steep: ClassVar[bool] = True

    effective_modulus: float
    radius: float
    slope_coefficient: float = BALL

    def __post_init__(self) -> None:
        raise_wrong(self)

    def scales(self, energy: float) -> tuple[float, float]:
        return steep_scales(self.effective_modulus, self.radius, self.slope_coefficient)

    def stages(self) -> tuple[Stage, ...]:
        return (Stage("elastic", 0.0, math.inf, STEEP_FORCE),)

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        return wrong_coefficient(values)


def steep_scales(effective_modulus: float, radius: float, slope_coefficient: float) -> tuple[float, float]:
    """δ_s and F_s."""
    indentation = radius / slope_coefficient**2
    return indentation, hertz_stiffness(effective_modulus, radius) * indentation**1.5


def wrong_coefficient(values: Mapping[str, Any]) -> dict[str, str]:
    """Message, by name, about a coefficient that is not positive."""
    given = values.get("slope_coefficient", BALL)
    wrong = not all_of(given > 0.0)
    return {"slope_coefficient": f"{given} must be > 0: without it take law hertz or tsuji"} if wrong else {}
