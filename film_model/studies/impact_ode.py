"""An impact as differential equations for conventional integrators, one impact at a time, with events.

The equations are ξ' = ν − γF, ν' = p − F in the law's units, F = f + c ξ'. Integration restarts where a stage of the
law ends and where the indentation turns, and records when the impactor stops; with damping also the largest force and
the zero of the force, which ends the contact. Forces are the law's own functions, as Python functions of floats.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from film_model.laws.law import AbstractLaw, Function, Power, Stage, origin_of
from film_model.studies.quadrature import unloaded, value

INTEGRATED_VALUES = (
    "maximum_force",
    "maximum_indentation",
    "time_of_maximum_indentation",
    "time_impactor_stops",
    "contact_duration",
    "rebound_velocity",
)
"""Names of the values that a method returns, in the law's units."""

Force = Callable[[float], float]


class Run(NamedTuple):
    """One passage along a stage or a branch: its elastic force f(ξ), and the ξ at which it ends.

    origin: ξ at which the stage or branch begins. power: the force if it is a power, with its origin, else None.
    damping: c(ξ) of a damped law. slopes: derivatives of f and c.
    """

    force: Force
    to: float
    origin: float
    power: Power | None
    damping: Force | None = None
    slopes: tuple[Force, Force] | None = None


class Passage(NamedTuple):
    """The end of a run, and what happened on it.

    turned: whether the indentation turned there. stop: when ν passed 0, if requested. peak: largest F of a damped law
    during loading.
    """

    time: float
    state: tuple[float, float]
    turned: bool
    stop: float | None = None
    peak: float = 0.0


@dataclass
class Impact:
    """An impact in the law's units: approach velocity ν > 0, compliance γ of the target (0: half-space), load p.

    damper: factor of the law's damping c. evaluations: number of force evaluations so far.
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
        """F' of a damped law; zero at the largest F."""
        assert run.damping is not None and run.slopes is not None
        rate, force = self.motion(run, xi, nu)
        by_f, by_c = (slope(xi) * rate for slope in run.slopes)
        c = run.damping(xi)
        faster = (self.load - force - self.gamma * (by_f + by_c * rate)) / (1.0 + self.gamma * c)
        return by_f + by_c * rate + c * faster

    def largest(self, run: Run, states: Iterable[Any]) -> float:
        """Largest F at states (ξ, ν); 0 if there are none."""
        return max((self.motion(run, float(xi), float(nu))[1] for xi, nu in states), default=0.0)

    def counted(self, force: Force) -> Force:
        """The force, with every evaluation counted."""

        def count(xi: float) -> float:
            self.evaluations += 1
            return force(xi)

        return count

    def loading(self) -> list[Run]:
        """The law's stages from first touch, ξ = 0, on; a law that pulls has others before."""
        return [self._along(s, s.end) for s in self.stages if s.end > 0.0]

    def unloading(self, run: int, xi: float, force: float) -> list[Run]:
        """The runs of unloading from a turn in a run of loading."""
        stage = run + sum(s.end <= 0.0 for s in self.stages)
        rule = self.stages[stage].unloading
        if rule is None:
            return [self._along(s, s.begin) for s in self.stages[: stage + 1][::-1]]
        if rule.contact_area is not None:
            return [self._parting(float(value(rule.contact_area, xi, self.stages[stage])), xi, force)]
        branch = unloaded(rule, self.stages[stage], xi, force)
        return [self._along(branch, branch.begin)]

    def _parting(self, area: float, xi: float, force: float) -> Run:
        """JKR's contact of the area α² through (ξ, f), where its ball has r times the radius: lengths over
        δ_s r^{1/3}, forces over r F_c (Thornton & Ning 1998)."""
        ratio = area**1.5 / (force + 2.0 * area**0.75)
        if ratio < 1.0:
            raise ValueError("a dent close to yield, whose radius would be below that of the ball, is not integrated")
        first, length = self.stages[0], ratio ** (1.0 / 3.0)
        origin = xi - (3.0 * area / ratio - 4.0 * area**0.25)
        jkr = scalar(first.force, first)
        own = self.counted(lambda at: ratio * jkr((at - origin) / length))
        return Run(own, origin + length * first.begin, origin + length * first.begin, None)

    def _along(self, stage: Stage, to: float) -> Run:
        run = Run(self.counted(scalar(stage.force, stage)), to, stage.begin, _own_power(stage.force, stage))
        if stage.damping is None or self.damper == 0.0:
            return run
        damping = _own_power(stage.damping, stage)
        if run.power is None or damping is None:
            raise ValueError(f"stage {stage.name!r} has damping that is not a power")
        names = ("constant", "slope", "square", "coefficient")
        scaled = replace(damping, **{name: self.damper * getattr(damping, name) for name in names})
        return run._replace(damping=scalar(scaled, stage), slopes=(_slope(run.power), _slope(scaled)))


def _own_power(function: Function, stage: Stage) -> Power | None:
    return replace(function, origin=origin_of(function, stage)) if isinstance(function, Power) else None


def _slope(power: Power) -> Force:
    c1, c2, q, origin = power.slope, power.coefficient, power.exponent, power.origin or 0.0
    twice = 2.0 * power.square
    return lambda xi: c1 + twice * (xi - origin) + (c2 * q * max(xi - origin, 1e-300) ** (q - 1.0) if c2 else 0.0)


def scalar(function: Function, stage: Stage) -> Force:
    """A function of a stage as a function of a float; constant before the stage begins."""
    power, begin = _own_power(function, stage), stage.begin
    if power is None:
        return lambda xi: float(value(function, max(xi, begin), stage))
    origin = power.origin or 0.0
    return lambda xi: power.at(max(xi - origin, 0.0))


class Advance(Protocol):
    """Integrates one run from (time, ξ, ν) until ξ reaches run.to, the indentation turns (in loading), or F of a damped
    law falls to 0 (in unloading).
    """

    def __call__(
        self, run: Run, time: float, state: tuple[float, float], loading: bool, watch_stop: bool
    ) -> Passage: ...


def follow(impact: Impact, advance: Advance) -> tuple[float, ...]:
    """Integrate the whole contact by one method: `INTEGRATED_VALUES`. Raises RuntimeError if the method fails."""
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


def impact_of(law: AbstractLaw, nu: float, gamma: float, load: float = 0.0, damper: float = 0.0) -> Impact:
    """The equations of an impact, in the law's units."""
    return Impact(law.stages(), nu, gamma, load, damper)


def sizes(impact: Impact) -> Any:
    """Typical sizes of ξ and ν for absolute tolerances, by Hertz's law from the approach velocity or the load."""
    depth = max((1.25 * impact.nu**2) ** 0.4, (2.5 * abs(impact.load)) ** (2.0 / 3.0))
    return np.array([depth, max(impact.nu, math.sqrt(abs(impact.load) * depth))])
