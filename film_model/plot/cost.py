"""Work-precision diagrams: error against time."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from film_model.base.foreign import Figure
from film_model.plot.style import COLOURS, HIGHLIGHT, MARKERS, picture, plain
from film_model.studies.cost import Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OTHERS = tuple(colour for colour in COLOURS if colour != HIGHLIGHT)
"""Colours of the other methods; those of a second round are dashed, with hollow markers."""


def plot_study(study: Study, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """Largest error against time for every method, for a single impact and in a batch; the Pareto front is marked.

    Files, errors and dpi: see `film_model.plot.style.picture`.
    """
    panels = [(study, "time_single", "single impact, from Python"), (study, "time_batch", "in a batch")]
    title = " ".join(study.scene.title.split()) or f"Impact on a {study.scene.target.kind}"
    return _figure(panels, f"{title}: what accuracy costs", path, dpi)


def plot_studies(studies: Sequence[tuple[str, Study]], path: str | os.PathLike[str] | None = None) -> Figure:
    """Several studies side by side, each with its name; times of a single impact."""
    return _figure([(study, "time_single", name) for name, study in studies], "What accuracy costs", path)


def _figure(
    panels: Sequence[tuple[Study, str, str]], title: str, path: str | os.PathLike[str] | None, dpi: float = 200.0
) -> Figure:
    def draw(figure: Figure) -> None:
        figure.set_layout_engine("constrained")
        figure.suptitle(plain(title), fontsize=min(12.0, 900.0 / len(title)), fontweight="bold", x=0.01, ha="left")
        axes: Any = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        handles: dict[str, Any] = {}
        for panel, (study, timing, name) in zip(axes, panels, strict=True):
            _draw(panel, study, timing, handles)
            panel.set(xlabel="largest relative error of the summary")
            panel.set_title(name, fontsize=10)
        axes[0].set(ylabel="seconds per impact")
        figure.legend(handles.values(), handles.keys(), loc="outside right upper", frameon=False)

    return picture(path, draw, (1.5 + 4.2 * len(panels), 4.6), dpi)


def _draw(panel: Axes, study: Study, timing: str, handles: dict[str, Any]) -> None:
    least = 1e-15  # smaller errors are rounding and are drawn here
    names = list(dict.fromkeys(run.method for run in study.runs))
    for k, name in enumerate(names):
        runs = [run for run in study.runs if run.method == name and run.errors and getattr(run, timing) is not None]
        if not runs:
            continue
        ours = name == study.film
        x = [max(run.error, least) for run in runs]
        y = [getattr(run, timing).median for run in runs]
        second = k > len(OTHERS)
        style: dict[str, Any] = {
            "color": HIGHLIGHT if ours else OTHERS[(k - 1) % len(OTHERS)],
            "linewidth": 2.2 if ours else 1.0,
            "linestyle": "--" if second else "-",
            "markerfacecolor": "white" if second else None,
        }
        (line,) = panel.loglog(x, y, marker=MARKERS[k % len(MARKERS)], markersize=4, zorder=3 if ours else 2, **style)
        handles.setdefault(name, line)
    front = study.front(timing)
    if front:
        x, y = [max(run.error, least) for run in front], [getattr(run, timing).median for run in front]
        line = panel.scatter(x, y, s=70, facecolors="none", edgecolors="0.3", linewidths=0.8, zorder=4)
        handles.setdefault("Pareto-optimal", line)
    panel.grid(True, which="major", color="0.92", linewidth=0.6)
    panel.set_xlim(least / 3.0, 0.3)
