"""Write film_model/problem/model_intervals.json: `python -m examples.model_intervals [FILE]`.

The residuals of the measured rows that are not held out, under law "auto" with rate hardening and without; run it when
that law or the rows change, and then `python -m examples.validation_page`.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import film_datasets as fd
from examples.reference.validation_inputs import with_rate
from film_datasets.evidence import evidence_rows
from film_model.problem.law_of_scene import ELASTIC, YIELDING
from film_model.problem.model_intervals import (
    COVERED,
    FAMILIES,
    POOLED,
    SLOW,
    STORED,
    Residuals,
    Table,
    by_family,
    residuals_of,
    yield_velocities,
)
from film_model.studies.validation import AUTO, Prediction, predict, scene_of
from film_model.studies.validation_rows import Row

DIGITS = 4
"""Decimals of a stored residual: 0.01 % of the value."""


class Coverage(NamedTuple):
    """How many rows lie in their interval, of how many that have one. spread: one standard deviation of the share."""

    inside: int
    rows: int

    @property
    def share(self) -> float:
        """The share of the rows in their interval."""
        return self.inside / self.rows if self.rows else math.nan

    @property
    def spread(self) -> float:
        """Standard deviation of the share if 90 % is true and the rows are independent."""
        return math.sqrt(COVERED * (1.0 - COVERED) / self.rows) if self.rows else math.nan


def predictions(rows: Iterable[Row]) -> list[Prediction]:
    """What law "auto" gives for the measured rows whose conditions are complete."""
    return [predict(AUTO, row) for row in rows if row.usable]


def slow_predictions(rows: Iterable[Row]) -> list[Prediction]:
    """The same where a row has a rate law, computed without it."""
    slow = ((row, with_rate(row, None)) for row in rows)
    return predictions(without for row, without in slow if without != row)


def residuals(found: Sequence[Prediction]) -> list[Residuals]:
    """By family and quantity, of rows that are not held out, with what is computed itself; without a rate law, wide
    enough for the same with one."""
    used = [one for one in found if not one.row.held_out and one.value > 0.0]
    table: list[Residuals] = []
    for family in FAMILIES:
        own = [one for one in used if one.family in POOLED.get(family, (family,))]
        for quantity in dict.fromkeys(one.row.quantity for one in used):
            rows = [one for one in own if one.row.quantity == quantity]
            if rows:
                low, high = central(sorted(math.log(one.row.value / one.value) for one in rows))
                most = max(yield_velocities(scene_of(AUTO, one.row)) or 0.0 for one in rows)
                ends = (min(round(low, DIGITS), 0.0), max(round(high, DIGITS), 0.0), round(most, 1))
                table.append(Residuals(family, quantity, len(rows), *ends))
    known = by_family(table)
    fast = {slow: family for family, slow in SLOW.items()}
    return [_hull(one, known.get((fast.get(one.family, ""), one.quantity), one)) for one in table]


def _hull(one: Residuals, other: Residuals) -> Residuals:
    return one._replace(low=min(one.low, other.low), high=max(one.high, other.high))


def central(values: Sequence[float]) -> tuple[float, float]:
    """Interval into which the next of exchangeable values falls with a probability of 90 %.

    Its ends are the order statistics of the ranks 0.05 (n + 1) and 0.95 (n + 1), interpolated (split conformal
    prediction, Vovk et al. 2005). Of fewer than 19 values it spans all, with a probability of (n − 1)/(n + 1).
    """
    outside = 0.5 * (1.0 - COVERED)
    return _ranked(values, outside), _ranked(values, 1.0 - outside)


def _ranked(values: Sequence[float], share: float) -> float:
    """The order statistic of rank share (n + 1), interpolated and within the sorted values."""
    place = min(max(share * (len(values) + 1), 1.0), len(values)) - 1.0
    below = min(int(place), max(len(values) - 2, 0))
    above = min(below + 1, len(values) - 1)
    return values[below] + (place - below) * (values[above] - values[below])


def coverage(found: Iterable[Prediction]) -> Coverage:
    """Of the held-out rows, how many lie in the stored interval of their family."""
    return _covered((one for one in found if one.row.held_out), None)


def coverage_of_new_sources(found: Sequence[Prediction]) -> Coverage:
    """Of the held-out rows, how many lie in an interval from the other sources, as for a source not yet seen."""
    held = [one for one in found if one.row.held_out]
    parts = [coverage_from_others(held, found, source) for source in dict.fromkeys(one.row.source for one in found)]
    return Coverage(sum(part.inside for part in parts), sum(part.rows for part in parts))


def coverage_from_others(judged: Iterable[Prediction], found: Sequence[Prediction], source: str) -> Coverage:
    """Of those judged rows that are of this source, how many lie in an interval from the other sources."""
    others = by_family(residuals([one for one in found if one.row.source != source]))
    return _covered((one for one in judged if one.row.source == source), others)


def _covered(found: Iterable[Prediction], table: Table | None) -> Coverage:
    inside = rows = 0
    for one in found:
        own = residuals_of(one.family, one.row.quantity, table) if one.value > 0.0 else None
        if own is not None:
            rows += 1
            inside += own.low <= math.log(one.row.value / one.value) <= own.high
    return Coverage(inside, rows)


def main(path: Path = Path(STORED)) -> Path:
    """Write the file; returns its path."""
    measured = evidence_rows(fd.load("measured_impacts"))
    found = residuals([*predictions(measured), *slow_predictions(measured)])
    rows = ",\n".join(f"    {json.dumps(one._asdict())}" for one in found)
    laws = json.dumps([ELASTIC, YIELDING])
    text = f'{{\n  "made_by": "examples/model_intervals.py",\n  "laws": {laws},\n  "residuals": [\n{rows}\n  ]\n}}\n'
    path.write_text(text, encoding="utf-8")
    return path


if __name__ == "__main__":
    print(main(*map(Path, sys.argv[1:])))
