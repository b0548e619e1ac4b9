"""The stress by which a plate bends under the contact, against the strength of its material."""

from __future__ import annotations

import math

import numpy as np

from film_model.base.materials import Material
from film_model.base.units import format_si
from film_model.targets.target import Estimate, Impact, missing


def bending_stress(force: float, reach: float, contact_radius: float, thickness: float, poissons_ratio: float) -> float:
    """Stress on the far face under the force, Pa: 6 M/h² with M = (1 + ν) F/(4π) (ln(ℓ/c) + 1/2).

    force: N. reach: ℓ, m, of `reach_of` on an infinite plate. contact_radius: m; c is Westergaard's radius of the same
    stress, √(1.6 a² + h²) − 0.675 h for a contact radius a below 1.724 h, which counts the thickness (Timoshenko &
    Woinowsky-Krieger 1959). thickness: h, m.
    """
    thin = contact_radius >= 1.724 * thickness
    radius = contact_radius if thin else math.sqrt(1.6 * contact_radius**2 + thickness**2) - 0.675 * thickness
    moment = (1.0 + poissons_ratio) * force / (4.0 * math.pi) * (math.log(max(reach / radius, 1.0)) + 0.5)
    return 6.0 * moment / thickness**2


def reach_of(time: float, stiffness: float, surface_density: float) -> float:
    """ℓ = √(4 b t e^{-γ}), b = √(D/ρ_A), m: of a force that acts on an infinite plate since the time t [s].

    A unit impulse at a point gives the curvature ∇²w = −cos(r²/(4 b t))/(4π D t) (Sneddon's w, differentiated), and its
    integral over a constant force, averaged over a disc of radius c, is −(F/(2π D)) (ln(ℓ/c) + 1/2) for ℓ ≫ c.
    """
    return math.sqrt(4.0 * math.sqrt(stiffness / surface_density) * time * math.exp(-np.euler_gamma))


def bending_strength(
    impact: Impact, material: Material | None, thickness: float | None, reach: float, shorter: float | None
) -> Estimate:
    """Whether a plate yields or breaks by bending. reach: `reach_of` the time of the maximum indentation, m.

    shorter: side of the plate, m; the reach of a static force at its centre is 2/π of it.
    """
    if material is None or thickness is None:
        return Estimate("the strength of a plate of layers, or of given stiffness, is not known")
    brittle = material.tensile_strength is not None
    strength = material.tensile_strength or material.yield_strength
    if strength is None:
        return missing("yield_strength or tensile_strength of target.material")
    reach = min(reach, math.inf if shorter is None else 2.0 / math.pi * shorter)
    stress = bending_stress(impact.force, reach, impact.contact_radius, thickness, material.poissons_ratio)
    # a rectangular section yields throughout at 1.5 times the moment at which it begins to yield
    value, threshold = stress / strength, 1.0 if brittle else 1.5
    word = "strength" if brittle else "yield strength"
    reason = (
        f"in an elastic plate the bending stress under the contact would be {format_si(stress, 'pressure', 3)}, "
        f"{value:.3g} times the {word} of {material.name or 'its material'}"
    )
    if value <= threshold:
        return Estimate(reason, value, threshold, 0.0)
    end = "it may break" if brittle else "it keeps a dish, which takes up energy, and the force is lower"
    return Estimate(f"{reason}: {end}", value, threshold, fails=True)
