"""Bending stiffness and wave impedance of infinite plates, and the change by waves from edges."""

from __future__ import annotations

from typing import Any

from film_model.base.arrays import all_of, greater, lesser, root
from film_model.base.units import format_si
from film_model.targets.bending_stiffness import anisotropy
from film_model.targets.target import Estimate, Impact

REFLECTION_CHANGE = 0.03, 2.2
"""c and p of the change c m (1 + e)/(Z e t_c) (t/t_return)^p by waves reflected from the edges of a plate."""


def plate_stiffness(youngs_modulus: float, poissons_ratio: float, thickness: float) -> float:
    """Bending stiffness D = E h³ / (12 (1 − ν²)) of an isotropic thin plate, N·m."""
    return youngs_modulus * thickness**3 / (12 * (1 - poissons_ratio**2))


def plate_impedance(mass_per_area: float, bending_stiffness: float) -> float:
    """Z = 8 √(ρ_A D) of an infinite isotropic thin plate, N·s/m (Zener 1941).

    Exact for Kirchhoff's plate. The contact must last longer than a wave needs to cross the thickness, and must end
    before a wave returns from an edge.
    """
    return 8 * root(mass_per_area * bending_stiffness)


def orthotropic_plate_impedance(mass_per_area: float, d11: float, d12: float, d22: float, d66: float) -> float:
    """Exact impedance of an infinite orthotropic thin plate, N·s/m.

    1/Z is the mean over all directions θ of 1/(8 √(ρ_A D(θ))), D(θ) = D11 c⁴ + 2 (D12 + 2 D66) c² s² + D22 s⁴, which
    integrates to Z = 8 √ρ_A (D11 D22)^¼ (π/2)/K(k²) with k² = (1 − A)/2, A = (D12 + 2 D66)/√(D11 D22) > −1. The
    complete elliptic integral is K(k²) = (π/2)/agm(1, √(1 − k²)).
    """
    mean = root(d11 * d22)
    return 8 * root(mass_per_area * mean) * _agm(1, root((1 + anisotropy(d11, d12, d22, d66)) / 2))


def paper_plate_impedance(mass_per_area: float, d11: float, d12: float, d22: float, d66: float) -> float:
    """Z = 8 √(ρ_A D) with D = [(A + 1)/2] √(D11 D22), N·s/m.

    The effective stiffness that reproduces the published FILM results for Olsson's plate (Big-Alabo, Cartmell &
    Harrison 2017). Exact for an isotropic plate; 12.5 % too low for Olsson's (A = 0.19).
    """
    effective = (anisotropy(d11, d12, d22, d66) + 1) / 2 * root(d11 * d22)
    return plate_impedance(mass_per_area, effective)


def _agm(a: Any, b: Any) -> Any:
    """Arithmetic-geometric mean of two positive numbers. It converges quadratically: 1e-150 and 1 take 13 rounds."""
    for _ in range(64):
        if all_of(abs(a - b) <= 4e-16 * a):
            break
        a, b = (a + b) / 2, root(a * b)
    return a


def change_by_reflections(motion: Any, restitution: Any, delay: Any) -> Any:
    """The change by waves reflected from the edges, at most 1: as of `Plate.reflection_change`."""
    constant, power = REFLECTION_CHANGE
    return lesser(constant * motion / greater(restitution, 1e-3) * delay**power, 1.0)


def reflected(impact: Impact, return_time: float) -> Estimate:
    """The estimate of these waves, which matter after `return_time` [s]."""
    if return_time == 0.0:
        why = "the plate is struck on an edge: the impedance of an infinite plate does not apply"
        return Estimate(why, 0.0, None, 1.0)
    value, (constant, power) = impact.back / return_time, REFLECTION_CHANGE
    share = constant * impact.motion / max(impact.restitution, 1e-3)
    threshold = (impact.tolerance / share) ** (1.0 / power)
    back, felt = format_si(impact.back, "time", 3), format_si(return_time, "time", 3)
    reason = f"edge waves matter {felt} after the centre of the impulse, contact without them ends after {back}"
    return Estimate(reason, value, threshold, change_by_reflections(impact.motion, impact.restitution, value))
