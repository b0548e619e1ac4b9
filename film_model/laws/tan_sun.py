"""Indentation of laminates after Tan and Sun, and Yang and Sun: three powers and a critical indentation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.law import AbstractLaw, ExampleBall, Family, Parameter, Power, Stage, Unloading


@dataclass(frozen=True)
class TanSun(AbstractLaw):
    """Yang & Sun 1982, ASTM STP 787; Tan & Sun 1985, J. Appl. Mech. 52:6; your constants.

        F = k δ^q                                                             loading
        F = F_m ((δ − δ_f)/(δ_m − δ_f))^{q_u}                                 unloading; reloading with q_r up to δ_m
        δ_f = 0                                                               δ_m ≤ δ_cr
        δ_f = δ_m [1 − (δ_cr/δ_m)^{2/5}],  or β (δ_m − δ_cr) if β is given    beyond
        e² = (q + 1)/(q_u + 1) (δ_m − δ_f)/δ_m

    δ_cr of graphite/epoxy: about 0.08 mm. q_u ≥ q, q_r ≤ q_u, 0 < β ≤ 1. Every contact loses energy. A second unloading
    retraces the unloading curve, scaled (our own choice, which creates no energy).
    """

    name: ClassVar[str] = "tan-sun"
    family: ClassVar[Family] = "measured"
    summary: ClassVar[str] = "laminates: k δ^1.5 in, power 2.5 out to a permanent indentation, 1.5 in again"
    source: ClassVar[str] = "Yang & Sun 1982, ASTM STP 787; Tan & Sun 1985, J. Appl. Mech. 52:6; your constants"
    validity: ClassVar[str] = "the laminate, thickness and indenter of your indentation test"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "stiffness": Parameter("k, in N/m^q with the exponent q", dimension="meyer_stiffness"),
        "critical_indentation": Parameter("δ_cr, deepest indentation that leaves no dent", dimension="length"),
        "exponent": Parameter("q of loading, 1.5", required=False),
        "unloading_exponent": Parameter("q_u, 2.5", required=False),
        "reloading_exponent": Parameter("q_r, 1.5", required=False),
        "permanent_fraction": Parameter("β of δ_f = β (δ_m − δ_cr), instead of the power 2/5", required=False),
    }

    stiffness: float
    critical_indentation: float
    exponent: float = 1.5
    unloading_exponent: float = 2.5
    reloading_exponent: float = 1.5
    permanent_fraction: float | None = None

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"stiffness": 0.7 * ball.stiffness, "critical_indentation": 0.3 * ball.depth}

    def scales(self, energy: float) -> tuple[float, float]:
        return self.critical_indentation, self.stiffness * self.critical_indentation**self.exponent

    def stages(self) -> tuple[Stage, ...]:
        force = Power(coefficient=1.0, exponent=self.exponent, origin=0.0)
        residual = Power(slope=1.0, coefficient=-1.0, exponent=0.6, origin=0.0)
        if self.permanent_fraction is not None:
            residual = Power(slope=self.permanent_fraction)
        powers = (self.unloading_exponent, self.reloading_exponent)
        return (
            Stage(
                "shallow", 0.0, 1.0, force, Unloading(residual=Power(), exponent=powers[0], reload_exponent=powers[1])
            ),
            Stage(
                "damaging",
                1.0,
                float("inf"),
                force,
                Unloading(residual=residual, exponent=powers[0], reload_exponent=powers[1]),
            ),
        )

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        exponent = values.get("exponent", cls.exponent)
        out, again = (
            values.get(f"{way}loading_exponent", getattr(cls, f"{way}loading_exponent")) for way in ("un", "re")
        )
        wrong: dict[str, str] = {}
        if out < exponent:
            wrong["unloading_exponent"] = f"{out:g} must be >= exponent {exponent:g}: it would give energy"
        if again > out:
            wrong["reloading_exponent"] = f"{again:g} must be <= unloading_exponent {out:g}: it would give energy"
        if values.get("permanent_fraction", 1.0) > 1.0:
            wrong["permanent_fraction"] = f"{values['permanent_fraction']:g} must be <= 1"
        return wrong
