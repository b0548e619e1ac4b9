"""What an impact did: events, summary, and the motion at any time, in quantities."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model import units
from film_model.core import native
from film_model.errors import Outcome
from film_model.problem import Problem
from film_model.scene import Scene
from film_model.vibration import Vibration

SUMMARY: dict[str, tuple[str, str]] = {
    "maximum_force": ("force", "largest contact force"),
    "maximum_indentation": ("length", "largest indentation"),
    "time_of_maximum_indentation": ("time", "time from first touch to maximum indentation"),
    "time_impactor_stops": ("time", "time at which the impactor's velocity is zero; none if it never is"),
    "contact_duration": ("time", "time from first touch to the end of contact"),
    "permanent_indentation": ("length", "indentation that is left at the end of contact"),
    "rebound_velocity": ("velocity", "impactor velocity at the end of contact; a rebound is negative"),
    "coefficient_of_restitution": ("dimensionless", "separation velocity over approach velocity"),
    "energy_absorbed": ("energy", "work done on the indentation and not given back"),
    "energy_radiated": ("energy", "energy that went into the motion of the target"),
}
"""Summary names, with dimension and meaning."""

MOTION: dict[str, tuple[str, str]] = {
    "indentation": ("length", "impactor displacement less target displacement"),
    "relative_velocity": ("velocity", "rate of indentation"),
    "contact_force": ("force", "force of the contact law at the indentation"),
    "impactor_displacement": ("length", "from first touch, positive into the target"),
    "impactor_velocity": ("velocity", "positive into the target"),
    "target_displacement": ("length", "at the point of impact, positive along the impactor's approach"),
    "target_velocity": ("velocity", "at the point of impact"),
}
"""Quantities of a history over time, with dimension and meaning. Equation (27) of Big-Alabo et al. 2017 gives the
target's displacement, ∫F dt/Z."""


@dataclass(frozen=True)
class Event:
    """Something that happens at one time: SI floats. stage: of the law, or "unloading" or "" (no contact)."""

    name: str
    time: float
    stage: str
    indentation: float
    relative_velocity: float
    contact_force: float
    impactor_displacement: float
    impactor_velocity: float
    target_displacement: float
    target_velocity: float

    def to_json(self) -> dict[str, Any]:
        """Plain values under the scene interface's names (`force` for the contact force)."""
        table = {f.name: getattr(self, f.name) for f in fields(self)}
        table["force"] = table.pop("contact_force")
        return table


@dataclass(frozen=True)
class Samples:
    """Motion at given times: arrays, or numbers for a single time; quantities from `sample`, SI from `sample_si`.

    stage: names of the law's stages, "unloading" on the elastic branch, "" without contact.
    """

    time: Any
    indentation: Any
    relative_velocity: Any
    contact_force: Any
    impactor_displacement: Any
    impactor_velocity: Any
    target_displacement: Any
    target_velocity: Any
    stage: Any


@dataclass(frozen=True)
class Accuracy:
    """requested: relative accuracy asked for, None where segments were given. estimated: bound on the relative error
    of every summary value. segments: lines a loading stage; unloading_segments: lines of the unloading, of which two
    or four times as many are drawn where contact fades out slowly; lines: in all. modes: of a target that vibrates;
    there are no lines then.

    Values smaller than a thousandth of their scale (approach velocity, maximum indentation) are judged against that
    thousandth, energies against the impact energy.
    """

    requested: float | None
    estimated: float
    segments: int
    unloading_segments: int
    lines: int
    modes: int = 0


class _Quantity:
    """A summary value as a pint quantity, or None where it does not exist."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name
        self.dimension, self.__doc__ = SUMMARY[name]

    def __get__(self, instance: History | None, owner: type) -> Any:
        if instance is None:
            return self
        value = instance.summary[self.name]
        return None if value is None else units.quantity(value, self.dimension)


@dataclass(frozen=True)
class History:
    """One impact from first touch to separation.

    summary: SI floats by the names of `SUMMARY`, None for what did not happen; the same names are attributes that
    return pint quantities. lines: the closed-form pieces of the motion, as the core recorded them; none where the
    target vibrates, and the motion is in `vibration`. Contact may then be lost and come back: contact_duration is that
    of the first contact; dent, rebound and energies are those after the last. remarks: what the run itself gave cause
    to say. Histories are equal if scene, events, summary and remarks are, to the last bit.
    """

    scene: Scene
    problem: Problem = field(repr=False, compare=False)
    lines: NDArray[Any] = field(repr=False, compare=False)
    events: tuple[Event, ...] = field(repr=False)
    outcome: Outcome
    summary: Mapping[str, float | None] = field(hash=False)
    accuracy: Accuracy
    remarks: tuple[str, ...]
    vibration: Vibration | None = field(default=None, repr=False, compare=False)

    maximum_force = _Quantity()
    maximum_indentation = _Quantity()
    time_of_maximum_indentation = _Quantity()
    time_impactor_stops = _Quantity()
    contact_duration = _Quantity()
    permanent_indentation = _Quantity()
    rebound_velocity = _Quantity()
    coefficient_of_restitution = _Quantity()
    energy_absorbed = _Quantity()
    energy_radiated = _Quantity()

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a user of these results should know, in sentences."""
        return tuple(dict.fromkeys((*self.problem.warnings, *self.remarks)))

    @property
    def duration(self) -> float:
        """Time of the last event, s; of the last line, where a load lets the contact creep on after first touch."""
        last = self.events[-1].time if self.events else 0.0
        return last or (float(self.lines["time"][-1]) * self.problem.scales.time if self.lines.size else 0.0)

    def sample_si(self, times: Any) -> Samples:
        """Motion at `times` [s, or with units; from first touch, >= 0; any shape], as SI floats.

        Exact on the lines of the march, with the true law's force at the marched indentation; on a target that
        vibrates, the integrator's interpolation. After the end of contact the impactor flies on. Raises ValueError for
        a time that is negative or not finite.
        """
        t = units.array_to_si(times, "time", bare=True)
        if not (t >= 0.0).all():
            raise ValueError("times must be finite and not before first touch (0 s)")
        order = np.argsort(t, axis=None, kind="stable")
        flat = t.reshape(-1)
        scales = self.problem.scales
        ascending = flat[order] / scales.time
        if self.vibration is not None:
            values, branches = self.vibration.sample(ascending)
        else:
            values, branches, _ = native.sample(self.problem.curve.native, self.lines, ascending)
        back = np.empty_like(order)
        back[order] = np.arange(order.size)
        motion = self.problem.motion(flat, values[back])
        names = np.array(stage_names(self.problem))[branches[back]]
        shaped = {name: column.reshape(t.shape)[()] for name, column in motion.items()}
        return Samples(time=t[()], stage=names.reshape(t.shape)[()], **shaped)

    def sample(self, times: Any) -> Samples:
        """Motion at `times` ("20 us" or a pint quantity, scalar or array), as pint quantities; see `sample_si`."""
        plain = self.sample_si(units.array_to_si(times, "time"))
        motion = {name: units.quantity(getattr(plain, name), MOTION[name][0]) for name in MOTION}
        return Samples(time=units.quantity(plain.time, "time"), stage=plain.stage, **motion)

    def to_json(self) -> dict[str, Any]:
        """Plain values, SI throughout: title, law, outcome, summary, events, effects, accuracy and warnings."""
        return {
            "title": self.scene.title,
            "law": self.problem.law.name,
            "outcome": self.outcome.value,
            "summary": {
                name: {"value": value, "units": units.si_unit(SUMMARY[name][0])} for name, value in self.summary.items()
            },
            "events": [event.to_json() for event in self.events],
            "effects": [effect.to_json() for effect in self.problem.effects],
            "accuracy": {f.name: getattr(self.accuracy, f.name) for f in fields(self.accuracy)},
            "warnings": list(self.warnings),
        }


def stage_names(problem: Problem) -> list[str]:
    """Names by the core's branch number: the law's stages, and from the end, no contact (−2) and unloading (−1)."""
    return [*problem.curve.stage_names, native.BRANCH_NAMES[native.FREE], native.BRANCH_NAMES[native.BRANCH]]
