"""The parameters that are fitted: their check, their start values and their scaling for the search."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from film_datasets.identification.result import TIME_OFFSET
from film_datasets.schema import MEASURED_CONDITIONS
from film_model.base.errors import Mistake, SceneError, raise_all
from film_model.base.fields import Field
from film_model.base.foreign import Dataset
from film_model.base.units import power_stiffness_unit, scene_unit
from film_model.scene import Scene
from film_model.scene.contact import parameter_fields, stiffness_unit
from film_model.scene.paths import field_at, number_text, refuse_twice, unit_of

STIFFNESS, EXPONENT = "contact.stiffness", "contact.exponent"
"""Numbers of which the second is in the unit of the first, so that it is fitted with it only."""


@dataclass(frozen=True)
class Parameter:
    """A parameter, SI, and the scaled value z in which it is searched: 0 at the start, of the order of 1.

    log: z is the logarithm of value/start, else (value - start)/scale.
    """

    path: str
    dimension: str
    unit: str
    start: float
    scale: float
    log: bool
    low: float
    high: float

    def si(self, z: float) -> float:
        """The value for a scaled value."""
        return self.start * math.exp(z) if self.log else self.start + self.scale * z

    def scaled(self, value: float) -> float:
        """The scaled value."""
        return math.log(value / self.start) if self.log else (value - self.start) / self.scale


def parameters_of(scene: Scene, fit: Sequence[str], measured: Sequence[Dataset]) -> list[Parameter]:
    """The parameters at the paths `fit`; a time offset for each history. Raises SceneError for those that cannot be
    fitted."""
    histories = [ds.attrs["measured"] == "history" for ds in measured]
    given = {name.replace("_", ".", 1) for ds in measured for name in MEASURED_CONDITIONS if name in ds.coords}
    _check(scene, fit, histories, given)
    found: list[Parameter] = []
    for path in fit:
        if path != TIME_OFFSET:
            found.append(_parameter(scene, path))
            continue
        for number, (ds, history) in enumerate(zip(measured, histories, strict=True)):
            if history:
                span = float(ds["t"].values[-1] - ds["t"].values[0])
                name = offset_name(number, len(measured))
                found.append(Parameter(name, "time", scene_unit("time"), 0.0, span, False, -span, span))
    return found


def without_data_sheet(scene: Scene, fit: Sequence[str]) -> dict[str, None]:
    """Changes of a scene that remove the yield strength beside a hardness that is fitted, which decides.

    Johnson and Cook's hardening needs the yield strength, so that it stays there.
    """
    removed: dict[str, None] = {}
    for part in ("impactor", "target"):
        material = getattr(getattr(scene, part), "material", None)
        given = material is not None and material.yield_strength is not None and material.strength_coefficient is None
        if given and f"{part}.material.hardness" in fit and f"{part}.material.yield_strength" not in fit:
            removed[f"{part}.material.yield_strength"] = None
    return removed


def offset_name(number: int, count: int) -> str:
    """The time offset of measurement `number` of `count`, from 0."""
    return TIME_OFFSET if count == 1 else f"{TIME_OFFSET}[{number + 1}]"


def scene_changes(values: Mapping[str, float], units: Mapping[str, str]) -> dict[str, Any]:
    """The values of parameters as changes of a scene. The unit of a stiffness follows a fitted exponent."""
    own = dict(units)
    if EXPONENT in values:
        own[STIFFNESS] = power_stiffness_unit(values[EXPONENT])
    return {path: number_text(value, own[path]) for path, value in values.items()}


def unit_at(scene: Scene, parameter: Parameter) -> str:
    """The unit of a parameter in the fitted scene."""
    return stiffness_unit(scene.contact) if parameter.dimension == "meyer_stiffness" else parameter.unit


def _field(scene: Scene, path: str, fit: Sequence[str]) -> Field | None:
    """As `field_at`; also an exponent whose stiffness is fitted, too."""
    fields = parameter_fields(scene.contact)
    if path == EXPONENT and STIFFNESS in fit and getattr(fields.get("stiffness"), "dimension", "") == "meyer_stiffness":
        return fields["exponent"]
    return field_at(scene, path)


def _check(scene: Scene, fit: Sequence[str], histories: Sequence[bool], given: Collection[str]) -> None:
    mistakes: list[Mistake] = []
    for path in fit:
        try:
            if path == TIME_OFFSET:
                if not any(histories):
                    raise ValueError("is for measured histories")
            elif _field(scene, path, fit) is None:
                raise ValueError("is not a number that can be fitted")
            elif path in given and not any(histories):
                raise ValueError("is measured")
            if list(fit).count(path) > 1:
                raise ValueError("is given twice")
            refuse_twice(scene, path, fit)
        except ValueError as error:
            mistakes.append(Mistake(None, None, f"fit: {path}", str(error)))
    if not fit:
        mistakes.append(Mistake(None, None, "fit", "missing: at least one parameter is needed"))
    raise_all(list(dict.fromkeys(mistakes)))


def _parameter(scene: Scene, path: str) -> Parameter:
    """A parameter that starts at the scene's value; in [contact], if that has no value, at the materials'."""
    value: Any = scene
    for name in path.split("."):
        value = value.parameters[name] if name in getattr(value, "parameters", {}) else getattr(value, name)
    if value is None and path.startswith("contact."):
        value = getattr(scene, path.partition(".")[2], None)
    if not isinstance(value, int | float):
        message = f"the scene has no {'value' if value is None else 'number'} to begin with: give one"
        raise SceneError([Mistake(None, None, f"fit: {path}", message)])
    field = _field(scene, path, (STIFFNESS,))
    assert field is not None and field.low is not None and field.high is not None
    start, unit = float(value), unit_of(scene, field)
    low, high = max(float(field.low), -1e30), min(float(field.high), 1e30)
    if field.open_ends:
        # the search keeps a distance from an open end
        low, high = low + 1e-9 * max(abs(low), 1e-3), high - 1e-9 * max(abs(high), 1e-3)
    if low >= 0.0 and start > 0.0 and field.dimension != "dimensionless":
        return Parameter(path, field.dimension, unit, start, start, True, max(low, 1e-9 * start), high)
    return Parameter(path, field.dimension, unit, start, abs(start) or 1.0, False, low, high)
