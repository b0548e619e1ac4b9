"""The methods one would use instead: conventional integrators, one impact at a time, with events.

All integrate ξ' = ν − γf, ν' = −f in the law's units, restart where a stage of the law ends and where the indentation
turns, and look for the moment at which the impactor stops on the way. They work from the law's own functions, as plain
Python functions of floats. Optional ones import their library when they are asked for.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from film_model.laws.law import AbstractLaw, Power, Stage, origin_of
from film_model.reference import unloaded, value

SUMMARY = (
    "maximum_force",
    "maximum_indentation",
    "time_of_maximum_indentation",
    "time_impactor_stops",
    "contact_duration",
    "rebound_velocity",
)
"""What a method returns, in the law's units."""

LONGEST = 1e9  # in the law's time unit: later than the end of any contact
MOST_STEPS = 200_000

Force = Callable[[float], float]


class Run(NamedTuple):
    """One way through a stage or along a branch: its force f(ξ), and the ξ it leads to.

    origin: ξ from which a root in the force is counted, where the stage or branch begins. power: the force as one, with
    its origin; None if it is no power.
    """

    force: Force
    to: float
    origin: float
    power: Power | None


@dataclass
class Impact:
    """An impact in the law's units: approach velocity ν > 0, and compliance γ of the target, 0 for a half-space."""

    stages: tuple[Stage, ...]
    nu: float
    gamma: float
    evaluations: int = field(default=0, compare=False)

    def counted(self, force: Force) -> Force:
        """The force, with every evaluation counted."""

        def count(xi: float) -> float:
            self.evaluations += 1
            return force(xi)

        return count

    def loading(self) -> list[Run]:
        """The law's stages."""
        return [Run(self.counted(scalar(s)), s.end, s.begin, _own_power(s)) for s in self.stages]

    def unloading(self, stage: int, xi: float, force: float) -> list[Run]:
        """The runs that lead back from a turn in a stage."""
        rule = self.stages[stage].unloading
        if rule is None:
            passed = self.stages[: stage + 1][::-1]
            return [Run(self.counted(scalar(s)), s.begin, s.begin, _own_power(s)) for s in passed]
        branch = unloaded(rule, self.stages[stage], xi, force)
        return [Run(self.counted(scalar(branch)), branch.begin, branch.begin, _own_power(branch))]


def _own_power(stage: Stage) -> Power | None:
    power = stage.force
    return replace(power, origin=origin_of(power, stage)) if isinstance(power, Power) else None


def scalar(stage: Stage) -> Force:
    """A stage's force as a function of a float, from its beginning on."""
    power, begin = _own_power(stage), stage.begin
    if power is None:
        return lambda xi: float(value(stage.force, max(xi, begin), stage))
    c0, c1, c2, q, origin = power.constant, power.slope, power.coefficient, power.exponent, power.origin or 0.0

    def force(xi: float) -> float:
        x = max(xi - origin, 0.0)
        return c0 + c1 * x + c2 * x**q

    return force


class Advance(Protocol):
    """Integrates one run: from (time, ξ, ν) to where ξ reaches run.to, or in loading to where the indentation turns.

    Returns time, ξ and ν there, whether it turned, and when ν passed 0 on the way (None: not, or not asked for).
    """

    def __call__(
        self, run: Run, gamma: float, time: float, state: tuple[float, float], loading: bool, watch_stop: bool
    ) -> tuple[float, tuple[float, float], bool, float | None]: ...


def follow(impact: Impact, advance: Advance) -> tuple[float, ...]:
    """The whole contact by one method: values of SUMMARY. Raises RuntimeError with the method's words when it fails."""
    time, state, turned = 0.0, (0.0, impact.nu), False
    runs = impact.loading()
    peak, stage = 0.0, -1
    for run in runs:
        stage += 1
        time, state, turned, _ = advance(run, impact.gamma, time, state, True, False)
        peak = max(peak, run.force(min(state[0], run.to)))
        if turned:
            break
    if not turned:
        raise RuntimeError("the law ends before the motion turns")
    deepest, turn = state[0], time
    stop = turn if impact.gamma == 0.0 else None
    for run in impact.unloading(stage, deepest, runs[stage].force(deepest)):
        time, state, _, passed = advance(run, impact.gamma, time, state, False, stop is None)
        stop = passed if stop is None else stop
    return peak, deepest, turn, math.nan if stop is None else stop, time, state[1]


# ---------------------------------------------------------------- adaptive methods


def solve_ivp(method: str, rtol: float, impact: Impact) -> tuple[float, ...]:
    """`scipy.integrate.solve_ivp` with its events; atol a hundredth of rtol times the size of each variable."""
    from scipy.integrate import solve_ivp as solve

    atol = _sizes(impact) * 0.01 * rtol

    def advance(run: Run, gamma: float, time: float, state: Any, loading: bool, watch_stop: bool) -> Any:
        def rates(_: float, z: Any) -> tuple[float, float]:
            f = run.force(float(z[0]))
            return float(z[1]) - gamma * f, -f

        events: list[Any] = []

        def event(function: Callable[[float, Any], float], direction: float, terminal: bool) -> None:
            made: Any = lambda t, z: function(t, z)  # noqa: E731
            made.terminal, made.direction = terminal, direction
            events.append(made)

        if loading:
            event(lambda t, z: rates(t, z)[0], -1.0, True)
        if math.isfinite(run.to):
            event(lambda t, z: float(z[0]) - run.to, 1.0 if loading else -1.0, True)
        if watch_stop:
            event(lambda t, z: float(z[1]), -1.0, False)
        found: Any = solve(rates, (time, time + LONGEST), state, method=method, rtol=rtol, atol=atol, events=events)
        if found.status != 1:
            raise RuntimeError(f"{method}: {found.message}")
        stop = float(found.t_events[-1][0]) if watch_stop and found.t_events[-1].size else None
        turned = loading and found.t_events[0].size > 0
        return float(found.t[-1]), (float(found.y[0, -1]), float(found.y[1, -1])), turned, stop

    return follow(impact, advance)


def cvode(method: str, rtol: float, impact: Impact) -> tuple[float, ...]:
    """SUNDIALS' CVODE (scikit-sundae) with its root finding. Raises ImportError without the library."""
    from sksundae.cvode import CVODE

    atol = _sizes(impact) * 0.01 * rtol

    def advance(run: Run, gamma: float, time: float, state: Any, loading: bool, watch_stop: bool) -> Any:
        def rates(_: float, z: Any, dz: Any) -> None:
            f = run.force(float(z[0]))
            dz[0], dz[1] = float(z[1]) - gamma * f, -f

        def events(_: float, z: Any, g: Any) -> None:
            g[0] = float(z[0]) - run.to if math.isfinite(run.to) else -1.0
            g[1] = float(z[1]) - gamma * run.force(float(z[0])) if loading else float(z[1])

        found_events: Any = events
        found_events.terminal = [True, loading]
        found_events.direction = [1 if loading else -1, -1]
        solver = CVODE(
            rates, rtol=rtol, atol=atol, eventsfn=events, num_events=2, method=method, max_num_steps=MOST_STEPS
        )
        found: Any = solver.solve(np.array([time, time + LONGEST]), np.array(state))
        if not found.success or found.t_events is None:
            raise RuntimeError(f"CVODE: {found.message}")
        which = found.i_events
        turned = loading and bool(which[-1][1])
        stops = [t for t, hit in zip(found.t_events, which, strict=True) if hit[1]] if watch_stop else []
        return float(found.t[-1]), tuple(map(float, found.y[-1])), turned, float(stops[0]) if stops else None

    return follow(impact, advance)


def heyoka(rtol: float, impact: Impact) -> Callable[[], tuple[float, ...]]:
    """Taylor series of high order, compiled by heyoka, in y = √(ξ − ξ_b) and dt = 2y dσ. A call runs the impact.

    Compiled here, once for each run of the impact. Raises ImportError without the library, ValueError for a force that
    is no polynomial in y.
    """
    import heyoka as hy

    y, nu, t = hy.make_vars("y", "nu", "t")
    known: dict[tuple[Any, ...], Any] = {}

    def integrator(run: Run, gamma: float, loading: bool) -> Any:
        power, to = run.power, run.to
        key = power, to, loading
        if key in known:
            return known[key]
        if power is None or (2.0 * power.exponent) % 1.0 or power.origin != run.origin:
            raise ValueError("the force is no polynomial in √ξ")
        f = hy.par[2]
        for _ in range(round(2.0 * power.exponent)):
            f = f * y
        f = f + hy.par[0] + hy.par[1] * y * y
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
        system = [(y, nu - gamma * f), (nu, -2.0 * y * f), (t, 2.0 * y)]
        known[key] = hy.taylor_adaptive(system, [0.1, 1.0, 0.0], tol=rtol, t_events=events, nt_events=other), watched
        return known[key]

    def advance(run: Run, gamma: float, time: float, state: Any, loading: bool, watch_stop: bool) -> Any:
        own, watched = integrator(run, gamma, loading)
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
        return end[2], (run.origin + end[0] ** 2, end[1]), turned, stop

    return lambda: follow(impact, advance)


def _sizes(impact: Impact) -> Any:
    """Sizes of ξ and ν in the impact, for absolute tolerances; those of Hertz's law."""
    return np.array([(1.25 * impact.nu**2) ** 0.4, impact.nu])


# ---------------------------------------------------------------- fixed steps


def small_increments(steps: int, impact: Impact) -> tuple[float, ...]:
    """The small-increment method: acceleration is constant over each of `steps` increments of about one contact."""
    return _marched(steps, impact, newmark=False)


def newmark(steps: int, impact: Impact) -> tuple[float, ...]:
    """Newmark's method with β = 1/4 and γ = 1/2 (constant mean acceleration), Newton's iteration in each step."""
    return _marched(steps, impact, newmark=True)


def _marched(steps: int, impact: Impact, newmark: bool) -> tuple[float, ...]:
    """Steps of one size; what happens within a step is found on the cubic through its ends."""
    depth, nu = _sizes(impact)
    h = 3.0 * float(depth / nu) / steps

    def advance(run: Run, gamma: float, time: float, state: Any, loading: bool, watch_stop: bool) -> Any:
        xi, v = state
        stop: float | None = None
        f = run.force(xi)
        for _ in range(MOST_STEPS):
            xi1, v1, f1 = (_newmark_step if newmark else _increment)(run.force, gamma, h, xi, v, f)
            y0, y1 = v - gamma * f, v1 - gamma * f1
            passed = _crossing(v, v1, -f, -f1, 0.0, h) if watch_stop and stop is None and v > 0.0 >= v1 else None
            edge = xi1 >= run.to if loading else xi1 <= run.to
            at = None
            turned = loading and y1 <= 0.0 < y0
            if turned:
                at = h * y0 / (y0 - y1)
                if _cubic(xi, xi1, y0, y1, at / h, h) > run.to:
                    turned = False
            if not turned and edge:
                at = _crossing(xi, xi1, y0, y1, run.to, h)
            if passed is not None and (at is None or passed <= at):
                stop = time + passed
            if at is not None:
                s = at / h
                where = run.to if not turned else _cubic(xi, xi1, y0, y1, s, h)
                return time + at, (where, _cubic(v, v1, -f, -f1, s, h)), turned, stop
            time, xi, v, f = time + h, xi1, v1, f1
        raise RuntimeError(f"no end of contact in {MOST_STEPS} steps")

    return follow(impact, advance)


def _increment(force: Force, gamma: float, h: float, xi: float, v: float, f: float) -> tuple[float, float, float]:
    xi1 = xi + h * (v - gamma * f) - 0.5 * h * h * f
    return xi1, v - h * f, force(xi1)


def _newmark_step(force: Force, gamma: float, h: float, xi: float, v: float, f: float) -> tuple[float, float, float]:
    """Mean acceleration: v1 = v − h (f + f1)/2, and ξ1 = ξ + h (y + y1)/2 with y = v − γf."""
    y = v - gamma * f
    xi1 = xi + h * y
    f1 = force(xi1)
    for _ in range(30):
        miss = xi1 - xi - 0.5 * h * (y + v - 0.5 * h * (f + f1) - gamma * f1)
        step = 1e-7 * (abs(xi1) + abs(h * v))
        slope = (force(xi1 + step) - f1) / step
        change = miss / (1.0 + 0.5 * h * (0.5 * h + gamma) * slope)
        xi1 -= change
        f1 = force(xi1)
        if abs(change) <= 1e-12 * (abs(xi1) + abs(h * v)):
            break
    return xi1, v - 0.5 * h * (f + f1), f1


def _cubic(a: float, b: float, slope_a: float, slope_b: float, s: float, h: float) -> float:
    """Value at the fraction s of the cubic with these ends and slopes."""
    rise = b - a
    return a + s * (
        h * slope_a + s * (3.0 * rise - h * (2.0 * slope_a + slope_b) + s * (h * (slope_a + slope_b) - 2.0 * rise))
    )


def _crossing(a: float, b: float, slope_a: float, slope_b: float, level: float, h: float) -> float:
    """When the cubic between a and b passes `level`."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (_cubic(a, b, slope_a, slope_b, middle, h) - level) * (a - level) > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high) * h


def impact_of(law: AbstractLaw, nu: float, gamma: float) -> Impact:
    """The impact of a law, in its units."""
    return Impact(law.stages(), nu, gamma)
