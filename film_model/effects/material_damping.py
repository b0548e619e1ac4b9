"""Damping in the materials: under law "auto", the damped law tsuji with the restitution of their loss factors.

The restitution (film_model/laws/damping.py: loss_restitution) does not depend on the velocity, as tan δ does not on the
frequency. One impact both yields and is damped only if its law does both, which none does here: the law is taken that
leaves the lower restitution.
"""

from __future__ import annotations

import math
from typing import Any

from film_model.base.arrays import all_of, any_of, either, greater
from film_model.effects.effect import FREE, NOT_MODELLED, SIMULATED, Effect, off_state
from film_model.effects.trial import matters
from film_model.problem.law_of_scene import DAMPED, ELASTIC, STEEP, YIELDING
from film_model.problem.problem import Problem
from film_model.scene import Scene

MARGIN = 1.05
"""Of :func:`change_of`, to the change that marches show (tests/test_material_damping.py)."""

MOST_GAMMA = 2.0
"""γ of a moving target up to which damping changes the summary by less than on a fixed one (the same test)."""


def hindered(problem: Problem) -> str:
    """Why the damping of a problem under law "auto" cannot be simulated; empty if it can."""
    if any_of(problem.given.compliance > 0.0):
        return "the target follows the force by its static stiffness"
    return "a material relaxes" if _relaxes(problem.scene) else ""


def _relaxes(scene: Scene) -> bool:
    bodies = (scene.impactor.material, scene.target.material)
    return scene.effects.viscoelasticity is not False and any([m is not None and m.prony is not None for m in bodies])


def damped(problem: Problem) -> tuple[Problem, Any]:
    """Impacts with the losses of their materials, and for which of them they are simulated; if for none, the impacts as
    they are."""
    scene, law = problem.scene, problem.law.name
    wanted, known = scene.effects.material_damping, problem.impacts.scene.loss_factor
    off = wanted is False or scene.contact.law != "auto" or law not in (ELASTIC, YIELDING)
    if off or known is None or not any_of(known > 0.0) or hindered(problem):
        return problem, False
    if law == YIELDING and (scene.effects.plasticity is True or _keeps_more(problem)):
        return problem, False
    sure = _surely(problem) if law == ELASTIC else None
    if sure is False:
        return problem, False
    made = problem.under(DAMPED)
    if law == ELASTIC:
        return made, sure or not any_of(problem.approach > 0.0) or matters(made, problem)
    known = problem.trial.status >= 0  # a ball deeper than the law's end is an error, not elastic
    return made, known & (rebound(made) < rebound(problem))


def change_of(restitution: Any) -> Any:
    """The change of the summary by the damping of an elastic impact on a fixed target: by the energy lost, 1 − e², or
    by the indentation at which the force ends, over the largest."""
    lost = 1.0 - restitution**2.0
    return greater(lost, 0.4 * lost**0.8)


def _surely(problem: Problem) -> bool | None:
    """Whether the losses of the materials matter in all elastic impacts, or in none; None if marches have to tell."""
    if problem.loaded or problem.vibrates or not all_of(problem.approach > 0.0):
        return None
    size, tolerance = change_of(problem.impacts.scene.loss_restitution), problem.scene.effect_tolerance
    if all_of(size < tolerance / MARGIN):
        return False if all_of(problem.gamma <= MOST_GAMMA) else None
    return True if _is_fixed(problem) and all_of(size > MARGIN * tolerance) else None


def _is_fixed(problem: Problem) -> bool:
    """Whether no target moves, and no weight presses."""
    return not (any_of(problem.gamma > 0.0) or problem.loaded or problem.vibrates)


def _keeps_more(problem: Problem) -> bool:
    """Whether the losses of the materials leave more than yield does in all impacts, which a target that is fixed shows
    without a march of the damped law."""
    if not _is_fixed(problem):
        return False
    kept = problem.impacts.scene.loss_restitution * problem.approach * problem.scales.velocity
    return not any_of(kept < rebound(problem))


def rebound(problem: Problem) -> Any:
    """Velocity after the trial impact, m/s; infinite if contact does not end: then neither loss is the larger."""
    return either(problem.trial.ends, -problem.trial.summary.final_velocity * problem.scales.velocity, math.inf)


def settled(effect: Effect, problem: Problem) -> Effect:
    """The estimated effect with what was decided about it. problem: what is simulated."""
    scene, law, share = problem.scene, problem.law.name, effect.change
    if scene.loss_factor is None:
        return effect
    if problem.law.damped and scene.contact.law == "auto":
        return effect._replace(state=SIMULATED, threshold=None, reason=f"{effect.reason}: law {law}", cost=FREE)
    if share is None:
        return effect
    if scene.effects.material_damping is False:
        state = off_state(share, scene.effect_tolerance)
        return effect._replace(state=state, reason=f"the scene has material_damping = false; {effect.reason}")
    if effect.state != NOT_MODELLED:
        return effect
    why = (
        hindered(problem)
        if law in (ELASTIC, STEEP[ELASTIC]) and scene.contact.law == "auto"
        else f"the law {law} has no damping"
    )
    return effect._replace(reason=f"{effect.reason}; {why}")
