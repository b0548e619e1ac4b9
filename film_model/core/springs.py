"""The core's springs that slip, seen from Python. Nothing else knows their structure (film_springs.h)."""

from __future__ import annotations

import ctypes as c
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from film_model.core.headers import Header

Array = NDArray[np.float64]

SPRINGS = Header("oblique/film_springs.h", native.CORE)
(MOST,) = SPRINGS.film("MOST_SPRINGS")
"""Springs beside each other."""


@SPRINGS.structure("film_watch")
class Watch(c.Structure):
    """phase: place in `film_model.oblique.result.KINDS`, −1 without contact. begins, kinds: of the phases
    that began, after so much of the time that has passed."""

    @property
    def phases(self) -> list[tuple[float, int]]:
        """Times and kinds of the phases that began."""
        return list(zip(self.begins[: self.events], self.kinds[: self.events], strict=True))


@SPRINGS.structure("film_springs")
class Springs(c.Structure):
    """Springs at one moment; v: sliding velocity, q: friction force, rise: its rate, push: other acceleration."""


@SPRINGS.structure("film_springs_impact_result")
class Impact(c.Structure):
    """velocity: at the end. force, step: largest friction force, and after how many steps. error: of the velocity at
    any time, from half and a quarter of the springs and steps. slack: what the friction force lacks to its limit, a
    share of the impulses. regime: place in `film_model.oblique.result.REGIMES`. watch: of the phases."""


@SPRINGS.structure("film_springs_brief")
class _Brief(c.Structure):
    """As :class:`Impact`."""


MANY_DTYPE = np.dtype(_Brief)


_library = native.with_functions(SPRINGS, sizes=("film_springs_sizes", Springs, _Brief))


def energy(state: Springs) -> float:
    """Energy of the springs."""
    return _library().film_springs_energy(c.byref(state))


def impact(
    count: int, numbers: Sequence[float], friction: Array, step: Any, force: Array, radius: Array, begins: Any = 0.0
) -> tuple[Impact | None, Array]:
    """An impact of one or several contacts, each in the same multiple of 4 steps, and over it the sliding velocity, the
    friction force and the radius inside which all sticks, (times, 3); no impact for numbers out of range.

    numbers: modulus, power, mass and velocity. friction: pairs of speed and coefficient, (pairs, 2). step, begins: time
    of a step of each contact, and where it begins. force, radius: before the first step of a contact and after each,
    (times,) or (contacts, times).
    """
    friction, force, radius = (np.ascontiguousarray(values, np.float64) for values in (friction, force, radius))
    times = [np.ascontiguousarray(values, np.float64) for values in np.atleast_1d(begins, step)]
    found, motion = Impact(), np.empty((force.size, 3))
    table = friction.ctypes.data, len(friction)
    when = times[1].size, *(array.ctypes.data for array in times), force.shape[-1] - 1
    at = force.ctypes.data, radius.ctypes.data, c.byref(found), motion.ctypes.data
    status = _library().film_springs_impact(count, *numbers, *table, *when, *at)
    return found if status == native.OK else None, motion


def impulses(force: Array, legs: Array) -> Array:
    """Of forces at the knots of legs, (impacts, times). legs: turn, end and a kink of the force before the turn, 0 for
    none, (impacts, 3)."""
    return _of_knots(_library().film_springs_impulses, force, legs)


def roughness(values: Array, legs: Array) -> Array:
    """By how much of the largest of some values up to the turn at most every other lies beside the cubic through its
    neighbours on one side of the kink, as :func:`impulses`."""
    return _of_knots(_library().film_springs_roughness, values, legs)


def _of_knots(function: Any, values: Array, legs: Array) -> Array:
    values, legs = np.ascontiguousarray(values, np.float64), np.ascontiguousarray(legs, np.float64)
    found, at = np.empty(len(values)), [array.ctypes.data for array in (legs, values)]
    function(len(values), values.shape[1] // 2 - 1, *at, found.ctypes.data)
    return found


def many(
    places: NDArray[np.int64],
    count: int,
    steps: int,
    friction: Array,
    numbers: Array,
    force: Array,
    radius: Array,
    estimated: bool = True,
) -> NDArray[Any]:
    """Results (MANY_DTYPE) of the impacts at some places of all, without their motions. steps: of a leg. friction:
    pairs as in :func:`impact`, of all or (impacts, pairs, 2). numbers: modulus, power, mass, velocity and legs as of
    :func:`impulses`, (impacts, 7). force, radius: at the knots. estimated: or with an error of 0."""
    numbers, friction, force, radius = (
        np.ascontiguousarray(values, np.float64) for values in (numbers, friction, force, radius)
    )
    found: NDArray[Any] = np.empty(places.size, MANY_DTYPE)
    table = friction.ctypes.data, friction.shape[-2], friction.ndim == 2
    at = force.ctypes.data, radius.ctypes.data, found.ctypes.data
    sizes = native.instructions(), places.size, places.ctypes.data, count, estimated
    _library().film_springs_many(*sizes, numbers.ctypes.data, *table, steps, force.shape[1] // 2 - 1, *at)
    return found


def radii(force: Array, depth: Array, law: Array, modulus: float, contacts: int = 1) -> tuple[Array, Array]:
    """Contact radii of contacts that yield by two models, at recorded forces and depths, of one or (impacts, times).
    law: radii of the law. contacts: how many follow each other in each impact, with as many times."""
    force, depth, law = (np.ascontiguousarray(values, np.float64) for values in (force, depth, law))
    first, second = np.empty(force.shape), np.empty(force.shape)
    at = [array.ctypes.data for array in (force, depth, law, first, second)]
    count = force.shape[-1]
    _library().film_springs_radii(force.size // count, contacts, count // contacts, *at[:3], modulus, *at[3:])
    return first, second


def slid(friction: Array, velocity: float, impulse: float) -> float:
    """The sliding velocity after a normal impulse over m_t in which the contact slides. friction: (pairs, 2)."""
    friction = np.ascontiguousarray(friction, np.float64)
    return _library().film_friction_slid(friction.ctypes.data, len(friction), velocity, impulse)


def power(curve: native.Curve) -> float:
    """The power of the contact radius with which the depth of the law grows, as in film_springs.h."""
    return _library().film_springs_power(c.byref(curve))


def slopes(curve: native.Curve, force: Array, depth: Array) -> Array:
    """The slope of the force of a reversible law, over its scales, at recorded forces and depths over theirs."""
    force, depth = (np.ascontiguousarray(values, np.float64) for values in (force, depth))
    slope = np.empty(force.shape)
    at = [array.ctypes.data for array in (force, depth, slope)]
    _library().film_springs_slopes(c.byref(curve), force.size, *at)
    return slope
