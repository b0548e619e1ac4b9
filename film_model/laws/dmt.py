"""DMT: an elastic sphere under the attraction of its surroundings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.adhesive import AdhesiveLaw
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import Power, Stage


@dataclass(frozen=True)
class Dmt(AdhesiveLaw):
    """Derjaguin, Muller & Toporov 1975, J. Colloid Interface Sci. 53:314. Reversible.

        F = K δ^{3/2} − 2π w R,  K = (4/3) E √R

    Contact begins and ends at δ = 0.
    """

    name: ClassVar[str] = "dmt"
    summary: ClassVar[str] = "elastic sphere under a constant attraction, F = K δ^1.5 − 2 π w R; reversible"
    source: ClassVar[str] = "Derjaguin, Muller & Toporov 1975, J. Colloid Interface Sci. 53:314"
    validity: ClassVar[str] = (
        "a/R below about 0.2, no yield; hard and small: (R w²/(E² z³))^{1/3} below about 0.1, z ≈ 0.3 nm"
    )

    def scales(self, energy: float) -> tuple[float, float]:
        tension = 2.0 * math.pi * self.work_of_adhesion * self.radius
        return (tension / hertz_stiffness(self.effective_modulus, self.radius)) ** (2.0 / 3.0), tension

    def stages(self) -> tuple[Stage, ...]:
        force = Power(constant=-1.0, coefficient=1.0, exponent=1.5, origin=0.0)
        return (Stage("pulling", 0.0, 1.0, force, pulls=True), Stage("pushing", 1.0, float("inf"), force))
