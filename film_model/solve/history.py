"""The result of one impact: events, summary, and the motion at any time, as quantities."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base import units
from film_model.base.arrays import Array
from film_model.base.errors import Outcome, SimulationError, did_you_mean, shown
from film_model.base.foreign import Dataset, Figure
from film_model.base.late import Late
from film_model.core import native
from film_model.effects.choose import Choice
from film_model.effects.effect import Effect
from film_model.problem.model_intervals import ModelInterval, model_interval, no_interval
from film_model.problem.problem import Problem
from film_model.problem.summary import SUMMARY
from film_model.scene import Scene

if TYPE_CHECKING:
    from film_model.base.text import Text
    from film_model.oblique.result import Oblique
    from film_model.solve.closed_form import ClosedForm
    from film_model.solve.derivatives import Derivatives
    from film_model.solve.modal_motion import ModalMotion
    from film_model.solve.relaxed import Relaxed
    from film_model.solve.sensed import Sensed
    from film_model.solve.spectrum import Spectrum

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


class Event(NamedTuple):
    """An event and the motion at its time, SI floats. stage: of the law, or "unloading", or "" (no contact).

    >>> fm.simulate(scene).events[0].name
    'contact_begins'
    """

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

    def __repr__(self) -> str:
        shown = ("indentation", "relative_velocity", "contact_force")
        values = {name: units.format_si(getattr(self, name), MOTION[name][0]) for name in shown}
        motion = ", ".join(f"{name.replace('_', ' ')} {value}" for name, value in values.items())
        return f"Event({self.name} at {units.format_si(self.time, 'time')}: {motion})"

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON (`force` is the contact force)."""
        table = self._asdict()
        table["force"] = table.pop("contact_force")
        return table


@dataclass(frozen=True, eq=False)
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

    __hash__ = None  # pyright: ignore[reportAssignmentType]  # arrays have none

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Samples):
            return NotImplemented
        pairs = ((getattr(self, one.name), getattr(other, one.name)) for one in fields(self))
        return np.shape(self.time) == np.shape(other.time) and all(bool(np.all(a == b)) for a, b in pairs)


@dataclass(frozen=True)
class Accuracy:
    """Requested and estimated accuracy, and the size of the mesh.

    requested: relative accuracy; None if segments were given. estimated: bound on the relative error of every summary
    value. segments: per loading stage. unloading_segments: of the unloading; the core takes two or four times as many
    if the force falls to 0 slowly. lines: segments in total; steps of viscoelastic bodies, which have no segments.
    modes: number of modes of a target that vibrates; there are no segments then.

    The error of a velocity or indentation is relative to at least a thousandth of the approach velocity or maximum
    indentation, that of an energy to the impact energy.
    """

    requested: float | None
    estimated: float
    segments: int
    unloading_segments: int
    lines: int
    modes: int = 0


@dataclass(frozen=True)
class History:
    """One impact from first touch to separation.

    summary: SI floats by the names of `SUMMARY`, None for what did not happen; the same names are attributes that
    return pint quantities. lines: the segments as recorded by the core; empty if the target vibrates or a material is
    viscoelastic, since the motion is then in `vibration` or `relaxed`. On a target that vibrates several contacts may
    follow each other: contact_duration is that of the first; permanent indentation, rebound and energies are those
    after the last. remarks: warnings of this run. derivatives: those that were asked for.
    oblique: the tangential part of an impact at an angle or with spin, if [contact] has a friction.
    Histories are equal if scene, events, summary and remarks are equal to the last bit.

    >>> history = fm.simulate(scene, accuracy=1e-6)
    >>> [event.name for event in history.events][-2:]
    ['impactor_stops', 'contact_ends']
    >>> print(f"{history.sample('20 us').contact_force.to('N'):.1f~P}")
    918.5 N
    """

    scene: Scene
    choice: Choice = field(repr=False, compare=False)
    lines: NDArray[Any] = field(repr=False, compare=False)
    events: tuple[Event, ...] = field(repr=False)
    outcome: Outcome
    summary: Mapping[str, float | None] = field(hash=False)
    accuracy: Accuracy
    remarks: tuple[str, ...]
    vibration: ModalMotion | None = field(default=None, repr=False, compare=False)
    relaxed: Relaxed | None = field(default=None, repr=False, compare=False)
    derivatives: Derivatives | None = field(default=None, repr=False, compare=False)
    oblique: Oblique | None = None

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...  # the summary values, added below the class
        def plot(self, path: str | os.PathLike[str] | None = None) -> Figure: ...
        def to_dataset(self, samples: int = 201) -> Dataset: ...
        def citations(self) -> Text: ...
        def _repr_html_(self) -> str: ...
    else:
        plot = Late("film_model.methods:plot")
        to_dataset = Late("film_model.methods:to_dataset")
        citations = Late("film_model.methods:citations")
        _repr_html_ = Late("film_model.methods:history_as_html")

    def __repr__(self) -> str:
        shown = (
            ("maximum_force", "peak"),
            ("contact_duration", "contact"),
            ("coefficient_of_restitution", "restitution"),
        )
        values = ((word, self.summary[name], SUMMARY[name][0]) for name, word in shown)
        said = ", ".join(f"{word} {units.format_si(value, kind)}" for word, value, kind in values if value is not None)
        return f"History({self.problem.law.name}: {said}; {self.outcome.value})"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the law, about effects that are not modelled, and of this run."""
        own = () if self.derivatives is None else self.derivatives.warnings
        sliding = () if self.oblique is None else self.oblique.warnings(self.scene.solver.accuracy)
        return tuple(dict.fromkeys((*self.choice.warnings, *self.remarks, *own, *sliding)))

    @property
    def problem(self) -> Problem:
        """The dimensionless problem."""
        return self.choice.problem

    @property
    def effects(self) -> tuple[Effect, ...]:
        """Every effect with the number that decided."""
        return self.choice.effects

    @cached_property
    def intervals(self) -> Mapping[str, ModelInterval]:
        """Of the summary values of which measurements of this kind are known: the 90 % interval of the model, SI."""
        found = {name: model_interval(self.problem, name, value) for name, value in self.summary.items()}
        return {name: interval for name, interval in found.items() if interval is not None}

    @cached_property
    def evidence(self) -> Mapping[str, str]:
        """The measurements that each interval comes from, and why a value has none though others of its kind have."""
        found = {name: no_interval(self.problem, name) for name in self.summary}
        return {name: said for name, said in found.items() if said} | {n: i.evidence for n, i in self.intervals.items()}

    def interval(self, name: str) -> tuple[Any, Any, str] | None:
        """The 90 % interval of the model of a summary value: two quantities, and the measurements that it comes from.

        None where no measurements of this kind are known. It stands beside the numerical error, `accuracy`.
        Raises ValueError for a name that is not in the summary.

        >>> history = fm.simulate(scene)
        >>> history.interval("maximum_force") is None
        True
        """
        if name not in SUMMARY:
            raise ValueError(f"{shown(name)} is no summary value{did_you_mean(name, SUMMARY)}")
        found = self.intervals.get(name)
        if found is None:
            return None
        low, high = (units.quantity(end, SUMMARY[name][0]) for end in (found.low, found.high))
        return low, high, found.evidence

    def sensed_si(self, times: Any) -> Sensed:
        """Motion of the target's sensors at ascending `times` [s, from first touch], SI; see `film_model.solve.sensed`.

        Raises ValueError if the target has no sensors or its vibrations are not simulated, or for wrong times.
        """
        from film_model.solve.sensed import sensed

        t = units.array_to_si(times, "time", bare=True)
        if t.ndim != 1 or not (t >= 0.0).all() or (np.diff(t) < 0.0).any():
            raise ValueError("times must be a list that ascends from 0 s, first touch, or later")
        return sensed(self.problem, self.vibration, t, self.accuracy.requested)

    def spectrum(self, frequencies: Any = None) -> Spectrum:
        """The force, and the response of a structure that vibrates, over frequency; see `film_model.solve.spectrum`.

        Raises SimulationError if the contact has not ended, and ValueError for wrong frequencies.
        """
        from film_model.solve.sensed import force_of_steps
        from film_model.solve.spectrum import SAMPLES, spectrum_of

        if not self.events or self.events[-1].name != "contact_ends":
            raise SimulationError("the contact does not end: its force has no spectrum")
        times, on = np.linspace(0.0, self.duration, SAMPLES + 1), self.vibration
        if on is None:
            return spectrum_of(times, self.sample_si(times).contact_force, None, frequencies)
        force = force_of_steps(on.segments, float(self.problem.scales.force), times)
        return spectrum_of(times, force, self.scene.target, frequencies)

    @cached_property
    def sensor_peaks(self) -> Mapping[str, Mapping[str, float]]:
        """Largest absolute displacement, velocity, acceleration and, where wanted, strains and bending stress of each
        sensor, SI; empty if none is simulated. See `film_model.solve.sensed.Peaks`."""
        sensors, on = self.scene.target.sensors, self.vibration
        if not sensors or on is None:
            return {}
        from film_model.solve.sensed import Peaks, quantities_of, replay_of  # which takes a tenth of a run without

        peaks = Peaks(self.scene.target, on.highest)
        replay = replay_of(self.problem, on, self.accuracy.requested)
        found = peaks.of(on.segments, float(self.problem.scales.force), self.duration, replay)
        names = [f"maximum_{name}" for name in quantities_of(self.scene.target)]
        return {
            s.name: {name: value for name, value in zip(names, values, strict=True) if value == value}
            for s, values in zip(sensors, found.T.tolist(), strict=True)
        }

    @property
    def vibration_energy_by_mode(self) -> Array | None:
        """Energy of each natural vibration at the end, without membrane forces, J, in the order of
        `vibration.frequency`; None without modes."""
        return None if self.vibration is None else self.vibration.energies * self.problem.scales.energy

    @property
    def closed_form(self) -> ClosedForm:
        """The motion as tables of plain numbers; empty for viscoelastic bodies."""
        from film_model.solve.closed_form import ClosedForm

        on = self.vibration
        if on is not None:
            return ClosedForm.of_modes(on.tables, on.segments, on.flights)
        return ClosedForm({"segment": self.lines}, self.problem.curve.native.compliance)

    @property
    def duration(self) -> float:
        """Time of the last event, s; of the last segment, if the only event is first touch."""
        last = self.events[-1].time if self.events else 0.0
        return last or (float(self.lines["time"][-1]) * self.problem.scales.time if self.lines.size else 0.0)

    def sample_si(self, times: Any) -> Samples:
        """Motion at `times` [s, or with units; from first touch, >= 0; any shape], as SI floats.

        Exact on the segments of the march; the force is the law's at that indentation. On a target that vibrates, the
        polynomial of degree 7 of each step in contact, and the modes' closed form in flight. Of viscoelastic bodies,
        the motion under the cubic force of each step, and the force of that motion. After the end of contact the
        impactor moves freely. Raises ValueError for a time that is negative or not finite.
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
        elif self.relaxed is not None:
            values, branches = self.relaxed.sample(ascending)
        else:
            values, branches, _ = native.sample(self.problem.curve.native, self.lines, ascending)
        back = np.empty_like(order)
        back[order] = np.arange(order.size)
        motion = self.problem.motion(flat, values[back].T)
        names = np.array(stage_names(self.problem))[branches[back]]
        shaped = {name: column.reshape(t.shape)[()] for name, column in motion.items()}
        return Samples(time=t[()], stage=names.reshape(t.shape)[()], **shaped)

    def sample(self, times: Any) -> Samples:
        """Motion at `times` ("20 us" or a pint quantity, scalar or array), as pint quantities; see `sample_si`."""
        plain = self.sample_si(units.array_to_si(times, "time"))
        motion = {name: units.quantity(getattr(plain, name), MOTION[name][0]) for name in MOTION}
        return Samples(time=units.quantity(plain.time, "time"), stage=plain.stage, **motion)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, SI throughout: title, law, outcome, summary, events, effects, accuracy and warnings."""
        found = {} if self.derivatives is None else {"derivatives": self.derivatives.to_dict()}
        return {
            "title": self.scene.title,
            "law": self.problem.law.name,
            "outcome": self.outcome.value,
            "summary": {
                name: {"value": value, "units": units.si_unit(SUMMARY[name][0]), **self._evidence(name)}
                for name, value in self.summary.items()
            },
            **found,
            **({} if self.oblique is None else {"oblique": self.oblique.to_dict()}),
            **({"sensors": self.sensor_peaks} if self.sensor_peaks else {}),
            "events": [event.to_dict() for event in self.events],
            "effects": [effect.to_dict() for effect in self.effects],
            "accuracy": {f.name: getattr(self.accuracy, f.name) for f in fields(self.accuracy)},
            "warnings": list(self.warnings),
        }

    def interval_text(self, name: str) -> str:
        """What is printed behind a summary value about its interval, or why it has none; often nothing."""
        if name in self.intervals:
            return self.intervals[name].text(SUMMARY[name][0])
        return f", {self.evidence[name]}" if name in self.evidence else ""

    def _evidence(self, name: str) -> dict[str, Any]:
        """The interval of a summary value and its evidence, or why it has none, for JSON; often nothing."""
        found = self.intervals.get(name)
        said = {"evidence": self.evidence[name]} if name in self.evidence else {}
        return said if found is None else {"interval": [found.low, found.high], **said}

    def to_json(self) -> str:
        """The same values as the text of one JSON object."""
        import json

        return json.dumps(self.to_dict(), indent=2, ensure_ascii=False, allow_nan=False)


units.add_quantities(History, SUMMARY, lambda history, name: history.summary[name])


def stage_names(problem: Problem) -> list[str]:
    """Names by the core's branch number: the law's stages, then no contact (index −2) and unloading (index −1)."""
    return [*problem.curve.stage_names, native.BRANCH_NAMES[native.FREE], native.BRANCH_NAMES[native.BRANCH]]


def stages_at(problem: Problem, branches: Iterable[int]) -> list[str]:
    """Names of branches of the core; a stretched stage is unloading."""
    names = stage_names(problem)
    return [names[branch if branch >= native.FREE else native.BRANCH] for branch in branches]
