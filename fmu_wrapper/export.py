"""Scene → .fmu: the description, the curve, the binaries and a page of documentation in one file."""

from __future__ import annotations

import io
import json
import math
import os
import re
import uuid
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from film_datasets.history import effect_line
from film_datasets.provenance import scene_text
from film_model import units
from film_model.accuracy import mesh_for
from film_model.bodies import Body
from film_model.component import DEFAULT_SEGMENTS
from film_model.errors import Outcome, SimulationError
from film_model.files import written_whole
from film_model.history import History
from film_model.problem import Problem, problem_of, refuse_vibrations
from film_model.scene import Scene
from film_model.solve import simulate
from fmu_wrapper import platforms, resource
from fmu_wrapper.documentation import documentation
from fmu_wrapper.model_description import Experiment, FmiVersion, model_description
from fmu_wrapper.variables import KINDS, VARIABLES, Kind, reference

_NAMESPACE = uuid.UUID("6c9a1e0e-53a4-5b0c-8f57-0a1d6b5b3c55")
_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_OLDEST = (1980, 1, 1, 0, 0, 0)  # of a ZIP entry: the same export gives the same bytes


def export(
    scene: Scene,
    path: str | os.PathLike[str],
    fmi_version: int = 3,
    *,
    kind: Kind = "impact",
    initial_gap: Any = 0.0,
    platform: str | Sequence[str] | None = None,
    with_sources: bool = False,
    overwrite: bool = False,
) -> Path:
    """Write a scene as an FMU that runs anywhere, without Python; the path it was written to.

    kind: "impact", the impactor with its mass, for Co-Simulation and Model Exchange; or "contact", the force element.
    initial_gap: of an impact, the distance before first touch ("5 mm" or m). platform: names of
    `fmu_wrapper.platforms.PLATFORMS`, or "all"; this machine's own by default, which needs no compiler. with_sources:
    C sources too, for importers that compile. The law, the effects and the number of segments are those the library
    chooses for the scene; mass, velocity, gap, radius, modulus, yield strength and impedance can still be set before
    each simulation. A damped law's damping follows them; a user's law whose damping is no power of one of them is
    exported without that one.

    Raises ValueError for a bad argument, FileExistsError, SimulationError as `simulate` does and for an impact on a
    free body, ImportError when matplotlib (for the pictures) or ziglang (for other platforms) is missing.
    """
    target = Path(path)
    if fmi_version not in (2, 3):
        raise ValueError(f"fmi_version: {fmi_version!r} is not allowed: 2 or 3 is needed")
    if kind not in KINDS:
        raise ValueError(f"kind: {kind!r} is not allowed: {' or '.join(map(repr, KINDS))} is needed")
    if target.suffix != ".fmu":
        raise ValueError(f"{target}: the name of an FMU must end in .fmu")
    if target.exists() and not overwrite:
        raise FileExistsError(f"{target}: exists; say overwrite=True to replace it")
    if isinstance(scene.target, Body) and kind == "impact":
        raise SimulationError(
            "an impact on a free body cannot be exported: it has no impedance to act against; "
            "kind contact is the force between the two"
        )
    try:
        gap = units.to_si(initial_gap, "length", bare=True)
    except ValueError as error:
        raise ValueError(f"initial_gap: {error}") from None
    resource.check_range(VARIABLES[reference("initial_gap")], gap)
    if gap > 0.0 and kind == "contact":
        raise ValueError(f"initial_gap: {gap:g} m is not allowed: the importer gives a contact its indentation")
    version: FmiVersion = 2 if fmi_version == 2 else 3
    binaries = _binaries(platform)
    files = _contents(scene, kind, version, gap, with_sources)
    for name, binary in binaries.items():
        where = platforms.PLATFORMS.get(name)
        suffix = Path(platforms.built_library()).suffix if where is None else where.suffix
        files[f"binaries/{platforms.folder(name, version)}/{kind}{suffix}"] = binary
    with written_whole(target) as beside:
        beside.write_bytes(_zipped(files))
    return target


def _binaries(platform: str | Sequence[str] | None) -> dict[str, bytes]:
    own = platforms.this_platform()
    if platform is None:
        library = platforms.ROOT / platforms.built_library()
        if not library.exists():
            raise ImportError(f"{library} is missing: install the package (pip install .), which compiles it")
        return {own: library.read_bytes()}
    names = [platform] if isinstance(platform, str) else list(platform)
    if names == ["all"]:
        names = list(platforms.PLATFORMS)
    unknown = [name for name in names if name not in platforms.PLATFORMS]
    if unknown or not names:
        raise ValueError(
            f"platform: {', '.join(unknown) or 'none'} is not allowed: all or {', '.join(platforms.PLATFORMS)}"
        )
    return {name: platforms.cross_compile(name) for name in names}


def _contents(scene: Scene, kind: Kind, version: FmiVersion, gap: float, with_sources: bool) -> dict[str, bytes]:
    """Every file but the binaries."""
    scene = replace(scene, title=_NOT_IN_XML.sub("\N{REPLACEMENT CHARACTER}", scene.title))
    problem = problem_of(scene)
    refuse_vibrations(problem, "an FMU")
    if problem.compliance > 0.0:
        raise SimulationError("an FMU is not to be had for a target of a static stiffness: simulate() gives its motion")
    segments, _ = mesh_for(scene, problem, None, None, None, fallback=DEFAULT_SEGMENTS)
    history = simulate(scene) if problem.approach > 0.0 or problem.load > 0.0 else None
    data = resource.model_data(scene, problem, kind, gap, segments, _nominals(problem, history))
    experiment = _experiment(problem, history, gap)
    title = scene.title or f"Impact on a {scene.target.kind}"
    description = title if kind == "impact" else f"Contact force. {title}"
    sources = [Path(name).name for name in platforms.SOURCES] if with_sources else []

    def described(token: str) -> bytes:
        return model_description(data, version, token, description, experiment, sources)

    text = scene_text(scene)
    unnamed = described("") + resource.finished(data, "") + text.encode()
    token = f"{{{uuid.uuid5(_NAMESPACE, unnamed.hex())}}}"
    files = {
        "modelDescription.xml": described(token),
        f"resources/{resource.NAME}": resource.finished(data, token),
        "resources/scene.toml": text.encode(),
        f"resources/{resource.NOTES}": _notes(problem, history),
        **{
            f"documentation/{name}": page
            for name, page in documentation(scene, problem, data, history, experiment).items()
        },
        "documentation/licenses/license.txt": platforms.license_text(),
    }
    if with_sources:
        for name in (*platforms.SOURCES, *platforms.HEADERS):
            files[f"sources/{Path(name).name}"] = (platforms.ROOT / name).read_bytes()
        if version == 3:
            files["sources/buildDescription.xml"] = _build_description(kind, sources)
    return files


def _notes(problem: Problem, history: History | None) -> bytes:
    """What is known of the scene when it is exported, for datasets of runs: law, effects and warnings."""
    warnings = history.warnings if history is not None else problem.warnings
    effects = [effect_line(effect) for effect in problem.effects]
    notes = {"contact_law": str(problem.law), "effects": effects, "warnings": list(warnings)}
    return json.dumps(notes, ensure_ascii=False, indent=1).encode()


def _nominals(problem: Problem, history: History | None) -> tuple[float, float, float]:
    """Sizes of the states: indentation, impactor velocity, target displacement."""
    units, most = problem.scales, {"xi": 1.0, "nu": 1.0}
    if history is not None and history.lines.size:
        most = {name: float(np.abs(history.lines[name]).max()) or 1.0 for name in most}
    deepest = None if history is None else history.summary["maximum_indentation"]
    depth = deepest or most["xi"] * units.length
    speed = (problem.approach or most["nu"]) * units.velocity
    moved = 0.0 if history is None or not history.events else history.events[-1].target_displacement
    return depth, speed, max(abs(moved), depth)


def _experiment(problem: Problem, history: History | None, gap: float) -> Experiment:
    """From the start to somewhat beyond the end of contact, or of its first swing if it has none, in 250 steps.

    tolerance: with a thousandth of the accuracy asked for, CVODE's errors stay below that accuracy.
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


def _build_description(kind: Kind, sources: list[str]) -> bytes:
    files = "".join(f'      <SourceFile name="{name}"/>\n' for name in sources)
    for name, value in platforms.DEFINITIONS.items():
        files += f'      <PreprocessorDefinition name="{name}" value="{value}"/>\n'
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<fmiBuildDescription fmiVersion="3.0">\n'
        f'  <BuildConfiguration modelIdentifier="{kind}">\n'
        f'    <SourceFileSet language="C99">\n{files}    </SourceFileSet>\n'
        '    <Library name="m"/>\n'
        "  </BuildConfiguration>\n"
        "</fmiBuildDescription>\n"
    ).encode()


def _zipped(files: dict[str, bytes]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, _OLDEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, content)
    return packed.getvalue()
