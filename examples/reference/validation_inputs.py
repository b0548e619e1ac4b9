"""What law "auto" gives for measured impacts with other inputs, and what other laws give."""

from __future__ import annotations

import math
import re
import statistics
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from film_model.base.flow_stress import REPRESENTATIVE_STRAIN, johnson_cook_exponent
from film_model.base.hardness import VICKERS
from film_model.base.materials import catalogue
from film_model.problem.law_of_scene import ELASTIC
from film_model.problem.model_intervals import ABOVE
from film_model.studies.validation import AUTO, Prediction, predict
from film_model.studies.validation_rows import HARDNESS, Row

COMPLETE, BY_NAME = "complete: hardness and rate", "steel of the catalogue by name"
FAST = "rebounds beyond 50 yield velocities"
ROUGH = "hardness not known within ±10 %"
"""Inputs that are compared, in words."""

NEAR = 0.1
"""Error within which a measured value counts as met."""


LARGEST_INPUT_UNCERTAINTY = 0.1
"""Relative uncertainty of the hardness or strength up to which the conditions of a row are complete."""

JOHNSON_COOK = {
    "1006": (350e6, 275e6, 0.36, 0.022),
    "4340": (792e6, 510e6, 0.26, 0.014),
    "S-7": (1539e6, 477e6, 0.18, 0.012),
}
"""A, B [Pa], n and C of the three steels of Johnson & Cook 1983, Proc. 7th Int. Symp. on Ballistics, 541-547."""

_RATE = re.compile(r", strain_rate_coefficient = ([0-9.]+)")


def steels() -> dict[str, float]:
    """The steels of the catalogue whose hardness is known, HV, by name, the softest first."""
    found = {name: one.hardness / VICKERS for name, one in catalogue().items() if "steel" in name and one.hardness}
    return dict(sorted(found.items(), key=lambda steel: steel[1]))


def rough(row: Row) -> bool:
    """Whether a row can be simulated, but its hardness is not known within `LARGEST_INPUT_UNCERTAINTY`."""
    able = row.hardness is not None and all(x == x for x in (row.radius, row.mass, row.velocity))
    return row.kind == "measured" and able and not row.input_uncertainty <= LARGEST_INPUT_UNCERTAINTY


def with_rate(row: Row, coefficient: float | None) -> Row:
    """The row with another strain rate coefficient of its target, or without one."""
    given = "" if coefficient is None else f", strain_rate_coefficient = {coefficient}"
    return row._replace(target=_RATE.sub(given, row.target))


def hardening(row: Row) -> Row:
    """The row with the strain hardening exponent of that steel of Johnson & Cook whose C its target has."""
    rate = _RATE.search(row.target)
    if rate is None:
        return row
    strength, coefficient, power, _ = next(steel for steel in JOHNSON_COOK.values() if steel[3] == float(rate[1]))
    exponent = johnson_cook_exponent(strength, coefficient, power, 210e9)  # Pa, of steel
    before, after = row.target[: rate.end()], row.target[rate.end() :]
    return row._replace(target=f"{before}, strain_hardening_exponent = {exponent:.6f}{after}")


def with_hardness(row: Row, vickers: float) -> Row:
    """The row with another hardness of its target."""
    return row._replace(target=HARDNESS.sub(f'hardness = "{vickers!r} HV"', row.target))


def by_name(row: Row) -> Row:
    """The row with the steel of the catalogue as its target of which the Vickers hardness is nearest."""
    own, known = row.hardness, steels()
    return row if own is None else row._replace(target=f'"{min(known, key=lambda name: abs(known[name] - own))}"')


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
        **{f"every steel with C = {c}": [with_rate(row, c) for row in hard] for *_, c in JOHNSON_COOK.values()},
        "hardness without rate": [with_rate(row, None) for row in hard],
        BY_NAME: [by_name(row) for row in hard],
        ROUGH: [row for row in own if rough(row)],
    }
    found = {name: [predict(AUTO, row) for row in group] for name, group in groups.items()}
    fast = [p for p in found[COMPLETE] if p.family == ABOVE and p.row.quantity == "coefficient_of_restitution"]
    waves = [predict(AUTO, p.row, {"effects.wave_losses": True}) for p in fast]
    hardened = [predict(AUTO, hardening(p.row)) for p in fast]
    return found | {FAST: fast, f"{FAST}, waves forced": waves, f"{FAST}, hardening": hardened}


def within_input(rows: Iterable[Row]) -> tuple[int, int]:
    """Of the rows of which the hardness is known, but not well: how many law "auto" meets with a hardness in its range,
    and how many there are."""
    known = [row for row in rows if rough(row) and row.input_uncertainty == row.input_uncertainty]
    met = 0
    for row in known:
        ends = (1.0 - row.input_uncertainty, 1.0 + row.input_uncertainty)
        low, high = sorted(predict(AUTO, with_hardness(row, (row.hardness or 0.0) * end)).value for end in ends)
        met += low <= row.value <= high
    return met, len(known)


def flow_of(name: str) -> float:
    """Flow stress A + B ε^n of one of these steels in slow loading, at the strain of a Vickers indentation, Pa."""
    strength, coefficient, exponent, _ = JOHNSON_COOK[name]
    return strength + coefficient * REPRESENTATIVE_STRAIN**exponent
