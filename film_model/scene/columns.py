"""Many impacts as one scene, in which arrays replace some of the numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from film_model.base.arrays import Array
from film_model.scene.scene import Scene
from film_model.scene.toml import in_place_of


def scene_of_columns(scene: Scene, columns: Mapping[str, Array]) -> Scene:
    """The scene with arrays [SI] in place of some of its numbers, by path: its derived values are arrays too."""
    made = _shared(scene)
    owners: dict[str, Any] = {"": made}
    for path, values in columns.items():
        section, _, name = path.rpartition(".")
        owner = owners.get(section) or _copied(section, owners)
        if path.startswith("contact.") and name not in owner.FIELDS:
            object.__setattr__(owner, "parameters", {**owner.parameters, name: values})
        elif name == "diameter" and getattr(owner, "is_ball", False):  # of which the radius is stored
            object.__setattr__(owner, "radius", 0.5 * values)
        else:
            object.__setattr__(owner, name, values)
            if name == "yield_strength" and (other := in_place_of(path)) is not None and other not in columns:
                object.__setattr__(owner, "hardness", None)
    return made


def scene_of_row(scene: Scene, columns: Mapping[str, Array], row: int) -> Scene:
    """The scene with the numbers [SI] of one row of some columns."""
    numbers: dict[str, Any] = {path: float(values[row]) for path, values in columns.items()}
    return scene_of_columns(scene, numbers)


def _copied(section: str, owners: dict[str, Any]) -> Any:
    """A copy of a part of the scene, put into a copy of the part that has it. owners: the copies by their paths."""
    parent, _, name = section.rpartition(".")
    owner = owners.get(parent) or _copied(parent, owners)
    owners[section] = _shared(getattr(owner, name))
    object.__setattr__(owner, name, owners[section])
    return owners[section]


def _shared(owner: Any) -> Any:
    """A copy with the same fields, without what is derived from them and kept."""
    made, names = object.__new__(type(owner)), owner.__dataclass_fields__
    made.__dict__.update({name: value for name, value in owner.__dict__.items() if name in names})
    return made
