"""A linear spring and a linear dashpot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.damping import spring_ratio
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
class LinearDashpot(AbstractLaw):
    """Cundall & Strack 1979, Géotechnique 29:47; e of a contact that ends at F = 0: derived here.

        F = k δ + c δ̇  until F = 0,  ζ = c/(2√(m k))
        e = exp(−ζ/√(1 − ζ²) atan2(2ζ√(1 − ζ²), 2ζ² − 1)),  continued for ζ ≥ 1

    The usual e = exp(−πζ/√(1 − ζ²)) holds with tension until δ = 0. The force jumps to c V at first touch.
    """

    name: ClassVar[str] = "linear-dashpot"
    family: ClassVar[Family] = "damped"
    summary: ClassVar[str] = "spring and dashpot, F = k δ + c δ̇; ends without tension"
    source: ClassVar[str] = "Cundall & Strack 1979, Géotechnique 29:47; e of a contact that ends at F = 0: derived here"
    validity: ClassVar[str] = "a spring with a chosen restitution, not a material"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "stiffness": Parameter("k", dimension="stiffness"),
        "restitution": Parameter("e on a fixed target; or damping", required=False),
        "damping": Parameter("c; or restitution", dimension="impedance", required=False, above=None, minimum=0.0),
    }
    damped: ClassVar[bool] = True

    stiffness: float
    restitution: float | None = None
    damping: float | None = None

    def __post_init__(self) -> None:
        raise_wrong(self)

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"stiffness": ball.spring, "restitution": 0.6}

    def scales(self, energy: float) -> tuple[float, float]:
        indentation = (energy / self.stiffness) ** 0.5
        return indentation, self.stiffness * indentation

    def stages(self) -> tuple[Stage, ...]:
        return (Stage("spring", 0.0, float("inf"), Power(slope=1.0), damping=Power(constant=1.0)),)

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        if self.damping is not None:
            return self.damping + 0.0 * mass
        assert self.restitution is not None
        return 2.0 * spring_ratio(self.restitution) * (mass * self.stiffness) ** 0.5

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        return wrong_restitution(values, "damping")
