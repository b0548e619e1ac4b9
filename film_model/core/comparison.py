"""How far two summaries of the same contacts differ, and what rounding does to them: `film_compare.c` from Python.

One contact has native.Start and native.Summary, and the answer is a float; many have arrays of START_DTYPE and
SUMMARY_DTYPE, and the answer is an array.
"""

from __future__ import annotations

import ctypes as c
from typing import Any

import numpy as np

from film_model.core.native import START_DTYPE, SUMMARY_DTYPE, Curve, Summary, library


def compare(start: Any, a: Any, b: Any) -> Any:
    """Largest relative difference of two summaries of each contact: see film_core.h."""
    if isinstance(b, Summary):
        found = c.c_double()
        library().film_compare(1, c.byref(start), c.byref(a), c.byref(b), c.byref(found))
        return found.value
    off = np.empty(len(start))
    tables = [np.ascontiguousarray(table, SUMMARY_DTYPE) for table in (a, b)]
    library().film_compare(len(start), *_addresses(np.ascontiguousarray(start, START_DTYPE), *tables, off))
    return off


def rounding(curve: Curve, start: Any, summary: Any, clearance: float) -> Any:
    """How much rounding may change each summary, relative as in `compare`; clearance: where the law's force begins."""
    if isinstance(summary, Summary):
        found = c.c_double()
        library().film_rounding(c.byref(curve), 1, c.byref(start), c.byref(summary), clearance, c.byref(found))
        return found.value
    off = np.empty(len(start))
    start, table = np.ascontiguousarray(start, START_DTYPE), np.ascontiguousarray(summary, SUMMARY_DTYPE)
    at, table_at, off_at = _addresses(start, table, off)
    library().film_rounding(c.byref(curve), len(start), at, table_at, clearance, off_at)
    return off


def _addresses(*tables: Any) -> list[int]:
    return [table.ctypes.data for table in tables]
