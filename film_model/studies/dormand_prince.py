# pyright: basic, reportCallIssue=false
"""A fast conventional integrator: Dormand–Prince 5(4), compiled by numba, with events located to its own order.

PI step control, first-same-as-last, restarts at every stage boundary, at the maximum indentation and where the
impactor stops. An event is located on the dense output, reached by a separate step and corrected by Newton's method,
so that it does not reduce the accuracy. Two forms of the equations:

    "time":  ξ' = ν − γf, ν' = p − f
    "root":  y = √(ξ − ξ_b) and dt = 2y dσ:  y' = ν − γf, ν' = 2y(p − f), t' = 2y   (ξ_b: where the stage begins, or the
             unloading branch ends); a 3/2-power force is smooth in y, which allows larger steps
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import FunctionType
from typing import Any

import numpy as np
from scipy.integrate import RK45

from film_model.laws.law import AbstractLaw, Power, Stage, origin_of

_, (A21, *_), (A31, A32, *_), (A41, A42, A43, *_), (A51, A52, A53, A54, _), (A61, A62, A63, A64, A65) = RK45.A.tolist()
B1, _, B3, B4, B5, B6 = RK45.B.tolist()
E1, _, E3, E4, E5, E6, E7 = RK45.E.tolist()
# Hairer, Nørsett & Wanner, Solving ODEs I, the dense output of DOPRI5
D = (
    *(-12715105075 / 11282082432, 0.0, 87487479700 / 32700410799, -10690763975 / 1880347072),
    *(701980252875 / 199316789632, -1453857185 / 822651844, 69997945 / 29380423),
)

EXPONENT, SAFETY = 0.2 - 0.75 * 0.04, 0.9  # PI control as in DOPRI5
LOWEST_ERROR = math.log(1e-4)
GROWS, TURNS, OPENS, STOPS = range(4)  # events: ξ reaches the end of a stage; ν − γf = 0; ξ = ξ_f; ν = 0


@dataclass(frozen=True)
class ScalarLaw:
    """A law as functions of floats that numba can compile.

    ends: of the stages, in ξ. force(k, ξ): of stage k in loading. free(k, ξ_m, f_m): where the unloading branch
    f = f_m ((ξ − ξ_f)/(ξ_m − ξ_f))^1.5 of a contact that turned in stage k ends.
    """

    ends: tuple[float, ...]
    force: Callable[[int, float], float]
    free: Callable[[int, float, float], float]


def scalar_law(law: AbstractLaw) -> ScalarLaw:
    """A law for :func:`compile_solver`; its functions are compiled by numba.

    Raises ImportError without numba, ValueError for a law that does not unload along a 3/2 power, is damped, or has a
    force that is not a plain function.
    """
    import numba

    if law.damped:
        raise ValueError("damping is not supported in this form")
    chain_force, chain_free = None, None
    stages = law.stages()
    for k, stage in reversed(list(enumerate(stages))):
        chain_force = _chained(numba, k, _one(numba, stage, stage.force), chain_force)
        chain_free = _freed(numba, k, stage, chain_free, k == 0)
    assert chain_force is not None and chain_free is not None
    return ScalarLaw(tuple(stage.end for stage in stages), chain_force, chain_free)


def _one(numba: Any, stage: Stage, function: Any) -> Any:
    """A function of a stage, compiled, of one float."""
    if not isinstance(function, Power):
        if not isinstance(function, FunctionType):
            raise ValueError(f"stage {stage.name!r} is not a function that numba compiles")
        return numba.njit(function)
    c0, c1, square, c2, q = (getattr(function, n) for n in ("constant", "slope", "square", "coefficient", "exponent"))
    origin = origin_of(function, stage)
    if c2 == square == 0.0:
        return numba.njit(lambda x: c0 + c1 * (x - origin))
    if q == 1.5 and square == 0.0:
        return numba.njit(
            lambda x: c0 + c1 * (x - origin) + c2 * max(x - origin, 0.0) * math.sqrt(max(x - origin, 0.0))
        )
    return numba.njit(lambda x: c0 + (c1 + square * (x - origin)) * (x - origin) + c2 * max(x - origin, 0.0) ** q)


def _chained(numba: Any, k: int, own: Any, others: Any) -> Any:
    if others is None:
        return numba.njit(lambda j, x: own(x))
    return numba.njit(lambda j, x: own(x) if j == k else others(j, x))


def _freed(numba: Any, k: int, stage: Stage, others: Any, first: bool) -> Any:
    rule = stage.unloading
    if rule is None:
        force = stage.force
        if not (first and isinstance(force, Power) and force.exponent == 1.5 and force.constant == force.slope == 0.0):
            raise ValueError(f"stage {stage.name!r} does not unload along a 3/2 power")
        own = numba.njit(lambda x, f: 0.0)
    elif rule.exponent != 1.5:
        raise ValueError(f"stage {stage.name!r} does not unload along a 3/2 power")
    elif rule.residual is not None:
        residual = _one(numba, stage, rule.residual)
        own = numba.njit(lambda x, f: residual(x))
    else:
        ratio = _one(numba, stage, rule.radius_ratio)
        own = numba.njit(lambda x, f: x - (f / math.sqrt(ratio(x))) ** (2.0 / 3.0))
    if others is None:
        return numba.njit(lambda j, x, f: own(x, f))
    return numba.njit(lambda j, x, f: own(x, f) if j == k else others(j, x, f))


def compile_solver(law: ScalarLaw, form: str, load: float = 0.0) -> Any:
    """Compile run(nu, gamma, rtol, floor, out): fills out (impacts, 6) with `INTEGRATED_VALUES` under a load.

    All values are in the law's units. The error of a variable z is compared with rtol (|z| + floor z_0), z_0 being its
    size in the impact. run returns the number of force evaluations of all impacts.
    """
    import numba

    inline = numba.njit(fastmath=True, inline="always", error_model="numpy")
    compiled = numba.njit(fastmath=True, error_model="numpy")
    root = form == "root"
    loading, free = (f if hasattr(f, "py_func") else inline(f) for f in (law.force, law.free))
    rates = inline(_rates(loading, root, load))
    dense = inline(_dense)
    parts = (
        rates,
        inline(_step(rates, root)),
        dense,
        inline(_locate(dense)),
        inline(_squared_error(root)),
        inline(_event),
        inline(_correct(rates, 0.0 if root else load)),  # dν where contact ends
    )
    impact = compiled(_impact(parts, np.array(law.ends), loading, free, root))

    @compiled
    def run(nu, gammas, rtol, floor, out):
        evaluations = 0
        for i in range(nu.size):
            evaluations += impact(nu[i], gammas[i], rtol, floor, out[i])
        return evaluations

    return run


def _rates(loading, root, load):
    def rates(branch, k, origin, f_max, per_span, gamma, z0, z1):
        """Derivatives of (y or ξ − ξ_b, ν, t)."""
        x = z0 * z0 if root else max(z0, 0.0)
        if branch:
            u = x * per_span
            f = f_max * u * math.sqrt(u)
        else:
            f = loading(k, origin + x)
        if root:
            return z1 - gamma * f, 2.0 * z0 * (load - f), 2.0 * z0
        return z1 - gamma * f, load - f, 1.0

    return rates


def _step(rates, root):
    def step(branch, k, origin, f_max, per_span, gamma, h, x, v, t, p1, q1, r1):
        """One step: the new state and rates, the errors, and the coefficients of the dense output."""
        p2, q2, _ = rates(branch, k, origin, f_max, per_span, gamma, x + h * A21 * p1, v + h * A21 * q1)
        p3, q3, r3 = rates(
            branch, k, origin, f_max, per_span, gamma, x + h * (A31 * p1 + A32 * p2), v + h * (A31 * q1 + A32 * q2)
        )
        p4, q4, r4 = rates(
            branch, k, origin, f_max, per_span, gamma,
            x + h * (A41 * p1 + A42 * p2 + A43 * p3), v + h * (A41 * q1 + A42 * q2 + A43 * q3),
        )  # fmt: skip
        p5, q5, r5 = rates(
            branch, k, origin, f_max, per_span, gamma,
            x + h * (A51 * p1 + A52 * p2 + A53 * p3 + A54 * p4), v + h * (A51 * q1 + A52 * q2 + A53 * q3 + A54 * q4),
        )  # fmt: skip
        p6, q6, r6 = rates(
            branch, k, origin, f_max, per_span, gamma,
            x + h * (A61 * p1 + A62 * p2 + A63 * p3 + A64 * p4 + A65 * p5),
            v + h * (A61 * q1 + A62 * q2 + A63 * q3 + A64 * q4 + A65 * q5),
        )  # fmt: skip
        x1 = x + h * (B1 * p1 + B3 * p3 + B4 * p4 + B5 * p5 + B6 * p6)
        v1 = v + h * (B1 * q1 + B3 * q3 + B4 * q4 + B5 * q5 + B6 * q6)
        t1 = t + h * (B1 * r1 + B3 * r3 + B4 * r4 + B5 * r5 + B6 * r6)
        p7, q7, r7 = rates(branch, k, origin, f_max, per_span, gamma, x1, v1)
        ex = h * (E1 * p1 + E3 * p3 + E4 * p4 + E5 * p5 + E6 * p6 + E7 * p7)
        ev = h * (E1 * q1 + E3 * q3 + E4 * q4 + E5 * q5 + E6 * q6 + E7 * q7)
        et = h * (E1 * r1 + E3 * r3 + E4 * r4 + E5 * r5 + E6 * r6 + E7 * r7) if root else 0.0
        dx = h * (D[0] * p1 + D[2] * p3 + D[3] * p4 + D[4] * p5 + D[5] * p6 + D[6] * p7)
        dv = h * (D[0] * q1 + D[2] * q3 + D[3] * q4 + D[4] * q5 + D[5] * q6 + D[6] * q7)
        return x1, v1, t1, p7, q7, r7, ex, ev, et, dx, dv

    return step


def _dense(s, h, z0, z1, k0, k1, d):
    """Value, and derivative in s, of the fourth-order interpolant at the fraction s of a step."""
    c1 = z1 - z0
    c2 = h * k0 - c1
    c3 = c1 - h * k1 - c2
    w = 1.0 - s
    inner = c3 + w * d
    middle = c2 + s * inner
    slope = c1 + (1.0 - 2.0 * s) * middle + s * w * (inner - s * d)
    return z0 + s * (c1 + w * middle), slope


def _locate(dense):
    def locate(kind, target, high, h, x, v, x1, v1, p, p1, q, q1, dx, dv):
        """Fraction of the step, below `high`, at which the event happens: false position on the dense output."""
        low, s = 0.0, 0.5
        if kind == TURNS:
            g_low, g_high = p * h, p1 * h
        elif kind == STOPS:
            g_low, g_high = v, v1
        else:
            g_low, g_high = x - target, dense(high, h, x, x1, p, p1, dx)[0] - target
        for _ in range(7):
            s = low + (high - low) * g_low / (g_low - g_high)
            if kind == TURNS:
                _, g = dense(s, h, x, x1, p, p1, dx)
            elif kind == STOPS:
                g, _ = dense(s, h, v, v1, q, q1, dv)
            else:
                g, _ = dense(s, h, x, x1, p, p1, dx)
                g -= target
            if g * g_low > 0.0:
                low, g_low, g_high = s, g, 0.5 * g_high  # the Illinois rule
            else:
                high, g_high, g_low = s, g, 0.5 * g_low
        return s

    return locate


def _squared_error(root):
    def squared_error(rtol, x, v, t, x1, v1, t1, ex, ev, et, x_floor, v_floor, t_floor):
        """Mean square of the errors of a step over their tolerances."""
        ex /= rtol * (max(abs(x), abs(x1)) + x_floor)
        ev /= rtol * (max(abs(v), abs(v1)) + v_floor)
        et /= rtol * (max(t, t1) + t_floor)
        return (ex * ex + ev * ev + et * et) * (1.0 / 3.0 if root else 0.5)

    return squared_error


def _event(branch, stopped, x1, v1, p1, target):
    """The event within a step that ends at x1, v1 with the rate p1 of x; -1 if there is none."""
    kind = -1
    if branch:
        if not stopped and v1 <= 0.0:
            kind = STOPS
        elif x1 <= 0.0:
            kind = OPENS
    elif p1 <= 0.0:
        kind = TURNS
    elif x1 >= target:
        kind = GROWS
    return kind


def _correct(rates, lift):
    def correct(kind, goal, branch, k, origin, f_max, per_span, gamma, x, v, t, p, q, r):
        """Newton's method from a state near an event: the state and the rates at the event."""
        for _ in range(2 if kind == GROWS else 1):
            if kind == TURNS:
                miss = -p / q
            elif kind == STOPS:
                miss = -v / q
            else:
                miss = (goal - x) / p
            x, v, t = x + miss * p, v + miss * (q if kind != OPENS else lift), t + miss * r
            p, q, r = rates(branch, k, origin, f_max, per_span, gamma, x, v)
        return x, v, t, p, q, r

    return correct


def _impact(parts, ends, loading, free, root):
    rates, step, dense, locate, squared_error, event, correct = parts

    def impact(v, gamma, rtol, floor, out):
        """One impact: fills the row `out`, returns the number of force evaluations."""
        depth = (1.25 * v * v) ** 0.4  # a size only: that of Hertz's law
        size = math.sqrt(depth) if root else depth
        x_floor, v_floor, t_floor = floor * size, floor * v, floor * depth / v
        x, t, k, origin, f_max, per_span = 0.0, 0.0, 0, 0.0, 0.0, 0.0
        branch, stopped = False, gamma == 0.0
        target = math.sqrt(ends[0]) if root else ends[0]
        h, last_error = 0.6 * rtol**0.2 * size / v, LOWEST_ERROR  # a rejected step costs more than a small first step
        p, q, r = rates(branch, k, origin, f_max, per_span, gamma, x, v)
        evaluations = 0
        for _ in range(1_000_000):
            x1, v1, t1, p1, q1, r1, ex, ev, et, dx, dv = step(
                branch, k, origin, f_max, per_span, gamma, h, x, v, t, p, q, r
            )
            evaluations += 6
            square = squared_error(rtol, x, v, t, x1, v1, t1, ex, ev, et, x_floor, v_floor, t_floor)
            error = 0.5 * math.log(square + 1e-30)  # powers of the error as one logarithm and one exponential
            if not square <= 1.0:
                h *= max(0.2, SAFETY * math.exp(-EXPONENT * error)) if square < 1e300 else 0.1
                continue
            grown = h * min(5.0, SAFETY * math.exp(0.04 * last_error - EXPONENT * error))
            last_error = max(error, LOWEST_ERROR)
            kind = event(branch, stopped, x1, v1, p1, target)
            if kind < 0:
                x, v, t, p, q, r, h = x1, v1, t1, p1, q1, r1, grown
                continue
            goal = 0.0 if branch else target
            s = locate(kind, goal, 1.0, h, x, v, x1, v1, p, p1, q, q1, dx, dv)
            if kind == TURNS and dense(s, h, x, x1, p, p1, dx)[0] > target:
                kind = GROWS  # the stage ends before the turn
                s = locate(kind, goal, s, h, x, v, x1, v1, p, p1, q, q1, dx, dv)
            x, v, t, p, q, r, _, _, _, _, _ = step(branch, k, origin, f_max, per_span, gamma, s * h, x, v, t, p, q, r)
            x, v, t, p, q, r = correct(kind, goal, branch, k, origin, f_max, per_span, gamma, x, v, t, p, q, r)
            evaluations += 8 if kind == GROWS else 7
            h = grown
            if kind == OPENS:
                out[4], out[5] = t, v
                break
            if kind == STOPS:
                stopped, out[3] = True, t
                continue
            xi = origin + (x * x if root else x)
            if kind == GROWS:
                xi, origin, k = ends[k], ends[k], k + 1
                target = math.sqrt(ends[k] - origin) if root else ends[k] - origin
            else:
                f_max = loading(k, xi)
                origin = free(k, xi, f_max)
                per_span, branch = 1.0 / (xi - origin), True
                out[0], out[1], out[2], out[3] = f_max, xi, t, t
            x = math.sqrt(xi - origin) if root else xi - origin
            p, q, r = rates(branch, k, origin, f_max, per_span, gamma, x, v)
            evaluations += 1
        return evaluations

    return impact
