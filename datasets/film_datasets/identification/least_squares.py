"""identify: nonlinear least squares of a scene's parameters, with confidence intervals from the Jacobian."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_datasets.csv_measurement import measured_over
from film_datasets.identification.model import ACCURACY, Array, predict
from film_datasets.identification.parameters import Parameter, parameters_of
from film_datasets.identification.result import TIME_OFFSET, FittedParameter, Identification
from film_datasets.schema import MEASUREMENT, kind_of
from film_model.base.errors import SceneError, SimulationError
from film_model.scene import Scene, Solver
from film_model.scene.paths import number_text

if TYPE_CHECKING:
    import xarray as xr

STEP = 1e-4
"""Step of the central differences for the Jacobian, in the scaled parameters."""

STARTS = (1.0, 0.6, 1.6)
"""Factors on the positive parameters of the scene from which the search starts; the best result is taken."""

XTOL, FTOL, GTOL = 1e-10, 1e-12, 1e-12
"""At which the search ends: of the scaled parameters, the sum of squares and its gradient."""

MARGIN = 1e-9
"""Distance of a start from the bounds, in the scaled parameters."""

FAILED_RESIDUAL = 2.0
"""Residual, over the largest measured value, of a point for which the model has no value."""

WIDEST = 0.5
"""A parameter whose standard error is a larger fraction of it is not identified."""

SINGULAR = 1e-5
"""Directions in parameter space that change the model this much less than the strongest one are not determined by the
measurement."""

SHARE = 0.05
"""A parameter with at least this component along such a direction is not identified."""

NEAR_BOUND = 1e-6
"""A fitted parameter this close to a bound, in the scaled parameters, is not identified."""

INFINITE_ERROR = 50.0
"""Standard error of a scaled parameter from which its interval is infinite: exp of it might overflow."""


def identify(measured: xr.Dataset, scene: Scene, fit: Sequence[str], confidence: float = 0.99) -> Identification:
    """Fit parameters of a scene to a measurement (`from_csv`), starting from the scene's own values.

    measured: a history, of which every quantity but the time is fitted, or impacts at several velocities. fit: paths
    of numbers such as "contact.yield_strength" or "impactor.velocity", and "time_offset", the time of first touch.
    Residuals are divided by the largest value of their quantity, and the sum of their squares is minimised; positive
    parameters are searched by their logarithm. Intervals are those of Student's t at the level `confidence`, from the
    Jacobian at the result: valid if the noise is independent from point to point and the model is linear over the
    interval. Some hundred impacts are simulated, each of which takes seconds if the target vibrates between its edges.

    Raises SceneError for parameters that cannot be fitted, SimulationError if the scene's own values give no impact,
    ValueError for other mistakes.

    >>> found = fd.identify(fd.from_csv("measured.csv"), scene, ["contact.yield_strength"])
    >>> found.scene.contact.yield_strength > 200e6
    True
    """
    if kind_of(measured) != MEASUREMENT:
        raise ValueError("a measurement is needed: see film_datasets.from_csv")
    if isinstance(confidence, bool) or not 0.5 <= confidence < 1.0:
        raise ValueError(f"confidence: {confidence!r} is not allowed: a number from 0.5 to below 1 is needed")
    fitted = _Fit(scene, measured, parameters_of(scene, fit, measured))
    return _identification(fitted, _search(fitted), confidence)


class _Fit:
    """The residuals of a measurement as a function of the scaled parameters z."""

    def __init__(self, scene: Scene, measured: xr.Dataset, parameters: list[Parameter]) -> None:
        self.scene, self.solver = replace(scene, solver=Solver(accuracy=ACCURACY)), scene.solver
        self.measured, self.parameters = measured, parameters
        _, self.names = measured_over(measured)
        self.known = {name: np.isfinite(measured[name].values) for name in self.names}
        largest = {n: float(np.abs(measured[n].values[self.known[n]]).max(initial=0.0)) for n in self.names}
        if not any(largest.values()):
            raise ValueError(f"{', '.join(self.names)}: zero throughout, there is nothing to fit")
        self.size = {name: value or 1.0 for name, value in largest.items()}
        self.points = sum(int(known.sum()) for known in self.known.values())
        if self.points <= len(parameters):
            raise ValueError(f"{self.points} measured values are too few for {len(parameters)} parameters")
        self.bounds = (
            np.array([p.scaled(p.low) for p in parameters]),
            np.array([p.scaled(p.high) for p in parameters]),
        )

    def scene_at(self, z: Array) -> tuple[Scene, float]:
        """The scene with these parameters, and the time offset."""
        values = {p.path: p.si(float(x)) for p, x in zip(self.parameters, z, strict=True)}
        offset = values.pop(TIME_OFFSET, 0.0)
        units = {p.path: p.unit for p in self.parameters}
        return self.scene.replace({path: number_text(value, units[path]) for path, value in values.items()}), offset

    def residuals(self, z: Array) -> Array:
        """Model minus measurement, over the largest measured value. Raises SimulationError if there is no impact."""
        scene, offset = self.scene_at(z)
        model = predict(scene, self.measured, self.names, offset)
        differences = [(model[n] - self.measured[n].values)[self.known[n]] / self.size[n] for n in self.names]
        return np.concatenate(differences)

    def finite_residuals(self, z: Array) -> Array:
        """As `residuals`, with `FAILED_RESIDUAL` where the model has no value."""
        try:
            found = self.residuals(z)
        except (SimulationError, SceneError):
            return np.full(self.points, FAILED_RESIDUAL)
        return np.where(np.isfinite(found), found, FAILED_RESIDUAL)

    def jacobian(self, z: Array) -> Array:
        """By central differences."""
        columns: list[Array] = []
        for k in range(z.size):
            step = np.zeros(z.size)
            step[k] = STEP
            columns.append((self.finite_residuals(z + step) - self.finite_residuals(z - step)) / (2.0 * STEP))
        return np.stack(columns, axis=1)


def _search(fit: _Fit) -> Array:
    """The scaled parameters with the least sum of squares."""
    from scipy.optimize import least_squares  # lazy: importing scipy.optimize takes 1 s

    if not np.isfinite(fit.residuals(np.zeros(len(fit.parameters)))).all():
        raise SimulationError(
            "with the values of the scene an impact of the measurement fails: start from better values"
        )
    low, high = fit.bounds
    jacobian: Any = fit.jacobian  # SciPy's annotation allows the name of a difference scheme only
    results: list[Any] = []
    for factor in STARTS:
        z = np.array([math.log(factor) if p.log else 0.0 for p in fit.parameters])
        z = np.clip(z, low + MARGIN, high - MARGIN)
        results.append(least_squares(fit.finite_residuals, z, jacobian, fit.bounds, xtol=XTOL, ftol=FTOL, gtol=GTOL))
        if all(not p.log for p in fit.parameters):
            break
    return min(results, key=lambda result: result.cost).x


class _Sensitivity(NamedTuple):
    """The Jacobian at the result and what follows from it.

    undetermined: directions, one per row, along which the model hardly changes. lost: which parameters have a component
    along one of them. errors: standard errors of the scaled parameters, infinite for those that are lost.
    """

    jacobian: Array
    errors: Array
    lost: NDArray[np.bool_]
    undetermined: Array


def _sensitivity(fit: _Fit, z: Array, residuals: Array) -> _Sensitivity:
    jacobian = fit.jacobian(z)
    noise = math.sqrt(float(residuals @ residuals) / (fit.points - z.size))
    _, strengths, directions = np.linalg.svd(jacobian, full_matrices=False)
    weak = strengths <= SINGULAR * max(float(strengths[0]), 1e-300)
    inverse = np.where(weak, 0.0, 1.0 / np.where(weak, 1.0, strengths))
    errors = noise * np.sqrt(((directions * inverse[:, None]) ** 2).sum(axis=0))
    lost = np.asarray((np.abs(directions[weak]) > SHARE).any(axis=0))
    return _Sensitivity(jacobian, np.where(lost, math.inf, errors), lost, directions[weak])


def _identification(fit: _Fit, z: Array, confidence: float) -> Identification:
    """The parameters z with their intervals, and the residuals of each quantity."""
    from scipy.stats import t as student  # lazy: importing scipy.stats takes 1 s

    residuals = fit.finite_residuals(z)
    sensitivity = _sensitivity(fit, z, residuals)
    quantile = float(student.ppf(0.5 + 0.5 * confidence, fit.points - z.size))
    parameters: list[FittedParameter] = []
    for k, p in enumerate(fit.parameters):
        value, error = float(z[k]), float(sensitivity.errors[k])
        reason = _reason(fit, k, z, sensitivity)
        if error < INFINITE_ERROR:
            low, high = p.si(value - quantile * error), p.si(value + quantile * error)
        else:
            low, high = 0.0 if p.log else -math.inf, math.inf
        width = abs(p.si(value)) if p.log else p.scale
        parameters.append(
            FittedParameter(p.path, p.dimension, p.unit, p.si(value), error * width, low, high, not reason, reason)
        )
    splits = np.cumsum([int(fit.known[name].sum()) for name in fit.names])[:-1]
    each = zip(fit.names, np.split(residuals, splits), strict=True)
    rms = {name: float(np.sqrt(np.mean(values**2))) * fit.size[name] for name, values in each}
    scene = replace(fit.scene_at(z)[0], solver=fit.solver)
    return Identification(scene, tuple(parameters), confidence, fit.points, rms, fit.measured)


def _reason(fit: _Fit, k: int, z: Array, sensitivity: _Sensitivity) -> str:
    """Why parameter k is not identified; empty if it is."""
    norms = np.sqrt((sensitivity.jacobian**2).sum(axis=0))
    if norms[k] <= SINGULAR * max(float(norms.max()), SINGULAR):
        return "the measurement does not depend on it"
    if sensitivity.lost[k]:
        shares = np.abs(sensitivity.undetermined).max(axis=0)
        others = [p.path for j, p in enumerate(fit.parameters) if j != k and shares[j] > SHARE]
        return f"only together with {' and '.join(others)}: a change of one can be compensated by the other"
    low, high = fit.bounds
    if min(z[k] - low[k], high[k] - z[k]) < NEAR_BOUND:
        return "the best value is at the end of its range"
    if sensitivity.errors[k] > WIDEST:
        return f"its standard error is {100 * sensitivity.errors[k]:.0f} % of it"
    return ""
