"""The numbers of a scene by path ("impactor.velocity"): which can be varied, swept or fitted, and in which unit."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from film_model.base.errors import did_you_mean
from film_model.base.fields import DIAMETER, SYNONYMS, Field
from film_model.base.units import scene_unit
from film_model.scene.contact import Contact, parameter_fields, stiffness_unit
from film_model.scene.scene import Scene

_IN_PLACE_OF = {"impactor.velocity": "drop_height", "impactor.drop_height": "velocity"}
"""Numbers of which a scene has one → the other."""

SECTIONS = ("impactor", "target", "contact", "effects", "solver")


def field_at(scene: Scene, path: str) -> Field | None:
    """The scene's field at a path; None if the path is valid but does not hold a plain number with a range.

    Raises ValueError for a path that the scene does not have.
    """
    *sections, name = path.split(".")
    head = sections[0] if sections else name
    if head not in SECTIONS:
        hint = did_you_mean(path, _paths(scene)) or "; give section and key, such as contact.yield_strength"
        raise ValueError(f"unknown key{hint}")
    if not sections:
        return None
    owner = _section_at(scene, path, sections)
    fields: dict[str, Field] = dict(owner.FIELDS)
    if isinstance(owner, Contact):
        fields |= parameter_fields(owner)
    if head == "target" and name == "kind" and len(sections) == 1:
        return None
    if name == "exponent" and any(field.dimension == "meyer_stiffness" for field in fields.values()):
        raise ValueError("is in the unit of the stiffness: list [contact] sections that give both")
    if name == "diameter" and getattr(owner, "is_ball", False):
        return DIAMETER
    if name not in fields:
        raise ValueError(f"unknown key{_meant(path, fields) or did_you_mean(path, _paths(scene))}")
    other = _IN_PLACE_OF.get(path)
    if other is not None and getattr(owner, other) is not None:
        raise ValueError(f"the scene gives {sections[-1]}.{other}: give {name} there in its place")
    return None if fields[name].low is None or head == "solver" else fields[name]


def refuse_twice(scene: Scene, path: str, others: Collection[str]) -> None:
    """ValueError for the radius or diameter of a ball if the other one is among the other paths."""
    *sections, name = path.split(".")
    other = ".".join([*sections, {"radius": "diameter", "diameter": "radius"}.get(name, "")])
    if other in others and getattr(_section_at(scene, path, sections), "is_ball", False):
        raise ValueError(f"{other} is given, too: give one of them")


def _meant(path: str, fields: dict[str, Field]) -> str:
    """The path of a number that an unknown path may have meant, as the end of a message."""
    section, _, name = path.rpartition(".")
    if name == "diameter" and "radius" in fields:
        return f": give {section}.radius, half of it"
    inside = [f"{part}.{name}" for part, field in fields.items() if name in field.inside]
    known = [SYNONYMS[name]] if SYNONYMS.get(name) in fields else inside
    return f'; did you mean "{section}.{known[0]}"?' if known else did_you_mean(name, fields)


def unit_of(scene: Scene, field: Field) -> str:
    """The SI unit of a field as scene files write it."""
    if field.dimension == "meyer_stiffness":
        return stiffness_unit(scene.contact)
    return scene_unit(field.dimension)


def number_text(value: float, unit: str) -> Any:
    """A number [SI] as a value of the scene file: with its unit if it has one."""
    return f"{value!r} {unit}" if unit else value


def _section_at(scene: Scene, path: str, sections: list[str]) -> Any:
    owner: Any = scene
    for section in sections:
        child = getattr(owner, section, None)
        if child is None or not hasattr(child, "FIELDS"):
            missing = "is not in the scene: give it there first" if child is None else "has no entries of its own"
            raise ValueError(f"{section} {missing}" + did_you_mean(path, _paths(scene)))
        owner = child
    return owner


def _paths(scene: Scene) -> list[str]:
    sections = {"impactor": scene.impactor, "target": scene.target, "contact": scene.contact}
    return [f"{name}.{field}" for name, section in sections.items() for field in section.FIELDS]
