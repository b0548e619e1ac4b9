"""Impacts on targets with edges: the contact law on a structure's natural vibrations, by a conventional integrator.

In the units of the march, ẍ = p − f and ẅ_n + ω_n² w_n = r_n f with r_n = m φ_n²/M_n. The indentation is x − Σ w_n less
the deflection of the modes that are left out, which follow a force statically and have the rest c f of the static
deflection: the law is in series with a spring of compliance c. Errors then fall with the square of the number of modes
or faster; without it they fall with the number itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.accuracy import difference
from film_model.core import native
from film_model.curve import curve_of
from film_model.errors import Outcome, SimulationError
from film_model.problem import Problem
from film_model.targets import Modes

Array = NDArray[np.float64]

MOST_WORK = 300_000_000
"""Evaluations of the force, each counted as the modes and 400 more, that a run may take: some ten seconds."""

MOST_EVENTS = 10_000
LONGEST = 3.0
"""A contact is left after this many times the quasi-static contact's duration and the slowest period together."""

MODES_FACTOR = 1.0
"""Bound on the error of a run over its difference to one with half the highest frequency: it may be small by chance."""

_FIRST_PHASE = 24.0  # highest frequency of the first run times the time from touch to the deepest point
_INTEGRATION = 1e-2  # tolerance of the integrator over the accuracy that is asked of the summary
_TIGHTEST = 1e-12  # tolerance of the integrator, at least: below, rounding costs all the work that modes would need
_LATE = 1e-3  # events are late by 1e-10 times this of the depth: above rounding, below what a sample shows
_NEVER = -1e300  # velocity at which the core would report the impactor's stop, which is watched here


@dataclass(frozen=True)
class Moment:
    """An event: ξ, ξ', f, ν and displacement of the struck point at a time, and the law's branch after it."""

    name: str
    time: float
    values: Array
    branch: int


@dataclass(frozen=True)
class Span:
    """The motion between two events: y = (x, ν, work, w_n, ẇ_n) by the integrator's own interpolation."""

    begin: float
    motion: Callable[[Any], Array]
    state: native.State


@dataclass(frozen=True)
class Vibration:
    """An impact on a vibrating target, in the units of the march. `summary` as the core's."""

    curve: native.Curve
    frequency: Array
    share: Array
    spans: tuple[Span, ...]
    events: tuple[Moment, ...]
    outcome: Outcome
    summary: native.Summary
    energy: float
    work: int
    waited: bool

    @property
    def modes(self) -> int:
        """Number of modes."""
        return self.frequency.size

    def sample(self, times: Array) -> tuple[Array, NDArray[np.int8]]:
        """(count, 5) values ξ, ξ', f, ν, displacement of the struck point at ascending times, and branch of each."""
        values, branches = np.empty((times.size, 5)), np.empty(times.size, np.int8)
        at = np.searchsorted([span.begin for span in self.spans[1:]], times, side="right")
        for k in np.unique(at):
            chosen, span = np.flatnonzero(at == k), self.spans[k]
            motion = span.motion(times[chosen]).T
            for i, y in zip(chosen.tolist(), motion, strict=True):
                values[i] = _values(self.curve, span.state, y)
            branches[chosen] = span.state.branch
        return values, branches


def vibrate(
    problem: Problem, modes_up_to: Callable[[float], Modes], compliance: float, accuracy: float, warnings: list[str]
) -> tuple[Vibration, float]:
    """The impact with so many modes that its summary is accurate, and the error estimate.

    modes_up_to: modes below a frequency [rad/s]. compliance: of all modes together, m/N. The highest frequency is
    doubled until two runs agree.
    """
    scales = problem.scales
    soft = compliance * scales.force / scales.length
    spring = _without_inertia(problem, curve_of(problem.law, soft).native)
    still = _without_inertia(problem, problem.curve.native) or spring
    if still is None or spring is None:
        raise SimulationError(f"law {problem.law.name}: {Outcome.BEYOND_LAW.value}; it cannot stop this impactor")
    depth = still.maximum_indentation
    lowest = _lowest(modes_up_to, 1.0 / scales.time)
    limit = LONGEST * (spring.contact_duration + 2.0 * math.pi / lowest)
    highest = max(_FIRST_PHASE / still.time_of_maximum_indentation, 4.0 * lowest)

    tolerance = max(accuracy * _INTEGRATION, _TIGHTEST)

    def run(highest: float) -> Vibration:
        modes = modes_up_to(highest / scales.time)
        rest = max(soft - modes.compliance * scales.force / scales.length, 0.0)
        frequency, share = modes.frequency * scales.time, modes.share * problem.mass
        return _integrate(problem, frequency, share, rest, depth, limit, tolerance)

    coarse = run(highest)
    while True:
        highest *= 2.0
        fine = run(highest)
        estimated = MODES_FACTOR * difference(problem, coarse.summary, fine.summary) + tolerance
        if estimated <= accuracy:
            return fine, estimated
        if 4 * fine.work > MOST_WORK:
            warnings.append(
                f"accuracy {accuracy:g} cannot be had: the error is estimated at {estimated:.1e} with {fine.modes} "
                "modes"
            )
            return fine, estimated
        coarse = fine


def _without_inertia(problem: Problem, curve: native.Curve) -> native.Summary | None:
    """The impact on a fixed target, or on a spring; None where the law ends before it turns."""
    start = native.Start(max(problem.approach, 1e-3), 0.0, 0.0, 0.0, math.inf)
    status, summary = native.impact(curve, native.mesh(native.WORK_PRESERVING, 6, 6), start)
    return summary if status == native.EVENT else None


def _lowest(modes_up_to: Callable[[float], Modes], unit: float) -> float:
    """The lowest frequency that the struck point takes part in, in units of `unit` [rad/s]."""
    highest = unit * 2.0**-60
    for _ in range(120):
        found = modes_up_to(highest).frequency
        if found.size > 0:
            return float(found[0]) / unit
        highest *= 2.0
    raise SimulationError("the target has no natural vibration that an impact could excite")


def _values(curve: native.Curve, state: native.State, y: Array) -> Array:
    """ξ, ξ', f, ν and displacement of the struck point from the integrator's y, under the law as in `state`."""
    at, count = native.State.from_buffer_copy(state), (y.size - 3) // 2
    moved, rate = float(y[3 : 3 + count].sum()), float(y[3 + count :].sum())
    at.xi, at.nu, at.shift = float(y[0]) - moved, float(y[1]) - rate, moved
    at.force = native.force_of(curve, at)(at.xi)
    values = native.motion(curve, at)
    values[3] = y[1]
    return values


def _integrate(
    problem: Problem, frequency: Array, share: Array, rest: float, depth: float, limit: float, tolerance: float
) -> Vibration:
    from scipy.integrate import solve_ivp

    curve, load, count = curve_of(problem.law, rest).native, problem.load, frequency.size
    state = native.initial_state(curve, native.Start(problem.approach, 0.0, load, _NEVER, math.inf))
    square, w, u = frequency**2, slice(3, 3 + count), slice(3 + count, 3 + 2 * count)
    force, work = native.force_of(curve, state), 0

    def rates(_: float, y: Array) -> Array:
        nonlocal work
        work += count + 400
        if work > MOST_WORK:
            raise SimulationError(
                f"the motion on {count} modes takes too long: {len(events)} events were met; a coarser accuracy needs "
                "fewer modes, and target_inertia = false in [effects] none"
            )
        moved, rate = y[w].sum(), y[u].sum()
        f = force(y[0] - moved)
        dy = np.empty_like(y)
        dy[0], dy[1], dy[2] = y[1], load - f, f * (y[1] - rate)
        dy[w] = y[u]
        dy[u] = share * f - square * y[w]
        return dy

    def stand(y: Array) -> None:
        moved = y[w].sum()
        state.xi, state.nu, state.shift = float(y[0] - moved), float(y[1] - y[u].sum()), float(moved)

    def indicator(k: int) -> Any:
        def watch(_: float, y: Array) -> float:
            stand(y)
            return native.indicators(curve, state, _LATE * problem.approach)[k]

        event: Any = watch
        event.terminal, event.direction = True, -1.0
        return event

    def stops(_: float, y: Array) -> float:
        return float(y[1])

    stops.direction = -1.0  # pyright: ignore[reportFunctionMemberAccess]
    watched = [indicator(0), indicator(1), indicator(2), stops]

    y, t = np.zeros(3 + 2 * count), 0.0
    y[1] = problem.approach
    speed = max(problem.approach, math.sqrt(depth))
    sizes = [[depth, speed, speed**2], np.full(count, depth), np.full(count, speed)]
    options: Any = {"method": "DOP853", "rtol": tolerance, "atol": 1e-2 * tolerance * np.concatenate(sizes)}
    spans: list[Span] = []
    events: list[Moment] = []
    while True:
        stand(y)
        for name, branch in native.switch(curve, state):
            values = _values(curve, state, y)
            if name in ("contact_begins", "contact_ends"):
                values[0] = state.xi_free
            events.append(Moment(name, t, values, branch))
        if len(events) > MOST_EVENTS:
            raise SimulationError(f"more than {MOST_EVENTS} events before the impactor leaves the target")
        held, free = native.State.from_buffer_copy(state), state.branch == native.FREE
        until, waits = (limit, True) if not free else _wait(t, y, load, state.xi_free, frequency, limit)
        if free:
            spans.append(Span(t, _Flight(t, y, load, frequency), held))
        if not t < until:
            break
        solution: Any = solve_ivp(rates, (t, until), y, events=watched, dense_output=True, **options)
        if solution.status < 0:
            raise SimulationError(f"the vibrating target could not be integrated: {solution.message}")
        if free and solution.status == 0:
            break
        if not free:
            spans.append(Span(t, solution.sol, held))
        for time, at in zip(solution.t_events[3], solution.y_events[3], strict=True):
            events.append(Moment("impactor_stops", float(time), _values(curve, held, at), held.branch))
        t, y = float(solution.t[-1]), solution.y[:, -1]
        if solution.status == 0:
            break
    outcome = Outcome.SEPARATED if free else Outcome.TIME_LIMIT
    energy = float(np.sum((y[u] ** 2 + square * y[w] ** 2) / share)) / 2.0
    summary = _summary(events, y, problem.approach, outcome)
    return Vibration(
        curve, frequency, share, tuple(spans), tuple(events), outcome, summary, energy, work, free and waits
    )


def _wait(t: float, y: Array, load: float, xi_free: float, frequency: Array, limit: float) -> tuple[float, bool]:
    """Until when a lost contact is waited for, and whether it could still come back then.

    No longer than the contact has lasted, or the slowest period; nor than until the impactor is out of the reach of all
    modes together.
    """
    count = frequency.size
    reach = float(np.sum(np.hypot(y[3 : 3 + count], y[3 + count :] / frequency)))
    until = t + max(t, 2.0 * math.pi / float(frequency[0]))
    if load <= 0.0 and y[1] < 0.0:
        out = t + max(0.0, (float(y[0]) + reach - xi_free) / -float(y[1]))
        if out <= until:
            return out, False
    return min(until, max(limit, t)), load <= 0.0


@dataclass(frozen=True)
class _Flight:
    """The motion without contact, from y at `begin`."""

    begin: float
    y: Array
    load: float
    frequency: Array

    def __call__(self, times: Any) -> Array:
        y, count, rate = self.y, self.frequency.size, self.frequency[:, None]
        w, u = y[3 : 3 + count, None], y[3 + count :, None]
        tau = np.asarray(times, dtype=np.float64) - self.begin
        cos, sin = np.cos(rate * tau), np.sin(rate * tau)
        slow = [y[0] + tau * (y[1] + 0.5 * self.load * tau), y[1] + self.load * tau, np.full_like(tau, y[2])]
        return np.concatenate([np.stack(slow), w * cos + u / rate * sin, u * cos - w * rate * sin])


def _summary(events: list[Moment], y: Array, approach: float, outcome: Outcome) -> native.Summary:
    """As the core's; contact_duration is that of the first contact, the dent and the velocity those after the last."""
    summary = native.Summary()
    summary.time_impactor_stops = summary.contact_duration = summary.permanent_indentation = math.nan
    summary.final_velocity = math.nan
    summary.maximum_force = max((float(event.values[2]) for event in events), default=0.0)
    for event in events:
        if event.name == "maximum_indentation" and event.values[0] > summary.maximum_indentation:
            summary.maximum_indentation, summary.time_of_maximum_indentation = event.values[0], event.time
        elif event.name == "impactor_stops" and math.isnan(summary.time_impactor_stops):
            summary.time_impactor_stops = event.time
        elif event.name == "contact_ends" and outcome is Outcome.SEPARATED:
            if math.isnan(summary.contact_duration):
                summary.contact_duration = event.time
            summary.permanent_indentation, summary.final_velocity = event.values[0], event.values[3]
    summary.work, summary.shift = y[2], y[3 : 3 + (y.size - 3) // 2].sum()
    return summary
