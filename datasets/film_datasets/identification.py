"""Parameters of a scene from a measurement: least squares, with intervals, and what cannot be told."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_datasets.design import field_at, unit_of
from film_datasets.schema import MEASUREMENT, kind_of
from film_model.batch import simulate_rows
from film_model.errors import Mistake, SceneError, SimulationError, raise_all
from film_model.fields import Field
from film_model.history import MOTION, SUMMARY, History
from film_model.plot import COLOURS, picture, prefixed_unit
from film_model.scene import Scene, Solver
from film_model.solve import simulate
from film_model.units import DIMENSIONS, format_si, scene_unit, si_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

TIME_OFFSET = "time_offset"
"""A parameter that is not the scene's: time of the measurement's first touch, s."""

ACCURACY = 1e-7
"""Of the impacts that are compared with the measurement: the differences of the fit must not see the segments."""

STEP = 1e-4
"""Step of a parameter, relative or of its scale, of the central differences for the Jacobian."""

STARTS = (1.0, 0.6, 1.6)
"""Factors on the positive parameters of the scene from which the search begins; the best end counts."""

WIDEST = 0.5
"""A parameter whose standard error is a larger part of it than this is not identified."""

SINGULAR = 1e-5
"""Directions that change the model this much less than the strongest one does are not seen in the data."""

SHARE = 0.05
"""Share of such a direction from which a parameter is part of it."""


@dataclass(frozen=True)
class Fitted:
    """One parameter, SI, in `unit`. low, high: the interval. identified: whether the data tell it; reason: why not."""

    path: str
    dimension: str
    unit: str
    value: float
    standard_error: float
    low: float
    high: float
    identified: bool
    reason: str

    def text(self, value: float) -> str:
        """A value of the parameter with its unit."""
        if not math.isfinite(value):
            return "?"
        return format_si(value, self.dimension, 5) if self.dimension in DIMENSIONS else f"{value:.5g} {self.unit}"

    def to_json(self) -> dict[str, Any]:
        """Plain values; None for what is not known."""
        numbers = {name: getattr(self, name) for name in ("value", "standard_error", "low", "high")}
        plain = {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        units = si_unit(self.dimension) if self.dimension in DIMENSIONS else self.unit
        return {**plain, "units": units, "identified": self.identified, "reason": self.reason}


@dataclass(frozen=True)
class Identification:
    """A scene fitted to a measurement.

    scene: with the fitted values. parameters: with intervals at the level `confidence`. residual: root mean square of
    the differences between measurement and model, by quantity, SI. measured: what was fitted.
    """

    scene: Scene
    parameters: tuple[Fitted, ...]
    confidence: float
    points: int
    residual: Mapping[str, float]
    measured: xr.Dataset = field(repr=False)

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each parameter that is not identified."""
        return tuple(f"{one.path} cannot be identified: {one.reason}" for one in self.parameters if not one.identified)

    def history(self) -> History:
        """The fitted impact."""
        return simulate(self.scene, accuracy=ACCURACY)

    def to_json(self) -> dict[str, Any]:
        """Plain values, SI."""
        units = {**{n: d for n, (d, _) in MOTION.items()}, **{n: d for n, (d, _) in SUMMARY.items()}}
        return {
            "parameters": {one.path: one.to_json() for one in self.parameters},
            "confidence": self.confidence,
            "points": self.points,
            "residual": {n: {"value": v, "units": si_unit(units[n])} for n, v in self.residual.items()},
            "warnings": list(self.warnings),
        }

    def table(self) -> str:
        """The parameters as text."""
        lines = [f"{self.points} points; intervals at {100 * self.confidence:g} %", ""]
        for one in self.parameters:
            value, low, high = map(one.text, (one.value, one.low, one.high))
            said = f"{low} to {high}" if one.identified else "not identified"
            lines.append(f"  {one.path:32}{value:>14}   {said}")
        lines += ["", "  root mean square of measurement less fit:"]
        for name, value in self.residual.items():
            largest = float(np.nanmax(np.abs(self.measured[name].values), initial=0.0))
            share = f"{100 * value / largest:.2g} % of the largest" if largest else ""
            lines.append(f"  {name.replace('_', ' '):32}{format_si(value, _dimension(name), 3):>14}   {share}".rstrip())
        return "\n".join(lines)

    def plot(self, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
        """Measurement and fitted model, and below the differences; a panel for every measured quantity."""
        return picture(path, self._draw, (7.2, 5.2), dpi)

    def _draw(self, figure: Figure) -> None:
        names = list(self.residual)
        along = "t" if self.measured.attrs["measured"] == "history" else "impactor_velocity"
        offset = next((one.value for one in self.parameters if one.path == TIME_OFFSET), 0.0)
        x = self.measured[along].values
        fine = np.linspace(x.min(), x.max(), 501)
        model, at_points = (_model(self.scene, self.measured, names, offset, places) for places in (fine, x))
        x_size, x_unit = prefixed_unit(x, "time" if along == "t" else "velocity")
        grid = figure.subplots(
            2,
            len(names),
            sharex=True,
            squeeze=False,
            gridspec_kw={"height_ratios": (3, 1), "hspace": 0.08, "wspace": 0.35},
        )
        for column, name in enumerate(names):
            values = self.measured[name].values
            size, unit = prefixed_unit(values[np.isfinite(values)], _dimension(name))
            above, below = grid[:, column]
            above.plot(x / x_size, values / size, "o", color="0.45", markersize=2.5, label="measured")
            above.plot(fine / x_size, model[name] / size, color=COLOURS[2], label="fitted")
            below.plot(x / x_size, (values - at_points[name]) / size, "o", color="0.45", markersize=2.0)
            below.axhline(0.0, color=COLOURS[2], linewidth=0.8)
            label = name.replace("_", " ")
            above.set_ylabel(f"{label} ({unit})" if unit else label)
            below.set(xlabel=f"{'time' if along == 't' else 'velocity'} ({x_unit})", ylabel="difference")
        grid[0, 0].legend(frameon=False, fontsize=8)
        texts = []
        for one in self.parameters:
            text = f"{one.path} {one.text(one.value)}"
            texts.append(text if one.identified else f"{text} (not identified)")
        figure.suptitle("\n".join(texts).replace("$", r"\$"), fontsize=9)


def identify(measured: xr.Dataset, scene: Scene, fit: Sequence[str], confidence: float = 0.99) -> Identification:
    """Fit parameters of a scene to a measurement (`from_csv`), beginning at the scene's own values.

    measured: a history, of which every quantity but the time is fitted, or impacts at several velocities. fit: paths
    of numbers such as "contact.yield_strength" or "impactor.velocity", and "time_offset", when first touch was.
    The differences are divided by each quantity's largest value and their squares summed; positive parameters are
    searched by their logarithm. Intervals are of Student's t at the level `confidence`, from the Jacobian at the end:
    right where the noise is independent from point to point and the model is linear over the interval. Some hundred
    impacts are simulated, each of which takes seconds where the target vibrates between its edges.

    Raises SceneError for parameters that cannot be fitted, SimulationError where the scene's own values make no
    impact, ValueError for other mistakes.
    """
    if kind_of(measured) != MEASUREMENT:
        raise ValueError("a measurement is needed: see film_datasets.from_csv")
    if isinstance(confidence, bool) or not 0.5 <= confidence < 1.0:
        raise ValueError(f"confidence: {confidence!r} is not allowed: a number from 0.5 to below 1 is needed")
    history = measured.attrs["measured"] == "history"
    parameters = [_parameter(scene, path, measured) for path in _checked(scene, fit, history)]
    return _Search(scene, measured, parameters).run(confidence)


@dataclass(frozen=True)
class _Parameter:
    """A parameter between the search, where it is about 0 and 1 wide, and SI."""

    path: str
    dimension: str
    unit: str
    start: float
    scale: float
    log: bool
    low: float
    high: float

    def si(self, z: float) -> float:
        return self.start * math.exp(z) if self.log else self.start + self.scale * z

    def z(self, value: float) -> float:
        return math.log(value / self.start) if self.log else (value - self.start) / self.scale


class _Search:
    """Least squares of one measurement."""

    def __init__(self, scene: Scene, measured: xr.Dataset, parameters: list[_Parameter]) -> None:
        self.scene, self.solver = replace(scene, solver=Solver(accuracy=ACCURACY)), scene.solver
        self.measured, self.parameters = measured, parameters
        along = "t" if measured.attrs["measured"] == "history" else "impactor_velocity"
        self.names = [str(name) for name in measured.data_vars if name != along]
        self.there = {name: np.isfinite(measured[name].values) for name in self.names}
        largest = {n: float(np.abs(measured[n].values[self.there[n]]).max(initial=0.0)) for n in self.names}
        if not any(largest.values()):
            raise ValueError(f"{', '.join(self.names)}: zero throughout, there is nothing to fit")
        self.size = {name: value or 1.0 for name, value in largest.items()}
        self.points = sum(int(there.sum()) for there in self.there.values())
        if self.points <= len(parameters):
            raise ValueError(f"{self.points} measured values are too few for {len(parameters)} parameters")

    def changed(self, z: Array) -> tuple[Scene, float]:
        """The scene with these parameters, and the time offset."""
        values = {p.path: p.si(float(x)) for p, x in zip(self.parameters, z, strict=True)}
        offset = values.pop(TIME_OFFSET, 0.0)
        units = {p.path: p.unit for p in self.parameters}
        changes = {path: f"{value!r} {units[path]}" if units[path] else value for path, value in values.items()}
        return self.scene.replace(changes), offset

    def residuals(self, z: Array) -> Array:
        """Model less measurement, each over its largest value. Raises SimulationError where there is no impact."""
        scene, offset = self.changed(z)
        model = _model(scene, self.measured, self.names, offset, None)
        parts = [(model[n] - self.measured[n].values)[self.there[n]] / self.size[n] for n in self.names]
        return np.concatenate(parts)

    def tried(self, z: Array) -> Array:
        """As residuals, but where the model has no value, as far off as if it were twice the measurement."""
        try:
            found = self.residuals(z)
        except (SimulationError, SceneError):
            return np.full(self.points, 2.0)
        return np.where(np.isfinite(found), found, 2.0)

    def run(self, confidence: float) -> Identification:
        from scipy.optimize import least_squares

        if not np.isfinite(self.residuals(np.zeros(len(self.parameters)))).all():
            raise SimulationError("with the values of the scene an impact of the measurement fails: give nearer ones")
        bounds = (np.array([p.z(p.low) for p in self.parameters]), np.array([p.z(p.high) for p in self.parameters]))
        ends = []
        for factor in STARTS:
            z = np.array([math.log(factor) if p.log else 0.0 for p in self.parameters])
            z = np.clip(z, bounds[0] + 1e-9, bounds[1] - 1e-9)
            ends.append(least_squares(self.tried, z, self.jacobian, bounds, xtol=1e-10, ftol=1e-12, gtol=1e-12))
            if all(not p.log for p in self.parameters):
                break
        best = min(ends, key=lambda end: end.cost)
        return self.judged(best.x, confidence, bounds)

    def jacobian(self, z: Array) -> Array:
        """By central differences."""
        columns = []
        for k in range(z.size):
            step = np.zeros(z.size)
            step[k] = STEP
            columns.append((self.tried(z + step) - self.tried(z - step)) / (2.0 * STEP))
        return np.stack(columns, axis=1)

    def judged(self, z: Array, confidence: float, bounds: tuple[Array, Array]) -> Identification:
        """What the end of the search tells of each parameter."""
        from scipy.stats import t as student

        residuals, jacobian = self.tried(z), self.jacobian(z)
        freedom = self.points - z.size
        noise = math.sqrt(float(residuals @ residuals) / freedom)
        _, strengths, directions = np.linalg.svd(jacobian, full_matrices=False)
        unseen = strengths <= SINGULAR * max(float(strengths[0]), 1e-300)
        inverse = np.where(unseen, 0.0, 1.0 / np.where(unseen, 1.0, strengths))
        errors = noise * np.sqrt(((directions * inverse[:, None]) ** 2).sum(axis=0))
        lost = (np.abs(directions[unseen]) > SHARE).any(axis=0) if unseen.any() else np.zeros(z.size, np.bool_)
        reach = float(student.ppf(0.5 + 0.5 * confidence, freedom))
        fitted = []
        for k, p in enumerate(self.parameters):
            error = math.inf if lost[k] else float(errors[k])
            reason = self.reason(k, z, jacobian, lost, directions[unseen], error, bounds)
            low, high = (
                p.si(float(z[k]) + side * reach * error) if error < 50.0 else side * math.inf for side in (-1, 1)
            )
            if p.log and low == -math.inf:
                low = 0.0
            width = abs(p.si(float(z[k]))) if p.log else p.scale
            fitted.append(
                Fitted(p.path, p.dimension, p.unit, p.si(float(z[k])), error * width, low, high, not reason, reason)
            )
        off, rest = residuals, {}
        for name in self.names:
            count = int(self.there[name].sum())
            rest[name] = float(np.sqrt(np.mean(off[:count] ** 2))) * self.size[name]
            off = off[count:]
        scene = replace(self.changed(z)[0], solver=self.solver)
        return Identification(scene, tuple(fitted), confidence, self.points, rest, self.measured)

    def reason(
        self, k: int, z: Array, jacobian: Array, lost: Any, unseen: Array, error: float, bounds: tuple[Array, Array]
    ) -> str:
        """Why parameter k is not identified; nothing if it is."""
        norms = np.sqrt((jacobian**2).sum(axis=0))
        if norms[k] <= SINGULAR * max(float(norms.max()), SINGULAR):
            return "the measurement does not depend on it"
        if lost[k]:
            shares = np.abs(unseen).max(axis=0)
            others = [p.path for j, p in enumerate(self.parameters) if j != k and shares[j] > SHARE]
            return f"only together with {' and '.join(others)}: what one changes the other makes up for"
        if min(z[k] - bounds[0][k], bounds[1][k] - z[k]) < 1e-6:
            return "it ran to the end of its range"
        if error > WIDEST:
            return f"its standard error is {100 * error:.0f} % of it"
        return ""


def _checked(scene: Scene, fit: Sequence[str], history: bool) -> list[str]:
    mistakes = []
    for path in fit:
        try:
            if path == TIME_OFFSET:
                if not history:
                    raise ValueError("is for measured histories")
            elif field_at(scene, path) is None:
                raise ValueError("is no number that can be fitted")
            elif path == "impactor.velocity" and not history:
                raise ValueError("is measured")
            if list(fit).count(path) > 1:
                raise ValueError("is given twice")
        except ValueError as error:
            mistakes.append(Mistake(None, None, f"fit: {path}", str(error)))
    if not fit:
        mistakes.append(Mistake(None, None, "fit", "missing: at least one parameter is needed"))
    raise_all(list(dict.fromkeys(mistakes)))
    return list(fit)


def _parameter(scene: Scene, path: str, measured: xr.Dataset) -> _Parameter:
    """A parameter, beginning at the scene's value: in [contact], the materials' if it has none of its own."""
    if path == TIME_OFFSET:
        span = float(measured["t"].values[-1] - measured["t"].values[0])
        return _Parameter(path, "time", scene_unit("time"), 0.0, span, False, -span, span)
    owner: Any = scene
    for name in path.split("."):
        owner = owner.parameters[name] if name in getattr(owner, "parameters", {}) else getattr(owner, name)
    value = getattr(scene, path.partition(".")[2], None) if owner is None and path.startswith("contact.") else owner
    if value is None:
        message = "the scene has no value to begin with: give one"
        raise SceneError([Mistake(None, None, f"fit: {path}", message)])
    found = field_at(scene, path)
    assert found is not None and found.low is not None and found.high is not None
    return _scaled(path, found, unit_of(scene, found), float(value))


def _scaled(path: str, found: Field, unit: str, value: float) -> _Parameter:
    low, high = max(float(found.low or 0.0), -1e30), min(float(found.high or 0.0), 1e30)
    if found.open_ends:
        low, high = low + 1e-9 * max(abs(low), 1e-3), high - 1e-9 * max(abs(high), 1e-3)
    if low >= 0.0 and value > 0.0 and found.dimension != "dimensionless":
        return _Parameter(path, found.dimension, unit, value, value, True, max(low, 1e-9 * value), high)
    return _Parameter(path, found.dimension, unit, value, abs(value) or 1.0, False, low, high)


def _model(
    scene: Scene, measured: xr.Dataset, names: list[str], offset: float, places: Array | None
) -> dict[str, Array]:
    """What the scene gives for the measured quantities, at `places` or at the measured ones."""
    if measured.attrs["measured"] == "impacts":
        speeds = np.asarray(measured["impactor_velocity"].values if places is None else places)
        return simulate_rows(scene, {"impactor.velocity": speeds}).summary
    t = np.asarray(measured["t"].values if places is None else places) - offset
    samples = simulate(scene).sample_si(np.maximum(t, 0.0))
    return {name: _before(getattr(samples, name), t, scene, name) for name in names}


def _before(values: Array, t: Array, scene: Scene, name: str) -> Array:
    """Before first touch there is no force; the bodies move at their velocities."""
    if name.endswith("displacement") or name == "indentation":
        speed = {"indentation": scene.approach_velocity, "impactor_displacement": scene.impactor.speed}.get(name, 0.0)
        return np.where(t < 0.0, speed * t, values)
    return values


def _dimension(name: str) -> str:
    return (MOTION[name] if name in MOTION else SUMMARY[name])[0]
