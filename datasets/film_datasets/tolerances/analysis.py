"""The tolerance analysis: how far tolerances and scatter spread each result, and which number causes how much of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from film_datasets.impacts import results_of, scene_with_numbers
from film_datasets.sweeps.axis import Axis
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import points
from film_datasets.sweeps.distributions import correlated, correlation_factor
from film_datasets.tolerances import shapley, sobol
from film_datasets.tolerances.inputs import check_quantities, moments, results_at, scattering
from film_datasets.tolerances.sobol import Indices, Interval
from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.base.units import format_si, quantity, si_unit
from film_model.oblique.result import OBLIQUE
from film_model.scene import Scene
from film_model.solve.derivatives import RESULTS
from film_model.solve.simulate import simulate_quietly

SHOWN = ("maximum_force", "maximum_indentation", "contact_duration", "coefficient_of_restitution")
"""Quantities that are analysed unless others are asked for."""

SAMPLES, CONFIDENCE = 1024, 0.95
"""Points of the sample, and level of the intervals, unless given."""

STEP = 0.1
"""Step of the derivatives of results along the surface, in standard deviations: above the errors of these results."""

PERCENTILES = (2.5, 50.0, 97.5)


@dataclass(frozen=True)
class Spread:
    """The spread of one result, SI.

    at_means: with all numbers at their means. linear: standard deviation from the derivatives there, None if there are
    none. slopes: the derivatives. shares: of each number in the linear variance. mean, deviation, percentiles: of the
    sample. indices: Sobol's, of each number. effects: Shapley's, instead of them if the numbers are correlated. used:
    impacts of the sample that have a value.
    """

    at_means: float | None
    linear: float | None
    slopes: dict[str, float | None]
    shares: dict[str, float]
    mean: float
    deviation: float
    percentiles: tuple[float, ...]
    indices: dict[str, Indices]
    effects: dict[str, Interval]
    used: int


@dataclass(frozen=True, repr=False)
class Tolerance:
    """Results of a tolerance analysis. numbers: mean and standard deviation of each, SI. spreads: by summary name."""

    sweep: Sweep
    confidence: float
    numbers: dict[str, tuple[float, float]]
    spreads: dict[str, Spread]
    warnings: tuple[str, ...]

    def of(self, name: str) -> tuple[Any, Any]:
        """Mean and standard deviation of a result, as pint quantities, from the sample."""
        spread, dimension = self.spreads[name], RESULTS[name][0]
        return quantity(spread.mean, dimension), quantity(spread.deviation, dimension)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON, SI; None for what is not known."""
        return {
            "title": self.sweep.scene.title,
            "confidence": self.confidence,
            "numbers": {
                path: {"mean": mean, "standard_deviation": deviation}
                for path, (mean, deviation) in self.numbers.items()
            },
            "spreads": {name: _plain(name, spread) for name, spread in self.spreads.items()},
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        sweep = self.sweep
        how = f"{sweep.samples} points, {sweep.design}{', correlated' if sweep.correlation else ''}"
        lines = [sweep.scene.title or "Impact", how, ""]
        lines.append(f"  {'':32}{'mean':>15}{'standard deviation':>20}")
        for axis in self.sweep.axes:
            mean, deviation = (format_si(value, axis.dimension, 5) for value in self.numbers[axis.path])
            lines.append(f"  {axis.path:32}{mean:>15}{deviation:>20}")
        for name, spread in self.spreads.items():
            lines += ["", *_text(name, spread, self.confidence)]
        return "\n".join(lines)


def _plain(name: str, spread: Spread) -> dict[str, Any]:
    return {
        "units": si_unit(RESULTS[name][0]),
        "at_means": spread.at_means,
        "linear_standard_deviation": spread.linear,
        "mean": _known(spread.mean),
        "standard_deviation": _known(spread.deviation),
        "percentiles": dict(zip(map(str, PERCENTILES), map(_known, spread.percentiles), strict=False)),
        "derivatives": spread.slopes,
        "linear_shares": spread.shares,
        "sobol_indices": {
            path: {word: [_known(v) for v in interval] for word, interval in one._asdict().items()}
            for path, one in spread.indices.items()
        },
        "shapley_effects": {path: [_known(v) for v in one] for path, one in spread.effects.items()},
        "points": spread.used,
    }


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _text(name: str, spread: Spread, confidence: float) -> list[str]:
    """The lines of one result."""
    dimension = RESULTS[name][0]
    if not spread.used:
        return [f"  {name.replace('_', ' ')}: no value in any impact"]

    def shown(value: float | None) -> str:
        return "-" if value is None else format_si(value, dimension, 4)

    low, middle, high = map(shown, spread.percentiles)
    share = 100.0 * spread.deviation / abs(spread.mean) if spread.mean else math.nan
    lines = [
        f"  {name.replace('_', ' ')}: {shown(spread.mean)} ± {shown(spread.deviation)} ({share:.2g} %)",
        f"    95 % between {low} and {high}, median {middle}; {spread.used} impacts",
        f"    at the means {shown(spread.at_means)}, linear standard deviation {shown(spread.linear)}",
    ]
    if not spread.shares and not spread.indices and not spread.effects:
        return lines
    level = f"({100 * confidence:g} %)"
    words = (f"Shapley's {level}", "") if spread.effects else (f"first order {level}", "total")
    lines.append(f"    {'share of the variance':32}{'linear':>10}{words[0]:>28}{words[1]:>22}".rstrip())
    for path in spread.slopes:
        linear = f"{100 * spread.shares[path]:.1f} %" if path in spread.shares else "-"
        found = spread.indices.get(path) or ([spread.effects[path]] if path in spread.effects else [])
        cells = [f"{100 * v:.1f} % ({100 * a:.1f} to {100 * b:.1f})" for v, a, b in found] or ["-", "-"]
        lines.append(f"    {path:32}{linear:>10}{cells[0]:>28}" + "".join(f"{cell:>26}" for cell in cells[1:]))
    return lines


def tolerance(
    scene: Scene,
    over: Mapping[str, Any],
    *,
    quantities: Sequence[str] = SHOWN,
    samples: int = SAMPLES,
    seed: int = 1,
    confidence: float = CONFIDENCE,
    correlation: Any = None,
) -> Tolerance:
    """How far the scatter of some numbers spreads the results of an impact.

    over: key of the scene → a tolerance, "10 mm ± 0.05 mm", or a distribution, as in :func:`film_datasets.sweep`.
    quantities: names of results: of the summary, or along
    the surface such as "rebound_spin", if the scene has friction; these are simulated one by one. samples: points, at
    least 8; (numbers + 2) times as many impacts are simulated. confidence: level of the intervals of the shares.
    correlation: as in `sweep`; the shares are then Shapley's effects, from 2^numbers times as many impacts, for at most
    8 numbers.

    Linear: σ_y² = Σ ∂y/∂x_i ∂y/∂x_j c_ij σ_i σ_j with the derivatives at the means. Raises SceneError for mistakes,
    ValueError for an unknown quantity.

    >>> found = fd.tolerance(scene, {"impactor.velocity": "1 m/s ± 2 %"}, samples=256)
    >>> mean, deviation = found.of("maximum_force")
    >>> print(f"{mean:.0f~P} ± {deviation:.0f~P}")
    1444 N ± 19 N
    """
    sweep = Sweep.of(scene, over, "sobol", samples=samples, seed=seed, correlation=correlation)
    return tolerance_of(sweep, quantities, confidence)


def tolerance_of(sweep: Sweep, quantities: Sequence[str] = SHOWN, confidence: float = CONFIDENCE) -> Tolerance:
    """As :func:`tolerance`, for the scatter of a sampled sweep, with its design and number of points."""
    least = 8  # points
    check_quantities(quantities)
    if sweep.samples < least:
        raise ValueError(f"samples: {sweep.samples} must be >= {least}")
    axes, warnings = scattering(sweep), list[str]()
    if sweep.correlation and len(axes) > shapley.MOST_NUMBERS:
        most = f"{len(axes)} correlated numbers, at most {shapley.MOST_NUMBERS} can be"
        warnings.append(f"no shares of the variance: {most}")
    known = {axis.path: moments(axis) for axis in axes}
    at_means, slopes = _linear(sweep, known, quantities, warnings)
    spreads: dict[str, Spread] = {}
    for name, results in zip(quantities, _sampled(sweep, axes, quantities), strict=True):
        plain = (results[[0, -1]] if sweep.correlation else results[:2]).ravel()  # independent designs
        indices, effects = dict[str, Indices](), dict[str, Interval]()
        values = plain[np.isfinite(plain)]
        if values.size < plain.size:
            warnings.append(f"{name}: {plain.size - values.size} of {plain.size} impacts have no value")
        if not sweep.correlation:
            indices = dict(zip(known, sobol.indices(results, confidence, sweep.seed), strict=True))
        elif len(axes) <= shapley.MOST_NUMBERS:
            effects = dict(zip(known, shapley.effects(results, confidence, sweep.seed), strict=True))
        linear, shares = _variance(slopes[name], known, sweep) if name in slopes else (None, {})
        spreads[name] = Spread(
            at_means=at_means.get(name),
            linear=linear,
            slopes=slopes.get(name, {}),
            shares=shares,
            mean=float(values.mean()) if values.size else math.nan,
            deviation=float(values.std(ddof=1)) if values.size > 1 else math.nan,
            percentiles=tuple(np.quantile(values, np.array(PERCENTILES) / 100).tolist() if values.size else ()),
            indices=indices,
            effects=effects,
            used=int(values.size),
        )
    return Tolerance(sweep, confidence, known, spreads, tuple(warnings))


def _linear(
    sweep: Sweep, known: Mapping[str, tuple[float, float]], quantities: Sequence[str], warnings: list[str]
) -> tuple[dict[str, float | None], dict[str, dict[str, float | None]]]:
    """The results with all numbers at their means, and their derivatives there: by differences along the surface."""
    scene = scene_with_numbers(sweep.first, {path: mean for path, (mean, _) in known.items()})
    try:
        history = simulate_quietly(scene, derivatives=list(known))
    except SimulationError as error:
        warnings.append(f"no linear estimate: {error}")
        return {}, {}
    assert history.derivatives is not None
    warnings += history.warnings
    values, slopes = dict(history.summary), {name: dict(row) for name, row in history.derivatives.values.items()}
    asked = [name for name in quantities if name in OBLIQUE]
    if history.oblique is not None and asked:
        values |= {name: history.oblique.summary[name] for name in asked}
        slopes |= _differences(sweep.first, known, asked)
    return values, slopes


def _differences(
    scene: Scene, known: Mapping[str, tuple[float, float]], names: Sequence[str]
) -> dict[str, dict[str, float | None]]:
    """Central differences of results along the surface, over `STEP` standard deviations to both sides."""
    count, means = len(known), np.array([mean for mean, _ in known.values()])
    steps = STEP * np.array([deviation for _, deviation in known.values()])
    moved = means + np.concatenate([np.diag(steps), -np.diag(steps)])
    found = results_of(scene, {path: moved[:, k] for k, path in enumerate(known)}, names)
    slopes = {name: (found[name][:count] - found[name][count:]) / (2.0 * steps) for name in names}
    return {name: dict(zip(known, map(_known, row.tolist()), strict=True)) for name, row in slopes.items()}


def _sampled(sweep: Sweep, axes: Sequence[Axis], quantities: Sequence[str]) -> Array:
    """Results of the sample: (quantities, designs, points), those of `sobol.designs` or `shapley.designs`."""
    d = len(axes)
    u = points(sweep.design, 2 * d, sweep.samples, sweep.seed)(0, sweep.samples)
    if sweep.correlation:
        if d > shapley.MOST_NUMBERS:
            factor = correlation_factor(sweep.correlation, [axis.path for axis in sweep.axes])
            both = (correlated(part, factor) for part in (u[:, :d], u[:, d:]))
        else:
            both = shapley.designs(u, np.array(sweep.correlation))
        return np.stack([results_at(sweep, axes, design, quantities) for design in both], axis=1)
    made = sobol.designs(u)
    found = results_at(sweep, axes, made.reshape(-1, d), quantities)
    return found.reshape(len(quantities), d + 2, sweep.samples)


def _variance(
    slopes: Mapping[str, float | None], known: Mapping[str, tuple[float, float]], sweep: Sweep
) -> tuple[float | None, dict[str, float]]:
    """Linear standard deviation, and the share of each number."""
    if any(slope is None for slope in slopes.values()):
        return None, {}
    each = np.array([(slopes[path] or 0.0) * deviation for path, (_, deviation) in known.items()])
    matrix = np.array(sweep.correlation) if sweep.correlation else np.eye(each.size)
    variance = float(each @ matrix @ each)
    if not variance > 0.0 or (sweep.correlation and each.size > shapley.MOST_NUMBERS):
        return math.sqrt(max(variance, 0.0)), {}
    shares = shapley.linear_shares(each, matrix) if sweep.correlation else (each**2 / variance).tolist()
    return math.sqrt(variance), dict(zip(known, shares, strict=True))
