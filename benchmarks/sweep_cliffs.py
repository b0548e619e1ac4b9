"""CPU time per impact of sweeps over each quantity: `python -m benchmarks.sweep_cliffs [--rows 20000] [--above 10]`.

For every contact law and target, each number that a scene may vary is swept over a factor of four, in memory, in one
thread. Printed are CPU microseconds per impact after a sweep of 256 impacts that makes imports and curves; it stands
for a sweep that takes more than `SLOW` per impact. `--above` prints only sweeps with more than so many microseconds.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import film_datasets
import film_model as fm
from film_model.base.errors import SceneError
from film_model.base.fields import written
from film_model.laws import LAWS
from film_model.laws.example_ball import STEEL_BALL
from film_model.scene.paths import field_at, unit_of

SLOW = 1000.0
"""CPU microseconds per impact in the sweep of 256 impacts, from which the large one is not run."""

OF_ALL = ("impactor.velocity", "impactor.mass", "impactor.radius")

MATERIAL: dict[str, Any] = {
    "youngs_modulus": "209.3 GPa",
    "poissons_ratio": 0.3,
    "density": "7850 kg/m^3",
    "yield_strength": "0.5 GPa",
}
"""Steel, of which two bodies have the effective modulus of `STEEL_BALL`."""

TARGETS: dict[str, tuple[Any, dict[str, Any]]] = {
    "half-space": (fm.HalfSpace(material=MATERIAL), {}),
    "plate": (fm.Plate(material=MATERIAL, thickness="20 mm"), {}),
    "rod": (fm.Rod(material=MATERIAL, diameter="30 mm"), {}),
    "body": (fm.Body(material=MATERIAL, radius="20 mm"), {}),
    "edged plate": (fm.Plate(material=MATERIAL, thickness="20 mm", size=["400 mm", "400 mm"]), {}),
    "static plate": (
        fm.Plate(material=MATERIAL, thickness="20 mm", size=["400 mm", "400 mm"]),
        {"boundary_reflections": True, "target_inertia": False},
    ),
    "with gravity": (fm.HalfSpace(material=MATERIAL), {"gravity": True}),
}

Case = tuple[str, str, str, fm.Scene, dict[str, Any], str]
"""Law, target, path, scene, its range, what is kept."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print."""
    purpose = (__doc__ or "").split("\n")[0]
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sweep_cliffs", description=purpose)
    parser.add_argument("--rows", type=int, default=20_000, help="impacts of a sweep")
    parser.add_argument("--above", type=float, default=0.0, help="least microseconds that are printed")
    parser.add_argument("--only", default="", help="part of a case's text")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the rows there")
    options = parser.parse_args(arguments)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    rows: list[dict[str, Any]] = []
    print(f"  {'law':20}{'target':16}{'varied':34}{'kept':14}{'CPU µs':>9}")
    for law, target, path, scene, span, keep in cases():
        text = f"  {law:20}{target:16}{path:34}{keep:14}"
        if options.only not in text:
            continue
        try:
            each = cost(scene, path, span, keep, options.rows)
        except (SceneError, fm.SimulationError) as error:
            print(f"{text}   {str(error).splitlines()[0][:90]}")
            continue
        rows.append({"law": law, "target": target, "path": path, "keep": keep, "microseconds": each})
        if each >= options.above:
            print(f"{text}{each:>9.2f}", flush=True)
    if options.json is not None:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    return 0


def cases() -> Iterator[Case]:
    """Every sweep that is measured."""
    for law in ("auto", *LAWS):
        if law == "tabulated":
            continue
        for target in TARGETS:
            scene = scene_of(law, target)
            numbers = [path for path in own_numbers(scene) if target == "half-space" or path not in OF_ALL[2:]]
            for path in numbers:
                yield law, target, path, scene, around(scene, path), "summary"
    for law in ("hertz", "jackson-green", "tsuji"):
        for target in ("half-space", "plate"):
            for keep in ("segments", "samples=201"):
                scene = scene_of(law, target)
                yield law, target, OF_ALL[0], scene, around(scene, OF_ALL[0]), keep
    yield from plate_cases()
    yield from accuracy_cases()
    for law in ("auto", "big-alabo", "stronge", "yigit-christoforou"):
        ball = fm.Sphere("10 mm", velocity="1 m/s", material="mild steel")
        scene = fm.Scene(ball, fm.HalfSpace(material="aluminium 6061-T6"), contact_of(law))
        for path in (*OF_ALL, "impactor.material.yield_strength"):
            yield law, "hardening metal", path, scene, around(scene, path), "summary"
    pair = fm.Scene(fm.Sphere("10 mm", velocity="1 m/s", material=MATERIAL), fm.Body(material=MATERIAL, radius="10 mm"))
    for law in ("auto", "big-alabo", "kogut-etsion"):
        scene = pair.replace(entries(law))
        for path in OF_ALL[:2]:
            ends = {"from": "5 mm/s", "to": "2 m/s", "spacing": "log"} if path == OF_ALL[0] else around(scene, path)
            yield law, "balls near yield", path, scene, ends, "summary"


def plate_cases() -> Iterator[Case]:
    """Plates on which the weight holds the contact shut, others with gravity, and both in one sweep."""
    ball = fm.Sphere("10 mm", velocity="1 m/s", material=MATERIAL)
    for law in ("auto", "hertz", "big-alabo"):
        for thickness in ("1 mm", "2 mm", "2.5 mm", "5 mm", "20 mm"):
            plate = fm.Plate(material=MATERIAL, thickness=thickness)
            scene = fm.Scene(ball, plate, fm.Contact(law), fm.Effects(gravity=True))
            yield law, f"plate of {thickness}", OF_ALL[0], scene, around(scene, OF_ALL[0]), "summary"
        scene = fm.Scene(ball, fm.Plate(material=MATERIAL, thickness="5 mm"), fm.Contact(law))
        yield law, "plate", "target.thickness", scene, {"from": "1 mm", "to": "20 mm"}, "summary"


def accuracy_cases() -> Iterator[Case]:
    """Other accuracies, and damping that leaves little velocity."""
    for accuracy in (1e-2, 3e-3, 1e-3, 1e-6, 1e-8):
        for law in ("auto", "hertz", "big-alabo", "jkr", "dmt", "thornton-ning", "hunt-crossley"):
            for target in ("half-space", "plate"):
                scene = scene_of(law, target).replace({"solver": {"accuracy": accuracy}})
                yield law, f"{target} {accuracy:g}", OF_ALL[0], scene, around(scene, OF_ALL[0]), "summary"
    scene = scene_of("hunt-crossley", "half-space")
    yield "hunt-crossley", "half-space", "contact.restitution", scene, {"from": "0.02", "to": "0.1"}, "summary"


def scene_of(law: str, target: str) -> fm.Scene:
    """The steel ball under a law on a target."""
    ball, (struck, effects) = STEEL_BALL, TARGETS[target]
    sphere = fm.Sphere(
        f"{ball.radius!r} m", velocity=f"{ball.velocity!r} m/s", mass=f"{ball.mass!r} kg", material=MATERIAL
    )
    return fm.Scene(sphere, struck, contact_of(law), fm.Effects(**effects))


def contact_of(law: str) -> fm.Contact:
    """The contact of a law with its example's parameters."""
    own = parameters_of(law)
    adhesion: dict[str, Any] = {"work_of_adhesion": "0.1 J/m^2"} if law in ("jkr", "dmt", "thornton-ning") else {}
    given: dict[str, Any] = {name: value_text(law, name, value, own) for name, value in own.items()}
    return fm.Contact(law, **given, **adhesion)


def parameters_of(law: str) -> dict[str, Any]:
    """The law's own parameters, SI, of its example."""
    if law == "auto":
        return {}
    return {name: v for name, v in LAWS[law].example(STEEL_BALL).items() if name in LAWS[law].parameters}


def value_text(law: str, name: str, value: Any, own: Mapping[str, Any]) -> Any:
    """A parameter of a law as a scene has it."""
    dimension = LAWS[law].parameters[name].dimension
    if dimension == "meyer_stiffness":
        exponent = own.get("exponent", getattr(LAWS[law], "exponent", 1.5))
        return f"{value!r} N/m^{exponent:g}"
    return written(value, dimension)


def entries(law: str) -> dict[str, Any]:
    """The entries of a scene that name a law, with its example's parameters."""
    own = parameters_of(law)
    return {"contact": {"law": law, **{name: value_text(law, name, value, own) for name, value in own.items()}}}


def own_numbers(scene: fm.Scene) -> list[str]:
    """The paths that are swept: of all scenes, of materials, and of the law."""
    law, contact = scene.contact.law, scene.contact
    own = [f"contact.{name}" for name, value in contact.parameters.items() if isinstance(value, float)]
    own = [path for path in own if path != "contact.exponent"]  # the unit of the stiffness depends on it
    materials = [f"target.material.{name}" for name in ("youngs_modulus", "poissons_ratio", "yield_strength")]
    fields = getattr(LAWS.get(str(law)), "__dataclass_fields__", dict.fromkeys(("effective_modulus", "yield_strength")))
    used = ("effective_modulus", "effective_modulus", "yield_strength")
    return [*OF_ALL, *(path for path, name in zip(materials, used, strict=True) if name in fields), *own]


def around(scene: fm.Scene, path: str) -> dict[str, Any]:
    """A range from half of the scene's number to twice it, or to what is possible."""
    field = field_at(scene, path)
    assert field is not None
    unit = unit_of(scene, field)
    value = number_at(scene, path)
    low, high = {
        "contact.restitution": (0.3, 0.9),
        "contact.exponent": (1.2, 1.8),
        "contact.unloading_stiffness": (value, 4.0 * value),
        "contact.plastic_stiffness": (value, 4.0 * value),
        "contact.loading_stiffness": (0.5 * value, value),
        "target.material.poissons_ratio": (0.2, 0.4),
    }.get(path, (0.5 * value, 2.0 * value))
    return {"from": f"{low!r} {unit}".strip(), "to": f"{high!r} {unit}".strip(), "spacing": "log"}


def number_at(scene: fm.Scene, path: str) -> float:
    """The number at a path, SI."""
    owner: Any = scene
    *sections, name = path.split(".")
    for section in sections:
        owner = getattr(owner, section)
    if path == "impactor.mass":
        return scene.mass  # also that by the density
    return owner.parameters[name] if path.startswith("contact.") and name in owner.parameters else getattr(owner, name)


def cost(scene: fm.Scene, path: str, span: Mapping[str, Any], keep: str, rows: int) -> float:
    """CPU microseconds per impact."""
    if keep.startswith("samples"):
        rows //= 4
    found = 0.0
    for count in (64, 256, rows):
        busy = time.process_time()
        film_datasets.sweep(scene, {path: {**span, "count": count}}, keep=keep, workers=1)
        found = 1e6 * (time.process_time() - busy) / count
        if count == 256 and found > SLOW:
            break
    return found


if __name__ == "__main__":
    sys.exit(main())
