"""The core's springs that slip, seen from Python. Nothing else knows their structure (film_springs.h)."""

from __future__ import annotations

import ctypes as c
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core import native

Array = NDArray[np.float64]

MOST = 256
"""Springs beside each other."""

_D, _I = c.c_double, c.c_int32


class Springs(c.Structure):
    """film_springs: springs at one moment; v: sliding velocity, q: friction force, push: other acceleration."""

    _fields_ = (
        [(name, _D) for name in ("stiffness", "width", "friction", "mass", "v", "q", "push", "radius")]
        + [("u", _D * MOST)]
        + [("count", _I), ("reserved", _I)]
    )


class Impact(c.Structure):
    """film_springs_impact_result. velocity: at the end. force, step: largest friction force, and after how many steps.
    apart: largest difference of the velocity at any time to that of half as many springs and steps."""

    _fields_ = (("velocity", _D), ("force", _D), ("apart", _D), ("step", c.c_int64))


@lru_cache(maxsize=1)
def _library() -> Any:
    """The core's library, with the functions of film_springs.h declared."""
    lib, pointer, i64 = native.library(), c.c_void_p, c.c_int64
    signatures: dict[str, tuple[list[Any], Any]] = {
        "film_springs_init": ([pointer, _I, *[_D] * 5], c.c_int),
        "film_springs_follow": ([pointer, _D, i64, pointer, pointer, pointer, pointer], None),
        "film_springs_impact": ([_I, *[_D] * 5, i64, pointer, pointer, pointer], c.c_int),
        "film_springs_radii": ([i64, *[pointer] * 3, _D, pointer, pointer], None),
        "film_springs_energy": ([pointer], _D),
        "film_springs_size": ([], i64),
    }
    for name, (arguments, result) in signatures.items():
        function = getattr(lib, name)
        function.argtypes = arguments
        function.restype = result
    if lib.film_springs_size() != c.sizeof(Springs):
        raise ImportError("the core was built from other sources: install the package again (pip install .)")
    return lib


def springs(count: int, modulus: float, largest: float, friction: float, mass: float, velocity: float) -> Springs:
    """Springs that do not touch yet, up to the radius `largest`. Raises ValueError for numbers out of range."""
    made = Springs()
    numbers = modulus, largest, friction, mass, velocity
    if _library().film_springs_init(c.byref(made), count, *numbers) != native.OK:
        raise ValueError(f"the core refuses {count} springs with {numbers!r}")
    return made


def energy(state: Springs) -> float:
    """Energy of the springs."""
    return _library().film_springs_energy(c.byref(state))


def follow(state: Springs, time: float, force: Array, radius: Array) -> tuple[Array, Array]:
    """Sliding velocity and friction force after each of as many steps as there are forces and radii."""
    force, radius = (np.ascontiguousarray(values, np.float64) for values in (force, radius))
    velocity, friction = np.empty(force.size), np.empty(force.size)
    at = [array.ctypes.data for array in (force, radius, velocity, friction)]
    _library().film_springs_follow(c.byref(state), time, force.size, *at)
    return velocity, friction


def impact(count: int, numbers: Sequence[float], step: float, force: Array, radius: Array) -> Impact | None:
    """An impact in an even number of steps of a time; None for numbers out of range.

    numbers: modulus, friction, mass and velocity. force, radius: before the first step and after each.
    """
    force, radius = (np.ascontiguousarray(values, np.float64) for values in (force, radius))
    found = Impact()
    at = force.ctypes.data, radius.ctypes.data, c.byref(found)
    status = _library().film_springs_impact(count, *numbers, step, force.size - 1, *at)
    return found if status == native.OK else None


def radii(force: Array, depth: Array, law: Array, modulus: float) -> tuple[Array, Array]:
    """Contact radii of a contact that yields by two models, at recorded forces and depths. law: radii of its law."""
    force, depth, law = (np.ascontiguousarray(values, np.float64) for values in (force, depth, law))
    first, second = np.empty(force.size), np.empty(force.size)
    at = [array.ctypes.data for array in (force, depth, law, first, second)]
    _library().film_springs_radii(force.size, *at[:3], modulus, *at[3:])
    return first, second
