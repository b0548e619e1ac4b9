"""What a scene predicts for the measured quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from film_datasets.csv_measurement import measured_over
from film_datasets.impacts import results_of
from film_datasets.schema import MEASURED_CONDITIONS, MEASURED_MOTION
from film_model.base.arrays import Array
from film_model.base.foreign import Dataset
from film_model.effects.choose import problem_of
from film_model.scene import Scene
from film_model.solve.derivatives import RESULTS
from film_model.solve.history import Samples
from film_model.solve.simulate import simulate_quietly


class Numerics(NamedTuple):
    """Accuracy of the impacts that are compared with the measurement; step of the central differences for the Jacobian,
    in the scaled parameters; and where the search ends: relative changes of parameters and of the sum of squares.

    The error of an impact changes with the parameters and disturbs the differences: it must be small beside the step.
    """

    accuracy: float
    step: float
    parameters: float
    squares: float


NUMERICS = Numerics(1e-7, 1e-4, 1e-10, 1e-12)

ON_MODES = Numerics(1e-4, 1e-2, 1e-5, 1e-7)
"""For a target that vibrates, where 1e-7 takes up to a second an impact. Derivatives are then known to about 1 %, which
is enough for steps of the search and for intervals; the result is that of the impacts themselves."""

DIMENSIONS_OF_QUANTITIES = {
    name: dimension for table in (MEASURED_MOTION, RESULTS) for name, (dimension, _) in table.items()
}
"""Dimension of every quantity that can be measured."""


def numerics_of(scene: Scene) -> Numerics:
    """How precisely the impacts of a scene are simulated for a fit."""
    return ON_MODES if problem_of(scene).vibrates else NUMERICS


@dataclass(frozen=True)
class Case:
    """A measurement with the entries of the scene that are its own, and its time of first touch, s."""

    measured: Dataset
    changes: Mapping[str, str]
    time_offset: float = 0.0

    @property
    def names(self) -> list[str]:
        """The measured quantities."""
        return measured_over(self.measured)[1]

    def predict(self, scene: Scene, points: Array | None = None) -> dict[str, Array]:
        """The measured quantities of this scene with the case's own entries; see `predict`."""
        own = scene.replace(dict(self.changes)) if self.changes else scene
        return predict(own, self.measured, self.names, self.time_offset, points)


def predict(
    scene: Scene, measured: Dataset, names: Sequence[str], time_offset: float, points: Array | None = None
) -> dict[str, Array]:
    """The quantities `names` at the measured times, velocities or angles, or at other `points`, SI.

    time_offset: time of the measurement's first touch, s. Raises SimulationError if there is no impact.
    """
    along, _ = measured_over(measured)
    if along != "t":
        return results_of(scene, _conditions(measured, along, points), names)
    points = np.asarray(measured[along].values if points is None else points)
    t = points - time_offset
    samples = simulate_quietly(scene).sample_si(np.maximum(t, 0.0))
    return {name: _before_first_touch(_motion(samples, scene, name), t, scene, name) for name in names}


def _conditions(measured: Dataset, along: str, points: Array | None) -> dict[str, Array]:
    """Key of the scene → values of the impacts; between measured points the other conditions are interpolated."""
    order = np.argsort(measured[along].values, kind="stable")
    ends = measured[along].values[order]
    found = {name: measured[name].values for name in MEASURED_CONDITIONS if name in measured.variables}
    return {
        name.replace("_", ".", 1): values if points is None else np.interp(points, ends, values[order])
        for name, values in found.items()
    }


def _motion(samples: Samples, scene: Scene, name: str) -> Array:
    if name == "impactor_acceleration":
        return -samples.contact_force / scene.mass
    return getattr(samples, name)


def _before_first_touch(values: Array, t: Array, scene: Scene, name: str) -> Array:
    """The values, and for t < 0 those of bodies that move at constant velocity without a contact force."""
    if name.endswith("displacement") or name == "indentation":
        speed = {"indentation": scene.approach_velocity, "impactor_displacement": scene.impactor.speed}.get(name, 0.0)
        return np.where(t < 0.0, speed * t, values)
    return values
