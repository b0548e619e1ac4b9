"""The methods one would use instead: conventional integrators, one impact at a time, with events.

All integrate ξ' = ν − γF, ν' = p − F in the law's units, F = f + c ξ', restart where a stage of the law ends and where
the indentation turns, and look for the moment at which the impactor stops on the way; with damping also for the
largest force and for its fall to 0, which ends the contact. They work from the law's own functions, as plain Python
functions of floats. Optional ones import their library when they are asked for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from film_model.laws.law import AbstractLaw, Function, Power, Stage, origin_of
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
    """One way through a stage or along a branch: its elastic force f(ξ), and the ξ it leads to.

    origin: ξ from which a root in the force is counted, where the stage or branch begins. power: the force as one, with
    its origin; None if it is no power. damping: c(ξ) of a damped law; slopes: of f and c.
    """

    force: Force
    to: float
    origin: float
    power: Power | None
    damping: Force | None = None
    slopes: tuple[Force, Force] | None = None


class Passage(NamedTuple):
    """Where a run ended, whether the indentation turned there, and when ν passed 0 on the way, if that was asked for.

    peak: largest F of a damped law on the way in.
    """

    time: float
    state: tuple[float, float]
    turned: bool
    stop: float | None = None
    peak: float = 0.0


@dataclass
class Impact:
    """An impact in the law's units: approach velocity ν > 0, compliance γ of the target (0: half-space), load p.

    damper: the factor of the law's damping.
    """

    stages: tuple[Stage, ...]
    nu: float
    gamma: float
    load: float = 0.0
    damper: float = 0.0
    evaluations: int = field(default=0, compare=False)

    def motion(self, run: Run, xi: float, nu: float) -> tuple[float, float]:
        """ξ' = (ν − γf)/(1 + γc), and F = f + c ξ'."""
        f = run.force(xi)
        if run.damping is None:
            return nu - self.gamma * f, f
        c = run.damping(xi)
        rate = (nu - self.gamma * f) / (1.0 + self.gamma * c)
        return rate, f + c * rate

    def growth(self, run: Run, xi: float, nu: float) -> float:
        """F' of a damped law; it falls to 0 where F is largest."""
        assert run.damping is not None and run.slopes is not None
        rate, force = self.motion(run, xi, nu)
        by_f, by_c = (slope(xi) * rate for slope in run.slopes)
        c = run.damping(xi)
        faster = (self.load - force - self.gamma * (by_f + by_c * rate)) / (1.0 + self.gamma * c)
        return by_f + by_c * rate + c * faster

    def largest(self, run: Run, states: Iterable[Any]) -> float:
        """Largest F at states (ξ, ν); 0 without any."""
        return max((self.motion(run, float(xi), float(nu))[1] for xi, nu in states), default=0.0)

    def counted(self, force: Force) -> Force:
        """The force, with every evaluation counted."""

        def count(xi: float) -> float:
            self.evaluations += 1
            return force(xi)

        return count

    def loading(self) -> list[Run]:
        """The law's stages."""
        return [self._along(s, s.end) for s in self.stages]

    def unloading(self, stage: int, xi: float, force: float) -> list[Run]:
        """The runs that lead back from a turn in a stage."""
        rule = self.stages[stage].unloading
        if rule is None:
            return [self._along(s, s.begin) for s in self.stages[: stage + 1][::-1]]
        branch = unloaded(rule, self.stages[stage], xi, force)
        return [self._along(branch, branch.begin)]

    def _along(self, stage: Stage, to: float) -> Run:
        run = Run(self.counted(scalar(stage.force, stage)), to, stage.begin, _own_power(stage.force, stage))
        if stage.damping is None or self.damper == 0.0:
            return run
        damping = _own_power(stage.damping, stage)
        if run.power is None or damping is None:
            raise ValueError(f"stage {stage.name!r} is damped, and not made of powers")
        damper = self.damper
        scaled = replace(damping, **{n: damper * getattr(damping, n) for n in ("constant", "slope", "coefficient")})
        return run._replace(damping=scalar(scaled, stage), slopes=(_slope(run.power), _slope(scaled)))


def _own_power(function: Function, stage: Stage) -> Power | None:
    return replace(function, origin=origin_of(function, stage)) if isinstance(function, Power) else None


def _slope(power: Power) -> Force:
    c1, c2, q, origin = power.slope, power.coefficient, power.exponent, power.origin or 0.0
    return lambda xi: c1 + (c2 * q * max(xi - origin, 1e-300) ** (q - 1.0) if c2 else 0.0)


def scalar(function: Function, stage: Stage) -> Force:
    """A function of a stage as a function of a float, from the stage's beginning on."""
    power, begin = _own_power(function, stage), stage.begin
    if power is None:
        return lambda xi: float(value(function, max(xi, begin), stage))
    c0, c1, c2, q, origin = power.constant, power.slope, power.coefficient, power.exponent, power.origin or 0.0

    def force(xi: float) -> float:
        x = max(xi - origin, 0.0)
        return c0 + c1 * x + c2 * x**q

    return force


class Advance(Protocol):
    """Integrates one run: from (time, ξ, ν) to where ξ reaches run.to, or in loading to where the indentation turns, or
    in unloading to where F of a damped law falls to 0.
    """

    def __call__(
        self, run: Run, time: float, state: tuple[float, float], loading: bool, watch_stop: bool
    ) -> Passage: ...


def follow(impact: Impact, advance: Advance) -> tuple[float, ...]:
    """The whole contact by one method: values of SUMMARY. Raises RuntimeError with the method's words when it fails."""
    at = Passage(0.0, (0.0, impact.nu), False)
    runs = impact.loading()
    peak, stage = 0.0, -1
    for run in runs:
        stage += 1
        if run.damping is not None:
            peak = impact.motion(run, *at.state)[1]
        at = advance(run, at.time, at.state, True, False)
        peak = max(peak, at.peak, run.force(min(at.state[0], run.to)))
        if at.turned:
            break
    if not at.turned:
        raise RuntimeError("the law ends before the motion turns")
    deepest, turn = at.state[0], at.time
    stop = turn if impact.gamma == 0.0 else None
    for run in impact.unloading(stage, deepest, runs[stage].force(deepest)):
        at = advance(run, at.time, at.state, False, stop is None)
        stop = at.stop if stop is None else stop
    return peak, deepest, turn, math.nan if stop is None else stop, at.time, at.state[1]


# ---------------------------------------------------------------- adaptive methods


def solve_ivp(method: str, rtol: float, impact: Impact) -> tuple[float, ...]:
    """`scipy.integrate.solve_ivp` with its events; atol a hundredth of rtol times the size of each variable."""
    from scipy.integrate import solve_ivp as solve

    atol = _sizes(impact) * 0.01 * rtol

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

    atol = _sizes(impact) * 0.01 * rtol

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
            rates, rtol=rtol, atol=atol, eventsfn=events, num_events=count, method=method, max_num_steps=MOST_STEPS
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
    """Taylor series of high order, compiled by heyoka, in y = √(ξ − ξ_b) and dt = 2y dσ. A call runs the impact.

    Compiled here, once for each run of the impact. Raises ImportError without the library, ValueError for a force that
    is no polynomial in y, and for damping.
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
            raise ValueError("damping is not written in this form")
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


def _sizes(impact: Impact) -> Any:
    """Sizes of ξ and ν in the impact, for absolute tolerances; those of Hertz's law, by the approach or by the load."""
    depth = max((1.25 * impact.nu**2) ** 0.4, (2.5 * abs(impact.load)) ** (2.0 / 3.0))
    return np.array([depth, max(impact.nu, math.sqrt(abs(impact.load) * depth))])


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

    def advance(run: Run, time: float, state: Any, loading: bool, watch_stop: bool) -> Passage:
        xi, v = state
        stop: float | None = None
        y0, f = impact.motion(run, xi, v)
        peak = 0.0
        for _ in range(MOST_STEPS):
            xi1, v1 = (_newmark_step if newmark else _increment)(impact, run, h, xi, v, y0, f)
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
        raise RuntimeError(f"no end of contact in {MOST_STEPS} steps")

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


def impact_of(law: AbstractLaw, nu: float, gamma: float, load: float = 0.0, damper: float = 0.0) -> Impact:
    """The impact of a law, in its units."""
    return Impact(law.stages(), nu, gamma, load, damper)
