"""The closed forms of impacts as columns: tables whose rows follow each other, along the dimensions `schema.RAGGED`."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.impacts import ClosedForms
from film_datasets.schema import RAGGED, SHARED, Variable
from film_model.base.arrays import Index
from film_model.core.records import Rows
from film_model.solve.closed_form import TABLES

Columns = dict[str, NDArray[Any]]


def ragged_dims(variables: Sequence[Variable]) -> tuple[str, ...]:
    """The dimensions of `RAGGED` that some variables have."""
    return tuple(dim for dim in RAGGED if any(dim in variable.dims for variable in variables))


def fields_of(dim: str) -> dict[str, str]:
    """The variables along a dimension, with the fields of the table that they hold."""
    return {f"{dim}_{name}": name for name in TABLES[dim].names or ()}


def ragged_columns(forms: Sequence[tuple[Index, ClosedForms]], count: int, dims: Sequence[str]) -> Columns:
    """The columns of `count` impacts, from closed forms and the places of their impacts."""
    columns: Columns = {}
    for dim in dims:
        if dim in SHARED:
            rows, columns[f"{dim}_begin"] = _shared(forms, count, dim)
        else:
            parts = [(places, form.tables[dim]) for places, form in forms if dim in form.tables]
            rows = Rows.together(parts, count, TABLES[dim])
        columns[f"{dim}_count"] = rows.counts
        columns |= {own: np.ascontiguousarray(rows.columns[name]) for own, name in fields_of(dim).items()}
    return columns


def _shared(forms: Sequence[tuple[Index, ClosedForms]], count: int, dim: str) -> tuple[Rows, NDArray[np.int64]]:
    """The different tables, one after the other, with the numbers of each impact's rows, and where they begin."""
    begins, counts = np.zeros(count, np.int64), np.zeros(count, np.int32)
    known, tables = _Known(), [np.empty(0, TABLES[dim])]
    for places, form in forms:
        if dim in form.shared:
            table = form.shared[dim]
            begin, is_new = known.place(table)
            begins[places], counts[places] = begin, table.size
            tables += [table] if is_new else []
    return Rows.of_table(np.concatenate(tables), counts), begins


class _Known:
    """The tables so far, each different one once."""

    def __init__(self) -> None:
        self._begins: dict[bytes, int] = {}
        self._rows = 0

    def place(self, table: NDArray[Any]) -> tuple[int, bool]:
        """Where a table begins, and whether there was none equal to it."""
        key = hashlib.sha256(table.tobytes()).digest()
        is_new = key not in self._begins
        if is_new:
            self._begins[key] = self._rows
            self._rows += table.size
        return self._begins[key], is_new


class Places:
    """Where the rows of impacts are in the tables of a whole sweep, block by block."""

    def __init__(self, dims: Sequence[str]) -> None:
        self._rows = dict.fromkeys(dims, 0)
        self._known = {dim: _Known() for dim in dims if dim in SHARED}

    def put(self, columns: Columns) -> None:
        """Set where the rows of the next block begin; of shared tables those that earlier blocks have are omitted."""
        for dim in self._rows:
            if dim in SHARED:
                self._put_shared(columns, dim)
                continue
            ends = self._rows[dim] + np.cumsum(columns[f"{dim}_count"], dtype=np.int64)
            columns[f"{dim}_begin"], self._rows[dim] = ends - columns[f"{dim}_count"], int(ends[-1])

    def _put_shared(self, columns: Columns, dim: str) -> None:
        begins, counts, names = columns[f"{dim}_begin"].copy(), columns[f"{dim}_count"], fields_of(dim)
        table = np.empty(len(columns[next(iter(names))]), TABLES[dim])
        for own, name in names.items():
            table[name] = columns[own]
        kept = [table[:0]]
        pairs = np.stack([begins[counts > 0], counts[counts > 0]], axis=1)
        for begin, count in np.unique(pairs, axis=0).tolist():
            rows = table[begin : begin + count]
            place, is_new = self._known[dim].place(rows)
            columns[f"{dim}_begin"] = np.where((begins == begin) & (counts == count), place, columns[f"{dim}_begin"])
            kept += [rows] if is_new else []
        joined = np.concatenate(kept)
        columns.update({own: np.ascontiguousarray(joined[name]) for own, name in names.items()})
