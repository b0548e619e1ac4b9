"""The integrators most people would use: scipy's `solve_ivp`, one impact at a time, with events.

State (ξ, ν), ξ' = ν − γf and ν' = −f, restarted at every stage boundary and where the indentation turns; the impactor
stops and contact ends at events of the unloading. The force is a plain Python function of floats.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.cases import Array, Case, ScalarLaw

METHODS = ("RK45", "DOP853", "LSODA", "Radau")
_LONGEST = 1e9  # in the law's time unit: later than the end of any contact


def run(case: Case, method: str, rtol: float) -> Array:
    """(impacts, 6) summaries in the law's units; NaN where the method gave up."""
    rows = [_impact(case.scalar, method, rtol, nu, gamma) for nu, gamma in zip(case.nu, case.gamma, strict=True)]
    return np.array(rows)


def _impact(law: ScalarLaw, method: str, rtol: float, nu: float, gamma: float) -> tuple[float, ...]:
    depth = (1.25 * nu * nu) ** 0.4  # only a size, for the absolute tolerance; Hertz's
    tolerance: dict[str, Any] = {"method": method, "rtol": rtol, "atol": [0.01 * rtol * depth, 0.01 * rtol * nu]}
    state, time = [0.0, nu], 0.0
    for k, (begin, end) in enumerate(zip((0.0, *law.ends), law.ends, strict=False)):
        rates = _rates(lambda xi, k=k, begin=begin: law.force(k, max(xi, begin)), gamma)
        turns = _event(lambda t, z, rates=rates: rates(t, z)[0], -1.0)
        leaves = _event(lambda t, z, end=end: z[0] - end, 1.0)
        found = _solve(rates, time, state, [turns, leaves] if end < np.inf else [turns], tolerance)
        time, state = found.t[-1], found.y[:, -1]
        if found.t_events[0].size:
            break
    xi_max, turn = float(state[0]), float(time)
    f_max = law.force(k, xi_max)
    free = law.free(k, xi_max, f_max)
    per_span = 1.0 / (xi_max - free)
    rates = _rates(lambda xi: f_max * (max(xi - free, 0.0) * per_span) ** 1.5, gamma)
    stops = _event(lambda t, z: z[1], -1.0)
    stops.terminal = False
    ends = _event(lambda t, z: z[0] - free, -1.0)
    found = _solve(rates, time, state, [ends, stops] if gamma > 0.0 else [ends], tolerance)
    if found.status != 1 or (gamma > 0.0 and not found.t_events[1].size):
        return (np.nan,) * 6
    stop = float(found.t_events[1][0]) if gamma > 0.0 else turn
    return f_max, xi_max, turn, stop, float(found.t[-1]), float(found.y[1, -1])


def _rates(force: Callable[[float], float], gamma: float) -> Callable[[float, Any], tuple[float, float]]:
    def rates(t: float, z: Any) -> tuple[float, float]:
        f = force(float(z[0]))
        return float(z[1]) - gamma * f, -f

    return rates


def _solve(rates: Any, time: float, state: Any, events: Any, tolerance: dict[str, Any]) -> Any:
    from scipy.integrate import solve_ivp

    return solve_ivp(rates, (time, _LONGEST), state, events=events, **tolerance)


def _event(function: Callable[[float, Any], float], direction: float) -> Any:
    event: Any = function
    event.terminal, event.direction = True, direction
    return event
