"""Jackson and Green's finite-element law of a sphere, whose hardness falls with the contact radius."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from film_model.base.arrays import all_of, exponential, greater
from film_model.laws.law import AbstractLaw, Array, Family, Parameter, Power, Stage, Unloading
from film_model.laws.yielding import MOST_YIELD_STRAIN, limit_point

ELASTIC_LIMIT = 1.9  # ω/ω_c up to which the force is Hertz's, though the contact has yielded at 1
LAST_RESIDUAL = ELASTIC_LIMIT * 2.0**9  # 973 ω/ω_c up to which the residual indentation is the published one
FITTED_STRAIN = (0.001, 0.009)  # S_y/E
FITTED_RADIUS = 0.41  # a/R


@dataclass(frozen=True)
class Plastic:
    """f(w) beyond 1.9 for e_y = S_y/E and C; `mended`: with the correction that removes the jump at 1.9."""

    yield_strain: float
    yield_factor: float
    mended: bool

    @property
    def radius_factor(self) -> float:
        """π C e_y/2."""
        return 0.5 * math.pi * self.yield_factor * self.yield_strain

    @property
    def growth(self) -> float:
        """B = 0.14 e^{23 e_y}."""
        return 0.14 * exponential(23.0 * self.yield_strain)

    @property
    def end(self) -> float:
        """w at which the contact radius would be the sphere's."""
        b = self.growth
        return (ELASTIC_LIMIT ** (b / (1.0 + b))) * self.radius_factor ** (-2.0 / (1.0 + b))

    def contact_radius(self, w: Any) -> Any:
        """a/R."""
        return self.radius_factor * (w * (w / ELASTIC_LIMIT) ** self.growth) ** 0.5

    def printed(self, w: Array) -> Array:
        """The law as published."""
        radius = self.radius_factor * np.sqrt(w * (w / ELASTIC_LIMIT) ** self.growth)  # a/R
        hardness = 2.84 * -np.expm1(-0.82 * radius**-0.7)  # H_G/S_y
        return np.exp(-0.25 * w ** (5.0 / 12.0)) * w**1.5 + 4.0 * hardness / self.yield_factor * w * -np.expm1(
            -(w ** (5.0 / 9.0)) / 25.0
        )

    def __call__(self, w: Array) -> Array:
        force = self.printed(w)
        if not self.mended:
            return force
        jump = ELASTIC_LIMIT**1.5 / self.printed(np.array([ELASTIC_LIMIT])) - 1.0
        # the correction decays by a factor e over 1.9 ω_c
        return force * (1.0 + jump * np.exp((ELASTIC_LIMIT - w) / 1.9))


def _residual(w: Array) -> Array:
    """As published; that exceeds w beyond 10,050, so the recovered part falls as w^{−0.54} from `LAST_RESIDUAL` on."""
    deep = np.minimum(w, LAST_RESIDUAL)
    recovered = 1.0 - 1.02 * (1.0 - ((deep + 5.9) / 6.9) ** -0.54)
    return w * (1.0 - recovered * (w / deep) ** -0.54)


@dataclass(frozen=True)
class JacksonGreen(AbstractLaw):
    """Jackson & Green 2005, J. Tribol. 127:343; Jackson, Green & Marghitu 2010, Nonlinear Dyn. 60:217.

        w = δ/ω_c,  ω_c = (π C S_y/2E)² R,  C = 1.295 e^{0.736 ν},  e_y = S_y/E,  B = 0.14 e^{23 e_y}
        f = w^{3/2}                                                                        w ≤ 1.9
        f = e^{−w^{5/12}/4} w^{3/2} + (4 H_G/(C S_y)) [1 − e^{−w^{5/9}/25}] w              beyond
        H_G/S_y = 2.84 [1 − exp(−0.82 (a/R)^{−0.7})],  a/R = (π C e_y/2) √(w (w/1.9)^B)
        w_f = 1.02 w_m [1 − ((w_m + 5.9)/6.9)^{−0.54}]                                     Hertz's curve, w_m > 1

    Beyond w_m = 973, where the last would recover too little, 1 − w_f/w_m falls as w_m^{−0.54}. ν: of the body that
    yields. constants "printed": the force jumps at 1.9 by +0.5 % for ν = 0.3, −2.5 % for 0.45. "continuous" (our own
    variant): a correction of that jump decays as exp((1.9 − w)/1.9).
    """

    name: ClassVar[str] = "jackson-green"
    family: ClassVar[Family] = "yields"
    summary: ClassVar[str] = "finite-element law with a hardness that depends on a/R; residual-indentation unloading"
    source: ClassVar[str] = (
        "Jackson & Green 2005, J. Tribol. 127:343; Jackson, Green & Marghitu 2010, Nonlinear Dyn. 60:217"
    )
    validity: ClassVar[str] = "fitted for a/R below 0.41 and S_y/E from 0.001 to 0.009; ends where a = R"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "constants": Parameter(
            "force at 1.9 critical indentations: continuous, or as printed",
            choices=("continuous", "printed"),
            required=False,
        )
    }

    shaped_by: ClassVar[tuple[str, ...]] = ("effective_modulus", "yield_strength")
    shaped_beside: ClassVar[Mapping[str, tuple[float, float]]] = {"poissons_ratio": (-1.0, 0.5)}

    effective_modulus: float
    radius: float
    yield_strength: float
    poissons_ratio: float
    constants: str = "continuous"

    @property
    def yield_factor(self) -> float:
        """C: the largest contact pressure at first yield over the yield strength."""
        return 1.295 * exponential(0.736 * self.poissons_ratio)

    def __post_init__(self) -> None:
        strain = self.shape
        if not all_of(strain < MOST_YIELD_STRAIN):
            raise ValueError(f"law jackson-green: S_y/E is {np.max(strain):.3g}; it must be below {MOST_YIELD_STRAIN}")

    @property
    def shape(self) -> float:
        """e_y = S_y/E."""
        return self.yield_strength / self.effective_modulus

    def of_shape(self, shape: float) -> JacksonGreen:
        return JacksonGreen(1.0, 1.0, shape, self.poissons_ratio, self.constants)

    def outside(self, depth: float) -> str:
        strain, said = self.shape, list[str]()
        if not FITTED_STRAIN[0] <= strain <= FITTED_STRAIN[1]:
            said.append(f"S_y/E is {strain:.3g}, fitted were {FITTED_STRAIN[0]} to {FITTED_STRAIN[1]}")
        radius = Plastic(strain, self.yield_factor, True).contact_radius(depth)
        if radius > FITTED_RADIUS:
            said.append(f"the contact radius is {radius:.3g} of the ball's, fitted was up to {FITTED_RADIUS}")
        return " and ".join(said) if depth > 1.0 else ""

    def scales(self, energy: float) -> tuple[float, float]:
        return limit_point(self.effective_modulus, self.radius, self.yield_factor * self.yield_strength)

    def stages(self) -> tuple[Stage, ...]:
        plastic = Plastic(self.shape, self.yield_factor, self.constants == "continuous")
        hertz, unloading = Power(coefficient=1.0, exponent=1.5, origin=0.0), Unloading(residual=_residual)
        return (
            Stage("elastic", 0.0, 1.0, hertz),
            Stage("yielded", 1.0, ELASTIC_LIMIT, hertz, unloading),
            Stage(
                "plastic",
                ELASTIC_LIMIT,
                greater(plastic.end, 2.0 * ELASTIC_LIMIT),
                plastic,
                unloading,
                knots=(LAST_RESIDUAL,),
            ),
        )
