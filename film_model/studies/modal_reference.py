"""The reference for contact on modes: contact law and natural vibrations together, by SciPy's integrators with events.

In the units of the march, ẍ = p − f and ẅ_n + 2 ζ_n ω_n ẇ_n + ω_n² w_n = r_n f with r_n = m φ_n²/M_n; a mode of
frequency 0 is a motion of the whole structure. The omitted high modes follow the force statically: the indentation is
x − Σ w_n − c f, so the law is in series with a spring of compliance c. The force is the core's; its march and its
tables of modes are not used. Laws that are damped or cannot be in series with a spring are not integrated.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.base.errors import Outcome, SimulationError
from film_model.core import native
from film_model.problem.curve import curve_of
from film_model.problem.problem import Problem


class System(NamedTuple):
    """Modes in the units of the march: ω_n², r_n, 2 ζ_n ω_n; the load p, and the force f(ξ) on the present branch."""

    square: Array
    share: Array
    drag: Array
    load: float
    force: Callable[[float], float]


class Moment(NamedTuple):
    """An event: ξ, ξ', f, ν and displacement of the struck point at a time, and the law's branch after it."""

    name: str
    time: float
    values: Array | list[float]
    branch: int


@dataclass(frozen=True)
class Span:
    """The motion between two events: y = (x, ν, work, w_n, ẇ_n) by the integrator's own interpolation."""

    begin: float
    motion: Callable[[Any], Array]
    state: native.State


@dataclass(frozen=True)
class ModalRun:
    """An impact on a vibrating target, in the units of the march. `summary` as the core's."""

    curve: native.Curve
    frequency: Array
    share: Array
    spans: tuple[Span, ...]
    events: tuple[Moment, ...]
    outcome: Outcome
    summary: native.Summary
    energy: float
    evaluations: int
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


def _values(curve: native.Curve, state: native.State, y: Array) -> Array:
    """ξ, ξ', f, ν and displacement of the struck point from the integrator's y, on the branch of `state`."""
    at, count = native.State.from_buffer_copy(state), (y.size - 3) // 2
    moved, rate = float(y[3 : 3 + count].sum()), float(y[3 + count :].sum())
    at.xi, at.nu, at.shift = float(y[0]) - moved, float(y[1]) - rate, moved
    at.force = native.force_of(curve, at)(at.xi)
    values = native.motion(curve, at)
    values[3] = y[1]
    return values


def integrate(
    problem: Problem,
    frequency: Array,
    share: Array,
    rest: float,
    depth: float,
    limit: float,
    tolerance: float,
    ratio: Array | float = 0.0,
    method: Any = "DOP853",
    step: float | None = None,
) -> ModalRun:
    """The impact on these modes (ω t_s, r_n, ζ_n), in series with a spring of compliance `rest`.

    depth: scale of lengths. limit: time at which contact is no longer followed. method: of `solve_ivp`, or a solver
    that takes fixed steps of the length `step` (`film_model.studies.modal_newmark`). Raises SimulationError if it takes
    too long, ValueError for a damped law.
    """
    most_events = 10_000
    from scipy.integrate import solve_ivp

    if problem.law.damped:
        raise ValueError("damped laws on vibrating targets are not integrated")
    curve, load, count = curve_of(problem.law, rest).native, problem.load, frequency.size
    # the velocity disables the core's event "impactor stops", which is detected here
    state = native.initial_state(curve, native.Start(problem.approach, 0.0, load, -1e300, math.inf))
    drag, w, u = 2.0 * ratio * frequency + np.zeros(count), slice(3, 3 + count), slice(3 + count, 3 + 2 * count)
    law, evaluations = native.force_of(curve, state), 0

    def force(xi: float) -> float:
        nonlocal evaluations
        evaluations += 1
        if evaluations * (count + 400) > 500_000_000:  # about fifteen seconds
            raise SimulationError(
                f"integrating {count} modes takes too long (after {len(events)} events): use a coarser accuracy, "
                "which needs fewer modes, or target_inertia = false in [effects]"
            )
        return law(xi)

    system = System(frequency**2, share, drag, load, force)

    def rates(_: float, y: Array) -> Array:
        moved, rate = y[w].sum(), y[u].sum()
        f = force(y[0] - moved)
        dy = np.empty_like(y)
        dy[0], dy[1], dy[2] = y[1], load - f, f * (y[1] - rate)
        dy[w] = y[u]
        dy[u] = share * f - system.square * y[w] - drag * y[u]
        return dy

    def set_state(y: Array) -> None:
        moved = y[w].sum()
        state.xi, state.nu, state.shift = float(y[0] - moved), float(y[1] - y[u].sum()), float(moved)

    def indicator(k: int) -> Any:
        def watch(_: float, y: Array) -> float:
            set_state(y)
            # events are late by 1e-13 of the depth: above rounding, invisible in samples
            return native.indicators(curve, state, 1e-3 * problem.approach)[k]

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
    options: Any = {"method": method, "rtol": tolerance, "atol": 1e-2 * tolerance * np.concatenate(sizes)}
    options |= {} if step is None else {"system": system, "step": step}
    spans: list[Span] = []
    events: list[Moment] = []
    while True:
        set_state(y)
        for name, branch in native.switch(curve, state):
            values = _values(curve, state, y)
            if name in ("contact_begins", "contact_ends"):
                values[0] = state.xi_free
            events.append(Moment(name, t, values.tolist(), branch))
        if len(events) > most_events:
            raise SimulationError(f"more than {most_events} events before the impactor leaves the target")
        held, free = native.State.from_buffer_copy(state), state.branch == native.FREE
        until, waits = (limit, True) if not free else _wait(t, y, load, state.xi_free, frequency, limit)
        if free:
            spans.append(Span(t, _Flight(t, y, load, frequency, drag), held))
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
            events.append(Moment("impactor_stops", float(time), _values(curve, held, at).tolist(), held.branch))
        t, y = float(solution.t[-1]), solution.y[:, -1]
        if solution.status == 0:
            break
    outcome = Outcome.SEPARATED if free else Outcome.TIME_LIMIT
    energy = float(np.sum((y[u] ** 2 + system.square * y[w] ** 2) / share)) / 2.0
    summary = _summary(events, y, problem.approach, outcome)
    return ModalRun(
        curve, frequency, share, tuple(spans), tuple(events), outcome, summary, energy, evaluations, free and waits
    )


def _wait(t: float, y: Array, load: float, xi_free: float, frequency: Array, limit: float) -> tuple[float, bool]:
    """Time until which another contact is waited for, and whether it may still happen later.

    The wait is the larger of the contact time so far and the longest period; it ends when the impactor is farther from
    the structure, which may move as a whole, than all modes together can move: damped ones move less.
    """
    count, bends = frequency.size, frequency > 0.0
    w, u = y[3 : 3 + count], y[3 + count :]
    reach = float(np.sum(np.hypot(w[bends], u[bends] / frequency[bends])))
    away, speed = float(y[0] - w[~bends].sum()), float(y[1] - u[~bends].sum())
    until = t + max(t, 2.0 * math.pi / float(frequency[bends][0]) if bends.any() else 0.0)
    if load <= 0.0 and speed < 0.0:
        out = t + max(0.0, (away + reach - xi_free) / -speed)
        if out <= until:
            return out, False
    return min(until, max(limit, t)), load <= 0.0


@dataclass(frozen=True)
class _Flight:
    """The motion without contact, from y at `begin`. drag: 2 ζ_n ω_n."""

    begin: float
    y: Array
    load: float
    frequency: Array
    drag: Array

    def __call__(self, times: Any) -> Array:
        y, count = self.y, self.frequency.size
        w, u = y[3 : 3 + count, None], y[3 + count :, None]
        tau, fades = np.asarray(times, dtype=np.float64) - self.begin, 0.5 * self.drag[:, None]
        rate = np.sqrt(np.maximum(self.frequency[:, None] ** 2 - fades**2, 0.0))
        cos, sin = np.cos(rate * tau), tau * np.sinc(rate * tau / math.pi)  # sin(ωτ)/ω, which is τ at ω = 0
        decay, falls = np.exp(-fades * tau), self.frequency[:, None] ** 2 * w
        slow = [y[0] + tau * (y[1] + 0.5 * self.load * tau), y[1] + self.load * tau, np.full_like(tau, y[2])]
        moved, rates = w * (cos + fades * sin) + u * sin, u * (cos - fades * sin) - falls * sin
        return np.concatenate([np.stack(slow), decay * moved, decay * rates])


def _summary(events: list[Moment], y: Array, approach: float, outcome: Outcome) -> native.Summary:
    """The core's summary; contact_duration of the first contact, permanent indentation and velocity after the last."""
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
