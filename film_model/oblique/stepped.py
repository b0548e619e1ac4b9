"""Friction of an impact that is advanced in steps, over any number of contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.core import sliding as core
from film_model.core import springs
from film_model.oblique.friction import refuse
from film_model.oblique.result import KINDS
from film_model.problem.problem import Problem
from film_model.scene.rolling import sliding_of


class SlidingOutputs(NamedTuple):
    """Motion along the surface at one time, SI. sliding_velocity: of the contacting point relative to the support.
    tangential_velocity: of the centre. friction_force: against sliding. tangential_impulse: of the friction force.
    friction_work: dissipated. phase: "sticks", "slips" at the rim, "slides", or "free" without contact."""

    sliding_velocity: float
    tangential_velocity: float
    spin: float
    friction_force: float
    tangential_impulse: float
    friction_work: float
    phase: str


class Pushes(NamedTuple):
    """What acts along the surface during a step. force: on the centre, N. torque: about it, N·m. support: velocity of
    the target along the surface, m/s."""

    force: float = 0.0
    torque: float = 0.0
    support: float = 0.0


@dataclass(frozen=True)
class SavedSliding:
    """A copy of the state of :class:`SteppedFriction`."""

    core: bytes
    pushes: Pushes
    gained: tuple[float, float]


class SteppedFriction:
    """The motion along the surface beside a normal motion in steps.

    Raises SimulationError for a scene whose friction is not known in steps: without moduli of both bodies, under a law
    that pulls, of viscoelastic bodies. table: of the coefficient, empty if it is constant. core: its state in the core.
    """

    def __init__(self, problem: Problem) -> None:
        scene = problem.scene
        refuse(problem)
        given = sliding_of(scene, at_rest=True)
        assert given is not None
        self._given, self._ball, scales = given, given.impactor, problem.scales
        self._along, self._spin = float(given.along), float(given.impactor.spin)
        self._velocity = float(given.ratio) * scales.velocity
        self.table: Array = np.empty((0, 2)) if given.table is None else given.pairs / (self._velocity, 1.0)
        self._force, self._time, self._curve = scales.force, scales.time, problem.curve.native
        self._mass = 1.0 / float(given.parameter * scene.effective_mass)
        self.begin()

    def begin(self) -> None:
        """Return to the start."""
        sliding = float(self._given.velocity) / self._velocity
        self.core = core.begin(self._curve, float(self._given.friction), self._mass, sliding)
        self._pushes, self._gained = Pushes(), (0.0, 0.0)

    def push(self, pushes: Pushes) -> None:
        """What acts from now on."""
        ball = self._ball
        self.core.springs.v -= (pushes.support - self._pushes.support) / self._velocity
        rate = pushes.force / float(ball.mass) + pushes.torque * float(ball.lever) / float(ball.inertia)
        self.core.springs.push = rate * self._time / self._velocity
        self._pushes = pushes

    def begun(self, time: float) -> list[tuple[float, str]]:
        """Times, s, and names of the phases that began in the last step. time: at its begin, s."""
        return [(time + begin * self._time, KINDS[kind]) for begin, kind in self.core.watch.phases]

    def gain(self, dt: float) -> None:
        """A time, s, in which what acts has acted."""
        force, torque, _ = self._pushes
        self._gained = (self._gained[0] + force * dt, self._gained[1] + torque * dt)

    @property
    def outputs(self) -> SlidingOutputs:
        """Motion now."""
        ball, now = self._ball, self.core
        impulse = now.impulse * self._force * self._time
        pushed, turned = self._gained
        work = (now.work - springs.energy(now.springs)) * self._force * self._velocity * self._time
        return SlidingOutputs(
            now.springs.v * self._velocity,
            self._along + (pushed - impulse) / float(ball.mass),
            self._spin + (turned - float(ball.lever) * impulse) / float(ball.inertia),
            now.springs.q * self._force,
            impulse,
            work,
            "free" if now.watch.phase < 0 else KINDS[now.watch.phase],
        )

    def save(self) -> SavedSliding:
        """A copy of the state."""
        return SavedSliding(bytes(self.core), self._pushes, self._gained)

    def restore(self, saved: SavedSliding) -> None:
        """Return to a saved state."""
        self.core = core.Sliding.from_buffer_copy(saved.core)
        self._pushes, self._gained = saved.pushes, saved.gained
