"""How far two summaries of the same contacts differ, and what rounding does to them: `film_compare.c` from Python."""

from __future__ import annotations

import ctypes as c
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.core.native import START_DTYPE, SUMMARY_DTYPE, Curve, library


def compare(start: Any, a: Any, b: Any) -> NDArray[np.float64]:
    """Largest relative difference of two summaries of each contact (START_DTYPE, SUMMARY_DTYPE): see film_core.h."""
    count, off = len(start), np.empty(len(start))
    tables = [np.ascontiguousarray(table, SUMMARY_DTYPE) for table in (a, b)]
    library().film_compare(c.c_int64(count), *_addresses(np.ascontiguousarray(start, START_DTYPE), *tables, off))
    return off


def rounding(curve: Curve, start: Any, summary: Any, clearance: float) -> NDArray[np.float64]:
    """How much rounding may change each summary, relative as in `compare`; clearance: where the law's force begins."""
    count, off = len(start), np.empty(len(start))
    start, table = np.ascontiguousarray(start, START_DTYPE), np.ascontiguousarray(summary, SUMMARY_DTYPE)
    at, table_at, off_at = _addresses(start, table, off)
    library().film_rounding(c.byref(curve), c.c_int64(count), at, table_at, c.c_double(clearance), off_at)
    return off


def _addresses(*tables: NDArray[Any]) -> list[c.c_void_p]:
    return [c.c_void_p(table.ctypes.data) for table in tables]
