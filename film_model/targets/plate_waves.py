"""Bending stiffness and wave impedance of infinite plates."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from film_model.base.arrays import root
from film_model.base.materials import Material
from film_model.targets.plate_statics import anisotropy


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
        if np.all(abs(a - b) <= 4e-16 * a):
            break
        a, b = (a + b) / 2, root(a * b)
    return a


LOCAL = 1.054
"""What the half-space of a contact law takes up of the plate: ln 2 − γ − (5/6) ∫ (f(s) − 6/s³ − 6/(5 s) [s < 1]) ds,
f = (sinh s cosh s + s)/(sinh² s − s²) − 1, over s = k h of waves 1/k in an elastic layer."""


def shear_around(material: Material, reach: float, thickness: float) -> float:
    """Deflection over force that plate theory and a half-space's contact law together neglect, m/N.

    Three-dimensional elasticity: a layer that is pressed on its face deflects more than Kirchhoff's plate by 12 (1 −
    ν²)/(5 E h k²) in waves of small k h. Under a point force, without the deflection of the half-space there, that is
    6 (1 − ν²)/(5π E h) (ln(ℓ/h) − 1.054), ℓ = `reach` of the edges. Both parts cancel where ℓ is about 3 h. They do not
    cancel in vibrations, so the logarithm less 1.054 is taken as at least 1. Next to an edge ℓ is taken as h/100.
    """
    soft = 6 * (1 - material.poissons_ratio**2) / (5 * math.pi * material.youngs_modulus * thickness)
    return soft * max(1.0, abs(math.log(max(reach / thickness, 0.01)) - LOCAL))


def reach_of_edges(edges: tuple[str, ...], size: tuple[float, float], position: tuple[float, float]) -> float:
    """Distance ℓ at which the shear around a force ends, m: near it the deflection by shear is F ln(ℓ/r)/(2π κ G h).

    Between two parallel edges at a distance L that hold, ℓ = (2L/π) sin(πx/L), as of a membrane; with one edge that
    holds, as at twice the distance. For both directions, ℓ⁻⁴ is their sum: 0.535 L at the centre of a square, where
    0.539 L is exact. Without edges that hold: the shorter side.
    """
    found: list[float] = []
    for (one, other), side, x in zip((edges[:2], edges[2:]), size, position, strict=True):
        if one != "free" or other != "free":
            length = 2 * side if "free" in (one, other) else side
            held = side - x if one == "free" else x  # distance from an edge that holds
            found.append(2 * length / math.pi * math.sin(math.pi * held / length))
    least = min(found, default=min(size))
    return least * sum((least / each) ** 4 for each in found) ** -0.25 if least > 0.0 and found else least
