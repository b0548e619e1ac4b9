"""Waves that a contact radiates into a target, and how fast they cross it."""

from __future__ import annotations

import math
from typing import Any

from film_model.base.materials import Material
from film_model.targets.target import Estimate, Impact, no_effect

HERTZ_PULSE = 4.6851
"""∫Ḟ² dt over F_m²/t_c of an elastic impact; π²/2 for a half-sine."""

HERTZ_SQUARE = 0.4113
"""∫F² dt over F_m² t_c of an elastic impact; 1/2 for a half-sine."""

RADIATION = (0.41756, -0.63293, 0.69362, -0.73621, 0.68903, -0.37054)
"""Coefficients of powers of (c_T/c_L)² in β/(1 − ν)²: to 5e-4 for ν from −0.9 to 0.5 (tests/test_effects.py)."""

MEAN_FREQUENCY = 0.7737 * math.pi
"""Mean of ω t_c over |F(ω)|² of a half-sine."""


def pressure_velocity(material: Material) -> float:
    """c_L = c_T √((2 − 2ν)/(1 − 2ν)) of longitudinal waves in a solid, m/s."""
    ratio = material.poissons_ratio
    return material.shear_velocity * math.sqrt((2.0 - 2.0 * ratio) / (1.0 - 2.0 * ratio))


def crossing_time(material: Material, thickness: float) -> float:
    """Time in which a longitudinal wave crosses a plate of a thickness [m] and returns, s."""
    return 2.0 * thickness / pressure_velocity(material)


def radiation(material: Material) -> Any:
    """β/(ρ c_T³), m s/N: a point force F(t) on a half-space radiates this times ∫Ḟ² dt. Floats or arrays.

    The imaginary part of the surface's compliance at a point is ω β(ν)/(ρ c_T³): Lamb's problem (Miller & Pursey
    1955). The Rayleigh wave takes two thirds.
    """
    ratio = material.poissons_ratio
    squared, beta = (1.0 - 2.0 * ratio) / (2.0 - 2.0 * ratio), 0.0
    for coefficient in reversed(RADIATION):
        beta = beta * squared + coefficient
    return (1.0 - ratio) ** 2.0 * beta / (material.density * material.shear_velocity**3.0)


def sheet_losses(impact: Impact, material: Material | None, thickness: float | None) -> Estimate:
    """The energy that a plate radiates beside its bending waves."""
    if thickness is None or material is None:
        return Estimate("the thickness or the waves of a plate of layers, or of given stiffness, are not known")
    if impact.duration >= 10.0 * thickness / material.shear_velocity:
        return no_effect("the contact is slow enough for bending waves, which are part of the target's motion")
    carried = 1.0 - impact.restitution**2 - impact.fraction if impact.by_impedance else 0.0
    radiated = radiation(material) * HERTZ_PULSE * impact.force**2 / impact.duration / impact.energy
    # beside bending, plates with h/R = 2, 3 and 4 radiate 0.27, 0.18 and 0.23 of that by finite elements
    size = min(1.0, max(0.25 * radiated, radiated - carried))
    reason = "the plate is too thick for bending waves alone and too thin for a half-space"
    if impact.duration < crossing_time(material, thickness):
        reason = "contact ends before a wave returns from the far side, so that the plate radiates as a half-space"
    return Estimate(reason, size, impact.tolerance, size)
