"""The impact as a component: stepped by someone else's clock, with exact events."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any, NamedTuple

from film_model import units
from film_model.accuracy import Linearisation, mesh_for, raise_failure
from film_model.core import native
from film_model.errors import SimulationError
from film_model.history import Event, stage_names
from film_model.problem import Problem, problem_of, refuse_vibrations
from film_model.scene import Body, Scene

_NOW = struct.Struct("9d")  # the first fields of film_state: time … force_peak
_REPORT = struct.Struct("4i")
_REPORT_AT = native.State.phase.offset
DEFAULT_SEGMENTS = (24, 48)  # a component that starts at rest has no impact to try meshes on

MOST_EVENTS = 1_000_000
"""A step with more events is refused: a ball that bounces for ever has no end of them."""


class Outputs(NamedTuple):
    """Motion at one time, SI; directions positive into the target. phase: one of `native.PHASES`."""

    time: float
    indentation: float
    relative_velocity: float
    impactor_displacement: float
    impactor_velocity: float
    target_displacement: float
    target_velocity: float
    contact_force: float
    phase: str
    contact_count: int


class StepResult(NamedTuple):
    """What a step did: the time it reached [s], the outputs there, and the events on the way, at their exact times."""

    time: float
    outputs: Outputs
    events: tuple[Event, ...]


@dataclass(frozen=True)
class SavedState:
    """Everything a component remembers; made by `save`, taken by `restore`."""

    core: bytes
    start_time: float
    support_velocity: float
    support_displacement: float
    load: float


class ImpactComponent:
    """An impactor in front of its target, or in contact with it, advanced step by step.

    scene: as for `simulate`. initial_gap: distance before first touch at the start, m. An accuracy or segments count
    chooses the mesh as for `simulate`. Between steps the external force and the support velocity are held, so a step of
    dt gives what two of dt/2 give; the motion within is exact on the lines of the march. Contacts repeat, on the dent
    that earlier ones left. Quantities, texts with units and plain SI floats are all taken. The scene's gravity, if it
    is simulated, comes on top of the external force.

    Raises SceneError or SimulationError as `simulate` does; SimulationError for a free body as target, and for one that
    vibrates.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        initial_gap: Any = 0.0,
        accuracy: float | None = None,
        segments: int | None = None,
        linearisation: Linearisation | None = None,
    ) -> None:
        if isinstance(scene.target, Body):
            raise SimulationError("a free body as target cannot be stepped: simulate() gives its motion")
        self.scene = scene
        self.problem: Problem = problem_of(scene)
        refuse_vibrations(self.problem, "an ImpactComponent")
        self._gap = _gap(initial_gap)
        self.segments, self._mesh = mesh_for(
            scene, self.problem, accuracy, segments, linearisation, fallback=DEFAULT_SEGMENTS
        )
        self._curve = self.problem.curve.native
        self.reset()

    def __repr__(self) -> str:
        return f"ImpactComponent(law {self.problem.law.name}, {self.phase} at {self.time:g} s)"

    def initialize(self, *, time: Any = 0.0, initial_gap: Any = None, velocity: Any = None) -> None:
        """Begin at `time` [s], on a spot without a dent; gap [m] and velocity [m/s] as constructed unless given."""
        start = self.problem.start
        if velocity is not None:
            start.nu = units.to_si(velocity, "velocity", bare=True) / self.problem.scales.velocity
        gap = self._gap if initial_gap is None else _gap(initial_gap)
        state = native.initial_state(self._curve, start, gap / self.problem.scales.length)
        begin = units.to_si(time, "time", bare=True)
        self.restore(SavedState(bytes(state), begin, 0.0, 0.0, self.problem.load))

    def reset(self) -> None:
        """Back to the beginning as constructed: no dent, no contact yet."""
        self.initialize()

    def save(self) -> SavedState:
        """A copy of the state."""
        support = self._support_velocity, self._support_displacement
        return SavedState(bytes(self._state), self._start_time, *support, self._load)

    def restore(self, saved: SavedState) -> None:
        """Return to a saved state; what follows is what followed then, to the last bit."""
        self._state = native.State.from_buffer_copy(saved.core)
        self._start_time = saved.start_time
        self._support_velocity, self._support_displacement = saved.support_velocity, saved.support_displacement
        self._load = saved.load

    @property
    def time(self) -> float:
        """Time, s; 0 at the beginning unless `initialize` was told otherwise."""
        return self._start_time + self._state.time * self.problem.scales.time

    @property
    def phase(self) -> str:
        """Where the impactor is: one of "approaching", "loading", "unloading", "reloading", "resting", "separated"."""
        return native.PHASES[self._state.phase]

    @property
    def outputs(self) -> Outputs:
        """Motion now, SI."""
        time, _, xi, nu, shift, force, _, _, _ = _NOW.unpack_from(self._state)
        phase, _, contacts, _ = _REPORT.unpack_from(self._state, _REPORT_AT)
        s, support = self.problem.scales, self._support_velocity
        target = self.problem.gamma * force * s.velocity
        if self._curve.compliance > 0.0:
            xi, rate, force, _, shift = native.motion(self._curve, self._state).tolist()
            target = (nu - rate) * s.velocity
        velocity = nu * s.velocity
        moved = shift * s.length + self._support_displacement
        return Outputs(
            self._start_time + time * s.time,
            xi * s.length,
            velocity - target,
            moved + xi * s.length,
            velocity + support,
            moved,
            target + support,
            force * s.force,
            native.PHASES[phase],
            contacts,
        )

    def step(
        self, dt: Any, *, external_force: Any = 0.0, support_velocity: Any = 0.0, stop_at_events: bool = False
    ) -> StepResult:
        """Advance by dt [s], or with `stop_at_events` to the next event if that comes first.

        external_force: on the impactor, into the target [N]; support_velocity: of the target as a whole [m/s]; both
        held over the step. Raises ValueError for a negative time or a number that is not finite, SimulationError when
        the contact law ends, or a ball that nothing damps bounces or swings more often than a step can follow; the
        component then stands at that moment.
        """
        dt, force = _si(dt, "time"), _si(external_force, "force")
        if dt < 0.0:
            raise ValueError(f"dt: {dt:g} s must be >= 0 s")
        support = _si(support_velocity, "velocity")
        scales, state = self.problem.scales, self._state
        load = self.problem.load + force / scales.force
        if load != self._load or support != self._support_velocity:
            change = (support - self._support_velocity) / scales.velocity
            native.set_input(state, load, -change, -support / scales.velocity)
            self._load, self._support_velocity = load, support
        events: list[Event] = []
        end, before = state.time + dt / scales.time, state.time
        remaining = dt / scales.time
        while True:
            status = native.step(self._curve, self._mesh, state, remaining)
            self._support_displacement += support * (state.time - before) * scales.time
            before = state.time
            if status != native.EVENT:
                raise_failure(status, self.problem)
                break
            events.append(self._event())
            if len(events) > MOST_EVENTS:
                raise SimulationError(f"more than {MOST_EVENTS} events in one step: ask for a shorter one")
            remaining = max(end - state.time, 0.0)
            if stop_at_events:
                break
        outputs = self.outputs
        return StepResult(outputs.time, outputs, tuple(events))

    def _event(self) -> Event:
        o = self.outputs
        stage = stage_names(self.problem)[self._state.branch]
        motion = (o.indentation, o.relative_velocity, o.contact_force, o.impactor_displacement, o.impactor_velocity)
        return Event(native.EVENTS[self._state.event], o.time, stage, *motion, o.target_displacement, o.target_velocity)


def _gap(value: Any) -> float:
    gap = units.to_si(value, "length", bare=True)
    if gap < 0.0:
        raise ValueError(f"initial_gap: {gap:g} m must be >= 0 m")
    return gap


def _si(value: Any, dimension: str) -> float:
    if type(value) is float and value - value == 0.0:
        return value
    return units.to_si(value, dimension, bare=True)
