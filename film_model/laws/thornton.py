"""Thornton: elastic, then perfectly plastic under a limiting contact pressure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.law import AbstractLaw, Family, Parameter, Power, Stage
from film_model.laws.unloading import brake_unloading
from film_model.laws.yielding import limit_point, pressure_over


@dataclass(frozen=True)
class Thornton(AbstractLaw):
    """Thornton 1997, J. Appl. Mech. 64:383.

        F = F_y + π R p_y (δ − δ_y),  δ_y = (π p_y/2E)² R        f = 1 + (3/2)(d − 1),  d = δ/δ_y
        R_p = R F_Hertz(δ_m)/F_m                                 of Hertz's unloading, from a² = R δ_m
        e = √(6√3/5) (1 − v²/6)^{1/2} [v/(v + 2√((6 − v²)/5))]^{1/4},  v = V_Y/V;  1.18499 v^{1/4} for V ≫ V_Y

    p_y: 1.6 S_y at first yield, 2.5 to 3 S_y to match deep indentations.
    """

    name: ClassVar[str] = "thornton"
    family: ClassVar[Family] = "yields"
    widening: ClassVar[float] = 1.0
    summary: ClassVar[str] = (
        "elastic, then linear under a limiting pressure; Hertz unloading from the same contact radius"
    )
    source: ClassVar[str] = "Thornton 1997, J. Appl. Mech. 64:383"
    validity: ClassVar[str] = "a/R below about 0.2; no strain hardening, one pressure from yield to full plasticity"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "yield_pressure": pressure_over(1.6, "limiting contact pressure p_y")
    }

    effective_modulus: float
    radius: float
    yield_pressure: float

    def scales(self, energy: float) -> tuple[float, float]:
        return limit_point(self.effective_modulus, self.radius, self.yield_pressure)

    def stages(self) -> tuple[Stage, ...]:
        return (
            Stage("elastic", 0.0, 1.0, Power(coefficient=1.0, exponent=1.5)),
            Stage("plastic", 1.0, float("inf"), Power(constant=1.0, slope=1.5), brake_unloading()),
        )
