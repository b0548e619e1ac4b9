"""film-model export-fmu, export-ssp, check-fmu, contact-for, modes, explore, export-page: with other programs."""

from __future__ import annotations

import argparse
import math
import re
from functools import partial
from typing import TYPE_CHECKING, Any

from film_model.cli.output import (
    DONE,
    FAILED,
    Commands,
    add_common,
    add_scene,
    check_writable,
    give,
    print_note,
    print_warnings,
    print_written,
    read_scene,
)

if TYPE_CHECKING:
    from film_model.scene import Scene
    from film_model.translate import Translation


def _add_fmus(commands: Commands) -> None:
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


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    _add_fmus(commands)
    parser = commands.add("contact-for", "fit the contact law of another engine to the impacts of a scene", contact_for)
    parser.add_argument("engine", help="name of the engine, e.g. mujoco; another word lists them")
    add_scene(parser)
    parser.add_argument(
        "--velocity",
        metavar="LOW..HIGH",
        help='approach velocities, e.g. 0.1..2 in m/s, or "5 mm/s..2 m/s" (default: half to twice the scene\'s)',
    )
    parser.add_argument("--law", metavar="NAME", help="only this law of the engine (default: all, the closest first)")
    parser.add_argument("--count", type=int, metavar="N", help="number of velocities in the range (default: 9)")
    add_common(parser, plot="compare force and restitution with the closest law's")

    parser = commands.add("modes", "vibrations from a finite-element program, or from matrices M and K", modes)
    parser.add_argument("what", choices=("read",), help='read: write them as a file for kind = "structure"')
    files = (
        ".unv (data sets 55); .op2, .pch of Nastran; .rst of Ansys; .dat of Abaqus, CalculiX; meshes .vtu, .vtk, .pvd, "
        ".xdmf, .med; .npz with K, M, C; .mtx of K"
    )
    parser.add_argument("file", metavar="FILE", help=files)
    parser.add_argument("--mass", metavar="FILE", help="M in Matrix Market format, beside K")
    parser.add_argument("--damping", metavar="FILE", help="C in Matrix Market format, beside K; optional")
    parser.add_argument(
        "--node",
        type=int,
        required=True,
        metavar="N",
        help="node that is struck; point of a mesh, row of matrices, from 1",
    )
    parser.add_argument("--direction", choices=("x", "y", "z"), help="of the impact, at nodes")
    parser.add_argument("--sensors", default="", metavar="N[,N]", help="nodes or rows of sensors: columns shape_N")
    parser.add_argument(
        "--mass-unit", choices=("kg", "g", "t"), help="of the model, e.g. t with mm and N (default: the file's, or kg)"
    )
    parser.add_argument(
        "--array", metavar="NAME", help="shapes of a mesh that has several arrays, without their number"
    )
    parser.add_argument(
        "--frequencies", default="", metavar="F[,F]", help="in Hz, or a file of them, in place of the file's"
    )
    masses = "of the shapes, one or one a vibration, or a file of them, in place of the file's; 1: normalised by mass"
    parser.add_argument("--modal-masses", default="", metavar="M[,M]", help=masses)
    parser.add_argument("--output", required=True, metavar="FILE.csv", help="file of vibrations")
    add_common(parser, json=False)

    parser = commands.add("explore", "simulate in a browser, with sliders", explore)
    parser.add_argument("scene", nargs="?", help="scene file (TOML); default: an example")
    parser.add_argument("--no-browser", action="store_true", help="only write the page and print where it is")

    parser = commands.add("export-page", "write a scene as one self-contained page with sliders", export_page)
    add_scene(parser)
    parser.add_argument("--output", metavar="FILE.html", default="impact.html", help="the page (impact.html)")
    add_common(parser, json=False)


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
        print_note("the weight is simulated, however small; the parameter gravity = 0 leaves it out")
    _say_if_alone(options)
    return DONE


def _say_if_alone(options: argparse.Namespace) -> None:
    """Say that there is one binary only where none was asked for and the others cannot be compiled."""
    from fmu_wrapper import platforms

    if options.platform is None and not platforms.can_cross_compile():
        print_note(
            f"its binary is for {platforms.this_platform()} only: those for four other systems need "
            'pip install "film-model[cross-compile]"'
        )


def export_ssp(options: argparse.Namespace) -> int:
    import fmu_wrapper

    check_writable(options.output, options.force)
    scene = read_scene(options)
    package = fmu_wrapper.export_ssp(scene, options.output, platform=options.platform, overwrite=options.force)
    print_written(options.output)
    _say_if_alone(options)
    print_note(f"components: {', '.join(package.components)}; parameter sets: {len(package.materials)}")
    by_reason: dict[str, list[str]] = {}
    for name, reason in package.left_out.items():
        by_reason.setdefault(reason, []).append(name)
    for reason, names in by_reason.items():
        print_note(f"no parameter set for {', '.join(names)}: {reason}")
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


def contact_for(options: argparse.Namespace) -> int:
    from film_model import translate
    from film_model.plot.engines import plot_translation

    engine = translate.engine_named(options.engine)
    velocity = _range(options.velocity)
    scene = read_scene(options)
    count = {} if options.count is None else {"count": options.count}
    made = translate.contact_for(engine, scene, velocity, law=options.law, **count)
    table = {"title": scene.title, "engine": engine.name, "laws": [one.to_dict() for one in made]}
    draw = partial(plot_translation, scene, made[0])
    return give(options, lambda: _law_text(scene, made), lambda: table, made[0].warnings, plot=draw)


def _range(text: str | None) -> tuple[Any, ...]:
    """The two ends of a range; plain numbers are m/s."""
    if text is None:
        return ()
    low, dots, high = text.partition("..")
    ends = (low, high) if dots else (low, low)
    made: list[Any] = []
    for end in ends:
        try:
            made.append(float(end))
        except ValueError:
            made.append(end.strip())
    return tuple(made)


def _law_text(scene: Scene, made: list[Translation]) -> str:
    """The closest law in full, the others in a row each."""
    width = 20
    best = made[0]
    speeds, at = best.velocities, f"at {best.velocities[0]:.3g} m/s"
    if len(speeds) > 1:
        at = f"at {len(speeds)} velocities, {speeds[0]:.3g} to {speeds[-1]:.3g} m/s"
    lines = [scene.title or "Impact", f"{best.engine.title}, law {best.law.name}: {best.law.formula}"]
    lines += [f"{best.law.source}", ""]
    for p in best.law.parameters:
        number = f"{best.values[p.name]:.6g} {p.unit}".rstrip()
        lines.append(f"  {p.name:{width}}{number:>24}  {p.meaning}")
    lines += ["", f"  {at:{width + 24}}{'error (rms)':>12}{'worst':>10}"]
    for name, error in best.errors.items():
        worst = f"{100 * error.worst:+.1f} % at {error.velocity:.3g} m/s"
        lines.append(f"  {name:{width + 24}}{100 * error.rms:>10.1f} %{worst:>22}")
    if best.tangential:
        lines += ["", f"  {'friction, ψ₂ over ψ₁, against ours':{width + 24}}{'error (rms)':>12}{'worst':>10}"]
    for name, one in best.tangential.items():
        lines.append(f"  {name:{width + 24}}{one.rms:>12.3f}{one.worst:>+10.3f} at ψ₁ = {one.before:.3g}")
    if len(made) > 1:
        lines += ["", f"  {'other laws':{width + 24}}{'force':>10}{'duration':>10}{'restitution':>13}  (rms)"]
    for one in made[1:]:
        force, duration, restitution = (f"{100 * error.rms:.1f} %" for error in one.errors.values())
        lines.append(f"  {one.law.name:{width + 24}}{force:>10}{duration:>10}{restitution:>13}")
        numbers = (f"{p.name} {one.values[p.name]:.6g} {p.unit}".rstrip() for p in one.law.parameters)
        lines.append(f"    {', '.join(numbers)}")
    lines += ["", *(f"  {note}" for note in best.law.notes), "", best.paste()]
    return "\n".join(lines)


def modes(options: argparse.Namespace) -> int:
    from pathlib import Path

    from film_model.targets.modes_of_programs import (
        MATRICES,
        Told,
        check_kind,
        gives_vibrations,
        read_matrices,
        read_vibrations,
    )

    check_writable(options.output, options.force)
    sensors = _numbers(options.sensors)
    path = Path(options.file)
    suffix = check_kind(path)
    if suffix not in MATRICES and options.direction is None:
        raise ValueError("--direction: missing: x, y or z is needed at a node")
    shapes = gives_vibrations(path, suffix)
    others = ("mass", "damping") if shapes else ("frequencies", "modal_masses", "array")
    for name in others:
        if getattr(options, name):
            raise ValueError(
                f"--{name.replace('_', '-')}: {path} has {'vibrations' if shapes else 'matrices'}: not allowed"
            )
    if shapes:
        frequencies, masses = (
            _values("--frequencies", options.frequencies),
            _values("--modal-masses", options.modal_masses),
        )
        told = Told(options.mass_unit, frequencies, masses, options.array)
        found = read_vibrations(path, options.node, options.direction, sensors, told)
    else:
        mass, damping = (None if name is None else Path(name) for name in (options.mass, options.damping))
        found = read_matrices(path, mass, damping, options.node, sensors, options.mass_unit, options.direction)
    found.write(Path(options.output))
    low, high = found.frequency[0], found.frequency[-1]
    print(f"{found.frequency.size} vibrations from {low:.6g} to {high:.6g} Hz")
    if found.place:
        print(f"node {options.node} at {', '.join(f'{x:.6g}' for x in found.place)}")
    if found.static_compliance is not None:
        print(f"static compliance {found.static_compliance:.6g} m/N")
    print_written(options.output)
    told = f"damping couples vibrations by up to {found.coupling:.2g} of their own: this is neglected"
    print_warnings([told] if found.coupling > 0.1 else [])
    return DONE


def _values(option: str, text: str) -> list[float]:
    """Numbers above or equal to 0 between commas or, in a file, also white space."""
    from pathlib import Path

    path = Path(text)
    if text and path.is_file():
        text = path.read_text("utf-8", errors="replace")
    try:
        found = [float(part) for part in re.split(r"[,;\s]+", text) if part]
    except ValueError:
        found = [math.nan]
    if not all(0.0 <= value < math.inf for value in found):
        raise ValueError(f'{option}: "{path}" is not a list of numbers such as 708,2453, or a file of them')
    return found


def _numbers(text: str) -> list[int]:
    try:
        found = [int(part) for part in text.split(",") if part.strip()]
    except ValueError:
        raise ValueError(f'--sensors: "{text}" is not a list of numbers such as 17,44') from None
    if len(set(found)) < len(found):
        raise ValueError(f'--sensors: "{text}" names a number twice')
    return found


def explore(options: argparse.Namespace) -> int:
    import tempfile
    import webbrowser
    from pathlib import Path

    from film_model.explorer.page import write_page

    scene = None if options.scene is None else read_scene(options)
    path = Path(tempfile.mkdtemp(prefix="film-model-"), "explorer.html")
    write_page(path, scene)
    print(path)
    if not options.no_browser and not webbrowser.open(path.as_uri()):
        raise OSError(f"no browser could be started: open {path} in one")
    return DONE


def export_page(options: argparse.Namespace) -> int:
    from pathlib import Path

    from film_model.explorer.page import write_page

    if Path(options.output).suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"--output: {options.output} must end in .html")
    check_writable(options.output, options.force)
    write_page(Path(options.output), read_scene(options))
    print_written(options.output)
    return DONE
