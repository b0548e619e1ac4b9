"""Friction in any contact, by many springs beside each other that slip: for laws that yield or are damped.

The core has the springs (core/springs.py). Errors fall as one over their number and steps; :func:`tangential` estimates
them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.core import springs as core

SPRINGS = 256
STEPS = 2048

SAFETY = 2.0
"""Of the largest difference to half as many springs and steps at any time, as an estimate of the error."""


LEVELS = (64, 128, SPRINGS)
"""Springs in batches, as many as the accuracy needs; 8 steps for each, as above."""

MODELLED = 1e-3
"""Accuracy beyond which springs of a contact that yields are not refined in batches: its stiffness is less known."""


class Grip(NamedTuple):
    """The normal motion over evenly spaced times, s. force: F ≥ 0, N. radius: a, m; both 0 without contact."""

    time: Array
    force: Array
    radius: Array


class Run(NamedTuple):
    """The sliding velocity, m/s, and the friction force, N, at the times; estimated: error of the last velocity."""

    velocity: Array
    force: Array
    estimated: float


def tangential(grip: Grip, modulus: float, friction: float, mass: float, velocity: float) -> Run:
    """The tangential motion. modulus: G*, Pa. mass: m_t, kg. velocity: of sliding at first touch, m/s."""
    fine, force = run(grip, modulus, friction, mass, velocity, SPRINGS)
    half = Grip(*(column[::2] for column in grip))
    coarse, _ = run(half, modulus, friction, mass, velocity, SPRINGS // 2)
    return Run(fine, force, SAFETY * float(np.abs(fine[::2] - coarse).max()))


def run(grip: Grip, modulus: float, friction: float, mass: float, velocity: float, count: int) -> tuple[Array, Array]:
    """Sliding velocity and friction force at the times, by so many springs (core/springs.py)."""
    state = core.springs(count, modulus, float(grip.radius.max()), friction, mass, velocity)
    step = float(grip.time[1] - grip.time[0])
    velocities, forces = core.follow(state, step, grip.force[1:], grip.radius[1:])
    return np.append(velocity, velocities), np.append(0.0, forces)
