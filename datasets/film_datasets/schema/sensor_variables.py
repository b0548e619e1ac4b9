"""The variables of sensors on a structure: their motion in a history, their largest motions there and in a sweep."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from film_datasets.schema.motion_variables import number
from film_datasets.schema.variable import TEXT, Variable
from film_model.solve.sensed import MOTION

if TYPE_CHECKING:
    import xarray as xr

SENSOR = Variable("sensor", ("sensor",), TEXT, None, "name of the sensor")

SENSED = (
    SENSOR,
    *(
        number(f"sensor_{name}", ("sensor", "t"), kind, f"{name} of the sensor", what, optional=True)
        for name, (kind, what) in MOTION.items()
    ),
    *(
        number(f"sensor_maximum_{name}", ("sensor",), kind, f"largest {name} of the sensor", "absolute value", True)
        for name, (kind, _) in MOTION.items()
    ),
)


def peak_name(what: str, word: str) -> str:
    """The variable of the largest motion of one sensor: sensor_tip_maximum_velocity."""
    return f"sensor_{word}_maximum_{what}"


def peak_variables(words: Iterable[str], dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """The variables of the largest motions of sensors in a sweep."""
    return tuple(
        number(
            *(peak_name(name, word), dims, kind, f"largest {name} of the sensor {word}"),
            "absolute value; NaN if the vibrations of the target are not simulated",
            optional=True,
        )
        for word in words
        for name, (kind, _) in MOTION.items()
    )


def peaks_in(ds: xr.Dataset, dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """The variables of the largest motions that a sweep says it has."""
    return peak_variables(str(ds.attrs.get("sensors", "")).split(), dims)
