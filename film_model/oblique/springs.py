"""Friction in any contact, by many springs beside each other that slip: for laws that yield or are damped.

Springs at radii r share the tangential stiffness 8 G* a and the normal force like those of Popov's reduction of a
sphere, p(r) ∝ 1 − r²/a². Errors fall as one over their number and steps; :func:`tangential` estimates them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array

SPRINGS = 256
STEPS = 2048

SAFETY = 4.0
"""Of the difference to half as many springs and steps, as an estimate of the error."""


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
    fine, force = _run(grip, modulus, friction, mass, velocity, SPRINGS)
    half = Grip(*(column[::2] for column in grip))
    coarse, _ = _run(half, modulus, friction, mass, velocity, SPRINGS // 2)
    return Run(fine, force, SAFETY * abs(float(fine[-1] - coarse[-1])))


def _run(grip: Grip, modulus: float, friction: float, mass: float, v: float, count: int) -> tuple[Array, Array]:
    """By the rule of the midpoint: half a step with the force before, half with that after."""
    step, largest = float(grip.time[1] - grip.time[0]), float(grip.radius.max())
    r = (np.arange(count) + 0.5) * (largest / count)
    stiffness, square = 8.0 * modulus * largest / count, r * r
    u, q = np.zeros(count), 0.0
    velocities, forces = np.empty(grip.time.size), np.empty(grip.time.size)
    for k, (force, radius) in enumerate(zip(grip.force.tolist(), grip.radius.tolist(), strict=True)):
        if k:
            v -= 0.5 * step * q / mass
            u += v * step
        share = np.maximum(radius * radius - square, 0.0)
        whole = float(share.sum())
        if whole > 0.0:
            most = share * (friction * force / (stiffness * whole))
            np.clip(u, -most, most, out=u)
            q = stiffness * float(u.sum())
        else:
            u[:], q = 0.0, 0.0
        v -= 0.5 * step * q / mass if k else 0.0
        velocities[k], forces[k] = v, q
    return velocities, forces
