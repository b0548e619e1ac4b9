"""When a brittle body crushes or may crack below a ball, from the largest force and the contact radius.

Every formula serves one impact (floats) and many (arrays).
"""

from __future__ import annotations

import itertools
import math
from typing import Any

from film_model.base.arrays import either, exponential, greater, lesser
from film_model.base.materials import Material
from film_model.problem.problem import Problem
from film_model.problem.stresses import contact_radius, edge_tension
from film_model.scene import Scene
from film_model.scene.noses import elastic_radius

RING_CRACK = (
    (0.0, 0.1, 0.2, 0.25, 0.3, 0.35, 0.4),
    (-4.0125, -4.6667, -5.5099, -6.0452, -6.7017, -7.5505, -8.7511),
)
"""Poisson's ratio, and ln ψ: K² = F² ψ/(π² a³) of the ring crack around a contact that F drives most. K is the integral
2 √(c/π) ∫ σ_r g dz/√(c² − z²) with Huber's stress and g = 1.3 − 0.3 (z/c)^1.25 of an edge crack."""

BRITTLE = ("crushing_strength", "fracture_toughness", "tensile_strength")
"""Entries of a brittle material, of which the first that it has is judged."""


def bodies(scene: Scene) -> list[Material]:
    """The materials of a scene that are brittle."""
    given = (scene.impactor.material, scene.target.material)
    return [m for m in given if m is not None and any([getattr(m, name) is not None for name in BRITTLE])]


def factors(body: Material | None) -> tuple[Any, Any]:
    """What F/a² [1/Pa] and F²/a³ [1/(Pa² m)] are multiplied by for the indicator of a brittle body: 1 where it fails.

    F the largest force, a the contact radius. Of F/a²: mean pressure over crushing_strength, or tension at the edge
    over tensile_strength; of F²/a³: K² of a ring crack over that of fracture_toughness. 0 of other bodies.
    """
    if body is None:
        return 0.0, 0.0
    if body.crushing_strength is not None:
        return 1.0 / (math.pi * body.crushing_strength), 0.0
    if body.fracture_toughness is not None:
        x, (at, values) = body.poissons_ratio, RING_CRACK
        logarithm: Any = values[0]  # linear between the rows of the table
        for k, (low, high) in enumerate(itertools.pairwise(at)):
            step = (values[k + 1] - values[k]) / (high - low)
            logarithm = logarithm + step * (greater(lesser(x, high), low) - low)
        return 0.0, exponential(logarithm) / (math.pi * body.fracture_toughness) ** 2
    strength = body.tensile_strength
    return 0.0 if strength is None else edge_tension(body.poissons_ratio, 1.5 / math.pi) / strength, 0.0


def failure(of: tuple[Any, Any], force: Any, radius: Any) -> Any:
    """The indicator from its factors, force [N] and contact radius [m]."""
    return (of[0] + of[1] * force / radius) * force / (radius * radius)


def own_radius(problem: Problem, force: Any, indentation: Any) -> Any:
    """Contact radius at the largest force, m; that of the elastic contact if no other is known."""
    radius, _ = contact_radius(problem.impacts, force, indentation)
    return either(radius == radius, radius, elastic_radius(problem.impacts.scene, indentation))


def fails(problem: Problem) -> Any:
    """Whether a brittle body of the scene crushes or may crack."""
    impacts = problem.impacts
    brittle = bodies(impacts.scene)
    if not brittle:
        return False
    core, scales = problem.trial.summary, problem.scales
    force, depth = core.maximum_force * scales.force, core.maximum_indentation * scales.length
    radius = own_radius(problem, force, depth)
    touches = radius > 0.0  # not of one that is still pressed in when it is no longer followed
    failing = [failure(factors(body), force, either(touches, radius, 1.0)) > 1.0 for body in brittle]
    return touches & (failing[0] | failing[-1])
