"""The command line of film-model.

Results go to standard output, warnings to standard error. Exit status 0: done; 2: the scene or the command line is
wrong; 3: it could not be done, a file could not be read or written, or what was checked is not good; 130: interrupted.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from film_model.history import History
    from film_model.laws import AbstractLaw

DONE, WRONG, FAILED = 0, 2, 3

OPTIONS = {"overwrite=True": "--force", "resume=True": "--resume"}
"""What messages tell to say in Python, and what to use here."""

MOST_EVENTS = 24
"""Events in a table; JSON and files have all."""


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
    commands = parser.add_subparsers(required=True, metavar="command")

    run = commands.add_parser("run", help="simulate the impact of a scene file")
    run.add_argument("scene", help="scene file (TOML)")
    run.add_argument("--output", metavar="FILE.nc", help="write the history as netCDF")
    run.add_argument("--plot", metavar="FILE", help="draw the history (.png, .svg or .pdf)")
    how = run.add_mutually_exclusive_group()
    how.add_argument("--accuracy", type=float, help="relative accuracy of every summary value, e.g. 1e-6")
    how.add_argument("--segments", type=int, help="segments a stage, instead of an accuracy")
    run.add_argument("--linearisation", choices=("work-preserving", "chord"), help="how lines replace the law")
    run.add_argument("--force", action="store_true", help="overwrite existing output files")
    run.add_argument("--json", action="store_true", help="print one JSON object")
    run.set_defaults(command=_run)

    cost = commands.add_parser("cost", help="error against time for a scene, beside other methods")
    cost.add_argument("scene", help="scene file (TOML)")
    cost.add_argument("--method", action="append", metavar="NAME", help="only methods whose name begins so; repeatable")
    cost.add_argument("--output", metavar="FILE.nc", help="write the study as netCDF")
    cost.add_argument("--plot", metavar="FILE", help="draw the work-precision diagram (.png, .svg or .pdf)")
    cost.add_argument("--force", action="store_true", help="overwrite existing output files")
    cost.add_argument("--json", action="store_true", help="print one JSON object")
    cost.set_defaults(command=_cost)

    hard = commands.add_parser("hard-cases", help="run the catalogue of hard cases")
    hard.add_argument("--match", metavar="TEXT", default="", help="only cases whose name contains this")
    hard.add_argument("--markdown", metavar="FILE.md", help="write the report as a page")
    hard.add_argument("--force", action="store_true", help="overwrite an existing page")
    hard.add_argument("--json", action="store_true", help="print one JSON object")
    hard.set_defaults(command=_hard_cases)
    explain = commands.add_parser("explain", help="say which effects a scene calls for, with the numbers that decide")
    explain.add_argument("scene", help="scene file (TOML)")
    explain.add_argument("--law", choices=("all",), help="all: also compare what the contact laws predict")
    explain.add_argument("--plot", metavar="FILE", help="draw the scene on a map of regimes (.png, .svg or .pdf)")
    explain.add_argument("--force", action="store_true", help="overwrite an existing picture")
    explain.add_argument("--json", action="store_true", help="print one JSON object")
    explain.set_defaults(command=_explain)

    export = commands.add_parser("export-fmu", help="write the impact of a scene file as an FMU")
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
    export.set_defaults(command=_export_fmu)

    check = commands.add_parser("check-fmu", help="validate an FMU and hold its runs against the library's")
    check.add_argument("fmu", help="FMU written by export-fmu")
    check.add_argument("--json", action="store_true", help="print one JSON object")
    check.set_defaults(command=_check_fmu)

    sweep = commands.add_parser("sweep", help="simulate the many impacts of a sweep file")
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
    sweep.set_defaults(command=_sweep)

    plot = commands.add_parser(
        "plot", help="draw a dataset: a history, a measurement, a study, or a quantity of a sweep"
    )
    plot.add_argument("file", metavar="FILE", help="FILE.nc or FILE.zarr")
    plot.add_argument("--output", metavar="PICTURE", help=".png, .svg or .pdf; FILE.png unless given")
    plot.add_argument("--quantity", metavar="NAME", help="summary quantity of a sweep; coefficient_of_restitution")
    plot.add_argument("--over", metavar="NAME[,NAME]", help="one swept quantity, for lines, or two, for a heat map")
    plot.add_argument("--at", metavar="NAME=VALUE", action="append", help="of another swept quantity, SI or a word")
    plot.add_argument("--force", action="store_true", help="overwrite an existing picture")
    plot.set_defaults(command=_plot)

    identify = commands.add_parser("identify", help="fit parameters of a scene to a measurement")
    identify.add_argument("measured", help="CSV file: time and force, or velocity and restitution, with units")
    identify.add_argument("scene", help="scene file (TOML), with values to begin with")
    identify.add_argument("--fit", required=True, metavar="NAME[,NAME]", help="e.g. contact.yield_strength,time_offset")
    identify.add_argument("--confidence", type=float, default=0.99, help="level of the intervals (0.99)")
    identify.add_argument("--plot", metavar="FILE", help="draw measurement and fit (.png, .svg or .pdf)")
    identify.add_argument("--force", action="store_true", help="overwrite an existing picture")
    identify.add_argument("--json", action="store_true", help="print one JSON object")
    identify.set_defaults(command=_identify)

    laws = commands.add_parser("laws", help="list the contact laws and their parameters")
    laws.add_argument("--json", action="store_true", help="print one JSON object")
    laws.add_argument("--plot", metavar="FILE", help="draw all of them (.png, .svg or .pdf)")
    laws.add_argument("--force", action="store_true", help="overwrite an existing picture")
    laws.set_defaults(command=_laws)

    materials = commands.add_parser("materials", help="list the materials of the catalogue")
    materials.add_argument("--json", action="store_true", help="print one JSON object")
    materials.set_defaults(command=_materials)
    return parser


def _run(options: argparse.Namespace) -> int:
    from film_model.scene import Scene
    from film_model.solve import simulate

    _check_outputs(options)
    scene = Scene.from_toml(options.scene)
    history = simulate(scene, accuracy=options.accuracy, segments=options.segments, linearisation=options.linearisation)
    if options.output:
        import film_datasets

        dataset = film_datasets.to_dataset(history)
        film_datasets.write(dataset, options.output, overwrite=options.force)
    if options.plot:
        from film_model.plot import plot_history

        plot_history(history, options.plot)
    if options.json:
        _print_json(history.to_json())
    else:
        print(_table(history))
        for path in filter(None, (options.output, options.plot)):
            print(f"wrote {path}", file=sys.stderr)
    for warning in history.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def _cost(options: argparse.Namespace) -> int:
    from film_model.scene import Scene
    from film_model.study import FILM, one_thread, study

    _check_outputs(options)
    one_thread()
    scene = Scene.from_toml(options.scene)
    done = study(scene, methods=options.method, progress=lambda name: print(f"timing {name}", file=sys.stderr))
    if not done.runs:
        raise ValueError(
            f"--method: no method begins with {' or '.join(options.method)}; there are {', '.join(FILM)} ..."
        )
    if options.output:
        import film_datasets

        film_datasets.write(film_datasets.to_dataset(done), options.output, overwrite=options.force)
    if options.plot:
        from film_model.plot_study import plot_study

        plot_study(done, options.plot)
    if options.json:
        return _print_json(done.to_json())
    print(f"{scene.title or 'Impact'}\nlaw {done.law}; errors are against {done.reference['method']}\n")
    print(f"{'':26}{'':16}{'error':>10}{'one impact':>14}{'in a batch':>14}{'forces':>9}")
    best = {id(run) for run in done.front()}
    for run in done.runs:
        error = f"{run.error:10.1e}" if run.errors else f"{'-':>10}"
        times = "".join(
            f"{'-' if t is None else f'{1e6 * t.median:.2f} us':>14}" for t in (run.time_single, run.time_batch)
        )
        said = "  *" if id(run) in best else "" if run.outcome == "done" else f"  {run.outcome}"
        print(f"{run.method:26}{run.setting:16}{error}{times}{run.force_evaluations or '-':>9}{said}")
    print("\n* nothing here is better in both error and time of one impact")
    print("\n".join([done.sentence(), *done.beaten()]))
    return DONE


def _hard_cases(options: argparse.Namespace) -> int:
    from pathlib import Path

    from film_model.files import written_whole
    from film_model.hard_cases import all_cases, page, report

    if options.markdown:
        _check_writable(options.markdown, options.force)
    reports = []
    chosen = [case for case in all_cases() if options.match in case.name]
    if not chosen:
        raise ValueError(f"--match: no case's name contains {options.match!r}")
    for case in chosen:
        print(f"running {case.name}", file=sys.stderr)
        reports.append(report(case))
    good = all(r.finding.good for r in reports)
    if options.markdown:
        with written_whole(Path(options.markdown)) as beside:
            beside.write_text(page(reports), "utf-8")
    if options.json:
        _print_json({"good": good, "cases": [r.to_json() for r in reports]})
        return DONE if good else FAILED
    print(f"{'':6}{'case':52}{'error':>9}{'allowed':>9}{'segments':>10}{'time':>10}  outcome")
    for r in reports:
        f = r.finding
        numbers = f"{f.error:9.1e}{f.allowed:9.0e}{f.segments or '-':>10}{r.seconds:8.2f} s"
        print(f"{'good' if f.good else 'BAD':6}{r.case.name:52}{numbers}  {f.outcome}")
        for name, said in r.others.items():
            print(f"{'':58}{name}: {said}")
    print(f"{sum(r.finding.good for r in reports)} of {len(reports)} good")
    return DONE if good else FAILED


def _explain(options: argparse.Namespace) -> int:
    from film_model import explain
    from film_model.scene import Scene

    if options.plot:
        _check_picture(options.plot, options.force)
    scene = Scene.from_toml(options.scene)
    report = explain.explain(scene, laws=options.law == "all")
    if options.plot:
        from film_model.plot import plot_regimes

        plot_regimes(scene, options.plot)
    if options.json:
        _print_json(report)
    else:
        print(explain.effects_text(scene))
        if options.law:
            print("\n" + explain.laws_text(report["laws"]))
        if options.plot:
            print(f"wrote {options.plot}", file=sys.stderr)
    for warning in report["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def _export_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper
    from film_model.scene import Scene
    from film_model.units import to_si

    try:
        gap = to_si(options.initial_gap, "length")
    except ValueError as error:
        raise ValueError(f"--initial-gap: {error}") from None
    path = options.output or f"{options.kind}.fmu"
    _check_writable(path, options.force)
    scene = Scene.from_toml(options.scene)
    fmu_wrapper.export(
        scene,
        path,
        options.fmi,
        kind=options.kind,
        initial_gap=gap,
        platform=options.platform,
        with_sources=options.with_sources,
        overwrite=options.force,
    )
    print(f"wrote {path}", file=sys.stderr)
    return DONE


def _check_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper

    report = fmu_wrapper.check(options.fmu)
    if options.json:
        _print_json(report.to_json())
    else:
        for problem in report.problems:
            print(f"wrong      {problem}")
        for finding in report.findings:
            word = "agrees" if finding.good else "differs"
            where = "" if finding.good else f"  at {finding.where}"
            print(f"{word:10} {finding.what:48} {finding.difference:8.1e}, allowed {finding.allowed:.0e}{where}")
        print(f"{report.path}: {'good' if report.good else 'not good'}")
    return DONE if report.good else FAILED


def _sweep(options: argparse.Namespace) -> int:
    from film_datasets.progress import Bar
    from film_datasets.report import sweep_report
    from film_datasets.run import run
    from film_datasets.sweeps import Sweep

    sweep = Sweep.from_toml(options.sweep, options.keep)
    dataset = run(
        sweep,
        options.output,
        command=f"film-model sweep {options.sweep} --output {options.output} --keep {options.keep}",
        workers=options.workers,
        scheduler=options.scheduler,
        resume=options.resume,
        overwrite=options.force,
        progress=Bar(),
    )
    with dataset:
        report = sweep_report(dataset)
    if options.json:
        _print_json({"output": options.output, **report})
    else:
        print(_sweep_table(report))
        print(f"wrote {options.output}", file=sys.stderr)
    for warning in report["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def _sweep_table(report: dict[str, Any]) -> str:
    """How the impacts ended, and the range of every summary quantity."""
    from film_model.history import SUMMARY
    from film_model.units import format_si

    ended = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in report["statuses"].items())
    lines = [report["title"], f"{report['impacts']} impacts: {ended}", ""]
    lines.append(f"  {'':30}{'least':>16}{'mean':>16}{'greatest':>16}")
    for name, row in report["summary"].items():
        cells = (row[key] for key in ("least", "mean", "greatest"))
        texts = ("-" if value is None else format_si(value, SUMMARY[name][0], 5) for value in cells)
        lines.append(f"  {name.replace('_', ' '):30}" + "".join(f"{text:>16}" for text in texts))
    lines += ["", f"  error at most {report['accuracy']['estimated']:.1e} of every value"]
    return "\n".join(lines)


def _plot(options: argparse.Namespace) -> int:
    from film_datasets.files import open_dataset
    from film_datasets.pictures import plot

    output = options.output or os.path.splitext(options.file.rstrip("/" + os.sep))[0] + ".png"
    over = [_dataset_name(name) for name in _names(options.over)]
    chosen: dict[str, Any] = {"quantity": options.quantity, "over": over}
    pairs = (pair.partition("=")[::2] for pair in options.at or ())
    with open_dataset(options.file) as dataset:
        _check_writable(output, options.force)
        given = {key: value for key, value in chosen.items() if value}
        plot(dataset, output, **given, at={_dataset_name(key): value for key, value in pairs})
    print(f"wrote {output}", file=sys.stderr)
    return DONE


def _dataset_name(path: str) -> str:
    """What a swept quantity such as impactor.velocity is called in a dataset."""
    return path.replace(".", "_")


def _identify(options: argparse.Namespace) -> int:
    from film_datasets.identification import identify
    from film_datasets.measured import from_csv
    from film_model.scene import Scene

    if options.plot:
        _check_picture(options.plot, options.force)
    scene = Scene.from_toml(options.scene)
    found = identify(from_csv(options.measured), scene, _names(options.fit), options.confidence)
    if options.plot:
        found.plot(options.plot)
    if options.json:
        _print_json(found.to_json())
    else:
        print(found.table())
        if options.plot:
            print(f"wrote {options.plot}", file=sys.stderr)
    for warning in found.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    return DONE


def _names(text: str | None) -> list[str]:
    """Names that are separated by commas."""
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def _check_writable(path: str, force: bool) -> None:
    """Say before the work what would make it useless after."""
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise FileNotFoundError(f"{path}: the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{path}: the folder {folder} cannot be written to")
    if os.path.isdir(path):
        raise IsADirectoryError(f"{path} is a folder, the name of a file is needed")
    if os.path.exists(path) and not force:
        raise FileExistsError(f"{path} exists; use --force to overwrite it")


def _check_outputs(options: argparse.Namespace) -> None:
    """The same of --output and --plot, where they are given."""
    if options.output:
        from pathlib import Path

        from film_datasets.files import check_file

        _check_writable(options.output, options.force)
        check_file(Path(options.output), options.force)
    if options.plot:
        _check_picture(options.plot, options.force)


def _check_picture(path: str, force: bool) -> None:
    from film_model.plot import check_picture

    check_picture(path)
    _check_writable(path, force)


def _table(history: History) -> str:
    """Summary, events and choices as text."""
    from film_model.effects import COMPUTED
    from film_model.history import SUMMARY
    from film_model.units import format_si

    problem, accuracy = history.problem, history.accuracy
    lines = [history.scene.title or "Impact", f"law {problem.law.name}; {history.outcome.value}", ""]
    for name, (dimension, _) in SUMMARY.items():
        value = history.summary[name]
        lines.append(f"  {name.replace('_', ' '):30}{'-' if value is None else format_si(value, dimension, 6):>16}")
    lines += ["", f"  {'event':24}{'time':>14}{'indentation':>16}{'force':>14}"]
    for event in history.events[:MOST_EVENTS]:
        numbers = (
            f"{format_si(event.time, 'time', 5):>14}{format_si(event.indentation, 'length', 5):>16}"
            f"{format_si(event.contact_force, 'force', 5):>14}"
        )
        what = f"  ({event.stage})" if event.name == "stage_changes" else ""
        lines.append(f"  {event.name.replace('_', ' '):24}{numbers}{what}")
    if len(history.events) > MOST_EVENTS:
        lines.append(f"  and {len(history.events) - MOST_EVENTS} more")
    lines.append("")
    lines += [
        f"  {effect.name.replace('_', ' ')}: {effect.state}; {effect.reason}"
        for effect in problem.effects
        if effect.name in COMPUTED
    ]
    means = f"{accuracy.modes} modes" if accuracy.modes else f"{accuracy.lines} lines"
    lines.append(f"  error at most {accuracy.estimated:.1e} of every value, by {means}")
    return "\n".join(lines)


def _laws(options: argparse.Namespace) -> int:
    from film_model.laws import LAWS
    from film_model.laws.unloading import UNLOADINGS

    if options.plot:
        from film_model.plot import plot_laws

        _check_picture(options.plot, options.force)
        plot_laws(options.plot)
        print(f"wrote {options.plot}", file=sys.stderr)
    rows = [{"name": name, **_law_row(law)} for name, law in LAWS.items()]
    rules = [{"name": name, **_law_row(law)} for name, law in UNLOADINGS.items()]
    if options.json:
        return _print_json({"laws": rows, "unloadings": rules})
    for row in rows:
        _print_law(row)
    print('\nof any law, with unloading = "..." in [contact]:\n')
    for row in rules:
        _print_law(row)
    return DONE


def _law_row(law: type[AbstractLaw]) -> dict[str, Any]:
    return {
        "summary": law.summary,
        "source": law.source,
        "validity": law.validity,
        "parameters": {
            key: {
                "dimension": p.dimension,
                "choices": list(p.choices),
                "required": p.required,
                "several": p.several,
                "help": p.help,
            }
            for key, p in law.parameters.items()
        },
    }


def _print_law(row: dict[str, Any]) -> None:
    print(f"{row['name']:20}{row['summary']}\n{'':20}{row['source']}\n{'':20}valid: {row['validity']}")
    for key, parameter in row["parameters"].items():
        kind = " | ".join(parameter["choices"]) or parameter["dimension"].replace("_", " ")
        kind = f"list of {kind}s" if parameter["several"] else kind
        needed = "" if parameter["required"] else ", may be left out"
        print(f"{'':20}  {key}: {parameter['help']} ({kind}{needed})")


def _materials(options: argparse.Namespace) -> int:
    from film_model.materials import catalogue
    from film_model.units import format_si

    materials = list(catalogue().values())
    if options.json:
        keys = ("name", "youngs_modulus", "poissons_ratio", "density", "yield_strength", "source")
        return _print_json({"materials": [{key: getattr(m, key) for key in keys} for m in materials]})
    print(f"{'name':28}{'E':>10}{'nu':>7}{'density':>14}{'yield':>10}  source")
    for m in materials:
        strength = "-" if m.yield_strength is None else format_si(m.yield_strength, "pressure")
        density = f"{m.density:g} kg/m3"
        modulus = format_si(m.youngs_modulus, "pressure")
        print(f"{m.name:28}{modulus:>10}{m.poissons_ratio:>7}{density:>14}{strength:>10}  {m.source}")
    return DONE


def _print_json(table: dict[str, Any]) -> int:
    escaped = not (sys.stdout.encoding or "").lower().startswith("utf")
    print(json.dumps(table, indent=2, ensure_ascii=escaped, allow_nan=False))
    return DONE
