"""The variables of a target's sensors, which every FMU has of its own."""

from __future__ import annotations

from collections.abc import Iterable

from film_model.solve.sensed import MOTION
from film_model.targets.sensors import sensor_words
from fmu_wrapper.variables import Kind, Real, Variable


def of_sensors(names: Iterable[str]) -> tuple[Variable, ...]:
    """Their motion: sensor_tip_displacement, …; the value references follow those of `VARIABLES`."""
    output: dict[Kind, str] = {"impact": "output"}
    return tuple(
        Variable(
            *(f"sensor_{word}_{what}", Real, of, output, "continuous", f"{what} of the sensor {word}"),
            depends={"impact": ("support_velocity",) if what == "velocity" else ()},
        )
        for word in sensor_words(names)
        for what, (of, _) in MOTION.items()
    )
