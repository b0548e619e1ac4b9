"""film-model check, convert, summarise, table: files checked, in other formats, and sweeps in few numbers."""

from __future__ import annotations

import argparse

from film_model.base.errors import did_you_mean, shown
from film_model.cli.output import (
    DONE,
    FAILED,
    Commands,
    add_common,
    add_scene,
    check_writable,
    give,
    listed,
    print_warnings,
    print_written,
    read_scene,
)

SHOWN = ("coefficient_of_restitution", "maximum_force", "maximum_indentation", "contact_duration")
"""Quantities that `summarise` prints unless others are asked for."""

COLUMNS = ("coefficient_of_restitution", "contact_duration", "maximum_force", "maximum_indentation")
"""Columns of `table` after the velocity."""


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    parser = commands.add("check", "whether a dataset is whole and holds what the simulation gives", check)
    parser.add_argument("file", metavar="FILE", help="FILE.nc or FILE.zarr")
    parser.add_argument("--rows", type=int, default=10, metavar="N", help="impacts to simulate again (default: 10)")

    parser = commands.add("convert", "write a dataset in another format", convert)
    parser.add_argument("file", metavar="FILE", help="FILE.nc, FILE.zarr, or a measurement in FILE.csv")
    parser.add_argument("output", metavar="OUTPUT", help="FILE.nc, .zarr, .csv, .parquet or .mat")
    add_common(parser, json=False)

    parser = commands.add("summarise", "mean, percentiles and extremes of a sweep, with their impacts", summarise)
    parser.add_argument("file", metavar="FILE", help="FILE.nc or FILE.zarr of a sweep")
    parser.add_argument("--quantity", metavar="NAME[,NAME]", help="summary quantities, or all (default: four)")
    add_common(parser, force="")

    parser = commands.add("table", "restitution and contact time over velocity, e.g. for a DEM program", table)
    add_scene(parser)
    parser.add_argument("--from", dest="low", default="0.01 m/s", metavar="VELOCITY", help="default: 0.01 m/s")
    parser.add_argument("--to", dest="high", default="10 m/s", metavar="VELOCITY", help="default: 10 m/s")
    parser.add_argument("--count", type=int, default=31, metavar="N", help="velocities, log-spaced (default: 31)")
    parser.add_argument("--law", metavar="NAME", help="contact law (default: the scene's)")
    parser.add_argument("--output", metavar="FILE", help="write .csv, .parquet or .mat instead of printing CSV")
    add_common(parser, json=False)


def check(options: argparse.Namespace) -> int:
    import film_datasets

    wrong = film_datasets.check(options.file, options.rows)
    print("\n".join(wrong) if wrong else f"{options.file}: nothing is wrong")
    return FAILED if wrong else DONE


def convert(options: argparse.Namespace) -> int:
    import film_datasets

    lacking = film_datasets.convert(options.file, options.output, overwrite=options.force)
    print_written(options.output)
    print_warnings(f"{what} do not fit a table: {options.output} has none" for what in lacking)
    return DONE


def summarise(options: argparse.Namespace) -> int:
    from film_datasets.files import open_dataset
    from film_datasets.schema import SWEEP, kind_of
    from film_datasets.sweeps.digest import digest_text, sweep_digest

    with open_dataset(options.file) as dataset:
        if kind_of(dataset) != SWEEP:
            raise ValueError(f"{options.file}: is no sweep; for one impact use film-model run --json")
        report = sweep_digest(dataset)
        known = report["summary"]
        asked = list(known) if options.quantity == "all" else listed(options.quantity) or list(SHOWN)
        for name in asked:
            if name not in known:
                raise ValueError(f"--quantity: {shown(name)} is not in {options.file}{did_you_mean(name, known)}")
        return give(options, lambda: digest_text(dataset, report, asked), lambda: report, report["warnings"])


def table(options: argparse.Namespace) -> int:
    import film_datasets

    check_writable(options.output, options.force)
    law = {} if options.law is None else {"contact.law": options.law}
    scene = read_scene(options).replace({"impactor.drop_height": None, "impactor.velocity": options.low, **law})
    velocities = {"from": options.low, "to": options.high, "count": options.count, "spacing": "log"}
    dataset = film_datasets.sweep(scene, {"impactor.velocity": velocities})
    if options.output:
        film_datasets.write(dataset, options.output, overwrite=options.force)
        print_written(options.output)
    else:
        frame = film_datasets.to_frame(dataset)
        wanted = ("impactor_velocity", *COLUMNS)
        chosen = [heading for name in wanted for heading in frame if heading.split(" ")[0] == name]
        print(frame[chosen].to_csv(index=False, lineterminator="\n", float_format="%.6g"), end="")
    print_warnings([] if dataset.attrs["warnings"] == "none" else str(dataset.attrs["warnings"]).split("\n"))
    return DONE
