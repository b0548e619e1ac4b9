"""Oblique impact, and the effects that the target judges."""

from __future__ import annotations

import math
from collections.abc import Callable

from film_model.base.units import format_si
from film_model.effects.case import ABSENT, Case, Rule
from film_model.effects.effect import FREE, SIMULATED, Effect
from film_model.effects.oblique_limits import LARGEST, expected, unknown
from film_model.scene import Scene
from film_model.targets import AbstractTarget, Estimate


def by_target(method: str) -> Callable[[Case, Rule], Effect]:
    """The rule of an effect that this method of the target estimates."""

    def judge(case: Case, rule: Rule) -> Effect:
        found: Estimate = getattr(case.scene.target, method)(case.seen)
        rule = rule if found.indicator is None else rule._replace(indicator=found.indicator)
        if not found.applies:
            return rule.absent(found.reason)
        if found.fails:
            return rule.failing(found.reason, found.value, found.threshold)
        if found.change is None or found.value is None:
            return rule.unjudged(found.reason, found.value, found.threshold)
        cost, reason = ABSENT, found.reason
        if found.remedy is not None:
            cost = f"{ABSENT}: {found.remedy}"
            reason += f": {found.remedy}" if found.change > case.seen.tolerance else ""
        return rule.sized(case.seen.tolerance, found.value, found.threshold, found.change, reason, cost)

    judge.__doc__ = getattr(AbstractTarget, method).__doc__
    return judge


def obliqueness(case: Case, rule: Rule) -> Effect:
    """An impact at an angle or with spin: simulated with friction in [contact], otherwise its normal component.

    Without friction the change is the range of the ball's tangential velocity for friction coefficients from 0 to 1,
    over its speed before: the impulse is at most µ m (1 + e) V cos α and m_t v (1 + β), with the largest share β of the
    velocity that an elastic contact gives back.
    """
    # how it slides is not said under damping, which lets more friction through
    scene, damps = case.scene, case.problem.damps and case.scene.contact.friction is not None
    return oblique(scene, rule, None if damps else case.seen.restitution, case.seen.tolerance)


def oblique(scene: Scene, rule: Rule, restitution: float | None, tolerance: float) -> Effect:
    """The same, also for an impact whose restitution is unknown."""
    angle, friction = scene.impactor.angle or 0.0, scene.contact.friction
    if angle == 0.0 and not scene.impactor.spin and not getattr(scene.target, "spin", None):
        return rule.absent("the impact is along the normal, without spin")
    if friction is not None:
        why = f"the tangential motion and the spin are simulated with a friction coefficient of {friction:g}"
        sliding = None if restitution is None else expected(scene, restitution)
        why += f"; {sliding}" if sliding else ""
        if scene.target.kind not in ("half-space", "body"):
            why += f"; the {scene.target.kind} is immovable along its surface"
        return rule.failing(why, math.degrees(angle), 0.0)._replace(state=SIMULATED, cost=FREE)
    normal = format_si(scene.impactor.speed, "velocity")
    why = f"only the normal component, {normal}, is simulated: give friction in [contact]"
    if restitution is None:
        return rule.failing(why, math.degrees(angle), 0.0)
    found = unknown(scene, restitution)
    kinds = {"velocity": found.speed, "angle": found.angle, "angular_frequency": found.spin}
    speed, turn, spun = (_range(ends, kind) for kind, ends in kinds.items())
    why += (
        f"; with coefficients from 0 to {LARGEST:g} the ball leaves with {speed} at {turn} to the normal, spin {spun}"
    )
    return rule.sized(tolerance, math.degrees(angle), 0.0, found.change, why)


def _range(ends: tuple[float, float], kind: str) -> str:
    if kind == "angle":
        return " to ".join(f"{math.degrees(end):.3g}°" for end in ends)
    return " to ".join(format_si(end, kind, 3) for end in ends)
