"""The variables of sensors on a structure: their motion in a history, their largest motions there and in a sweep."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

from film_datasets.schema.motion_variables import number, spaced
from film_datasets.schema.variable import TEXT, Variable, flag_words
from film_model.solve.sensed import MOTION, STRAIN

if TYPE_CHECKING:
    import xarray as xr

SENSOR = Variable("sensor", ("sensor",), TEXT, None, "name of the sensor")


def _in_histories(quantities: dict[str, tuple[str, str]]) -> tuple[Variable, ...]:
    """The variables of quantities over time, and of their largest values."""
    over_time = (
        number(f"sensor_{name}", ("sensor", "t"), kind, f"{spaced(name)} of the sensor", what, optional=True)
        for name, (kind, what) in quantities.items()
    )
    largest = (
        number(
            f"sensor_maximum_{name}", ("sensor",), kind, f"largest {spaced(name)} of the sensor", "absolute value", True
        )
        for name, (kind, _) in quantities.items()
    )
    return (*over_time, *largest)


SENSED, STRAINED = (SENSOR, *_in_histories(MOTION)), _in_histories(STRAIN)
"""Variables of a history with sensors, and those of sensors with strain."""

FORCE_INTERVAL = ("contact_force_low", "contact_force_high")

IDENTIFIED = tuple(
    number(name, ("t",), "force", f"{word} end of the interval of the contact force", "if it was identified", True)
    for name, word in zip(FORCE_INTERVAL, ("lower", "upper"), strict=True)
)
"""Variables of a measured history that was identified from the motion of sensors."""


def sensor_words(names: Iterable[str]) -> tuple[str, ...]:
    """Names of sensors as parts of names of variables: letters, digits and _."""
    return flag_words([re.sub(r"\W", "_", name, flags=re.ASCII) for name in names])


def peak_name(what: str, word: str) -> str:
    """The variable of the largest motion of one sensor: sensor_tip_maximum_velocity."""
    return f"sensor_{word}_maximum_{what}"


def peak_variables(words: Iterable[str], dims: tuple[str, ...], strained: bool) -> tuple[Variable, ...]:
    """The variables of the largest motions of sensors in a sweep. strained: with strains."""
    return tuple(
        number(
            *(peak_name(name, word), dims, kind, f"largest {spaced(name)} of the sensor {word}"),
            "absolute value; NaN if the vibrations of the target are not simulated",
            optional=True,
        )
        for word in words
        for name, (kind, _) in (MOTION | STRAIN if strained else MOTION).items()
    )


def peaks_in(ds: xr.Dataset, dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """The variables of the largest motions that a sweep says it has."""
    words = str(ds.attrs.get("sensors", "")).split()
    return peak_variables(words, dims, any(peak_name("strain_x", word) in ds.variables for word in words))
