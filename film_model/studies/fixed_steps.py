"""Methods with fixed steps as alternatives to FILM: small increments and Newmark's."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from film_model.studies.impact_ode import Impact, Passage, Run, follow, sizes


def _marched(one_step: Callable[..., tuple[float, float]], steps: int, impact: Impact) -> tuple[float, ...]:
    """About `steps` steps of equal size per contact; events within a step are located on the cubic through its ends."""
    depth, nu = sizes(impact)
    h = 3.0 * float(depth / nu) / steps

    def advance(run: Run, time: float, state: Any, loading: bool, watch_stop: bool) -> Passage:
        most_steps = 200_000
        xi, v = state
        stop: float | None = None
        y0, f = impact.motion(run, xi, v)
        peak = 0.0
        for _ in range(most_steps):
            xi1, v1 = one_step(impact, run, h, xi, v, y0, f)
            y1, f1 = impact.motion(run, xi1, v1)
            a0, a1 = impact.load - f, impact.load - f1
            passed = _crossing(v, v1, a0, a1, 0.0, h) if watch_stop and stop is None and v > 0.0 >= v1 else None
            edge = xi1 >= run.to if loading else xi1 <= run.to
            at = None
            turned = loading and y1 <= 0.0 < y0
            if turned:
                at = h * y0 / (y0 - y1)
                if _cubic(xi, xi1, y0, y1, at / h, h) > run.to:
                    turned = False
            if not turned and edge:
                at = _crossing(xi, xi1, y0, y1, run.to, h)
            if run.damping is not None and not loading and f1 <= 0.0 < f:
                at = min(h * f / (f - f1), at or h)
            if run.damping is not None and loading and not turned:
                peak = max(peak, f1)
            if passed is not None and (at is None or passed <= at):
                stop = time + passed
            if at is not None:
                s = at / h
                where = run.to if edge and not turned else _cubic(xi, xi1, y0, y1, s, h)
                return Passage(time + at, (where, _cubic(v, v1, a0, a1, s, h)), turned, stop, peak)
            time, xi, v, y0, f = time + h, xi1, v1, y1, f1
        raise RuntimeError(f"found no end of contact in {most_steps} steps")

    return follow(impact, advance)


def _increment(impact: Impact, run: Run, h: float, xi: float, v: float, y: float, f: float) -> tuple[float, float]:
    a = impact.load - f
    return xi + h * y + 0.5 * h * h * a, v + h * a


def _newmark_step(impact: Impact, run: Run, h: float, xi: float, v: float, y: float, f: float) -> tuple[float, float]:
    """Mean acceleration: v1 = v + h (a + a1)/2, a = p − F, and ξ1 = ξ + h (y + y1)/2. F is linear in v."""

    def ends(xi1: float) -> tuple[float, float]:
        f1, c1 = run.force(xi1), 0.0 if run.damping is None else run.damping(xi1)
        yields = 1.0 + impact.gamma * c1
        v1 = (v + 0.5 * h * (2.0 * impact.load - f - f1 / yields)) / (1.0 + 0.5 * h * c1 / yields)
        return xi1 - xi - 0.5 * h * (y + (v1 - impact.gamma * f1) / yields), v1

    xi1 = xi + h * y
    miss, v1 = ends(xi1)
    for _ in range(30):
        step = 1e-7 * (abs(xi1) + abs(h * v))
        change = miss * step / (ends(xi1 + step)[0] - miss)
        xi1 -= change
        miss, v1 = ends(xi1)
        if abs(change) <= 1e-12 * (abs(xi1) + abs(h * v)):
            break
    return xi1, v1


small_increments = partial(_marched, _increment)
"""The small-increment method: constant acceleration over each increment."""

newmark = partial(_marched, _newmark_step)
"""Newmark's method with β = 1/4 and γ = 1/2 (mean acceleration), solved by Newton's iteration in each step."""


def _cubic(a: float, b: float, slope_a: float, slope_b: float, s: float, h: float) -> float:
    """Value, at the fraction s of a step, of the cubic with these end values and slopes."""
    rise = b - a
    return a + s * (
        h * slope_a + s * (3.0 * rise - h * (2.0 * slope_a + slope_b) + s * (h * (slope_a + slope_b) - 2.0 * rise))
    )


def _crossing(a: float, b: float, slope_a: float, slope_b: float, level: float, h: float) -> float:
    """Time within the step at which the cubic between a and b passes `level`, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (_cubic(a, b, slope_a, slope_b, middle, h) - level) * (a - level) > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high) * h
