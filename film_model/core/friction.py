"""The core's friction beside a normal motion, seen from Python. Nothing else knows its structures (film_friction.h)."""

from __future__ import annotations

import ctypes as c
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core import native

Array = NDArray[np.float64]

STICKS, SLIPS, REVERSES, SLIDES = range(4)
"""Phases, by how they begin; also places in `film_model.oblique.result.KINDS`."""

SLOW = 1e-7
"""Sliding over approach velocity below which the core takes all to be proportional to it, within as much."""

TABLE = Path(__file__).parent / "oblique" / "hertz.npy"
"""Made by `python examples/friction_table.py`."""

EXACT, COARSE, QUICK = range(3)
ERRORS = (0.0, 1e-8, 1e-5)
"""Of sliding velocities over those before, and the second of forces and their times in the table; measured in tests."""

_EVENTS, _STEPS, _COLUMNS, _PER_STEP = 48, 1500, 6, 4
_D, _I = c.c_double, c.c_int32


class Normal(c.Structure):
    """film_normal: ν' = load − f, z' = ν − γ f, f = slope z + coefficient z^exponent, from z = 0 with ν = approach."""

    _fields_ = [(name, _D) for name in ("slope", "coefficient", "exponent", "approach", "gamma", "load")]


class Result(c.Structure):
    """film_friction_result: what friction did. regime: place in `film_model.oblique.result.REGIMES`."""

    _fields_ = (
        [(name, _D) for name in ("velocity", "force", "time_of_force", "duration", "closure")]
        + [("begins", _D * _EVENTS), ("kinds", _I * _EVENTS)]
        + [(name, _I) for name in ("phases", "steps", "regime", "reserved")]
    )

    @property
    def events(self) -> list[tuple[float, int]]:
        """Times and kinds of the phases."""
        return list(zip(self.begins[: self.phases], self.kinds[: self.phases], strict=True))


NORMAL_DTYPE = np.dtype(Normal)
MANY_DTYPE = np.dtype(
    [(name, np.float64) for name in ("velocity", "force", "time_of_force", "closure")]
    + [(name, np.int32) for name in ("status", "regime", "steps", "reserved")]
)
"""film_friction_brief. regime: place in `film_model.oblique.result.REGIMES`. steps: 0 where none was needed."""


@lru_cache(maxsize=1)
def _library() -> Any:
    """The core's library, with the functions of film_friction.h declared."""
    lib, pointer, i64 = native.library(), c.c_void_p, c.c_int64
    lib.film_friction.argtypes = [pointer, _D, _D, c.c_int, pointer, pointer, _I, _I, pointer]
    lib.film_friction.restype = c.c_int
    lib.film_friction_many.argtypes = [i64, *[pointer] * 3, c.c_int, *[pointer] * 2]
    lib.film_friction_many.restype = None
    sizes = (c.c_int64 * 3)()
    lib.film_friction_sizes(sizes)
    if list(sizes) != [c.sizeof(Normal), c.sizeof(Result), MANY_DTYPE.itemsize]:
        raise ImportError("the core was built from other sources: install the package again (pip install .)")
    return lib


def impact(normal: Normal, rate: float, velocity: float) -> tuple[int, Result, Array]:
    """Status and result of one impact, and its motion: rows of time, z, D, D', q and c. rate: 2χ; velocity: D'."""
    result, rows, count = Result(), np.empty((_PER_STEP * _STEPS + 2, _COLUMNS)), _I()
    room = rows.ctypes.data, _PER_STEP, len(rows), c.byref(count)
    status = _library().film_friction(c.byref(normal), rate, velocity, 0, c.byref(result), *room)
    return status, result, rows[: count.value].copy()


def many(normal: NDArray[Any], rate: Array, velocity: Array, coarse: int = EXACT) -> NDArray[Any]:
    """Results (MANY_DTYPE) of many impacts (NORMAL_DTYPE). coarse: EXACT, COARSE or QUICK, for `ERRORS`; unless EXACT,
    those under Hertz's law alone are from a table."""
    normal = np.ascontiguousarray(normal, NORMAL_DTYPE)
    rate, velocity = (np.ascontiguousarray(values, np.float64) for values in (rate, velocity))
    found: NDArray[Any] = np.empty(normal.size, MANY_DTYPE)
    table = _table().ctypes.data if coarse else None
    at = [array.ctypes.data for array in (normal, rate, velocity)]
    _library().film_friction_many(normal.size, *at, coarse, table, found.ctypes.data)
    return found


@lru_cache(maxsize=1)
def _table() -> Array:
    """The table of film_friction_many.c."""
    return np.load(TABLE)
