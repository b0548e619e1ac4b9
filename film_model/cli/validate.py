"""film-model validate: the contact laws against measured values and theory."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from film_model.base.files import write_text
from film_model.cli.output import Commands, add_common, check_writable, give

if TYPE_CHECKING:
    from film_model.studies.validation import LawReport


def add_commands(commands: Commands) -> None:
    """The command and its options."""
    parser = commands.add("validate", "compare the contact laws with measured values and theory", validate)
    parser.add_argument("--law", default="all", metavar="NAME", help='one law, "auto", or "all" (default)')
    parser.add_argument("--output", metavar="FILE.csv", help="write what every law gives for every value")
    add_common(parser, plot="draw the errors of the laws")


def validate(options: argparse.Namespace) -> int:
    """Print median and worst error by law and group of rows."""
    from film_datasets import load
    from film_datasets.evidence import evidence_rows
    from film_model.studies.validation import TESTED, compare, table

    if options.output:
        check_writable(options.output, options.force)
    rows = evidence_rows(load("measured_impacts"))
    reports = compare(rows, TESTED if options.law == "all" else (options.law,))
    rises = [f"{report.law}: restitution rises with velocity, {said}" for report in reports for said in report.rises]

    def draw(path: str) -> None:
        from film_model.plot.validation import plot_validation

        plot_validation(reports, path)

    return give(
        options,
        lambda: "\n".join([table(reports), *rises]),
        lambda: {"laws": [report.to_dict() for report in reports]},
        output=lambda path: write_text(path, _rows_as_csv(reports)),
        plot=draw,
    )


def _rows_as_csv(reports: list[LawReport]) -> str:
    import csv
    import io

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        ["source", "quantity", "published", "uncertainty", "kind", "held_out", *(report.law for report in reports)]
    )
    for predictions in zip(*(report.predictions for report in reports), strict=True):
        row = predictions[0].row
        found = (f"{prediction.value:.6g}" for prediction in predictions)
        held = "yes" if row.held_out else "no"
        writer.writerow([row.source, row.quantity, f"{row.value:.6g}", row.uncertainty, row.kind, held, *found])
    return text.getvalue()
