"""Kogut and Etsion's finite-element law of a sphere on a rigid flat, with the unloading of Etsion and others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.law import AbstractLaw, Array, Family, Parameter, Power, Stage, Unloading
from film_model.laws.yielding import limit_point

STAGES = ((1.0, 1.03, 1.425), (6.0, 1.40, 1.263))  # ω/ω_c at which each begins, its coefficient and its exponent
FULLY_PLASTIC = 110.0


def _residual(w: Array) -> Array:
    return w * (1.0 - w**-0.28) * (1.0 - w**-0.69)


def _exponent(w: Array) -> Array:
    return 1.5 * w**-0.0331


@dataclass(frozen=True)
class KogutEtsion(AbstractLaw):
    """Kogut & Etsion 2002, J. Appl. Mech. 69:657; Etsion, Kligerman & Kadin 2005, Int. J. Solids Struct. 42:3716.

        w = δ/ω_c,  ω_c = (π K_ν H/2E)² R,  K_ν = 0.454 + 0.41 ν
        f = w^{3/2}              w ≤ 1
        f = 1.03 w^{1.425}       w ≤ 6
        f = 1.40 w^{1.263}       w ≤ 110
        f = (3/K_ν) w            beyond, the pressure H
        w_f = w_m (1 − w_m^{−0.28})(1 − w_m^{−0.69}),  q = 1.5 w_m^{−0.0331}        unloading

    ν: of the body that yields. constants "printed": the force jumps by +3.0 % at 1, +1.7 % at 6 and (ν = 0.3) +7.9 % at
    110, and just above yield more energy returns than was stored. "continuous" (our own variant): 1 and 6^{0.162} for
    1.03 and 1.40, and a last stage without a jump.
    """

    name: ClassVar[str] = "kogut-etsion"
    family: ClassVar[Family] = "yields"
    summary: ClassVar[str] = "finite-element power laws of a sphere up to the hardness; Etsion's unloading"
    source: ClassVar[str] = (
        "Kogut & Etsion 2002, J. Appl. Mech. 69:657; Etsion, Kligerman & Kadin 2005, Int. J. Solids Struct. 42:3716"
    )
    validity: ClassVar[str] = "fitted up to 110 critical indentations (unloading: 170); ends at 100000"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "hardness": Parameter(
            "H of the body that yields, by default the material's, or 2.8 times its strength",
            "pressure",
            required=False,
            over_strength=2.8,
        ),
        "constants": Parameter(
            "coefficients: continuous force, or as printed", choices=("continuous", "printed"), required=False
        ),
    }

    effective_modulus: float
    radius: float
    poissons_ratio: float
    hardness: float
    constants: str = "continuous"

    @property
    def pressure_factor(self) -> float:
        """K_ν: the largest contact pressure at first yield over the hardness."""
        return 0.454 + 0.41 * self.poissons_ratio

    def outside(self, depth: float) -> str:
        return f"{depth:.4g} critical indentations, fitted were up to 110" if depth > FULLY_PLASTIC else ""

    def scales(self, energy: float) -> tuple[float, float]:
        return limit_point(self.effective_modulus, self.radius, self.pressure_factor * self.hardness)

    def stages(self) -> tuple[Stage, ...]:
        printed = self.constants == "printed"
        unloading = Unloading(residual=_residual, exponent=_exponent)
        stages = [Stage("elastic", 0.0, 1.0, Power(coefficient=1.0, exponent=1.5))]
        ends = (6.0, FULLY_PLASTIC)
        force = 1.0
        for (begin, coefficient, power), end, name in zip(STAGES, ends, ("first", "second"), strict=True):
            factor = coefficient if printed else force / begin**power
            curve = Power(coefficient=factor, exponent=power, origin=0.0)
            stages.append(Stage(f"{name} elastoplastic", begin, end, curve, unloading))
            force = factor * end**power
        slope = 3.0 / self.pressure_factor
        last = Power(constant=slope * FULLY_PLASTIC if printed else force, slope=slope)
        # beyond 2e5 ω_c the unloading exponent would fall below one
        return (*stages, Stage("fully plastic", FULLY_PLASTIC, 1e5, last, unloading))
