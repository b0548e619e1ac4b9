"""Gravity: the impactor's weight on the contact."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from film_model.base.arrays import any_of, either, unwarned
from film_model.effects.effect import FREE, NOT_NEEDED, PUSHED, SIMULATED, Effect, off_state, percent
from film_model.effects.judged import agreeing
from film_model.effects.trial import beyond, change, few, matters
from film_model.problem.problem import Problem


def estimate(weight: Any, force: Any, indentation: Any, energy: Any) -> Any:
    """Relative change of the summary by a weight [N] on a target that does not move.

    By the balance of energy, W(δ) = ½ m V² + m g δ, δ_m grows by m g/F_m and F_m by d ln F/d ln δ times that; for a
    power law F ∝ δ^q the exponent is q = F_m δ_m/W − 1. First order in m g/F_m.
    """
    exponent = force * indentation / energy - 1.0
    return weight / force * (exponent + abs(exponent - 1.0) + 1.0) / 2.0  # the larger of 1 and q


def needed(light: Problem) -> Any:
    """Whether an impact is simulated with its weight. light: the problem without it."""
    wanted = light.scene.effects.gravity
    if light.free or wanted != "auto":
        return wanted is True and not light.free
    if few(light):
        return beyond(size_of(light)[0], light.scene.effect_tolerance)
    pressed = light.again(load=light.impacts.numbers.weight)
    return matters(pressed, light, lambda with_weight, without: size_of(without, with_weight)[0])


def size_of(light: Problem, pressed: Problem | None = None) -> tuple[Any, Problem | None]:
    """Change of the summary by the weight (nan if contact without it does not end); the problem with it, if marched."""

    def marched() -> Any:
        nonlocal pressed
        pressed = light.again(load=light.impacts.numbers.weight) if pressed is None else pressed
        return change(pressed, light)

    return sized(light, marched), pressed


def sized(light: Problem, marched: Callable[[], Any]) -> Any:
    """The same by the first-order estimate up to 0.3 of the tolerance; beyond it, from marches."""
    ends = light.trial.ends
    size = _estimate_for(light, ends)
    doubtful = size > 0.3 * light.scene.effect_tolerance
    if any_of(doubtful & ends):
        size = either(doubtful, marched(), size)
    return either(ends, size, math.nan)


def _estimate_for(light: Problem, ends: Any) -> Any:
    """The first-order estimate; infinite if the target moves or contact does not end. ends: whether it does."""
    core, impacts = light.trial.summary, light.impacts
    usable = ends & (light.gamma == 0.0)
    if not any_of(usable):
        return math.inf
    with unwarned(usable):
        force = core.maximum_force * light.scales.force
        depth = core.maximum_indentation * light.scales.length + light.given.compliance * force
        return either(usable, estimate(impacts.numbers.weight, force, depth, impacts.numbers.energy), math.inf)


def describe(light: Problem, heavy: bool) -> Effect:
    """The effect on one impact. heavy: whether the weight is simulated."""
    wanted, tolerance = light.scene.effects.gravity, light.scene.effect_tolerance
    ratio, size, pressed, source = None, None, None, "balance of energy, to first order in m g/F_m"
    if light.free:
        ratio = size = 0.0
    elif light.trial.ends:
        ratio = light.impacts.numbers.weight / (light.trial.summary.maximum_force * light.scales.force)
        found, pressed = size_of(light)
        size = None if math.isnan(found) else found
        source = source if pressed is None else "marched with the weight and without"
    if heavy and pressed is None:
        pressed = light.again(load=light.impacts.numbers.weight)
    off = wanted is False and not light.free
    state = SIMULATED if heavy else off_state(size, tolerance) if off else NOT_NEEDED
    reason = "both bodies fall with the same acceleration" if light.free else _pressing(ratio, size)
    if off:
        reason = f"the scene has gravity = false; {reason}"
    elif heavy and wanted is True:
        reason = f"the scene asks for it; {reason}"
    if pressed is not None and pressed.trial.status >= 0 and not pressed.trial.ends:
        edges, kind = light.scene.target.finite and any_of(light.gamma > 0.0), light.scene.target.kind
        reason += f"; on an infinite {kind} the ball would come to rest" if edges else "; the ball comes to rest"
    cost = FREE if light.free else f"1 × the segments, {PUSHED}"
    threshold = agreeing(ratio, tolerance / 1.5, size, tolerance)
    return Effect("gravity", "m g/F_m", ratio, threshold, size, state, reason, source, cost)


def _pressing(ratio: float | None, size: float | None) -> str:
    """The weight against the contact force, and what it changes."""
    if ratio is None:
        return "contact does not end without the weight"
    changed = "an unknown amount" if size is None else percent(size)
    weighs = f"{100 * ratio:.2g} % of" if ratio < 1.0 else f"{ratio:.2g} times"
    return f"the weight is {weighs} the largest force and changes a result by {changed}"
