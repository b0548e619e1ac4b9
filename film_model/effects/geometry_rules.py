"""Effects of the shape of the bodies: slopes, whole balls, oblique impact; and those that the target judges."""

from __future__ import annotations

import math
from collections.abc import Callable

from film_model.base.units import format_si
from film_model.effects.case import ABSENT, Case, Rule
from film_model.effects.effect import FREE, SIMULATED, Effect
from film_model.effects.elastic_ball import COMPUTED, Body, change, excess
from film_model.effects.oblique_limits import LARGEST, expected, unknown
from film_model.laws.hertz import hertz_stiffness
from film_model.scene import Scene
from film_model.targets import AbstractTarget, Estimate


def by_target(method: str) -> Callable[[Case, Rule], Effect]:
    """The rule of an effect that this method of the target estimates."""

    def judge(case: Case, rule: Rule) -> Effect:
        found: Estimate = getattr(case.scene.target, method)(case.seen_by_target)
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
            reason += f": {found.remedy}" if found.change > case.tolerance else ""
        return rule.sized(case.tolerance, found.value, found.threshold, found.change, reason, cost)

    judge.__doc__ = getattr(AbstractTarget, method).__doc__
    return judge


def small_slope(case: Case, rule: Rule) -> Effect:
    """Hertz's half-spaces and paraboloids instead of balls.

    By [finite elements](finite_elements.md#elastic-contacts-of-large-slope) an elastic ball presses harder than
    Hertz's; Sneddon's rigid sphere less by a²/(10 R²). Shares of the compliance weight the bodies. The change is that
    of the indentation at the energy of the impact; force and contact time change less. From an indentation of one
    radius no law is valid.
    """
    deepest = 1.0  # over the effective radius: half the ball is below the surface, and no contact law is valid
    scene = case.scene
    modulus, radius = scene.effective_modulus, scene.effective_radius
    if scene.nose is not None:
        beyond = case.contact_radius / scene.impactor.radius
        if beyond > 1.0:
            return rule.failing(f"the {scene.impactor.shape} is pressed in beyond its base", beyond, 1.0)
        return rule.unjudged("known for balls only", beyond)
    if modulus is None:
        return rule.unjudged("missing: an effective modulus")
    if case.indentation > deepest * radius:
        why = f"the indentation is {case.indentation / radius:.3g} times the radius: no contact law is valid so deep"
        return rule.failing(why, case.contact_radius / radius, math.sqrt(deepest))
    hertz = (case.force / hertz_stiffness(modulus, radius)) ** (2.0 / 3.0)  # elastic part of the indentation
    bodies, known = _bodies(scene, modulus)
    size = change(excess(bodies), math.sqrt(hertz / radius)) * hertz / case.indentation
    value = case.contact_radius / radius
    threshold = case.tolerance * value / size if size > 0.0 else None
    why = f"the contact radius is {value:.2g} R: the indentation is about {100 * size:.2g} % off by Hertz's theory"
    why += "" if value <= COMPUTED else f"; computed was up to {COMPUTED:g} R"
    if not known and size > case.tolerance:
        why = f"missing: impactor.material; if the target is much stiffer, {why}"
        return rule.unjudged(why, value, threshold)
    return rule.sized(case.tolerance, value, threshold, min(size, 1.0), why)


def _bodies(scene: Scene, modulus: float) -> tuple[list[Body], bool]:
    """The bodies, and whether their shares of the indentation are known; otherwise the ball is taken as the whole."""
    bodies = (scene.impactor, scene.target)
    soft = [None if (m := body.material) is None else (1.0 - m.poissons_ratio**2) / m.youngs_modulus for body in bodies]
    total = 1.0 / modulus if None in soft else sum(c for c in soft if c is not None)
    balls, found = (True, scene.target.free), list[Body]()
    for body, ball, own, other in zip(bodies, balls, soft, soft[::-1], strict=True):
        rest = 1.0 if ball else 0.0  # of two unknown bodies
        share = own / total if own is not None else rest if other is None else 1.0 - other / total
        curvature = scene.effective_radius / body.radius if ball else 0.0
        found.append(Body(min(max(share, 0.0), 1.0), curvature))
    return found, soft != [None, None]


def obliqueness(case: Case, rule: Rule) -> Effect:
    """An impact at an angle or with spin: simulated with friction in [contact], otherwise its normal component.

    Without friction the change is the range of the ball's tangential velocity for friction coefficients from 0 to 1,
    over its speed before: the impulse is at most µ m (1 + e) V cos α and m_t v (1 + β), with the largest share β of the
    velocity that an elastic contact gives back.
    """
    # how it slides is not said under damping, which lets more friction through
    scene, damps = case.scene, case.problem.damps and case.scene.contact.friction is not None
    return oblique(scene, rule, None if damps else case.restitution, case.tolerance)


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
