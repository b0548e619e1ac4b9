"""Small slope: surfaces of balls that are pressed in far are steep, and not Hertz's paraboloids.

    F = K δ^{3/2} (1 + c √(δ/R))        c = 0.976 R/R_b of an elastic ball of radius R_b, 0.157 of a half-space

Each body counts by its share of the compliance. The largest force changes by c √(δ/R)/2 at most, indentation and
contact time by less. Beyond the tolerance law "auto" takes large-slope in place of hertz, damped-large-slope in place
of tsuji; [finite elements](finite_elements.md#elastic-contacts-of-large-slope) of a ball with its inertia agree within
2.2 % of force and indentation up to √(δ/R) = 0.35 by Hertz's law, 7 % up to 0.5. From an indentation of one radius
no law is valid. Law elastoplastic has Hertz's elastic stage: where yield begins to matter, the largest force falls by
2 % between metals, by 3 % of polymers.
"""

from __future__ import annotations

import math
from typing import Any

from film_model.base.arrays import any_of
from film_model.effects.case import Case
from film_model.effects.effect import FREE, NOT_MODELLED, SIMULATED, Effect, off_state
from film_model.laws.large_slope import BALL
from film_model.problem.law_of_scene import STEEP, YIELDING
from film_model.problem.problem import Problem
from film_model.scene import Scene
from film_model.targets import Estimate

COMPUTED = 0.5
"""√(δ/R) up to which finite elements were computed."""


def steep(problem: Problem) -> tuple[Problem, Any]:
    """Impacts with the slopes of their surfaces, and for which of them they are simulated; if for none, the impacts as
    they are."""
    base, scene, wanted = problem.scene, problem.impacts.scene, problem.scene.effects.small_slope
    coefficient = scene.slope_coefficient
    off = wanted is False or base.contact.law != "auto" or problem.law.name not in STEEP
    if off or coefficient is None or problem.relaxation is not None:
        return problem, False
    matters = True if wanted is True else change_of(scene, problem.given.load) > base.effect_tolerance
    if not any_of(matters):
        return problem, False
    return problem.under(STEEP[problem.law.name]), matters


def change_of(scene: Scene, load: Any) -> Any:
    """The change of the largest force by the slopes, at most: the target does not move, and its
    indentation is the sum of those by the energy alone and by the load [N] alone. None if it is unknown."""
    if scene.slope_coefficient is None:
        return None
    stiffness = scene.hertz_stiffness
    deepest = (2.5 * scene.kinetic_energy / stiffness) ** 0.4 + (2.5 * load / stiffness) ** (2.0 / 3.0)
    return _change(scene.slope_coefficient, deepest / scene.effective_radius)


def _change(coefficient: Any, depth: Any) -> Any:
    """The change of the largest force of an impact by law large-slope, to second order. depth: Hertz's, over R."""
    steepness = coefficient * depth**0.5
    return steepness / (2.0 + steepness)


def judge(case: Case) -> Estimate:
    """Hertz's half-spaces and paraboloids instead of balls: the change of the force at the energy of the impact."""
    # Indentation over the effective radius from which no contact law is valid: half of a ball is below the surface
    deepest = 1.0
    scene = case.scene
    modulus, radius, coefficient = scene.effective_modulus, scene.effective_radius, scene.slope_coefficient
    if scene.nose is not None:
        beyond = case.seen.contact_radius / scene.impactor.radius
        if beyond > 1.0:
            return Estimate(f"the {scene.impactor.shape} is pressed in beyond its base", beyond, 1.0, fails=True)
        return Estimate("known for balls only", beyond)
    if modulus is None:
        return Estimate("missing: an effective modulus")
    if case.problem.law.name == YIELDING and case.seen.indentation <= deepest * radius:
        return Estimate(f"law {YIELDING} is that of finite elements with large slopes", applies=False)
    seen = case.seen
    if seen.indentation > deepest * radius:
        why = f"the indentation is {seen.indentation / radius:.3g} times the radius: no contact law is valid so deep"
        return Estimate(why, seen.contact_radius / radius, math.sqrt(deepest), fails=True)
    hertz = (seen.force / scene.hertz_stiffness) ** (2.0 / 3.0)  # elastic part of the indentation
    size = _change(BALL if coefficient is None else coefficient, hertz / radius) * hertz / seen.indentation
    value = seen.contact_radius / radius
    threshold = seen.tolerance * value / size if size > 0.0 else None
    why = f"the contact radius is {value:.2g} R: the force is about {100 * size:.2g} % off by Hertz's theory"
    why += "" if value <= COMPUTED else f"; computed was up to {COMPUTED:g} R"
    if coefficient is None and size > seen.tolerance:
        why = f"missing: impactor.material; if the target is much stiffer, {why}"
        return Estimate(why, value, threshold)
    return Estimate(why, value, threshold, min(size, 1.0))


def settled(effect: Effect, problem: Problem) -> Effect:
    """The estimated effect with what was decided about it. problem: what is simulated."""
    scene, law = problem.scene, problem.law.name
    if problem.law.steep:
        return effect._replace(state=SIMULATED, threshold=None, reason=f"{effect.reason}: law {law}", cost=FREE)
    if effect.change is None:
        return effect
    if scene.effects.small_slope is False:
        state = off_state(effect.change, scene.effect_tolerance)
        return effect._replace(state=state, reason=f"the scene has small_slope = false; {effect.reason}")
    if effect.state != NOT_MODELLED or law not in STEEP:
        return effect
    auto = scene.contact.law == "auto"
    why = "a material relaxes" if auto else f"the law {law} has Hertz's force: law {STEEP[law]} simulates it"
    return effect._replace(reason=f"{effect.reason}; {why}")
