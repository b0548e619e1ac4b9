"""A scene: impactor, target, contact, effects and solver, with units, from Python or a scene file."""

from __future__ import annotations

from film_model.scene.contact import Contact
from film_model.scene.impactor import SLOWEST, STANDARD_GRAVITY, Sphere
from film_model.scene.options import DEFAULT_ACCURACY, DEFAULT_TOLERANCE, Effects, Solver
from film_model.scene.scene import Scene

__all__ = [
    "DEFAULT_ACCURACY",
    "DEFAULT_TOLERANCE",
    "SLOWEST",
    "STANDARD_GRAVITY",
    "Contact",
    "Effects",
    "Scene",
    "Solver",
    "Sphere",
]
