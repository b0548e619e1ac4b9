"""Work-precision diagrams of a study."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from film_model.plot import COLOURS, picture
from film_model.study import FILM, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKS = "osD^v<>Pp*hXd"
BEST = "#bd1f01"
OTHERS = tuple(colour for colour in COLOURS if colour != BEST)
LEAST = 1e-15  # errors below are drawn there: rounding


def plot_study(study: Study, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """Largest error against time for every method, one impact alone and in a batch; the Pareto front is marked.

    Written to `path` (.png, .svg or .pdf) if given. Raises ValueError for another suffix, ImportError without
    matplotlib.
    """
    return _figure([(study, "time_single", "one impact, from Python"), (study, "time_batch", "in a batch")], path, dpi)


def plot_studies(studies: Sequence[tuple[str, Study]], path: str | os.PathLike[str] | None = None) -> Figure:
    """Several studies side by side, one impact alone each; with their names."""
    return _figure([(study, "time_single", name) for name, study in studies], path)


def _figure(
    panels: Sequence[tuple[Study, str, str]], path: str | os.PathLike[str] | None, dpi: float = 200.0
) -> Figure:
    def draw(figure: Figure) -> None:
        figure.set_layout_engine("constrained")
        axes: Any = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        handles: dict[str, Any] = {}
        for panel, (study, timing, title) in zip(axes, panels, strict=True):
            _draw(panel, study, timing, handles)
            panel.set(title=title, xlabel="largest relative error")
        axes[0].set(ylabel="seconds an impact")
        figure.legend(handles.values(), handles.keys(), loc="outside right upper", frameon=False)

    return picture(path, draw, (1.5 + 4.2 * len(panels), 4.6), dpi)


def _draw(panel: Axes, study: Study, timing: str, handles: dict[str, Any]) -> None:
    names = list(dict.fromkeys(run.method for run in study.runs))
    for k, name in enumerate(names):
        runs = [run for run in study.runs if run.method == name and run.errors and getattr(run, timing) is not None]
        if not runs:
            continue
        ours = name == FILM[0]
        x = [max(run.error, LEAST) for run in runs]
        y = [getattr(run, timing).median for run in runs]
        style: dict[str, Any] = {"color": BEST if ours else OTHERS[k % len(OTHERS)], "linewidth": 2.2 if ours else 1.0}
        (line,) = panel.loglog(x, y, marker=MARKS[k % len(MARKS)], markersize=4, zorder=3 if ours else 2, **style)
        handles.setdefault(name, line)
    front = study.front(timing)
    if front:
        x, y = [max(run.error, LEAST) for run in front], [getattr(run, timing).median for run in front]
        line = panel.scatter(x, y, s=70, facecolors="none", edgecolors="0.3", linewidths=0.8, zorder=4)
        handles.setdefault("nothing better in both", line)
    panel.invert_xaxis()
    panel.grid(True, which="major", color="0.92", linewidth=0.6)
    panel.set_xlim(0.3, LEAST / 3.0)
