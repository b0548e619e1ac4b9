"""identify_force: the contact force from the measured motion of sensors on a structure."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import NormalDist
from typing import Any

import numpy as np

from film_datasets.identification.deconvolution import SHORTEST, Deconvolved, deconvolve
from film_datasets.identification.sensor_motions import Array, Motions, sensor_motions
from film_datasets.provenance import dataset_of, text_and_hash
from film_datasets.schema import FORCE_INTERVAL, MEASUREMENT
from film_model.base.errors import SimulationError, TooManyModes, shown
from film_model.base.foreign import Dataset, Figure
from film_model.base.units import format_si, si_unit
from film_model.plot.style import COLOURS, HIGHLIGHT, picture, plain, prefixed_unit
from film_model.scene import Scene
from film_model.solve.sensed import MOTION, responses
from film_model.targets import AbstractTarget

MOST_PANELS = 6
"""Sensors in the picture."""


@dataclass(frozen=True, eq=False)
class IdentifiedForce:
    """A contact force, SI, linear between the times and 0 before and after. low, high: interval at the level
    `confidence`. impulse: with its interval. fitted: motions by this force in the order of `motions`."""

    time: Array
    force: Array
    low: Array
    high: Array
    impulse: tuple[float, float, float]
    confidence: float
    motions: Motions
    fitted: Array
    scene: Scene = field(repr=False)
    warnings: tuple[str, ...] = ()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, IdentifiedForce):
            return False
        return self.scene == other.scene and self.to_dict() == other.to_dict()

    @property
    def largest(self) -> tuple[float, float, float]:
        """The largest force, with its interval, N."""
        at = int(np.argmax(self.force))
        return float(self.force[at]), float(self.low[at]), float(self.high[at])

    @property
    def residual(self) -> dict[str, float]:
        """RMS residual of each sensor, SI."""
        left = np.sqrt(np.mean((self.motions.values - self.fitted) ** 2, axis=1))
        return dict(zip(self.motions.names, left.tolist(), strict=True))

    def to_dict(self) -> dict[str, Any]:
        """Plain values, SI."""
        values = {"largest_force": (self.largest, "force"), "impulse": (self.impulse, "impulse")}
        kinds = zip(self.residual.items(), self.motions.quantities, strict=True)
        history = {"time": self.time, "force": self.force, "low": self.low, "high": self.high}
        return {
            **{
                name: {"value": value, "units": si_unit(kind), "interval": [low, high]}
                for name, ((value, low, high), kind) in values.items()
            },
            "time_of_largest_force": float(self.time[np.argmax(self.force)]),
            "confidence": self.confidence,
            "residual": {name: {"value": v, "units": si_unit(MOTION[kind][0])} for (name, v), kind in kinds},
            "history": {name: array.tolist() for name, array in history.items()},
            "warnings": list(self.warnings),
        }

    def table(self) -> str:
        """The result as text."""
        count = len(self.motions.names)
        of = f"{count} sensor{'s' if count > 1 else ''}, {self.motions.values.shape[1]} times"
        lines = [f"contact force from {of}; intervals at {100 * self.confidence:g} %", ""]
        for name, (value, low, high), kind in (
            ("largest force", self.largest, "force"),
            ("impulse", self.impulse, "impulse"),
        ):
            text, ends = format_si(value, kind, 4), [format_si(one, kind, 4) for one in (low, high)]
            lines.append(f"  {name:30}{text:>16}   {' to '.join(ends)}")
        moments = {"force begins": 0, "largest force at": int(np.argmax(self.force)), "force ends": -1}
        lines += [f"  {name:30}{format_si(float(self.time[at]), 'time', 4):>16}" for name, at in moments.items()]
        lines += ["", "  RMS residual:"]
        size = np.sqrt(np.mean(self.motions.values**2, axis=1)).tolist()
        kinds = (MOTION[quantity][0] for quantity in self.motions.quantities)
        for (name, rms), kind, own in zip(self.residual.items(), kinds, size, strict=True):
            share = f"{100 * rms / own:.2g} % of its motion" if own else ""
            lines.append(f"  {name:30}{format_si(rms, kind, 3):>16}   {share}".rstrip())
        return "\n".join(lines)

    def to_dataset(self) -> Dataset:
        """The force with its interval, of kind impact_measurement, which `identify` takes."""
        values = (self.time - self.time[0], self.force, self.low, self.high)
        columns: dict[str, Any] = dict(zip(("t", "contact_force", *FORCE_INTERVAL), values, strict=True))
        about = {
            "title": self._title,
            "summary": f"Contact force identified from the motion of {', '.join(self.motions.names)}.",
            "source": "regularised deconvolution on the vibrations of the scene's target",
            "command": "film_datasets.identify_force",
            "comment": f"The force begins {self.time[0]:g} s after the measurement's time 0. Intervals at "
            f"{100 * self.confidence:g} %.",
        }
        own = {
            "measured": "history",
            **text_and_hash("scene", self.scene.archived_text()),
            "warnings": "\n".join(self.warnings) or "none",
        }
        return dataset_of(MEASUREMENT, columns, about, own, f"{MEASUREMENT} history", coordinates=FORCE_INTERVAL)

    @property
    def _title(self) -> str:
        return self.scene.title or f"Contact force on a {self.scene.target.kind}"

    def plot(self, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
        """The force with its interval, and below it the motion of the first sensors as measured and by this force."""
        return picture(path, self._draw, (7.2, 2.8 + 1.4 * min(len(self.motions.names), MOST_PANELS)), dpi)

    def _draw(self, figure: Figure) -> None:
        figure.set_layout_engine("constrained")
        figure.suptitle(plain(self._title), fontsize=min(11.0, 620.0 / len(self._title)), fontweight="bold")
        names = self.motions.names[:MOST_PANELS]
        ratios = {"height_ratios": [1.7, *[1.0] * len(names)]}
        panels: Any = figure.subplots(len(names) + 1, 1, gridspec_kw=ratios)
        times = self.motions.begin + self.motions.dt * np.arange(self.fitted.shape[1])
        (t_size, t_unit), (size, unit) = prefixed_unit(self.time, "time"), prefixed_unit(self.force, "force")
        panels[0].fill_between(
            self.time / t_size, self.low / size, self.high / size, color=COLOURS[0], alpha=0.3, linewidth=0
        )
        panels[0].plot(self.time / t_size, self.force / size, color=COLOURS[0], linewidth=0.8)
        panels[0].set(ylabel=f"contact force ({unit})", xlabel=f"time ({t_unit})")
        t_size, t_unit = prefixed_unit(times, "time")
        panels[0].set_title(f"interval at {100 * self.confidence:g} %", loc="right", fontsize=8)
        for panel, name, kind, own, fitted in zip(
            panels[1:], names, self.motions.quantities, self.motions.values, self.fitted, strict=False
        ):
            size, unit = prefixed_unit(own, MOTION[kind][0])
            panel.plot(times / t_size, own / size, ".", color="0.45", markersize=2.0, label="measured")
            panel.plot(times / t_size, fitted / size, color=HIGHLIGHT, linewidth=0.9, label="by this force")
            panel.set_ylabel(f"{kind}\n({unit})")
            panel.sharex(panels[-1])
            panel.tick_params(labelbottom=panel is panels[-1])
            panel.set_title(plain(name), loc="left", fontsize=8, pad=2.0)
        panels[1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, fontsize=8, frameon=False)
        panels[-1].set_xlabel(f"time ({t_unit})")


def identify_force(
    path: str | os.PathLike[str], scene: Scene, confidence: float = 0.99, *, columns: Mapping[str, str] | None = None
) -> IdentifiedForce:
    """The contact force from measured displacements, velocities or accelerations of the sensors of a scene's target.

    path: a CSV file with evenly spaced times and a column for each sensor (`sensor_motions`), from before contact, when
    the target is at rest, on. Of the scene only the target matters: its vibrations up to half the sampling rate.
    columns: headings of the file, as of `from_csv`.

    The force is linear between times of the measurement, zero before and after one contact, or several close to each
    other, and as smooth as the data want: `deconvolution` has the method. The noise is taken as independent from time
    to time, equal in all sensors of a quantity and, between quantities, in proportion to their largest values. The
    interval holds for such noise, and for vibrations and places that are right; it does not know their errors, which
    `warnings` judges by the residual. A sensor is most telling where the structure moves at once, close to the contact.

    Raises SceneError for mistakes in the file, ValueError for a target without sensors or vibrations, SimulationError
    if the vibrations cannot be computed.

    >>> beam = fm.Beam("mild steel", "300 mm", "20 mm", "10 mm", "free", sensors=[{"name": "tip", "position": "0.2 m"}])
    >>> struck = fm.simulate(fm.Scene(fm.Sphere("10 mm", "1 m/s", material="nylon 6/6"), beam), accuracy=1e-4)
    >>> times = [k * 5e-6 for k in range(400)]
    >>> rows = [f"{t!r}, {a!r}" for t, a in zip(times, struck.sensed_si(times).acceleration[0].tolist())]
    >>> with open("tip.csv", "w") as file:
    ...     print("time [s], tip [m/s^2]", *rows, sep=chr(10), file=file)
    >>> force, low, high = fd.identify_force("tip.csv", struck.scene).largest
    >>> print(f"{force:.0f} N of {struck.summary['maximum_force']:.0f} N")
    132 N of 132 N
    """
    if isinstance(confidence, bool) or not 0.5 <= confidence < 1.0:
        raise ValueError(f"confidence: {confidence!r} is not allowed: a number from 0.5 to below 1 is needed")
    motions = _motions(path, scene.target, columns)
    own = _responses(scene.target, motions)
    groups = (motions.values[[q == one for one in motions.quantities]] for q in motions.quantities)
    sizes = [float(np.abs(group).max()) for group in groups]
    if not all(sizes):
        raise ValueError(f"{', '.join(motions.names)}: zero throughout, there is nothing to identify")
    scaled = [(r / size, m / size) for r, m, size in zip(own, motions.values, sizes, strict=True)]
    found = deconvolve([r for r, _ in scaled], [m for _, m in scaled])
    factor = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    everywhere: Array = np.interp(np.arange(motions.values.shape[1]), found.rows, found.force, left=0.0, right=0.0)
    fitted: Array = np.array([np.convolve(response, everywhere)[: everywhere.size] for response in own])
    long = motions.dt * found.step
    impulse, half = long * found.total, factor * long * found.total_deviation
    times: Array = motions.begin + motions.dt * found.rows.astype(np.float64)
    return IdentifiedForce(
        times,
        found.force,
        found.force - factor * found.deviation,
        found.force + factor * found.deviation,
        (impulse, impulse - half, impulse + half),
        confidence,
        motions,
        fitted,
        scene,
        tuple(_warnings(found, motions, fitted)),
    )


def _motions(path: str | os.PathLike[str], target: AbstractTarget, columns: Mapping[str, str] | None) -> Motions:
    if not target.sensors:
        raise ValueError("the target has no sensors: give them as [[target.sensors]]")
    if target.modes_missing:
        raise ValueError(f"the vibrations of the target are not known: {target.modes_missing}")
    return sensor_motions(path, [sensor.name for sensor in target.sensors], columns)


def _responses(target: AbstractTarget, motions: Motions) -> list[Array]:
    """The response of each measured motion to a unit force at one time, by the vibrations that the times resolve."""
    highest = 0.5 / motions.dt
    try:
        modes = target.modes(2.0 * math.pi * highest)
    except TooManyModes as error:
        raise SimulationError(f"up to half the sampling rate, {highest:g} Hz: {error}") from None
    if modes.frequency.size == 0:
        raise SimulationError(f"the target has no vibration below half the sampling rate, {highest:g} Hz")
    found = responses(modes, motions.dt, motions.values.shape[1])
    every = [sensor.name for sensor in target.sensors or ()]
    places = zip(map(list(MOTION).index, motions.quantities), map(every.index, motions.names), strict=True)
    return [found[place] for place in places]


def _warnings(found: Deconvolved, motions: Motions, fitted: Array) -> list[str]:
    """What speaks against the force."""
    said, doubted = list[str](), list[str]()
    for name, own, residual in zip(motions.names, motions.values, motions.values - fitted, strict=True):
        share = float(np.linalg.norm(residual) / np.linalg.norm(own))
        lines = np.abs(np.fft.rfft(residual)[1 : (residual.size + 1) // 2]) ** 2
        largest = float(lines.max() / lines.sum())
        by_chance = lines.size * (1.0 - largest) ** (lines.size - 1)  # at most: Fisher 1929, Proc. R. Soc. A 125:54
        if share > 0.05 and by_chance < 1e-6:
            line = (int(np.argmax(lines)) + 1) / (residual.size * motions.dt)
            doubted.append(f"{shown(name)} {100 * share:.2g} % of the motion, most at {line / 1e3:.3g} kHz")
    if doubted:
        said.append(
            f"the residual is no noise ({'; '.join(doubted)}): frequencies, shapes or damping are not those of this "
            "structure, or a sensor's place or sign"
        )
    pull = float(-np.minimum(found.force, 0.0).sum() / np.abs(found.force).sum())
    if pull > 0.05:
        said.append(f"{100 * pull:.2g} % of the force pulls, which a contact cannot: it is not that of this contact")
    if found.rows[0] == 0 or found.rows[-1] >= motions.values.shape[1] - found.step:
        said.append("the force lasts from or to an end of the record, where it is taken as 0: record before and after")
    if found.rows.size - 2 <= 2 * SHORTEST:
        said.append(f"the contact lasts about {found.rows.size - 1} samples: sample faster")
    return said
