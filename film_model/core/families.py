"""Families of curves in the core: a law whose stages depend on one more number, its shape (film_family)."""

from __future__ import annotations

import ctypes as c
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from film_model.core.records import EVENTS, LINES


@native.CORE.structure("film_family")
class Family(c.Structure):
    """Curves of a law with a shape. `memory`, to which `numbers` points, is kept alive here. If `high` is 0, a "shape"
    of the functions below is a row of numbers: the factor of each row of coefficients, and the end."""

    @classmethod
    def of(
        cls, low: float, high: float, end: NDArray[np.float64], places: list[int], table: NDArray[np.float64]
    ) -> Family:
        """end: series of ln(end). places: of the doubles that vary. table: their series, (nodes, varying)."""
        made = cls(low, high, len(end), len(places))
        made.memory = np.concatenate([end, np.array(places, np.float64), table.ravel()])
        made.numbers = made.memory.ctypes.data
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        end, rest = np.split(self.memory, [self.nodes])
        places, table = np.split(rest, [self.varying])
        return Family.of, (self.low, self.high, end, places.astype(int).tolist(), table)


@native.MOTIONS.structure("film_motions")
class _Room(c.Structure):
    """Memory for the motions of many contacts."""


def shaped(family: Family, whole: native.Curve, shape: float | NDArray[np.float64]) -> native.Curve:
    """The curve of a shape; of a family over several numbers, that of one contact's."""
    made, numbers = native.Curve.from_buffer_copy(whole), np.array(shape, np.float64)
    if native.library().film_shape_at(c.byref(family), c.byref(whole), numbers.ctypes.data, c.byref(made)) != native.OK:
        raise ValueError(f"the shape {shape!r} is not between {family.low!r} and {family.high!r}")
    return made


def batch(
    family: Family,
    whole: native.Curve,
    cut: native.Mesh,
    start: NDArray[Any],
    shape: NDArray[np.float64],
    using: int | None = None,
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries of many contacts (START_DTYPE), each on its shape's curve; as `native.batch`."""
    start, shape = np.ascontiguousarray(start, native.START_DTYPE), np.ascontiguousarray(shape, np.float64)
    summary, status = np.empty(start.size, native.SUMMARY_DTYPE), np.empty(start.size, np.int32)
    at = [array.ctypes.data for array in (start, shape, summary, status)]
    own = c.byref(family), c.byref(whole), c.byref(cut), start.size, *at
    native.library().film_batch_shaped(native.instructions() if using is None else using, *own)
    return status, summary


def in_series(curve: native.Curve, compliance: float) -> native.Curve:
    """The curve in series with a spring [δ_s/F_s]."""
    made = native.Curve.from_buffer_copy(curve)
    if native.library().film_spring(c.byref(made), compliance) != native.OK:
        raise ValueError(f"a spring of compliance {compliance!r} cannot be in series with the curve")
    return made


def batch_varied(
    curve: native.Curve,
    places: NDArray[np.int32],
    values: NDArray[np.float64],
    cut: native.Mesh,
    start: NDArray[Any],
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries of many contacts (START_DTYPE) whose curves differ in doubles; the GIL is released.

    places: of these among the doubles of the curve. values: (contacts, places).
    """
    start, values = np.ascontiguousarray(start, native.START_DTYPE), np.ascontiguousarray(values, np.float64)
    summary, status = np.empty(start.size, native.SUMMARY_DTYPE), np.empty(start.size, np.int32)
    at = [array.ctypes.data for array in (start, places, values, summary, status)]
    own = c.byref(curve), c.byref(cut), start.size, at[0], places.size, *at[1:]
    native.library().film_batch_varied(*own)
    return status, summary


class Rows(NamedTuple):
    """The curves of many contacts. curve: of all; or family: with its curve, and the shape of each; or varied: as in
    `batch_varied`. compliance: of a spring of each in series, δ_s/F_s."""

    curve: native.Curve
    family: tuple[Family, native.Curve, NDArray[np.float64]] | None = None
    varied: tuple[native.Curve, NDArray[np.int32], NDArray[np.float64]] | None = None
    compliance: NDArray[np.float64] | None = None

    def arguments(self) -> tuple[tuple[Any, tuple[Any, ...]], list[Any]]:
        """The curve, and compliance, family, shape, varying, places and values, of the core's functions; and what they
        point to."""
        family, curve, shape = (None, self.curve, None) if self.family is None else self.family
        curve, places, values = (curve, None, None) if self.varied is None else self.varied
        own = [None if a is None else np.ascontiguousarray(a, np.float64) for a in (self.compliance, shape, values)]
        at = [None if a is None else a.ctypes.data for a in own]
        which = (0, None) if places is None else (places.size, places.ctypes.data)
        return (c.byref(curve), (at[0], None if family is None else c.byref(family), at[1], *which, at[2])), own


def batch_in_series(
    rows: Rows, cut: native.Mesh, start: NDArray[Any], using: int | None = None
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries of many contacts (START_DTYPE), in series with their springs; the GIL is released."""
    start = np.ascontiguousarray(start, native.START_DTYPE)
    (curve, differing), _held = rows.arguments()
    summary, status = np.empty(start.size, native.SUMMARY_DTYPE), np.empty(start.size, np.int32)
    native.library().film_batch_in_series(
        native.instructions() if using is None else using,
        *(curve, c.byref(cut), start.size, start.ctypes.data, *differing),
        *(summary.ctypes.data, status.ctypes.data),
    )
    return status, summary


def by_series(curve: native.Curve, cut: native.Mesh) -> bool:
    """Whether :func:`motions` of damped contacts on the curve, shared by all, are by series, not by lines."""
    return bool(native.library().film_motions_by_series(c.byref(curve), c.byref(cut)))


class Motions(NamedTuple):
    """Forces and depths of many contacts, over scales, (contacts, times); nan without a record. slope: of the force, of
    a reversible law. power: of the contact radius with which the depth of each grows."""

    force: NDArray[np.float64]
    depth: NDArray[np.float64]
    slope: NDArray[np.float64] | None
    power: NDArray[np.float64]


def motions(rows: Rows, cut: native.Mesh, start: NDArray[Any], times: NDArray[np.float64], reversible: bool) -> Motions:
    """The motions of many contacts (START_DTYPE) at ascending times (contacts, times), by lines or `by_series`."""
    start, times = np.ascontiguousarray(start, native.START_DTYPE), np.ascontiguousarray(times, np.float64)
    (curve, differing), _held = rows.arguments()
    force, depth, slope = (np.empty(times.shape) for _ in range(3))
    power, sampled = np.empty(len(times)), np.empty(5 * times.shape[1])
    most = 4 * LINES
    lines, events = np.empty(most, native.LINE_DTYPE), np.empty(EVENTS * native.STATE_DTYPE.itemsize, np.uint8)
    memory = [array.ctypes.data for array in (lines, events, sampled)]
    room = _Room(*memory, times.shape[1], most, EVENTS, native.instructions(), 0)
    found = [array.ctypes.data for array in (times, force, depth)]
    native.library().film_motions_many(
        *(c.byref(room), curve, c.byref(cut), start.size, start.ctypes.data, *differing),
        *(*found, slope.ctypes.data if reversible else None, power.ctypes.data),
    )
    return Motions(force, depth, slope if reversible else None, power)
