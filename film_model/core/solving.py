"""One contact to an accuracy; differences of two summaries of the same contacts, their rounding errors, and bounds on
errors from two meshes; dents of laws that pull.

Where one contact is compared, it has native.Start and native.Summary, and the answer is a float; many have arrays of
START_DTYPE and SUMMARY_DTYPE, and the answer is an array.
"""

from __future__ import annotations

import ctypes as c
import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import native
from film_model.core.native import FULL, START_DTYPE, SUMMARY_DTYPE, Curve, Mesh, Solution, Start, Summary, at, library

MOST_SEGMENTS, MOST_LINES, VALUES = native.SOLVE.film("MOST_SEGMENTS", "MOST_LINES", "COMPARED")
"""Segments of loading, and lines of a contact, beyond which no mesh is refined."""


@lru_cache(maxsize=64)
def doubled(linearisation: int, loading: int, unloading: int, count: int) -> tuple[Any, tuple[Mesh, ...]]:
    """Meshes, each of twice the segments of the one before, side by side; and the owners of their memory."""
    owners = tuple(native.mesh(linearisation, loading << k, unloading << k) for k in range(count))
    return (Mesh * count)(*owners), owners


def solve(
    curve: Curve, start: Start, linearisation: int, first: tuple[int, int], accuracy: float, clearance: float
) -> tuple[int, Solution]:
    """Status and solution of one contact. first: segments of loading and unloading of the coarsest mesh."""
    found, most = Solution(), math.ceil(math.log2(MOST_SEGMENTS / first[0])) + 1
    for count in (min(6, most), most):  # nearly all contacts need at most so many meshes
        meshes, _ = doubled(linearisation, *first, count)
        given = c.byref(curve), c.byref(start), meshes, count, accuracy, clearance, c.byref(found)
        status = library().film_solve(*given)
        if status != FULL:
            break
    return status, found


def estimate(
    curve: Curve, start: Start, linearisation: int, counts: tuple[int, int], clearance: float
) -> tuple[int, Solution]:
    """The same on a given mesh."""
    found, (meshes, _) = Solution(), doubled(linearisation, *counts, 2)
    return library().film_estimate(c.byref(curve), c.byref(start), meshes, clearance, c.byref(found)), found


def compare(start: Any, a: Any, b: Any, vibrates: bool = False) -> Any:
    """Largest relative difference of two summaries of each contact: see film_solve.h."""
    if isinstance(b, Summary):
        found = c.c_double()
        library().film_compare(1, c.byref(start), c.byref(a), c.byref(b), vibrates, c.byref(found))
        return found.value
    off = np.empty(len(start))
    start, tables = np.ascontiguousarray(start, START_DTYPE), [np.ascontiguousarray(t, SUMMARY_DTYPE) for t in (a, b)]
    library().film_compare(len(start), start.ctypes.data, *(table.ctypes.data for table in tables), vibrates, at(off))
    return off


def differences(start: Start, a: Summary, b: Summary, vibrates: bool) -> list[float]:
    """The same of one contact, value by value."""
    found = (c.c_double * VALUES)()
    library().film_differences(c.byref(start), c.byref(a), c.byref(b), vibrates, found)
    return list(found)


def first_segments(damping: Any, least: int) -> Any:
    """Segments of the first trial of each contact: more for strong damping."""
    if not isinstance(damping, np.ndarray):
        one = c.c_int32()
        library().film_first_segments(1, c.byref(c.c_double(damping)), least, c.byref(one))
        return one.value
    given, found = np.ascontiguousarray(damping, np.float64), np.empty(damping.size, np.int32)
    library().film_first_segments(found.size, given.ctypes.data, least, at(found))
    return found


_FOUR = c.c_double * 4


def change(full: tuple[Any, Any, Any], without: tuple[Any, Any, Any], units: tuple[Any, Any, Any, Any]) -> Any:
    """Largest change of each contact's results by neglecting an effect: see film_solve.h. full, without: statuses,
    starts and summaries with it and without. units: of the march without over those of that with it."""
    if isinstance(full[2], Summary):
        found, ((status, p, a), (other, q, b)) = c.c_double(), (full, without)
        tried = c.byref(c.c_int32(status)), c.byref(p), c.byref(a), c.byref(c.c_int32(other)), c.byref(q), c.byref(b)
        library().film_change(1, *tried, _FOUR(*units), c.byref(found))
        return found.value
    kinds = np.int32, START_DTYPE, SUMMARY_DTYPE
    tables = [np.ascontiguousarray(*pair) for trial in (full, without) for pair in zip(trial, kinds, strict=True)]
    scale, off = np.stack(np.broadcast_arrays(*units), axis=-1), np.empty(len(full[1]))
    library().film_change(off.size, *(table.ctypes.data for table in (*tables, scale)), at(off))
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


def bound_fine(cut: Mesh, start: NDArray[Any], coarse: Any, fine: Any, off: Any, before: Any) -> Array:
    """Bounds on the errors of many contacts on a mesh, from their difference `off` to half as many segments."""
    tables = [np.ascontiguousarray(start, START_DTYPE)]
    tables += [np.ascontiguousarray(each, SUMMARY_DTYPE) for each in (coarse, fine)]
    tables += [np.ascontiguousarray(each, np.float64) for each in (off, before)]
    bound = np.empty(len(start))
    library().film_bound_fine(c.byref(cut), 0, len(start), *(table.ctypes.data for table in tables), at(bound))
    return bound


def bound_coarse(cut: Mesh, start: NDArray[Any], coarse: Any, off: Any) -> Array:
    """The same from the difference to twice as many segments."""
    tables = [np.ascontiguousarray(start, START_DTYPE), np.ascontiguousarray(coarse, SUMMARY_DTYPE)]
    tables.append(np.ascontiguousarray(off, np.float64))
    bound = np.empty(len(start))
    library().film_bound_coarse(c.byref(cut), len(start), *(table.ctypes.data for table in tables), at(bound))
    return bound
