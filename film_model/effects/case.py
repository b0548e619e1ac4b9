"""One impact in the form that the rules for neglected effects take."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from film_model.base.arrays import either, greater, ratio
from film_model.problem.problem import Problem
from film_model.scene import Scene
from film_model.scene.noses import elastic_radius
from film_model.targets import Impact

YIELDS = 1e-9
"""Absorbed fraction of the impact energy above which something has yielded."""


class Pulse(NamedTuple):
    """The impulse of one impact or of many, dimensionless.

    back: time from the centre of the impulse to the end of contact, in the units of the march. motion: the target's
    displacement over V t_c, m (1 + e)/(Z t_c).
    """

    restitution: Any
    back: Any
    motion: Any

    @classmethod
    def of(cls, approach: Any, gamma: Any, core: Any) -> Pulse:
        """From the approach velocity, γ and the core's summary of contacts that have ended."""
        push, duration = approach - core.final_velocity, core.contact_duration
        moved = core.permanent_indentation + core.shift
        back = either(push > 0.0, ratio(approach * duration - moved, push), 0.5 * duration)
        back = greater(back, 0.0)  # a load that is not in the balance of momentum may move it beyond the end
        return cls(-core.final_velocity / approach, back, push / approach * gamma / duration)


class Case(NamedTuple):
    """The input of the rules: a problem, and its impact on the trial mesh as the rules of a target see it."""

    problem: Problem
    scene: Scene
    seen: Impact


def absorbed(problem: Problem) -> float:
    """Fraction of the impact energy that plastic deformation absorbs; of a reversible law that pulls, parting absorbs
    all, and of one that yields this counts as deformation."""
    if problem.curve.pulls and problem.curve.reversible:
        return 0.0
    return greater(problem.trial.summary.work / (0.5 * problem.approach**2), 0.0)


def deforms(problem: Problem) -> Any:
    """Whether something has yielded."""
    return absorbed(problem) > YIELDS


def case_of(problem: Problem, vibrates: bool) -> Case:
    """The impact of a problem whose trial march ends. vibrates: its target does, though not in this problem."""
    s, core, scene = problem.scales, problem.trial.summary, problem.scene
    pulse, indentation = Pulse.of(problem.approach, problem.gamma, core), core.maximum_indentation * s.length
    fixed = problem.again(impedance=math.inf, compliance=0.0)
    if not fixed.trial.ends:  # on a target that does not move, the impact is beyond the law
        fixed = problem
    still, units = fixed.trial.summary, fixed.scales
    softness = still.maximum_indentation * units.length / (still.maximum_force * units.force)
    seen = Impact(
        mass=scene.mass,
        force=core.maximum_force * s.force,
        indentation=indentation,
        contact_radius=elastic_radius(scene, indentation),
        duration=core.contact_duration * s.time,
        turn=core.time_of_maximum_indentation * s.time,
        restitution=pulse.restitution,
        energy=scene.kinetic_energy,
        fraction=absorbed(problem),
        back=pulse.back * s.time,
        motion=pulse.motion,
        by_impedance=problem.gamma != 0.0,
        by_compliance=problem.given.compliance > 0.0,
        vibrates=vibrates,
        tolerance=scene.effect_tolerance,
        held=(still.contact_duration * units.time, softness),
    )
    return Case(problem, scene, seen)
