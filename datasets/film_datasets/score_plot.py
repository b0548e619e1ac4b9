"""Picture of a score: the errors of every quantity, one dot for each case."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from film_datasets.reference_impacts.score import Score, by_quantity
from film_model.plot.style import COLOURS, HIGHLIGHT, picture, plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEAST = 1e-16
"""Smaller errors are drawn here."""


def plot_scores(scores: list[Score], path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """The errors of each quantity on a logarithmic axis, one dot for each case, and their medians. Files, errors and dpi:
    see `picture`.

    >>> figure = fd.plot_scores(fd.score("results"), "score.png")
    """
    table = by_quantity(scores)
    return picture(path, lambda figure: _draw(figure, scores, list(table)), (7.2, 1.4 + 0.36 * len(table)), dpi)


def _draw(figure: Figure, scores: list[Score], names: list[str]) -> None:
    figure.set_layout_engine("constrained")
    panel = figure.add_subplot()
    table = by_quantity(scores)
    for place, name in enumerate(names):
        errors = [max(one.errors[name], LEAST) for one in scores if name in one.errors]
        panel.plot(errors, [place] * len(errors), "o", color=COLOURS[0], markersize=4, alpha=0.5)
        panel.plot(max(table[name]["median"], LEAST), place, "|", color=HIGHLIGHT, markersize=16, markeredgewidth=2)
    panel.set_xscale("log")
    panel.set_yticks(range(len(names)), [plain(name).replace("_", " ") for name in names])
    panel.invert_yaxis()
    panel.set_xlabel("relative error (dots: cases; bars: medians)")
    panel.grid(axis="x", color="0.9")
    panel.set_title(f"{len(scores)} reference impacts", fontsize=10)
