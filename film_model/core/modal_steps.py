"""The record of an impact on modes as tables of plain numbers, to be stored, and back: `modal.SEGMENT_DTYPE` without
what sampling does not need."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.core import modal

Table = NDArray[Any]

_NUMBERS = ("time", "h", "x", "v", "depth", "depth_rate", "load")
_OF_LAW = ("xi_free", "per_recovery", "f_max", "exponent", "xi_origin", "f_shift", "damper")  # fields of film_line

STEP_DTYPE = np.dtype(
    [(name, np.float64) for name in _NUMBERS]
    + [("force", np.float64, (4,)), ("bend", np.float64, (6,))]
    + [(name, np.float64) for name in _OF_LAW]
    + [("branch", np.int32), ("flight", np.int32)]
)
"""A step in contact, or a flight: the fields of film_modal_segment and of its line."""

FLIGHT_DTYPE = np.dtype([("displacement", np.float64), ("velocity", np.float64)])
"""A mode where a flight begins; those of one flight follow each other."""

MODE_DTYPE = np.dtype([(name, np.float64) for name in ("frequency", "share", "damping_ratio")])
"""A mode: rad/s, 1/kg, 1."""


def steps_of(segments: Table) -> Table:
    """The steps of recorded segments."""
    steps: Table = np.empty(len(segments), STEP_DTYPE)
    for name in (*_NUMBERS, "force", "bend", "flight"):
        steps[name] = segments[name]
    for name in (*_OF_LAW, "branch"):
        steps[name] = segments["line"][name]
    return steps


def segments_of(steps: Table, unit: float, rest: float) -> Table:
    """The segments of steps, as `modal.sample` takes them. unit, rest: as of `modal.Start`."""
    segments: Table = np.zeros(len(steps), modal.SEGMENT_DTYPE)
    for name in (*_NUMBERS, "force", "bend", "flight"):
        segments[name] = steps[name]
    for name in (*_OF_LAW, "branch"):
        segments["line"][name] = steps[name]
    segments["unit"], segments["rest"] = unit, rest
    return segments


def flights_of(flights: Array) -> Table:
    """The states of the modes where flights begin, mode by mode; from (flights, 2 modes)."""
    modes = flights.shape[1] // 2
    states: Table = np.empty(len(flights) * modes, FLIGHT_DTYPE)
    states["displacement"], states["velocity"] = flights[:, :modes].ravel(), flights[:, modes:].ravel()
    return states


def modes_of(tables: modal.Tables) -> Table:
    """The modes of a structure."""
    modes: Table = np.empty(tables.count, MODE_DTYPE)
    modes["frequency"], modes["share"], modes["damping_ratio"] = tables.frequency, tables.share, tables.ratio
    return modes
