"""Numbers of a scene that do not go together, or are possible, but more often a mistake of units."""

from __future__ import annotations

import math
from typing import Any

from film_model.base.arrays import endless
from film_model.base.errors import Mistake
from film_model.base.materials import USUAL
from film_model.base.units import format_si
from film_model.laws import LAWS
from film_model.scene.noses import VOLUMES, second_radius


def remarks_about(scene: Any) -> tuple[str, ...]:
    """A sentence for each number of a material, and each given mass, that is far from what is possible or usual."""
    found: list[str] = []
    for part, body in (("impactor", scene.impactor), ("target", scene.target)):
        mass, material = getattr(body, "mass", None), body.material
        if material is None:
            continue
        found += [f"{part}.material.{said}" for said in material.remarks]
        if mass is None or not math.isfinite(body.radius) or getattr(body, "shape", None) in VOLUMES:
            continue
        ball = material.density * 4.0 / 3.0 * math.pi * body.radius**3
        if not ball * USUAL[0] <= mass <= ball * USUAL[1]:
            found.append(
                f"{part}.mass: {format_si(mass, 'mass')} is {mass / ball:.3g} times density × volume of a ball of its "
                f"radius, {format_si(ball, 'mass')}; right for a heavy body with a rounded nose, otherwise check units"
            )
    return tuple(found)


def mistakes_of(scene: Any) -> list[Mistake]:
    """Mistakes that concern several parts of a scene."""
    found = _mistakes_of_shape(scene)
    contact, target, name = scene.contact, scene.target, scene.contact.law_name
    if scene.impactor.own_mass is None:
        found["impactor.mass"] = f"missing: {scene.impactor.mass_needed}"
    if target.own_mass is None:
        found["target.mass"] = "missing: give mass, or a material (the mass is then density × sphere volume)"
    if target.free and scene.approach_velocity <= 0:
        found["target.velocity"] = f"{target.velocity:g} m/s must be < the impactor's {scene.impactor.speed:g} m/s"
    if contact.needs("effective_modulus") and scene.effective_modulus is None:
        both = (("impactor", scene.impactor), ("target", target))
        missing = " and ".join(f"{part}.material" for part, body in both if body.material is None)
        rule = ', or unloading = "retrace"' if contact.unloading_name == "brake" else ""
        found["contact.effective_modulus"] = f"missing: give {missing}, or effective_modulus{rule}"
    if contact.needs("poissons_ratio") and scene.poissons_ratio is None:
        found["contact.poissons_ratio"] = f'missing: law "{name}" needs it: give a material, or poissons_ratio'
    steep = scene.effects.small_slope is True if name == "auto" else contact.needs("slope_coefficient")
    if steep and scene.slope_coefficient is None:
        found["contact.law"] = "steep surfaces are those of balls, and need the material of a body"
    if contact.needs("work_of_adhesion") and not scene.work_of_adhesion:
        found["contact.work_of_adhesion"] = f'law "{name}" needs a value > 0: give it, or materials with surface_energy'
    if scene.yield_strength is None:
        where = "give hardness or yield_strength of a material, or yield_strength in [contact]"
        if contact.needs("yield_strength"):
            found["contact.law"] = f'law "{name}" needs a yield strength: {where}'
        elif scene.effects.plasticity is True and name == "auto":
            found["effects.plasticity"] = f"plasticity needs a yield strength: {where}"
        for parameter in contact.from_strength:
            found[f"contact.{parameter}"] = f'missing: law "{name}" needs it, or a yield strength: {where}'
    if scene.effects.rate_hardening is True:
        if name != "auto" and not contact.has("yield_strength"):
            found["effects.rate_hardening"] = f'law "{name}" has no yield_strength that could rise'
        elif scene.rate_hardening is None:
            found["effects.rate_hardening"] = (
                "missing: the material that yields needs a yield strength, and strain_rate_coefficient "
                "or rate_multiplier"
            )
    return [Mistake(None, None, f"Scene.{key}", message) for key, message in found.items()]


def _mistakes_of_shape(scene: Any) -> dict[str, str]:
    """What the surfaces of a scene, or a contact that is not round, cannot have, by path."""
    body, target, contact, found = scene.impactor, scene.target, scene.contact, dict[str, str]()
    seconds = second_radius(body), getattr(target, "second_radius", None)
    for entry, own, other in (("radius", body.radius, target.radius), ("second_radius", *seconds)):
        if other is not None and -own <= other < 0.0:
            radii = [format_si(value, "length") for value in (other, -own)]
            found[f"target.{entry}"] = f"{radii[0]} is a hollow: it must be < {radii[1]}, the ball's"
    if scene.is_round:
        return found
    what = f'shape "{body.shape}"' if scene.nose is not None else "a second radius of curvature"
    if scene.nose is not None and (not endless(target.radius) or seconds[1] is not None):
        found["target.radius"] = f"{what} needs a flat target: leave out its radii"
    law = LAWS[contact.law] if isinstance(contact.law, str) and contact.law != "auto" else None
    yields = law is not None and law.family in ("yields", "adhesive")
    if law is not None and (yields if scene.nose is None else contact.needs("radius")):
        found["contact.law"] = f'law "{law.name}" is of balls: leave it out with {what}'
    if contact.unloading_name == "brake":
        found["contact.unloading"] = f'Brake\'s rule is of balls: give unloading = "retrace" with {what}'
    if scene.effects.plasticity is True:
        found["effects.plasticity"] = f"true, but laws that yield are of balls, not of {what}"
    if contact.friction is not None:
        found["contact.friction"] = f"friction is simulated of balls, not with {what}"
    return found
