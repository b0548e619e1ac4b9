"""Numbers of a scene that are possible, but more often a mistake of units."""

from __future__ import annotations

import math

from film_model.base.materials import Material, named
from film_model.base.units import format_si
from film_model.scene import Scene
from film_model.scene.noses import VOLUMES

LEAST, MOST = 0.3, 3.0
"""Mass over density × volume of a ball of the contact's radius, and numbers of a material over those of the catalogue
under its name, beyond which there is a remark."""


def remarks(scene: Scene) -> tuple[str, ...]:
    """A sentence for each number of a material, and each given mass, that is far from what is possible or usual."""
    found: list[str] = []
    for part, body in (("impactor", scene.impactor), ("target", scene.target)):
        mass, material = getattr(body, "mass", None), body.material
        if material is None:
            continue
        found += [f"{part}.material.{said}" for said in _of_material(material)]
        if mass is None or not math.isfinite(body.radius) or getattr(body, "shape", None) in VOLUMES:
            continue
        ball = material.density * 4.0 / 3.0 * math.pi * body.radius**3
        if not ball * LEAST <= mass <= ball * MOST:
            found.append(
                f"{part}.mass: {format_si(mass, 'mass')} is {mass / ball:.3g} times density × volume of a ball of its "
                f"radius, {format_si(ball, 'mass')}; right for a heavy body with a rounded nose, otherwise check units"
            )
    return tuple(found)


def _of_material(material: Material) -> list[str]:
    """Sentences about the numbers of a material that is not from the catalogue."""
    softest = 1e5  # Young's modulus of the softest rubbers, Pa; gels and foams may have less
    heaviest = 23000.0
    lightest = 10.0  # densities of light foams and of osmium, kg/m³
    usual = named(material.name)
    if usual == material:
        return []
    found: list[str] = []
    for entry, dimension in (("density", "density"), ("youngs_modulus", "pressure")):
        value = getattr(material, entry)
        if usual is not None and not LEAST <= value / getattr(usual, entry) <= MOST:
            known = format_si(getattr(usual, entry), dimension)
            found.append(f"{entry}: {format_si(value, dimension)}, but {usual.name} has {known}; check units")
    if not found and not lightest <= material.density <= heaviest:
        of = "a light foam" if material.density < lightest else "osmium"
        limit = format_si(lightest if material.density < lightest else heaviest, "density")
        found.append(f"density: {format_si(material.density, 'density')}, but {of} has {limit}; check units")
    if not found and material.youngs_modulus < softest:
        modulus, limit = format_si(material.youngs_modulus, "pressure"), format_si(softest, "pressure")
        found.append(f"youngs_modulus: {modulus}, but a soft rubber has {limit}; check units")
    if material.yield_strength is not None and material.yield_strength > material.youngs_modulus:
        strength, modulus = (
            format_si(value, "pressure") for value in (material.yield_strength, material.youngs_modulus)
        )
        found.append(f"youngs_modulus: {modulus} is less than the yield strength, {strength}; check units")
    return found
