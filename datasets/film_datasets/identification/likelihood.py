"""log_likelihood: how probable a measurement is for a scene, for Bayesian calibration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from film_datasets.identification.model import DIMENSIONS_OF_QUANTITIES, Case, numerics_of
from film_datasets.schema import MEASUREMENT, kind_of
from film_model.base.errors import SimulationError
from film_model.base.foreign import Dataset
from film_model.base.units import to_si
from film_model.scene import Scene, Solver


def log_likelihood(
    measured: Dataset, scene: Scene, standard_deviation: Mapping[str, object], time_offset: object = "0 s"
) -> float:
    """ln p of a measurement (`from_csv`) given a scene: −½ Σ ((y − f)/σ)² + ln(2π σ²), for independent Gaussian errors.

    y: what was measured, without empty cells. f: the scene's value, simulated as in `identify`. standard_deviation: σ
    of every measured quantity by its name, with unit: of the measurement, and of the model if it is known. time_offset:
    time of first touch of a measured history. −inf if the scene has no impact or no such value.

    A sampler such as emcee takes `lambda p: fd.log_likelihood(measured, at(p), {"contact_force": "2 N"})` and the
    logarithm of the prior, with `at(p) = scene.replace({"contact.yield_strength": f"{p[0]} GPa"})`, which raises
    SceneError outside the range of a value.

    Raises ValueError for a dataset that is no measurement of a history or of impacts, and for a σ that is missing, of
    another dimension or not above 0.

    >>> measured = fd.from_csv("measured.csv")
    >>> print(f"{fd.log_likelihood(measured, scene, {'coefficient_of_restitution': 0.1}):.2f}")
    -5.80
    """
    if kind_of(measured) != MEASUREMENT or measured.attrs["measured"] not in ("history", "impacts"):
        raise ValueError("measured: a measured history or measured impacts (film_datasets.from_csv) are needed")
    case = Case(measured, {}, to_si(time_offset, "time"))
    if unequal := set(case.names) ^ set(standard_deviation):
        raise ValueError(f"standard_deviation: {', '.join(sorted(unequal))}: one for each of {', '.join(case.names)}")
    sigma = {name: to_si(value, DIMENSIONS_OF_QUANTITIES[name]) for name, value in standard_deviation.items()}
    for name, value in sigma.items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"standard_deviation: {name} is {standard_deviation[name]}, which must be above 0")
    try:
        found = case.predict(replace(scene, solver=Solver(accuracy=numerics_of(scene).accuracy)))
    except SimulationError:
        return -math.inf
    total = 0.0
    for name in case.names:
        values = measured[name].values
        known = ~np.isnan(values)
        residuals = (values - found[name])[known] / sigma[name]
        total -= 0.5 * float(np.sum(residuals**2)) + known.sum() * math.log(math.sqrt(2.0 * math.pi) * sigma[name])
    return float(total) if math.isfinite(total) else -math.inf
