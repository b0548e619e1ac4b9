"""FILM itself, as the library runs it: a batch in the compiled core."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from benchmarks.cases import Array, Case, worst_error
from film_model.core import native
from film_model.problem.curve import curve_of

_COLUMNS = (
    "maximum_force",
    "maximum_indentation",
    "time_of_maximum_indentation",
    "time_impactor_stops",
    "contact_duration",
    "final_velocity",
)
MOST_SEGMENTS = 4096
_RATIOS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0)  # unloading segments per loading segment


def starts(case: Case) -> Any:
    """How the impacts of a case start (START_DTYPE)."""
    start: Any = np.zeros(case.nu.size, native.START_DTYPE)
    start["nu"], start["gamma"], start["time_limit"] = case.nu, case.gamma, math.inf
    return start


def batch(case: Case, linearisation: int, segments: tuple[int, int], using: int | None = None) -> Callable[[], Any]:
    """A call that computes all impacts of the case: `values` reads its result. Curve and mesh are made here, once.

    using: the instructions, by their index in native.INSTRUCTIONS; the widest by default.
    """
    start = starts(case)
    curve, mesh = curve_of(case.law).native, native.mesh(linearisation, *segments)
    return lambda: native.batch(curve, mesh, start, using)


def values(result: Any) -> Array:
    """(impacts, 6) summaries from what a batch returns; NaN where an impact failed."""
    status, found = result
    columns = np.stack([found[name] for name in _COLUMNS], axis=1)
    columns[status != native.EVENT] = np.nan
    return columns


def sufficient_segments(case: Case, exact: Array, linearisation: int, error: float) -> list[tuple[int, int]]:
    """Loading and unloading segments a stage, fewest for each of several ratios, that keep all errors below `error`."""
    found: list[tuple[int, int]] = []
    for ratio in (1.0,) if linearisation == native.CHORD else _RATIOS:
        pairs = ((n, max(1, round(ratio * n))) for n in _ladder())
        fits = (p for p in pairs if worst_error(values(batch(case, linearisation, p)()), exact) <= error)
        found += [pair for pair in (next(fits, None),) if pair is not None]
    return found


def _ladder() -> Iterable[int]:
    n = 1
    while n <= MOST_SEGMENTS:
        yield n
        n = max(n + 1, round(1.06 * n))
