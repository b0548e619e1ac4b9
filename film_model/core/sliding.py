"""The core's friction beside a motion in steps, seen from Python. Nothing else knows its structure (film_slide.h)."""

from __future__ import annotations

import ctypes as c
from functools import lru_cache
from typing import Any

from film_model.core import native

_D, _SPRINGS = c.c_double, 256


class Sliding(c.Structure):
    """film_sliding: springs side by side that slip."""

    _fields_ = [
        *((name, _D) for name in ("friction", "mobility", "push", "longest")),
        *((name, _D) for name in ("velocity", "force", "impulse", "work", "slope", "widest")),
        ("deflection", _D * _SPRINGS),
    ]


@lru_cache(maxsize=1)
def _library() -> Any:
    """The core's library, with the functions of film_slide.h declared."""
    lib, pointer = native.library(), c.c_void_p
    lib.film_slide.argtypes = [pointer, pointer, pointer, _D, pointer]
    lib.film_slide.restype = c.c_int
    lib.film_slide_stored.argtypes = [pointer]
    lib.film_slide_stored.restype = _D
    lib.film_slide_size.restype = c.c_int64
    if lib.film_slide_size() != c.sizeof(Sliding):
        raise ImportError("the core was built from other sources: install the package again (pip install .)")
    return lib


def slide(curve: native.Curve, mesh: native.Mesh, begin: native.State, dt: float, sliding: Sliding) -> int:
    """Advance `sliding` in place by dt, in which the normal motion leads on from `begin`; the core's status."""
    return _library().film_slide(c.byref(curve), c.byref(mesh), c.byref(begin), dt, c.byref(sliding))


def stored(sliding: Sliding) -> float:
    """Energy of the springs, in units of `work`."""
    return _library().film_slide_stored(c.byref(sliding))
