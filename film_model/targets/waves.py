"""Waves that a contact radiates into a target, and how fast they cross it."""

from __future__ import annotations

import math

from film_model.base.arrays import interpolated
from film_model.base.materials import Material
from film_model.targets.target import Impact

HERTZ_PULSE = 4.6851
"""∫Ḟ² dt over F_m²/t_c of an elastic impact; π²/2 for a half-sine."""

HERTZ_SQUARE = 0.4113
"""∫F² dt over F_m² t_c of an elastic impact; 1/2 for a half-sine."""

RADIATION = (
    (0.0, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.49),
    (0.21396, 0.18556, 0.15986, 0.14813, 0.13723, 0.12723, 0.11824, 0.11047, 0.10542),
)
"""Poisson's ratio, and β: a point force F(t) radiates β/(ρ c_T³) ∫Ḟ² dt into a half-space (Lamb's problem)."""

THIN = 10.0
"""Contact time over the time in which a shear wave crosses a plate, from which bending waves describe its motion."""


BESIDE_BENDING = 0.25
"""Energy that a plate between thick and thin radiates beside bending, over what a half-space takes: finite elements of
plates with h/R = 2, 3 and 4 give 0.27, 0.18 and 0.23."""


def shear_velocity(material: Material) -> float:
    """c_T = √(G/ρ), m/s."""
    return math.sqrt(material.youngs_modulus / (2.0 * (1.0 + material.poissons_ratio)) / material.density)


def pressure_velocity(material: Material) -> float:
    """c_L = c_T √((2 − 2ν)/(1 − 2ν)) of longitudinal waves in a solid, m/s."""
    ratio = material.poissons_ratio
    return shear_velocity(material) * math.sqrt((2.0 - 2.0 * ratio) / (1.0 - 2.0 * ratio))


def radiated_energy(material: Material, impact: Impact) -> float:
    """Energy that a contact radiates into a half-space, J: β/(ρ c_T³) ∫Ḟ² dt with ∫Ḟ² dt = 4.685 F_m²/t_c.

    The imaginary part of the surface's compliance at a point is ω β(ν)/(ρ c_T³): Lamb's problem (Miller & Pursey
    1955). The Rayleigh wave takes two thirds. Hunter 1957 finds the same dependence V^{3/5}.
    """
    beta = interpolated(material.poissons_ratio, *RADIATION)
    pulse = HERTZ_PULSE * impact.force**2 / impact.duration
    return beta / (material.density * shear_velocity(material) ** 3) * pulse
