"""Picture of scores: the errors of every quantity, one dot for each case."""

from __future__ import annotations

import os
from collections.abc import Mapping

from film_datasets.reference_impacts.score import Score, by_quantity
from film_model.base.foreign import Figure
from film_model.plot.style import COLOURS, picture, plain


def plot_scores(
    scores: list[Score] | Mapping[str, list[Score]], path: str | os.PathLike[str] | None = None, dpi: float = 200.0
) -> Figure:
    """The errors of each quantity on a logarithmic axis, one dot for each case, and their medians; of several codes in
    rows below each other, by their names. Files, errors and dpi: see `picture`.

    >>> figure = fd.plot_scores(fd.score("hertz-half-space-0.4.csv"), "score.png")
    """
    codes = scores if isinstance(scores, Mapping) else {"": scores}
    names = list(dict.fromkeys(name for each in codes.values() for name in by_quantity(each)))
    return picture(path, lambda figure: _draw(figure, codes, names), (7.2, 1.4 + 0.36 * len(names)), dpi)


def _draw(figure: Figure, codes: Mapping[str, list[Score]], names: list[str]) -> None:
    least = 1e-16  # smaller errors are drawn here
    figure.set_layout_engine("constrained")
    panel = figure.add_subplot()
    for k, ((code, scores), colour) in enumerate(zip(codes.items(), COLOURS, strict=False)):
        table, below = by_quantity(scores), 0.2 * (k - 0.5 * (len(codes) - 1))
        errors = [[max(one.errors[name], least) for one in scores if name in one.errors] for name in names]
        points = [(error, place + below) for place, each in enumerate(errors) for error in each]
        medians = [(max(table[name]["median"], least), names.index(name) + below) for name in table]
        panel.plot(*zip(*points, strict=True), "o", color=colour, markersize=4, alpha=0.5, label=code or None)
        panel.plot(*zip(*medians, strict=True), "|", color=colour, markersize=14, markeredgewidth=2)
    panel.set_xscale("log")
    panel.set_yticks(range(len(names)), [plain(name).replace("_", " ") for name in names])
    panel.invert_yaxis()
    panel.set(xlabel="relative error (dots: cases; bars: medians)", ylabel="quantity")
    panel.grid(axis="x", color="0.9")
    if len(codes) > 1:
        figure.legend(loc="outside upper center", ncols=len(codes), frameon=False)
