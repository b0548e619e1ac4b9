"""Hertz's spring with Tsuji's dashpot, whose restitution does not depend on the velocity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.damping import spring_ratio
from film_model.laws.hertz import Hertz, hertz_stiffness
from film_model.laws.law import (
    AbstractLaw,
    ExampleBall,
    Family,
    Parameter,
    Power,
    Stage,
    raise_wrong,
    wrong_restitution,
)


@dataclass(frozen=True)
class Tsuji(AbstractLaw):
    """Tsuji, Tanaka & Ishida 1992, Powder Technol. 71:239; α for an end at F = 0: derived here.

        F = K δ^{3/2} + α √(m K) δ^{1/4} δ̇  until F = 0,  α = √5 ζ(e),  ζ(e) that of linear-dashpot

    It is a linear dashpot in w = δ^{5/4} and δ̇. The usual α = √5 β, β = −ln e/√(π² + ln² e), holds with tension until
    δ = 0; without it gives 0.550 for e = 0.5.
    """

    name: ClassVar[str] = "tsuji"
    family: ClassVar[Family] = "damped"
    summary: ClassVar[str] = "Hertz with a dashpot α √(m K) δ^¼: one restitution for all velocities"
    source: ClassVar[str] = "Tsuji, Tanaka & Ishida 1992, Powder Technol. 71:239; α for an end at F = 0: derived here"
    validity: ClassVar[str] = "a spring of granular simulations: no material has one restitution"
    parameters: ClassVar[Mapping[str, Parameter]] = {"restitution": Parameter("e on a fixed target")}
    damped: ClassVar[bool] = True

    effective_modulus: float
    radius: float
    restitution: float

    def __post_init__(self) -> None:
        raise_wrong(self)

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"restitution": 0.6}

    def scales(self, energy: float) -> tuple[float, float]:
        return Hertz(self.effective_modulus, self.radius).scales(energy)

    def stages(self) -> tuple[Stage, ...]:
        damping = Power(coefficient=1.0, exponent=0.25)
        return (Stage("elastic", 0.0, float("inf"), Power(coefficient=1.0, exponent=1.5), damping=damping),)

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        stiffness = hertz_stiffness(self.effective_modulus, self.radius)
        return 5.0**0.5 * spring_ratio(self.restitution) * (mass * stiffness) ** 0.5 * length**0.25

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        return wrong_restitution(values)
