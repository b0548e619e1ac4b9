"""Axes of plots: values in readable units, labels, ticks, logarithmic scales and titles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.schema import dimension_of, flag_meanings, holds_text, swept_name, words_of
from film_model.base.foreign import DataArray, Dataset, Figure
from film_model.plot.style import COLOURS, prefixed_unit

MOST_POINTS = 20_000
"""Points along a line, thinned evenly, or in a scatter plot, drawn at random."""


def finite(array: DataArray) -> Any:
    """The finite values; [0] if there are none."""
    values = array.values[np.isfinite(array.values)]
    return values if values.size else np.zeros(1)


def thinned(size: int, most: int) -> slice:
    """A slice that leaves at most `most` of `size` values, evenly spaced."""
    return slice(None, None, max(1, -(-size // most)))


def some_of(size: int, most: int) -> NDArray[np.int64]:
    """Places of at most `most` of `size` impacts, increasing, drawn at random with a fixed seed: equal steps through a
    Sobol sequence or a flattened grid can meet one half of the values, or one column, only."""
    if size <= most:
        return np.arange(size)
    return np.sort(np.random.default_rng(0).choice(size, most, replace=False, shuffle=False))


def values_and_label(array: DataArray) -> tuple[Any, str]:
    """Values in a unit with a suitable prefix, and the label of their axis."""
    if holds_text(array):
        return np.arange(array.size), plain(str(array.name))
    if flag_meanings(array):
        return array.values, plain(str(array.name))
    size, unit = prefixed_unit(array.values, dimension_of(array))
    return array.values / size, label(str(array.name), unit)


def label(name: str, unit: str) -> str:
    """'contact force (kN)'."""
    return plain(name) + (f" ({unit})" if unit else "")


def plain(name: str) -> str:
    """A name with spaces, without `$`, which matplotlib reads as the start of a formula."""
    return name.replace("_", " ").replace("$", r"\$")


def format_axis(panel: Any, which: str, array: DataArray, scaled: DataArray | None = None) -> None:
    """Format the axis "x" or "y" of `array`: names as ticks, or a logarithmic scale with plain numbers.

    It is logarithmic if all values are > 0 and the largest is at least 30 times the smallest, 3 times in a geometric
    sequence; up to a ratio of 2000 it has labels at 1, 2 and 5 of each decade, beyond it at powers of ten.
    scaled: the values that decide this, those of `array` unless given.
    """
    axis = getattr(panel, f"{which}axis")
    meanings = words_of(array) if holds_text(array) else flag_meanings(array)
    if meanings:
        axis.set_ticks(range(len(meanings)), [plain(word) for word in meanings])
        return
    array = array if scaled is None else scaled
    values = np.asarray(array.values[:: max(1, array.size // MOST_POINTS)], np.float64)
    low, high = float(values.min()), float(values.max())
    if not (low > 0.0 and math.isfinite(high)):
        return
    steps = values[1:] / values[:-1]
    geometric = steps.size > 1 and high >= 3.0 * low and np.ptp(steps) <= 1e-6 * abs(steps[0])
    if geometric or high >= 30.0 * low:
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # lazy: an optional dependency

        getattr(panel, f"set_{which}scale")("log")
        if high <= 2000.0 * low:
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def worded(ds: Dataset, without: Sequence[str]) -> str | None:
    """The first swept quantity that has words, and is not one of `without`."""
    swept = map(swept_name, str(ds.attrs["swept"]).split())
    return next((name for name in swept if name not in without and ds[name].size > 1 and words_of(ds[name][:1])), None)


def draw_points(panel: Any, x: Any, y: Any, words: Sequence[str], title: str, **style: Any) -> None:
    """A point for each impact. words: of each, which has its own colour and entry in a legend; or none."""
    style = {**style, "rasterized": True}
    if not words:
        panel.plot(x, y, ".", color=COLOURS[0], **style)
        return
    each = np.array(words)
    for k, word in enumerate(dict.fromkeys(words)):
        panel.plot(x[each == word], y[each == word], ".", color=COLOURS[k % len(COLOURS)], label=plain(word), **style)
    add_legend(panel, title)


def add_legend(panel: Any, title: str) -> None:
    """A legend of the panel's curves or points: inside if it has 5 entries or fewer, else beside the panel."""
    handles, texts = panel.get_legend_handles_labels()
    many = len(texts) > 5
    keys: Any = panel.figure if many else panel
    where = {"loc": "outside right upper"} if many else {}
    legend = keys.legend(handles, texts, title=plain(title), frameon=False, fontsize=8, **where)
    for handle in legend.legend_handles:
        handle.set_alpha(1.0)


def set_title(figure: Figure, ds: Dataset, notes: Sequence[str] = ()) -> None:
    """The title of the dataset, and below it the notes."""
    title = str(ds.attrs["title"]).partition(": sweep over")[0]
    figure.suptitle(title.replace("$", r"\$"), fontsize=min(11.0, 620.0 / max(len(title), 1)), fontweight="bold")
    if notes:
        figure.axes[0].set_title("; ".join(notes).replace("$", r"\$"), fontsize=8)
