"""The results of an oblique impact beside those of its normal motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from film_model.base import units
from film_model.base.arrays import Array, Number, either, greater
from film_model.base.units import format_si

OBLIQUE: dict[str, tuple[str, str]] = {
    "tangential_rebound_velocity": ("velocity", "of the centre of the impactor along the surface"),
    "rebound_spin": ("angular_frequency", "of the impactor; positive if it adds to sliding"),
    "rebound_angle": ("angle", "between the path of the centre and the normal"),
    "contact_point_rebound_velocity": ("velocity", "of sliding when contact ends"),
    "tangential_restitution": ("dimensionless", "tangential velocity of the centre after over before the impact"),
    "tangential_impulse": ("impulse", "of friction, against sliding"),
    "maximum_friction_force": ("force", "largest friction force, by its size"),
    "time_of_maximum_friction_force": ("time", "after first touch"),
    "friction_work": ("energy", "dissipated by friction"),
    "impact_number": ("dimensionless", "ψ₁ = v/(κ µ V_n), v: of sliding before; below 1 elastic contacts stick first"),
    "tangential_parameter": ("dimensionless", "χ = (m/m_t)/(2 κ), with κ = E*/(4 G*)"),
    "target_tangential_velocity": ("velocity", "of the centre of a target that is a free body"),
    "target_rebound_spin": ("angular_frequency", "of a target that is a free body; positive as the impactor's"),
}
"""Results of an oblique impact, with dimension and meaning; those of the target of free bodies only."""

BOUNDS: dict[str, tuple[str, str]] = {
    "sliding_after_low": ("velocity", "lower sliding velocity after the impact"),
    "sliding_after_high": ("velocity", "higher sliding velocity after the impact"),
}
"""Bounds of that velocity under two models of a contact that yields, with the errors of both; dimension and meaning."""

RESULTS = OBLIQUE | BOUNDS
"""What a batch or sweep has of each impact."""

REGIMES = ("sticks first", "slides first", "slides throughout")

MOTION: dict[str, tuple[str, str]] = {
    "time": ("time", "after first touch"),
    "sliding_velocity": ("velocity", "of the contacting points on each other"),
    "friction_force": ("force", "on the impactor, against sliding at first touch"),
    "sliding_displacement": ("length", "of the bodies on each other since first touch, far from the contact"),
    "stick_radius": ("length", "of the area that sticks; by springs to 1/256 of the largest"),
}
"""Columns of the recorded motion, with dimension and meaning."""

KINDS = ("sticks", "slips", "slip_reverses", "slides")
"""Events: a phase of the contact begins."""

OPEN = 0.01
"""Difference of two models, or error if no accuracy is asked for, over the sliding velocity before, from which a
warning names it."""

MODELLED = 1e-3
"""Accuracy beyond which friction of a contact that yields is not refined: its stiffness is less known."""


def error_of_force(estimated: Number) -> Number:
    """Error of the sliding velocity over that before, by the relative error of the normal force: that share of v₁ − v₂,
    and |v₂| ≤ |v₁|."""
    return 2.0 * estimated


def allowed(accuracy: Any, yields: Any) -> Any:
    """Error of the sliding velocity over that before up to which none is named, where an accuracy is asked for."""
    return greater(error_of_force(accuracy), either(yields, MODELLED, 0.0))


def doubted(estimated: Any, accuracy: Any, low: Any, high: Any, before: Any) -> tuple[Any, Any]:
    """Whether the error of the sliding velocity is named, and how far two models differ. accuracy: that was asked for,
    or nan. low, high: bounds; the same of one model. before: |v₁|."""
    most = either(accuracy == accuracy, allowed(accuracy, low < high), OPEN)
    return estimated > most, high - low > OPEN * before


@dataclass(frozen=True)
class Oblique:
    """The tangential part of an impact. summary: SI floats by the names of `OBLIQUE`. sliding_regime: "sticks first",
    "slides first" or "slides throughout", of the motion that is simulated: a damping force, which raises the limit of
    friction at first touch, may make a contact stick whose ψ₁ is above 1. events: (time, s, and "sticks", "slips",
    "slip_reverses" or "slides"); by springs within a step, 1/2048 of a contact (more than eight contacts: down to
    1/128), and the first 32 of several contacts. motion: arrays, SI, by the names of `MOTION`; at these
    times the sliding velocity is within the estimate, and by springs the friction force within 6e-4 of its largest
    limit. Lines between are off by up to 3e-3 of the largest values where friction is solved exactly, by springs by
    2e-5 of the velocity, and of the force by 1e-2 in the step in which a damping force begins. estimated: error of the
    sliding velocity over that before. low, high: bounds of the sliding velocity after the impact under two models of a
    contact that yields, with the errors of both; None of others.

    >>> fm.simulate(scene).oblique is None  # no friction is given
    True
    """

    summary: Mapping[str, float] = field(hash=False)
    sliding_regime: str
    events: tuple[tuple[float, str], ...] = field(repr=False)
    motion: Mapping[str, Array] = field(repr=False, hash=False, compare=False)
    estimated: float
    low: float | None = None
    high: float | None = None

    def __getattr__(self, name: str) -> Any:
        """A result as a pint quantity, by its name in `OBLIQUE`."""
        if name in OBLIQUE:
            return units.quantity(self.summary[name], OBLIQUE[name][0])
        raise AttributeError(name)

    @property
    def bounds(self) -> dict[str, float]:
        """The bounds of the sliding velocity after the impact, m/s, by name; empty where the law does not yield."""
        ends = zip(BOUNDS, (self.low, self.high), strict=True)
        return {name: end for name, end in ends if end is not None}

    def to_dict(self) -> dict[str, Any]:
        """Plain values, for JSON, which has no infinite ones and no NaN: None instead."""
        values = {
            name: {"value": value if math.isfinite(value) else None, "units": units.si_unit(RESULTS[name][0])}
            for name, value in {**self.summary, **self.bounds}.items()
        }
        events = [{"name": name, "time": time} for time, name in self.events]
        return {**values, "sliding_regime": self.sliding_regime, "events": events, "estimated_error": self.estimated}

    def warnings(self, accuracy: float | None = None) -> tuple[str, ...]:
        """How far two models of a contact that yields differ, and an error beyond the accuracy that was asked for."""
        before, said = abs(self.motion["sliding_velocity"][0]), list[str]()
        low, high = self.low or 0.0, self.high or 0.0
        inexact, apart = doubted(self.estimated, math.nan if accuracy is None else accuracy, low, high, before)
        if inexact:
            said.append(f"friction: the sliding velocity is known to {100 * self.estimated:.2g} % of that before only")
        if apart:
            ends = " and ".join(format_si(end, "velocity", 3) for end in (low, high))
            said.append(
                "friction: how stiff a contact that yields is along the surface is not known; two models give a "
                f"sliding velocity after the impact of {ends}"
            )
        return tuple(said)

    def text(self) -> str:
        """The results in lines, for a terminal."""
        lines = [f"  {name.replace('_', ' '):32}{_shown(name, value):>14}" for name, value in self.summary.items()]
        return "\n".join([f"  oblique: {self.sliding_regime}", *lines])


def _shown(name: str, value: float) -> str:
    dimension = OBLIQUE[name][0]
    if math.isnan(value):
        return "-"
    return f"{math.degrees(value):.6g} deg" if dimension == "angle" else format_si(value, dimension, 6)
