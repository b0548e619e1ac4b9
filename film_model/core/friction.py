"""The core's friction beside a normal motion, seen from Python. Nothing else knows its structures (film_friction.h)."""

from __future__ import annotations

import ctypes as c
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from film_model.core.headers import Header

Array = NDArray[np.float64]

FRICTION = Header("oblique/film_friction.h", native.CORE)
STICKS, SLIPS, REVERSES, SLIDES = FRICTION.film("STICKS", "SLIPS", "REVERSES", "SLIDES")
"""Phases, by how they begin; also places in `film_model.oblique.result.KINDS`."""

SLOW = 1e-7
"""Sliding over approach velocity below which the core takes all to be proportional to it, within as much."""

TABLE = Path(__file__).parent / "oblique" / "hertz.npy"
"""Made by `python examples/friction_table.py`."""

EXACT, COARSE, QUICK = FRICTION.film("FRICTION_EXACT", "FRICTION_COARSE", "FRICTION_QUICK")
ERRORS = (0.0, 1e-8, 1e-5)
"""Of sliding velocities over those before, and the second of forces and their times in the table; measured in tests."""

_STEPS, _COLUMNS = FRICTION.film("FRICTION_STEPS", "FRICTION_COLUMNS")


@FRICTION.structure("film_normal")
class Normal(c.Structure):
    """ν' = load − f, z' = ν − γ f, f = slope z + coefficient z^exponent, from z = 0 with ν = approach."""


@FRICTION.structure("film_friction_result")
class Result(c.Structure):
    """What friction did. regime: place in `film_model.oblique.result.REGIMES`."""

    @property
    def events(self) -> list[tuple[float, int]]:
        """Times and kinds of the phases."""
        return list(zip(self.begins[: self.phases], self.kinds[: self.phases], strict=True))


@FRICTION.structure("film_friction_brief")
class _Brief(c.Structure):
    """regime: place in `film_model.oblique.result.REGIMES`. steps: 0 where none was needed."""


NORMAL_DTYPE, MANY_DTYPE = np.dtype(Normal), np.dtype(_Brief)


_library = native.with_functions(FRICTION, sizes=("film_friction_sizes", Normal, Result, _Brief))


def impact(normal: Normal, rate: float, velocity: float) -> tuple[int, Result, Array]:
    """Status and result of one impact, and its motion: rows of time, z, D, D', q and c. rate: 2χ; velocity: D'."""
    per_step = 4
    result, rows, count = Result(), np.empty((per_step * _STEPS + 2, _COLUMNS)), c.c_int32()
    room = rows.ctypes.data, per_step, len(rows), c.byref(count)
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
