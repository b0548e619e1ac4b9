"""Membrane forces of a target that is bent by more than a fraction of its thickness: simulated on its vibrations."""

from __future__ import annotations

from film_model.base.errors import SimulationError
from film_model.effects.effect import NOT_MODELLED, SIMULATED, STRETCHED, Effect, off_state
from film_model.effects.judged import judged
from film_model.problem.problem import Problem
from film_model.scene import Scene


def possible(scene: Scene) -> bool:
    """Whether they can be simulated, and the scene does not switch them off. SimulationError if it asks in vain."""
    wanted, known = scene.effects.stretching, scene.target.stretches
    if wanted is True and not known:
        raise SimulationError(
            "effects.stretching is true, but the membrane forces are not known: they need a plate or beam of known "
            "thickness and size, without static_stiffness, held at opposite edges, with in_plane"
        )
    return known and wanted is not False and scene.effects.target_motion is not False


def needed(problem: Problem) -> bool:
    """Whether they are simulated in one impact. problem: on the target's impedance or static stiffness."""
    if not possible(problem.scene):
        return False
    ends = problem if problem.trial.ends else problem.again(load=0.0)  # the weight may keep the contact closed
    return problem.scene.effects.stretching is True or judged(ends, "stretching").state == NOT_MODELLED


def settled(effect: Effect, problem: Problem) -> Effect:
    """The estimated effect with what was decided about it. problem: what is simulated."""
    scene = problem.scene
    if problem.stretches:
        return effect._replace(state=SIMULATED, cost=STRETCHED)
    if scene.effects.stretching is False and effect.change is not None:
        state = off_state(effect.change, scene.effect_tolerance)
        return effect._replace(state=state, reason=f"the scene has stretching = false; {effect.reason}")
    return effect
