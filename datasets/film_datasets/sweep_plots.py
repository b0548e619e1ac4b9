"""Plots of a sweep: a quantity as lines, a heat map or a scatter plot over one swept quantity or two."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.axis_style import (
    MOST_POINTS,
    add_legend,
    draw_points,
    finite,
    format_axis,
    label,
    plain,
    set_title,
    some_of,
    thinned,
    values_and_label,
    worded,
)
from film_datasets.distribution_plots import DEFAULT_QUANTITY
from film_datasets.provenance import warnings_of
from film_datasets.schema import dimension_of, has_failed, pieces, require_impacts, swept_name, words_of
from film_model.base.errors import did_you_mean, shown
from film_model.base.foreign import DataArray, Dataset, Figure
from film_model.base.units import to_si
from film_model.plot.style import COLOURS, prefixed_unit
from film_model.solve.history import SUMMARY

MOST_LINES = 9
"""A swept quantity of at most so many values gives a line for each value, with a legend."""

FEW_POINTS = 200
"""Up to so many points of a scatter plot are drawn large."""

LINE_STYLES = ("-", "--", ":", "-.")

COLOUR_MAP = "cividis"
"""Safe for the colour-blind, and of evenly increasing lightness."""


def draw_sweep(
    ds: Dataset, quantity: str | None, over: Sequence[str] | str | None, at: Mapping[str, Any] | None
) -> Callable[[Figure], None]:
    """A function that draws a sweep into a figure; for the arguments see `film_datasets.plot`."""
    require_impacts(ds)
    known = [name for name in (DEFAULT_QUANTITY, *SUMMARY, "zener_number") if name in ds]
    quantity = quantity or next(iter(known), DEFAULT_QUANTITY)
    if quantity not in known:
        hint = did_you_mean(quantity, known) or f"; there are {', '.join(known)}"
        raise ValueError(f"quantity: {shown(quantity)} is not a summary quantity of this dataset{hint}")
    if not any(np.isfinite(values).any() for values in pieces(ds[quantity])):
        return lambda figure: _say_why(figure, ds, quantity)
    swept = [swept_name(path) for path in str(ds.attrs["swept"]).split()]
    scalars = [name for name in swept if ds[name].ndim == 0]  # of a selection
    if scalars:
        ds = ds[[quantity, "status", *swept]].expand_dims(scalars)
    chosen = _chosen_axes(ds, swept, over)
    draw = _draw_scatter if "impact" in ds[quantity].dims else _draw_map if len(chosen) == 2 else _draw_lines

    def fill(figure: Figure) -> None:
        figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.08)
        draw(figure, ds, quantity, chosen, dict(at or {}))

    return fill


def _say_why(figure: Figure, ds: Dataset, quantity: str) -> None:
    """Instead of empty axes: that no impact has a value of the quantity, and the first warning of the sweep."""
    said = [f"No impact of this sweep has a value of {quantity.replace('_', ' ')}.", *warnings_of(ds)[:1]]
    lines = [textwrap.fill(line, 80).replace("$", r"\$") for line in said]
    figure.text(0.5, 0.5, "\n\n".join(lines), ha="center", va="center")
    set_title(figure, ds)


def _chosen_axes(ds: Dataset, swept: list[str], over: Sequence[str] | str | None) -> list[str]:
    """The swept quantities along the axes of the plot: `over`, or those with the most to show."""
    numbers = [name for name in swept if not words_of(ds[name]) and ds[name].size > 1]
    long = [name for name in numbers if ds[name].size > MOST_LINES]
    chosen = [over] if isinstance(over, str) else list(over or long[:2] or numbers[:1] or swept[:1])
    unknown = [name for name in chosen if name not in swept]
    if unknown:
        hint = did_you_mean(unknown[0], swept)
        raise ValueError(f"over: {shown(unknown[0])} is not swept{hint}; swept: {', '.join(swept)}")
    if len(chosen) > 2:
        raise ValueError("over: one swept quantity or two, no more")
    if len(set(chosen)) < len(chosen):
        raise ValueError(f"over: {shown(chosen[0])} is given twice")
    return chosen


def _draw_lines(figure: Figure, ds: Dataset, quantity: str, over: list[str], at: dict[str, Any]) -> None:
    """A line for each value of another swept quantity that has names or few values."""
    panel = figure.add_subplot()
    (x,) = over
    others = [str(name) for name in ds[quantity].dims if name != x and name not in at]
    named = [name for name in others if words_of(ds[name])]
    short = [name for name in others if 1 < ds[name].size <= MOST_LINES]
    family = next(iter([*named, *short]), None)
    free = [x] if family is None else [x, family]
    array, fixed = _select(ds, quantity, free, at)
    count, array = array.sizes[x], array.transpose(x, ...)
    places = np.arange(count)[thinned(count, MOST_POINTS)]
    array = array.isel({x: _with_extremes(places, array)}).load()
    size, unit = prefixed_unit(finite(array), dimension_of(array))
    x_values, x_label = values_and_label(array[x])
    separate = bool(words_of(ds[x]))  # there is nothing between two names to draw a line through
    marker = "o" if separate or array.sizes[x] <= 12 else None
    for k, text in enumerate([""] if family is None else _legend_texts(ds[family])):
        line = array if family is None else array.isel({family: k})
        line_style = "none" if separate else LINE_STYLES[k // len(COLOURS) % len(LINE_STYLES)]
        style: dict[str, Any] = {"linestyle": line_style, "color": COLOURS[k % len(COLOURS)], "marker": marker}
        panel.plot(x_values, line.values / size, label=text, **style)
    panel.set(xlabel=x_label, ylabel=label(quantity, unit))
    format_axis(panel, "x", ds[x], array[x])
    if family is not None:
        add_legend(panel, family)
    notes = _notes(fixed, _select(ds, "status", free, at)[0])
    set_title(figure, ds, [*notes, *_thinning(array.sizes[x], count, "values")])


def _draw_map(figure: Figure, ds: Dataset, quantity: str, over: list[str], at: dict[str, Any]) -> None:
    """A heat map over two swept quantities."""
    panel = figure.add_subplot()
    x, y = over
    array, fixed = _select(ds, quantity, [y, x], at)
    whole, array = array, array.isel({name: thinned(array.sizes[name], 1500) for name in over})
    array = array.transpose(y, x).load()
    size, unit = prefixed_unit(finite(array), dimension_of(array))
    (x_values, x_label), (y_values, y_label) = values_and_label(array[x]), values_and_label(array[y])
    cells = array.values / size
    mesh = panel.pcolormesh(x_values, y_values, cells, cmap=COLOUR_MAP, shading="nearest", rasterized=True)
    figure.colorbar(mesh, ax=panel, label=label(quantity, unit))
    panel.set(xlabel=x_label, ylabel=y_label)
    format_axis(panel, "x", ds[x], array[x])
    format_axis(panel, "y", ds[y], array[y])
    notes = _notes(fixed, _select(ds, "status", over, at)[0])
    if array.size < whole.size:
        notes.append(f"{array.sizes[x]} × {array.sizes[y]} of {whole.sizes[x]} × {whole.sizes[y]} values are drawn")
    set_title(figure, ds, notes)


def _draw_scatter(figure: Figure, ds: Dataset, quantity: str, over: list[str], at: dict[str, Any]) -> None:
    """A point for every impact of a sampled sweep: over one swept quantity, with a colour for each word of another; or
    over two, coloured."""
    if at:
        raise ValueError("at: a sampled sweep has no grid to select from")
    panel, status, count = figure.add_subplot(), ds["status"], ds.sizes["impact"]
    ds = ds.isel(impact=_with_extremes(some_of(count, MOST_POINTS), ds[quantity]))
    array = ds[quantity].load()
    size, unit = prefixed_unit(finite(array), dimension_of(array))
    x_values, x_label = values_and_label(ds[over[0]])
    few = array.size <= FEW_POINTS
    if len(over) == 1:
        style: dict[str, Any] = {"markersize": 9} if few else {"markersize": 3, "alpha": 0.5}
        family = worded(ds, over)
        words = words_of(ds[family]) if family else []
        draw_points(panel, x_values, array.values / size, words, family or "", **style)
        panel.set(xlabel=x_label, ylabel=label(quantity, unit))
    else:
        y_values, y_label = values_and_label(ds[over[1]])
        area, colours = 25 if few else 4, array.values / size
        points = panel.scatter(
            x_values, y_values, area, colours, cmap=COLOUR_MAP, edgecolors="0.5", linewidths=0.3, rasterized=True
        )
        figure.colorbar(points, ax=panel, label=label(quantity, unit))
        panel.set(xlabel=x_label, ylabel=y_label)
        format_axis(panel, "y", ds[over[1]])
    format_axis(panel, "x", ds[over[0]])
    set_title(figure, ds, [*_notes([], status), *_thinning(array.size, count, "impacts")])


def _with_extremes(places: NDArray[np.int64], array: DataArray) -> NDArray[np.int64]:
    """Places along the first dimension, and those of extreme values."""
    if places.size == array.shape[0]:
        return places
    extremes: list[int] = []
    for other in range(array[0].size):
        line, first, found = array if array.ndim == 1 else array[:, other], 0, list[tuple[float, int]]()
        for values in pieces(line):
            known = np.flatnonzero(np.isfinite(values))
            ends = known[[values[known].argmin(), values[known].argmax()]] if known.size else []
            found += [(float(values[k]), first + int(k)) for k in ends]
            first += values.size
        extremes += [place for _, place in (min(found), max(found))] if found else []
    return np.union1d(places, np.array(extremes, dtype=np.int64))


def _thinning(drawn: int, count: int, what: str) -> list[str]:
    """A note if not everything is drawn."""
    return [f"{drawn} of {count} {what} are drawn, the least and the greatest among them"] if drawn < count else []


def _select(ds: Dataset, quantity: str, free: list[str], at: dict[str, Any]) -> tuple[DataArray, list[str]]:
    """The quantity over the dimensions `free`, and a text for each other dimension with its selected value."""
    indices, texts = {}, []
    unknown = [name for name in at if name not in ds[quantity].dims or name in free]
    if unknown:
        raise ValueError(f"at: {shown(unknown[0])} is no other swept quantity")
    for name in map(str, ds[quantity].dims):
        if name in free:
            continue
        names = words_of(ds[name])
        value = at.get(name)
        if names:
            if value is not None and str(value) not in names:
                raise ValueError(f"at: {name} has {', '.join(names)}, not {shown(value)}")
            indices[name] = 0 if value is None else names.index(str(value))
            texts.append(f"{name.replace('_', ' ')} {names[indices[name]]}")
        else:
            wanted = ds[name].values[0] if value is None else to_si(value, dimension_of(ds[name]), bare=True)
            indices[name] = int(np.abs(ds[name].values - wanted).argmin())
            size, unit = prefixed_unit(ds[name].values[indices[name]][None], dimension_of(ds[name]))
            texts.append(f"{name.replace('_', ' ')} {ds[name].values[indices[name]] / size:.4g} {unit}".rstrip())
    return ds[quantity].isel(indices), texts


def _legend_texts(array: DataArray) -> list[str]:
    """The values of a swept quantity as texts."""
    if words_of(array):
        return [plain(word) for word in words_of(array)]
    size, unit = prefixed_unit(array.values, dimension_of(array))
    return [f"{value:.4g} {unit}".rstrip() for value in (array.values / size).tolist()]


def _notes(fixed: Sequence[str], status: DataArray) -> list[str]:
    """Below the title: the values of the other swept quantities, and how many impacts failed."""
    notes = ["at " + ", ".join(fixed)] if fixed else []
    failed = sum(int(np.count_nonzero(has_failed(codes))) for codes in pieces(status))
    return [*notes, f"{failed} of {status.size} impacts failed and are not drawn"] if failed else notes
