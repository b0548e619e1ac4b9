"""The three ways to describe a plate in a scene."""

from __future__ import annotations

from collections.abc import Mapping

from film_model.base.errors import Mistake
from film_model.base.fields import mistake


def kind_mistakes(
    plate: object, material: object, thickness: object, pair: Mapping[str, object], layup: object
) -> list[Mistake]:
    """The mistake of describing the plate in none of the three ways, or in two. pair: mass_per_area and
    bending_stiffness."""
    either = "give thickness (isotropic), or mass_per_area and bending_stiffness, or layup"
    given = [name for name, value in pair.items() if value is not None]
    if layup is not None:
        others = [*given, *(["thickness"] if thickness is not None else [])]
        return [mistake(plate, name, f"{either}, not two of them") for name in others]
    if thickness is None and len(given) < 2:
        missing = "thickness" if not given else next(name for name in pair if name not in given)
        return [mistake(plate, missing, f"missing: {either}")]
    if thickness is None:
        return []
    mistakes = [mistake(plate, name, f"{either}, not both") for name in given]
    if material is None:
        mistakes.append(mistake(plate, "material", f"missing: a plate of given thickness needs it; {either}"))
    return mistakes
