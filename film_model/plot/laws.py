"""The contact laws side by side: force over indentation of one impact."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any

from film_model.base.foreign import Figure
from film_model.laws import LAWS
from film_model.laws.example_ball import VELOCITY_RATIO
from film_model.laws.law import FAMILIES
from film_model.plot.style import COLOURS, picture
from film_model.studies.law_gallery import Loop, gallery_loops

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLUMNS = 6
FAMILY_COLOURS = dict(zip(FAMILIES, COLOURS, strict=False))
_SPACING = {"left": 0.058, "right": 0.985, "bottom": 0.085, "top": 0.905, "hspace": 0.24, "wspace": 0.1}


def plot_laws(path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """Force over indentation of the gallery's impact, a panel per law with all other laws in grey behind it.

    Indentation and force are divided by the largest that Hertz's law gives. Files, errors and dpi: see `picture`.
    """
    rows = math.ceil((len(LAWS) + 1) / COLUMNS)  # a cell at least is left for the legend
    # inches: the width of the picture; title and axis labels, and the height of a row
    return picture(path, lambda figure: _draw(figure, rows), (13.0, 1.4 + 2.0 * rows), dpi)


def _draw(figure: Figure, rows: int) -> None:
    loops = gallery_loops()
    panels = figure.subplots(rows, COLUMNS, sharex=True, sharey=True, squeeze=False, gridspec_kw=_SPACING)
    flat = list(panels.flat)
    for panel, name in zip(flat, loops, strict=False):
        _panel(panel, name, loops)
    for panel in flat[len(loops) :]:
        panel.set_axis_off()
    for panel in flat[max(len(loops) - COLUMNS, 0) : len(loops)]:
        panel.tick_params(labelbottom=True)
    figure.supxlabel("indentation over that of Hertz's law", fontsize=10, y=0.012)
    figure.supylabel("contact force over that of Hertz's law", fontsize=10, x=0.012)
    figure.text(0.058, 0.965, "Contact laws", fontsize=13, fontweight="bold")
    what = f"a steel ball on steel at {VELOCITY_RATIO:g} yield velocities; springs, laminate and table by example"
    figure.text(0.165, 0.966, what, fontsize=9, color="0.25")
    _legend(flat[len(loops)])


def _panel(panel: Axes, name: str, loops: dict[str, Loop]) -> None:
    """The loop of one law in the colour of its family."""
    depth, force = (float(values.max()) for values in loops["hertz"].curve)
    for other in loops.values():
        panel.plot(other.curve[0] / depth, other.curve[1] / force, color="0.88", linewidth=0.7, zorder=1)
    panel.plot(loops["hertz"].curve[0] / depth, loops["hertz"].curve[1] / force, ":", color="0.35", linewidth=1.0)
    loop = loops[name]
    x, y = loop.curve[0] / depth, loop.curve[1] / force
    turn, colour = loop.turn, FAMILY_COLOURS[loop.family]
    panel.fill([0.0, *x], [0.0, *y], color=colour, alpha=0.15, linewidth=0.0, zorder=2)
    panel.plot(x[: turn + 1], y[: turn + 1], color=colour, linewidth=1.8, zorder=4)
    panel.plot(x[turn:], y[turn:], "--", color=colour, linewidth=1.4, zorder=3)
    panel.set_title(name, fontsize=10, loc="left", pad=3.0)
    panel.text(0.04, 0.93, f"e = {loop.restitution:.2f}", transform=panel.transAxes, va="top", fontsize=9)
    panel.set(xlim=(0.0, None), ylim=(0.0, None))


def _legend(key: Any) -> None:
    for family, heading in FAMILIES.items():
        key.plot([], [], color=FAMILY_COLOURS[family], linewidth=3, label=heading)
    key.plot([], [], color="0.3", linewidth=1.8, label="loading")
    key.plot([], [], "--", color="0.3", linewidth=1.4, label="unloading")
    key.fill([], [], color="0.3", alpha=0.15, label="energy absorbed")
    key.plot([], [], ":", color="0.35", linewidth=1.0, label="Hertz")
    key.plot([], [], color="0.8", linewidth=0.7, label="all other laws")
    key.legend(loc="upper left", bbox_to_anchor=(0.0, 1.0), frameon=False, fontsize=8.5, borderaxespad=0.0)
