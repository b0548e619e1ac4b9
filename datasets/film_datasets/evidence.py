"""Measured and computed values of many sources, one a row: a table in CSV, as a dataset, and as rows for a study."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from film_datasets.provenance import provenance
from film_datasets.schema import MEASUREMENT, TABLE, content_sha256, flag_meanings, flag_words
from film_datasets.schema.tables import EVIDENCE_KINDS, EVIDENCE_QUANTITIES, EVIDENCE_SURENESS
from film_model.studies.validation import Row

if TYPE_CHECKING:
    import xarray as xr

NUMBERS = (
    *("value", "uncertainty", "radius", "mass", "velocity", "effective_modulus"),
    *("yield_strength", "poissons_ratio", "target_impedance"),
)
"""Columns of numbers, SI; an empty cell is NaN."""

_WORDS = {"quantity": EVIDENCE_QUANTITIES, "kind": EVIDENCE_KINDS, "sureness": EVIDENCE_SURENESS}
_VARIABLES = {"kind": "kind_of_value"}


def evidence_from_csv(path: str | os.PathLike[str], references: str | os.PathLike[str]) -> xr.Dataset:
    """The dataset of a table of values. references: table of the words in the column `source`, and their references.

    Raises ValueError for a word that is not known.
    """
    import xarray as xr

    with open(references, encoding="utf-8", newline="") as file:
        sources = {row["source"]: row["reference"] for row in csv.DictReader(file)}
    lines = [line for line in Path(path).read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    known = {**_WORDS, "source": tuple(sources)}
    laws = tuple(dict.fromkeys(row["law"] for row in rows if row["law"]))
    columns: dict[str, Any] = {"law": [laws.index(row["law"]) if row["law"] else -1 for row in rows]}
    for name, words in known.items():
        wrong = sorted({row[name] for row in rows} - set(words))
        if wrong:
            raise ValueError(f"{path}: column {name}: {wrong[0]!r} is not one of {', '.join(words)}")
        variable = "source_of_value" if name == "source" else _VARIABLES.get(name, name)
        columns[variable] = [words.index(row[name]) for row in rows]
    for name in NUMBERS:
        columns[name] = [float(row[name]) if row[name] else np.nan for row in rows]
    meanings = {"sources": flag_words(list(sources)), "laws": flag_words(laws)}
    table = TABLE[f"{MEASUREMENT} values"]
    ds = xr.Dataset({v.name: (v.dims, np.asarray(columns[v.name], v.dtype), v.attributes(meanings)) for v in table})
    ds.attrs = {
        **provenance(
            MEASUREMENT,
            title="Impacts measured, computed with finite elements, or derived",
            summary=f"{len(rows)} values from {len(sources)} sources, with their conditions and uncertainty.",
            source=f"published values, from the file {Path(path).name}",
            command="film_datasets.evidence.evidence_from_csv",
            comment="One value a row. The yield strength of a steel is the pressure of its Vickers hardness on the "
            "projected area over 2.8 (Tabor 1951).",
        ),
        "measured": "values",
        "sources": "\n".join(f"{word}: {reference}" for word, reference in sources.items()),
        "notes": "\n".join(row["note"] or "none" for row in rows),
    }
    ds.attrs["content_sha256"] = content_sha256(ds)
    return ds


def evidence_rows(ds: xr.Dataset) -> list[Row]:
    """The rows of such a dataset."""
    words = {name: flag_meanings(ds[name]) for name in ("quantity", "source_of_value", "kind_of_value", "sureness")}
    laws, notes = flag_meanings(ds["law"]), str(ds.attrs["notes"]).split("\n")
    rows: list[Row] = []
    for k, note in enumerate(notes):
        at = {name: words[name][int(ds[name][k])] for name in words}
        number = int(ds["law"][k])
        rows.append(
            Row(
                **{name: float(ds[name][k]) for name in NUMBERS},
                quantity=at["quantity"],
                source=at["source_of_value"],
                kind=at["kind_of_value"],
                sureness=at["sureness"],
                law="" if number < 0 else laws[number + 1],
                note=note,
            )
        )
    return rows
