"""What law "auto" gives for measured impacts with other inputs, and what other laws give."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from film_model.base.flow_stress import REPRESENTATIVE_STRAIN
from film_model.problem.law_of_scene import ELASTIC
from film_model.problem.model_intervals import ABOVE
from film_model.studies.validation import AUTO, Prediction, predict
from film_model.studies.validation_rows import JOHNSON_COOK, Row

COMPLETE, BY_NAME = "complete: hardness and rate", "steel of the catalogue by name"
FAST = "rebounds beyond 50 yield velocities"
ROUGH = "hardness not known within ±10 %"
"""Inputs that are compared, in words."""

NEAR = 0.1
"""Error within which a measured value counts as met."""


class Spread(NamedTuple):
    """Errors of some values: how many; of the absolute ones the median, that of 90 % of them, the share within `NEAR`
    and the largest; and the median with its sign."""

    rows: int
    median: float
    most: float
    near: float
    worst: float
    bias: float

    @classmethod
    def of(cls, found: Iterable[Prediction]) -> Spread:
        """Of the values that were simulated, at least one."""
        signed = [p.error for p in found if not math.isnan(p.value)]
        errors = sorted(map(abs, signed))
        near = sum(error <= NEAR for error in errors) / len(errors)
        return cls(
            len(errors),
            statistics.median(errors),
            errors[int(0.9 * len(errors))],
            near,
            errors[-1],
            statistics.median(signed),
        )


def elastic(rows: Sequence[Row]) -> list[Prediction]:
    """Hertz's law on theories of elastic contacts."""
    return [predict(ELASTIC, row) for row in rows if row.kind == "theory" and not row.yields]


def own_numbers(rows: Sequence[Row]) -> list[Prediction]:
    """What laws give for values computed with them, or fitted by their own authors: they confirm no law."""
    return [predict(row.law, row) for row in rows if row.kind in ("own_fit", "same_law")]


def inputs_of(rows: Iterable[Row]) -> dict[str, list[Prediction]]:
    """What law "auto" gives for steels with complete conditions, with other inputs, and for those of which the
    hardness is not known well: by input, in words. Fast rebounds with waves and hardening, too."""
    own = list(rows)
    hard = [row for row in own if row.of_steel]
    groups = {
        COMPLETE: hard,
        **{f"every steel with C = {c}": [row.with_rate(c) for row in hard] for *_, c in JOHNSON_COOK.values()},
        "hardness without rate": [row.with_rate(None) for row in hard],
        BY_NAME: [row.by_name for row in hard],
        ROUGH: [row for row in own if row.rough],
    }
    found = {name: [predict(AUTO, row) for row in group] for name, group in groups.items()}
    fast = [p for p in found[COMPLETE] if p.family == ABOVE and p.row.quantity == "coefficient_of_restitution"]
    waves = [predict(AUTO, p.row, {"effects.wave_losses": True}) for p in fast]
    hardening = [predict(AUTO, p.row.hardening) for p in fast]
    return found | {FAST: fast, f"{FAST}, waves forced": waves, f"{FAST}, hardening": hardening}


def within_input(rows: Iterable[Row]) -> tuple[int, int]:
    """Of the rows of which the hardness is known, but not well: how many law "auto" meets with a hardness in its range,
    and how many there are."""
    known = [row for row in rows if row.rough and row.input_uncertainty == row.input_uncertainty]
    met = 0
    for row in known:
        ends = (1.0 - row.input_uncertainty, 1.0 + row.input_uncertainty)
        low, high = sorted(predict(AUTO, row.with_hardness((row.hardness or 0.0) * end)).value for end in ends)
        met += low <= row.value <= high
    return met, len(known)


def flow_of(name: str) -> float:
    """Flow stress A + B ε^n of one of these steels in slow loading, at the strain of a Vickers indentation, Pa."""
    strength, coefficient, exponent, _ = JOHNSON_COOK[name]
    return strength + coefficient * REPRESENTATIVE_STRAIN**exponent
