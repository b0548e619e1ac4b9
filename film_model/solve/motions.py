"""The motions that a component advances: on the lines of the core's march, on a target's natural vibrations, and
in contact of viscoelastic bodies."""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Generic, TypeAlias, TypeVar

from film_model.base.arrays import Array
from film_model.core import modal, native, relaxing
from film_model.core import sliding as core
from film_model.oblique.stepped import SteppedFriction
from film_model.problem.problem import Problem
from film_model.solve.sensed import weights_of
from film_model.solve.vibration import Vibration, vibrate

_NOW = struct.Struct("9d")  # the first fields of film_state: time … force_peak
_REPORT = struct.Struct("4i")
_REPORT_AT = native.State.phase.offset

FALLBACK_VELOCITY = 1.0
"""Of the impact that determines the vibrations of a component without one, over the velocity scale."""


Now: TypeAlias = tuple[float, float, float, float, float, float, int, int]
"""The motion at one time: time, ξ, ν, velocity and displacement of the struck point, f, phase, number of contacts."""


class OnLines:
    """The core's march on a mesh, in steps. clock: the unit of its times, s. mesh: of its lines."""

    def __init__(self, problem: Problem, mesh: native.Mesh) -> None:
        self.clock = problem.scales.time
        self._problem, self.mesh, self._curve = problem, mesh, problem.curve.native

    def begin(self, nu: float, gap: float) -> None:
        """Start with a velocity at a distance to the target."""
        start = native.Start.from_buffer_copy(self._problem.start)
        start.nu = nu
        self._state = native.initial_state(self._curve, start, gap)

    def step(self, dt: float) -> int:
        """Forward by dt or to the next event; the core's status."""
        return native.step(self._curve, self.mesh, self._state, dt)

    def slide(self, dt: float, friction: SteppedFriction) -> int:
        """As :meth:`step`, with the motion along the surface."""
        begin = native.State.from_buffer_copy(self._state)
        status = self.step(dt)
        if status < 0:
            return status
        slid = core.slide(self._curve, self.mesh, begin, self._state, friction.table, friction.core)
        return slid if slid < 0 else status

    def renew_work(self) -> None:
        """Begin a step of the caller's, whose work is limited."""

    def set_input(self, load: float, nu_change: float, stop_velocity: float) -> int:
        """Change load, velocity (by a step of the support) and stop velocity; the core's status."""
        return native.set_input(self._state, load, nu_change, stop_velocity)

    @property
    def time(self) -> float:
        """Time since the start."""
        return self._state.time

    @property
    def contact(self) -> native.State:
        """The contact's state: the latest event, the law's branch after it, the phase."""
        return self._state

    @property
    def peak(self) -> float:
        """Largest force of the latest contact."""
        return self._state.force_peak

    def now(self) -> Now:
        """The motion now."""
        time, _, xi, nu, shift, force, _, _, _ = _NOW.unpack_from(self._state)
        phase, _, contacts, _ = _REPORT.unpack_from(self._state, _REPORT_AT)
        recoil = self._problem.gamma * force
        if self._curve.compliance > 0.0:
            xi, rate, force, _, shift = native.motion(self._curve, self._state).tolist()
            recoil = nu - rate
        return time, xi, nu, recoil, shift, force, phase, contacts

    def save(self) -> bytes:
        """The whole state."""
        return bytes(self._state)

    def restore(self, saved: bytes) -> None:
        """Return to a saved state."""
        self._state = native.State.from_buffer_copy(saved)


Motion = TypeVar("Motion", modal.Motion, relaxing.Motion)


class _InOneMotion(ABC, Generic[Motion]):
    """A contact that the core advances as a whole, `_motion`, which saves itself."""

    _motion: Motion

    def renew_work(self) -> None:
        """Begin a step of the caller's, whose work is limited."""

    def step(self, dt: float) -> int:
        """Forward by dt or to the next event; the core's status."""
        return self._motion.step(dt)

    def slide(self, dt: float, friction: SteppedFriction) -> int:
        """As :meth:`step`, with the motion along the surface; not of viscoelastic bodies."""
        assert isinstance(self._motion, modal.Motion)
        return core.slide_on_modes(self._motion, dt, friction.table, friction.core)

    def set_input(self, load: float, nu_change: float, stop_velocity: float) -> int:
        """Change load, velocity (by a step of the support) and stop velocity; the core's status."""
        return self._motion.set_input(load, nu_change, stop_velocity)

    @property
    @abstractmethod
    def time(self) -> float:
        """Time since the start."""

    @property
    @abstractmethod
    def contact(self) -> native.State | relaxing.State:
        """The contact's state: the latest event, the law's branch after it, the phase."""

    def now(self) -> Now:
        """The motion now."""
        xi, rate, force, nu, shift = self._motion.values().tolist()
        contact = self.contact
        return self.time, xi, nu, nu - rate, shift, force, contact.phase, contact.contacts

    def save(self) -> bytes:
        """The whole state."""
        return self._motion.save()

    def restore(self, saved: bytes) -> None:
        """Return to a saved state."""
        self._motion.restore(saved)


class OnModes(_InOneMotion[modal.Motion]):
    """A contact on a target's natural vibrations: as many, and in steps as short, as the impact `found` needs. weights:
    of `weights_of`."""

    clock = 1.0

    def __init__(self, problem: Problem, found: Vibration) -> None:
        self._start = modal.Start.from_buffer_copy(found.start)
        self._start.load = problem.load
        self.tables, self._curve = found.tables, found.curve
        self.weights = weights_of(problem.scene.target, found.tables, found.highest)

    def follow(self, tables: modal.Tables, rest: float, tolerance: float) -> None:
        """From the next `begin`, other vibrations; rest: compliance of the omitted ones, in the units of the march."""
        self.tables, self._start.rest, self._start.tolerance = tables, rest, tolerance

    def renew_work(self) -> None:
        """Begin a step of the caller's, whose work is limited."""
        self._motion.state.steps = 0

    def begin(self, nu: float, gap: float) -> None:
        """Start with a velocity at a distance to the target, which is at rest."""
        start = modal.Start.from_buffer_copy(self._start)
        start.nu = nu
        self._motion = modal.Motion(self.tables, self._curve, start, gap)

    @property
    def time(self) -> float:
        """Time since the start, s."""
        return self._motion.state.time + self._motion.state.tau

    def sensed(self) -> Array:
        """Displacement, velocity and acceleration of each sensor now: (3, sensors)."""
        return self._motion.sensed(self.weights)

    @property
    def contact(self) -> native.State:
        """The contact's state: the latest event, the law's branch after it, the phase."""
        return self._motion.state.contact

    @property
    def peak(self) -> float:
        """Largest force of the latest contact."""
        return self._motion.state.contact.force_peak


class OnMemory(_InOneMotion[relaxing.Motion]):
    """A contact of viscoelastic bodies, in steps. clock: the unit of its times, s."""

    def __init__(self, problem: Problem, tolerance: float) -> None:
        assert problem.relaxation is not None
        self.clock, self._problem, self._tolerance = problem.scales.time, problem, tolerance
        self._law = problem.relaxation.law(self.clock)

    def begin(self, nu: float, gap: float) -> None:
        """Start with a velocity at a distance to the target."""
        start = native.Start.from_buffer_copy(self._problem.start)
        start.nu = nu
        self._motion = relaxing.Motion(self._law, start, self._tolerance, gap)

    @property
    def left(self) -> float:
        """Depth that the surface has not yet recovered since the last contact."""
        return self._motion.left

    @property
    def time(self) -> float:
        """Time since the start."""
        return self._motion.time

    @property
    def contact(self) -> relaxing.State:
        """The contact's state: the latest event, the branch after it, the phase."""
        return self._motion.state

    @property
    def peak(self) -> float:
        """Largest force of the latest contact."""
        return self._motion.state.peak


def modes_for(problem: Problem, accuracy: float, warnings: list[str]) -> Vibration:
    """The impact with the vibrations that the accuracy needs: that of the scene, or where nothing moves that with the
    `FALLBACK_VELOCITY`."""
    moves = problem.approach > 0.0 or problem.load > 0.0
    problem = problem if moves else replace(problem, approach=FALLBACK_VELOCITY)
    if problem.stretches:
        warnings.append(f"membrane forces of the {problem.scene.target.kind} are left out of motions in steps")
        problem = replace(problem, stretches=False)
    return vibrate(problem, problem.scene.target, accuracy, warnings, recorded=False)[0]
