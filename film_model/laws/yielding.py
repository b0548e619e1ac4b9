"""The yield point of a sphere, and what the elastoplastic laws share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from film_model.base.arrays import root
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import AbstractLaw, Family, Parameter

YIELD_PRESSURE_RATIO = 1.1
"""Mean contact pressure at first yield over the yield strength, p_m = 1.1 S_y."""

LEAST_YIELD_STRAIN = 1e-9
"""S_y/E below which the series of elastoplastic do not reach a = R; any solid has more."""

MOST_YIELD_STRAIN = 0.2
"""S_y/E from which jackson-green and elastoplastic do not hold: fitted were up to 0.009 and 0.019."""


def yield_point(effective_modulus: float, radius: float, yield_strength: float) -> tuple[float, float]:
    """Indentation δ_y [m] and force F_y [N] at first yield.

    δ_y = (1.1 π R S_y/K)², F_y = K δ_y^{3/2}; R is the effective radius, K Hertz's stiffness.
    Source: Big-Alabo, Cartmell & Harrison 2017, after (19).
    """
    stiffness = hertz_stiffness(effective_modulus, radius)
    indentation = (YIELD_PRESSURE_RATIO * math.pi * radius * yield_strength / stiffness) ** 2
    return indentation, stiffness * indentation**1.5


@dataclass(frozen=True)
class YieldingSphere(AbstractLaw):
    """A sphere that yields, in units of its yield point."""

    family: ClassVar[Family] = "yields"

    effective_modulus: float
    radius: float
    yield_strength: float

    def scales(self, energy: float) -> tuple[float, float]:
        return yield_point(self.effective_modulus, self.radius, self.yield_strength)


def pressure_over(factor: float, what: str) -> Parameter:
    """A contact pressure that is `factor` times the strength unless it is given."""
    help = f"{what}, by default {factor:g} times the strength"
    return Parameter(help, "pressure", required=False, over_strength=factor)


def yield_velocity(effective_modulus: float, radius: float, yield_strength: float, mass: float) -> float:
    """Velocity [m/s] above which a half-space impact of `mass` [kg] yields: √(0.8 F_y δ_y/m)."""
    indentation, force = yield_point(effective_modulus, radius, yield_strength)
    return root(0.8 * force * indentation / mass)


def limit_point(effective_modulus: float, radius: float, pressure: float) -> tuple[float, float]:
    """Indentation (π p/2E)² R [m] and force [N] at which Hertz's largest pressure is p [Pa]."""
    indentation = (0.5 * math.pi * pressure / effective_modulus) ** 2 * radius
    return indentation, hertz_stiffness(effective_modulus, radius) * indentation**1.5
