"""The picture of one impact: force, indentation, velocities and energies over time, and the force loop.

On a target that vibrates: displacements instead of velocities, which are ragged there, and the energy by vibration. At
an angle or with spin: the friction force and its limits.
"""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from film_model.base.foreign import Figure
from film_model.base.units import format_si
from film_model.plot.style import COLOURS, HIGHLIGHT, NO_CONTACT, UNLOADING, picture, plain, prefixed_unit
from film_model.scene.friction_table import FrictionTable
from film_model.solve.history import MOTION, SUMMARY, Event, History, Samples

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LABELS = {
    "contact_begins": "contact again",
    "stage_changes": "{stage} begins",
    "maximum_indentation": "maximum indentation",
    "impactor_stops": "impactor stops",
    "reloading_begins": "reloading",
    "contact_ends": "contact ends",
}

NUMBERS = {
    **{"maximum_force": "peak force", "maximum_indentation": "peak indentation", "contact_duration": "contact"},
    **{"permanent_indentation": "dent", "rebound_velocity": "rebound", "coefficient_of_restitution": "restitution"},
}
STRESSES = {
    **{"impulse": "impulse", "contact_radius": "contact radius", "dent_diameter": "dent diameter"},
    **{"mean_pressure": "mean pressure", "peak_pressure": "peak pressure", "maximum_shear_stress": "shear stress"},
}
"""Numbers of the first and of the second line, with their words."""

VELOCITIES = {"impactor_velocity": "-", "target_velocity": "--", "relative_velocity": ":"}
DISPLACEMENTS = {"impactor_displacement": "-", "target_displacement": "--"}
LINES = VELOCITIES | DISPLACEMENTS
"""Line styles of the quantities that share a panel."""

ABOVE: dict[str, Any] = {
    **{"loc": "lower right", "bbox_to_anchor": (1.0, 1.01), "ncols": 3, "borderaxespad": 0.0},
    **{"fontsize": 8, "frameon": False},
}
"""Place of a legend above the right end of a panel."""

SIZE, LEFT = (9.6, 7.0), 0.075  # inches; left margin as a fraction of the width


@dataclass(frozen=True)
class Trace:
    """The data of the picture. stages: of the law, in order. samples: SI, from first touch to `end` [s].

    energies: J at the samples, by name; empty if they are unknown. spectrum: frequency, Hz, and energy at the end, J,
    of each vibration of the target; None if it does not vibrate, or its vibrations are unknown. friction: time, s, the
    friction force and its limit, N; None without friction. sensed: acceleration of each sensor at the samples, m/s².
    """

    title: str
    law: str
    stages: tuple[str, ...]
    samples: Samples
    end: float
    events: tuple[Event, ...]
    summary: Mapping[str, float | None]
    energies: Mapping[str, Any]
    spectrum: tuple[Any, Any] | None = None
    friction: tuple[Any, Any, Any] | None = None
    sensed: Mapping[str, Any] = field(default_factory=dict[str, Any])

    @classmethod
    def of(cls, history: History) -> Trace:
        """The whole contact at evenly spaced times and at all events."""
        scene, vibration = history.scene, history.vibration
        # enough for lines without visible corners in print
        times = [np.linspace(0.0, history.duration, 1001), [event.time for event in history.events]]
        # so many steps in contact are sampled at their beginning and middle, too
        if vibration is not None and len(vibration.segments) <= 5000:
            begin, step = (vibration.segments[name] for name in ("time", "h"))
            times += [begin, (begin + 0.5 * step)[step < np.inf]]
        samples = history.sample_si(np.unique(np.concatenate(times)))
        found = {name: e for name, e in energies(history, samples).items() if e.max() > 1e-6 * scene.kinetic_energy}
        title = scene.title or f"Impact on a {scene.target.kind}"
        law, stages = history.problem.law.name, tuple(history.problem.curve.stage_names)
        spectrum = None
        if vibration is not None:
            spectrum = vibration.frequency / (2.0 * math.pi), history.vibration_energy_by_mode
            if "target" in found and not vibration.damped and vibration.frequency[0] > 0.0:
                found["vibrations"] = found.pop("target")
        seen = samples, history.duration, history.events, history.summary, found, spectrum
        sensed = dict[str, Any]()
        if vibration is not None and scene.target.sensors:
            motion = history.sensed_si(samples.time)
            sensed = dict(zip(motion.names, motion.acceleration, strict=True))
        return cls(title, law, stages, *seen, friction_over_time(history), sensed)


def plot_history(history: History | Trace, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """The whole contact, coloured by the stage of the law. Files, errors and dpi: see `style.picture`."""
    trace = history if isinstance(history, Trace) else Trace.of(history)
    return picture(path, lambda figure: _draw(figure, trace), SIZE, dpi)


def _draw(figure: Figure, trace: Trace) -> None:
    rows, columns = figure.add_gridspec(
        1, 2, width_ratios=(1.35, 1.0), left=LEFT, right=0.985, bottom=0.135, top=0.83, wspace=0.2
    )
    over_time: list[tuple[Callable[..., None], tuple[Any, ...]]] = []
    over_time += [(_energies, (trace,))] if trace.energies else []
    over_time += [] if trace.friction is None else [(_friction, trace.friction)]
    over_time += [(_sensors, (trace,))] if trace.sensed else []
    below = len(over_time) + int(trace.spectrum is not None)
    grid, beside = (
        rows.subgridspec(3, 1, hspace=0.12),
        columns.subgridspec(1 + below, 1, hspace=(0.0, 0.34, 0.62, 0.9, 1.2)[below]),
    )
    samples = trace.samples
    force = figure.add_subplot(grid[0])
    depth = figure.add_subplot(grid[1], sharex=force)
    speed = figure.add_subplot(grid[2], sharex=force)
    loop = figure.add_subplot(beside[0])
    panels = [force, depth, speed]
    moved = float(np.abs(samples.target_velocity).max()) > 1e-9 * float(np.abs(samples.impactor_velocity).max())
    shown = list(VELOCITIES) if moved else ["impactor_velocity"]
    shown = shown if trace.spectrum is None else list(DISPLACEMENTS)
    _curves(force, trace, "time", ["contact_force"])
    _curves(depth, trace, "time", ["indentation"])
    _curves(speed, trace, "time", shown)
    _curves(loop, trace, "indentation", ["contact_force"])
    for panel, name in ((force, "contact_force"), (depth, "indentation")):
        panel.tick_params(labelbottom=False)
        panel.set(xlabel="", ylim=_reach(trace, name))
    for k, (draw, values) in enumerate(over_time):
        panels.append(figure.add_subplot(beside[1 + k], sharex=force))
        draw(panels[-1], *values)
    beneath = panels[3:]
    if trace.spectrum is not None:
        beneath = [*beneath, figure.add_subplot(beside[below])]
        _spectrum(beneath[-1], *trace.spectrum)
    speed.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    force.set_xlim(0.0, trace.end / _unit(samples.time, "time")[0] * 1.01)
    loop.set(xlim=_reach(trace, "indentation"), ylim=_reach(trace, "contact_force"))
    loop.set_title(plain(f"contact law: {trace.law}"), loc="right", fontsize=8)
    _mark_events(panels, trace)
    _key(figure, trace, shown)
    figure.align_ylabels(panels[:3])
    figure.align_ylabels([loop, *beneath])
    title = " ".join(trace.title.split())
    size = min(12.0, 900.0 / len(title))  # letters of 12 points: some 75 fit
    figure.text(LEFT, 0.967, plain(title), fontsize=size, fontweight="bold")
    for height, names in ((0.936, NUMBERS), (0.912, STRESSES)):
        figure.text(LEFT, height, _numbers(trace, names), fontsize=8, color="0.25")


def _reach(trace: Trace, name: str) -> tuple[float, float | None]:
    """Limits of an axis that shows a quantity in contact: from 0, or from below where a law pulls."""
    values = getattr(trace.samples, name)
    size, found = _unit(values, name)[0], values[trace.samples.stage != ""]
    low, high = (float(end(found, initial=0.0)) / size for end in (np.min, np.max))
    room = 0.05 * (high - low)
    return (low - room if low < -1e-6 * high else 0.0), (high + room or None)


def _curves(panel: Axes, trace: Trace, across: str, names: list[str]) -> None:
    """Quantities `names` over `across`, one line per stage."""
    samples = trace.samples
    x_size, x_unit = _unit(getattr(samples, across), across)
    size, unit = _unit(np.stack([getattr(samples, name) for name in names]), names[0])
    for name in names:
        for stage, run in _runs(samples.stage):
            x, y = getattr(samples, across)[run] / x_size, getattr(samples, name)[run] / size
            panel.plot(x, y, LINES.get(name, "-"), color=_colour(trace, stage), solid_capstyle="round")
    what = names[0].rpartition("_")[2] if len(names) > 1 else names[0].replace("_", " ")
    panel.set(xlabel=f"{across} ({x_unit})", ylabel=f"{what} ({unit})")


def energies(history: History, samples: Samples) -> dict[str, Any]:
    """Energies at the samples, J: of the impactor's motion, of the contact, and transferred to the target.

    The work of the contact force is integrated by the trapezoidal rule.
    """
    target, own = history.scene.target, samples.target_velocity
    mass = target.own_mass if target.free else None
    return {
        "impactor": 0.5 * history.scene.mass * samples.impactor_velocity**2,
        "contact": _work(samples.contact_force, samples.indentation),
        "target": _work(samples.contact_force, samples.target_displacement) if mass is None else 0.5 * mass * own**2,
    }


def friction_over_time(history: History) -> tuple[Any, Any, Any] | None:
    """Time, s, friction force and its limit µF, N; None without friction."""
    if history.oblique is None:
        return None
    t, force = (history.oblique.motion[name] for name in ("time", "friction_force"))
    mu = history.scene.contact.friction or 0.0
    if isinstance(mu, FrictionTable):
        mu = mu.at(abs(history.oblique.motion["sliding_velocity"]))
    return t, force, mu * history.sample_si(t).contact_force


def _work(force: Any, displacement: Any) -> Any:
    return np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(displacement))])


def _energies(panel: Axes, trace: Trace) -> None:
    """Energies over time."""
    x_size, x_unit = _unit(trace.samples.time, "time")
    size, unit = _unit(np.stack(list(trace.energies.values())), "energy")
    for (name, values), line in zip(trace.energies.items(), ("-", "--", ":"), strict=False):
        panel.plot(trace.samples.time / x_size, values / size, line, color="0.2", label=name)
    panel.set(xlabel=f"time ({x_unit})", ylabel=f"energy ({unit})")
    least = min(float(values.min()) for values in trace.energies.values()) / size
    if least > -1e-3 * panel.get_ylim()[1]:
        panel.set_ylim(0.0, None)
    panel.legend(**ABOVE)


def _friction(panel: Axes, time: Any, force: Any, limit: Any) -> None:
    """The friction force over time between its limits, ± µ times the contact force."""
    (x_size, x_unit), (size, unit) = prefixed_unit(time, "time"), prefixed_unit(limit, "force")
    panel.fill_between(time / x_size, -limit / size, limit / size, color="0.9", linewidth=0.0, label="up to µF")
    panel.plot(time / x_size, force / size, color=HIGHLIGHT, label="friction")
    panel.set(xlabel=f"time ({x_unit})", ylabel=f"friction ({unit})")
    panel.legend(**ABOVE)


def _sensors(panel: Axes, trace: Trace) -> None:
    """The acceleration of each sensor over time."""
    x_size, x_unit = _unit(trace.samples.time, "time")
    size, unit = prefixed_unit(np.stack(list(trace.sensed.values())), "acceleration")
    for k, (name, values) in enumerate(trace.sensed.items()):
        panel.plot(trace.samples.time / x_size, values / size, color=COLOURS[k % len(COLOURS)], label=plain(name))
    panel.set(xlabel=f"time ({x_unit})", ylabel=f"sensors ({unit.replace('^2', '²')})")
    if len(trace.sensed) <= 6:
        panel.legend(**ABOVE)


def _spectrum(panel: Axes, frequency: Any, energy: Any) -> None:
    """The energy of each vibration at the end over its frequency; of a motion as a whole, in words."""
    whole, total = float(energy[frequency == 0.0].sum()), float(energy.sum())
    bends = (frequency > 0.0) & (energy > 1e-6 * energy.max(initial=0.0))
    frequency, energy = frequency[bends], energy[bends]
    size, unit = prefixed_unit(energy, "energy")
    panel.set(xscale="log", yscale="log", xlabel="frequency (kHz)", ylabel=f"energy ({unit})")
    if frequency.size:
        # the axis of energy has powers of ten
        least = min(0.5 * float(energy.min()), float(energy.max()) / 20.0) / size
        if frequency.size == 1:
            panel.set_xlim(*(factor * float(frequency[0]) / 1e3 for factor in (0.1, 10.0)))
        panel.vlines(frequency / 1e3, least, energy / size, color=COLOURS[0], linewidth=0.8)
        panel.plot(frequency / 1e3, energy / size, ".", color=COLOURS[0], markersize=3.0)
        panel.set_ylim(least, None)
    said = f"vibrations at the end: {format_si(total - whole, 'energy')}"
    said += f"; motion as a whole: {format_si(whole, 'energy')}" if whole else ""
    panel.set_title(said, loc="right", fontsize=8)


def _runs(stages: Any) -> Iterator[tuple[str, slice]]:
    """Each stage with its samples and the first of the next stage, so that the lines join."""
    starts = [0, *(np.flatnonzero(stages[1:] != stages[:-1]) + 1).tolist(), len(stages)]
    for first, after in itertools.pairwise(starts):
        if after - first > 1 or after < len(stages):
            yield str(stages[first]), slice(first, after + 1)


def _mark_events(panels: list[Axes], trace: Trace) -> None:
    """A thin line at every event after first touch, with a label above the first panel if there is room."""
    letter = 4.4  # width of a letter in points; a label without room is omitted
    top, size = panels[0], _unit(trace.samples.time, "time")[0]
    width, height = top.get_position().width * SIZE[0] * 72.0, top.get_position().height * SIZE[1] * 72.0  # points
    span, ends = top.get_xlim()[1], [-math.inf] * 3
    thin: dict[str, Any] = {"color": "0.55", "linewidth": 0.5}
    labels: dict[str, float] = {}  # of the first event of a kind
    contacts = ("contact_begins", "contact_ends")
    few = len(trace.events) <= 12  # of more events only those at which contact begins and ends are marked
    for event in (event for event in trace.events[1:] if few or event.name in contacts):
        labels.setdefault(LABELS.get(event.name, event.name).format(stage=event.stage), event.time / size)
        for panel in panels:
            panel.axvline(event.time / size, zorder=0, **thin)
    for t in dict.fromkeys(labels.values()):
        text = ", ".join(label for label, time in labels.items() if time == t)
        half, at = 0.5 * letter * len(text), t / span * width
        middle = min(max(at, half), width - half)
        row = next((k for k, end in enumerate(ends) if middle - half > end), None)
        if row is not None:
            ends[row] = middle + half + letter
            top.axvline(t, 1.0, 1.0 + 10.0 * row / height, clip_on=False, zorder=0, **thin)
            note = top.annotate(
                plain(text), (t, 1.0), (middle - at, 3.0 + 10.0 * row), top.get_xaxis_transform(), "offset points"
            )
            note.set(ha="center", fontsize=8, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})


def _key(figure: Figure, trace: Trace, names: list[str]) -> None:
    """The legend below the panels: colours of the stages, and line styles of the quantities that share a panel."""
    from matplotlib.lines import Line2D

    keys = [
        Line2D([], [], color=_colour(trace, stage), linewidth=3, label=plain(stage or "no contact"))
        for stage in dict.fromkeys(stage for stage, _ in _runs(trace.samples.stage))
    ]
    for name in names if len(names) > 1 else []:
        keys.append(Line2D([], [], ls=LINES[name], color="0.2", label=name.replace("_", " ")))
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (LEFT - 0.012, 0.078), "ncols": min(len(keys), 5)}
    figure.legend(handles=keys, **place, frameon=False, fontsize=8)


def _numbers(trace: Trace, names: Mapping[str, str]) -> str:
    """Numbers on one line; zeros and missing values are omitted."""
    values = ((word, trace.summary.get(name), SUMMARY[name][0]) for name, word in names.items())
    return "  ·  ".join(f"{word} {format_si(value, kind)}" for word, value, kind in values if value).replace("-", "−")


def _unit(values: Any, name: str) -> tuple[float, str]:
    """Size in SI and symbol of the unit for a quantity of the motion."""
    return prefixed_unit(values, name if name in ("time", "energy") else MOTION[name][0])


def _colour(trace: Trace, stage: str) -> str:
    if stage in trace.stages:
        return COLOURS[trace.stages.index(stage) % len(COLOURS)]
    return UNLOADING if stage else NO_CONTACT
