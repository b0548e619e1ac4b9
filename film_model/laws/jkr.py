"""JKR: an elastic sphere with adhesion."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from film_model.laws.adhesive import AdhesiveLaw
from film_model.laws.law import Array, Stage

JKR_LOSS = (
    0.5
    * math.pi
    * (9.0 * math.pi / 8.0) ** (2.0 / 3.0)
    * (1.2 * (4.0 / 3.0) ** (4.0 / 3.0) + 0.8 * 3.0 ** (-4.0 / 3.0))
)
"""Energy that a JKR contact loses between δ = 0 and the end of contact, over (w⁵R⁴/E²)^{1/3}: 7.0922."""

PARTING = -(3.0 ** (2.0 / 3.0))  # δ/δ_s at which a contact of given indentation ends
UNLOADED = 2.0 ** (4.0 / 3.0)  # ... without a force
DEEPEST = UNLOADED * 2.0**20


def _root_of_radius(indentation: Array) -> Array:
    """u = √(a/a_c) from 3 u⁴ − 4 u = δ/δ_s, on the stable branch u³ ≥ 1/3.

    With u = u₀ + v, u₀³ = 1/3: v √(18 u₀² + 12 u₀ v + 3 v²) = √((δ − δ_min)/δ_s), a root without cancellation near the
    end of the branch, by Newton's method.
    """
    least = 3.0 ** (-1.0 / 3.0)
    right = np.sqrt(np.maximum(indentation - PARTING, 0.0))
    v = right / (math.sqrt(18.0) * least + 3.0**0.25 * np.sqrt(right))
    for _ in range(40):
        inner = np.sqrt(18.0 * least**2 + 12.0 * least * v + 3.0 * v * v)
        v = np.maximum(v - (v * inner - right) / (inner + v * (6.0 * least + 3.0 * v) / inner), 0.0)
    return least + v


def jkr_force(indentation: Array) -> Array:
    """F/F_c = α³ − 2 α^{3/2}, α = a/a_c."""
    cube = _root_of_radius(indentation) ** 3
    return cube * (cube - 2.0)


def jkr_scales(effective_modulus: float, radius: float, work_of_adhesion: float) -> tuple[float, float]:
    """δ_s = a_c²/(3R) [m] with a_c³ = 9π w R²/(8E), and F_c = 1.5 π w R [N]."""
    cube = 9.0 * math.pi * work_of_adhesion * radius**2 / (8.0 * effective_modulus)
    return cube ** (2.0 / 3.0) / (3.0 * radius), 1.5 * math.pi * work_of_adhesion * radius


@dataclass(frozen=True)
class Jkr(AdhesiveLaw):
    """Johnson, Kendall & Roberts 1971, Proc. R. Soc. A 324:301.

        F = 4 E a³/(3R) − √(8π w E a³),  δ = a²/R − √(2π w a/E)
        F_c = 1.5 π w R                                                       largest tension
        F = −(8/9) F_c at δ = 0                                               contact begins
        F = −(5/9) F_c at δ = −3^{2/3} δ_s                                    it ends
        δ_s = a_c²/(3R),  a_c³ = 9π w R²/(8E)
        e² = 1 − (V_s/V)²,  m V_s²/2 = 7.09 (w⁵R⁴/E²)^{1/3}                   Thornton & Ning 1998

    Below V_s the ball sticks, and swings without end unless the target moves.
    """

    name: ClassVar[str] = "jkr"
    summary: ClassVar[str] = "elastic sphere that sticks: tension up to 1.5 π w R, energy lost at parting"
    source: ClassVar[str] = "Johnson, Kendall & Roberts 1971, Proc. R. Soc. A 324:301"
    validity: ClassVar[str] = (
        "a/R below about 0.2, no yield; soft or large: (R w²/(E² z³))^{1/3} above about 5, z ≈ 0.3 nm"
    )

    def scales(self, energy: float) -> tuple[float, float]:
        return jkr_scales(self.effective_modulus, self.radius, self.work_of_adhesion)

    def stages(self) -> tuple[Stage, ...]:
        return (
            Stage("parting", PARTING, -1.0, jkr_force, root=True, pulls=True),
            Stage("pulling", -1.0, UNLOADED, jkr_force, pulls=True),
            Stage("pushing", UNLOADED, DEEPEST, jkr_force, knots=tuple(UNLOADED * 2.0**k for k in range(1, 20))),
        )
