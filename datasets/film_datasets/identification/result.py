"""The result of an identification: fitted parameters with intervals, as text, JSON and figure."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from film_datasets.axis_style import finite, label
from film_datasets.csv_measurement import doubts_of, measured_over
from film_datasets.identification.model import DIMENSIONS_OF_QUANTITIES, Case, numerics_of
from film_model.base.foreign import Figure
from film_model.base.hardness import VICKERS
from film_model.base.units import DIMENSIONS, format_si, si_unit
from film_model.plot.style import HIGHLIGHT, picture, prefixed_unit
from film_model.scene import Scene
from film_model.solve.history import History
from film_model.solve.simulate import simulate

TIME_OFFSET = "time_offset"
"""A parameter of the measurement, not of the scene: time of its first touch, s."""

ALONG = {"t": "time", "impactor_velocity": "velocity", "impactor_angle": "angle"}
"""Words, and dimensions, of what measurements are made over."""


@dataclass(frozen=True)
class FittedParameter:
    """One parameter, SI, in `unit`. low, high: confidence interval. identified: whether the measurement determines it;
    reason: why not."""

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
        if self.path.endswith(".hardness"):
            return f"{value / VICKERS:.4g} HV"
        return format_si(value, self.dimension, 5) if self.dimension in DIMENSIONS else f"{value:.5g} {self.unit}"

    def limit(self) -> str:
        """What is known of a parameter that is not identified: at most one end of its interval."""
        if self.low > 0.0 and not math.isfinite(self.high):
            return f"not identified, but at least {self.text(self.low)}"
        if self.low <= 0.0 and math.isfinite(self.high):
            return f"not identified, but at most {self.text(self.high)}"
        return "not identified"

    def to_dict(self) -> dict[str, Any]:
        """Plain values; None for what is not known."""
        numbers = {name: getattr(self, name) for name in ("value", "standard_error", "low", "high")}
        plain = {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        units = si_unit(self.dimension) if self.dimension in DIMENSIONS else self.unit
        return {**plain, "units": units, "identified": self.identified, "reason": self.reason}


@dataclass(frozen=True)
class Identification:
    """A scene fitted to a measurement.

    scene: with the fitted values. parameters: with intervals at the level `confidence`, from the `intervals` asked for.
    residual: RMS residual of each measured quantity, SI; largest: its largest measured value. cases: what was fitted.
    """

    scene: Scene
    parameters: tuple[FittedParameter, ...]
    confidence: float
    points: int
    residual: Mapping[str, float]
    largest: Mapping[str, float]
    cases: tuple[Case, ...] = field(repr=False)
    intervals: str = "curvature"

    @property
    def square(self) -> float:
        """The sum of the squares of all residuals, each over the largest value of its quantity."""
        return sum(self._count(name) * (rms / (self.largest[name] or 1.0)) ** 2 for name, rms in self.residual.items())

    def _count(self, name: str) -> int:
        measured = (case.measured[name].values for case in self.cases if name in case.names)
        return sum(int(np.isfinite(values).sum()) for values in measured)

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each parameter that is not identified, and for each kind of value that no impact can have."""
        lost = (f"{one.path} cannot be identified: {one.reason}" for one in self.parameters if not one.identified)
        return (*lost, *dict.fromkeys(doubt for case in self.cases for doubt in doubts_of(case.measured)))

    def history(self) -> History:
        """The fitted impact."""
        return simulate(self.scene, accuracy=numerics_of(self.scene).accuracy)

    def to_dict(self) -> dict[str, Any]:
        """Plain values, SI."""
        residual = {
            name: {"value": value, "units": si_unit(DIMENSIONS_OF_QUANTITIES[name])}
            for name, value in self.residual.items()
        }
        return {
            "parameters": {one.path: one.to_dict() for one in self.parameters},
            "confidence": self.confidence,
            "intervals": self.intervals,
            "points": self.points,
            "residual": residual,
            "warnings": list(self.warnings),
        }

    def table(self) -> str:
        """The parameters as text."""
        by = " by profile likelihood" if self.intervals == "profile" else ""
        files = f" of {len(self.cases)} measurements" if len(self.cases) > 1 else ""
        lines = [f"{self.points} points{files}; intervals at {100 * self.confidence:g} %{by}", ""]
        for one in self.parameters:
            value, low, high = map(one.text, (one.value, one.low, one.high))
            interval = f"{low} to {high}" if one.identified else one.limit()
            lines.append(f"  {one.path:32}{value:>14}   {interval}")
        lines += ["", "  RMS residual:"]
        for name, value in self.residual.items():
            largest = self.largest[name]
            share = f"{100 * value / largest:.2g} % of the largest" if largest else ""
            text = format_si(value, DIMENSIONS_OF_QUANTITIES[name], 3)
            lines.append(f"  {name.replace('_', ' '):32}{text:>14}   {share}".rstrip())
        return "\n".join(lines)

    def plot(self, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
        """Measurement and fitted model, and below them their difference; a column for every measured quantity of every
        measurement."""
        columns = sum(len(case.names) for case in self.cases)
        return picture(path, self._draw, (7.2 * max(1.0, 0.5 * columns), 5.2), dpi)

    def _draw(self, figure: Figure) -> None:
        ratios: dict[str, Any] = {"height_ratios": (3, 1), "hspace": 0.08, "wspace": 0.35}
        pairs = [(case, name) for case in self.cases for name in case.names]
        panels: Any = figure.subplots(2, len(pairs), sharex="col", squeeze=False, gridspec_kw=ratios)
        for column, (case, name) in enumerate(pairs):
            along, _ = measured_over(case.measured)
            x, values = case.measured[along].values, case.measured[name].values
            count = 61 if along == "impactor_angle" else 501  # over the angle, impacts are simulated one by one
            fine = np.linspace(x.min(), x.max(), count)
            curve, at_points = (case.predict(self.scene, points)[name] for points in (fine, x))
            x_size, x_unit = prefixed_unit(x, ALONG[along])
            size, unit = prefixed_unit(finite(case.measured[name]), DIMENSIONS_OF_QUANTITIES[name])
            above, below = panels[:, column]
            above.plot(x / x_size, values / size, "o", color="0.45", markersize=2.5, label="measured")
            above.plot(fine / x_size, curve / size, color=HIGHLIGHT, label="fitted")
            below.plot(x / x_size, (values - at_points) / size, "o", color="0.45", markersize=2.0)
            below.axhline(0.0, color=HIGHLIGHT, linewidth=0.8)
            above.set_ylabel(label(name, unit))
            if case.changes:
                above.set_title(", ".join(case.changes.values()), fontsize=8)
            below.set(xlabel=label(ALONG[along], x_unit), ylabel=label("difference", unit))
        panels[0, 0].legend(frameon=False, fontsize=8)
        texts: list[str] = []
        for one in self.parameters:
            interval = f"{one.text(one.low)} to {one.text(one.high)}" if one.identified else one.limit()
            texts.append(f"{one.path} {one.text(one.value)} ({interval})")
        law = f"law {self.scene.contact.law_name}, intervals at {100 * self.confidence:g} %"
        figure.suptitle("\n".join([law, *texts]).replace("$", r"\$"), fontsize=9, y=0.985)
