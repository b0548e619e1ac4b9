"""Finite elements of a ball on a half-space that yields and hardens: loading and unloading."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from film_model.base.arrays import all_of, exponential
from film_model.laws.law import AbstractLaw, Array, Family, Power, Stage, Unloading
from film_model.laws.yielding import MOST_YIELD_STRAIN, limit_point

FITTED_RADIUS = 0.4  # a/R
FITTED_STRAIN = 0.019  # S_y/E
FITTED_EXPONENT = 0.4  # n
MOST_EXPONENT = 0.6  # n
RATIO = 0.3  # Poisson's ratio whose C enters the shape
SPREAD, NARROWED = 0.0648, 1.29  # of a/a_Y: exponent, and how n lowers it
PRESSURE, FLATTENING, BEND = 1.702, 0.299, 1.2136  # of the mean pressure: rise, less by a/R, how soon
HARDENED, STRAINED = 0.7033, 0.5488  # of the hardening: exponent over n, plastic strain over a/a_Y
STIFFENED, STIFFENING = 0.2578, 0.2794  # of the secant over a/a_Y
ROUNDED, ROUNDING = 0.1228, 0.8388  # of the exponent of unloading


@dataclass(frozen=True)
class Plastic:
    """f(w) beyond first yield, for S_y/E times C(ν)/C(0.3) and n."""

    yield_strain: float
    exponent: float

    @property
    def first_radius(self) -> Any:
        """a/R at first yield, π C e_y/2."""
        return 0.5 * math.pi * pressure_factor(RATIO) * self.yield_strain

    @property
    def end(self) -> Any:
        """w at which a = R, if w is far above 1."""
        spread = 2.0 * self._spread
        return self.first_radius ** (-2.0 / (1.0 + spread))

    @property
    def _spread(self) -> Any:
        return SPREAD / (1.0 + NARROWED * self.exponent)

    def contact_radius(self, w: Any) -> Any:
        """a over that at first yield."""
        return (w * (1.0 + (w - 1.0) ** 2.0) ** self._spread) ** 0.5

    def __call__(self, w: Any) -> Any:
        """Hardening begins with (α − 1)², the force with Hertz's slope: otherwise restitution would exceed 1."""
        radius = self.contact_radius(w)
        slope = self.first_radius * radius
        most = PRESSURE / (1.0 + (FLATTENING * slope) ** 1.5)
        mean = 1.0 + most * (1.0 - (1.0 + (w**0.5 - 1.0) / (BEND * most)) ** -BEND)
        return radius * radius * mean * (1.0 + STRAINED * (radius - 1.0) ** 2.0 / radius) ** (HARDENED * self.exponent)


@dataclass(frozen=True)
class Secant:
    """f_m/(w_m − w_f)."""

    plastic: Plastic

    def __call__(self, w: Any) -> Any:
        return self.plastic.contact_radius(w) * (1.0 + STIFFENED * (1.0 - w**-STIFFENING))


def _exponent(w: Array) -> Array:
    return 1.5 - ROUNDED * (1.0 - w**-ROUNDING)


def pressure_factor(poissons_ratio: Any) -> Any:
    """C: the largest contact pressure at first yield over the yield strength."""
    return 1.295 * exponential(0.736 * poissons_ratio)


@dataclass(frozen=True)
class Elastoplastic(AbstractLaw):
    """With w = δ/δ_Y, δ_Y = (π C S_y/2E)² R, C = 1.295 e^{0.736 ν}, and f over the force there:

    f = w^{3/2} up to first yield, w = 1. Beyond, α = a/a_Y = √(w (1 + (w − 1)²)^{0.0648/(1 + 1.29 n)}),
    f = α² (1 + M [1 − (1 + (√w − 1)/(1.2136 M))^{−1.2136}]) (1 + 0.5488 (α − 1)²/α)^{0.7033 n},
    M = 1.702/(1 + (0.299 a/R)^{3/2}). Unloading: f_m/(w_m − w_f) = α (1 + 0.2578 (1 − w_m^{−0.2794})), with the
    exponent 1.5 − 0.1228 (1 − w_m^{−0.8388}).

    Fitted to 189 impacts of a rigid ball, without friction, on a half-space: von Mises' yield, flow stress
    S_y (1 + E ε_p/S_y)^n, 1.5 to 1000 times the velocity of first yield, S_y/E from 0.0008 to 0.019, ν from 0.2 to
    0.45, n up to 0.4, a/R up to 0.4. Restitution differs from them by 1.5 % on average and by 5 % at most, the force by
    1.2 and 3.6 %, the indentation by 0.7 and 2.3 %.

    strain_hardening_exponent: n, of the material; 0, without hardening, if it gives none. Of two bodies that yield, the
    law takes the strength, ν and n of the softer: the other stays elastic. Two equal bodies share the indentation, each
    as deep as the half of it, which the finite elements do not have: this is an estimate. Ends where a = R.
    """

    name: ClassVar[str] = "elastoplastic"
    family: ClassVar[Family] = "yields"
    summary: ClassVar[str] = "finite elements of a sphere that yields and hardens, loading and unloading"
    source: ClassVar[str] = "fitted to axisymmetric finite elements made for this package"
    validity: ClassVar[str] = "computed for a/R and n up to 0.4 and S_y/E up to 0.019; ends where a = R"
    shaped_by: ClassVar[tuple[str, ...]] = ("effective_modulus", "yield_strength", "poissons_ratio")
    shaped_beside: ClassVar[Mapping[str, tuple[float, float]]] = {"strain_hardening_exponent": (0.0, MOST_EXPONENT)}

    effective_modulus: float
    radius: float
    yield_strength: float
    poissons_ratio: float
    strain_hardening_exponent: float = 0.0

    def __post_init__(self) -> None:
        strain = self.yield_strength / self.effective_modulus
        if not all_of(strain < MOST_YIELD_STRAIN):
            raise ValueError(f"law elastoplastic: S_y/E is {np.max(strain):.3g}; it must be below {MOST_YIELD_STRAIN}")
        n = self.strain_hardening_exponent
        if not all_of((n >= 0.0) & (n <= MOST_EXPONENT)):
            raise ValueError(f"law elastoplastic: the strain hardening exponent must be from 0 to {MOST_EXPONENT}")

    @property
    def shape(self) -> float:
        """e_y C(ν)/C(0.3): a/R at first yield depends on it alone."""
        ratio = pressure_factor(self.poissons_ratio) / pressure_factor(RATIO)
        return self.yield_strength / self.effective_modulus * ratio

    def of_shape(self, shape: float) -> Elastoplastic:
        return Elastoplastic(1.0, 1.0, shape, RATIO, self.strain_hardening_exponent)

    def outside(self, depth: float) -> str:
        strain, said = self.yield_strength / self.effective_modulus, list[str]()
        if strain > FITTED_STRAIN:
            said.append(f"S_y/E is {strain:.3g}, computed was up to {FITTED_STRAIN}")
        if self.strain_hardening_exponent > FITTED_EXPONENT:
            said.append(f"n is {self.strain_hardening_exponent:.3g}, computed was up to {FITTED_EXPONENT}")
        plastic = Plastic(self.shape, self.strain_hardening_exponent)
        radius = plastic.first_radius * plastic.contact_radius(depth)
        if radius > FITTED_RADIUS:
            said.append(f"the contact radius is {radius:.3g} of the ball's, computed was up to {FITTED_RADIUS}")
        return " and ".join(said) if depth > 1.0 else ""

    def scales(self, energy: float) -> tuple[float, float]:
        strength = pressure_factor(self.poissons_ratio) * self.yield_strength
        return limit_point(self.effective_modulus, self.radius, strength)

    def stages(self) -> tuple[Stage, ...]:
        plastic = Plastic(self.shape, self.strain_hardening_exponent)
        unloading = Unloading(secant=Secant(plastic), exponent=_exponent)
        return (
            Stage("elastic", 0.0, 1.0, Power(coefficient=1.0, exponent=1.5, origin=0.0)),
            Stage("elastoplastic", 1.0, plastic.end, plastic, unloading),
        )
