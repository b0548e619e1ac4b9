"""The variables of `variables.csv`, the one table of what datasets hold, by the parts of datasets that they are in."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from pathlib import Path

from film_datasets.schema.variable import BYTE, FLOAT, INTEGER, LONG, TEXT, Variable
from film_model.base.errors import STATUSES
from film_model.base.units import si_unit
from film_model.core.native import EVENTS, PHASES
from film_model.oblique.result import BOUNDS, KINDS, OBLIQUE, REGIMES
from film_model.problem.scales import Scales
from film_model.solve import sensed
from film_model.solve.bounce import COLUMNS
from film_model.solve.chain_motion import BODIES, CONTACTS
from film_model.solve.history import MOTION, SUMMARY
from film_model.studies.reference import COMPARED

BRANCHES = {-2: "no_contact", -1: "unloading"}
"""Stage numbers below the law's own, which count from 0."""

IMPACT_STATUSES = {code: status for code, status in sorted(STATUSES.items()) if status.of_row}
"""The statuses that an impact of a sweep can have, besides those of values that are out of range."""

OUT_OF_RANGE = max(IMPACT_STATUSES) + 1
"""Status of an impact whose value of the first swept quantity is out of range, +1 for the second, and so on."""

MEASURED_MOTION = {
    **MOTION,
    "impactor_acceleration": (
        "acceleration",
        "as an accelerometer on the impactor reads it, positive into the target: less contact force over mass",
    ),
}
"""Quantities of a measured history: dimension and description."""

_TYPES = {"float": FLOAT, "byte": BYTE, "integer": INTEGER, "long": LONG, "text": TEXT}

_EACH: dict[str, Mapping[str, tuple[str, str]]] = {
    **{"motion": MOTION, "measured motion": MEASURED_MOTION, "summary": SUMMARY},
    **{"oblique": OBLIQUE, "bounds": BOUNDS},
    **{"sensed": sensed.MOTION, "strain": sensed.STRAIN, "bounces": COLUMNS, "bodies": BODIES, "contacts": CONTACTS},
    "compared": {name: SUMMARY[name] for name in COMPARED},
    "scales": {name: (name, "") for name in Scales._fields},
}
"""Tables for each row of which a row of the file stands: dimension and description by name."""

_FLAGS = {
    "=branches": tuple(BRANCHES.items()),
    "=events": tuple(enumerate(EVENTS))[1:],
    "=phases": tuple(enumerate(PHASES)),
    "=regimes": ((-1, "none"), *enumerate(word.replace(" ", "_") for word in REGIMES)),
    "=friction phases": tuple(enumerate(KINDS)),
    "=statuses": tuple((code, status.word) for code, status in IMPACT_STATUSES.items()),
}
"""Flags that are those of other tables; the others are in the file, as "0:no 1:yes"."""


def _variables(row: Mapping[str, str]) -> Iterator[Variable]:
    """The variables of a row: one, or one for each row of a table of `_EACH`, whose words are put into its texts."""
    for name, (dimension, what) in _EACH.get(row["each"], {"": ("", "")}).items():
        words = {"name": name, "words": name.replace("_", " "), "what": what, "short": what.partition(";")[0]}
        own, long_name, comment = (
            row[key].format(**words) if name else row[key] for key in ("name", "long_name", "comment")
        )
        dimension = row["dimension"] or dimension
        pairs = (pair.split(":") for pair in row["flags"].split() if row["flags"] not in _FLAGS)
        yield Variable(
            *(own, tuple(row["dims"].split()), _TYPES[row["type"]], si_unit(dimension) if dimension else None),
            *(long_name, comment, _FLAGS.get(row["flags"]) or tuple((int(value), word) for value, word in pairs)),
            *(row["more"], OUT_OF_RANGE if row["more"] == "out_of_range" else 0),
            *(row["optional"] == "yes", row["sample_dimension"]),
        )


def _read() -> dict[str, tuple[Variable, ...]]:
    parts: dict[str, tuple[Variable, ...]] = {}
    with open(Path(__file__).with_name("variables.csv"), encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            parts[row["part"]] = (*parts.get(row["part"], ()), *_variables(row))
    return parts


PARTS = _read()
"""Variables by the part of a dataset that they are in."""
