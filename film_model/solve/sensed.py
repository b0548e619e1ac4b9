"""The motion of sensors on a structure during an impact, from the recorded contact force and the structure's modes.

In a step the force is a cubic of time, in flight 0. Every mode follows it exactly from rest at first touch: by
Duhamel's integral at Gauss points while the mode turns by less than `TURNED`, and beyond by the polynomial that solves
its equation, with a free vibration beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from film_model.base.arrays import Array
from film_model.solve.modal_motion import ModalMotion
from film_model.targets import AbstractTarget
from film_model.targets.sensors import Influence

TURNED = 0.5
"""Angle up to which six Gauss points integrate to rounding; from which on the polynomial loses three digits at most."""

_POINTS, _WEIGHTS = (np.asarray(part) for part in np.polynomial.legendre.leggauss(6))
_NODES = (np.polynomial.legendre.leggauss(4)[0] + 1.0) / 2.0
_POWERS = np.linalg.inv(np.vander(_NODES, increasing=True))
"""Coefficients of θ^k of the cubic with given values at the Gauss nodes of a step."""

SAMPLES = 2001
"""Evenly spaced times of which the largest values are taken, beside those of the events."""

MOTION = {
    "displacement": ("length", "displacement of the sensor, positive along the impactor's approach"),
    "velocity": ("velocity", "velocity of the sensor"),
    "acceleration": ("acceleration", "acceleration of the sensor"),
}
"""Quantities of a sensor over time, with dimension and meaning."""


@dataclass(frozen=True)
class Sensed:
    """Motion of a target's sensors at given times, SI: arrays of the shape (sensors, times)."""

    names: tuple[str, ...]
    time: Array
    displacement: Array
    velocity: Array
    acceleration: Array


def sensed(target: AbstractTarget, vibration: ModalMotion | None, force: float, times: Array) -> Sensed:
    """The motion of a target's sensors at ascending times, s, from first touch on. force: unit of the steps', N.

    It has the vibrations that the impact was followed with; what vibrations above them add statically is left out.
    Raises ValueError if the target has no sensors, or does not vibrate.
    """
    if not target.sensors:
        raise ValueError("the target has no sensors: give them as [[target.sensors]]")
    if vibration is None:
        raise ValueError("sensors need a target whose vibrations are simulated: see the effect boundary_reflections")
    highest = float(vibration.frequency[-1]) * (1.0 + 1e-9)
    found = [_follow(target.influence(highest, sensor), vibration.segments, force, times) for sensor in target.sensors]
    return Sensed(tuple(sensor.name for sensor in target.sensors), times, *np.array(found).transpose(1, 0, 2))


def peaks_of(found: Sensed) -> dict[str, dict[str, float]]:
    """Largest absolute displacement, velocity and acceleration of each sensor, SI."""
    return {
        name: {f"maximum_{what}": float(np.abs(getattr(found, what)[k]).max()) for what in MOTION}
        for k, name in enumerate(found.names)
    }


def _follow(on: Influence, steps: Any, unit: float, times: Array) -> Array:
    """Displacement, velocity and acceleration at the times, one row each. unit: of the steps' forces, N."""
    moved, rate = np.zeros(on.frequency.size), np.zeros(on.frequency.size)
    found, first = np.zeros((3, times.size)), 0
    ends = np.append(steps["time"][1:], np.inf)
    for step, until in zip(steps, ends.tolist(), strict=True):
        force = unit * (_POWERS @ step["force"]) if step["flight"] < 0 else np.zeros(4)
        long = float(step["h"]) if np.isfinite(step["h"]) else 1.0  # at rest under a load the force is constant
        powers = force / long ** np.arange(4.0)
        end = int(np.searchsorted(times, until, "right"))
        for at in range(first, end):
            tau = float(times[at] - step["time"])
            w, v = _after(on, powers, moved, rate, tau)
            pushed = float(powers @ tau ** np.arange(4.0))
            turning = pushed - 2.0 * on.damping_ratio * on.frequency * v - on.frequency**2 * w
            found[:, at] = [float(on.factor @ part) for part in (w, v, turning)]
        first = end
        if until < np.inf:
            moved, rate = _after(on, powers, moved, rate, until - float(step["time"]))
    return found


def _after(on: Influence, force: Array, moved: Array, rate: Array, tau: float) -> tuple[Array, Array]:
    """Displacements and rates of the modes per unit of factor, tau [s] after a state, under Σ force_k t^k [N]."""
    omega, drag = on.frequency, on.damping_ratio * on.frequency
    if not force.any():
        return _free(omega, drag, moved, rate, tau)
    slow = omega * tau <= TURNED
    w, v = np.empty(omega.size), np.empty(omega.size)
    w[slow], v[slow] = _free(omega[slow], drag[slow], moved[slow], rate[slow], tau)
    nodes = (_POINTS + 1.0) * (0.5 * tau)
    pushed = 0.5 * tau * _WEIGHTS * np.polynomial.polynomial.polyval(nodes, force)
    left, own, damp = (tau - nodes)[:, None], omega[slow], drag[slow]
    more, faster = _free(own, damp, np.zeros(own.size), np.ones(own.size), left)
    w[slow] += pushed @ more
    v[slow] += pushed @ faster
    fast = ~slow
    square, damp = omega[fast] ** 2, 2.0 * drag[fast]
    a = [np.zeros(square.size)] * 6
    for k in range(3, -1, -1):  # ω² a_k + 2 ζ ω (k + 1) a_{k+1} + (k + 1)(k + 2) a_{k+2} = force_k
        a[k] = (force[k] - damp * (k + 1) * a[k + 1] - (k + 1) * (k + 2) * a[k + 2]) / square
    w[fast], v[fast] = _free(omega[fast], drag[fast], moved[fast] - a[0], rate[fast] - a[1], tau)
    w[fast] += a[0] + tau * (a[1] + tau * (a[2] + tau * a[3]))
    v[fast] += a[1] + tau * (2.0 * a[2] + tau * 3.0 * a[3])
    return w, v


def _free(omega: Array, drag: Array, moved: Array, rate: Array, tau: Any) -> tuple[Array, Array]:
    """Free vibration: w = e^(−ζωt) (w₀ cos ω_d t + (v₀ + ζω w₀) sin(ω_d t)/ω_d); of frequency 0, w₀ + v₀ t."""
    turning = np.sqrt(omega**2 - drag**2)
    sine, cosine = tau * np.sinc(turning * tau / np.pi), np.cos(turning * tau)
    fades = np.exp(-drag * tau)
    w = fades * (moved * cosine + (rate + drag * moved) * sine)
    v = fades * (rate * cosine - (omega**2 * moved + drag * rate) * sine)
    return w, v
