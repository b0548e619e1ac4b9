"""film-model sweep, plot, identify, tolerance: many impacts, files and measurements."""

from __future__ import annotations

import argparse
import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from film_model.cli.output import (
    DONE,
    FAILED,
    Commands,
    add_common,
    check_dataset,
    check_writable,
    give,
    give_result,
    listed,
    print_json,
    print_note,
    print_warnings,
    print_written,
    read_scene,
)

if TYPE_CHECKING:
    from film_datasets.sweeps import Sweep
    from film_model.scene import Scene


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    _add_sweep(commands.add("sweep", "simulate the impacts of a sweep file", sweep))
    parser = commands.add("plot", "draw a dataset: a history, a measurement, a study, or a quantity of a sweep", plot)
    parser.add_argument("file", metavar="FILE", help="FILE.nc or FILE.zarr")
    parser.add_argument("--output", metavar="PICTURE", help=".png, .svg or .pdf (default: FILE.png)")
    parser.add_argument(
        "--quantity", metavar="NAME", help="summary quantity of a sweep (default: coefficient_of_restitution)"
    )
    parser.add_argument("--over", metavar="NAME[,NAME]", help="one swept quantity for lines, or two for a heat map")
    parser.add_argument("--at", metavar="NAME=VALUE", action="append", help="of another swept quantity, SI or a word")
    parser.add_argument("--kind", metavar="KIND", help="of a sweep: histogram, ecdf, scatter or tornado")
    add_common(parser, style=True, json=False)

    parser = commands.add("identify", "from a measurement: parameters of a scene, or the contact force", identify)
    parser.add_argument(
        "measured", nargs="+", help="CSV files: time and force, or velocity and restitution, with units"
    )
    parser.add_argument("scene", help="scene file (TOML), with initial values")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--fit", metavar="NAME[,NAME]", help="e.g. contact.yield_strength,time_offset")
    what.add_argument(
        "--force-from",
        action="store_true",
        help="the file has time and accelerations of the target's sensors: find the contact force behind them",
    )
    parser.add_argument(
        "--columns",
        metavar="NAME=HEADING",
        nargs="+",
        help='headings of the file, e.g. time="t [us]" force="CH1 [kN]"; lines before them are ignored',
    )
    parser.add_argument(
        "--each",
        metavar="KEY=VALUE[,VALUE]",
        action="append",
        help='an entry of the scene that differs between the files, e.g. impactor.velocity="1 m/s,2 m/s"',
    )
    parser.add_argument("--law", metavar="NAME[,NAME]", help="compare these laws, or all, instead of the scene's")
    parser.add_argument("--confidence", type=float, default=0.99, help="level of the intervals (default: 0.99)")
    parser.add_argument(
        "--intervals",
        choices=("curvature", "profile"),
        default="curvature",
        help="how they are found; profile: exactly",
    )
    parser.add_argument("--output", metavar="FILE", help="write the force: .nc, .zarr, .csv, .parquet or .mat")
    add_common(parser, plot="draw measurement and fit")

    parser = commands.add(
        "tolerance", "spread of the results by tolerances and scatter, and which number causes it", tolerance
    )
    parser.add_argument("sweep", help="sweep file (TOML) with tolerances or distributions")
    parser.add_argument("--quantity", metavar="NAME[,NAME]", help="summary quantities (default: four)")
    parser.add_argument("--samples", type=int, metavar="N", help="points (default: those of the file)")
    parser.add_argument("--confidence", type=float, default=0.95, help="level of the intervals (default: 0.95)")
    add_common(parser, plot="draw the tornado picture of the first quantity")


def _add_sweep(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("sweep", help="sweep file (TOML)")
    parser.add_argument("--output", metavar="FILE", required=True, help="FILE.nc, .zarr, .csv, .parquet or .mat")
    parser.add_argument(
        "--keep",
        metavar="WHAT",
        default="summary",
        help="summary (default); segments: also the exact histories; samples=201: also histories at 201 times",
    )
    parser.add_argument(
        "--derivatives",
        metavar="KEY[,KEY]",
        help="also those of the summary by keys of the scene, e.g. impactor.velocity",
    )
    parser.add_argument(
        "--variables",
        metavar="NAME[,NAME]",
        help="keep only these of the summary, e.g. maximum_force,contact_duration (default: all)",
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", type=int, metavar="N", help="number of threads (default: all cores)")
    where.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask scheduler whose workers compute instead")
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--resume", action="store_true", help="continue an interrupted run")
    how.add_argument("--shard", metavar="K/N", help="compute only part K of N into FILE.zarr; K is a number from 1")
    how.add_argument("--finish", action="store_true", help="check that all parts are there, and complete FILE.zarr")
    add_common(parser, force="overwrite an existing output and start again")


def sweep(options: argparse.Namespace) -> int:
    from film_datasets.files import size_of
    from film_datasets.sweeps import ProgressBar, finish_shards, read_sweep, run_sweep, sizes_text, sweep_report

    asked = read_sweep(options.sweep, options.keep, listed(options.derivatives), listed(options.variables))
    if options.shard:
        return _shard(options, asked)
    command = f"film-model sweep {options.sweep} --output {options.output} --keep {options.keep}"
    for name in ("derivatives", "variables"):
        command += f" --{name} {getattr(options, name)}" if getattr(options, name) else ""
    if options.finish:
        dataset = finish_shards(asked, options.output, command=command, overwrite=options.force)
    else:
        dataset = run_sweep(
            asked,
            options.output,
            command=command,
            workers=options.workers,
            scheduler=options.scheduler,
            resume=options.resume,
            overwrite=options.force,
            progress=ProgressBar(),
            announce=print_note,
        )
    with dataset:
        report = sweep_report(dataset)
    if options.json:
        print_json({"output": options.output, **report})
    else:
        print(_sweep_table(report))
        print_written(options.output)
    if "segments" in report:
        size = sizes_text(report["segments"]["bytes"], report["impacts"], options.output, size_of(options.output))
        print_note(f"written: {size}")
    print_warnings(report["warnings"])
    return FAILED if report["failed"] == report["impacts"] else DONE


def _shard(options: argparse.Namespace, asked: Sweep) -> int:
    """Compute one shard of a sweep."""
    from film_datasets.sweeps import ProgressBar, run_shard

    if options.force:
        raise ValueError("--force: a shard replaces nothing; use it with --finish")
    where: dict[str, Any] = {"workers": options.workers, "scheduler": options.scheduler}
    missing = run_shard(asked, options.output, options.shard, **where, progress=ProgressBar())
    if options.json:
        return print_json({"output": options.output, "shard": options.shard, "missing": missing})
    left = f"{len(missing)} missing" if missing else "all are there: complete them with --finish"
    print(f"shard {options.shard} is finished; {left}")
    return DONE


def _sweep_table(report: dict[str, Any]) -> str:
    """Counts of outcomes, and the range of every summary quantity that has a value, with the impacts that have one."""
    from film_model.base.units import format_si
    from film_model.oblique.result import RESULTS
    from film_model.problem.summary import SUMMARY

    dimensions = {name: dimension for name, (dimension, _) in (SUMMARY | RESULTS).items()}
    ended = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in report["statuses"].items())
    lines = [report["title"], f"{report['impacts']} impacts: {ended}", ""]
    if report["failed"] == report["impacts"]:
        return "\n".join(lines[:2])
    lines.append(f"  {'':30}{'minimum':>16}{'mean':>16}{'maximum':>16}")
    known = {name: row for name, row in report["summary"].items() if row["count"]}
    most = max((row["count"] for row in known.values()), default=0)
    for name, row in known.items():
        texts = (format_si(row[key], dimensions[name], 5) for key in ("least", "mean", "greatest"))
        few = f"   in {row['count']} of {most}" if row["count"] < most else ""
        lines.append(f"  {name.replace('_', ' '):30}" + "".join(f"{text:>16}" for text in texts) + few)
    lines += ["", f"  estimated relative error ≤ {report['accuracy']['estimated']:.1e}"]
    return "\n".join(lines)


def plot(options: argparse.Namespace) -> int:
    from film_datasets.dataset_plots import plot as draw
    from film_datasets.files import open_dataset

    output = options.output or os.path.splitext(options.file.rstrip("/" + os.sep))[0] + ".png"
    over = [_variable(name) for name in listed(options.over)]
    chosen: dict[str, Any] = {"quantity": options.quantity, "over": over, "kind": options.kind}
    pairs = (pair.partition("=")[::2] for pair in options.at or ())
    with open_dataset(options.file) as dataset:
        check_writable(output, options.force)
        given = {key: value for key, value in chosen.items() if value}
        draw(dataset, output, **given, at={_variable(key): value for key, value in pairs})
    print_written(output)
    return DONE


def _variable(path: str) -> str:
    """The dataset variable of a swept quantity such as impactor.velocity."""
    return path.replace(".", "_")


def _column(pair: str) -> tuple[str, str]:
    """The quantity and the heading of one of --columns."""
    quantity, _, heading = pair.partition("=")
    if not quantity.strip() or not heading.strip():
        raise ValueError(f'--columns: "{pair}": QUANTITY=HEADING is needed, e.g. force="CH1 [kN]"')
    return quantity.strip(), heading.strip()


def identify(options: argparse.Namespace) -> int:
    import film_datasets

    check_dataset(options)
    scene = read_scene(options)
    columns = dict(map(_column, options.columns or ()))
    if options.force_from:
        return _identify_force(options, scene, columns)
    if options.output:
        raise ValueError("--output: is for --force-from")
    measured = [film_datasets.from_csv(path, columns=columns) for path in options.measured]
    pairs = (pair.partition("=")[::2] for pair in options.each or ())
    given: dict[str, Any] = {"each": {key: listed(values) for key, values in pairs}, "intervals": options.intervals}
    if options.law:
        return _compare(options, measured, scene, given)
    found = film_datasets.identify(measured, scene, listed(options.fit), options.confidence, **given)
    return give_result(options, found, found.table)


def _identify_force(options: argparse.Namespace, scene: Scene, columns: dict[str, str]) -> int:
    """The contact force from the motion of sensors."""
    import film_datasets

    for name in ("each", "law"):
        if getattr(options, name):
            raise ValueError(f"--{name}: is not for --force-from")
    if len(options.measured) > 1:
        raise ValueError(f"--force-from: {len(options.measured)} files are given, one is needed")
    found = film_datasets.identify_force(options.measured[0], scene, options.confidence, columns=columns)
    return give_result(options, found, found.table)


def _compare(options: argparse.Namespace, measured: Any, scene: Scene, given: dict[str, Any]) -> int:
    """Fit with several laws; the picture is that of the best."""
    from film_datasets.identification import compare_laws, comparison_table
    from film_model.laws import LAWS

    laws = list(LAWS) if options.law == "all" else listed(options.law)
    found = compare_laws(measured, scene, listed(options.fit), laws, options.confidence, **given)
    best = found[0].fit
    draw, warnings = ({}, ()) if best is None else ({"plot": best.plot}, best.warnings)
    table = {"laws": [one.to_dict() for one in found]}
    give(options, lambda: comparison_table(found), lambda: table, warnings, **draw)
    return FAILED if best is None else DONE


def tolerance(options: argparse.Namespace) -> int:
    from film_datasets.sweeps import read_sweep
    from film_datasets.sweeps.designs import MOST_SAMPLES, SAMPLED
    from film_datasets.tolerances import tolerance_of
    from film_datasets.tolerances.analysis import SHOWN
    from film_datasets.tornado_plot import plot_tornado

    if not 0.0 < options.confidence < 1.0:
        raise ValueError(f"--confidence: {options.confidence:g} must be between 0 and 1")
    sweep = read_sweep(options.sweep)
    if sweep.design not in SAMPLED:
        raise ValueError(f'{options.sweep}: design "{sweep.design}" has no scatter: "sobol" is needed')
    if options.samples is not None:
        if not 8 <= options.samples <= MOST_SAMPLES["sobol"]:
            raise ValueError(f"--samples: {options.samples} is not allowed: 8 to {MOST_SAMPLES['sobol']} are needed")
        sweep = replace(sweep, samples=options.samples)
    quantities = listed(options.quantity) or SHOWN
    found = tolerance_of(sweep, quantities, options.confidence)
    return give(options, lambda: str(found), found.to_dict, found.warnings, plot=lambda path: plot_tornado(found, path))
