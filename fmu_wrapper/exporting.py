"""Export: scene → .fmu, a ZIP file with the model description, the curve, the binaries and a documentation page."""

from __future__ import annotations

import json
import math
import os
import uuid
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np

from film_model.base import units
from film_model.base.errors import Outcome, SimulationError
from film_model.base.files import check_replaceable, written_whole
from film_model.effects.choose import Choice, choose
from film_model.oblique.stepped import SteppedFriction
from film_model.problem.problem import Problem
from film_model.scene import DEFAULT_ACCURACY, Scene
from film_model.solve.accuracy import mesh_for
from film_model.solve.history import History
from film_model.solve.motions import modes_for
from film_model.solve.relaxed import tolerance_for
from film_model.solve.simulate import simulate_chosen
from film_model.solve.vibration import Vibration
from fmu_wrapper import platforms, resource
from fmu_wrapper.archive import zipped
from fmu_wrapper.assumptions import segments_for_speeds, served, validity_of
from fmu_wrapper.documentation import documentation
from fmu_wrapper.free_body import as_structure
from fmu_wrapper.model_description import Experiment, FmiVersion, Names, Outputs, model_description, printable
from fmu_wrapper.related import related_files
from fmu_wrapper.terminals import terminals_and_icons
from fmu_wrapper.variables import KINDS, VARIABLES, Kind, reference

OUTPUTS: tuple[Outputs, ...] = get_args(Outputs)
_NAMESPACE = uuid.UUID("6c9a1e0e-53a4-5b0c-8f57-0a1d6b5b3c55")


def export(
    scene: Scene,
    path: str | os.PathLike[str],
    fmi_version: int = 3,
    *,
    kind: Kind = "impact",
    initial_gap: Any = 0.0,
    platform: str | Sequence[str] | None = None,
    with_sources: bool = False,
    name: str | None = None,
    outputs: Outputs = "all",
    overwrite: bool = False,
) -> Path:
    """Write a scene as an FMU, which runs without Python. Returns the path of the file.

    kind: "impact" contains the impactor with its mass; "contact" is the force element alone. They are for
    Co-Simulation and, except on targets that vibrate or have a static stiffness and for viscoelastic bodies, Model
    Exchange. initial_gap: "5 mm". platform: names from `fmu_wrapper.platforms.PLATFORMS`, or "all", which
    leaves out "wasm32-wasi", for browsers; this machine's binary is the package's, others need ziglang. The default is
    all where ziglang is installed, else this machine.
    with_sources: for importers that compile; C names begin with the model identifier, so that several FMUs link
    into one program. name: of the model, from which the identifier is made too; the default is the scene's title.
    outputs: "real" makes local variables of those that are no real numbers, for tools that take real outputs only.

    The FMU serves every value of its parameters (:func:`fmu_wrapper.served`), and reports by its output `validity`
    where an assumption of the export does not hold. A parameter is left out if the law's stages depend on it, or if a
    user's law has a damping that is not a power of it.

    Raises ValueError for an invalid argument; FileExistsError; SimulationError as `simulate` does, of a free body as
    `as_structure`, and for a contact of viscoelastic bodies; ImportError if matplotlib or ziglang is missing.
    """
    target = Path(path)
    if scene.target.free and kind == "impact":
        scene = as_structure(scene)
    _check_friction(scene, kind)
    _check_choices(fmi_version, kind, outputs, target)
    check_replaceable(target, overwrite)
    try:
        gap = units.to_si(initial_gap, "length", bare=True)
    except ValueError as error:
        raise ValueError(f"initial_gap: {error}") from None
    resource.check_range(VARIABLES[reference("initial_gap")], gap)
    if gap > 0.0 and kind == "contact":
        raise ValueError(f"initial_gap: {gap:g} m is not allowed: the indentation of a contact is an input")
    version: FmiVersion = 2 if fmi_version == 2 else 3
    names = Names.of(scene, kind, name)
    binaries = _binaries(platform)
    files = _contents(scene, kind, version, gap, with_sources, names, outputs)
    for on, binary in binaries.items():
        where = platforms.PLATFORMS.get(on)
        suffix = Path(platforms.built_library()).suffix if where is None else where.suffix
        files[f"binaries/{platforms.folder(on, version)}/{names.identifier}{suffix}"] = binary
    with written_whole(target) as beside:
        beside.write_bytes(zipped(files))
    return target


def _check_choices(fmi_version: int, kind: Kind, outputs: Outputs, target: Path) -> None:
    """Raise ValueError for what is not among the values that are allowed."""
    if fmi_version not in (2, 3):
        raise ValueError(f"fmi_version: {fmi_version!r} is not allowed: 2 or 3 is needed")
    if kind not in KINDS:
        raise ValueError(f"kind: {kind!r} is not allowed: {' or '.join(map(repr, KINDS))} is needed")
    if outputs not in OUTPUTS:
        raise ValueError(f"outputs: {outputs!r} is not allowed: {' or '.join(map(repr, OUTPUTS))} is needed")
    if target.suffix != ".fmu":
        raise ValueError(f"{target}: the file name of an FMU must end in .fmu")


def _binaries(platform: str | Sequence[str] | None) -> dict[str, bytes]:
    """Binaries by platform: this machine's from the package, others compiled or from the cache."""
    own, everywhere = platforms.this_platform(), platforms.EVERYWHERE
    if platform is None:
        platform = (own, *everywhere) if platforms.can_cross_compile() else own
    names = list(dict.fromkeys([platform] if isinstance(platform, str) else platform))
    if names == ["all"]:
        names = list(everywhere)
    unknown = [name for name in names if name not in (own, *platforms.PLATFORMS)]
    if unknown or not names:
        allowed = ", ".join(platforms.PLATFORMS)
        raise ValueError(f"platform: {', '.join(unknown) or 'none'} is not allowed: all or {allowed}")
    found = platforms.cross_compiled([name for name in names if name != own])
    if own in names:
        library = platforms.ROOT / platforms.built_library()
        if not library.exists():
            raise ImportError(f"{library} is missing: install the package (pip install .) to compile it")
        found[own] = library.read_bytes()
    return {name: found[name] for name in names}


def _check_friction(scene: Scene, kind: Kind) -> None:
    """Raise SimulationError for friction that an FMU cannot contain."""
    if kind == "contact":
        scene.contact.refuse_friction("a contact contains")
    elif scene.contact.friction is not None:
        SteppedFriction(choose(scene).problem)


def _contents(
    scene: Scene, kind: Kind, version: FmiVersion, gap: float, with_sources: bool, names: Names, outputs: Outputs
) -> dict[str, bytes]:
    """All files except the binaries."""
    scene = replace(scene, title=printable(scene.title))
    on = served(scene, kind)
    choice, segments, history = _simulated(on, kind)
    problem = choice.problem
    vibration = _vibration(problem, history)
    if vibration is None:
        segments = segments_for_speeds(scene, problem, segments)
    nominals, tolerance = _nominals(problem, history), 0.0
    if problem.relaxation is not None:
        tolerance = tolerance_for(problem, on.solver.accuracy or DEFAULT_ACCURACY)
    data = resource.model_data(problem, kind, gap, segments, nominals, validity_of(on), vibration, tolerance)
    experiment = _experiment(problem, history, gap)
    title = scene.title or f"Impact on a {scene.target.kind}"
    description = title if kind == "impact" else f"Contact force. {title}"
    code = platforms.prefixed_sources(names.identifier, version) if with_sources else {}
    sources = [one for one in code if one.endswith(".c")]

    def described(token: str) -> bytes:
        sensors = [sensor.name for sensor in scene.target.sensors or ()][: data.modes.sensors]
        return model_description(data, version, token, names, description, experiment, sources, sensors, outputs)

    text = scene.archived_text()
    unnamed = described("") + resource.finished(data, "") + text.encode()
    token = f"{{{uuid.uuid5(_NAMESPACE, unnamed.hex())}}}"
    files = {
        "modelDescription.xml": described(token),
        f"resources/{resource.NAME}": resource.finished(data, token),
        "resources/scene.toml": text.encode(),
        f"resources/{resource.NOTES}": _notes(choice, history),
        **{
            f"documentation/{name}": page
            for name, page in documentation(title, scene, choice, data, history, experiment).items()
        },
        "documentation/licenses/license.txt": platforms.license_text(),
        **terminals_and_icons(data, version, history),
        **related_files(resource.component_of(on, data) if kind == "impact" else None, experiment),
    }
    if with_sources:
        files |= {f"sources/{one}": text for one, text in code.items()}
        if version == 3:
            files["sources/buildDescription.xml"] = _build_description(names.identifier, sources)
    return files


def _simulated(scene: Scene, kind: Kind) -> tuple[Choice, tuple[int, int], History | None]:
    """The choice of effects, segments for loading and unloading, and the history, or None if nothing moves."""
    choice = choose(scene)
    problem = choice.problem
    if problem.relaxation is not None and kind == "contact":
        raise SimulationError(
            "kind contact is not supported for a viscoelastic material: its force depends on all of the motion before, "
            "of which a contact knows the communication points only; export kind impact, or take the instantaneous "
            "modulus by viscoelasticity = false in [effects]"
        )
    history = simulate_chosen(choice, scene.solver) if problem.approach > 0.0 or problem.load > 0.0 else None
    if problem.vibrates or problem.relaxation is not None:
        segments = (0, 0)
    elif history is None or problem.approach == 0.0:
        segments, _ = mesh_for(problem, scene.solver)
    else:
        segments = (history.accuracy.segments, history.accuracy.unloading_segments)
    return choice, segments, history


def _vibration(problem: Problem, history: History | None) -> Vibration | None:
    """The impact with the natural vibrations that the FMU contains; None if the target does not vibrate."""
    if history is not None or not problem.vibrates:
        return None if history is None else cast("Vibration | None", history.vibration)  # simulated, not from a file
    return modes_for(problem, problem.scene.solver.accuracy or DEFAULT_ACCURACY, [])


def _notes(choice: Choice, history: History | None) -> bytes:
    """Law, effects and warnings at the time of the export, for the attributes of datasets of runs."""
    warnings = history.warnings if history is not None else choice.warnings
    effects = [effect.line for effect in choice.effects]
    law = choice.problem.law
    notes = {"contact_law": str(law), "contact_law_name": law.name, "effects": effects, "warnings": list(warnings)}
    return json.dumps(notes, ensure_ascii=False, indent=1).encode()


def _nominals(problem: Problem, history: History | None) -> tuple[float, float, float]:
    """Nominal values of the states indentation, impactor velocity and target displacement, SI."""
    scales, largest = problem.scales, {"xi": 1.0, "nu": 1.0}
    if history is not None and history.lines.size:
        largest = {name: float(np.abs(history.lines[name]).max()) or 1.0 for name in largest}
    maximum = None if history is None else history.summary["maximum_indentation"]
    depth = maximum or largest["xi"] * scales.length
    speed = (problem.approach or largest["nu"]) * scales.velocity
    moved = 0.0 if history is None or not history.events else history.events[-1].target_displacement
    return depth, speed, max(abs(moved), depth)


def _experiment(problem: Problem, history: History | None, gap: float) -> Experiment:
    """Default experiment in 250 steps, from the start to 1.25 times the contact (the first swing if it does not end).

    tolerance: 1e-3 of the requested accuracy keeps CVODE's errors below that accuracy.
    """
    contact = 0.0 if history is None else history.duration
    if history is not None and history.outcome is Outcome.TIME_LIMIT:
        contact = 2.0 * (history.summary["time_of_maximum_indentation"] or 0.5 * contact)
    contact = contact or 10.0 * problem.scales.time
    speed = problem.approach * problem.scales.velocity
    pull = problem.load * problem.scales.force / problem.mass
    fall = 2.0 * gap / (speed + math.sqrt(speed**2 + 2.0 * pull * gap)) if speed + pull > 0.0 and gap > 0.0 else 0.0
    stop = float(f"{fall + 1.25 * contact:.3g}")
    accuracy = problem.scene.solver.accuracy or 1e-4
    return Experiment(stop, stop / 250.0, min(max(1e-3 * accuracy, 1e-10), 1e-7))


def _build_description(identifier: str, sources: list[str]) -> bytes:
    files = "".join(f'      <SourceFile name="{name}"/>\n' for name in sources)
    for name, value in platforms.DEFINITIONS.items():
        files += f'      <PreprocessorDefinition name="{name}" value="{value}"/>\n'
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<fmiBuildDescription fmiVersion="3.0">\n'
        f'  <BuildConfiguration modelIdentifier="{identifier}">\n'
        f'    <SourceFileSet language="C99">\n{files}    </SourceFileSet>\n'
        '    <Library name="m"/>\n'
        "  </BuildConfiguration>\n"
        "</fmiBuildDescription>\n"
    ).encode()
