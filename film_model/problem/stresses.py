"""What follows from force and indentation of a contact: its radius, pressure, and the stresses below the surface.

Every formula serves one impact (floats) and many (arrays).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np

from film_model.base.arrays import Number, all_of, either, greater, lesser, ratio, root
from film_model.laws.elastoplastic import Plastic, scaled_strain
from film_model.problem.problem import Impacts, Problem
from film_model.scene.noses import elastic_radius

SHALLOW = 1e-3
"""Permanent over maximum indentation up to which nothing is called a dent."""


def plastic_contact(impacts: Impacts) -> Plastic | None:
    """The contact beyond yield, that of law elastoplastic with strength, ν, n, h and x of the impacts' law.

    n = h = x = 0 for a law without. None if the strength or Poisson's ratio is unknown.
    """
    scene, strength = impacts.scene, impacts.yield_strength
    names = ("poissons_ratio", "strain_hardening_exponent", "elastic_share", "softer_curvature")
    poisson, *beside = map(impacts.law.value, names)
    poisson = scene.poissons_ratio if poisson is None else poisson
    if strength is None or poisson is None or scene.effective_modulus is None:
        return None
    strain = scaled_strain(strength / scene.effective_modulus, poisson)
    exponent, share, curvature = [0.0 if value is None else value for value in beside]
    return Plastic(strain, exponent, share, curvature=curvature)


def hertzian(widening: Number) -> Number:
    """Relative difference of a force from Hertz's at this indentation up to which the contact is elastic; 0 of a law
    wider than the ball's section, which has no elastic stage and Hertz's force by chance."""
    return either(widening > 1.0, 0.0, 1e-3)


def contact_radius(impacts: Impacts, force: Number, indentation: Number) -> tuple[Number, Any]:
    """Contact radius at the largest force [N] and indentation [m], m (nan if unknown); and whether contact is Hertz's.

    :func:`elastic_radius`, √(R δ) of a ball, while the force is Hertz's; beyond, at most R: the law's own if it has
    one (`AbstractLaw.widening`), or that of the finite elements (`plastic_contact`).
    """
    elastic = is_hertzian(impacts, force, indentation)
    return radius_of(impacts, elastic, indentation), elastic


def is_hertzian(impacts: Impacts, force: Number, indentation: Number) -> Any:
    """Whether a force [N] at an indentation [m] is Hertz's, of a nose that has such a force."""
    scene = impacts.scene
    if scene.effective_modulus is None or scene.nose is not None:
        return force != force
    hertz = scene.hertz_stiffness * indentation * root(indentation)
    return ratio(abs(force - hertz), hertz) <= hertzian(impacts.law.value("widening"))


def radius_of(impacts: Impacts, elastic: Any, indentation: Number, tabled: bool = False) -> Number:
    """As :func:`contact_radius`, where it is known whether contact is Hertz's. tabled: within 1e-5 in arrays."""
    scene, radius = impacts.scene, impacts.scene.effective_radius
    if scene.effective_modulus is None:
        return indentation * math.nan
    if scene.nose is not None or scene.oval is not None or all_of(elastic):
        return elastic_radius(scene, indentation)
    widened, own = math.nan, impacts.law.value("widening")
    plastic = None if all_of(own > 0.0) else plastic_contact(impacts)
    if plastic is not None:
        w = greater(indentation / (plastic.first_radius**2.0 * radius), 1.0)
        widened = plastic.tabled_widening(w) if tabled else plastic.widening(w)
    widened = either(own > 0.0, own, widened)
    square = radius * indentation
    return root(either(elastic, square, lesser(square * widened, radius * radius)))


def stresses_of(problem: Problem, summary: dict[str, Any]) -> dict[str, Any]:
    """Radius, dent, pressures and stresses from a summary, by their names in `SUMMARY`.

    They hold at the largest force, which is that at the largest indentation; of damped laws and viscoelastic materials
    it is not, so that only the radius is known. Nothing is known for laws that pull. Stresses are those of the body
    in which they are larger (`Scene.stressed_poissons_ratio`).
    """
    scene, force = problem.impacts.scene, summary["maximum_force"]
    depth = summary["maximum_indentation"]
    if problem.relaxation is None:
        radius, elastic = contact_radius(problem.impacts, force, depth)
    else:  # on the way in, the contact is as wide as Hertz's at that indentation
        radius, elastic = elastic_radius(scene, depth), force != force
    radius = radius * math.nan if problem.curve.pulls else radius
    damped = problem.damps or problem.relaxation is not None
    left = summary["permanent_indentation"]
    dented = left > SHALLOW * depth
    mean = force * math.nan if damped else force / (math.pi * radius * radius)
    peak = either(elastic, 1.5 * mean, math.nan)
    poisson = scene.stressed_poissons_ratio if scene.oval is None else None
    shear, below = (math.nan, math.nan) if poisson is None else shear_below(poisson)
    deep = force * math.nan if damped else below * radius  # a damped force may be Hertz's by chance
    return {
        "contact_radius": radius,
        "dent_diameter": either(dented, 2.0 * radius, left * 0.0),
        "mean_pressure": mean,
        "peak_pressure": peak,
        "maximum_shear_stress": shear * peak,
        "maximum_von_mises_stress": 2.0 * shear * peak,
        "depth_of_maximum_stress": either(elastic, deep, math.nan),
    }


def shear_below(poissons_ratio: Number) -> tuple[Number, Number]:
    """Largest shear stress on the axis of a Hertz contact, over p0; and its depth over the contact radius.

    With ζ = z/a: σ_z = −p0/(1 + ζ²), σ_r = −p0 [(1 + ν)(1 − ζ atan(1/ζ)) − 1/(2 (1 + ζ²))], τ = |σ_r − σ_z|/2 (Johnson
    1985, 3.45). Von Mises' stress on the axis is 2 τ. For ν = 0.3: 0.310 p0 at 0.48 a. From 0 to 0.5 these are the
    largest of the whole body; below 0, the surface may be stressed more.
    """
    if not isinstance(poissons_ratio, np.ndarray):
        return _shear_at(poissons_ratio)
    if (poissons_ratio == poissons_ratio.flat[0]).all():
        return _shear_at(float(poissons_ratio.flat[0]))
    return _shear_below(poissons_ratio)


@lru_cache(maxsize=64)
def _shear_at(poissons_ratio: float) -> tuple[float, float]:
    shear, depth = _shear_below(np.array([poissons_ratio]))
    return float(shear[0]), float(depth[0])


def _shear_below(ratio: Any) -> tuple[Any, Any]:
    """Newton's method for dτ/dζ = 0, from a straight line that is within 2 % of the root; converges quadratically."""
    z = 0.38 + 0.33 * ratio
    for _ in range(5):
        q = 1.0 + z * z
        turn = np.arctan(1.0 / z)
        slope = -3.0 * z / q**2 + (1.0 + ratio) * (turn - z / q)
        bend = -3.0 / q**2 + 12.0 * z * z / q**3 - 2.0 * (1.0 + ratio) / q**2
        z = z - slope / bend
    q = 1.0 + z * z
    return 0.5 * (1.5 / q - (1.0 + ratio) * (1.0 - z * np.arctan(1.0 / z))), z


def edge_tension(poissons_ratio: Number, peak_pressure: Number) -> Number:
    """Largest tensile stress of a Hertz contact, at its edge, Pa: (1 − 2ν) p0/3."""
    return (1.0 - 2.0 * poissons_ratio) * peak_pressure / 3.0
