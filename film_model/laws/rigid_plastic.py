"""Johnson's fully plastic sphere: constant pressure during loading, elastic recovery during unloading."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.law import AbstractLaw, Family, Parameter, Power, Stage
from film_model.laws.unloading import brake_unloading
from film_model.laws.yielding import pressure_over


@dataclass(frozen=True)
class RigidPlastic(AbstractLaw):
    """Johnson 1985, Contact Mechanics, section 11.5.

        F = 2 π R p_d δ,  a² = 2 R δ
        δ_m − δ_f = 3 F_m/(4 E a)                                             recovery by Hertz's curve of that a
        e = 1.884 √(p_d/E) (W/(p_d R³))^{−1/8} ∝ V^{−1/4},  W = ½ m V²

    Below δ_s = (9π²/8) (p_d/E)² R the law leaves no dent, and e = 0.894.
    """

    name: ClassVar[str] = "rigid-plastic"
    family: ClassVar[Family] = "yields"
    widening: ClassVar[float] = 2.0
    summary: ClassVar[str] = "constant pressure, F = 2 π R p_d δ; elastic recovery of the contact radius"
    source: ClassVar[str] = "Johnson 1985, Contact Mechanics, section 11.5"
    validity: ClassVar[str] = "far beyond yield, V above some hundred V_Y; no elastic stage"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "yield_pressure": pressure_over(3.0, "dynamic contact pressure p_d")
    }

    effective_modulus: float
    radius: float
    yield_pressure: float

    def scales(self, energy: float) -> tuple[float, float]:
        indentation = 9.0 * math.pi**2 / 8.0 * (self.yield_pressure / self.effective_modulus) ** 2 * self.radius
        return indentation, 2.0 * math.pi * self.radius * self.yield_pressure * indentation

    def stages(self) -> tuple[Stage, ...]:
        return (Stage("plastic", 0.0, float("inf"), Power(slope=1.0), brake_unloading()),)
