"""Shear of plates: what Kirchhoff's theory neglects."""

from __future__ import annotations

import math

from film_model.base.materials import Material
from film_model.core import plates
from film_model.targets.target import COMES_BACK, Estimate, Impact, no_effect
from film_model.targets.waves import MEAN_FREQUENCY, crossing_time


def shear_around(material: Material, reach: float, thickness: float) -> float:
    """Deflection over force that plate theory and a half-space's contact law together neglect, m/N.

    Three-dimensional elasticity: a layer that is pressed on its face deflects more than Kirchhoff's plate by 12 (1 −
    ν²)/(5 E h k²) in waves of small k h. Under a point force, without the deflection of the half-space there, that is
    6 (1 − ν²)/(5π E h) (ln(ℓ/h) − 1.054), ℓ = `reach` of the edges. Both parts cancel where ℓ is about 3 h. They do not
    cancel in vibrations, so the logarithm less 1.054 is taken as at least 1. Next to an edge ℓ is taken as h/100.
    """
    soft = 6 * (1 - material.poissons_ratio**2) / (5 * math.pi * material.youngs_modulus * thickness)
    return soft * max(1.0, abs(plates.around(max(reach / thickness, 0.01))))


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


def shear_of_waves(impact: Impact, material: Material, thickness: float, slowness: float) -> Estimate:
    """Shear adds k² h²/5 to the mobility 1/Z and to the energy of bending waves (lowest wave of a layer pressed on its
    face), k² = ω √(ρ_A/D), ω = 0.77 π/t_c, the mean over a half-sine's spectrum. slowness: √(ρ_A/D), s/m²."""
    if impact.duration < crossing_time(material, thickness):
        return no_effect("contact ends before a wave returns from the far side: see wave losses")
    square = MEAN_FREQUENCY / impact.duration * slowness
    shear = square * thickness**2 / 5.0
    carried = 1.0 - impact.restitution**2 - impact.fraction if impact.by_impedance else 0.0
    value, size = math.sqrt(square) * thickness, max(0.0, shear * carried)
    longer = f"{2.0 * math.pi / value:.2g} times as long as the plate is thick"
    reason = f"the bending waves are {'only ' if size > impact.tolerance else ''}{longer}"
    return Estimate(reason, value, None, size)


def shear_of_bending(impact: Impact, energy: float, slender: float) -> Estimate:
    """½ c F² over the impact energy, c F the deflection around the load that plate theory and contact law neglect
    (`shear_around`). energy: ½ c F². slender: h/L."""
    size = min(energy / impact.energy, 1.0)
    if impact.vibrates and size <= impact.tolerance:
        return Estimate(COMES_BACK, slender, indicator="h/L")
    return Estimate("the energy of shear deformation is neglected", slender, None, size, indicator="h/L")
