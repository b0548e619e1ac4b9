"""The core's friction beside a motion in steps, seen from Python. Nothing else knows its structure (film_slide.h)."""

from __future__ import annotations

import ctypes as c

from film_model.core import modal, native
from film_model.core.headers import Header
from film_model.core.springs import SPRINGS, Array

SLIDE = Header("modal/film_slide.h", modal.MODAL, SPRINGS)


@SLIDE.structure("film_sliding")
class Sliding(c.Structure):
    """Springs that slip, what they have done, and the phases that began in the last call. steps: work since the caller
    set it to 0, which the core limits."""


_library = native.with_functions(SLIDE, sizes=("film_slide_sizes", Sliding))


def begin(curve: native.Curve, friction: float, mass: float, velocity: float) -> Sliding:
    """The start of a motion. Raises ValueError for numbers out of range."""
    made = Sliding()
    if _library().film_slide_init(c.byref(made), c.byref(curve), friction, mass, velocity) != native.OK:
        raise ValueError(f"the core refuses friction {friction!r}, mass {mass!r}, velocity {velocity!r}")
    return made


def slide(
    curve: native.Curve, mesh: native.Mesh, begun: native.State, ended: native.State, friction: Array, sliding: Sliding
) -> int:
    """Advance `sliding` in place while the normal motion leads from `begun` to `ended`; the core's status.
    friction: pairs of speed and coefficient, (pairs, 2); none for that of the start."""
    table = friction.ctypes.data, len(friction)
    return _library().film_slide(
        c.byref(curve), c.byref(mesh), c.byref(begun), c.byref(ended), *table, c.byref(sliding)
    )


def slide_on_modes(motion: modal.Motion, dt: float, friction: Array, sliding: Sliding) -> int:
    """Advance both motions by dt, in the structure's unit, or to the next event; the core's status."""
    table = friction.ctypes.data, len(friction)
    with motion.tables.lock:
        return _library().film_slide_on_modes(*motion.pointers(), dt, *table, c.byref(sliding))
