"""Figures: of an impact, force, indentation, velocities and energies over time; of the contact laws, their loops."""

from __future__ import annotations

import io
import itertools
import math
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from film_model.bodies import Body
from film_model.effects import percent
from film_model.files import written_whole
from film_model.history import MOTION, SUMMARY, Event, History, Samples
from film_model.laws.big_alabo import FULLY_PLASTIC
from film_model.regimes import Regimes, regimes
from film_model.scene import Scene
from film_model.units import PREFIXED, format_si, scene_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg", ".pdf")

SAMPLES = 1001  # even samples over the contact: a printed line shows no corner

COLOURS = ("#3f90da", "#ffa90e", "#bd1f01", "#832db6", "#a96b59", "#e76300", "#b9ac70", "#717581", "#92dadd")
UNLOADING = "#94a4a2"
"""Petroff's ten colours (arXiv:2107.02270), safe for the colour-blind: the law's stages, and the unloading branch."""

LABELS = {
    "contact_begins": "contact again",
    "stage_changes": "{stage} begins",
    "maximum_indentation": "deepest",
    "impactor_stops": "impactor stops",
    "reloading_begins": "reloading",
    "contact_ends": "contact ends",
}

LABEL_ROWS, LETTER = 3, 4.4
"""Rows of event labels above the panels (what fits in none has its line only), and points a letter at most takes."""

NUMBERS = {
    **{"maximum_force": "peak force", "maximum_indentation": "peak indentation", "contact_duration": "contact"},
    **{"permanent_indentation": "dent", "rebound_velocity": "rebound", "coefficient_of_restitution": "restitution"},
}

VELOCITIES = {"impactor_velocity": "-", "target_velocity": "--", "relative_velocity": ":"}

SIZE, LEFT = (9.0, 8.2), 0.085  # inches; part of the width left of the panels
MAP_SIZE, LAWS_SIZE = (7.6, 5.4), (13.0, 7.4)
_STYLE: dict[Any, Any] = {
    **{"font.size": 9.0, "lines.linewidth": 1.6, "svg.hashsalt": "film-model", "hatch.linewidth": 0.5},
    **{"axes.spines.top": False, "axes.spines.right": False, "xtick.direction": "in", "ytick.direction": "in"},
}
FAMILIES = ("elastic", "sphere that yields", "spring", "laminate, table", "damped")
_SPACING = {"left": 0.058, "right": 0.985, "bottom": 0.085, "top": 0.905, "hspace": 0.24, "wspace": 0.1}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


@dataclass(frozen=True)
class Trace:
    """An impact as it is drawn. stages: names of the law's, in their order. samples: SI, from first touch to `end` [s].

    energies: J at the samples, by name; none where they are not known.
    """

    title: str
    law: str
    stages: tuple[str, ...]
    samples: Samples
    end: float
    events: tuple[Event, ...]
    summary: Mapping[str, float | None]
    energies: Mapping[str, Any]

    @classmethod
    def of(cls, history: History) -> Trace:
        """The whole contact, in even samples and at all events."""
        scene, events = history.scene, [event.time for event in history.events]
        samples = history.sample_si(np.union1d(np.linspace(0.0, history.duration, SAMPLES), events))
        found = {name: e for name, e in energies(history, samples).items() if e.max() > 1e-6 * scene.kinetic_energy}
        title = scene.title or f"Impact on a {scene.target.kind}"
        law, stages = history.problem.law.name, tuple(history.problem.curve.stage_names)
        return cls(title, law, stages, samples, history.duration, history.events, history.summary, found)


def plot_history(history: History | Trace, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """A figure of the whole contact, coloured by the stage of the law; written to `path` (.png, .svg or .pdf) if given.

    The file is written beside its place and renamed; one that is there is replaced. dpi: of a PNG, dots an inch.
    pyplot is not used. Raises ValueError for another suffix, ImportError without matplotlib, OSError where the file
    cannot be written.
    """
    trace = history if isinstance(history, Trace) else Trace.of(history)
    return picture(path, lambda figure: _draw(figure, trace), SIZE, dpi)


def plot_regimes(scene: Scene, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """A map of regimes over Zener's λ and V/V_Y with the scene on it; written to `path` as `plot_history` does."""
    return picture(path, lambda figure: _draw_regimes(figure, scene, regimes(scene)), MAP_SIZE, dpi)


def _target(path: str | os.PathLike[str] | None) -> Path | None:
    """The path of the picture, refused with ValueError if its suffix is no picture's."""
    target = None if path is None else Path(path)
    if target is not None and target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{target}: the name of a picture must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    return target


def check_picture(path: str | os.PathLike[str]) -> None:
    """Before the work: ValueError if the suffix of `path` is no picture's, ImportError without matplotlib."""
    _target(path)
    _matplotlib()


def _matplotlib() -> tuple[Any, type[Figure]]:
    """The module and its figure, which need no pyplot."""
    try:
        import matplotlib
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError('plots need matplotlib: install film-model[plot] (pip install "film-model[plot]")') from error
    return matplotlib, Figure


def picture(
    path: str | os.PathLike[str] | None, draw: Callable[[Figure], None], size: tuple[float, float], dpi: float = 200.0
) -> Figure:
    """A figure of `size` [inches] in the style of this package, filled by `draw`; else as `plot_history`."""
    target = _target(path)
    matplotlib, figure_class = _matplotlib()
    with matplotlib.rc_context(_STYLE):
        figure = figure_class(figsize=size)
        draw(figure)
        if target is not None:
            _save(figure, target, dpi)
    return figure


def _draw(figure: Figure, trace: Trace) -> None:
    grid = figure.add_gridspec(
        4 if trace.energies else 3,
        2,
        **{"width_ratios": (1.6, 1.0), "left": LEFT, "right": 0.985, "bottom": 0.06, "top": 0.88},
        **{"hspace": 0.12, "wspace": 0.26},
    )
    samples = trace.samples
    force = figure.add_subplot(grid[0, 0])
    depth = figure.add_subplot(grid[1, 0], sharex=force)
    speed = figure.add_subplot(grid[2, 0], sharex=force)
    loop, key = figure.add_subplot(grid[:2, 1]), figure.add_subplot(grid[2:, 1])
    panels = [force, depth, speed]
    moved = float(np.abs(samples.target_velocity).max()) > 1e-9 * float(np.abs(samples.impactor_velocity).max())
    velocities = list(VELOCITIES) if moved else ["impactor_velocity"]
    _curves(force, trace, "time", ["contact_force"])
    _curves(depth, trace, "time", ["indentation"])
    _curves(speed, trace, "time", velocities)
    _curves(loop, trace, "indentation", ["contact_force"])
    if trace.energies:
        panels.append(figure.add_subplot(grid[3, 0], sharex=force))
        _energies(panels[3], trace)
    for panel in panels[:-1]:
        panel.tick_params(labelbottom=False)
        panel.set(xlabel="")
    for panel in (force, depth, *panels[3:]):
        panel.set_ylim(0.0, None)
    speed.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    force.set_xlim(0.0, trace.end / _unit(samples.time, "time")[0] * 1.01)
    loop.set(xlim=(0.0, None), ylim=(0.0, None))
    _mark_events(panels, trace)
    _key(key, trace, velocities)
    figure.align_ylabels(panels)
    title = " ".join(trace.title.split())
    size = min(12.0, 900.0 / len(title))  # letters of 12 points: some 75 fit
    figure.text(LEFT, 0.972, _plain(title), fontsize=size, fontweight="bold")
    figure.text(LEFT, 0.945, _numbers(trace), fontsize=8, color="0.25")


def _curves(panel: Axes, trace: Trace, across: str, names: list[str]) -> None:
    """Quantities `names` over `across`, one line a stage."""
    samples = trace.samples
    x_size, x_unit = _unit(getattr(samples, across), across)
    size, unit = _unit(np.stack([getattr(samples, name) for name in names]), names[0])
    for name in names:
        for stage, run in _runs(samples.stage):
            x, y = getattr(samples, across)[run] / x_size, getattr(samples, name)[run] / size
            panel.plot(x, y, VELOCITIES.get(name, "-"), color=_colour(trace, stage), solid_capstyle="round")
    what = "velocity" if len(names) > 1 else names[0].replace("_", " ")
    panel.set(xlabel=f"{across} ({x_unit})", ylabel=f"{what} ({unit})")


def energies(history: History, samples: Samples) -> dict[str, Any]:
    """Where the energy is at the samples, J: motion of the impactor, the contact, and what went into the target.

    The work of the contact force is summed by trapezoids between the samples.
    """
    target, own = history.scene.target, samples.target_velocity
    mass = target.own_mass if isinstance(target, Body) else None
    return {
        "impactor": 0.5 * history.scene.mass * samples.impactor_velocity**2,
        "contact": _summed(samples.contact_force, samples.indentation),
        "target": _summed(samples.contact_force, samples.target_displacement) if mass is None else 0.5 * mass * own**2,
    }


def _summed(force: Any, way: Any) -> Any:
    return np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(way))])


def _energies(panel: Axes, trace: Trace) -> None:
    """Energies over time, by name at their largest."""
    x_size, x_unit = _unit(trace.samples.time, "time")
    size, unit = _unit(np.stack(list(trace.energies.values())), "energy")
    for (name, values), line in zip(trace.energies.items(), ("-", "--", ":"), strict=False):
        panel.plot(trace.samples.time / x_size, values / size, line, color="0.2", label=name)
    panel.set(xlabel=f"time ({x_unit})", ylabel=f"energy ({unit})")
    panel.legend(loc="center right", fontsize=8, frameon=False)


def _runs(stages: Any) -> Iterator[tuple[str, slice]]:
    """Each stage with the samples in it and the first one after it, so that the lines join."""
    starts = [0, *(np.flatnonzero(stages[1:] != stages[:-1]) + 1).tolist(), len(stages)]
    for first, after in itertools.pairwise(starts):
        if after - first > 1 or after < len(stages):
            yield str(stages[first]), slice(first, after + 1)


def _mark_events(panels: list[Axes], trace: Trace) -> None:
    """A thin line at every event after first touch, and its label above the first panel where there is room."""
    top, size = panels[0], _unit(trace.samples.time, "time")[0]
    width, height = top.get_position().width * SIZE[0] * 72.0, top.get_position().height * SIZE[1] * 72.0  # points
    span, ends = top.get_xlim()[1], [-math.inf] * LABEL_ROWS
    thin: dict[str, Any] = {"color": "0.55", "linewidth": 0.5}
    labels: dict[str, float] = {}  # of the first event of a kind
    for event in trace.events[1:]:
        labels.setdefault(LABELS.get(event.name, event.name).format(stage=event.stage), event.time / size)
        for panel in panels:
            panel.axvline(event.time / size, zorder=0, **thin)
    for t in dict.fromkeys(labels.values()):
        text = ", ".join(label for label, time in labels.items() if time == t)
        half, at = 0.5 * LETTER * len(text), t / span * width
        middle = min(max(at, half), width - half)
        row = next((k for k, end in enumerate(ends) if middle - half > end), None)
        if row is not None:
            ends[row] = middle + half + LETTER
            top.axvline(t, 1.0, 1.0 + 10.0 * row / height, clip_on=False, zorder=0, **thin)
            note = top.annotate(
                _plain(text), (t, 1.0), (middle - at, 3.0 + 10.0 * row), top.get_xaxis_transform(), "offset points"
            )
            note.set(ha="center", fontsize=8, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})


def _key(panel: Axes, trace: Trace, velocities: list[str]) -> None:
    """The legend: colours of the stages, and strokes of the velocities."""
    panel.set_axis_off()
    for stage in dict.fromkeys(stage for stage, _ in _runs(trace.samples.stage)):
        panel.plot([], [], color=_colour(trace, stage), linewidth=3, label=_plain(stage or "no contact"))
    for name in velocities if len(velocities) > 1 else []:
        panel.plot([], [], VELOCITIES[name], color="0.2", label=name.replace("_", " "))
    law = _plain(f"contact law: {trace.law}")
    panel.legend(loc="upper left", bbox_to_anchor=(-0.02, 0.85), frameon=False, title=law, alignment="left")


def _numbers(trace: Trace) -> str:
    """The main numbers on one line, without what did not happen."""
    values = ((word, trace.summary[name], SUMMARY[name][0]) for name, word in NUMBERS.items())
    return "  ·  ".join(f"{word} {format_si(value, kind)}" for word, value, kind in values if value).replace("-", "−")


def _unit(values: Any, name: str) -> tuple[float, str]:
    """Size in SI and symbol of the unit in which `values` are drawn: the SI unit with an engineering prefix."""
    return prefixed_unit(values, name if name in ("time", "energy") else MOTION[name][0])


def prefixed_unit(values: Any, dimension: str) -> tuple[float, str]:
    """Size in SI and symbol of the unit for values [SI] of a dimension, of which the largest is to be read easily."""
    largest = float(np.abs(values).max(initial=0.0))
    if dimension not in (*PREFIXED, "velocity"):
        return 1.0, scene_unit(dimension)
    # 0.25 m/s, but 250 nm
    power = 0 if largest == 0.0 else math.floor((math.log10(largest) + (dimension == "velocity")) / 3) * 3
    power = min(max(power, min(_PREFIXES)), max(_PREFIXES))
    return 10.0**power, _PREFIXES[power] + scene_unit(dimension)


def _colour(trace: Trace, stage: str) -> str:
    return COLOURS[trace.stages.index(stage) % len(COLOURS)] if stage in trace.stages else UNLOADING


def _plain(text: str) -> str:
    """A text that matplotlib does not take for mathematics."""
    return text.replace("$", r"\$")


_REGIMES: dict[str, tuple[str, str | None]] = {
    "half-space": ("#e4eaef", None),
    "moving": ("#a9cbe6", None),
    "reflections": ("#ffdca8", ".."),
    "quasi-static": ("#e0ad94", "//"),
}
"""Colours and hatches of the target's regimes: told apart without colour too."""

_RATIO = r"$V_0/V_\mathrm{Y}$"


def _draw_regimes(figure: Figure, scene: Scene, found: Regimes) -> None:
    from matplotlib.patches import Patch

    panel = figure.add_axes((0.095, 0.235, 0.88, 0.635))
    tolerance, kind = scene.effect_tolerance, scene.target.kind
    across, up = np.meshgrid(found.lambdas, found.ratios)
    panel.set_facecolor(_REGIMES["moving"][0])
    keys: list[Any] = []

    def fill(field: Any, low: float, high: float, name: str, word: str) -> None:
        colour, hatch = _REGIMES[name]
        inside = (field >= low) & (field <= high)
        if inside.any():
            area = panel.contourf(across, up, field, [low, high], colors=[colour], hatches=[hatch])
            area.set(edgecolor="0.6", linewidth=0.0)  # the hatch's
        keys.append(Patch(facecolor=colour, hatch=hatch, edgecolor="0.55", linewidth=0.6, label=word))

    fill(
        found.motion, -1.0, tolerance, "half-space", f"half-space: target motion changes less than {percent(tolerance)}"
    )
    infinite = "infinite rod" if kind == "rod" else "infinite plate"
    keys.append(Patch(facecolor=_REGIMES["moving"][0], edgecolor="0.55", linewidth=0.6, label=infinite))
    if kind == "rod" and found.rests is not None:
        fill(found.rests, 1.0, math.inf, "reflections", "finite rod: the wave is back before contact ends")
    elif found.reflections is not None and found.rests is not None:
        word = f"finite plate: its edges change more than {percent(tolerance)}"
        fill(found.reflections, tolerance, math.inf, "reflections", word)
        fill(found.rests, 1.0, math.inf, "quasi-static", "quasi-static: contact longer than the plate's period")
    panel.contourf(across, up, found.motion, [-1.0, tolerance], colors=[_REGIMES["half-space"][0]])  # above the others
    left, white = found.lambdas[0] * 1.25, {"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 1.0}
    for level, stroke, above in ((1.0, "-", "elastoplastic"), (FULLY_PLASTIC, "--", "fully plastic")):
        panel.contour(across, up, found.depth, [level], colors="0.15", linewidths=1.4, linestyles=stroke)
        edge = float(np.interp(level, found.depth[:, 0], found.ratios))
        panel.text(left, edge * 1.2, above, va="bottom", color="0.15", bbox=white)
        if level == 1.0:
            panel.text(left, edge / 1.2, "elastic", va="top", color="0.15", bbox=white)
    where = _mark_scene(panel, found)
    keys += panel.get_legend_handles_labels()[0]
    panel.set(xscale="log", yscale="log", xlim=found.lambdas[[0, -1]], ylim=found.ratios[[0, -1]])
    panel.set(xlabel="Zener's inelasticity number λ", ylabel=f"approach velocity over yield velocity {_RATIO}")
    figure.legend(handles=keys, loc="lower left", bbox_to_anchor=(0.085, 0.005), ncols=2, frameon=False, fontsize=8)
    title = " ".join(scene.title.split()) or f"Impact on a {kind}"
    figure.text(0.095, 0.945, _plain(title), fontsize=min(12.0, 760.0 / len(title)), fontweight="bold")
    figure.text(0.095, 0.905, f"{where}  ·  boundaries by Big-Alabo's law", fontsize=8, color="0.25")


def _mark_scene(panel: Axes, found: Regimes) -> str:
    """The scene on its map: a point, or a line where one of its numbers is not known; and that in words."""
    style: dict[str, Any] = {"color": COLOURS[2], "zorder": 5}
    value, ratio = found.value, found.ratio
    if value is not None and ratio is not None:
        at = np.clip(value, *found.lambdas[[0, -1]]), np.clip(ratio, *found.ratios[[0, -1]])
        label = "this scene" if at == (value, ratio) else "this scene, beyond the map"
        panel.plot(*at, "o", markersize=9, markeredgecolor="white", clip_on=False, label=label, **style)
        return f"λ = {value:.3g}, {_RATIO} = {ratio:.3g}"
    if value is not None:
        panel.axvline(value, linewidth=1.8, label="this scene, yield velocity not known", **style)
        return f"λ = {value:.3g}, {_RATIO} not known"
    if ratio is not None:
        panel.plot(found.lambdas[0], ratio, "<", markersize=11, clip_on=False, label="this scene, λ = 0", **style)
        return f"λ = 0, {_RATIO} = {ratio:.3g}"
    panel.plot([], [], " ", label="this scene has neither λ nor a yield velocity")
    return "neither number is known"


def _save(figure: Figure, target: Path, dpi: float) -> None:
    """Write the picture whole or not at all, the same picture with the same bytes."""
    kind = target.suffix[1:].lower()
    picture, undated = io.BytesIO(), {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    figure.savefig(picture, format=kind, dpi=dpi, metadata=undated.get(kind))
    with written_whole(target) as beside:
        beside.write_bytes(picture.getbuffer())


def plot_laws(path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """The contact laws side by side: force over indentation of the same impact, in and out, each before all others.

    Indentation and force are those of the ball of `law_family`, over what Hertz's law gives it. Files, errors and dpi:
    as for `plot_history`.
    """
    return picture(path, _draw_laws, LAWS_SIZE, dpi)


def _draw_laws(figure: Figure) -> None:
    from film_model.law_family import VELOCITY_RATIO, family_loops

    loops = family_loops()
    depth, force = (float(values.max()) for values in loops["hertz"].curve)
    columns = 6
    rows = math.ceil((len(loops) + 1) / columns)  # the last cells hold the key
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False, gridspec_kw=_SPACING)
    flat = list(panels.flat)
    for panel, (name, loop) in zip(flat, loops.items(), strict=False):
        for other in loops.values():
            panel.plot(other.curve[0] / depth, other.curve[1] / force, color="0.88", linewidth=0.7, zorder=1)
        panel.plot(loops["hertz"].curve[0] / depth, loops["hertz"].curve[1] / force, ":", color="0.35", linewidth=1.0)
        x, y = loop.curve[0] / depth, loop.curve[1] / force
        turn, colour = loop.turn, COLOURS[FAMILIES.index(loop.family)]
        panel.fill([0.0, *x], [0.0, *y], color=colour, alpha=0.15, linewidth=0.0, zorder=2)
        panel.plot(x[: turn + 1], y[: turn + 1], color=colour, linewidth=1.8, zorder=4)
        panel.plot(x[turn:], y[turn:], "--", color=colour, linewidth=1.4, zorder=3)
        panel.set_title(name, fontsize=10, loc="left", pad=3.0)
        panel.text(0.04, 0.93, f"e = {loop.restitution:.2f}", transform=panel.transAxes, va="top", fontsize=9)
        panel.set(xlim=(0.0, None), ylim=(0.0, None))
    for panel in flat[len(loops) :]:
        panel.set_axis_off()
    for panel in flat[max(len(loops) - columns, 0) : len(loops)]:
        panel.tick_params(labelbottom=True)
    figure.supxlabel("indentation over that of Hertz's law", fontsize=10, y=0.012)
    figure.supylabel("contact force over that of Hertz's law", fontsize=10, x=0.012)
    figure.text(0.058, 0.965, "Contact laws", fontsize=13, fontweight="bold")
    what = f"a steel ball on steel at {VELOCITY_RATIO:g} yield velocities; springs, laminate and table by example"
    figure.text(0.165, 0.966, what, fontsize=9, color="0.25")
    key = flat[len(loops)]
    for family, colour in zip(FAMILIES, COLOURS, strict=False):
        key.plot([], [], color=colour, linewidth=3, label=family)
    key.plot([], [], color="0.3", linewidth=1.8, label="loading")
    key.plot([], [], "--", color="0.3", linewidth=1.4, label="unloading")
    key.fill([], [], color="0.3", alpha=0.15, label="energy absorbed")
    key.plot([], [], ":", color="0.35", linewidth=1.0, label="Hertz")
    key.plot([], [], color="0.8", linewidth=0.7, label="all the other laws")
    key.legend(loc="upper left", bbox_to_anchor=(0.0, 1.0), frameon=False, fontsize=8.5, borderaxespad=0.0)
