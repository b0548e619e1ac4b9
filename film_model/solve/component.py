"""The impact as a component that the caller advances in steps, with exact events."""

from __future__ import annotations

import warnings as python_warnings
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from film_model.base import units
from film_model.base.errors import ImpactWarning, SimulationError
from film_model.base.late import Late
from film_model.base.units import format_si
from film_model.core import modal, native
from film_model.effects.choose import Choice, choose
from film_model.oblique.stepped import Pushes, SavedSliding, SlidingOutputs, SteppedFriction
from film_model.scene import DEFAULT_ACCURACY, Scene, Solver
from film_model.solve.accuracy import Linearisation, mesh_for, mesh_of, raise_failure, solver_for
from film_model.solve.history import Event, stages_at
from film_model.solve.motions import OnLines, OnMemory, OnModes, modes_for
from film_model.solve.relaxed import tolerance_for
from film_model.solve.sensed import Sensed
from film_model.solve.vibration import unused_options


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
    """What a step did: the time it reached [s], the outputs there, and the events on the way, at their exact times.
    sliding: times, s, and names, as in `History.oblique`, of the phases of friction that began, within 1 % of the
    duration of a contact; a step does not end there."""

    time: float
    outputs: Outputs
    events: tuple[Event, ...]
    sliding: tuple[tuple[float, str], ...] = ()


@dataclass(frozen=True)
class SavedState:
    """The state of a component, from `save`, for `restore`."""

    core: bytes
    start_time: float
    support_velocity: float
    support_displacement: float
    load: float
    sliding: SavedSliding | None = None


class ImpactComponent:
    """An impactor in front of its target, or in contact with it, advanced step by step.

    scene: as for `simulate`. initial_gap: distance to the target at the start, m. Accuracy or segments determine the
    mesh as in `simulate`; a pair of segments is for loading and unloading. The external force and the support velocity
    are constant during a step, so one step of dt gives the same as two of dt/2; the motion is exact on the segments of
    the march. Later contacts begin on the permanent indentation of earlier ones. Arguments may be quantities, texts
    with units, or SI floats. The scene's gravity, if simulated, is added to the external force.

    A target whose vibrations matter is followed by its natural vibrations, as many as `simulate` needs for the scene;
    it rings on between contacts, and the support moves it as a whole. `modes` is their number, and `segments` are 0.
    Viscoelastic bodies have `segments` 0, too. A step raises SimulationError if their contact closes again before it
    ended, or begins before they have recovered from the one before: see docs/effects.md.
    What `simulate` would warn about the accuracy is issued as an ImpactWarning.

    With friction in [contact], the motion along the surface is followed too, through any number of contacts, and does
    not change the normal motion: `sliding` has its outputs, and steps take tangential force, torque and velocity of the
    support. It is that of springs side by side, whose stiffness is 4 G*/E* times the slope of the law's force: exact
    for elastic contacts and balls in their dents; where a law yields in loading, one of the two models between which
    `simulate` shows the sliding velocity.

    Raises SceneError or SimulationError as `simulate` does; SimulationError for a target that is a free body.

    >>> component = fm.ImpactComponent(scene, initial_gap="1 mm")
    >>> [event.name for event in component.step("1.02 ms").events]
    ['contact_begins', 'stage_changes']
    >>> component.phase
    'loading'
    """

    def __init__(
        self,
        scene: Scene,
        *,
        initial_gap: Any = 0.0,
        accuracy: float | None = None,
        segments: int | tuple[int, int] | None = None,
        linearisation: Linearisation | None = None,
    ) -> None:
        if scene.target.free:
            raise SimulationError("a free body as target cannot be stepped: simulate() gives its motion")
        self.scene = scene
        self.choice: Choice = choose(scene)
        self.problem = self.choice.problem
        self._gap = _gap(initial_gap)
        self.modes, self.segments = 0, (0, 0)
        pair, most = (segments, max(segments)) if isinstance(segments, tuple) else (None, segments)
        solver = solver_for(scene.solver, accuracy, most, linearisation)
        if self.problem.vibrates:
            self._motion: OnLines | OnModes | OnMemory = self._on_modes(solver)
        elif self.problem.relaxation is not None:
            self._motion = self._on_memory(solver)
        else:
            self.segments, mesh = (pair, mesh_of(solver, pair)) if pair else mesh_for(self.problem, solver)
            self._motion = OnLines(self.problem, mesh)
        self._friction = None if scene.contact.friction is None else SteppedFriction(self.problem)
        self.reset()

    def _on_modes(self, solver: Solver) -> OnModes:
        warnings = unused_options(solver)
        found = modes_for(self.problem, solver.accuracy or DEFAULT_ACCURACY, warnings)
        _warn(warnings)
        self.modes = found.modes
        return OnModes(self.problem, found)

    def _on_memory(self, solver: Solver) -> OnMemory:
        _warn(unused_options(solver, "the contact of viscoelastic bodies is solved"))
        return OnMemory(self.problem, tolerance_for(self.problem, solver.accuracy or DEFAULT_ACCURACY))

    _repr_html_ = Late("film_model.methods:component_as_html")

    def __repr__(self) -> str:
        return f"ImpactComponent(law {self.problem.law.name}, {self.phase} at {self.time:g} s)"

    def initialize(self, *, time: Any = 0.0, initial_gap: Any = None, velocity: Any = None) -> None:
        """Start at `time` [s], target undeformed; gap [m] and velocity [m/s] default to those of the constructor."""
        scales, speed = self.problem.scales, self.problem.approach
        if velocity is not None:
            speed = units.to_si(velocity, "velocity", bare=True) / scales.velocity
        gap = self._gap if initial_gap is None else _gap(initial_gap)
        begin = units.to_si(time, "time", bare=True)
        self._motion.begin(speed, gap / scales.length)
        self._start_time, self._load = begin, self.problem.load
        self._support_velocity = self._support_displacement = 0.0
        if self._friction is not None:
            self._friction.begin()

    def reset(self) -> None:
        """Return to the initial state: undeformed target, no contact."""
        self.initialize()

    @property
    def vibrations(self) -> modal.Tables | None:
        """Frequencies [rad/s], shares [1/kg] and damping ratios of the vibrations in use; None without any."""
        return self._motion.tables if isinstance(self._motion, OnModes) else None

    def follow(self, vibrations: modal.Tables, rest: float, tolerance: float) -> None:
        """Restart with other vibrations of the target, such as those that an FMU contains.

        rest: compliance of those omitted, m/N. tolerance: of the core's steps. Raises SimulationError if the target
        does not vibrate.
        """
        if not isinstance(self._motion, OnModes):
            raise SimulationError("the target of this impact does not vibrate")
        scales = self.problem.scales
        self._motion.follow(vibrations, rest * scales.force / scales.length, tolerance)
        self.modes = vibrations.count
        self.reset()

    def save(self) -> SavedState:
        """A copy of the state, for `restore`."""
        support = self._support_velocity, self._support_displacement
        sliding = None if self._friction is None else self._friction.save()
        return SavedState(self._motion.save(), self._start_time, *support, self._load, sliding)

    def restore(self, saved: SavedState) -> None:
        """Return to a saved state; the same steps then give the same results to the last bit."""
        self._motion.restore(saved.core)
        self._start_time = saved.start_time
        self._support_velocity, self._support_displacement = saved.support_velocity, saved.support_displacement
        self._load = saved.load
        if self._friction is not None and saved.sliding is not None:
            self._friction.restore(saved.sliding)

    @property
    def time(self) -> float:
        """Time, s; starts at 0 unless `initialize` sets another start."""
        return self._start_time + self._motion.time * self._motion.clock

    @property
    def phase(self) -> str:
        """Phase of the motion: "approaching", "loading", "unloading", "reloading", "resting", "separated"."""
        return native.PHASES[self._motion.contact.phase]

    @property
    def largest_force(self) -> float:
        """Largest force of the present contact, or of the latest one, N."""
        return self._motion.peak * self.problem.scales.force

    @property
    def outputs(self) -> Outputs:
        """Motion now, SI."""
        time, xi, nu, recoil, shift, force, phase, contacts = self._motion.now()
        s, support = self.problem.scales, self._support_velocity
        indentation, velocity, target = xi * s.length, nu * s.velocity, recoil * s.velocity
        moved = shift * s.length + self._support_displacement
        return Outputs(
            self._start_time + time * self._motion.clock,
            indentation,
            velocity - target,
            moved + indentation,
            velocity + support,
            moved,
            target + support,
            force * s.force,
            native.PHASES[phase],
            contacts,
        )

    @property
    def sensed(self) -> Sensed | None:
        """Motion of the target's sensors now, SI; None without sensors, or where the target does not vibrate.

        As of `history.sensed_si`; the support moves them as a whole.
        """
        sensors, motion, length = self.scene.target.sensors, self._motion, self.problem.scales.length
        if not sensors or not isinstance(motion, OnModes):
            return None
        moved, rate, acceleration = length * motion.sensed()
        names, own = tuple(sensor.name for sensor in sensors), (self._support_displacement, self._support_velocity)
        return Sensed(names, np.array(self.time), moved + own[0], rate + own[1], acceleration)

    @property
    def sliding(self) -> SlidingOutputs | None:
        """Motion along the surface now, SI; None without friction in [contact]."""
        return None if self._friction is None else self._friction.outputs

    def step(
        self,
        dt: Any,
        *,
        external_force: Any = 0.0,
        support_velocity: Any = 0.0,
        tangential_force: Any = 0.0,
        torque: Any = 0.0,
        tangential_support_velocity: Any = 0.0,
        stop_at_events: bool = False,
    ) -> StepResult:
        """Advance by dt [s], or with `stop_at_events` to the next event if that comes first.

        external_force: on the impactor, positive into the target [N]; support_velocity: of the target as a whole [m/s];
        tangential_force: on the impactor's centre [N], torque: about it [N m], both in the direction in which they add
        to sliding, and tangential_support_velocity: of the target along the surface [m/s], which need friction in
        [contact]; all constant during the step. Raises ValueError for a negative time or a value that is not finite;
        SimulationError if the indentation passes the end of the contact law or the step has too many events. The
        component then keeps the state of that moment.
        """
        dt, force = _si(dt, "time"), _si(external_force, "force")
        if dt < 0.0:
            raise ValueError(f"dt: {dt:g} s must be >= 0 s")
        support = _si(support_velocity, "velocity")
        self._push(tangential_force, torque, tangential_support_velocity)
        scales, motion = self.problem.scales, self._motion
        load = self.problem.load + force / scales.force
        if load != self._load or support != self._support_velocity:
            change = (support - self._support_velocity) / scales.velocity
            motion.set_input(load, -change, -support / scales.velocity)
            self._load, self._support_velocity = load, support
        events, begun = list[Event](), list[tuple[float, str]]()
        # 1 to 6 s: a ball under a load may bounce for ever
        most = 100_000 if self._friction is None else 4_000
        motion.renew_work()
        if self._friction is not None:
            self._friction.core.steps = 0
        remaining, before = dt / motion.clock, motion.time
        end = before + remaining
        while True:
            status = self._advance(remaining, begun)
            self._support_displacement += support * (motion.time - before) * motion.clock
            before = motion.time
            if status != native.EVENT:
                raise_failure(status, self.problem, self._where() if status < 0 else "")
                break
            events.append(self._event())
            if len(events) > most:
                raise SimulationError(f"more than {most} events in one step{self._where()}: ask for a shorter one")
            remaining = max(end - before, 0.0)
            if stop_at_events:
                break
        outputs = self.outputs
        return StepResult(outputs.time, outputs, tuple(events), tuple(begun))

    def _push(self, force: Any, torque: Any, support: Any) -> None:
        pushes = Pushes(_si(force, "force"), _si(torque, "torque"), _si(support, "velocity"))
        if self._friction is not None:
            self._friction.push(pushes)
        elif any(pushes):
            raise ValueError("tangential_force, torque and tangential_support_velocity need contact.friction")

    def _advance(self, dt: float, begun: list[tuple[float, str]]) -> int:
        """Forward by dt or to the next event, with friction beside it, whose phases are added to `begun`; the core's
        status."""
        motion, before, time = self._motion, self._motion.time, self.time
        if self._friction is None:
            return motion.step(dt)
        status = motion.slide(dt, self._friction)
        self._friction.gain((motion.time - before) * motion.clock)
        begun += self._friction.begun(time)
        return status

    def _where(self) -> str:
        """When the motion failed; between viscoelastic contacts, how much of the surface has not recovered."""
        left = self._motion.left * self.problem.scales.length if isinstance(self._motion, OnMemory) else 0.0
        rest = f", with {format_si(left, 'length', 2)} of the surface not yet recovered" if left > 0.0 else ""
        return f"; at {format_si(self.time, 'time', 5)}{rest}"

    def _event(self) -> Event:
        o, contact = self.outputs, self._motion.contact
        (stage,) = stages_at(self.problem, (contact.branch,))
        motion = (o.indentation, o.relative_velocity, o.contact_force, o.impactor_displacement, o.impactor_velocity)
        return Event(native.EVENTS[contact.event], o.time, stage, *motion, o.target_displacement, o.target_velocity)


def _warn(sentences: Iterable[str]) -> None:
    for sentence in sentences:
        python_warnings.warn(sentence, ImpactWarning, stacklevel=4)


def _gap(value: Any) -> float:
    gap = units.to_si(value, "length", bare=True)
    if gap < 0.0:
        raise ValueError(f"initial_gap: {gap:g} m must be >= 0 m")
    return gap


def _si(value: Any, dimension: str) -> float:
    if type(value) is float and value - value == 0.0:
        return value
    return units.to_si(value, dimension, bare=True)
