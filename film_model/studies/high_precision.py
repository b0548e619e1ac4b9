"""One impact in extended precision: a reference for results in double precision.

Zener's equations in the variable y = (ξ − ξ_b)^(1/2), as in `film_model.studies.quadrature.integrate`, for a damped law
(ξ − ξ_b)^(1/4), by Gragg–Bulirsch–Stoer extrapolation with mpmath. The law must consist of powers whose exponents are
multiples of 1/2 (damped: 1/4), which are smooth in y. No code is shared with the core.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from film_model.laws.law import AbstractLaw, Power, Stage, origin_of

DIGITS = 30
"""Decimal digits of the arithmetic; results have about ten fewer correct digits."""


def impact(
    law: AbstractLaw, mass: float, velocity: float, impedance: float = math.inf, load: float = 0.0
) -> dict[str, float]:
    """One impact under a constant load [N]: SI floats by the names of `quadrature.REFERENCE_VALUES`, without energies.

    Raises ImportError without mpmath, ValueError for a law that is not made of powers or that ends before the motion
    turns, and for a load that turns the impactor back or prevents the end of contact.
    """
    return _Extended(arithmetic(), law, mass, velocity, impedance, load).summary()


def arithmetic() -> Any:
    """A context of mpmath with `DIGITS` digits. Raises ImportError without mpmath."""
    try:
        import mpmath
    except ImportError as error:
        raise ImportError("extended precision needs mpmath: pip install mpmath") from error
    context = mpmath.mp.clone()
    context.dps = DIGITS
    return context


class _Extended:
    """The equations of one impact in mpmath's numbers, in the law's units."""

    def __init__(
        self, context: Any, law: AbstractLaw, mass: float, velocity: float, impedance: float, load: float
    ) -> None:
        self.mp = context
        number = context.mpf
        length, force = (number(x) for x in law.scales(0.5 * mass * velocity**2))
        self.length, self.force = length, force
        self.time = context.sqrt(number(mass) * length / force)
        self.speed = length / self.time
        self.nu = number(velocity) / self.speed
        self.gamma = number(0) if math.isinf(impedance) else force / (number(impedance) * self.speed)
        self.load = number(load) / force
        self.stages = law.stages()
        self.root = 4 if law.damped else 2
        self.damper = number(float(law.damping_factor(mass, velocity, float(length)))) * self.speed / force
        self.damping: Callable[[Any], Any] | None = None
        self.tolerance = number(10) ** (4 - DIGITS)
        self.nudge = number(10) ** (-DIGITS // 2)

    def power(self, function: Any, stage: Stage) -> Callable[[Any], Any]:
        """A function of ξ."""
        if isinstance(function, (int, float)):
            return lambda xi: self.mp.mpf(function)
        if not isinstance(function, Power) or (function.coefficient and (self.root * function.exponent) % 1.0):
            raise ValueError(
                f"stage {stage.name!r} is not made of powers whose exponents are multiples of 1/{self.root}"
            )
        names = ("constant", "slope", "square", "coefficient", "exponent")
        exact = replace(function, **{name: self.mp.mpf(getattr(function, name)) for name in names})
        origin = self.mp.mpf(origin_of(function, stage))
        return lambda xi: exact.at(max(xi - origin, self.mp.mpf(0)))

    def summary(self) -> dict[str, float]:
        """The values of the whole contact."""
        state, k, deepest, peak = self.load_contact()
        turn = state[2]
        stop = turn if self.gamma == 0 else None
        residual, runs = self.unloading(k, deepest)
        xi = deepest
        for begin, self.own in runs:
            state = (self.mp.root(xi - begin, self.root), *state[1:])
            state, _, passed = self.run(state, self.mp.mpf(0), False)
            stop = passed if stop is None else stop
            xi = begin
        return {
            "maximum_force": float(peak * self.force),
            "maximum_indentation": float(deepest * self.length),
            "time_of_maximum_indentation": float(turn * self.time),
            "time_impactor_stops": math.nan if stop is None else float(stop * self.time),
            "contact_duration": float(state[2] * self.time),
            "permanent_indentation": float(residual * self.length),
            "rebound_velocity": float(state[1] * self.speed),
            "coefficient_of_restitution": float(-state[1] / self.nu),
        }

    def load_contact(self) -> tuple[Sequence[Any], int, Any, Any]:
        """Loading: state at the turn, index of the stage, ξ there, and the largest force."""
        state: Sequence[Any] = (self.mp.mpf(0), self.nu, self.mp.mpf(0))
        peak = self.mp.mpf(0)
        for k, stage in enumerate(self.stages):
            begin, force = self.mp.mpf(stage.begin), self.power(stage.force, stage)
            self.own = lambda x, force=force, begin=begin: force(begin + x)
            if stage.damping is not None:
                damping = self.power(stage.damping, stage)
                self.damping = lambda x, damping=damping: self.damper * damping(x)
            edge = self.mp.inf if math.isinf(stage.end) else self.mp.root(self.mp.mpf(stage.end) - begin, self.root)
            state = (self.mp.mpf(0), *state[1:])
            peak = max(peak, self.motion(state)[1])
            state, turned, _ = self.run(state, edge, True)
            peak = max(peak, self.motion(state)[1], self.peak)
            if turned:
                return state, k, begin + state[0] ** self.root, peak
        raise ValueError("the law ends before the motion turns")

    def unloading(self, k: int, xi: Any) -> tuple[Any, list[tuple[Any, Callable[[Any], Any]]]]:
        """Residual ξ after a turn at ξ in stage k, and the runs to it: where each begins, and its force."""
        stage, rule = self.stages[k], self.stages[k].unloading
        if rule is None:
            runs: list[tuple[Any, Callable[[Any], Any]]] = []
            for passed in self.stages[: k + 1][::-1]:
                begin, own = self.mp.mpf(passed.begin), self.power(passed.force, passed)
                runs.append((begin, lambda x, own=own, begin=begin: own(begin + x)))
            return self.mp.mpf(0), runs
        q, load = self.power(rule.exponent, stage)(xi), self.power(stage.force, stage)(xi)
        if (self.root * q) % 1:
            raise ValueError(f"stage {stage.name!r} unloads with an exponent that is no multiple of 1/{self.root}")
        if rule.residual is not None:
            residual = self.power(rule.residual, stage)(xi)
        else:
            ratio = self.power(rule.radius_ratio, stage)(xi)
            residual = xi - (load / self.mp.sqrt(ratio)) ** (1 / q)
        span = xi - residual
        return residual, [(residual, lambda x: load * (x / span) ** q if x > 0 else self.mp.mpf(0))]

    def motion(self, state: Sequence[Any]) -> tuple[Any, Any]:
        """dξ/dt = (ν − γ f)/(1 + γ c), and F = f + c dξ/dt."""
        x = state[0] ** self.root
        f = self.own(x)
        if self.damping is None:
            return state[1] - self.gamma * f, f
        c = self.damping(x)
        rate = (state[1] - self.gamma * f) / (1 + self.gamma * c)
        return rate, f + c * rate

    def rates(self, state: Sequence[Any]) -> tuple[Any, Any, Any]:
        """d(y, ν, t)/dσ, with dt = n yⁿ⁻¹ dσ."""
        rate, force = self.motion(state)
        clock = self.root * state[0] ** (self.root - 1)
        return rate, clock * (self.load - force), clock

    def growth(self, state: Sequence[Any]) -> Any:
        """A difference of F with the sign of dF/dσ."""
        later = [s + self.nudge * r for s, r in zip(state, self.rates(state), strict=True)]
        return self.motion(later)[1] - self.motion(state)[1]

    def step(self, state: Sequence[Any], h: Any) -> tuple[Sequence[Any], Any, int]:
        """One extrapolated step: state, error, and number of columns used."""
        most = 14  # of the extrapolation
        rows: list[list[Sequence[Any]]] = []
        error = self.mp.inf
        for column in range(most):
            n = 2 * (column + 1)
            small = h / n
            before, now = state, [s + small * r for s, r in zip(state, self.rates(state), strict=True)]
            for _ in range(n - 1):
                rates = self.rates(now)
                before, now = now, [s + 2 * small * r for s, r in zip(before, rates, strict=True)]
            rates = self.rates(now)
            value: Sequence[Any] = [(a + b + small * r) / 2 for a, b, r in zip(before, now, rates, strict=True)]
            row: list[Sequence[Any]] = [value]
            for back, last in enumerate(rows[-1] if rows else []):
                ratio = self.mp.mpf(n) ** 2 / self.mp.mpf(2 * (column - back)) ** 2 - 1
                row.append([a + (a - b) / ratio for a, b in zip(row[-1], last, strict=True)])
            rows.append(row)
            if column > 2:
                sizes = [abs(a) + abs(h * r) for a, r in zip(state, self.rates(state), strict=True)]
                differences = zip(row[-1], row[-2], sizes, strict=True)
                error = max(abs(a - b) / (size + self.tolerance) for a, b, size in differences)
                if error < self.tolerance:
                    return row[-1], error, column + 1
        return rows[-1][-1], error, most

    def run(self, state: Sequence[Any], edge: Any, loading: bool) -> tuple[Sequence[Any], bool, Any]:
        """Integrate until y = edge, the indentation turns (in loading) or F falls to 0 (in unloading).

        Returns the state, whether the indentation turned, and the time at which ν passed 0, or None. Sets `peak`, the
        largest F of a damped contact on the way.
        """
        self.peak = self.mp.mpf(0)
        h = self.mp.mpf(1) if edge == self.mp.inf else abs(edge - state[0]) + self.mp.mpf("0.01")
        h /= 5 * max(abs(state[1]), 1)
        passed = None
        for _ in range(100_000):
            new, error, columns = self.step(state, h)
            if error > self.tolerance * 100:
                h /= 2
                continue
            hits: list[tuple[Any, bool]] = []
            crossing = (new[0] >= edge) if loading else (new[0] <= edge)
            if crossing and edge != self.mp.inf:
                hits.append((self.when(state, h, lambda s: s[0] - edge), False))
            if loading and self.rates(new)[0] <= 0 < self.rates(state)[0]:
                hits.append((self.when(state, h, lambda s: self.rates(s)[0]), True))
            if not loading and self.rates(new)[0] > 0:
                raise ValueError("the load turns the impactor back before contact ends")
            if self.damping is not None:
                if loading and self.growth(new) <= 0 < self.growth(state):
                    self.peak = self.motion(self.step(state, self.when(state, h, self.growth))[0])[1]
                if not loading and self.motion(new)[1] <= 0 < self.motion(state)[1]:
                    hits.append((self.when(state, h, lambda s: self.motion(s)[1]), False))
            if not loading and passed is None and state[1] > 0 >= new[1]:
                at = self.when(state, h, lambda s: s[1])
                if not hits or at <= hits[0][0]:
                    passed = self.step(state, at)[0][2]
            if hits:
                at, turned = min(hits, key=lambda hit: hit[0])
                return self.step(state, at)[0], turned, passed
            state = new
            if columns < 9:
                h *= 2
        raise ValueError("found no end of contact")

    def when(self, state: Sequence[Any], h: Any, function: Callable[[Sequence[Any]], Any]) -> Any:
        """Time within a step at which a function of the state passes zero: false position and bisection."""
        low, high, g_low = self.mp.mpf(0), h, function(state)
        g_high = function(self.step(state, h)[0])
        if g_low == 0:
            return low
        for k in range(60):
            at = high - g_high * (high - low) / (g_high - g_low) if k % 3 else (low + high) / 2
            g = function(self.step(state, at)[0])
            if (g > 0) == (g_low > 0):
                low, g_low = at, g
            else:
                high, g_high = at, g
            if g == 0 or high - low <= self.tolerance * h:
                break
        return high
