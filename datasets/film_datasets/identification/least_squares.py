"""identify: nonlinear least squares of a scene's parameters, with confidence intervals from the Jacobian."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_datasets.csv_measurement import measured_over
from film_datasets.identification.model import Array, numerics_of, predict
from film_datasets.identification.parameters import Parameter, parameters_of
from film_datasets.identification.result import TIME_OFFSET, FittedParameter, Identification
from film_datasets.schema import MEASUREMENT, kind_of
from film_model.base.errors import SceneError, SimulationError
from film_model.base.units import power_stiffness_unit
from film_model.effects.choose import problem_of
from film_model.scene import Scene, Solver
from film_model.scene.paths import EXPONENT, number_text

STARTS = (1.0, 0.6, 1.6)
"""Factors on the positive parameters of the scene from which the search starts; the best result is taken."""

GTOL = 1e-12
"""Gradient of the sum of squares at which the search ends."""

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
    interval. Some hundred impacts are simulated; on a target that vibrates at an accuracy of 1e-4.

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
        self.numerics = numerics_of(scene)
        self.scene, self.solver = replace(scene, solver=Solver(accuracy=self.numerics.accuracy)), scene.solver
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
        self.directions = self._directions()

    def _directions(self) -> Array:
        """Directions of the search in the scaled parameters, one per column.

        These themselves; but an exponent q changes together with the stiffness, so that ln k + q ln δ is constant at
        the law's depth δ. Otherwise the sum of squares has a narrow valley, in which the search stops early.
        """
        found, at = np.eye(len(self.parameters)), {p.path: k for k, p in enumerate(self.parameters)}
        for k, p in enumerate(self.parameters):
            if p.dimension == "meyer_stiffness" and EXPONENT in at:
                q = at[EXPONENT]
                found[k, q] = -math.log(problem_of(self.scene).scales.length) * self.parameters[q].scale
                for bound, end in zip(self.bounds, (-math.inf, math.inf), strict=True):
                    bound[k] = end
        return found

    def scene_at(self, z: Array) -> tuple[Scene, float]:
        """The scene with these parameters, and the time offset."""
        values = {p.path: p.si(float(x)) for p, x in zip(self.parameters, z, strict=True)}
        offset = values.pop(TIME_OFFSET, 0.0)
        changes = {
            p.path: number_text(values[p.path], self.unit(p, values)) for p in self.parameters if p.path in values
        }
        return self.scene.replace(changes), offset

    def unit(self, parameter: Parameter, values: Mapping[str, float]) -> str:
        """The unit of a parameter; that of a stiffness with the exponent among the values, if this is fitted too."""
        if parameter.dimension == "meyer_stiffness" and EXPONENT in values:
            return power_stiffness_unit(values[EXPONENT])
        return parameter.unit

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
        """Derivatives along the directions, by central differences."""
        columns: list[Array] = []
        for direction in self.directions.T:
            step = self.numerics.step * direction
            difference = self.finite_residuals(z + step) - self.finite_residuals(z - step)
            columns.append(difference / (2.0 * self.numerics.step))
        return np.stack(columns, axis=1)


def _search(fit: _Fit) -> Array:
    """The scaled parameters with the least sum of squares."""
    from scipy.optimize import least_squares  # lazy: importing scipy.optimize takes 1 s

    if not np.isfinite(fit.residuals(np.zeros(len(fit.parameters)))).all():
        raise SimulationError(
            "with the values of the scene an impact of the measurement fails: start from better values"
        )
    low, high = fit.bounds
    turned = fit.directions
    jacobian: Any = lambda y: fit.jacobian(turned @ y)  # noqa: E731, SciPy's annotation allows a name only
    results: list[Any] = []
    for factor in STARTS:
        y = np.array([math.log(factor) if p.log else 0.0 for p in fit.parameters])
        y = np.clip(y, low + MARGIN, high - MARGIN)
        ends: Any = {"xtol": fit.numerics.parameters, "ftol": fit.numerics.squares, "gtol": GTOL}
        results.append(least_squares(lambda y: fit.finite_residuals(turned @ y), y, jacobian, fit.bounds, **ends))
        if all(not p.log for p in fit.parameters):
            break
    return turned @ min(results, key=lambda result: result.cost).x


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
    jacobian = fit.jacobian(z) @ np.linalg.inv(fit.directions)
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
    values = {p.path: p.si(float(x)) for p, x in zip(fit.parameters, z, strict=True)}
    for k, p in enumerate(fit.parameters):
        value, error = float(z[k]), float(sensitivity.errors[k])
        reason = _reason(fit, k, z, sensitivity)
        if error < INFINITE_ERROR:
            low, high = p.si(value - quantile * error), p.si(value + quantile * error)
        else:
            low, high = 0.0 if p.log else -math.inf, math.inf
        width = abs(p.si(value)) if p.log else p.scale
        parameters.append(
            FittedParameter(
                p.path, p.dimension, fit.unit(p, values), p.si(value), error * width, low, high, not reason, reason
            )
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
