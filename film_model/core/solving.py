"""One contact to an accuracy, and bounds on errors from two meshes: march/film_solve.c and march/film_compare.c."""

from __future__ import annotations

import ctypes as c
import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from film_model.core.native import FULL, START_DTYPE, SUMMARY_DTYPE, Curve, Mesh, Solution, Start, at, library

MOST_SEGMENTS, MOST_LINES = native.SOLVE.film("MOST_SEGMENTS", "MOST_LINES")
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


def bound_fine(cut: Mesh, start: NDArray[Any], coarse: Any, fine: Any, off: Any, before: Any) -> NDArray[np.float64]:
    """Bounds on the errors of many contacts on a mesh, from their difference `off` to half as many segments."""
    tables = [np.ascontiguousarray(start, START_DTYPE)]
    tables += [np.ascontiguousarray(each, SUMMARY_DTYPE) for each in (coarse, fine)]
    tables += [np.ascontiguousarray(each, np.float64) for each in (off, before)]
    bound = np.empty(len(start))
    library().film_bound_fine(c.byref(cut), 0, len(start), *(table.ctypes.data for table in tables), at(bound))
    return bound


def bound_coarse(cut: Mesh, start: NDArray[Any], coarse: Any, off: Any) -> NDArray[np.float64]:
    """The same from the difference to twice as many segments."""
    tables = [np.ascontiguousarray(start, START_DTYPE), np.ascontiguousarray(coarse, SUMMARY_DTYPE)]
    tables.append(np.ascontiguousarray(off, np.float64))
    bound = np.empty(len(start))
    library().film_bound_coarse(c.byref(cut), len(start), *(table.ctypes.data for table in tables), at(bound))
    return bound
