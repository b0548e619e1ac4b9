"""film-model validate: the contact laws against measured values and theory."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from film_model.cli.output import DONE, add_force, add_json, add_plot, check_picture, check_writable, print_json

if TYPE_CHECKING:
    from film_model.studies.validation import LawReport


def add_commands(named: Any) -> None:
    """The command and its options."""
    parser: argparse.ArgumentParser = named.add_parser(
        "validate", help="compare the contact laws with measured values and theory"
    )
    parser.add_argument("--law", default="all", metavar="NAME", help='one law, "auto", or "all" (default)')
    parser.add_argument("--output", metavar="FILE.csv", help="write what every law gives for every value")
    add_plot(parser, "draw the errors of the laws")
    add_force(parser)
    add_json(parser)
    parser.set_defaults(command=validate)


def validate(options: argparse.Namespace) -> int:
    """Print median and worst error by law and group of rows."""
    from film_datasets import load
    from film_datasets.evidence import evidence_rows
    from film_model.studies.validation import TESTED, compare, table

    if options.output:
        check_writable(options.output, options.force)
    check_picture(options.plot, options.force)
    rows = evidence_rows(load("measured_impacts"))
    reports = compare(rows, TESTED if options.law == "all" else (options.law,))
    if options.output:
        from pathlib import Path

        from film_model.base.files import written_whole

        with written_whole(Path(options.output)) as beside:
            beside.write_text(_rows_as_csv(reports), "utf-8")
    if options.plot:
        from film_model.plot.validation import plot_validation

        plot_validation(reports, options.plot)
    if options.json:
        return print_json({"laws": [report.to_dict() for report in reports]})
    print(table(reports))
    for report in reports:
        for said in report.rises:
            print(f"{report.law}: restitution rises with velocity, {said}")
    return DONE


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
