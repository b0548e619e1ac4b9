"""film-model export-fmu, export-ssp, check-fmu."""

from __future__ import annotations

import argparse
import sys

from film_model.cli.output import (
    DONE,
    FAILED,
    Commands,
    add_common,
    add_scene,
    check_writable,
    give,
    print_written,
    read_scene,
)


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    parser = commands.add("export-fmu", "write the impact of a scene file as an FMU", export_fmu)
    add_scene(parser)
    parser.add_argument("--fmi", type=int, choices=(2, 3), default=3, help="FMI version (default: 3)")
    parser.add_argument(
        "--kind", choices=("impact", "contact"), default="impact", help="impactor with its mass, or force element"
    )
    parser.add_argument(
        "--initial-gap", metavar="LENGTH", default="0 m", help='distance between the bodies at the start, e.g. "5 mm"'
    )
    parser.add_argument(
        "--platform",
        action="append",
        metavar="NAME",
        help="e.g. aarch64-linux, or all (default: all where zig is installed, else this machine's)",
    )
    parser.add_argument("--with-sources", action="store_true", help="include the C sources, for importers that compile")
    parser.add_argument("--name", help="name of the model (default: the kind and the scene's title)")
    parser.add_argument(
        "--outputs", choices=("all", "real"), default="all", help="real: for tools that take real outputs only"
    )
    parser.add_argument("--output", metavar="FILE.fmu", help="file to write (default: impact.fmu or contact.fmu)")
    add_common(parser, json=False)

    parser = commands.add("export-ssp", "write contact and bodies of a scene file as an SSP package", export_ssp)
    add_scene(parser)
    parser.add_argument("--platform", action="append", metavar="NAME", help="as for export-fmu")
    parser.add_argument("--output", metavar="FILE.ssp", default="impact.ssp", help="file to write (impact.ssp)")
    add_common(parser, json=False)

    parser = commands.add("check-fmu", "validate an FMU and compare its runs with the library's", check_fmu)
    parser.add_argument("fmu", help="FMU written by export-fmu")
    parser.add_argument("--verbose", action="store_true", help="print every comparison, not one of each run")
    add_common(parser, force="")


def export_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper
    from film_model.base.units import to_si

    try:
        gap = to_si(options.initial_gap, "length")
    except ValueError as error:
        raise ValueError(f"--initial-gap: {error}") from None
    path = options.output or f"{options.kind}.fmu"
    check_writable(path, options.force)
    scene = read_scene(options)
    same = {name: getattr(options, name) for name in ("kind", "platform", "with_sources", "name", "outputs")}
    fmu_wrapper.export(scene, path, options.fmi, initial_gap=gap, overwrite=options.force, **same)
    print_written(path)
    if options.kind == "impact" and scene.effects.gravity == "auto":
        print("the weight is simulated, however small; the parameter gravity = 0 leaves it out", file=sys.stderr)
    _say_if_alone(options)
    return DONE


def _say_if_alone(options: argparse.Namespace) -> None:
    """Say that there is one binary only where none was asked for and the others cannot be compiled."""
    from fmu_wrapper import platforms

    if options.platform is None and not platforms.can_cross_compile():
        print(
            f"its binary is for {platforms.this_platform()} only: those for four other systems need "
            'pip install "film-model[cross-compile]"',
            file=sys.stderr,
        )


def export_ssp(options: argparse.Namespace) -> int:
    import fmu_wrapper

    check_writable(options.output, options.force)
    scene = read_scene(options)
    package = fmu_wrapper.export_ssp(scene, options.output, platform=options.platform, overwrite=options.force)
    print_written(options.output)
    _say_if_alone(options)
    print(f"components: {', '.join(package.components)}; parameter sets: {len(package.materials)}", file=sys.stderr)
    by_reason: dict[str, list[str]] = {}
    for name, reason in package.left_out.items():
        by_reason.setdefault(reason, []).append(name)
    for reason, names in by_reason.items():
        print(f"no parameter set for {', '.join(names)}: {reason}", file=sys.stderr)
    return DONE


def check_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper

    report = fmu_wrapper.check(options.fmu)
    lines = [f"error      {problem}" for problem in report.problems]
    lines.append(f"{'result':10} {'comparison with the library':48} {'error':>8}  allowed")
    for finding in report.findings if options.verbose else report.largest():
        word = "agrees" if finding.good else "differs"
        where = "" if finding.good else f"  at {finding.where}"
        lines.append(f"{word:10} {finding.what:48} {finding.difference:8.1e}  {finding.allowed:7.0e}{where}")
    lines.append(f"{report.path}: {'passed' if report.good else 'failed'}")
    give(options, lambda: "\n".join(lines), report.to_dict)
    return DONE if report.good else FAILED
