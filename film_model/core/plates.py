"""The core's simply supported plates, seen from Python. Nothing else knows their structure (film_plate.h)."""

from __future__ import annotations

import ctypes as c
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from film_model.core.headers import Header

Array = NDArray[np.float64]

PLATE = Header("plate/film_plate.h", native.CORE)


@PLATE.structure("film_plate")
class Plate(c.Structure):
    """Sides a and b, mass per area, D11, mixed = D12 + 2 D66, D22, and an elastic bed, in any units."""


@lru_cache(maxsize=1)
def _library() -> Any:
    """The core's library, with the functions of film_plate.h declared."""
    return PLATE.declare(native.library())


def most(plate: Plate, highest: float) -> float:
    """A bound on the number of modes up to a frequency."""
    return _library().film_plate_most(c.byref(plate), highest)


def modes(plate: Plate, highest: float, points: Array) -> tuple[Array, Array]:
    """Frequencies of the modes up to one without a node at the first point, and shapes at the points, one per row.

    points: x, y and the orders of derivatives in both, one point per row.
    """
    room = int(most(plate, highest))
    at, frequency = np.ascontiguousarray(points), np.empty(room)
    shapes = np.empty((room, len(at)))
    given = c.byref(plate), highest, len(at), at.ctypes.data, room, frequency.ctypes.data, shapes.ctypes.data
    count = _library().film_plate_modes(*given)
    return frequency[:count], shapes[:count].T


def compliance(plate: Plate, x: float, y: float) -> float:
    """Static deflection over force at a point of a plate without bed."""
    return _library().film_plate_compliance(c.byref(plate), x, y)
