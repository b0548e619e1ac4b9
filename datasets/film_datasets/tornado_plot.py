"""The tornado picture of a sweep: the swing of one result by each number that scatters."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from film_datasets.axis_style import label, plain
from film_datasets.sweeps.definition import Sweep
from film_datasets.tolerances.analysis import Tolerance
from film_datasets.tolerances.one_at_a_time import HIGH, LOW, Swing, one_at_a_time
from film_model.base.foreign import Figure
from film_model.base.units import format_si
from film_model.plot.style import COLOURS, picture, prefixed_unit
from film_model.solve.derivatives import RESULTS


def plot_tornado(
    found: Tolerance, path: str | os.PathLike[str] | None = None, quantity: str | None = None, dpi: float = 200.0
) -> Figure:
    """The tornado picture of a tolerance analysis, written to `path` if given. quantity: the first unless given.

    Raises ValueError for a quantity without a value at the medians, ImportError without matplotlib.

    >>> found = fd.tolerance(scene, {"impactor.radius": "10 mm ± 1 %", "impactor.velocity": "1 m/s ± 2 %"}, samples=64)
    >>> figure = fd.plot_tornado(found, "tornado.png")
    """
    return picture(path, draw_tornado(found.sweep, quantity or next(iter(found.spreads))), (7.2, 4.0), dpi)


def draw_tornado(sweep: Sweep, quantity: str) -> Callable[[Figure], None]:
    """A function that draws the picture into a figure. Raises as :func:`one_at_a_time`."""
    swings = one_at_a_time(sweep, quantity)
    units = {axis.path: axis.dimension for axis in sweep.axes}
    return lambda figure: _fill(figure, sweep, quantity, swings[:20], units)


def _fill(figure: Figure, sweep: Sweep, quantity: str, swings: Sequence[Swing], units: dict[str, str]) -> None:
    figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.08)
    panel = figure.add_subplot()
    size, unit = prefixed_unit([v for s in swings for v in (s.at_low, s.at_high)], RESULTS[quantity][0])
    middle = swings[0].median / size
    for place, swing in enumerate(swings):
        for end, value, colour in ((swing.low, swing.at_low, COLOURS[0]), (swing.high, swing.at_high, COLOURS[1])):
            length = value / size - middle
            panel.barh(place, length, left=middle, color=colour, height=0.6, hatch="" if colour == COLOURS[0] else "//")
            side = "left" if length >= 0.0 else "right"
            gap = 4 if length >= 0.0 else -4
            text = format_si(end, units[swing.path], 4)
            panel.annotate(
                text, (middle + length, place), (gap, 0), textcoords="offset points", ha=side, va="center", fontsize=7
            )
    panel.axvline(middle, color="0.3", linewidth=0.8)
    panel.set_yticks(range(len(swings)), [plain(swing.path).replace(".", " ") for swing in swings])
    panel.invert_yaxis()
    panel.margins(x=0.24)
    panel.set_xlabel(label(quantity, unit))
    figure.suptitle((sweep.scene.title or "Impact").replace("$", r"\$"), fontsize=11, fontweight="bold")
    ends = f"each number at its {100 * LOW:g} % and {100 * HIGH:g} % quantile, the others at their medians"
    ends += ", given it by the correlations" if sweep.correlation else ""
    panel.set_title(ends, fontsize=8)
