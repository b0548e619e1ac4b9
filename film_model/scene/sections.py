"""The parts of a scene from the sections of its file, and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, cast

from film_model.base.errors import Mistake, SceneError, did_you_mean, shown
from film_model.base.fields import build, key_text, table_of
from film_model.scene.contact import Contact, contact_table
from film_model.scene.impactor import Sphere
from film_model.scene.options import Effects, Solver
from film_model.targets import TARGETS, AbstractTarget

SECTIONS = ("impactor", "target", "contact", "effects", "solver")
"""Of a scene file, in order, each a part of a scene."""


def section_of(name: str, part: Any, whole: bool = False) -> dict[str, Any]:
    """The section of that name with a part of a scene. whole: as of `table_of`."""
    kind = {"kind": part.kind} if name == "target" else {}
    return contact_table(part) if name == "contact" else kind | table_of(part, whole)


def parts_of(table: Mapping[str, Any]) -> tuple[dict[str, Any], list[Mistake]]:
    """The parts of a scene from its sections, and their mistakes."""
    makers: dict[str, Callable[[dict[str, Any]], Any]] = {
        "impactor": lambda section: build(Sphere, section),
        "target": target_of,
        "contact": lambda section: Contact(**section),
        "effects": lambda section: build(Effects, section),
        "solver": lambda section: build(Solver, section),
    }
    mistakes: list[Mistake] = []
    parts: dict[str, Any] = {}
    for key, value in table.items():
        if key == "title":
            parts[key] = value
        elif key not in makers:
            hint = did_you_mean(key, ["title", *makers])
            mistakes.append(Mistake(None, None, key_text(key), f"unknown key{hint}"))
        elif not isinstance(value, Mapping):
            mistakes.append(Mistake(None, None, key, f"{shown(value)} is not allowed: a section [{key}] is needed"))
        else:
            try:
                parts[key] = makers[key](dict(cast("Mapping[str, Any]", value)))
            except SceneError as error:
                mistakes += [found.moved(key) for found in error.mistakes]
    return parts, mistakes


def target_of(section: dict[str, Any]) -> AbstractTarget:
    """The target of a section."""
    kind = section.pop("kind", None)
    if isinstance(kind, str) and kind in TARGETS:
        return build(TARGETS[kind], section)
    need = ", ".join(f'"{known}"' for known in TARGETS) + " is needed"
    if kind is None:
        raise SceneError([Mistake(None, None, "Target.kind", f"missing: {need}")])
    hint = did_you_mean(kind, TARGETS) if isinstance(kind, str) else ""
    raise SceneError([Mistake(None, None, "Target.kind", f"{shown(kind)} is not allowed: {need}{hint}")])
