"""Hunt and Crossley: damping proportional to the elastic force."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from film_model.laws.damped_sphere import DampedSphere
from film_model.laws.damping import hunt_crossley_strength
from film_model.laws.law import ExampleBall, Parameter, wrong_restitution


@dataclass(frozen=True)
class HuntCrossley(DampedSphere):
    """Hunt & Crossley 1975, J. Appl. Mech. 42:440; χ by the exact inversion.

        F = K δ^{3/2} (1 + χ δ̇),  K = (4/3) E √R
        χ = λ/V_0,  λ (1 + e) = ln((1 + λ)/(1 − λ e))                         exact for any exponent of δ

    Force and indentation end together, without tension. e holds at the scene's velocity V_0. Other notations give K χ.
    """

    name: ClassVar[str] = "hunt-crossley"
    summary: ClassVar[str] = "Hertz with damping proportional to the force, K δ^1.5 (1 + χ δ̇)"
    source: ClassVar[str] = "Hunt & Crossley 1975, J. Appl. Mech. 42:440; χ by the exact inversion"
    validity: ClassVar[str] = "near the velocity at which χ was found; restitution falls with velocity"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "restitution": Parameter("e at the approach velocity on a fixed target; or hysteresis_damping", required=False),
        "hysteresis_damping": Parameter(
            "χ; or restitution", dimension="inverse_velocity", required=False, above=None, minimum=0.0
        ),
    }
    damping_exponent: ClassVar[float] = 1.5

    restitution: float | None = None
    hysteresis_damping: float | None = None

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"restitution": 0.6}

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        force = self._stiffness * length**1.5
        if self.hysteresis_damping is not None:
            return self.hysteresis_damping * force + 0.0 * mass
        assert self.restitution is not None
        if np.any(np.asarray(velocity) <= 0.0):
            raise ValueError("law hunt-crossley: a restitution needs an approach velocity; give hysteresis_damping")
        return hunt_crossley_strength(self.restitution) / velocity * force

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        return wrong_restitution(values, "hysteresis_damping")
