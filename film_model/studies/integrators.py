"""Adaptive integrators as alternatives to FILM: scipy's solve_ivp, SUNDIALS' CVODE, heyoka's Taylor series.

Each optional library is imported by the function that uses it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from film_model.studies.impact_ode import Impact, Passage, Run, follow, sizes

LONGEST = 1e9  # in the law's time unit: later than the end of any contact


def solve_ivp(method: str, rtol: float, impact: Impact) -> tuple[float, ...]:
    """`scipy.integrate.solve_ivp` with its events; atol is rtol/100 times the size of each variable."""
    from scipy.integrate import solve_ivp as solve

    atol = sizes(impact) * 0.01 * rtol

    def advance(run: Run, time: float, state: Any, loading: bool, watch_stop: bool) -> Passage:
        def rates(_: float, z: Any) -> tuple[float, float]:
            rate, force = impact.motion(run, float(z[0]), float(z[1]))
            return rate, impact.load - force

        events: list[Any] = []

        def event(function: Callable[[float, Any], float], direction: float, terminal: bool) -> None:
            made: Any = lambda t, z: function(t, z)  # noqa: E731
            made.terminal, made.direction = terminal, direction
            events.append(made)

        if loading:
            event(lambda t, z: rates(t, z)[0], -1.0, True)
        if math.isfinite(run.to):
            event(lambda t, z: float(z[0]) - run.to, 1.0 if loading else -1.0, True)
        if run.damping is not None and not loading:
            event(lambda t, z: impact.motion(run, float(z[0]), float(z[1]))[1], -1.0, True)
        if run.damping is not None and loading:
            event(lambda t, z: impact.growth(run, float(z[0]), float(z[1])), -1.0, False)
        if watch_stop:
            event(lambda t, z: float(z[1]), -1.0, False)
        found: Any = solve(rates, (time, time + LONGEST), state, method=method, rtol=rtol, atol=atol, events=events)
        if found.status != 1:
            raise RuntimeError(f"{method}: {found.message}")
        stop = float(found.t_events[-1][0]) if watch_stop and found.t_events[-1].size else None
        turned = loading and found.t_events[0].size > 0
        peaks = found.y_events[-1] if run.damping is not None and loading else ()
        return Passage(
            float(found.t[-1]), (float(found.y[0, -1]), float(found.y[1, -1])), turned, stop, impact.largest(run, peaks)
        )

    return follow(impact, advance)


def cvode(method: str, rtol: float, impact: Impact) -> tuple[float, ...]:
    """SUNDIALS' CVODE (scikit-sundae) with its root finding. Raises ImportError without the library."""
    from sksundae.cvode import CVODE

    atol = sizes(impact) * 0.01 * rtol

    def advance(run: Run, time: float, state: Any, loading: bool, watch_stop: bool) -> Passage:
        def rates(_: float, z: Any, dz: Any) -> None:
            rate, force = impact.motion(run, float(z[0]), float(z[1]))
            dz[0], dz[1] = rate, impact.load - force

        def events(_: float, z: Any, g: Any) -> None:
            xi, nu = float(z[0]), float(z[1])
            g[0] = xi - run.to if math.isfinite(run.to) else -1.0
            g[1] = impact.motion(run, xi, nu)[0] if loading else nu
            if run.damping is not None:
                g[2] = impact.growth(run, xi, nu) if loading else impact.motion(run, xi, nu)[1]

        count = 2 if run.damping is None else 3
        found_events: Any = events
        found_events.terminal = [True, loading, not loading][:count]
        found_events.direction = [1 if loading else -1, -1, -1][:count]
        solver = CVODE(
            rates, rtol=rtol, atol=atol, eventsfn=events, num_events=count, method=method, max_num_steps=200_000
        )
        found: Any = solver.solve(np.array([time, time + LONGEST]), np.array(state))
        if not found.success or found.t_events is None:
            raise RuntimeError(f"CVODE: {found.message}")
        which = found.i_events
        turned = loading and bool(which[-1][1])
        stops = [t for t, hit in zip(found.t_events, which, strict=True) if hit[1]] if watch_stop else []
        peaks = [z for z, hit in zip(found.y_events, which, strict=True) if hit[2]] if count > 2 and loading else []
        end = float(found.y[-1][0]), float(found.y[-1][1])
        return Passage(float(found.t[-1]), end, turned, float(stops[0]) if stops else None, impact.largest(run, peaks))

    return follow(impact, advance)


def heyoka(rtol: float, impact: Impact) -> Callable[[], tuple[float, ...]]:
    """High-order Taylor series, compiled by heyoka, in y = √(ξ − ξ_b) and dt = 2y dσ; returns a function to run it.

    Each run of the impact is compiled once. Raises ImportError without the library; a call raises ValueError for
    damping and for a force that is not a polynomial in y.
    """
    import heyoka as hy

    y, nu, t = hy.make_vars("y", "nu", "t")
    known: dict[tuple[Any, ...], Any] = {}

    def integrator(run: Run, loading: bool) -> Any:
        power, to, gamma = run.power, run.to, impact.gamma
        key = power, to, loading
        if key in known:
            return known[key]
        if run.damping is not None:
            raise ValueError("damping is not supported in this form")
        if power is None or (2.0 * power.exponent) % 1.0 or power.origin != run.origin:
            raise ValueError("the force is not a polynomial in √ξ")
        f = hy.par[2]
        for _ in range(round(2.0 * power.exponent)):
            f = f * y
        f = f + hy.par[0] + (hy.par[1] + power.square * y * y) * y * y
        edge = hy.par[3]
        rising, falling = hy.event_direction.positive, hy.event_direction.negative
        events = [hy.t_event(y - edge, direction=rising if loading else falling)]
        if loading:
            events.append(hy.t_event(nu - gamma * f, direction=falling))
        watched: list[float] = []

        def passes(own: Any, at: float, _: int) -> None:
            own.update_d_output(at)
            watched.append(float(own.d_output[2]))

        other = [] if loading else [hy.nt_event(nu, passes, direction=falling)]
        system = [(y, nu - gamma * f), (nu, 2.0 * y * (impact.load - f)), (t, 2.0 * y)]
        known[key] = hy.taylor_adaptive(system, [0.1, 1.0, 0.0], tol=rtol, t_events=events, nt_events=other), watched
        return known[key]

    def advance(run: Run, time: float, state: Any, loading: bool, watch_stop: bool) -> Passage:
        own, watched = integrator(run, loading)
        power = run.power
        assert power is not None
        own.pars[:3] = [power.constant, power.slope, power.coefficient]
        own.pars[3] = math.sqrt(run.to - run.origin) if loading and math.isfinite(run.to) else 1e6 if loading else 0.0
        own.time = 0.0
        own.state[:] = [math.sqrt(max(state[0] - run.origin, 0.0)), state[1], time]
        own.reset_cooldowns()
        watched.clear()
        outcome = own.propagate_until(LONGEST)[0]
        if outcome not in (hy.taylor_outcome(-1), hy.taylor_outcome(-2)):
            raise RuntimeError(f"heyoka: {outcome}")
        turned = loading and outcome == hy.taylor_outcome(-2)
        stop = watched[0] if watched and watch_stop else None
        end = float(own.state[0]), float(own.state[1]), float(own.state[2])
        return Passage(end[2], (run.origin + end[0] ** 2, end[1]), turned, stop)

    return lambda: follow(impact, advance)
