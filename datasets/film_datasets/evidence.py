"""Measured and computed values of many sources, one a row: a dataset as rows for a study."""

from __future__ import annotations

from typing import Any

from film_datasets.schema import flag_meanings
from film_model.base.foreign import Dataset
from film_model.studies.validation_rows import Row

NUMBERS = (
    *("value", "uncertainty", "input_uncertainty", "radius", "mass", "velocity", "effective_modulus"),
    *("yield_strength", "poissons_ratio", "target_impedance"),
)
"""Columns of numbers, SI; an empty cell is NaN."""

LINES = {"notes": "note", "balls": "ball", "targets": "target"}
"""Attributes with one line for each row → their columns."""


def evidence_rows(ds: Dataset) -> list[Row]:
    """The rows of such a dataset."""
    names = {"quantity": "quantity", "source": "source_of_value", "kind": "kind_of_value", "sureness": "sureness"}
    words = {name: flag_meanings(ds[variable]) for name, variable in names.items()}
    optional = {name: ("", *flag_meanings(ds[name])[1:]) for name in ("law", "matter")}
    lines = {name: str(ds.attrs[name]).split("\n") for name in LINES}
    rows: list[Row] = []
    for k in range(ds.sizes["row"]):
        cells: dict[str, Any] = {
            **{name: float(ds[name][k]) for name in NUMBERS},
            **{name: words[name][int(ds[variable][k])] for name, variable in names.items()},
            **{name: found[int(ds[name][k]) + 1] for name, found in optional.items()},
            **{column: "" if lines[name][k] == "none" else lines[name][k] for name, column in LINES.items()},
        }
        rows.append(Row(**cells, number=int(ds["row_number"][k]), complete=bool(ds["complete"][k])))
    return rows
