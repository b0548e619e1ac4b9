"""The force of law large-slope with Tsuji's dashpot: soft balls with losses."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.large_slope import BALL, STEEP_FORCE, steep_scales, wrong_coefficient
from film_model.laws.law import ExampleBall, Power, Stage
from film_model.laws.tsuji import Tsuji


@dataclass(frozen=True)
class DampedLargeSlope(Tsuji):
    """The force of law large-slope with a dashpot like that of law tsuji:

        F = K δ^{3/2} (1 + c √(δ/R)) + α √(m K) (δ^{1/4} + 1.2 δ_s^{−3/4} δ) δ̇  until F = 0

    α is that of tsuji. The second term keeps e for all velocities: 1 − e within 2 % up to √(δ/R) = 0.4 by Hertz's law,
    4 % at 0.5.
    """

    name: ClassVar[str] = "damped-large-slope"
    summary: ClassVar[str] = "large-slope with a dashpot: soft balls with one restitution for all velocities"
    source: ClassVar[str] = "large-slope and tsuji"
    validity: ClassVar[str] = "√(δ/R) up to about 0.5"
    widening: ClassVar[float] = 1.0
    steep: ClassVar[bool] = True

    slope_coefficient: float = BALL

    def scales(self, energy: float) -> tuple[float, float]:
        return steep_scales(self.effective_modulus, self.radius, self.slope_coefficient)

    def stages(self) -> tuple[Stage, ...]:
        damping = Power(slope=1.2, coefficient=1.0, exponent=self.damping_exponent)
        return (Stage("elastic", 0.0, math.inf, STEEP_FORCE, damping=damping),)

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"restitution": 0.8}

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        return wrong_coefficient(values) | super().settle(values)
