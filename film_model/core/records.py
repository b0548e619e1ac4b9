"""The lines of many contacts, and samples of their motions: `film_many.c` from Python."""

from __future__ import annotations

import ctypes as c
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.core import native

LINES, EVENTS = 1 << 14, 1 << 10
"""Lines and events that are recorded at a time; a contact with more is recorded by itself."""


class Rows(NamedTuple):
    """Rows of many contacts, such as lines, one after the other, and how many each has."""

    table: NDArray[Any]
    counts: NDArray[np.int32]

    def part(self, places: NDArray[np.intp]) -> Rows:
        """Of some of the contacts."""
        counts = self.counts[places]
        return Rows(
            _words(self.table)[_positions(_begins(self.counts)[places], counts)].view(self.table.dtype)[:, 0], counts
        )

    @classmethod
    def together(
        cls, parts: Sequence[tuple[NDArray[np.intp], Rows]], count: int, dtype: np.dtype[Any] = native.LINE_DTYPE
    ) -> Rows:
        """Of `count` contacts, from parts and the places of their contacts; a place in no part has no rows."""
        counts = np.zeros(count, np.int32)
        for places, rows in parts:
            counts[places] = rows.counts
        begins, table = _begins(counts), np.empty(int(counts.sum(dtype=np.int64)), dtype)
        for places, rows in parts:
            _words(table)[_positions(begins[places], rows.counts)] = _words(rows.table)
        return cls(table, counts)


def _words(table: NDArray[Any]) -> NDArray[np.uint64]:
    """A table as rows of 8-byte words, which NumPy copies much faster than structures."""
    return table.view(np.uint64).reshape(table.size, table.dtype.itemsize // 8)


def _begins(counts: NDArray[np.int32]) -> NDArray[np.int64]:
    return np.cumsum(counts, dtype=np.int64) - counts


def _positions(begins: NDArray[np.int64], counts: NDArray[np.int32]) -> NDArray[np.int64]:
    """The positions begins[i] … begins[i] + counts[i] - 1 of every i, one after the other."""
    return np.repeat(begins - _begins(counts), counts) + np.arange(int(counts.sum(dtype=np.int64)))


def record_many(curve: native.Curve, cut: native.Mesh, start: NDArray[Any]) -> Rows:
    """The lines of each of many contacts (START_DTYPE); none for one that fails or does not begin with a velocity."""
    start, record = np.ascontiguousarray(start, native.START_DTYPE), native.library().film_record_many
    memory, events = np.empty(LINES, native.LINE_DTYPE), np.empty(EVENTS * native.STATE_DTYPE.itemsize, np.uint8)
    counts, found, first = np.empty(start.size, np.int32), [_words(memory[:0])], 0
    while first < start.size:
        left, own = start[first:], counts[first:]
        at, rooms = (left.ctypes.data, memory.ctypes.data, LINES), (own.ctypes.data, events.ctypes.data, EVENTS)
        done = record(c.byref(curve), c.byref(cut), left.size, *at, *rooms)
        lines = memory[: int(own[:done].sum(dtype=np.int64))]
        if done == 0:
            lines, done = _alone(curve, cut, native.Start(*left[0].tolist())), 1
            own[0] = lines.size
        found.append(_words(lines).copy())
        first += done
    return Rows(np.concatenate(found).view(native.LINE_DTYPE)[:, 0], counts)


def _alone(curve: native.Curve, cut: native.Mesh, begin: native.Start) -> NDArray[Any]:
    status, lines, _ = native.record(curve, cut, native.initial_state(curve, begin), begin.time_limit, 4 * LINES)
    return lines if status >= 0 else lines[:0]


def sample_many(curve: native.Curve, lines: Rows, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """(contacts, times, 5) values as `native.sample` at ascending times (contacts, times); every contact has lines."""
    times, table = np.ascontiguousarray(times, np.float64), np.ascontiguousarray(lines.table)
    values, flags = np.empty((*times.shape, 5)), np.empty((2, times.shape[1]), np.int8)
    tables = table.ctypes.data, lines.counts.ctypes.data, times.shape[1], times.ctypes.data, values.ctypes.data
    native.library().film_sample_many(c.byref(curve), len(times), *tables, *(flag.ctypes.data for flag in flags))
    return values
