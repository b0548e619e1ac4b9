"""Measured and computed values of many sources, one a row: a table in CSV, as a dataset, and as rows for a study."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from film_datasets.provenance import dataset_of
from film_datasets.schema import MEASUREMENT, TABLE, flag_meanings, flag_words
from film_model.studies.validation_rows import Row

if TYPE_CHECKING:
    import xarray as xr

NUMBERS = (
    *("value", "uncertainty", "input_uncertainty", "radius", "mass", "velocity", "effective_modulus"),
    *("yield_strength", "poissons_ratio", "target_impedance"),
)
"""Columns of numbers, SI; an empty cell is NaN."""

_VARIABLES = {"kind": "kind_of_value", "source": "source_of_value"}
_FLAGS = {v.name: tuple(word for number, word in v.flags if number >= 0) for v in TABLE[f"{MEASUREMENT} values"]}
_WORDS = {name: _FLAGS[_VARIABLES.get(name, name)] for name in ("quantity", "kind", "sureness")}
_LINES = {"notes": "note", "balls": "ball", "targets": "target"}
"""Attributes with one line for each row → their columns."""


def evidence_from_csv(path: str | os.PathLike[str], references: str | os.PathLike[str]) -> xr.Dataset:
    """The dataset of a table of values. references: table of the words in the column `source`, and their references.

    Raises ValueError for a word that is not known.
    """
    with open(references, encoding="utf-8", newline="") as file:
        sources = {row["source"]: row["reference"] for row in csv.DictReader(file)}
    lines = [line for line in Path(path).read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    known = {**_WORDS, "source": tuple(sources)}
    laws = tuple(dict.fromkeys(row["law"] for row in rows if row["law"]))
    for name, words in known.items():
        wrong = sorted({row[name] for row in rows} - set(words))
        if wrong:
            raise ValueError(f"{path}: column {name}: {wrong[0]!r} is not one of {', '.join(words)}")
    plain = [_row(row) for row in rows]
    columns: dict[str, Any] = {
        **{name: [getattr(row, name) for row in plain] for name in NUMBERS},
        **{_VARIABLES.get(name, name): [words.index(row[name]) for row in rows] for name, words in known.items()},
        "law": [laws.index(row.law) if row.law else -1 for row in plain],
        "matter": [_FLAGS["matter"].index(row.matter) if row.matter else -1 for row in plain],
        "row_number": [row.number for row in plain],
        "complete": [row.complete for row in plain],
        "held_out": [row.held_out for row in plain],
    }
    about = {
        "title": "Impacts measured, computed with finite elements, or derived",
        "summary": f"{len(rows)} values from {len(sources)} sources, with their conditions and uncertainty.",
        "source": f"published values, from the file {Path(path).name}",
        "command": "film_datasets.evidence.evidence_from_csv",
        "comment": "One value a row. Attributes notes, balls and targets have one line for each row; the last two "
        "are the materials of measured impacts, as in a scene file.",
    }
    own = {
        "measured": "values",
        "sources": "\n".join(f"{word}: {reference}" for word, reference in sources.items()),
        **{name: "\n".join(row[column] or "none" for row in rows) for name, column in _LINES.items()},
    }
    meanings = {"sources": flag_words(list(sources)), "laws": flag_words(laws)}
    return dataset_of(MEASUREMENT, columns, about, own, f"{MEASUREMENT} values", meanings)


def _row(row: dict[str, str]) -> Row:
    """A row of the table, whose cells are text."""
    numbers: dict[str, Any] = {name: float(row[name]) if row[name] else np.nan for name in NUMBERS}
    words: dict[str, Any] = {
        name: row[name] for name in ("quantity", "source", "kind", "sureness", "law", "matter", "ball", "target")
    }
    return Row(**numbers, **words, number=int(row["number"]), complete=row["complete"] == "yes", note=row["note"])


def evidence_rows(ds: xr.Dataset) -> list[Row]:
    """The rows of such a dataset."""
    names = {"quantity": "quantity", "source": "source_of_value", "kind": "kind_of_value", "sureness": "sureness"}
    words = {name: flag_meanings(ds[variable]) for name, variable in names.items()}
    optional = {name: ("", *flag_meanings(ds[name])[1:]) for name in ("law", "matter")}
    lines = {name: str(ds.attrs[name]).split("\n") for name in _LINES}
    rows: list[Row] = []
    for k in range(ds.sizes["row"]):
        cells: dict[str, Any] = {
            **{name: float(ds[name][k]) for name in NUMBERS},
            **{name: words[name][int(ds[variable][k])] for name, variable in names.items()},
            **{name: found[int(ds[name][k]) + 1] for name, found in optional.items()},
            **{column: "" if lines[name][k] == "none" else lines[name][k] for name, column in _LINES.items()},
        }
        rows.append(Row(**cells, number=int(ds["row_number"][k]), complete=bool(ds["complete"][k])))
    return rows
