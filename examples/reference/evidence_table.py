"""The table of measured and computed values in CSV as a dataset."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from film_datasets.evidence import LINES, NUMBERS
from film_datasets.provenance import dataset_of
from film_datasets.schema import MEASUREMENT, TABLE, flag_words
from film_model.studies.validation_rows import Row

_VARIABLES = {"kind": "kind_of_value", "source": "source_of_value"}
_FLAGS = {v.name: tuple(word for number, word in v.flags if number >= 0) for v in TABLE[f"{MEASUREMENT} values"]}
_WORDS = {name: _FLAGS[_VARIABLES.get(name, name)] for name in ("quantity", "kind", "sureness")}


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
        "command": "python -m examples.published_datasets",
        "comment": "One value a row. Attributes notes, balls and targets have one line for each row; the last two "
        "are the materials of measured impacts, as in a scene file.",
    }
    own = {
        "measured": "values",
        "sources": "\n".join(f"{word}: {reference}" for word, reference in sources.items()),
        **{name: "\n".join(row[column] or "none" for row in rows) for name, column in LINES.items()},
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
