"""Impacts under an engine's contact law: m δ'' = −F(δ, δ'), by the classical Runge–Kutta method, all impacts at once.

Fixed steps in units of the elastic contact time, which is estimated for each impact; the first steps are graded,
because some damping forces grow as δ^(1/4). Contact ends where the force falls to 0, or where the depth does if the
engine keeps attractive forces; the instant is found on the cubic Hermite interpolation of the last step. Relative
errors of force, duration and restitution are below 3e-4 (tests/test_translate.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from film_model.base.arrays import Array
from film_model.translate.law import EngineLaw, Pair, Values

STEPS = 64
"""Steps in the estimated contact time."""

_GRADED = np.diff(np.linspace(0.0, 1.0, 13) ** 3)
"""Parts of the first step of the march."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Impacts:
    """Summaries of impacts, SI: one value per impact. times, depths, forces: their histories, rows are instants."""

    force: Array
    duration: Array
    restitution: Array
    depth: Array
    times: Array
    depths: Array
    forces: Array


def march(law: EngineLaw, pair: Pair, values: Values, velocities: Array) -> Impacts:
    """Impacts at the velocities [m/s]; values are numbers, or arrays of that length."""
    speed = np.asarray(velocities, dtype=np.float64)

    def force(depth: Any, rate: Any) -> Any:
        return law.force(pair, values, np.maximum(depth, 0.0), rate)

    clock = 3.0 * _elastic_depth(force, pair.mass, speed, pair.depth) / speed
    # one that has not ended after six estimated contact times has restitution 0
    steps = np.concatenate([_GRADED, np.ones(int(6.0 * STEPS) - 1)]) / STEPS
    depth, rate, time = np.zeros_like(speed), speed.copy(), np.zeros_like(speed)
    pull = force(depth, rate)
    rows = [(time, depth, rate, pull)]
    over = np.zeros(speed.shape, dtype=bool)
    for part in steps:
        depth, rate = _runge_kutta(force, pair.mass, depth, rate, pull, part * clock)
        time, pull = time + part * clock, force(depth, rate)
        rows.append((time, depth, rate, pull))
        over |= (depth <= 0.0) | ((pull <= 0.0) & (not law.pulls))
        if over.all():
            break
    return _summary(law, force, pair.mass, speed, [np.array(column) for column in zip(*rows, strict=True)])


def _elastic_depth(force: Any, mass: float, speed: Array, start: float) -> Array:
    """The depth at which the law at rest stores the impact energy, to about 10 %: only a step size depends on it."""
    nodes, weights = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
    energy, depth = 0.5 * mass * speed**2, np.full_like(speed, start)
    for _ in range(40):
        stored = sum(w * force(n * depth, np.zeros_like(speed)) for n, w in zip(nodes, weights, strict=True)) * depth
        ratio = np.clip(energy / np.maximum(stored, 1e-300), 1e-12, 1e12)
        depth = depth * ratio**0.4  # exact for F ∝ δ^1.5
        if np.abs(np.log(ratio)).max() < 0.1:
            break
    return depth


def _runge_kutta(force: Any, mass: float, depth: Any, rate: Any, pull: Any, h: Any) -> tuple[Any, Any]:
    """One step of size h; pull: the force at its start."""
    a1 = -pull / mass
    v2 = rate + 0.5 * h * a1
    a2 = -force(depth + 0.5 * h * rate, v2) / mass
    v3 = rate + 0.5 * h * a2
    a3 = -force(depth + 0.5 * h * v2, v3) / mass
    v4 = rate + h * a3
    a4 = -force(depth + h * v3, v4) / mass
    return depth + h / 6.0 * (rate + 2.0 * (v2 + v3) + v4), rate + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)


def _summary(law: EngineLaw, force: Any, mass: float, speed: Array, columns: list[Array]) -> Impacts:
    """Largest force and depth, and the end of contact."""
    times, depths, _, forces = columns
    ended = depths <= 0.0
    if not law.pulls:
        ended |= forces <= 0.0
    ended[0] = False
    last = np.where(ended.any(axis=0), ended.argmax(axis=0), len(times) - 1)
    each = np.arange(speed.size)
    before = np.maximum(last - 1, 0)
    ends = [[column[row, each] for column in columns] for row in (before, last)]
    end, final = _end_of_contact(law, force, mass, ends)
    separated = ended.any(axis=0)
    inside = np.arange(len(times))[:, None] < last
    return Impacts(
        force=_peak(np.where(inside, forces, 0.0)),
        duration=np.where(separated, end, times[last, each]),
        restitution=np.where(separated, np.maximum(-final, 0.0) / speed, 0.0),
        depth=_peak(np.where(inside, depths, 0.0)),
        times=times,
        depths=np.where(inside, depths, 0.0),
        forces=np.where(inside, forces, 0.0),
    )


def _end_of_contact(law: EngineLaw, force: Any, mass: float, ends: list[list[Array]]) -> tuple[Array, Array]:
    """Time and rate at the end of contact within a step, by bisection of its cubic Hermite interpolation."""
    (t0, x0, v0, f0), (t1, x1, v1, f1) = ends
    h = t1 - t0

    def state(s: Any) -> tuple[Any, Any]:
        a, b, c, d = (1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2, s * s * (3 - 2 * s), s * s * (s - 1)
        return a * x0 + h * b * v0 + c * x1 + h * d * v1, a * v0 - h * b * f0 / mass + c * v1 - h * d * f1 / mass

    low, high = np.zeros_like(t0), np.ones_like(t0)
    for _ in range(26):
        middle = 0.5 * (low + high)
        depth, rate = state(middle)
        out = depth <= 0.0
        if not law.pulls:
            out |= force(depth, rate) <= 0.0
        low, high = np.where(out, low, middle), np.where(out, middle, high)
    return t0 + high * h, state(high)[1]


def _peak(rows: Array) -> Array:
    """The largest value of each column, from the parabola through the largest and its neighbours."""
    top = rows.argmax(axis=0)
    each = np.arange(rows.shape[1])
    inner = (top > len(_GRADED) + 1) & (top < len(rows) - 1)  # equal steps on both sides
    at = np.clip(top, 1, len(rows) - 2)
    a, b, c = rows[at - 1, each], rows[at, each], rows[at + 1, each]
    curve = a - 2.0 * b + c
    with np.errstate(divide="ignore", invalid="ignore"):
        bent = b - (a - c) ** 2 / (8.0 * curve)
    return np.where(inner & (curve < 0.0), bent, rows[top, each])
