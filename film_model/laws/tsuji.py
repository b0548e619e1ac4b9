"""Hertz's spring with Tsuji's dashpot, whose restitution does not depend on the velocity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.damped_sphere import DampedSphere
from film_model.laws.damping import spring_ratio
from film_model.laws.law import ExampleBall, Parameter, wrong_restitution


@dataclass(frozen=True)
class Tsuji(DampedSphere):
    """Tsuji, Tanaka & Ishida 1992, Powder Technol. 71:239; α for an end at F = 0: derived here.

        F = K δ^{3/2} + α √(m K) δ^{1/4} δ̇  until F = 0,  α = √5 ζ(e),  ζ(e) that of linear-dashpot

    It is a linear dashpot in w = δ^{5/4} and δ̇. The usual α = √5 β, β = −ln e/√(π² + ln² e), holds with tension until
    δ = 0; without it gives 0.550 for e = 0.5.
    """

    name: ClassVar[str] = "tsuji"
    summary: ClassVar[str] = "Hertz with a dashpot α √(m K) δ^¼: one restitution for all velocities"
    source: ClassVar[str] = "Tsuji, Tanaka & Ishida 1992, Powder Technol. 71:239; α for an end at F = 0: derived here"
    validity: ClassVar[str] = "a spring of granular simulations: no material has one restitution"
    parameters: ClassVar[Mapping[str, Parameter]] = {"restitution": Parameter("e on a fixed target")}
    damping_exponent: ClassVar[float] = 0.25

    restitution: float

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"restitution": 0.6}

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        return 5.0**0.5 * spring_ratio(self.restitution) * (mass * self._stiffness) ** 0.5 * length**0.25

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        return wrong_restitution(values)
