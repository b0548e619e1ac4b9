"""How many modes an impact needs, by the core, seen from Python. Nothing else calls that part of it (film_refine.h)."""

from __future__ import annotations

import ctypes as c
from typing import Any

import numpy as np

from film_model.core import modal, native
from film_model.core.headers import Header

REFINE = Header("modal/film_refine.h", modal.MODAL, native.SOLVE)
ASKS = tuple(REFINE.film("ENOUGH", "RUN", "SHARES", "SOFTER", "FEWER", "FAILED"))
ENOUGH, RUN, SHARES, SOFTER, FEWER, FAILED = ASKS
"""What may be asked for; no more; the run that just failed was needed."""

REFINED, MOST_FOLLOWED = REFINE.film("REFINED", "MOST_FOLLOWED")
"""Tolerance of a step over that of the run with twice the highest frequency; largest number of modes of a run."""


@REFINE.structure("film_run")
class Run(c.Structure):
    """A run that was asked for, or the shares of its modes."""


@REFINE.structure("film_refine")
class Refinement(c.Structure):
    """What is asked for next, and in the end the estimates."""

    def begin(self, first: float) -> None:
        """Ask for the first run, up to a frequency; what is given is set before."""
        _library().film_refine_begin(c.byref(self), first)

    def take(self, run: Run) -> None:
        """Take what was asked for, and ask for the next."""
        _library().film_refine_next(c.byref(self), c.byref(run))


_library = native.with_functions(REFINE, sizes=("film_refine_sizes", Run, Refinement))


def tightened(tolerance: float, share: float) -> float:
    """A share of a tolerance, as far as a step can meet it."""
    return _library().film_tightened(tolerance, share)


def step_tolerance(accuracy: float) -> float:
    """Tolerance of a step for an accuracy."""
    return _library().film_step_tolerance(accuracy)


def error_of(damped: bool, before: Any, change: Any) -> Any:
    """Bound on the error of a run, of a law with damping or without. change: its difference to a run with half the
    highest frequency; before: the same of that run."""
    shape = np.broadcast_shapes(np.shape(before), np.shape(change))
    pair = [np.ascontiguousarray(np.broadcast_to(each, shape), np.float64) for each in (before, change)]
    found = np.empty(shape)
    _library().film_refine_bounds(damped, found.size, *(array.ctypes.data for array in (*pair, found)))
    return found if shape else float(found)
