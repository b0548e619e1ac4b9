"""Friction of elastic impacts: cost of an impact by our ways and by Dormand–Prince 5(4) on springs that slip.

`python -m benchmarks.oblique [COUNT]`. The competitor integrates the same equations (docs/method.md, section 15) in
numba: z'' = −f, D'' = −2χ Σ w u, with springs at evenly spaced depths s and |u| ≤ z − s, clipped in every stage. For
each error the fastest of its numbers of springs and tolerances that meets it in all impacts is compared.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from film_model.core import friction as core

COUNT = 200
CHI = 1.4411764705882353
"""Of a solid ball, ν = 0.3."""

LAST = 4.0 * CHI - 1.0
REGIMES = {"sticks first": (0.05, 1.0), "slides first": (1.0, LAST), "slides throughout": (LAST, 8.0)}
"""ψ₁ of the impacts."""

TARGETS = (1e-2, 3e-3, 1e-3)
"""Largest error of ψ₂ over ψ₁."""

SPRINGS = (8, 16, 32, 64, 128, 256, 512, 1024, 2048)
TOLERANCES = tuple(10.0 ** -np.arange(2.0, 9.0))

NODES = ((), (1 / 5,), (3 / 40, 9 / 40), (44 / 45, -56 / 15, 32 / 9))
NODES += ((19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),)
NODES += ((9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),)
NODES += ((35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),)
ERRORS = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
"""Dormand & Prince (1980): stages, and the difference of both orders."""


def compile_solver() -> Any:
    """run(before, chi, springs, tolerance, after): fills `after` with ψ₂."""
    import numba

    a = np.zeros((7, 7))
    for stage, row in enumerate(NODES):
        a[stage, : len(row)] = row
    e = np.array(ERRORS)

    @numba.njit
    def deflection(u, s, begun, z, d):
        """At z and d, of a spring at the depth s that had u; one that the step reaches moves along for its part."""
        part = 1.0 if s <= begun[0] else (z - s) / (z - begun[0])
        return min(max(u + part * (d - begun[2]), s - z), z - s)

    @numba.njit
    def rates(y, u, weights, begun, chi, out):
        z, q, n = max(y[0], 0.0), 0.0, u.size
        for j in range(min(int(z * n + 0.5), n)):
            q += weights[j] * deflection(u[j], (j + 0.5) / n, begun, z, y[2])
        out[0], out[1], out[2], out[3] = y[1], -1.25 * z * np.sqrt(z), y[3], -2.0 * chi * q

    @numba.njit
    def one(before, chi, n, tolerance):
        weights, u = np.empty(n), np.zeros(n)
        for j in range(n):
            weights[j] = 1.875 * (np.sqrt((j + 1.0) / n) - np.sqrt(j / n))
        y, at, k, h = np.array([0.0, 1.0, 0.0, before]), np.empty(4), np.empty((7, 4)), 1e-3
        while y[0] > 0.0 or y[1] > 0.0:
            for stage in range(7):
                for i in range(4):
                    at[i] = y[i]
                    for j in range(stage):
                        at[i] += h * a[stage, j] * k[j, i]
                rates(at, u, weights, y, chi, k[stage])
            worst = 1e-10
            for i in range(4):
                off = 0.0
                for j in range(7):
                    off += h * e[j] * k[j, i]
                worst = max(worst, abs(off) / tolerance)
            if worst <= 1.0:
                for j in range(n):
                    s = (j + 0.5) / n
                    u[j] = deflection(u[j], s, y, at[0], at[2]) if s < at[0] else 0.0
                y[:] = at
            h *= min(5.0, max(0.2, 0.9 * worst**-0.2))
        return y[3]

    @numba.njit
    def run(before, chi, n, tolerance, after):
        for i in range(before.size):
            after[i] = one(before[i], chi, n, tolerance)

    return run


def fastest(call: Callable[[], object], repeats: int = 3) -> float:
    """Seconds of the fastest call."""
    seconds = []
    for _ in range(repeats):
        begin = time.process_time()
        call()
        seconds.append(time.process_time() - begin)
    return min(seconds)


def ours(before: np.ndarray) -> dict[str, float]:
    """Microseconds an impact by the exact solver and by the table."""
    normal, rate = of_hertz(before.size), np.full(before.size, 2.0 * CHI)
    ways = {"exact": core.EXACT, "table": core.COARSE}
    return {
        name: 1e6 * fastest(lambda t=table: core.many(normal, rate, before, t)) / before.size
        for name, table in ways.items()
    }


def of_hertz(count: int) -> Any:
    """Normal motions under Hertz's law, with 1 for depth and approach."""
    normal: Any = np.zeros(count, core.NORMAL_DTYPE)
    normal["coefficient"], normal["exponent"], normal["approach"] = 1.25, 1.5, 1.0
    return normal


def main(count: int = COUNT) -> dict[str, dict[str, float]]:
    """Print the table; returns microseconds an impact, by regime and way."""
    run, found = compile_solver(), dict[str, dict[str, float]]()
    print("regime              error  Dormand-Prince  springs     exact  ratio    table  ratio")
    for regime, (low, high) in REGIMES.items():
        before = np.random.default_rng(1).uniform(low, high, count)
        exact = core.many(of_hertz(count), np.full(count, 2.0 * CHI), before)["velocity"]
        own = found[regime] = ours(before)
        for target in TARGETS:
            cost, springs = competitor(run, before, exact, target)
            ratios = (f"{value:8.2f} {cost / value:6.0f}" for value in own.values())
            print(f"{regime:18} {target:6.0e} {cost:12.1f} us {springs:8} {' '.join(ratios)}")
            found[regime] = found[regime] | {f"{target:g}": cost}
    return found


def competitor(run: Any, before: np.ndarray, exact: np.ndarray, target: float) -> tuple[float, int]:
    """Microseconds an impact and springs of the fastest setting that meets an error; nan and 0 if none does."""
    after, fitting = np.empty(before.size), []
    for springs in SPRINGS:
        for tolerance in TOLERANCES:
            seconds = fastest(lambda s=springs, t=tolerance: run(before, CHI, s, t, after), 1)
            if (np.abs(after - exact) <= target * before).all():
                fitting.append((seconds, springs, tolerance))
        if fitting:
            break
    if not fitting:
        return np.nan, 0
    _, springs, tolerance = min(fitting)
    return 1e6 * fastest(lambda: run(before, CHI, springs, tolerance, after)) / before.size, springs


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
