"""What the impactor hits: one kind of target per file, and the list `TARGETS`.

To add a kind (docs/adding_a_target.md): its file, its name in `TARGETS`, and for editors its import here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_model.base.late import LateClasses
from film_model.targets.bending_stiffness import BendingStiffness
from film_model.targets.modes import Modes
from film_model.targets.target import AbstractTarget, Estimate, Impact

if TYPE_CHECKING:
    from film_model.targets.beam import Beam as Beam
    from film_model.targets.body import Body as Body
    from film_model.targets.half_space import HalfSpace as HalfSpace
    from film_model.targets.plate import Plate as Plate
    from film_model.targets.rod import Rod as Rod
    from film_model.targets.structure import Structure as Structure

TARGETS: LateClasses[AbstractTarget] = LateClasses(
    __name__, ("half-space", "plate", "beam", "rod", "body", "structure")
)
"""Every kind of target by its name in scene files. Readers, messages and pages are made from it."""

__getattr__ = TARGETS.called

__all__ = ["TARGETS", "AbstractTarget", "BendingStiffness", "Estimate", "Impact", "Modes"]
__all__ += TARGETS.class_names  # pyright: ignore[reportUnsupportedDunderAll]
