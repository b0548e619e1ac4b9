"""Friction in a contact that gives back its normal work: exact between events.

The theory of Cattaneo, Mindlin, Jäger and Ciavarella for elastically similar bodies, in the form of Popov's springs:
the tangential force is a difference of normal forces. In units of the normal motion, with the tangential displacement D
over κµ times the unit of length, κ = E*/(4 G*), and q = Q/(µ × unit of force):

    D'' = −2χ q,    2χ = (m/m_t)/κ
    stick: q' = f'(z) D',    slip with sign σ outside a depth c: q = q₀(c) + σ (f(z) − f(c)),  c − σ D₀(c) = z − σ D

D₀(s) and q₀(s) are the path of (D, q) over the depth at which each spring has stuck. Events end each step: stick ends
where |D'| = z'; slip ends where σ D' = z', and what had slipped sticks as a straight piece of the path; c reaches the
beginning of a piece; c = 0: sliding of the whole contact; c = z in unloading: the sign of slip changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, cast

import numpy as np

TOLERANCE = 1e-12
"""Of a step of the integration, relative; ψ₂ of 30 reference impacts is then right to 1e-8."""

NODES = 64
"""Times at which a recorded piece is known, between which others are searched."""

LONGEST_STEP = 0.1
"""Of the integration; contact takes about 3."""

LONGEST = 50.0
"""Time after which the end of a phase is not found."""

MOST_EVENTS = 50
"""Events of one impact; elastic impacts have up to six."""

Law = Callable[[float], tuple[float, float]]
"""The force f(z) and its slope, in units of the normal motion; f'' ≥ 0, f(0) = 0."""

STICK, SLIP, SLIDE = "sticks", "slips", "slides"
ENDS, TURNS, CORNER, CAUGHT = range(4)


class Normal(NamedTuple):
    """The normal motion ξ' = ν − γ f, ν' = load − f from ξ = 0. law: f. approach: ν at first touch."""

    law: Law
    approach: float
    gamma: float = 0.0
    load: float = 0.0


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return cast("Any", brentq)(function, low, high, xtol=1e-16, rtol=1e-15)


class Straight(NamedTuple):
    """A piece of the path: D₀ = D + slope (s − begin), q₀ = q + slope (f(s) − f(begin))."""

    begin: float
    end: float
    slope: float
    D: float
    q: float


@dataclass
class Stuck:
    """A piece of the path that was recorded as the contact stuck and grew. begin, end: depths. since, until: times.
    solution: of (z, ν, D, D', q) over time."""

    begin: float
    end: float
    since: float
    until: float
    solution: Any

    @cached_property
    def _times(self) -> Any:
        return np.linspace(self.since, self.until, NODES)

    @cached_property
    def _nodes(self) -> Any:
        return self.solution(self._times)

    def at(self, w: float, sign: float) -> Any:
        """(z, ν, D, D', q) where z − σ D was w, which rises with time: |D'| < z'."""
        known = self._nodes[0] - sign * self._nodes[2]
        if w >= known[-1]:
            return self._nodes[:, -1]
        if w <= known[0]:  # a trial step beyond the piece
            return self._nodes[:, 0] + (w - known[0]) / (known[1] - known[0]) * (self._nodes[:, 1] - self._nodes[:, 0])
        k = int(np.searchsorted(known, w))

        def off(t: float) -> float:
            y = self.solution(t)
            return y[0] - sign * y[2] - w

        low, high = self._times[k - 1], self._times[k]
        if off(low) * off(high) > 0.0:  # to rounding
            return self._nodes[:, k]
        return self.solution(_root(off, low, high))


class Slip(NamedTuple):
    """A contact that slips with a sign outside the depth c on a piece of the path; as a whole without a piece."""

    law: Law
    sign: float
    piece: Straight | Stuck | None

    def depth(self, z: float, D: float) -> float:
        """c."""
        piece, w = self.piece, z - self.sign * D
        if piece is None:
            return 0.0
        if isinstance(piece, Stuck):
            return float(piece.at(w, self.sign)[0])
        # c − σ (D + slope (c − begin)) = w, with slope = −σ
        return piece.begin + (w - piece.begin + self.sign * piece.D) / (1.0 - self.sign * piece.slope)

    def force(self, z: float, D: float) -> float:
        """q."""
        piece, f = self.piece, self.law(z)[0]
        if piece is None:
            return self.sign * f
        if isinstance(piece, Stuck):
            c, _, _, _, q = piece.at(z - self.sign * D, self.sign)
        else:
            c = self.depth(z, D)
            q = piece.q + piece.slope * (self.law(c)[0] - self.law(piece.begin)[0])
        return float(q) + self.sign * (f - self.law(float(c))[0])


class Phase(NamedTuple):
    """A phase between two events. kind: sticks, slips or slides. slip: None of one that sticks. begin, end: times.
    solution: of (z, ν, D, D', q)."""

    kind: str
    slip: Slip | None
    begin: float
    end: float
    solution: Any

    def at(self, time: float) -> tuple[float, float, float, float]:
        """z, D, D' and q."""
        z, _, D, rate, q = self.solution(time)
        return z, D, rate, q if self.slip is None else self.slip.force(z, D)


class Tangential(NamedTuple):
    """The tangential motion, in its units. velocity: ψ at the end, over the unit of velocity. phases: in order."""

    velocity: float
    phases: tuple[Phase, ...]


def tangential(normal: Normal, rate: float, velocity: float) -> Tangential:
    """The tangential motion of an impact. rate: 2χ. velocity: D' at first touch.

    Raises RuntimeError if there are more than `MOST_EVENTS` events.
    """
    return _Path(normal, rate).follow(velocity)


class _Path:
    """The state of one impact: the path of the springs that stick, and the motion."""

    def __init__(self, normal: Normal, rate: float) -> None:
        self.normal, self.rate = normal, rate
        self.pieces: list[Straight | Stuck] = []
        self.sign = 0.0

    def speed(self, z: float, nu: float) -> float:
        """z'."""
        return nu - self.normal.gamma * self.normal.law(z)[0]

    def follow(self, velocity: float) -> Tangential:
        y = np.array([0.0, self.normal.approach, 0.0, velocity, 0.0])
        kind = STICK if abs(velocity) < self.speed(0.0, y[1]) else SLIDE
        self.sign = math.copysign(1.0, velocity)
        phases, t = list[Phase](), 0.0
        for _ in range(MOST_EVENTS):
            phase, y, event = self._phase(kind, t, y)
            phases.append(phase)
            t = phase.end
            if event == ENDS:
                return Tangential(float(y[3]), tuple(phases))
            kind = self._inner(self._next(kind, event, y))
        raise RuntimeError(f"more than {MOST_EVENTS} events of friction in one impact")

    # ------------------------------------------------------------ phases

    def _phase(self, kind: str, t: float, y: Any) -> tuple[Phase, Any, int]:
        """A phase from a time and state, the state after it, and the event that ends it."""
        slip = None if kind == STICK else Slip(self.normal.law, self.sign, self.pieces[-1] if kind == SLIP else None)
        begun = float(y[0])

        def motion(_: float, y: Any) -> list[float]:
            z, nu, D, rate, q = y
            f, slope = self.normal.law(z)
            q = q if slip is None else slip.force(z, D)
            return [
                self.speed(z, nu),
                self.normal.load - f,
                rate,
                -self.rate * q,
                slope * rate if slip is None else 0.0,
            ]

        from scipy.integrate import solve_ivp

        found = solve_ivp(
            motion, (t, t + LONGEST), y, "DOP853", dense_output=True, events=self._events(slip),
            rtol=TOLERANCE, atol=TOLERANCE * 1e-2, max_step=self._longest_step(y, slip),
        )  # fmt: skip
        event = next((k for k, times in enumerate(found.t_events) if times.size), None)
        if event is None:
            raise RuntimeError("the end of a contact with friction is not found")
        end, last = float(found.t[-1]), np.array(found.y[:, -1])
        if slip is not None:
            last[4] = slip.force(last[0], last[2])
        elif last[0] > begun:
            self.pieces.append(Stuck(begun, float(last[0]), t, end, found.sol))
        return Phase(kind, slip, t, end, found.sol), last, event

    def _longest_step(self, y: Any, slip: Slip | None) -> float:
        """A step that passes over no event: sticking ends before the turn, which may be near."""
        f = self.normal.law(float(y[0]))[0]
        left = self.speed(float(y[0]), float(y[1])) / f if slip is None and f > 0.0 else math.inf
        return min(LONGEST_STEP, 0.1 * left)

    def _events(self, slip: Slip | None) -> list[Any]:
        """Functions that fall to 0 at the events, in the order of their numbers."""

        def ends(_: float, y: Any) -> float:
            return y[0]

        def turns(_: float, y: Any) -> float:  # stick: |D'| = z'; slip: σ D' = z'
            speed = self.speed(y[0], y[1])
            return speed - abs(y[3]) if slip is None else slip.sign * y[3] - speed

        def corner(_: float, y: Any) -> float:
            return slip.depth(y[0], y[2]) - slip.piece.begin  # type: ignore[union-attr]

        def caught(_: float, y: Any) -> float:
            return y[0] - slip.depth(y[0], y[2])  # type: ignore[union-attr]

        found: list[Any] = [ends, turns] if slip is None or slip.piece is None else [ends, turns, corner, caught]
        for event in found:
            event.terminal, event.direction = True, -1.0
        return found

    # ------------------------------------------------------------ the path

    def _cut(self, c: float) -> None:
        """Leave the path up to a depth."""
        while self.pieces and self.pieces[-1].begin >= c * (1.0 - 1e-12):
            self.pieces.pop()
        if self.pieces:
            last = self.pieces[-1]
            if isinstance(last, Straight):
                self.pieces[-1] = last._replace(end=c)
            else:
                self.pieces[-1] = replace(last, end=c, until=self._time(last, c))

    def _time(self, piece: Stuck, c: float) -> float:
        """When a recorded piece was at a depth."""
        return _root(lambda t: piece.solution(t)[0] - c, piece.since, piece.until)

    def _stick_all(self, kind: str, y: Any) -> None:
        """What slipped outside c sticks: a straight piece of the path up to (z, D)."""
        z, D, q = float(y[0]), float(y[2]), float(y[4])
        slip = Slip(self.normal.law, self.sign, self.pieces[-1] if kind == SLIP else None)
        c = min(slip.depth(z, D), z)
        self._cut(c)
        f, at = self.normal.law(z)[0], self.normal.law(c)[0]
        if z > c:
            self.pieces.append(Straight(c, z, self.sign, D - self.sign * (z - c), q - self.sign * (f - at)))

    def _next(self, kind: str, event: int, y: Any) -> str:
        """The kind of the next phase, after an event."""
        if event == CORNER:
            self.pieces.pop()
        elif event == CAUGHT:
            self.sign = -self.sign
            self._cut(float(y[0]))
        elif kind == STICK:
            self.sign = math.copysign(1.0, float(y[3]))
        else:
            self._stick_all(kind, y)
            if self.speed(float(y[0]), float(y[1])) > 0.0:
                return STICK
            self.sign = -self.sign
        return SLIP

    def _inner(self, kind: str) -> str:
        """The kind of a phase of slip where what slipped in its direction before slips again."""
        while (
            kind == SLIP
            and self.pieces
            and isinstance(self.pieces[-1], Straight)
            and self.pieces[-1].slope == self.sign
        ):
            self.pieces.pop()
        return kind if self.pieces or kind != SLIP else SLIDE
