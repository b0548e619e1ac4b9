"""Families of curves in the core: a law whose stages depend on one more number, its shape (film_family)."""

from __future__ import annotations

import ctypes as c
from typing import Any

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


def batch_in_series(
    curve: native.Curve,
    family: tuple[Family, native.Curve, NDArray[np.float64]] | None,
    varied: tuple[native.Curve, NDArray[np.int32], NDArray[np.float64]] | None,
    compliance: NDArray[np.float64],
    cut: native.Mesh,
    start: NDArray[Any],
    using: int | None = None,
) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """Statuses and summaries of many contacts (START_DTYPE), each in series with its own spring; the GIL is released.

    curve: of all; or family: with its curve, and the shape of each; or varied: as in `batch_varied`. compliance: of the
    springs, δ_s/F_s.
    """
    start = np.ascontiguousarray(start, native.START_DTYPE)
    of, curve, shape = (None, curve, None) if family is None else family
    curve, places, values = (curve, None, None) if varied is None else varied
    columns = [np.ascontiguousarray(values, np.float64) for values in (compliance, shape, values) if values is not None]
    spring, own = columns[0].ctypes.data, columns[1].ctypes.data if len(columns) > 1 else None
    summary, status = np.empty(start.size, native.SUMMARY_DTYPE), np.empty(start.size, np.int32)
    native.library().film_batch_in_series(
        native.instructions() if using is None else using,
        *(c.byref(curve), c.byref(cut), start.size, start.ctypes.data, spring),
        *(None if of is None else c.byref(of), None if of is None else own),
        *((0, None, None) if places is None else (places.size, places.ctypes.data, own)),
        *(summary.ctypes.data, status.ctypes.data),
    )
    return status, summary
