"""film-model cost, hard-cases, validate, reference-impacts, score: how good the method and its laws are."""

from __future__ import annotations

import argparse
from functools import partial
from typing import TYPE_CHECKING

import film_model.plot as pictures
from film_model.base.files import write_text
from film_model.cli.output import (
    DONE,
    FAILED,
    Commands,
    add_common,
    add_scene,
    check_dataset,
    check_writable,
    give,
    listed,
    print_note,
    read_scene,
)

if TYPE_CHECKING:
    from film_model.studies.cost import Study
    from film_model.studies.hard_cases import Report
    from film_model.studies.validation import LawReport


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    parser = commands.add("cost", "compare error and computing time with other methods", cost)
    add_scene(parser)
    parser.add_argument(
        "--method", action="append", metavar="NAME", help="only methods whose name begins with this; repeatable"
    )
    parser.add_argument("--output", metavar="FILE.nc", help="write the study as netCDF")
    add_common(parser, plot="draw the work-precision diagram")

    parser = commands.add("hard-cases", "run the catalogue of hard cases", hard_cases)
    parser.add_argument("--match", metavar="TEXT", default="", help="only cases whose name contains this")
    parser.add_argument("--markdown", metavar="FILE.md", help="write the report as a page")
    add_common(parser)

    parser = commands.add("validate", "compare the contact laws with measured values and theory", validate)
    parser.add_argument("--law", default="all", metavar="NAME", help='one law, "auto", or "all" (default)')
    parser.add_argument("--output", metavar="FILE.csv", help="write what every law gives for every value")
    add_common(parser, plot="draw the errors of the laws")

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


def cost(options: argparse.Namespace) -> int:
    from film_model.studies.cost import study
    from film_model.studies.timing import one_thread

    check_dataset(options)
    one_thread()
    scene = read_scene(options)
    done = study(scene, methods=options.method, progress=lambda name: print_note(f"timing {name}"))

    def write(path: str) -> None:
        import film_datasets

        film_datasets.write(film_datasets.to_dataset(done), path, overwrite=options.force)

    draw = partial(pictures.plot_study, done)
    return give(options, lambda: _cost_table(done), done.to_dict, output=write, plot=draw)


def _cost_table(done: Study) -> str:
    """All runs, with a star for the Pareto-optimal ones, what follows from them, and what is not installed."""
    from film_model.studies.cost import NOT_INSTALLED

    lines = [done.scene.title or "Impact", f"law {done.law}; reference: {done.reference['method']}", ""]
    lines.append(f"{'':26}{'':16}{'error':>10}{'single impact':>15}{'in a batch':>14}{'evaluations':>13}")
    best = {id(run) for run in done.front()}
    missing = dict.fromkeys(run.method for run in done.runs if run.outcome == NOT_INSTALLED)
    for run in done.runs:
        if run.method in missing:
            continue
        error = f"{run.error:10.1e}" if run.errors else f"{'-':>10}"
        single, batch = ("-" if t is None else f"{1e6 * t.median:.2f} us" for t in (run.time_single, run.time_batch))
        mark = "  *" if id(run) in best else "" if run.outcome == "done" else f"  {run.outcome}"
        numbers = f"{error}{single:>15}{batch:>14}{run.force_evaluations or '-':>13}"
        lines.append(f"{run.method:26}{run.setting:16}{numbers}{mark}")
    lines += ["", "times are per impact; * Pareto-optimal in error and time of a single impact"]
    if missing:
        lines.append(f'not compared, because not installed: {", ".join(missing)} (pip install "film-model[benchmark]")')
    return "\n".join([*lines, done.sentence(), *done.beaten()])


def hard_cases(options: argparse.Namespace) -> int:
    from film_model.studies import high_precision
    from film_model.studies.hard_cases import all_cases, page, report

    high_precision.arithmetic()  # without mpmath, raises before the first case
    check_writable(options.markdown, options.force)
    reports: list[Report] = []
    chosen = [case for case in all_cases() if options.match in case.name]
    if not chosen:
        raise ValueError(f"--match: no case's name contains {options.match!r}")
    for case in chosen:
        print_note(f"running {case.name}")
        reports.append(report(case))
    good = all(r.finding.good for r in reports)
    table = {"good": good, "cases": [r.to_dict() for r in reports]}
    markdown = partial(write_text, text=page(reports))
    give(options, lambda: _cases_table(reports), lambda: table, markdown=markdown)
    return DONE if good else FAILED


def _cases_table(reports: list[Report]) -> str:
    lines = [f"{'':6}{'case':52}{'error':>9}{'allowed':>9}{'segments':>10}{'time':>10}  outcome"]
    for r in reports:
        f = r.finding
        numbers = f"{f.error:9.1e}{f.allowed:9.0e}{f.segments or '-':>10}{r.seconds:8.2f} s"
        lines.append(f"{'pass' if f.good else 'FAIL':6}{r.case.name:52}{numbers}  {f.outcome}")
        lines += [f"{'':58}{name}: {said}" for name, said in r.others.items()]
    return "\n".join([*lines, f"{sum(r.finding.good for r in reports)} of {len(reports)} passed"])


def validate(options: argparse.Namespace) -> int:
    """Print median and worst error by law and group of rows."""
    from film_datasets import load
    from film_datasets.evidence import evidence_rows
    from film_model.plot.validation import plot_validation
    from film_model.studies.validation import TESTED, compare, table

    check_writable(options.output, options.force)
    rows = evidence_rows(load("measured_impacts"))
    reports = compare(rows, TESTED if options.law == "all" else (options.law,))
    rises = [f"{report.law}: restitution rises with velocity, {said}" for report in reports for said in report.rises]

    return give(
        options,
        lambda: "\n".join([table(reports), *rises]),
        lambda: {"laws": [report.to_dict() for report in reports]},
        output=lambda path: write_text(path, _rows_as_csv(reports)),
        plot=partial(plot_validation, reports),
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


def reference_impacts(options: argparse.Namespace) -> int:
    import film_datasets

    names = listed(options.cases) if options.cases is not None else None
    written = film_datasets.write_suite(
        options.output, names, options.workers, lambda name: print_note(f"wrote {name}")
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
