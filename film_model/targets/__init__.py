"""What the impactor hits: one kind of target per file, and the list `TARGETS`.

To add a kind (docs/adding_a_target.md): its file, its import here, and its name in `TARGETS` and in `__all__`.
"""

from __future__ import annotations

from film_model.targets.beam import Beam
from film_model.targets.bending_stiffness import BendingStiffness
from film_model.targets.body import Body
from film_model.targets.half_space import HalfSpace
from film_model.targets.modes import Modes
from film_model.targets.plate import Plate
from film_model.targets.rod import Rod
from film_model.targets.structure import Structure
from film_model.targets.target import AbstractTarget, Estimate, Impact

TARGETS: dict[str, type[AbstractTarget]] = {
    target.kind: target for target in (HalfSpace, Plate, Beam, Rod, Body, Structure)
}
"""Every kind of target by its name in scene files. Readers, messages and pages are made from it."""

__all__ = [
    "TARGETS",
    "AbstractTarget",
    "Beam",
    "BendingStiffness",
    "Body",
    "Estimate",
    "HalfSpace",
    "Impact",
    "Modes",
    "Plate",
    "Rod",
    "Structure",
]
