"""film-model reference-impacts and score: the suite of certified impacts, and how close another code comes to it."""

from __future__ import annotations

import argparse
import sys

from film_model.cli.output import DONE, Commands, add_common, give, listed


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    parser = commands.add(
        "reference-impacts", "write the suite of certified impacts to test other codes against", reference_impacts
    )
    parser.add_argument("--output", metavar="DIR", required=True, help="a new or empty folder")
    parser.add_argument("--cases", metavar="NAMES", help="only these, separated by commas")
    parser.add_argument("--workers", type=int, metavar="N", default=1, help="processes (default: 1)")

    parser = commands.add("score", "compare another code's histories with the reference impacts", score)
    parser.add_argument("results", help="CASE.csv, or a folder of such files")
    parser.add_argument("--case", metavar="NAME", help="case of a file that is called otherwise")
    add_common(parser, plot="draw the errors")


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

    scores = film_datasets.score(options.results, options.case)
    cases = [{"case": one.case, "rows": one.rows, "errors": dict(one.errors)} for one in scores]
    table = {"quantities": by_quantity(scores), "cases": cases}
    return give(
        options, lambda: text_of(scores), lambda: table, plot=lambda path: film_datasets.plot_scores(scores, path)
    )
