"""The motion of sensors on a structure during an impact, from the recorded contact force and the structure's modes.

In a step the force is a cubic of time, in flight 0. Every mode follows it exactly from rest at first touch: by
Duhamel's integral at Gauss points while the mode turns by less than `TURNED`, and beyond by the polynomial that solves
its equation, with a free vibration beside it. The largest motions are those of the same modes under a force that is
linear between even times, for which Duhamel's integral is one convolution, whatever the number of modes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.base.errors import CoreError
from film_model.base.threads import one_thread
from film_model.core.modal import Motion, Start, Tables
from film_model.core.native import OK, Curve
from film_model.problem.problem import Problem
from film_model.scene import DEFAULT_ACCURACY
from film_model.solve.modal_motion import ModalMotion
from film_model.solve.structures import CARRIED, modes_of
from film_model.solve.vibration import Vibration, vibrate
from film_model.targets import AbstractTarget, Modes
from film_model.targets.surface_strain import bending_stress

TURNED = 0.5
"""Angle of a step up to which six Gauss points integrate to rounding, and from which on the polynomial loses at most
three digits of the motion at its end."""

_POINTS, _WEIGHTS = (np.asarray(part) for part in np.polynomial.legendre.leggauss(6))
_NODES = (np.polynomial.legendre.leggauss(4)[0] + 1.0) / 2.0
_POWERS = np.linalg.inv(np.vander(_NODES, increasing=True))
"""Coefficients of θ^k of the cubic with given values at the Gauss nodes of a step."""

IN_CONTACT = 2048
"""Least number of even times while there is contact, of which the largest motions are taken: a force that is linear
between them differs by 1e-6 of itself where it is a half-sine."""

MOST_TIMES = 2**14
"""Number of even times in all, or up to 1.2 times as many, where a smaller part of them is in contact."""

MOTION = {
    "displacement": ("length", "displacement of the sensor, positive along the impactor's approach"),
    "velocity": ("velocity", "velocity of the sensor"),
    "acceleration": ("acceleration", "acceleration of the sensor"),
}
"""Quantities of a sensor over time, with dimension and meaning."""

STRAIN = {
    "strain_x": (
        "dimensionless",
        "strain along x at the face away from the impactor; on a structure of the gauge",
    ),
    "strain_y": ("dimensionless", "strain along y at the same face"),
    "bending_stress": ("pressure", "largest principal stress: pulls at one face and presses at the other"),
}
"""The same of sensors with strain."""


def quantities_of(target: AbstractTarget) -> dict[str, tuple[str, str]]:
    """The quantities that the sensors of a target have: with strains if one has them."""
    return MOTION | STRAIN if any(sensor.strain for sensor in target.sensors or ()) else MOTION


@dataclass(frozen=True)
class Sensed:
    """Motion of a target's sensors at given times, SI: arrays of the shape (sensors, times); (sensors,) now. Strains
    are empty if no sensor has them, and NaN where one has none."""

    names: tuple[str, ...]
    time: Array
    displacement: Array
    velocity: Array
    acceleration: Array
    strain_x: Array = field(default_factory=lambda: np.zeros((0, 0)))
    strain_y: Array = field(default_factory=lambda: np.zeros((0, 0)))
    bending_stress: Array = field(default_factory=lambda: np.zeros((0, 0)))


def sensed(problem: Problem, vibration: ModalMotion | None, times: Array, accuracy: float | None = None) -> Sensed:
    """The motion of a target's sensors at ascending times, s, from first touch on. accuracy: as of :func:`replay_of`.

    It has the vibrations that the impact was followed with; what vibrations above them add statically is left out.
    Raises ValueError if the target has no sensors, or does not vibrate.
    """
    target = problem.scene.target
    if not target.sensors:
        raise ValueError("the target has no sensors: give them as [[target.sensors]]")
    if vibration is None:
        raise ValueError("sensors need a target whose vibrations are simulated: see the effect boundary_reflections")
    if (replay := replay_of(problem, vibration, accuracy)) is not None:
        found = replay(times)
    else:
        modes, force = _with_strain(target.modes(vibration.highest)), float(problem.scales.force)
        found = _follow(modes, vibration.segments, force, times)
    return Sensed(tuple(sensor.name for sensor in target.sensors), times, *split_rows(target, found))


def replay_of(problem: Problem, on: ModalMotion, accuracy: float | None) -> Callable[[Array], Array] | None:
    """What follows an impact with membrane forces once more: :func:`replayed` at times; None for others. accuracy: with
    which it was simulated, None for the default; a motion from a file is simulated again."""
    if not problem.stretches:
        return None
    target = problem.scene.target
    if not isinstance(on, Vibration):
        on = vibrate(problem, target, accuracy or DEFAULT_ACCURACY, [], recorded=False)[0]
    return partial(replayed, target, on.tables, on.curve, on.start, on.highest)


def replayed(target: AbstractTarget, tables: Tables, curve: Curve, start: Start, highest: float, times: Array) -> Array:
    """The motion of all rows, as of :func:`_follow`, with membrane forces: the impact is followed once more."""
    modes, motion = _with_strain(modes_of(target, highest, CARRIED)[0]), Motion(tables, curve, start)
    weights, found = np.zeros((len(modes.factor), tables.count)), np.empty((3, len(modes.factor), times.size))
    weights[:, : modes.frequency.size] = modes.factor / modes.share
    state = motion.state
    for k, time in enumerate(times.tolist()):
        while (left := time - (state.time + state.tau)) > 0.0:
            state.steps = 0  # the limit of work is for each step
            if (status := motion.step(left)) < 0:
                raise CoreError(f"the motion of the sensors cannot be followed beyond {state.time:.4g} s", status)
            if status == OK:
                break
        found[:, :, k] = motion.sensed(weights)
    return math.sqrt(start.stretch) * found


def _with_strain(modes: Modes) -> Modes:
    """The modes with the rows of strains among the factors."""
    return replace(modes, factor=np.vstack([modes.factor, modes.strain])) if modes.strain.size else modes


def split_rows(target: AbstractTarget, found: Array) -> Array:
    """The quantities of `quantities_of`, (quantities, sensors, times), from the motion of all rows."""
    sensors = target.sensors or ()
    moved, chosen = found[:, : len(sensors)], [k for k, sensor in enumerate(sensors) if sensor.strain]
    if not chosen:
        return moved
    strains = np.full(moved.shape, np.nan)
    along, across, *stresses = target.strains(found[0, len(sensors) :])
    strains[:, chosen] = along, across, bending_stress(*stresses)
    return np.concatenate([moved, strains])


def _follow(on: Modes, steps: Any, unit: float, times: Array) -> Array:
    """Displacement, velocity and acceleration of each sensor at the times. unit: of the steps' forces, N."""
    most_numbers = 1_000_000  # numbers of modes at several times that are computed together: 8 MB
    moved, rate = np.zeros(on.frequency.size), np.zeros(on.frequency.size)
    found, first = np.zeros((3, len(on.factor), times.size)), 0
    total, damp, square = on.factor.sum(axis=1), 2.0 * on.damping_ratio * on.frequency, on.frequency**2
    together = max(most_numbers // on.frequency.size, 1)
    ends = np.append(steps["time"][1:], np.inf)
    for step, until in zip(steps, ends.tolist(), strict=True):
        powers, begin = _cubic(step, unit), float(step["time"])
        end = int(np.searchsorted(times, until, "right"))
        for part in range(first, end, together):
            at = slice(part, min(part + together, end))
            tau = times[at] - begin
            w, v = _after(on, powers, moved, rate, tau)
            pushed = np.polynomial.polynomial.polyval(tau, powers)
            found[0, :, at], found[1, :, at] = on.factor @ w.T, on.factor @ v.T
            found[2, :, at] = total[:, None] * pushed - on.factor @ (damp * v + square * w).T
        first = end
        if until < np.inf:
            (moved,), (rate,) = _after(on, powers, moved, rate, np.array([until - begin]))
    return found


def _cubic(steps: Any, unit: float) -> Array:
    """Coefficients of the force in one step or several, N/s^k, 0 in flight; at rest under a load it is constant."""
    long = np.where(np.isfinite(steps["h"]), steps["h"], 1.0)[..., None]
    force = np.where(steps["flight"][..., None] < 0, unit * (steps["force"] @ _POWERS.T), 0.0)
    return force / long ** np.arange(4.0)


def weights_of(target: AbstractTarget, tables: Tables, highest: float) -> Array:
    """Deflection of each mode in use at the sensors over that at the struck point: (sensors, modes). highest: frequency
    up to which the target's modes are in use, rad/s; a mode that stands for those above moves no sensor."""
    found = np.zeros((len(target.sensors or ()), tables.count))
    if not target.sensors:
        return found
    modes = target.modes(highest).merged()
    found[:, : modes.frequency.size] = modes.factor / modes.share
    return found


def force_of_steps(steps: Any, unit: float, times: Array) -> Array:
    """The contact force of recorded segments at ascending times from first touch on, s, N. unit: of the steps' forces,
    N."""
    counts = np.diff(np.searchsorted(times, steps["time"]), append=times.size)  # times are many more than steps
    (p0, p1, p2, p3), tau = np.repeat(_cubic(steps, unit).T, counts, axis=1), times - np.repeat(steps["time"], counts)
    return ((p3 * tau + p2) * tau + p1) * tau + p0


def _after(on: Modes, force: Array, moved: Array, rate: Array, tau: Array) -> tuple[Array, Array]:
    """Displacements and rates of the modes per unit of factor, (times, modes), at times tau [s] after a state, under
    Σ force_k t^k [N]."""
    omega, drag, tau = on.frequency, on.damping_ratio * on.frequency, tau[:, None]
    if not force.any():
        return _free(omega, drag, moved, rate, tau)
    w, v = np.empty((2, tau.size, omega.size))
    slow = omega * tau.max() <= TURNED
    w[:, slow], v[:, slow] = _free(omega[slow], drag[slow], moved[slow], rate[slow], tau)
    nodes = (_POINTS + 1.0)[:, None, None] * (0.5 * tau)
    pushed = 0.5 * tau * _WEIGHTS[:, None, None] * np.polynomial.polynomial.polyval(nodes, force)
    more, faster = _free(omega[slow], drag[slow], 0.0, 1.0, tau - nodes)
    w[:, slow] += (pushed * more).sum(axis=0)
    v[:, slow] += (pushed * faster).sum(axis=0)
    fast = ~slow
    square, damp = omega[fast] ** 2, 2.0 * drag[fast]
    a = [np.zeros(square.size)] * 6
    for k in range(3, -1, -1):  # ω² a_k + 2 ζ ω (k + 1) a_{k+1} + (k + 1)(k + 2) a_{k+2} = force_k
        a[k] = (force[k] - damp * (k + 1) * a[k + 1] - (k + 1) * (k + 2) * a[k + 2]) / square
    w[:, fast], v[:, fast] = _free(omega[fast], drag[fast], moved[fast] - a[0], rate[fast] - a[1], tau)
    w[:, fast] += a[0] + tau * (a[1] + tau * (a[2] + tau * a[3]))
    v[:, fast] += a[1] + tau * (2.0 * a[2] + tau * 3.0 * a[3])
    return w, v


def _free(omega: Array, drag: Array, moved: Any, rate: Any, tau: Any) -> tuple[Array, Array]:
    """Free vibration: w = e^(−ζωt) (w₀ cos ω_d t + (v₀ + ζω w₀) sin(ω_d t)/ω_d); of frequency 0, w₀ + v₀ t."""
    turning = np.sqrt(omega**2 - drag**2)
    sine, cosine = tau * np.sinc(turning * tau / np.pi), np.cos(turning * tau)
    fades = np.exp(-drag * tau)
    w = fades * (moved * cosine + (rate + drag * moved) * sine)
    v = fades * (rate * cosine - (omega**2 * moved + drag * rate) * sine)
    return w, v


# ---------------------------------------------------------------- the largest motions


class Peaks:
    """The largest motions of a structure's sensors, for any number of impacts on the modes up to `highest`, rad/s.

    They are the largest of evenly spaced times from first touch to the last event, `IN_CONTACT` of them in
    contact or `MOST_TIMES` in all, or up to 1.2 times as many. Between them the force is taken as linear; the responses
    to such a force are exact, and are kept.
    """

    def __init__(self, target: AbstractTarget, highest: float) -> None:
        self._target, self._modes = target, _with_strain(target.modes(highest))
        self._kept = dict[tuple[float, int], NDArray[np.complex128]]()

    def of(self, steps: Any, unit: float, duration: float, replay: Callable[[Array], Array] | None = None) -> Array:
        """Largest absolute values of the quantities of each sensor, SI: (quantities, sensors). steps: the recorded
        segments. unit: of their forces, N. duration: of what is looked at, s. replay: gives the motion of all rows at
        times, for impacts with membrane forces."""
        if duration <= 0.0:
            return np.zeros((len(quantities_of(self._target)), len(self._target.sensors or ())))
        touching = float(np.minimum(steps["h"], duration)[steps["flight"] < 0].sum())
        longest = max(touching / IN_CONTACT, duration / MOST_TIMES)
        dt = 2.0 ** (math.floor(4.0 * math.log2(longest)) / 4.0)  # impacts of about equal duration share responses
        count = math.ceil(duration / dt) + 1
        if replay is not None:
            return np.abs(split_rows(self._target, replay(np.minimum(dt * np.arange(count), duration)))).max(axis=-1)
        step = 1 << max(count.bit_length() - 4, 0)  # of sizes with small prime factors
        size = math.ceil(count / step) * step
        if (key := (dt, size)) not in self._kept:
            self._kept[key] = np.fft.rfft(responses(self._modes, dt, size), 2 * size)
        times: Array = dt * np.arange(float(count))
        force = np.where(times <= duration, force_of_steps(steps, unit, times), 0.0)
        moved = np.fft.irfft(np.fft.rfft(force, 2 * size) * self._kept[key], 2 * size)[..., :count]
        before, after = moved[..., count - 2], moved[..., count - 1]
        moved[..., count - 1] = before + (duration / dt - (count - 2)) * (after - before)
        return np.abs(split_rows(self._target, moved)).max(axis=-1)


@one_thread
def responses(on: Modes, dt: float, count: int) -> Array:
    """Displacement, velocity and acceleration of each sensor at the times 0, dt, … by a force that rises evenly from 0
    at −dt to 1 N at time 0 and falls to 0 at dt: (3, sensors, count).

    A mode with the pole s moves by Im(e^{st})/ω_d after an impulse of 1 N·s, hence after the triangle by
    Im(e^{st} dt (e^{−s dt} − 2 + e^{s dt})/(s dt)²)/ω_d; its derivatives have the factors s and s². The exponentials
    of all times are products of those of few.
    """
    slow = 1e-4  # angle that a motion of frequency 0 turns by in all: as a vibration it is then exact to 2e-9
    omega = np.maximum(on.frequency, slow / (count * dt))
    pole = -on.damping_ratio * on.frequency + 1j * omega * np.sqrt(1.0 - on.damping_ratio**2)
    z = pole * dt
    small = np.polynomial.polynomial.polyval(z, [1.0 / math.factorial(k) for k in range(2, 10)])
    with np.errstate(over="ignore", invalid="ignore"):
        begun = np.where(np.abs(z) < 0.1, small, (np.exp(z) - 1.0 - z) / z**2)
    side = math.isqrt(count - 1) + 1
    coarse, fine = np.exp(np.outer(np.arange(side) * side, z)), np.exp(np.outer(z, np.arange(side)))
    hat, found = (np.expm1(z) / z) ** 2, np.empty((3, len(on.factor), count), np.float64)
    for k, sensor in np.ndindex(found.shape[:2]):
        gain = on.factor[sensor] * dt / pole.imag * pole**k
        after: Any = (gain * hat * coarse) @ fine
        found[k, sensor, 0] = float((gain * begun).imag.sum())
        found[k, sensor, 1:] = after.imag.ravel()[: count - 1]
    found[2, :, 0] += on.factor.sum(axis=1)
    return found
