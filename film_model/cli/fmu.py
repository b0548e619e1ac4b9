"""film-model export-fmu, export-ssp, check-fmu."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from film_model.cli.output import DONE, FAILED, add_force, add_json, check_writable, print_json, print_written


def add_commands(named: Any) -> None:
    """The commands and their options."""
    parser: argparse.ArgumentParser = named.add_parser("export-fmu", help="write the impact of a scene file as an FMU")
    parser.add_argument("scene", help="scene file (TOML)")
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
    add_force(parser, "overwrite an existing file")
    parser.set_defaults(command=export_fmu)

    parser = named.add_parser("export-ssp", help="write contact and bodies of a scene file as an SSP package")
    parser.add_argument("scene", help="scene file (TOML)")
    parser.add_argument("--platform", action="append", metavar="NAME", help="as for export-fmu")
    parser.add_argument("--output", metavar="FILE.ssp", default="impact.ssp", help="file to write (impact.ssp)")
    add_force(parser, "overwrite an existing file")
    parser.set_defaults(command=export_ssp)

    parser = named.add_parser("check-fmu", help="validate an FMU and compare its runs with the library's")
    parser.add_argument("fmu", help="FMU written by export-fmu")
    parser.add_argument("--verbose", action="store_true", help="print every comparison, not one of each run")
    add_json(parser)
    parser.set_defaults(command=check_fmu)


def export_fmu(options: argparse.Namespace) -> int:
    import fmu_wrapper
    from film_model.base.units import to_si
    from film_model.scene import Scene

    try:
        gap = to_si(options.initial_gap, "length")
    except ValueError as error:
        raise ValueError(f"--initial-gap: {error}") from None
    path = options.output or f"{options.kind}.fmu"
    check_writable(path, options.force)
    scene = Scene.from_toml(options.scene)
    fmu_wrapper.export(
        scene,
        path,
        options.fmi,
        kind=options.kind,
        initial_gap=gap,
        platform=options.platform,
        with_sources=options.with_sources,
        name=options.name,
        outputs=options.outputs,
        overwrite=options.force,
    )
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
    from film_model.scene import Scene

    check_writable(options.output, options.force)
    scene = Scene.from_toml(options.scene)
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
    if options.json:
        print_json(report.to_dict())
    else:
        for problem in report.problems:
            print(f"error      {problem}")
        print(f"{'result':10} {'comparison with the library':48} {'error':>8}  allowed")
        for finding in report.findings if options.verbose else report.largest():
            word = "agrees" if finding.good else "differs"
            where = "" if finding.good else f"  at {finding.where}"
            print(f"{word:10} {finding.what:48} {finding.difference:8.1e}  {finding.allowed:7.0e}{where}")
        print(f"{report.path}: {'passed' if report.good else 'failed'}")
    return DONE if report.good else FAILED
