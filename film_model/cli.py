"""The command line: film-model run | export-fmu | check-fmu | laws | materials.

Results go to standard output, warnings to standard error. Exit status 0: done; 2: the scene or the command line is
wrong; 3: the simulation could not be done.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from film_model.history import History

DONE, WRONG, FAILED = 0, 2, 3


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit status."""
    options = _parser().parse_args(arguments)
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
    except KeyboardInterrupt:
        return _complain("interrupted", 130)


def _complain(text: str, status: int) -> int:
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

    export = commands.add_parser("export-fmu", help="write the impact of a scene file as an FMU")
    export.add_argument("scene", help="scene file (TOML)")
    export.add_argument("--fmi", type=int, choices=(2, 3), default=3, help="FMI version (default: 3)")
    export.add_argument(
        "--kind", choices=("impact", "contact"), default="impact", help="impactor with its mass, or force element"
    )
    export.add_argument("--initial-gap", metavar="LENGTH", default="0 m", help='distance at the start, e.g. "5 mm"')
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

    laws = commands.add_parser("laws", help="list the contact laws and their parameters")
    laws.add_argument("--json", action="store_true", help="print one JSON object")
    laws.set_defaults(command=_laws)

    materials = commands.add_parser("materials", help="list the materials of the catalogue")
    materials.add_argument("--json", action="store_true", help="print one JSON object")
    materials.set_defaults(command=_materials)
    return parser


def _run(options: argparse.Namespace) -> int:
    from film_model.scene import Scene
    from film_model.solve import simulate

    for path in filter(None, (options.output, options.plot)):
        _check_writable(path, options.force)
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


def _export_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper
    from film_model.scene import Scene
    from film_model.units import to_si

    gap = to_si(options.initial_gap, "length")
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


def _check_writable(path: str, force: bool) -> None:
    """Say before the work what would make it useless after."""
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise FileNotFoundError(f"{path}: the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{path}: the folder {folder} cannot be written to")
    if os.path.exists(path) and not force:
        raise FileExistsError(f"{path} exists; use --force to overwrite it")


def _table(history: History) -> str:
    """Summary, events and choices as text."""
    from film_model.history import SUMMARY
    from film_model.units import format_si

    problem, accuracy = history.problem, history.accuracy
    lines = [history.scene.title or "Impact", f"law {problem.law.name}; {history.outcome.value}", ""]
    for name, (dimension, _) in SUMMARY.items():
        value = history.summary[name]
        lines.append(f"  {name.replace('_', ' '):30}{'-' if value is None else format_si(value, dimension, 6):>16}")
    lines += ["", f"  {'event':24}{'time':>14}{'indentation':>16}{'force':>14}"]
    for event in history.events:
        numbers = (
            f"{format_si(event.time, 'time', 5):>14}{format_si(event.indentation, 'length', 5):>16}"
            f"{format_si(event.contact_force, 'force', 5):>14}"
        )
        what = f"  ({event.stage})" if event.name == "stage_changes" else ""
        lines.append(f"  {event.name.replace('_', ' '):24}{numbers}{what}")
    lines.append("")
    lines += [f"  {effect.name.replace('_', ' ')}: {effect.state}; {effect.reason}" for effect in problem.effects]
    means = f"{accuracy.modes} modes" if accuracy.modes else f"{accuracy.lines} lines"
    lines.append(f"  error at most {accuracy.estimated:.1e} of every value, by {means}")
    return "\n".join(lines)


def _laws(options: argparse.Namespace) -> int:
    from film_model.laws import LAWS

    rows: list[dict[str, Any]] = [
        {
            "name": law.name,
            "summary": law.summary,
            "source": law.source,
            "parameters": {
                key: {"dimension": p.dimension, "choices": list(p.choices), "required": p.required, "help": p.help}
                for key, p in law.parameters.items()
            },
        }
        for law in LAWS.values()
    ]
    if options.json:
        return _print_json({"laws": rows})
    for row in rows:
        print(f"{row['name']:14}{row['summary']}\n{'':14}{row['source']}")
        for key, parameter in row["parameters"].items():
            kind = " | ".join(parameter["choices"]) or parameter["dimension"].replace("_", " ")
            needed = "" if parameter["required"] else ", may be left out"
            print(f"{'':14}  {key}: {parameter['help']} ({kind}{needed})")
    return DONE


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
    print(json.dumps(table, indent=2, ensure_ascii=False, allow_nan=False))
    return DONE
