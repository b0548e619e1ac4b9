"""What all impacts of a dataset have in common: values of their scene, and a number that tells scenes apart."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from typing import Any

import numpy as np

from film_model.base.foreign import Dataset
from film_model.scene import Scene


def constants_of(scene: Scene) -> dict[str, Any]:
    """The values of `schema.CONSTANTS` that a scene has, SI; arrays if the scene has arrays."""
    law = scene.contact.law_name
    values = {
        "mass": scene.mass,
        "radius": scene.impactor.radius,
        "approach_velocity": scene.approach_velocity,
        "effective_modulus": scene.effective_modulus,
        "yield_strength": scene.yield_strength,
        "impact_energy": scene.kinetic_energy,
        "contact_law_name": None if law == "auto" else law,
    }
    return {name: value for name, value in values.items() if value is not None}


def common_constants(scenes: Iterable[Scene]) -> dict[str, Any]:
    """The constants that all scenes have, with the same value."""
    common: dict[str, Any] | None = None
    for scene in scenes:
        with np.errstate(all="ignore"):  # a value out of range is no constant of the impacts
            own = {name: np.unique(np.asarray(value)) for name, value in constants_of(scene).items()}
        single = {name: values.item() for name, values in own.items() if values.size == 1}
        common = {n: v for n, v in (common or single).items() if single.get(n) == v} if common != {} else {}
    return common or {}


def scene_key(scene_text: str, words: Iterable[str] = ()) -> int:
    """A number of 31 bits that differs between scenes, and between sweeps that give words different numbers."""
    digest = hashlib.sha256("\0".join((scene_text, *words)).encode()).digest()
    return int.from_bytes(digest[:4], "big") >> 1


def check_scene_key(ds: Dataset, key: int) -> None:
    """Raise ValueError if an impact of the dataset belongs to another scene; older files do not tell."""
    if "scene_key" in ds.variables and (ds["scene_key"] != key).any():
        raise ValueError(
            "datasets of different scenes were joined, and only the first one's scene is known: use the dataset that "
            "the impact came from"
        )
