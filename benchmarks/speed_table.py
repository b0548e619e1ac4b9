"""The table of docs/understand/accuracy_and_cost.md, from the rows of `benchmarks.speed`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parent.parent / "docs" / "understand" / "accuracy_and_cost.md"
CASES = {
    "Hertz, plates, λ 0.05-3": "Hertz, plates, λ 0.05–3",
    "Big-Alabo, plate, 0.05-2 m/s": "Big-Alabo, plate",
    "Stronge, half-space, 0.05-2 m/s": "Stronge, half-space",
    "Big-Alabo, half-space, 0.05-2 m/s": "Big-Alabo, half-space",
}
"""Cases of the table, and what it calls them."""

HEAD = "| impacts | error | FILM, batch | best rival, batch | FILM, one impact | best rival, one impact |"
FILM, ALONE = "FILM, work-preserving", "one impact alone"
BATCH, ONE = (", lanes", ", numba"), (", one impact", "5(4), numba")  # how the names of rivals end


def write(rows: Sequence[dict[str, Any]]) -> None:
    """Put the table into the page, in the place of the one that is there."""
    lines = PAGE.read_text(encoding="utf-8").split("\n")
    begin = lines.index(HEAD)
    end = next(k for k in range(begin, len(lines)) if not lines[k])
    PAGE.write_text("\n".join([*lines[:begin], *table(rows), *lines[end:]]), encoding="utf-8")


def table(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Lines of the table."""
    made = [HEAD, "|---" * 6 + "|"]
    for case, said in CASES.items():
        for target in sorted({row["target"] for row in rows}, reverse=True):
            those = [row for row in rows if row["case"] == case and row["target"] == target]
            here = {row["contender"].strip(): row["microseconds"] for row in those}
            cells = [said, f"{target:.0e}".replace("e-0", "e-")]
            for own, ends in ((FILM, BATCH), (ALONE, ONE)):
                cells += [_number(here[own]), _best(here, ends, here[own])]
            made.append(f"| {' | '.join(cells)} |")
            said = ""
    return [re.sub(r"^\|  \|", "| |", line) for line in made]


def _best(here: dict[str, float | None], ends: tuple[str, ...], film: float) -> str:
    """The fastest rival whose name ends so, its time, and that over FILM's."""
    found = [(time, name) for name, time in here.items() if time is not None and name.endswith(ends)]
    if not found:
        return "–"
    time, name = min(found)
    ratio = time / film
    return f"{name.split()[0]} {_number(time)} ({ratio:.{0 if ratio >= 9.5 else 1 if ratio >= 1 else 2}f}×)"


def _number(microseconds: float) -> str:
    return f"{microseconds:#.2g}".rstrip(".")
