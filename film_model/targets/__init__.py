"""What the impactor hits: one kind of target per file, and the list `TARGETS`.

To add a kind (docs/adding_a_target.md): its file, its name in `TARGETS`, and for editors and `from film_model import *`
its import here and its class in `__all__`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_model.base.late import LateClasses
from film_model.targets.bending_stiffness import BendingStiffness
from film_model.targets.modes import Modes
from film_model.targets.target import AbstractTarget, Estimate, Impact

if TYPE_CHECKING:
    from film_model.targets.beam import Beam
    from film_model.targets.body import Body
    from film_model.targets.half_space import HalfSpace
    from film_model.targets.plate import Plate
    from film_model.targets.rod import Rod
    from film_model.targets.structure import Structure

TARGETS: LateClasses[AbstractTarget] = LateClasses(
    __name__, ("half-space", "plate", "beam", "rod", "body", "structure")
)
"""Every kind of target by its name in scene files. Readers, messages and pages are made from it."""


def __getattr__(name: str) -> type[AbstractTarget]:
    return TARGETS.called(name)


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
