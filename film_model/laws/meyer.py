"""Meyer's power law, with an offset in force and indentation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.law import AbstractLaw, ExampleBall, Family, Parameter, Power, Stage


@dataclass(frozen=True)
class Meyer(AbstractLaw):
    """Meyer 1908; Big-Alabo, Cartmell & Harrison 2017, equations (1) and (9).

        F = F_0 + K_c (δ − δ_0)^q  for δ ≥ δ_0, else 0

    q: springs and flat punches 1, spheres 1.5, cones 2. F_0, δ_0 ≥ 0.
    """

    name: ClassVar[str] = "meyer"
    family: ClassVar[Family] = "elastic"
    summary: ClassVar[str] = "power law F = F0 + K (δ − δ0)^q, reversible"
    source: ClassVar[str] = "Meyer 1908; Big-Alabo, Cartmell & Harrison 2017, equations (1) and (9)"
    validity: ClassVar[str] = "where your power law was fitted; reversible"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "stiffness": Parameter("K_c, in N/m^q with the exponent q", dimension="meyer_stiffness"),
        "exponent": Parameter("q"),
        "initial_force": Parameter("F0", dimension="force", required=False, above=None, minimum=0.0),
        "initial_indentation": Parameter("δ0", dimension="length", required=False, above=None, minimum=0.0),
    }

    stiffness: float
    exponent: float
    initial_force: float = 0.0
    initial_indentation: float = 0.0

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"stiffness": 0.9 * ball.stiffness / ball.depth**0.5, "exponent": 2.0}

    def scales(self, energy: float) -> tuple[float, float]:
        if self.initial_force > 0.0:
            return (self.initial_force / self.stiffness) ** (1.0 / self.exponent), self.initial_force
        indentation = self.initial_indentation or (energy / self.stiffness) ** (1.0 / (self.exponent + 1.0))
        return indentation, self.stiffness * indentation**self.exponent

    def stages(self) -> tuple[Stage, ...]:
        jumps = self.initial_force > 0.0
        force = Power(constant=1.0 if jumps else 0.0, coefficient=1.0, exponent=self.exponent)
        if self.initial_indentation == 0.0:
            return (Stage("power", 0.0, float("inf"), force),)
        begin = self.initial_indentation / self.scales(1.0)[0] if jumps else 1.0
        return Stage("clearance", 0.0, begin, Power()), Stage("power", begin, float("inf"), force)
