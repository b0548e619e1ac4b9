"""Write docs/validation.md and its picture: `python examples/validation_page.py [FOLDER]`.

The contact laws against the published dataset `measured_impacts`. Every number on the page is computed here.
"""

import statistics
import sys
from collections.abc import Sequence
from pathlib import Path

import film_datasets as fd
from film_datasets.evidence import evidence_rows
from film_model.plot.validation import plot_validation
from film_model.studies.validation import AUTO, LawReport, Prediction, compare, elastic, measured, own_numbers

DOCS = Path(__file__).parent.parent / "docs"

TEXT = """# Validation

Made by `python examples/validation_page.py` from `datasets/published/measured_impacts.csv`; `film-model validate`
prints the same numbers. {count} values from {sources} sources: {kinds}. Each has its conditions, its uncertainty,
and how it was read: "recollection" marks the {recollected} that could not be opened again. Measured values that
could not be traced are left out, so they are few: Leeb hardness testers (tungsten carbide balls on steel of known
hardness), and two elastic rebounds.

![computed over published values, and the distribution of the errors](validation.png)

## The laws that yield

Absolute errors in percent, median / worst, and of all values the quartiles. "Measured": rebounds and dents of Leeb
hardness testers. "Finite elements": fits of restitution by Jackson, Green & Marghitu and by Wu, Li & Thornton.
"Theory": Johnson's fully plastic impact.

{laws}

{said}

`auto` takes `jackson-green`: it has the smallest median error of all values, and its restitution falls with
velocity. It is right for elastic, perfectly plastic bodies. Its measured restitution is too small by {low} to
{high} %: the steels of the measurements harden, by strain and by strain rate, and their strengths were taken from
static hardness. `kogut-etsion` is closer to these measurements, and further from the finite elements beyond 35
yield velocities, where its restitution falls too slowly. Dents are compared as caps of the ball as deep as the
permanent indentation, without pile-up.

## Elastic contacts

Hertz's law on a half-space, or on a plate of the given impedance. Waves in a half-space and losses in the material
are not simulated, so a rebound from a half-space is complete.

{elastic}

## Values computed with a law

Table 3 of Big-Alabo, Cartmell & Harrison (2017), for five segments a stage, against the converged answer of the
same law.

{own}

## Sources

{references}

## Every value under law "auto"

{rows}
"""


def cell(errors: Sequence[float]) -> str:
    """Median and worst error in percent."""
    return f"{100 * statistics.median(errors):.1f} / {100 * max(errors):.1f}" if errors else ""


def quartiles(errors: Sequence[float]) -> str:
    """The quartiles in percent."""
    return " – ".join(f"{100 * value:.1f}" for value in statistics.quantiles(errors, n=4))


def law_rows(reports: Sequence[LawReport]) -> str:
    """One line a law."""
    lines = [
        "| law | all values | quartiles | measured | finite elements | theory | restitution |",
        "|---|---|---|---|---|---|---|",
    ]
    for report in reports:
        kinds = [
            report.errors(lambda row, kind=kind: row.kind == kind) for kind in ("measured", "finite_element", "theory")
        ]
        falls = "falls" if report.monotone else "not monotone"
        cells = [cell(report.errors()), quartiles(report.errors()), *map(cell, kinds), falls]
        lines.append(f"| `{report.law}` | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def prediction_rows(predictions: Sequence[Prediction]) -> str:
    """One line a value."""
    lines = [
        "| source | quantity | published | computed | error, % | read from | conditions |",
        "|---|---|---|---|---|---|---|",
    ]
    for p in predictions:
        row = p.row
        words = [
            row.source,
            row.quantity.replace("_", " "),
            f"{row.value:.4g}",
            f"{p.value:.4g}",
            f"{100 * p.error:.1f}",
        ]
        lines.append("| " + " | ".join([*words, row.sureness, row.note]) + " |")
    return "\n".join(lines)


def page() -> tuple[str, list[LawReport]]:
    """The page, and the reports for the picture."""
    ds = fd.load("measured_impacts")
    rows = evidence_rows(ds)
    reports = compare(rows)
    auto = next(report for report in reports if report.law == AUTO)
    kinds = {kind: sum(row.kind == kind for row in rows) for kind in dict.fromkeys(row.kind for row in rows)}
    rebounds = [
        -100 * p.error for p in auto.predictions if measured(p.row) and p.row.quantity == "coefficient_of_restitution"
    ]
    said = [f"`{report.law}`: restitution rises with velocity, {rise}." for report in reports for rise in report.rises]
    every = [abs(p.error) for p in elastic(rows).predictions if measured(p.row)] + auto.errors(measured)
    said.append(
        f"All {len(every)} measured values, elastic ones included, under `auto`: median error "
        f"{100 * statistics.median(every):.1f} %, worst {100 * max(every):.1f} %."
    )
    lines = str(ds.attrs["sources"]).split("\n")
    text = TEXT.format(
        count=len(rows),
        sources=len({row.source for row in rows}),
        recollected=sum(row.sureness == "recollection" for row in rows),
        kinds=", ".join(f"{count} {kind.replace('_', ' ')}" for kind, count in kinds.items()),
        laws=law_rows(reports),
        said="\n".join(said),
        low=f"{min(rebounds):.0f}",
        high=f"{max(rebounds):.0f}",
        elastic=prediction_rows(elastic(rows).predictions),
        own=prediction_rows(own_numbers(rows)),
        references="\n".join(f"- `{word}`: {said}" for word, _, said in (line.partition(": ") for line in lines)),
        rows=prediction_rows(auto.predictions),
    )  # fmt: skip
    return text, reports


def main(folder: Path = DOCS) -> tuple[Path, Path]:
    """Write the page and the picture; returns the paths."""
    text, reports = page()
    (folder / "validation.md").write_text(text, encoding="utf-8")
    plot_validation(reports, folder / "validation.png", dpi=80.0)
    return folder / "validation.md", folder / "validation.png"


if __name__ == "__main__":
    for path in main(*map(Path, sys.argv[1:])):
        print(path)
