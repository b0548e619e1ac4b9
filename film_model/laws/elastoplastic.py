"""Finite elements of a ball on a half-space that yields and hardens: loading and unloading."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np

from film_model.base.arrays import all_of, any_of, exponential, greater, lesser, logarithm
from film_model.base.flow_stress import MOST_HARDENING
from film_model.laws.law import AbstractLaw, Family, Power, Stage, Unloading
from film_model.laws.yielding import LEAST_YIELD_STRAIN, MOST_YIELD_STRAIN, limit_point

MOST_SHARE = 0.8  # h
COMPARED_STRAIN = 0.005
RATIO = 0.3  # Poisson's ratio whose C enters the shape

FLATTENED, SUNK = (2.0 - 4.0 / math.pi) / (3.0 * math.pi / 8.0), 8.0 / (3.0 * math.pi)
"""Curvature that a uniform pressure gives an elastic surface, and its depth at the centre, over those of Hertz's
pressure of the same mean: Johnson 1985, Contact Mechanics, 3.4."""


@dataclass(frozen=True)
class Constants:
    """Beyond first yield, as examples/finite_elements/fit.py prints them."""

    onset: float = 1.762  # of w − 1
    spread: float = 0.09639  # of a²/(R δ)
    spread_hardened: float = 1.505
    pressure: float = 2.379  # mean, of full plasticity, less that at first yield
    pressure_flattened: float = 0.5506  # over a/R
    pressure_bend: float = 0.5068
    strain: float = 0.5642  # over a/a_Y
    strain_exponent: float = 0.7185  # over n
    stiffening: float = 0.2631  # of unloading
    stiffening_hardened: float = 0.603
    rounding: float = 0.1641  # of the exponent of unloading
    lateness: float = 0.2434
    stays_elastic: float = 2.692  # s; of the harder of two bodies; see docs/finite_elements.md

    def beyond(self, w: Any) -> Any:
        """1 + ((w − 1)/onset)²: Hertz's value and slope at first yield."""
        return 1.0 + ((w - 1.0) / self.onset) ** 2.0

    def reached(self, w: Any) -> Any:
        """Part of the change from elastic to fully plastic unloading."""
        return 1.0 - self.beyond(w) ** -self.lateness

    def exponent(self, w: Any) -> Any:
        """Of unloading."""
        return 1.5 - self.rounding * self.reached(w)

    def elastic_share(self, strengths: Any, moduli: Any) -> Any:
        """h of two bodies, at most `MOST_SHARE`. strengths: s, moduli: m, of the harder over the softer one, the
        strengths at the plastic strain `COMPARED_STRAIN`."""
        yields = greater(self.stays_elastic - greater(strengths, 1.0), 0.0) / (self.stays_elastic - 1.0)
        return lesser((1.0 - yields**4.0) / (1.0 + moduli), MOST_SHARE)


FITTED = Constants()


class Pressed(NamedTuple):
    """Of the softer body. widening: ω, reached: g, pressure: P, slope: dP/dα_s, but for the change of M."""

    widening: Any
    reached: Any
    pressure: Any
    slope: Any


@dataclass(frozen=True)
class Plastic:
    """Beyond first yield. yield_strain: of `scaled_strain`; exponent: n; share: h; curvature: x."""

    yield_strain: Any
    exponent: Any
    share: Any = 0.0
    constants: Constants = FITTED
    curvature: Any = 0.0

    @property
    def first_radius(self) -> Any:
        """a/R at first yield, π C e_y/2."""
        return 0.5 * math.pi * pressure_factor(RATIO) * self.yield_strain

    @property
    def flattening(self) -> Any:
        """What a_Y/R α_s is multiplied by in M."""
        return self.constants.pressure_flattened * (1.0 - self.share * (1.0 - self.curvature))

    @property
    def end(self) -> Any:
        """w at which a = R, to 1e-4, or 1e-3 if h > 0: each step gains a digit."""
        parabola = w = self.first_radius**-2.0
        for _ in range(4):
            w = parabola / self.widening(w)
        return w

    @property
    def spread(self) -> Any:
        """How the softer body's contact widens."""
        return self.constants.spread * exponential(-self.constants.spread_hardened * self.exponent)

    @property
    def hardens(self) -> Any:
        """Exponent of the hardening of the pressure."""
        return self.constants.strain_exponent * self.exponent

    def widened(self, beyond: Any) -> Any:
        """ω."""
        return 1.0 + self.spread * logarithm(beyond)

    def pressed(self, softer: Any) -> Pressed:
        """At w_s."""
        own = self.constants
        beyond = own.beyond(softer)
        widening = self.widened(beyond)
        radius = (softer * widening) ** 0.5
        most = own.pressure / (1.0 + (self.flattening * self.first_radius * radius) ** 1.5)
        bend = own.pressure_bend
        bent = 1.0 + (softer**0.5 - 1.0) / (bend * most)
        fallen = bent**-bend
        strained = 1.0 + own.strain * (radius - 1.0) ** 2.0 / radius
        hardened = strained**self.hardens
        mean = 1.0 + most * (1.0 - fallen)
        slope = fallen / bent + mean * self.hardens * own.strain * (1.0 - 1.0 / (radius * radius)) / strained
        return Pressed(widening, 1.0 - beyond**-own.lateness, mean * hardened, slope * hardened)

    def at(self, w: Any) -> Pressed:
        """At w: one step of Newton's method to α_s."""
        if not any_of(self.share > 0.0):
            return self.pressed(w)
        now = self.pressed(w)
        flat = self.share * (1.0 - (1.0 - FLATTENED) * now.reached)
        own = (now.widening * w) ** 0.5
        missing = self.radius_of(now, w) - (1.0 - self.share) * own - flat * now.pressure
        step = missing / (1.0 - self.share + flat * now.slope)
        return self.pressed(w * (1.0 + step / own) ** 2.0)

    def radius_of(self, now: Pressed, w: Any) -> Any:
        """α."""
        flat, sunk = 1.0 - (1.0 - FLATTENED) * now.reached, 1.0 - (1.0 - SUNK) * now.reached
        half = 0.5 * self.share * now.pressure * (sunk * now.widening - flat)
        return (now.widening * w + half * half) ** 0.5 - half

    def widening(self, w: Any) -> Any:
        """a²/(R δ)."""
        return self.contact_radius(w) ** 2.0 / w

    def tabled_widening(self, w: Any) -> Any:
        """The same within 1e-5 in an array, of one contact."""
        if any(
            isinstance(value, np.ndarray) for value in (self.yield_strain, self.exponent, self.share, self.curvature)
        ):
            return self.widening(w)
        per, widening, rise = _widenings(self)
        place = np.minimum(np.log(w) * per, rise.size - 1)
        below = place.astype(np.intp)
        return widening[below] + (place - below) * rise[below]

    def contact_radius(self, w: Any) -> Any:
        """a over that at first yield."""
        if not any_of(self.share > 0.0):
            return (w * self.widened(self.constants.beyond(w))) ** 0.5
        return self.radius_of(self.at(w), w)

    def force(self, w: Any) -> Any:
        """f."""
        now = self.at(w)
        radius = self.radius_of(now, w)
        return radius * radius * now.pressure

    def secant(self, w: Any) -> Any:
        """f_m/(w_m − w_f) of unloading."""
        own, now = self.constants, self.at(w)
        stiffer = 1.0 + own.stiffening * exponential(-own.stiffening_hardened * self.exponent) * now.reached
        sunk = 1.0 - (1.0 - SUNK) * now.reached
        return self.radius_of(now, w) * stiffer / (1.0 - self.share + self.share * sunk * stiffer)


@lru_cache(maxsize=16)
def _widenings(plastic: Plastic) -> tuple[float, Any, Any]:
    """Places per ln w, up to the end, the widening there, and its rise to the next."""
    logarithms = np.linspace(0.0, math.log(plastic.end), 2049)
    widening = plastic.widening(np.exp(logarithms))
    return 1.0 / float(logarithms[1]), widening, np.append(np.diff(widening), 0.0)


def pressure_factor(poissons_ratio: Any) -> Any:
    """C: the largest contact pressure at first yield over the yield strength.

    √(C(ν) C(0.3)) with C(ν) = 1.295 e^{0.736 ν} of Jackson & Green 2005, J. Tribol. 127:343: first yield follows C(ν),
    full plasticity does not depend on ν.
    """
    return 1.295 * exponential(0.368 * (poissons_ratio + RATIO))


def scaled_strain(yield_strain: Any, poissons_ratio: Any) -> Any:
    """S_y/E C(ν)/C(0.3): a/R at first yield depends on it alone."""
    return yield_strain * (pressure_factor(poissons_ratio) / pressure_factor(RATIO))


@dataclass(frozen=True)
class Elastoplastic(AbstractLaw):
    """Under a rigid ball, f over the force at first yield:

        w = δ/δ_Y,  δ_Y = (π C S_y/2E)² R,  C = 1.295 e^{0.368 (ν + 0.3)},  z = (w − 1)/1.762
        f = w^{3/2}                                                                       w ≤ 1
        f = α² P,  α = a/a_Y = √(ω w),  ω = 1 + 0.09639 e^{−1.505 n} ln(1 + z²)           beyond
        P = (1 + M [1 − (1 + (√w − 1)/(0.5068 M))^{−0.5068}]) (1 + 0.5642 (α − 1)²/α)^{0.7185 n}
        M = 2.379/(1 + (0.5506 a/R)^{3/2})
        f_m/(w_m − w_f) = α k,  k = 1 + 0.2631 e^{−0.603 n} g                             unloading, exponent
        g = 1 − (1 + z²)^{−0.2434}                                                        1.5 − 0.1641 g

    Restitution leaves 1 as (w − 1)². C is the geometric mean of those for ν and 0.3, because ν matters at first yield
    only: for ν = 0.2 or 0.45 the law leaves Hertz's at 4 % above or 5 % below the pressure of first yield,
    1.295 e^{0.736 ν} S_y.

    elastic_share h: part of the compliance of a second body that stays elastic; 0: rigid. As if pressed by a rigid ball
    of the radius R/(1 − h c₁ P/α) at a w_s of its own, where α_s, ω, P, g and k are taken:

        w = w_s (1 − h) α/α_s + h c₂ α P,  α = (1 − h) α_s + h c₁ P,  so α² + h P (c₂ ω − c₁) α = ω w
        c₁ = 1 − 0.383 g,  c₂ = 1 − 0.151 g              from Hertz's to a uniform pressure (Johnson 1985)
        f = α² P,  f_m/(w_m − w_f) = α k/(1 − h + h c₂ k)
        M = 2.379/(1 + (0.5506 [1 − h (1 − x)] α_s a_Y/R)^{3/2})
        h = φ/(1 + m) ≤ 0.8,  φ = 1 − ((2.692 − s)/1.692)⁴            in a scene

    w_s is one step of Newton's method from w. m: E/(1 − ν²) of the body that yields later over that of the other. s:
    ratio of flow stresses at a plastic strain of 0.005. Equal bodies yield alike (φ = 0); from s = 2.692 on the harder
    one stays elastic.

    softer_curvature x: part of the curvature 1/R that the softer body has; 0: it is flat, 1: the harder one is; of two
    balls R/R_s. M falls with the slope at the contact's edge, (1 − h) α_s a_Y/R of that rigid ball. A softer ball has a
    slope of its own, however the harder body flattens: the part h x, without a constant; under a rigid body it is left
    out, where it lowers the force by up to 2 %.

    Fitted to 142 finite-element impacts of a rigid ball and 51 of two bodies, without friction: von Mises, flow stress
    S_y (1 + E ε_p/S_y)^n. Largest errors, of impacts not fitted too: 2.5 % up to 1000 V_Y, 6 % beyond, 5 % of two
    bodies (docs/finite_elements.md).

    strain_hardening_exponent n: of the material, default 0. Of two bodies that yield, strength, ν and n are those of
    the softer. Two equal bodies have half of a/R in M.
    """

    name: ClassVar[str] = "elastoplastic"
    family: ClassVar[Family] = "yields"
    summary: ClassVar[str] = "finite elements of a sphere that yields and hardens, loading and unloading"
    source: ClassVar[str] = "fitted to axisymmetric finite elements made for this package"
    validity: ClassVar[str] = (
        "computed for a/R and n up to 0.4, S_y/E up to 0.019 and δ up to 1810 δ_Y; ends where a = R"
    )
    shaped_by: ClassVar[tuple[str, ...]] = ("effective_modulus", "yield_strength", "poissons_ratio")
    shaped_beside: ClassVar[Mapping[str, tuple[float, float]]] = {
        "strain_hardening_exponent": (0.0, MOST_HARDENING),
        "elastic_share": (0.0, MOST_SHARE),
        "softer_curvature": (0.0, 1.0),
    }

    effective_modulus: float
    radius: float
    yield_strength: float
    poissons_ratio: float
    strain_hardening_exponent: float = 0.0
    elastic_share: float = 0.0
    softer_curvature: float = 0.0

    def __post_init__(self) -> None:
        strain, n = self.yield_strength / self.effective_modulus, self.strain_hardening_exponent
        share, curvature = self.elastic_share, self.softer_curvature
        known = (strain >= LEAST_YIELD_STRAIN) & (strain < MOST_YIELD_STRAIN) & (n >= 0.0) & (n <= MOST_HARDENING)
        if all_of(known & (share >= 0.0) & (share <= MOST_SHARE) & (curvature >= 0.0) & (curvature <= 1.0)):
            return
        if not all_of(strain < MOST_YIELD_STRAIN):
            raise ValueError(f"law elastoplastic: S_y/E is {np.max(strain):.3g}; it must be below {MOST_YIELD_STRAIN}")
        if not all_of(strain >= LEAST_YIELD_STRAIN):
            raise ValueError(f"law elastoplastic: S_y/E is {np.min(strain):.3g}; least is {LEAST_YIELD_STRAIN:g}")
        if not all_of((n >= 0.0) & (n <= MOST_HARDENING)):
            raise ValueError(f"law elastoplastic: the strain hardening exponent must be from 0 to {MOST_HARDENING}")
        if not all_of((share >= 0.0) & (share <= MOST_SHARE)):
            raise ValueError(f"law elastoplastic: the elastic share must be from 0 to {MOST_SHARE}")
        raise ValueError("law elastoplastic: the softer body's part of the curvature must be from 0 to 1")

    @property
    def shape(self) -> float:
        """That of `scaled_strain`."""
        return scaled_strain(self.yield_strength / self.effective_modulus, self.poissons_ratio)

    def of_shape(self, shape: float) -> Elastoplastic:
        beside = self.strain_hardening_exponent, self.elastic_share, self.softer_curvature
        return Elastoplastic(1.0, 1.0, shape, RATIO, *beside)

    @property
    def _plastic(self) -> Plastic:
        beside = self.strain_hardening_exponent, self.elastic_share
        return Plastic(self.shape, *beside, curvature=self.softer_curvature)

    def outside(self, depth: float) -> str:
        if not depth > 1.0:
            return ""
        plastic = self._plastic
        computed = (
            ("S_y/E is {:.3g}", self.yield_strength / self.effective_modulus, "0.019"),
            ("n is {:.3g}", self.strain_hardening_exponent, "0.4"),
            ("the harder body has {:.3g} of the compliance or more", self.elastic_share, "0.66"),
            ("the indentation is {:.3g} of that at first yield", depth, "1810"),
            ("the contact radius is {:.3g} of the ball's", plastic.first_radius * plastic.contact_radius(depth), "0.4"),
        )
        said = [f"{what.format(x)}, computed was up to {most}" for what, x, most in computed if x > float(most)]
        return " and ".join(said)

    def scales(self, energy: float) -> tuple[float, float]:
        strength = pressure_factor(self.poissons_ratio) * self.yield_strength
        return limit_point(self.effective_modulus, self.radius, strength)

    def stages(self) -> tuple[Stage, ...]:
        plastic = self._plastic
        unloading = Unloading(secant=plastic.secant, exponent=FITTED.exponent)
        return (
            Stage("elastic", 0.0, 1.0, Power(coefficient=1.0, exponent=1.5, origin=0.0)),
            Stage("elastoplastic", 1.0, plastic.end, plastic.force, unloading),
        )
