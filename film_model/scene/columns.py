"""Many impacts as one scene, in which arrays replace some of the numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from film_model.base.arrays import Array
from film_model.scene.scene import Scene


def scene_of_columns(scene: Scene, columns: Mapping[str, Array]) -> Scene:
    """The scene with arrays [SI] in place of some of its numbers, by path: its derived values are arrays too."""
    made = _copied(scene)
    for path, values in columns.items():
        *sections, name = path.split(".")
        owner: Any = made
        for section in sections:
            part = _copied(getattr(owner, section))
            object.__setattr__(owner, section, part)
            owner = part
        if path.startswith("contact.") and name not in owner.FIELDS:
            object.__setattr__(owner, "parameters", {**owner.parameters, name: values})
        else:
            object.__setattr__(owner, name, values)
    return made


def _copied(owner: Any) -> Any:
    """A copy that shares its attributes; what copy.copy does to find them takes most of its time."""
    made = object.__new__(type(owner))
    made.__dict__.update(owner.__dict__)
    return made
