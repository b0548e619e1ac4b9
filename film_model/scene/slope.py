"""How steep two bodies in contact are: what Hertz's half-spaces and paraboloids leave out."""

from __future__ import annotations

from typing import Any

from film_model.base.arrays import greater, lesser
from film_model.laws.large_slope import BALL, HALF_SPACE
from film_model.scene.impactor import Sphere
from film_model.scene.noses import relative_radius
from film_model.targets import AbstractTarget


def slope_coefficient(ball: Sphere, target: AbstractTarget, modulus: Any) -> Any:
    """c of law large-slope; None if neither material, or not the effective modulus is known.

    A material that is not given has the rest of the compliance.
    """
    materials = [m for m in (ball.material, target.material) if m is not None]
    soft = [(1.0 - m.poissons_ratio**2) / m.youngs_modulus for m in materials]
    if modulus is None or not soft:
        return None
    first = soft[0] / (sum(soft) if len(soft) == 2 else 1.0 / modulus)
    share = lesser(greater(first if ball.material is not None else 1.0 - first, 0.0), 1.0)
    radius = relative_radius(ball.radius, target.radius)
    other = BALL * radius / target.radius if target.free else HALF_SPACE
    return share * BALL * radius / ball.radius + (1.0 - share) * other
