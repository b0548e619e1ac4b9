"""identify: nonlinear least squares of a scene's parameters, with confidence intervals from the Jacobian."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np

from film_datasets.identification.model import Array, Case, numerics_of
from film_datasets.identification.parameters import (
    Parameter,
    offset_name,
    parameters_of,
    scene_changes,
    unit_at,
    without_data_sheet,
)
from film_datasets.identification.profile import MARGIN, Profile
from film_datasets.identification.result import FittedParameter, Identification
from film_datasets.schema import MEASUREMENT, kind_of
from film_model.base.arrays import Mask
from film_model.base.errors import SceneError, SimulationError, shown
from film_model.base.foreign import Dataset
from film_model.scene import Scene, Solver

TRIED, SEARCHED = 16, 2
"""Points around the scene's values that are tried, and of which a search starts: a power of two, for Sobol's points."""

INTERVALS = ("curvature", "profile")

FAILED_RESIDUAL = 2.0
"""Residual, over the largest measured value, of a point for which the model has no value."""

SINGULAR = 1e-5
"""Directions in parameter space that change the model this much less than the strongest one are not determined by the
measurement."""

SHARE = 0.05
"""A parameter with at least this component along such a direction is not identified."""


def identify(
    measured: Dataset | Sequence[Dataset],
    scene: Scene,
    fit: Sequence[str],
    confidence: float = 0.99,
    *,
    each: Mapping[str, Sequence[str]] | None = None,
    intervals: str = "curvature",
) -> Identification:
    """Fit parameters of a scene to a measurement (`from_csv`), or to several at once, from the scene's own values.

    measured: histories, of which every quantity but the time is fitted, or impacts at several velocities. fit: paths
    of numbers such as "contact.yield_strength" or "impactor.velocity", and "time_offset", the time of first touch, one
    for each history. "contact.exponent" is fitted together with "contact.stiffness". each: entries of the scene that
    differ between the measurements, a value for each: {"impactor.velocity": ["1 m/s", "2 m/s"]}. A hardness that is
    fitted may contradict the yield strength of the material, which the fitted scene then lacks.

    Residuals are divided by the largest value of their quantity in all measurements, and the sum of their squares S is
    minimised; positive parameters are searched by their logarithm. The search starts from the scene's own values and
    from the best of `TRIED` others around them. intervals: "curvature", those of Student's t at the level `confidence`,
    from the Jacobian at the result, valid if the model is linear over the interval; or "profile", the values up to
    which S, with all other parameters fitted again, rises by the same factor 1 + t²/(n - k) for n points and k
    parameters, where the model need not be linear. Both hold if the noise is independent from point to point and
    equal in all points of a quantity. Some hundred impacts are simulated, for profiles some thousand; on a target that
    vibrates at an accuracy of 1e-4.

    Raises SceneError for parameters that cannot be fitted, SimulationError if the scene's own values give no impact,
    ValueError for other mistakes.

    >>> found = fd.identify(fd.from_csv("measured.csv"), scene, ["contact.yield_strength"])
    >>> print(f"{found.scene.contact.yield_strength / 1e6:.0f} MPa")
    123 MPa
    """
    datasets: list[Dataset] = list(measured) if isinstance(measured, list | tuple) else [cast("Any", measured)]
    if not datasets or any(kind_of(one) != MEASUREMENT for one in datasets):
        raise ValueError("a measurement is needed: see film_datasets.from_csv")
    if isinstance(confidence, bool) or not 0.5 <= confidence < 1.0:
        raise ValueError(f"confidence: {confidence!r} is not allowed: a number from 0.5 to below 1 is needed")
    if intervals not in INTERVALS:
        raise ValueError(f'intervals: {shown(intervals)} is not allowed: "curvature" or "profile" is needed')
    cases = _cases(datasets, each or {}, fit)
    changes = {**without_data_sheet(scene, fit), **cases[0].changes}
    own = scene.replace(changes) if changes else scene
    fitted = _Fit(own, cases, parameters_of(own, fit, datasets))
    return _identification(fitted, _search(fitted), confidence, intervals)


def _cases(datasets: Sequence[Dataset], each: Mapping[str, Sequence[str]], fit: Sequence[str]) -> list[Case]:
    """The measurements with the entries of the scene that are their own."""
    for path, values in each.items():
        if path in fit:
            raise ValueError(f"each: {path} is fitted")
        if isinstance(values, str) or len(values) != len(datasets):
            count = 1 if isinstance(values, str) else len(values)
            raise ValueError(f"each: {path} has {count} values for {len(datasets)} measurements")
    return [Case(ds, {path: values[k] for path, values in each.items()}) for k, ds in enumerate(datasets)]


class _Fit:
    """The residuals of measurements as a function of the scaled parameters z."""

    def __init__(self, scene: Scene, cases: list[Case], parameters: list[Parameter]) -> None:
        self.numerics = numerics_of(scene)
        self.scene, self.solver = replace(scene, solver=Solver(accuracy=self.numerics.accuracy)), scene.solver
        self.cases, self.parameters = cases, parameters
        self.names = list(dict.fromkeys(name for case in cases for name in case.names))
        self.largest = dict.fromkeys(self.names, 0.0)
        self.known = [{n: np.isfinite(case.measured[n].values) for n in case.names} for case in cases]
        for case, known in zip(cases, self.known, strict=True):
            for n in case.names:
                most = float(np.abs(case.measured[n].values[known[n]]).max(initial=0.0))
                self.largest[n] = max(self.largest[n], most)
        if not any(self.largest.values()):
            raise ValueError(f"{', '.join(self.names)}: zero throughout, there is nothing to fit")
        self.points = sum(int(one.sum()) for known in self.known for one in known.values())
        if self.points <= len(parameters):
            raise ValueError(f"{self.points} measured values are too few for {len(parameters)} parameters")
        self.bounds = (
            np.array([p.scaled(p.low) for p in parameters]),
            np.array([p.scaled(p.high) for p in parameters]),
        )

    def at(self, z: Array) -> tuple[Scene, list[Case]]:
        """The scene with these parameters, and the cases with their time offsets."""
        values = {p.path: p.si(float(x)) for p, x in zip(self.parameters, z, strict=True)}
        offsets = [values.pop(offset_name(k, len(self.cases)), 0.0) for k in range(len(self.cases))]
        scene = self.scene.replace(scene_changes(values, {p.path: p.unit for p in self.parameters}))
        return scene, [replace(case, time_offset=t) for case, t in zip(self.cases, offsets, strict=True)]

    def residuals(self, z: Array) -> Array:
        """Model minus measurement, over the largest measured value. Raises SimulationError if there is no impact."""
        scene, cases = self.at(z)
        found: list[Array] = []
        for case, known in zip(cases, self.known, strict=True):
            model = case.predict(scene)
            found += [(model[n] - case.measured[n].values)[known[n]] / (self.largest[n] or 1.0) for n in case.names]
        return np.concatenate(found)

    def rms(self, residuals: Array) -> dict[str, float]:
        """Root mean square of the residuals of each quantity, SI."""
        sizes = [(name, int(known[name].sum())) for known in self.known for name in known]
        parts = np.split(residuals, np.cumsum([size for _, size in sizes])[:-1])
        own = {n: np.concatenate([v for (m, _), v in zip(sizes, parts, strict=True) if m == n]) for n in self.names}
        return {n: float(np.sqrt(np.mean(own[n] ** 2))) * (self.largest[n] or 1.0) for n in self.names}

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
            step[k] = self.numerics.step
            columns.append((self.finite_residuals(z + step) - self.finite_residuals(z - step)) / (2.0 * step[k]))
        return np.stack(columns, axis=1)


def _search(fit: _Fit) -> Array:
    """The scaled parameters with the least sum of squares."""
    from scipy.optimize import least_squares  # lazy: importing scipy.optimize takes 1 s

    if not np.isfinite(fit.residuals(np.zeros(len(fit.parameters)))).all():
        raise SimulationError(
            "with the values of the scene an impact of the measurement fails: start from better values"
        )
    jacobian: Any = fit.jacobian  # SciPy's annotation allows the name of a difference scheme only
    ends: Any = {"xtol": fit.numerics.parameters, "ftol": fit.numerics.squares, "gtol": 1e-12}
    results: list[Any] = [least_squares(fit.finite_residuals, z, jacobian, fit.bounds, **ends) for z in _starts(fit)]
    return min(results, key=lambda result: result.cost).x


def _starts(fit: _Fit) -> list[Array]:
    """The scene's own values, and the `SEARCHED` best of points that cover the surroundings evenly."""
    from scipy.stats import qmc  # lazy: importing scipy.stats takes 1 s

    low, high = fit.bounds[0] + MARGIN, fit.bounds[1] - MARGIN
    # the largest factor on positive parameters that is tried; others change by their scale
    width = np.array([math.log(16.0) if p.log else 1.0 for p in fit.parameters])
    points = qmc.Sobol(len(width), rng=1).random(TRIED)
    around = [np.clip(width * (2.0 * point - 1.0), low, high) for point in points]
    around.sort(key=lambda z: float(np.sum(fit.finite_residuals(z) ** 2)))
    return [*(np.clip(z, low, high) for z in _scene_values(fit)), *around[:SEARCHED]]


def _scene_values(fit: _Fit) -> list[Array]:
    """The scene's own values; also with time offsets at which the peaks of model and measurement coincide: while the
    pulses do not overlap, the sum of squares does not depend on the offset."""
    own = np.zeros(len(fit.parameters))
    paths = [p.path for p in fit.parameters]
    aligned = own.copy()
    for k, case in enumerate(fit.cases):
        if (name := offset_name(k, len(fit.cases))) in paths:
            t, quantity = case.measured["t"].values, case.names[0]
            model = np.abs(case.predict(fit.scene, t - t[0])[quantity])
            late = t[np.nanargmax(np.abs(case.measured[quantity].values))] - (t - t[0])[np.argmax(model)]
            aligned[paths.index(name)] = fit.parameters[paths.index(name)].scaled(float(late))
    return [own, aligned] if aligned.any() else [own]


class _Sensitivity(NamedTuple):
    """The Jacobian at the result and what follows from it.

    undetermined: directions, one per row, along which the model hardly changes. lost: which parameters have a component
    along one of them. errors: standard errors of the scaled parameters, infinite for those that are lost.
    """

    jacobian: Array
    errors: Array
    lost: Mask
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


def _identification(fit: _Fit, z: Array, confidence: float, intervals: str) -> Identification:
    """The parameters z with their intervals, and the residuals of each quantity."""
    from scipy.stats import t as student  # lazy: importing scipy.stats takes 1 s

    residuals = fit.finite_residuals(z)
    sensitivity = _sensitivity(fit, z, residuals)
    quantile = float(student.ppf(0.5 + 0.5 * confidence, fit.points - z.size))
    rise = 1.0 + quantile**2 / (fit.points - z.size)
    scene, cases = fit.at(z)
    parameters: list[FittedParameter] = []
    for k, p in enumerate(fit.parameters):
        value, error = float(z[k]), float(sensitivity.errors[k])
        reason = _reason(fit, k, z, sensitivity)
        if intervals == "profile" and not sensitivity.lost[k]:
            profile = Profile(fit.finite_residuals, fit.jacobian, fit.bounds, z, k)
            low, high = map(p.si, profile.interval(rise, quantile * error))
        # from 50 on, exp of a scaled parameter might overflow
        elif error < 50.0:
            low, high = p.si(value - quantile * error), p.si(value + quantile * error)
        else:
            low, high = 0.0 if p.log else -math.inf, math.inf
        width = abs(p.si(value)) if p.log else p.scale
        unit = unit_at(scene, p)
        parameters.append(
            FittedParameter(p.path, p.dimension, unit, p.si(value), error * width, low, high, not reason, reason)
        )
    rms = fit.rms(residuals)
    scene = replace(scene, solver=fit.solver)
    return Identification(scene, tuple(parameters), confidence, fit.points, rms, fit.largest, tuple(cases), intervals)


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
    if min(z[k] - low[k], high[k] - z[k]) < 1e-6:
        return "the best value is at the end of its range"
    if sensitivity.errors[k] > 0.5:
        return f"its standard error is {100 * sensitivity.errors[k]:.0f} % of it"
    return ""
