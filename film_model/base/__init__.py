"""Used by all other packages: units, errors, fields of scene objects, materials, files, helpers for arrays."""

from __future__ import annotations

from film_model.base.errors import STATUSES, Mistake, Outcome, SceneError, SimulationError, Status
from film_model.base.fields import Field
from film_model.base.files import written_whole
from film_model.base.materials import Material, material

__all__ = [
    "STATUSES",
    "Field",
    "Material",
    "Mistake",
    "Outcome",
    "SceneError",
    "SimulationError",
    "Status",
    "material",
    "written_whole",
]
