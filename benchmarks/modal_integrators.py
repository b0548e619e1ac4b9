"""Integrators of contact on modes to compare the core with: Newmark's method, and Dormand and Prince's by numba.

Both follow one contact under Hertz's law, in the units of the march; frequency, share and rest as in
`film_model.studies.modal_reference`. They return the maximum force and the time at which contact ends.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

NEWTON_STEPS = 20

_NODES = np.array(
    [
        [0.0] * 6,
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_ERROR = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


def newmark(approach: float, frequency: Any, share: Any, rest: float, end: float, steps: int) -> tuple[float, float]:
    """Average acceleration, fixed steps."""
    h, (w, u, a) = end / steps, (np.zeros_like(frequency) for _ in range(3))
    x, v, force, most, stiff = 0.0, approach, 0.0, 0.0, 1.0 / (1.0 + 0.25 * h**2 * frequency**2)
    soft = 0.25 * h * h * (1.0 + float(np.sum(share * stiff))) + rest
    for k in range(steps):
        guess = w + h * u + 0.25 * h * h * a
        ahead = x + h * v - 0.25 * h * h * force - float(np.sum(guess * stiff))
        depth = max(ahead, 0.0)
        for _ in range(NEWTON_STEPS if ahead > 0.0 else 0):
            depth = max(depth - (depth + soft * depth**1.5 - ahead) / (1.0 + 1.5 * soft * depth**0.5), 0.25 * depth)
        new = depth**1.5
        w = (guess + 0.25 * h * h * share * new) * stiff
        next_a = share * new - frequency**2 * w
        u, a = u + 0.5 * h * (a + next_a), next_a
        x, v, force, most = x + h * v - 0.25 * h * h * (force + new), v - 0.5 * h * (force + new), new, max(most, new)
        if new == 0.0 and k > 10:
            return most, (k + 1) * h
    return most, end


def dormand_prince(approach: float, frequency: Any, share: Any, rest: float, tolerance: float) -> tuple[float, float]:
    """Order 5(4), adaptive; ImportError without numba."""
    return _compiled()(approach, frequency, share, rest, tolerance, _NODES, _ERROR)


@cache
def _compiled() -> Any:
    import numba

    @numba.njit(fastmath=True)
    def force_of(depth: float, rest: float) -> float:
        xi = max(depth, 0.0)
        for _ in range(NEWTON_STEPS):
            step = (xi + rest * xi**1.5 - depth) / (1.0 + 1.5 * rest * xi**0.5)
            if depth <= 0.0 or abs(step) <= 1e-15 * depth:
                break
            xi = max(xi - step, 0.25 * xi)
        return xi**1.5 if depth > 0.0 else 0.0

    @numba.njit(fastmath=True)
    def slopes(y: Any, frequency: Any, share: Any, rest: float, to: Any) -> float:
        n, depth = frequency.size, y[0]
        for i in range(n):
            depth -= y[2 + i]
        force = force_of(depth, rest)
        to[0], to[1] = y[1], -force
        for i in range(n):
            to[2 + i] = y[2 + n + i]
            to[2 + n + i] = share[i] * force - frequency[i] ** 2 * y[2 + i]
        return depth

    @numba.njit(fastmath=True)
    def run(
        approach: float, frequency: Any, share: Any, rest: float, tolerance: float, nodes: Any, weights: Any
    ) -> tuple[float, float]:
        size = 2 + 2 * frequency.size
        y, trial, k = np.zeros(size), np.zeros(size), np.zeros((7, size))
        y[1] = approach
        t, h, most = 0.0, 1e-4, 0.0
        slopes(y, frequency, share, rest, k[0])
        while True:
            depth = 0.0
            for stage in range(1, 7):
                for i in range(size):
                    total = 0.0
                    for j in range(stage):
                        total += nodes[stage, j] * k[j, i]
                    trial[i] = y[i] + h * total
                depth = slopes(trial, frequency, share, rest, k[stage])
            error = 0.0
            for i in range(size):
                off = 0.0
                for j in range(7):
                    off += weights[j] * k[j, i]
                error += (h * off / tolerance) ** 2
            error = (error / 2) ** 0.5
            if error > 1.0 or (depth < 0.0 and h > 1e-9):
                h *= 0.5 if depth < 0.0 else max(0.9 * error**-0.2, 0.2)
                continue
            t += h
            y[:], k[0, :] = trial, k[6]
            most = max(most, -k[0, 1])
            if depth < 0.0:
                return most, t
            h *= min(0.9 * max(error, 1e-6) ** -0.2, 5.0)

    return run
