"""The lines of many contacts, and samples of their motions: `film_many.c` from Python."""

from __future__ import annotations

import ctypes as c
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index
from film_model.core import native

LINES, EVENTS = 1 << 11, 1 << 10
"""Lines and events that are recorded at a time, which the processor's cache holds; a contact with more is recorded by
itself."""

_WORDS = ("branch", "phase")
_NUMBERS = tuple(name for name in native.LINE_DTYPE.names or () if name not in _WORDS)


class Lines(NamedTuple):
    """The lines (LINE_DTYPE) of some contacts, one after the other, and how many each has."""

    table: NDArray[Any]
    counts: NDArray[np.int32]


class Rows(NamedTuple):
    """Rows of many contacts, such as lines, one after the other, and how many each has. columns: by the fields."""

    columns: Mapping[str, NDArray[Any]]
    counts: NDArray[np.int32]

    @classmethod
    def of_table(cls, table: NDArray[Any], counts: NDArray[np.int32]) -> Rows:
        """Those of an array of structures."""
        return cls({name: table[name] for name in table.dtype.names or ()}, counts)

    @classmethod
    def together(cls, parts: Sequence[tuple[Index, Rows]], count: int, dtype: np.dtype[Any]) -> Rows:
        """Of `count` contacts, from parts and their contacts' ascending places; a place in no part has no rows."""
        if len(parts) == 1 and parts[0][0].size == count:
            return parts[0][1]
        counts = np.zeros(count, np.int32)
        for places, rows in parts:
            counts[places] = rows.counts
        begins, table = _begins(counts), cls.of_table(np.empty(0, dtype), counts)
        length = int(counts.sum(dtype=np.int64))
        columns = {name: np.empty((length, *empty.shape[1:]), empty.dtype) for name, empty in table.columns.items()}
        for places, rows in parts:
            positions = _positions(begins[places], rows.counts)
            for name, column in columns.items():
                column[positions] = rows.columns[name]
        return cls(columns, counts)


def _begins(counts: NDArray[np.int32]) -> NDArray[np.int64]:
    return np.cumsum(counts, dtype=np.int64) - counts


def _positions(begins: NDArray[np.int64], counts: NDArray[np.int32]) -> NDArray[np.int64]:
    """The positions begins[i] … begins[i] + counts[i] - 1 of every i, one after the other."""
    return np.repeat(begins - _begins(counts), counts) + np.arange(int(counts.sum(dtype=np.int64)))


def recorded(curve: native.Curve, cut: native.Mesh, start: NDArray[Any]) -> Iterator[tuple[slice, Lines]]:
    """The lines of many contacts (START_DTYPE), in parts of contacts that follow one another: which contacts, and their
    lines, in memory that the next part overwrites. A contact that fails or begins without a velocity has none."""
    start, record = np.ascontiguousarray(start, native.START_DTYPE), native.library().film_record_many
    memory, events = np.empty(LINES, native.LINE_DTYPE), np.empty(EVENTS * native.STATE_DTYPE.itemsize, np.uint8)
    counts, first = np.empty(start.size, np.int32), 0
    while first < start.size:
        left, own = start[first:], counts[first:]
        at, rooms = (left.ctypes.data, memory.ctypes.data, LINES), (own.ctypes.data, events.ctypes.data, EVENTS)
        done = record(c.byref(curve), c.byref(cut), left.size, *at, *rooms)
        lines = memory[: int(own[:done].sum(dtype=np.int64))]
        if done == 0:
            lines, done = _alone(curve, cut, native.Start(*left[0].tolist())), 1
            own[0] = lines.size
        yield slice(first, first + done), Lines(lines, own[:done])
        first += done


def _alone(curve: native.Curve, cut: native.Mesh, begin: native.Start) -> NDArray[Any]:
    """The lines of one contact that may have more than `LINES`."""
    status, lines, _, _ = native.record(curve, cut, native.initial_state(curve, begin), begin.time_limit, 4 * LINES)
    return lines if status >= 0 else lines[:0]


def record_many(curve: native.Curve, cut: native.Mesh, start: NDArray[Any]) -> Rows:
    """The lines of many contacts, as `recorded` gives them."""
    counts, end = np.empty(start.size, np.int32), 0
    numbers, words = np.empty((len(_NUMBERS), 0)), np.empty((len(_WORDS), 0), np.int32)
    for part, lines in recorded(curve, cut, start):
        begin, end = end, end + lines.table.size
        counts[part] = lines.counts
        if end > numbers.shape[1]:  # room for all, if the rest have about as many
            room = LINES + int(1.1 * end * start.size / part.stop)
            numbers, words = _longer(numbers, begin, room), _longer(words, begin, room)
        at = numbers[:, begin:].ctypes.data, words[:, begin:].ctypes.data
        native.library().film_line_columns(lines.table.size, lines.table.ctypes.data, numbers.shape[1], *at)
    columns = {name: column[:end] for name, column in zip(_NUMBERS, numbers, strict=True)}
    return Rows(columns | {name: column[:end] for name, column in zip(_WORDS, words, strict=True)}, counts)


def _longer(columns: NDArray[Any], begun: int, length: int) -> NDArray[Any]:
    """Columns of another length with the rows that are there."""
    longer = np.empty((len(columns), length), columns.dtype)
    longer[:, :begun] = columns[:, :begun]
    return longer


def sample_many(curve: native.Curve, lines: Lines, times: Array) -> Array:
    """(5, contacts, times) values as `native.sample` at ascending times (contacts, times); every contact has lines."""
    times, table = np.ascontiguousarray(times, np.float64), np.ascontiguousarray(lines.table)
    values = np.empty((5, *times.shape))
    tables = table.ctypes.data, lines.counts.ctypes.data, times.shape[1], times.ctypes.data, values.ctypes.data
    native.library().film_sample_many(native.instructions(), c.byref(curve), len(times), *tables)
    return values
