"""Kuwabara and Kono's viscoelastic sphere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.damped_sphere import DampedSphere
from film_model.laws.law import ExampleBall, Parameter


@dataclass(frozen=True)
class KuwabaraKono(DampedSphere):
    """Kuwabara & Kono 1987, Jpn. J. Appl. Phys. 26:1230; Brilliantov et al. 1996, Phys. Rev. E 53:5382.

        F = K δ^{3/2} + (3/2) A K √δ δ̇ = (1 + A d/dt) K δ^{3/2}  until F = 0,  K = (4/3) E √R
        e = 1 − 1.15345 s² + …,  s² = (3/2) A (K/m)^{2/5} V^{1/5}             on a fixed target
        e ≈ (1 + 0.501086 s)/(1 + 0.501086 s + 1.15345 s² + 0.577978 s³ + 0.532178 s⁴)

    The last is Müller & Pöschel's (2011, Phys. Rev. E 84:021302). Valid for A δ̇ ≪ δ.
    """

    name: ClassVar[str] = "kuwabara-kono"
    summary: ClassVar[str] = "viscoelastic sphere, (1 + A d/dt) K δ^1.5"
    source: ClassVar[str] = (
        "Kuwabara & Kono 1987, Jpn. J. Appl. Phys. 26:1230; Brilliantov et al. 1996, Phys. Rev. E 53:5382"
    )
    validity: ClassVar[str] = "weak, quasi-static viscoelasticity: a dissipation time much shorter than the contact"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "dissipation_time": Parameter("A", dimension="time", above=None, minimum=0.0)
    }
    damping_exponent: ClassVar[float] = 0.5

    dissipation_time: float

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"dissipation_time": 0.2 * ball.depth / ball.velocity}

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        return 1.5 * self.dissipation_time * self._stiffness * length**0.5 + 0.0 * mass
