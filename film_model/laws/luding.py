"""Luding's piecewise linear law, whose unloading stiffness grows with the indentation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.law import AbstractLaw, ExampleBall, Family, Parameter, Power, Stage, Unloading


@dataclass(frozen=True)
class Luding(AbstractLaw):
    """Luding 2008, Granul. Matter 10:235.

        F = k_1 δ                                                             loading, up to δ*
        F = k_2 (δ − δ_f),  δ_f = (1 − k_1/k_2) δ_m                           unloading and reloading
        k_2 = k_1 + (k_p − k_1) δ_m/δ*,  δ* = (k_p/(k_p − k_1)) φ_f 2R
        F = k_p (δ − φ_f 2R)                                                  beyond δ*, both ways
        e = √(k_1/k_2(δ_m))                                                   on a half-space, up to δ*

    Without adhesion.
    """

    name: ClassVar[str] = "luding"
    family: ClassVar[Family] = "spring"
    summary: ClassVar[str] = "springs k_1 and k_2(δ_m), elastic k_p beyond a plasticity depth; no adhesion"
    source: ClassVar[str] = "Luding 2008, Granul. Matter 10:235"
    validity: ClassVar[str] = "a spring of granular simulations, not a material"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "loading_stiffness": Parameter("k_1", dimension="stiffness"),
        "plastic_stiffness": Parameter("k_p, above k_1", dimension="stiffness"),
        "plasticity_depth": Parameter("φ_f: deepest dent over twice the effective radius"),
    }

    radius: float
    loading_stiffness: float
    plastic_stiffness: float
    plasticity_depth: float

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {
            "loading_stiffness": ball.spring,
            "plastic_stiffness": 5.0 * ball.spring,
            "plasticity_depth": 1.2 * ball.depth / (2.0 * ball.radius),
        }

    def scales(self, energy: float) -> tuple[float, float]:
        share = 1.0 - self.loading_stiffness / self.plastic_stiffness
        indentation = self.plasticity_depth * 2.0 * self.radius / share
        return indentation, self.loading_stiffness * indentation

    def stages(self) -> tuple[Stage, ...]:
        ratio = self.plastic_stiffness / self.loading_stiffness
        growing = Unloading(secant=Power(constant=1.0, slope=ratio - 1.0), exponent=1.0)
        limit = Unloading(residual=Power(constant=1.0 - 1.0 / ratio), exponent=1.0)
        return (
            Stage("plastic", 0.0, 1.0, Power(slope=1.0), growing),
            Stage("limit", 1.0, float("inf"), Power(constant=1.0, slope=ratio), limit),
        )

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        low, high = values["loading_stiffness"], values["plastic_stiffness"]
        return {} if high > low else {"plastic_stiffness": f"{high:g} N/m must be > loading_stiffness {low:g} N/m"}
