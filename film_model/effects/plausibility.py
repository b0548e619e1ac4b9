"""Numbers of a scene that are possible, but more often a mistake of units."""

from __future__ import annotations

import math

from film_model.base.units import format_si
from film_model.scene import Scene

UNLIKELY = 1000.0
"""Mass over density × volume of a ball of the contact's radius, or its inverse, that causes a remark."""


def remarks(scene: Scene) -> tuple[str, ...]:
    """A sentence for each given mass that is far from that of a ball of its radius and material."""
    found: list[str] = []
    for part, body in (("impactor", scene.impactor), ("target", scene.target)):
        mass, material = getattr(body, "mass", None), body.material
        if mass is None or material is None or not math.isfinite(body.radius):
            continue
        ball = material.density * 4.0 / 3.0 * math.pi * body.radius**3
        if not ball / UNLIKELY < mass < ball * UNLIKELY:
            found.append(
                f"{part}.mass: {format_si(mass, 'mass')} is {mass / ball:.3g} times density × volume of a ball of its "
                f"radius, {format_si(ball, 'mass')}; right for a heavy body with a rounded nose, otherwise check units"
            )
    return tuple(found)
