"""Thornton & Ning: a sphere that yields and sticks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from film_model.laws.adhesive import AdhesiveLaw
from film_model.laws.jkr import PARTING, UNLOADED, jkr_force, jkr_scales
from film_model.laws.law import ExampleBall, Parameter, Power, Stage, Unloading
from film_model.laws.yielding import pressure_over

WIDEST = 1024.0
"""The law ends where the contact radius is this many times that at yield."""


@dataclass(frozen=True)
class _Plastic:
    """A contact beyond yield: α = a/a_c, where α² = α_y² + (d − d_y)/3, f = f_y + (P/2) (d − d_y), d = δ/δ_s."""

    pressure: Any  # P = p_y π R/(2 E a_c)

    @cached_property
    def radius(self) -> Any:
        """α_y = u², u³ − P u − 2/3 = 0, by Newton's method from above: the cubic is convex there."""
        u = self.pressure**0.5 + 1.0
        for _ in range(12):
            square = u * u
            u = u - (u * (square - self.pressure) - 2.0 / 3.0) / (3.0 * square - self.pressure)
        return u * u

    @cached_property
    def begin(self) -> Any:
        """d_y of the elastic contact."""
        return 3.0 * self.radius**2 - 4.0 * self.radius**0.5

    @cached_property
    def end(self) -> Any:
        """Where the contact radius is `WIDEST` times that at yield."""
        return self.begin + 3.0 * self.radius**2 * (WIDEST**2 - 1.0)

    @cached_property
    def force(self) -> Any:
        """f_y of the elastic contact."""
        return self.radius**3 - 2.0 * self.radius**1.5

    @property
    def reach(self) -> Any:
        """How far unloading from the end of the law goes on the JKR curve, over its own length scale."""
        squared = (WIDEST * self.radius) ** 2
        cube = squared**1.5
        ratio = cube / (self.force + 0.5 * self.pressure * (self.end - self.begin) + 2.0 * cube**0.5)
        return (3.0 * squared / ratio - 4.0 * squared**0.25) / ratio ** (1.0 / 3.0)


@dataclass(frozen=True)
class ThorntonNing(AdhesiveLaw):
    """Thornton & Ning 1998, Powder Technol. 99:154. JKR's contact with the pressure cut off at p_y.

        p_y = 2 E a_y/(π R) − √(2 w E/(π a_y))                                end of the elastic contact
        F = F_y + π R p_y (δ − δ_y),  a² = a_y² + R (δ − δ_y)                 beyond
        R_p = 4 E a³/(3 (F + √(8π w E a³))) ≥ R                               unloading by JKR's F, moved by the dent:
        δ_p = δ_m − a²/R_p + √(2π w a/E)
        tension ≤ 1.5 π w R_p;  end at δ_p − 2.0801 δ_s (R_p/R)^{1/3}         δ_s: JKR's

    Slow balls stick. p_y π R/(2 E a_c) must be above 1.06: no yield by adhesion alone. Under long-ranged attraction
    (dmt) adhesion takes no energy: take thornton.
    """

    name: ClassVar[str] = "thornton-ning"
    summary: ClassVar[str] = "sphere that yields and sticks: thornton with adhesion, tension up to 1.5 π w R_p"
    source: ClassVar[str] = "Thornton & Ning 1998, Powder Technol. 99:154"
    validity: ClassVar[str] = (
        "a/R below about 0.2; no strain hardening, one pressure from yield to full plasticity; "
        "no yield by adhesion alone"
    )
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "yield_pressure": pressure_over(1.6, "limiting contact pressure p_y")
    }

    yield_pressure: float

    def __post_init__(self) -> None:
        softest = 2.0 ** (5.0 / 3.0) / 3.0  # 1.0583, at which the sphere yields where a contact without a force is
        if np.any(self.similarity < softest):
            names = ("yield_pressure", "work_of_adhesion", "radius", "similarity")
            columns = np.broadcast_arrays(*(getattr(self, name) for name in names))
            pressure, work, radius, similarity = (column.flat[columns[-1].argmin()] for column in columns)
            raise ValueError(
                f"yield_pressure {pressure:.4g} Pa must be at least {softest / similarity * pressure:.4g} Pa at a work "
                f"of adhesion of {work:.4g} J/m^2 and a radius of {radius:.4g} m: adhesion alone yields it"
            )

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {**super().example(ball), **cls.over_strength(ball.yield_strength)}

    def scales(self, energy: float) -> tuple[float, float]:
        return jkr_scales(self.effective_modulus, self.radius, self.work_of_adhesion)

    @property
    def similarity(self) -> Any:
        """p_y π R/(2 E a_c), a_c = √(3 R δ_s)."""
        contact = (3.0 * self.radius * self.scales(0.0)[0]) ** 0.5
        return 0.5 * math.pi * self.yield_pressure * self.radius / (self.effective_modulus * contact)

    def stages(self) -> tuple[Stage, ...]:
        plastic = _Plastic(self.similarity)
        reach = 1.001 * float(np.max(plastic.reach))
        # at least 30 pieces: up to p_y π R/(2 E a_c) = 1e7 all laws have the same, so that sweeps share them
        spaced = 4.0
        knots = max(30, math.ceil(math.log(reach / UNLOADED, spaced)))
        area = Power(constant=plastic.radius**2, slope=1.0 / 3.0)
        return (
            Stage("parting", PARTING, -1.0, jkr_force, root=True, pulls=True),
            Stage("pulling", -1.0, UNLOADED, jkr_force, pulls=True),
            Stage(
                *("pushing", UNLOADED, plastic.begin, jkr_force),
                knots=tuple(UNLOADED * spaced**k for k in range(1, knots)),
                pulls=True,
                reach=UNLOADED * spaced**knots,
            ),
            Stage(
                *("plastic", plastic.begin, plastic.end),
                Power(constant=plastic.force, slope=0.5 * plastic.pressure),
                Unloading(contact_area=area),
            ),
        )
