"""What the damped laws of spheres share: Hertz's force with a dashpot that grows as a power of the indentation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.hertz import Hertz, hertz_stiffness
from film_model.laws.law import AbstractLaw, Family, Power, Stage, raise_wrong


@dataclass(frozen=True)
class DampedSphere(AbstractLaw):
    """F = K δ^{3/2} + c δ^q δ̇. damping_exponent: q."""

    family: ClassVar[Family] = "damped"
    damped: ClassVar[bool] = True
    damping_exponent: ClassVar[float]

    effective_modulus: float
    radius: float

    def __post_init__(self) -> None:
        raise_wrong(self)

    @property
    def _stiffness(self) -> float:
        """K [N/m^1.5]."""
        return hertz_stiffness(self.effective_modulus, self.radius)

    def scales(self, energy: float) -> tuple[float, float]:
        return Hertz(self.effective_modulus, self.radius).scales(energy)

    def stages(self) -> tuple[Stage, ...]:
        damping = Power(coefficient=1.0, exponent=self.damping_exponent)
        return (Stage("elastic", 0.0, float("inf"), Power(coefficient=1.0, exponent=1.5), damping=damping),)
