"""The core's friction beside a normal motion, seen from Python. Nothing else knows its structures (film_friction.h)."""

from __future__ import annotations

import ctypes as c
from functools import lru_cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from film_model.core import native

Array = NDArray[np.float64]

STICKS, SLIPS, REVERSES, SLIDES = range(4)
"""Phases, by how they begin; also places in `film_model.oblique.result.KINDS`."""

SLOW = 1e-7
"""Sliding over approach velocity below which the core takes all to be proportional to it, within as much."""

_EVENTS, _STEPS, _COLUMNS, _PER_STEP, _AT_ONCE = 48, 1500, 6, 4, 1024
_D, _I = c.c_double, c.c_int32


class Normal(c.Structure):
    """film_normal: ν' = load − f, z' = ν − γ f, f = slope z + coefficient z^exponent, from z = 0 with ν = approach."""

    _fields_ = [(name, _D) for name in ("slope", "coefficient", "exponent", "approach", "gamma", "load")]


class Result(c.Structure):
    """film_friction_result: what friction did."""

    _fields_ = (
        [(name, _D) for name in ("velocity", "force", "time_of_force", "duration", "closure")]
        + [("begins", _D * _EVENTS), ("kinds", _I * _EVENTS)]
        + [("phases", _I), ("steps", _I)]
    )

    @property
    def events(self) -> list[tuple[float, int]]:
        """Times and kinds of the phases."""
        return list(zip(self.begins[: self.phases], self.kinds[: self.phases], strict=True))


NORMAL_DTYPE = np.dtype(Normal)
MANY_DTYPE = np.dtype(
    [(name, np.float64) for name in ("velocity", "force", "time_of_force", "closure")]
    + [(name, np.int32) for name in ("first", "phases", "steps")]
)
"""Of a result, without its events; first: kind of the first phase."""


@lru_cache(maxsize=1)
def _library() -> Any:
    """The core's library, with the functions of film_friction.h declared."""
    lib, pointer, i64 = native.library(), c.c_void_p, c.c_int64
    lib.film_friction.argtypes = [pointer, _D, _D, pointer, pointer, _I, _I, pointer]
    lib.film_friction.restype = c.c_int
    lib.film_friction_many.argtypes = [i64, pointer, pointer, pointer, pointer, pointer]
    lib.film_friction_many.restype = None
    sizes = (c.c_int64 * 2)()
    lib.film_friction_sizes(sizes)
    if list(sizes) != [c.sizeof(Normal), c.sizeof(Result)]:
        raise ImportError("the core was built from other sources: install the package again (pip install .)")
    return lib


def impact(normal: Normal, rate: float, velocity: float) -> tuple[int, Result, Array]:
    """Status and result of one impact, and its motion: rows of time, z, D, D', q and c. rate: 2χ; velocity: D'."""
    result, rows, count = Result(), np.empty((_PER_STEP * _STEPS + 2, _COLUMNS)), _I()
    room = rows.ctypes.data, _PER_STEP, len(rows), c.byref(count)
    status = _library().film_friction(c.byref(normal), rate, velocity, c.byref(result), *room)
    return status, result, rows[: count.value].copy()


def many(normal: NDArray[Any], rate: Array, velocity: Array) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and results (MANY_DTYPE) of many impacts (NORMAL_DTYPE)."""
    normal = np.ascontiguousarray(normal, NORMAL_DTYPE)
    columns = [np.ascontiguousarray(values, np.float64) for values in (rate, velocity)]
    found: NDArray[Any] = np.empty(normal.size, MANY_DTYPE)
    status = np.empty(normal.size, np.int32)
    whole: NDArray[Any] = np.empty(min(normal.size, _AT_ONCE), np.dtype(Result))
    for begin in range(0, normal.size, _AT_ONCE):
        part = slice(begin, begin + _AT_ONCE)
        arrays = (normal[part], *(values[part] for values in columns), whole, status[part])
        count = arrays[0].size
        _library().film_friction_many(count, *(array.ctypes.data for array in arrays))
        for name in cast("Any", MANY_DTYPE.names):
            found[name][part] = whole["kinds"][:count, 0] if name == "first" else whole[name][:count]
    return status, found
