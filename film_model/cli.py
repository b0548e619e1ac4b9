"""The command line of film-model.

Results go to standard output, warnings to standard error. Exit status 0: done; 2: the scene or the command line is
wrong; 3: it could not be done, a file could not be read or written, or what was checked is not good; 130: interrupted.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Sequence

from film_model import commands
from film_model.commands import DONE, FAILED, WRONG

OPTIONS = {"overwrite=True": "--force", "resume=True": "--resume"}
"""What messages tell to say in Python, and what to use here."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit status."""
    options = _parser().parse_args(arguments)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a code page without Greek letters shows "?" for them
    from film_model.errors import SceneError, SimulationError

    try:
        return options.command(options)
    except SceneError as error:
        return _complain(str(error), WRONG)
    except SimulationError as error:
        return _complain(str(error), FAILED)
    except BrokenPipeError:  # the reader has left
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except (OSError, ValueError, ImportError) as error:
        return _complain(str(error), FAILED)
    except KeyboardInterrupt as stop:
        return _complain(str(stop) or "interrupted", 130)


def _complain(text: str, status: int) -> int:
    for argument, option in OPTIONS.items():
        text = text.replace(f"say {argument}", f"use {option}")
    print(text, file=sys.stderr)
    return status


def _parser() -> argparse.ArgumentParser:
    from film_model.version import __version__

    parser = argparse.ArgumentParser(
        prog="film-model", description="What happens when a ball hits something: force, indentation, rebound."
    )
    parser.add_argument("--version", action="version", version=f"film-model {__version__}")
    named = parser.add_subparsers(required=True, metavar="command")

    run = named.add_parser("run", help="simulate the impact of a scene file")
    run.add_argument("scene", help="scene file (TOML)")
    run.add_argument("--output", metavar="FILE.nc", help="write the history as netCDF")
    run.add_argument("--plot", metavar="FILE", help="draw the history (.png, .svg or .pdf)")
    how = run.add_mutually_exclusive_group()
    how.add_argument("--accuracy", type=float, help="relative accuracy of every summary value, e.g. 1e-6")
    how.add_argument("--segments", type=int, help="segments a stage, instead of an accuracy")
    run.add_argument("--linearisation", choices=("work-preserving", "chord"), help="how lines replace the law")
    run.add_argument("--force", action="store_true", help="overwrite existing output files")
    run.add_argument("--json", action="store_true", help="print one JSON object")
    run.set_defaults(command=commands.run)

    cost = named.add_parser("cost", help="error against time for a scene, beside other methods")
    cost.add_argument("scene", help="scene file (TOML)")
    cost.add_argument("--method", action="append", metavar="NAME", help="only methods whose name begins so; repeatable")
    cost.add_argument("--output", metavar="FILE.nc", help="write the study as netCDF")
    cost.add_argument("--plot", metavar="FILE", help="draw the work-precision diagram (.png, .svg or .pdf)")
    cost.add_argument("--force", action="store_true", help="overwrite existing output files")
    cost.add_argument("--json", action="store_true", help="print one JSON object")
    cost.set_defaults(command=commands.cost)

    hard = named.add_parser("hard-cases", help="run the catalogue of hard cases")
    hard.add_argument("--match", metavar="TEXT", default="", help="only cases whose name contains this")
    hard.add_argument("--markdown", metavar="FILE.md", help="write the report as a page")
    hard.add_argument("--force", action="store_true", help="overwrite an existing page")
    hard.add_argument("--json", action="store_true", help="print one JSON object")
    hard.set_defaults(command=commands.hard_cases)
    explain = named.add_parser("explain", help="say which effects a scene calls for, with the numbers that decide")
    explain.add_argument("scene", help="scene file (TOML)")
    explain.add_argument("--law", choices=("all",), help="all: also compare what the contact laws predict")
    explain.add_argument("--plot", metavar="FILE", help="draw the scene on a map of regimes (.png, .svg or .pdf)")
    explain.add_argument("--force", action="store_true", help="overwrite an existing picture")
    explain.add_argument("--json", action="store_true", help="print one JSON object")
    explain.set_defaults(command=commands.explain)

    export = named.add_parser("export-fmu", help="write the impact of a scene file as an FMU")
    export.add_argument("scene", help="scene file (TOML)")
    export.add_argument("--fmi", type=int, choices=(2, 3), default=3, help="FMI version (default: 3)")
    export.add_argument(
        "--kind", choices=("impact", "contact"), default="impact", help="impactor with its mass, or force element"
    )
    export.add_argument(
        "--initial-gap", metavar="LENGTH", default="0 m", help='distance of an impact at the start, e.g. "5 mm"'
    )
    export.add_argument(
        "--platform", action="append", metavar="NAME", help="e.g. aarch64-linux, or all; by default this machine's"
    )
    export.add_argument("--with-sources", action="store_true", help="put the C sources in, for importers that compile")
    export.add_argument("--output", metavar="FILE.fmu", help="file to write (default: impact.fmu or contact.fmu)")
    export.add_argument("--force", action="store_true", help="overwrite an existing file")
    export.set_defaults(command=commands.export_fmu)

    check = named.add_parser("check-fmu", help="validate an FMU and hold its runs against the library's")
    check.add_argument("fmu", help="FMU written by export-fmu")
    check.add_argument("--json", action="store_true", help="print one JSON object")
    check.set_defaults(command=commands.check_fmu)

    sweep = named.add_parser("sweep", help="simulate the many impacts of a sweep file")
    sweep.add_argument("sweep", help="sweep file (TOML)")
    sweep.add_argument("--output", metavar="FILE", required=True, help="FILE.nc or FILE.zarr")
    sweep.add_argument(
        "--keep",
        metavar="WHAT",
        default="summary",
        help="besides the summary (default): segments, the exact histories; or samples=201, dense ones",
    )
    where = sweep.add_mutually_exclusive_group()
    where.add_argument("--workers", type=int, metavar="N", help="threads; all cores by default")
    where.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask scheduler whose workers compute instead")
    sweep.add_argument("--resume", action="store_true", help="go on where an interrupted run stopped")
    sweep.add_argument("--force", action="store_true", help="overwrite an existing output, and begin anew")
    sweep.add_argument("--json", action="store_true", help="print one JSON object")
    sweep.set_defaults(command=commands.sweep)

    plot = named.add_parser("plot", help="draw a dataset: a history, a measurement, a study, or a quantity of a sweep")
    plot.add_argument("file", metavar="FILE", help="FILE.nc or FILE.zarr")
    plot.add_argument("--output", metavar="PICTURE", help=".png, .svg or .pdf; FILE.png unless given")
    plot.add_argument("--quantity", metavar="NAME", help="summary quantity of a sweep; coefficient_of_restitution")
    plot.add_argument("--over", metavar="NAME[,NAME]", help="one swept quantity, for lines, or two, for a heat map")
    plot.add_argument("--at", metavar="NAME=VALUE", action="append", help="of another swept quantity, SI or a word")
    plot.add_argument("--force", action="store_true", help="overwrite an existing picture")
    plot.set_defaults(command=commands.plot)

    identify = named.add_parser("identify", help="fit parameters of a scene to a measurement")
    identify.add_argument("measured", help="CSV file: time and force, or velocity and restitution, with units")
    identify.add_argument("scene", help="scene file (TOML), with values to begin with")
    identify.add_argument("--fit", required=True, metavar="NAME[,NAME]", help="e.g. contact.yield_strength,time_offset")
    identify.add_argument("--confidence", type=float, default=0.99, help="level of the intervals (0.99)")
    identify.add_argument("--plot", metavar="FILE", help="draw measurement and fit (.png, .svg or .pdf)")
    identify.add_argument("--force", action="store_true", help="overwrite an existing picture")
    identify.add_argument("--json", action="store_true", help="print one JSON object")
    identify.set_defaults(command=commands.identify)

    laws = named.add_parser("laws", help="list the contact laws and their parameters")
    laws.add_argument("--json", action="store_true", help="print one JSON object")
    laws.add_argument("--plot", metavar="FILE", help="draw all of them (.png, .svg or .pdf)")
    laws.add_argument("--force", action="store_true", help="overwrite an existing picture")
    laws.set_defaults(command=commands.laws)

    materials = named.add_parser("materials", help="list the materials of the catalogue")
    materials.add_argument("--json", action="store_true", help="print one JSON object")
    materials.set_defaults(command=commands.materials)
    return parser
