"""A system for SSP 1.0 importers: the contact FMU, a free mass for each body that moves, and parameter sets.

A target that vibrates or has a static stiffness stays with its impactor, in one impact FMU."""

from __future__ import annotations

import os
import re
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import film_model as fm
from film_model.base.errors import SceneError, SimulationError
from film_model.base.files import check_replaceable, written_whole
from film_model.base.materials import catalogue
from film_model.effects.choose import Choice, choose
from film_model.scene import STANDARD_GRAVITY, Scene
from film_model.solve.simulate import simulate_chosen
from fmu_wrapper import resource
from fmu_wrapper.archive import zipped
from fmu_wrapper.assumptions import served
from fmu_wrapper.exporting import export
from fmu_wrapper.layout import OF_LAW
from fmu_wrapper.powers import field_of
from fmu_wrapper.resource import Data, has
from fmu_wrapper.ssp_files import Connection, Element, parameter_set, system_structure
from fmu_wrapper.variables import VARIABLES, Real, reference

_System = tuple[list[Element], list[Connection], dict[str, bytes], dict[str, str]]
"""Components, their connections, parameter sets of materials by file name, and materials left out with reasons."""


@dataclass(frozen=True)
class Package:
    """What was written: the file, its components, its materials, and those that the contact cannot serve: why."""

    path: Path
    components: tuple[str, ...]
    materials: tuple[str, ...]
    left_out: dict[str, str]


def export_ssp(
    scene: Scene, path: str | os.PathLike[str], *, platform: str | Sequence[str] | None = None, overwrite: bool = False
) -> Package:
    """Write the impact of a scene as an SSP 1.0 package for Co-Simulation, with FMUs for FMI 2.0.

    The components are the scene's contact (`contact`), its impactor as a free mass (`impactor`), and a second mass if
    the target is a free body (`target`). A plate, beam or rod moves by its impedance Z: the impactor's
    support_velocity is contact_force / Z. A half-space does not move. The folder `materials` contains a parameter set
    of the contact for each material of the catalogue that the target may be made of. A target that vibrates or has a
    static stiffness cannot be parted from its contact: the only component is then the `impact`, without such sets.
    platform: as in `export`.

    Raises as `export` does.
    """
    target = Path(path)
    if target.suffix != ".ssp":
        raise ValueError(f"{target}: the file name of an SSP package must end in .ssp")
    check_replaceable(target, overwrite)
    choice = choose(served(scene) if not scene.target.free else served(scene, "contact"))
    with tempfile.TemporaryDirectory() as folder:
        if choice.problem.vibrates or choice.problem.given.compliance > 0.0:
            elements, connections, sets, left_out = _whole(scene, Path(folder), platform)
        else:
            elements, connections, sets, left_out = _parted(scene, choice, Path(folder), platform)
        fmus = {f"resources/{one.name}": one.read_bytes() for one in sorted(Path(folder).iterdir())}
    text = system_structure(scene.title or "Impact", elements, connections, *_times(choice))
    own = {f"resources/{element.name}.ssv": parameter_set(element.name, element.values) for element in elements}
    with written_whole(target) as beside:
        beside.write_bytes(zipped({"SystemStructure.ssd": text, **own, **sets, **fmus}))
    return Package(
        target, tuple(element.name for element in elements), tuple(Path(path).stem for path in sets), left_out
    )


def _parted(scene: Scene, choice: Choice, folder: Path, platform: Any) -> _System:
    """The contact and its bodies as components."""
    contact = _exported(scene, folder / "contact.fmu", "contact", platform)
    mass = _exported(_free_mass(scene, contact), folder / "mass.fmu", "impact", platform)
    return (_elements(scene, choice, contact, mass), _connections(scene, choice), *_materials(scene, contact))


def _whole(scene: Scene, folder: Path, platform: Any) -> _System:
    """The impact as the only component."""
    impact = _exported(scene, folder / "impact.fmu", "impact", platform)
    reason = "the motion of the target depends on its material, and the FMU contains it: export each"
    values = {
        v.name: impact.start[k]
        for k, v in enumerate(VARIABLES)
        if v.causality.get("impact") == "parameter" and v.type is Real and has(impact, v.name)
    }
    return [Element("impact", "resources/impact.fmu", impact, values)], [], {}, dict.fromkeys(catalogue(), reason)


def _exported(scene: Scene, path: Path, kind: Any, platform: Any) -> Data:
    export(scene, path, 2, kind=kind, platform=platform, name=path.stem)
    with zipfile.ZipFile(path) as archive:
        return resource.read(archive.read(f"resources/{resource.NAME}"))


def _free_mass(scene: Scene, contact: Data) -> Scene:
    """A scene whose FMU is a free mass as soon as its contact is made soft: no material, no limit of validity."""
    depth, force = contact.nominal[0], contact.force_scale * (contact.nominal[0] / contact.length_scale) ** 1.5
    return fm.Scene(
        fm.Sphere(
            radius=f"{scene.effective_radius!r} m",
            mass=f"{scene.mass!r} kg",
            velocity=f"{max(scene.approach_velocity, contact.speed)!r} m/s",
        ),
        fm.HalfSpace(),
        contact=fm.Contact(law="meyer", stiffness=f"{force / depth**1.5!r} N/m^1.5", exponent=1.5),
        effects=fm.Effects(gravity=True, target_motion=False),
        title="A free mass: its own contact is made negligible by power_stiffness",
    )


def _elements(scene: Scene, choice: Choice, contact: Data, mass: Data) -> list[Element]:
    """The components, with the start values of parameters and of inputs that are not 0."""
    # a mass is an impact FMU whose own contact is so much softer than the scene's that its force is negligible
    soft = 1e-12 * mass.start[reference("power_stiffness")]
    body, rate = scene.target, scene.approach_velocity
    gravity = STANDARD_GRAVITY if choice.problem.load > 0.0 else 0.0
    law = {
        name: value
        for name, value in resource.start_values(contact).items()
        if name in (*OF_LAW, "input_extrapolation")
    }
    free = {"gravity": gravity, "power_stiffness": soft}
    impactor = {"mass": scene.mass, "initial_velocity": body.velocity + rate, "support_velocity": body.velocity}
    elements = [
        Element("contact", "resources/contact.fmu", contact, {**law, "relative_velocity": rate}),
        Element("impactor", "resources/mass.fmu", mass, {**impactor, **free}),
    ]
    if body.free:
        assert body.own_mass is not None
        other = {"mass": body.own_mass, "initial_velocity": body.velocity}
        elements.append(Element("target", "resources/mass.fmu", mass, {**other, **free}))
    return elements


def _connections(scene: Scene, choice: Choice) -> list[Connection]:
    """Indentation and its rate act on the contact, its force on the bodies; forces push them apart."""
    connections = [
        Connection("impactor", "indentation", "contact", "indentation"),
        Connection("impactor", "relative_velocity", "contact", "relative_velocity"),
        Connection("contact", "contact_force", "impactor", "external_force", -1.0),
    ]
    if scene.target.free:
        connections.append(Connection("contact", "contact_force", "target", "external_force"))
        connections.append(Connection("target", "impactor_velocity", "impactor", "support_velocity"))
    elif choice.problem.gamma > 0.0:
        yields = 1.0 / choice.problem.given.impedance
        connections.append(Connection("contact", "contact_force", "impactor", "support_velocity", yields))
    return connections


def _times(choice: Choice) -> tuple[float, float]:
    """Stop time and communication step, 200 in a contact, s, rounded to three digits."""
    problem = choice.problem
    lasts = (
        simulate_chosen(choice, problem.scene.solver).duration if problem.approach > 0.0 else 10.0 * problem.scales.time
    )
    return float(f"{1.25 * lasts:.3g}"), float(f"{lasts / 200:.3g}")


def _materials(scene: Scene, contact: Data) -> tuple[dict[str, bytes], dict[str, str]]:
    """Parameter sets of the contact by file name, and materials left out with reasons."""
    parameters: dict[str, dict[str, float]] = {}
    left_out: dict[str, str] = {}
    for name in catalogue():
        try:
            parameters[name] = _of_material(scene, name, contact)
        except (SceneError, SimulationError, ValueError) as error:
            left_out[name] = str(error)
    if len({tuple(values.values()) for values in parameters.values()}) == 1:
        left_out |= dict.fromkeys(parameters, "the contact law of the scene does not depend on the target's material")
        parameters = {}
    stems = {name: re.sub(r"[\W_]", "_", name) for name in parameters}
    files = {f"resources/materials/{stems[name]}.ssv": values for name, values in parameters.items()}
    return {path: parameter_set(Path(path).stem, values) for path, values in files.items()}, left_out


def _of_material(scene: Scene, name: str, contact: Data) -> dict[str, float]:
    """Parameters of the contact if the target is made of a material. Raises ValueError if the law's curve differs."""
    other = choose(served(scene.replace({"target.material": name}), "contact")).problem
    names = [one for one in OF_LAW if has(contact, one)]
    values: dict[str, float] = {}
    for one in names:
        value = getattr(other.law, field_of(other.law, one), None)
        if value is None:
            raise ValueError(f"the contact is exported with {one}, which law {other.law.name} does not have here")
        values[one] = value
    shaped = contact.family.nodes > 0 and contact.family.low <= getattr(other.law, "shape", 0.0) <= contact.family.high
    if not shaped and bytes(other.curve.native) != bytes(contact.curve):
        raise ValueError("the stages of the law differ from those of the exported contact")
    return values
