"""Target motion: the target moves by its impedance, its static stiffness or its vibrations."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from film_model.base.arrays import any_of, endless
from film_model.effects.effect import DAMPED, FREE, NOT_NEEDED, ON_MODES, SIMULATED, SPRUNG, Effect, off_state
from film_model.effects.judged import agreeing
from film_model.effects.trial import change, matters
from film_model.problem.curve import can_be_in_series
from film_model.problem.numbers import zener
from film_model.problem.problem import Problem


class Support(NamedTuple):
    """How a target moves: by its impedance [N s/m], or statically with its compliance [m/N]; of many impacts, arrays.

    vibrates: by its natural vibrations instead; impedance or compliance then only serve to decide other effects. slow:
    some of these vibrations are so slow that the target moves as a free mass, which the compliance does not include.
    """

    impedance: Any
    compliance: Any = 0.0
    vibrates: bool = False
    slow: bool = False

    def part(self, places: Any) -> Support:
        """Of some of many impacts."""
        impedance, compliance = (at[places] if isinstance(at, np.ndarray) else at for at in self[:2])
        return self._replace(impedance=impedance, compliance=compliance)

    @property
    def only_vibrates(self) -> bool:
        """Whether a trial without vibrations lacks a motion: it has the target fixed, or not as a free mass."""
        return self.vibrates and (self.slow or (self.compliance == 0.0 and endless(self.impedance)))

    @property
    def how(self) -> str:
        """How the target moves, in words."""
        if self.vibrates:
            return "vibrates between its edges"
        if self.compliance > 0.0:
            return f"has a static stiffness of {1 / self.compliance:.4g} N/m"
        return f"has an impedance of {self.impedance:.4g} N s/m"


def needed(moved: Problem, support: Support) -> Any:
    """Whether an impact is simulated with the target's motion. moved: the problem with it."""
    effects, impacts = moved.scene.effects, moved.impacts
    if effects.target_motion is False or not moved.scene.target.gives_way:
        return False
    asked = effects.boundary_reflections is True or effects.target_inertia is True
    if effects.target_motion is True or asked or support.only_vibrates or not any_of(moved.approach > 0.0):
        return True
    where = np.isfinite(moved.given.impedance) | (moved.given.compliance > 0.0) if impacts.many else None
    return matters(moved, held(moved), where=where)


def held(moved: Problem) -> Problem:
    """The problem on a target that does not move."""
    return moved.again(impedance=moved.impacts.column(math.inf), compliance=0.0)


def _released(problem: Problem) -> Problem | None:
    """The problem on a target that moves; None if it only vibrates, or the law cannot follow its static stiffness."""
    target, scales, impedance = problem.scene.target, problem.scales, problem.scene.target_impedance
    own = (target.compliance or 0.0) if math.isinf(impedance) else 0.0
    by_spring = own > 0.0 and can_be_in_series(problem.law, own * scales.force / scales.length)
    if math.isinf(impedance) and not by_spring:
        return None
    return problem.again(impedance=impedance, compliance=own)


def describe(problem: Problem, support: Support, moves: bool) -> Effect:
    """The effect on one impact. problem: with target motion, unless the scene switches it off."""
    scene, wanted, tolerance = problem.scene, problem.scene.effects.target_motion, problem.scene.effect_tolerance
    target, size, cost, value = scene.target, None, FREE, None
    if not target.gives_way:
        state, size, value = NOT_NEEDED, 0.0, 0.0
        reason = "the target is a free body: reduced mass" if problem.free else f"the target is a {target.kind}"
    elif wanted is False:
        state, reason = NOT_NEEDED, "the scene has target_motion = false"
    elif moves:
        state, reason = SIMULATED, f"the target {support.how}"
    else:
        state, reason = NOT_NEEDED, f"the target {support.how} and moves too little to matter"
    moved = _released(problem) if wanted is False else problem
    if moved and target.gives_way and scene.approach_velocity > 0.0:
        still = problem if wanted is False else held(problem)
        found = change(moved, still)
        size = None if math.isnan(found) or support.only_vibrates else found
        each = SPRUNG if moved.given.compliance > 0.0 else DAMPED
        cost = f"{moved.trial.summary.lines / max(still.trial.summary.lines, 1):.2g} × the segments, {each}"
        if support.vibrates:
            cost = ON_MODES
    if math.isfinite(scene.target_impedance):
        found = zener(scene, scene.target_impedance)
        value = None if math.isnan(found) else found
    if target.gives_way and wanted is False:
        state = off_state(size, tolerance)
    source = "Zener 1941, Phys. Rev. 59:669; marched with the target's motion and without"
    # as λ → 0, e = 1 − 1.730173 λ
    threshold = agreeing(value, tolerance / (2 * 1.730173), size, tolerance)
    return Effect("target_motion", "Zener's λ", value, threshold, size, state, reason, source, cost)
