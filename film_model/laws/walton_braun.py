"""Walton and Braun's pair of springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.law import AbstractLaw, ExampleBall, Family, Parameter, Power, Stage, Unloading


@dataclass(frozen=True)
class WaltonBraun(AbstractLaw):
    """Walton & Braun 1986, J. Rheol. 30:949.

        F = k_1 δ                                                             loading
        F = k_2 (δ − δ_f),  δ_f = (1 − k_1/k_2) δ_m                           unloading and reloading
        e = √(k_1/k_2),  t_c = (π/2) √(m/k_1) (1 + e)                         on a half-space, at any velocity

    k_2 ≥ k_1.
    """

    name: ClassVar[str] = "walton-braun"
    family: ClassVar[Family] = "spring"
    summary: ClassVar[str] = "two springs, k_1 δ and k_2 (δ − δ_f): restitution √(k_1/k_2)"
    source: ClassVar[str] = "Walton & Braun 1986, J. Rheol. 30:949"
    validity: ClassVar[str] = "a spring with a chosen restitution, not a material"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "loading_stiffness": Parameter("k_1", dimension="stiffness"),
        "unloading_stiffness": Parameter("k_2, at least k_1", dimension="stiffness"),
    }

    loading_stiffness: float
    unloading_stiffness: float

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"loading_stiffness": ball.spring, "unloading_stiffness": 2.0 * ball.spring}

    def scales(self, energy: float) -> tuple[float, float]:
        indentation = (energy / self.loading_stiffness) ** 0.5
        return indentation, self.loading_stiffness * indentation

    def stages(self) -> tuple[Stage, ...]:
        unloading = Unloading(secant=Power(constant=self.unloading_stiffness / self.loading_stiffness), exponent=1.0)
        return (Stage("loading", 0.0, float("inf"), Power(slope=1.0), unloading),)

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        low, high = values["loading_stiffness"], values["unloading_stiffness"]
        if high >= low:
            return {}
        return {"unloading_stiffness": f"{high:g} N/m must be >= loading_stiffness {low:g} N/m"}
