"""film-model reference-impacts and score: the suite of certified impacts, and how close another code comes to it."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from film_model.cli.output import (
    DONE,
    add_force,
    add_json,
    add_plot,
    check_picture,
    listed,
    print_json,
    print_written,
)


def add_commands(named: Any) -> None:
    """The commands and their options."""
    parser: argparse.ArgumentParser = named.add_parser(
        "reference-impacts", help="write the suite of certified impacts to test other codes against"
    )
    parser.add_argument("--output", metavar="DIR", required=True, help="a new or empty folder")
    parser.add_argument("--cases", metavar="NAMES", help="only these, separated by commas")
    parser.add_argument("--workers", type=int, metavar="N", default=1, help="processes (default: 1)")
    parser.set_defaults(command=reference_impacts)

    parser = named.add_parser("score", help="compare another code's histories with the reference impacts")
    parser.add_argument("results", help="CASE.csv, or a folder of such files")
    parser.add_argument("--case", metavar="NAME", help="case of a file that is called otherwise")
    add_plot(parser, "draw the errors")
    add_force(parser, "overwrite an existing picture")
    add_json(parser)
    parser.set_defaults(command=score)


def reference_impacts(options: argparse.Namespace) -> int:
    import film_datasets

    names = listed(options.cases) if options.cases is not None else None
    written = film_datasets.write_suite(
        options.output, names, options.workers, lambda name: print(f"wrote {name}", file=sys.stderr)
    )
    print(f"{len(written)} cases in {options.output}")
    return DONE


def score(options: argparse.Namespace) -> int:
    import film_datasets
    from film_datasets.reference_impacts.score import by_quantity, text_of

    check_picture(options.plot, options.force)
    scores = film_datasets.score(options.results, options.case)
    if options.plot:
        film_datasets.plot_scores(scores, options.plot)
    if options.json:
        cases = [{"case": one.case, "rows": one.rows, "errors": dict(one.errors)} for one in scores]
        return print_json({"quantities": by_quantity(scores), "cases": cases})
    print(text_of(scores))
    print_written(options.plot)
    return DONE
