"""What the adhesive laws share: their parameters, and the check of the work of adhesion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from film_model.laws.law import AbstractLaw, ExampleBall, Family


@dataclass(frozen=True)
class AdhesiveLaw(AbstractLaw):
    """An elastic sphere that its surroundings pull. work_of_adhesion: w, J/m², of both surfaces together."""

    family: ClassVar[Family] = "adhesive"

    effective_modulus: float
    radius: float
    work_of_adhesion: float

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {"work_of_adhesion": 0.05}  # of oxidised metals in air, about

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        work = values.get("work_of_adhesion")
        if isinstance(work, float | int) and not 0.0 < work < math.inf:
            return {"work_of_adhesion": f"{work:g} must be > 0: without adhesion take law hertz"}
        return {}
