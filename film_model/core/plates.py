"""The core's simply supported plates, seen from Python. Nothing else knows their structure (film_plate.h)."""

from __future__ import annotations

import ctypes as c

import numpy as np

from film_model.base.arrays import Array
from film_model.core import native
from film_model.core.headers import Header

PLATE = Header("plate/film_plate.h", native.CORE)


@PLATE.structure("film_plate")
class Plate(c.Structure):
    """Sides a and b, struck point x, y, mass per area, D11, mixed = D12 + 2 D66, D22, an elastic bed, and thickness,
    1/S and bulge of a plate with shear, 0 without, in any units."""


_library = native.with_functions(PLATE)


def sheared(plate: Plate) -> bool:
    """Whether shear is known where the plate is struck."""
    return bool(_library().film_plate_sheared(c.byref(plate)))


def highest(plate: Plate) -> float:
    """Frequency of the shortest waves of a plate with shear."""
    return _library().film_plate_highest(c.byref(plate))


def most(plate: Plate, limit: float) -> float:
    """A bound on the number of modes up to a frequency."""
    return _library().film_plate_most(c.byref(plate), limit)


def modes(plate: Plate, limit: float, points: Array) -> tuple[Array, Array]:
    """Frequencies of the modes up to one without a node at the struck point, and shapes over the root of the modal mass
    there and at the points, one per row.

    points: x, y and the orders of derivatives in both, one point per row.
    """
    room = int(most(plate, limit))
    at, frequency = np.ascontiguousarray(points), np.empty(room)
    shapes = np.empty((room, 1 + len(at)))
    given = c.byref(plate), limit, len(at), at.ctypes.data, room, frequency.ctypes.data, shapes.ctypes.data
    count = _library().film_plate_modes(*given)
    return frequency[:count], shapes[:count].T


def compliance(plate: Plate) -> float:
    """Static deflection over force of a plate without bed."""
    return _library().film_plate_compliance(c.byref(plate))


def around(reach: float) -> float:
    """film_plate_around."""
    return _library().film_plate_around(reach)


def shear(plates: Array) -> Array:
    """The part of shear in that, of each plate; their numbers, one plate per row."""
    rows, found = np.ascontiguousarray(plates), np.empty(len(plates))
    _library().film_plate_shear(len(rows), rows.ctypes.data, found.ctypes.data)
    return found
