"""Differences of two summaries of the same contacts, their rounding errors, and dents of laws that pull.

One contact has native.Start and native.Summary, and the answer is a float; many have arrays of START_DTYPE and
SUMMARY_DTYPE, and the answer is an array.
"""

from __future__ import annotations

import ctypes as c
from typing import Any

import numpy as np

from film_model.core.native import START_DTYPE, SUMMARY_DTYPE, Curve, Summary, at, library


def compare(start: Any, a: Any, b: Any) -> Any:
    """Largest relative difference of two summaries of each contact: see film_solve.h."""
    if isinstance(b, Summary):
        found = c.c_double()
        library().film_compare(1, c.byref(start), c.byref(a), c.byref(b), c.byref(found))
        return found.value
    off = np.empty(len(start))
    start, tables = np.ascontiguousarray(start, START_DTYPE), [np.ascontiguousarray(t, SUMMARY_DTYPE) for t in (a, b)]
    library().film_compare(len(start), start.ctypes.data, *(table.ctypes.data for table in tables), at(off))
    return off


def rounding(curve: Curve, start: Any, summary: Any, clearance: float) -> Any:
    """How much rounding may change each summary, relative as in `compare`; clearance: where the law's force begins."""
    if isinstance(summary, Summary):
        found = c.c_double()
        library().film_rounding(c.byref(curve), 1, c.byref(start), c.byref(summary), clearance, c.byref(found))
        return found.value
    off = np.empty(len(start))
    start, table = np.ascontiguousarray(start, START_DTYPE), np.ascontiguousarray(summary, SUMMARY_DTYPE)
    own = len(start), start.ctypes.data, table.ctypes.data, clearance, at(off)
    library().film_rounding(c.byref(curve), *own)
    return off


def dents(curve: Curve, depth: Any, end: Any, places: Any = None, values: Any = None) -> Any:
    """What contacts leave that turned at `depth` and ended at `end` [δ_s], of a law that pulls: see film_core.h.

    places, values: of many contacts whose curves differ in doubles, as in `families.Rows`.
    """
    rows = np.array(np.broadcast_arrays(np.atleast_1d(depth), end), np.float64)
    left = np.empty(rows.shape[1:])
    own = 0, None, None
    if places is not None:
        values = np.ascontiguousarray(values, np.float64)
        own = places.size, places.ctypes.data, values.ctypes.data
    library().film_dents(c.byref(curve), left.size, *own, *(row.ctypes.data for row in rows), at(left))
    return left if np.ndim(depth) else float(left[0])
