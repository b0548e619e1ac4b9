"""The variables of the largest motions of sensors on a structure in a sweep."""

from __future__ import annotations

from collections.abc import Iterable

from film_datasets.schema.variable import FLOAT, Variable
from film_model.base.foreign import Dataset
from film_model.base.units import si_unit
from film_model.solve.sensed import MOTION, STRAIN

FORCE_INTERVAL = ("contact_force_low", "contact_force_high")
"""Variables of a measured history that was identified from the motion of sensors."""


def peak_name(what: str, word: str) -> str:
    """The variable of the largest motion of one sensor: sensor_tip_maximum_velocity."""
    return f"sensor_{word}_maximum_{what}"


def peak_variables(words: Iterable[str], dims: tuple[str, ...], strained: bool) -> tuple[Variable, ...]:
    """The variables of the largest motions of sensors in a sweep. strained: with strains."""
    return tuple(
        Variable(
            *(peak_name(name, word), dims, FLOAT, si_unit(kind)),
            f"largest {name.replace('_', ' ')} of the sensor {word}",
            "absolute value; NaN if the vibrations of the target are not simulated",
            optional=True,
        )
        for word in words
        for name, (kind, _) in (MOTION | STRAIN if strained else MOTION).items()
    )


def peaks_in(ds: Dataset, dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """The variables of the largest motions that a sweep says it has."""
    words = str(ds.attrs.get("sensors", "")).split()
    return peak_variables(words, dims, any(peak_name("strain_x", word) in ds.variables for word in words))
