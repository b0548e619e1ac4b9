"""Families of curves in the core: a law whose stages depend on one more number, its shape (film_family)."""

from __future__ import annotations

import ctypes as c
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.core import native


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


@native.CORE.structure("film_curves")
class _Curves(c.Structure):
    """Curves of many contacts. What they point to is kept alive as `held`."""


def shaped(family: Family, whole: native.Curve, shape: float | NDArray[np.float64]) -> native.Curve:
    """The curve of a shape; of a family over several numbers, that of one contact's."""
    made, numbers = native.Curve.from_buffer_copy(whole), np.array(shape, np.float64)
    if native.library().film_shape(c.byref(family), c.byref(whole), numbers.ctypes.data, c.byref(made)) != native.OK:
        raise ValueError(f"the shape {shape!r} is not between {family.low!r} and {family.high!r}")
    return made


def in_series(curve: native.Curve, compliance: float) -> native.Curve:
    """The curve in series with a spring [δ_s/F_s]."""
    made = native.Curve.from_buffer_copy(curve)
    if native.library().film_spring(c.byref(made), compliance) != native.OK:
        raise ValueError(f"a spring of compliance {compliance!r} cannot be in series with the curve")
    return made


class Rows(NamedTuple):
    """The curves of many contacts. curve: of all, or of the family, of which each has a shape; or that from which each
    differs in the doubles at `places`, whose values are (contacts, places). compliance: of a spring of each in series,
    δ_s/F_s."""

    curve: native.Curve
    family: Family | None = None
    shape: NDArray[np.float64] | None = None
    compliance: NDArray[np.float64] | None = None
    values: NDArray[np.float64] | None = None
    places: NDArray[np.int32] | None = None

    def for_core(self) -> _Curves:
        """These as the core takes them."""
        columns = self.shape, self.compliance, self.values
        own = [None if column is None else np.ascontiguousarray(column, np.float64) for column in columns]
        at = [None if column is None else column.ctypes.data for column in (*own, self.places)]
        family, varying = self.family and c.addressof(self.family), 0 if self.places is None else self.places.size
        made = _Curves(c.addressof(self.curve), family, *at, varying)
        made.held = self, own
        return made


def batch(
    rows: Rows, cut: native.Mesh, start: NDArray[Any], using: int | None = None
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries of many contacts (START_DTYPE) on curves of their own; as `native.batch`."""
    start, curves = np.ascontiguousarray(start, native.START_DTYPE), rows.for_core()
    summary, status = np.empty(start.size, native.SUMMARY_DTYPE), np.empty(start.size, np.int32)
    at = [array.ctypes.data for array in (start, summary, status)]
    instructions = native.instructions() if using is None else using
    native.library().film_batch_of(instructions, c.byref(curves), c.byref(cut), start.size, *at)
    return status, summary


def kinked(curve: native.Curve) -> bool:
    """Whether contacts yield with a kink of their force, which a knot of :func:`motions` meets."""
    return bool(native.library().film_motions_kink(c.byref(curve)))


class Motions(NamedTuple):
    """Forces and depths of many contacts, over scales, (contacts, times); nan without a record. legs: times of the
    turn, the end, and of yield or 0. slope: of the force, of a reversible law. power: of the contact radius with which
    the depth of each grows."""

    legs: NDArray[np.float64]
    force: NDArray[np.float64]
    depth: NDArray[np.float64]
    slope: NDArray[np.float64] | None
    power: NDArray[np.float64]


def motions(rows: Rows, start: NDArray[Any], legs: NDArray[np.float64], knots: int, reversible: bool) -> Motions:
    """The motions of contacts (START_DTYPE) at so many knots of legs whose turn and end are known, (contacts, 2)."""
    start, curves = np.ascontiguousarray(start, native.START_DTYPE), rows.for_core()
    legs, shape = np.pad(legs, ((0, 0), (0, 1))), (len(legs), 2 * (knots + 1))
    times, force, depth, slope = (np.empty(shape) for _ in range(4))
    power = np.empty(len(legs))
    found = [array.ctypes.data for array in (legs, times, force, depth)]
    native.library().film_motions_many(
        *(native.instructions(), c.byref(curves), start.size, start.ctypes.data, shape[1]),
        *(*found, slope.ctypes.data if reversible else None, power.ctypes.data),
    )
    return Motions(legs, force, depth, slope if reversible else None, power)
