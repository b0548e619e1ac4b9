"""Plots of how the values of a sweep are distributed: histogram, empirical distribution, and one against another."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from film_datasets.axis_style import MOST_POINTS, draw_points, format_axis, set_title, some_of, values_and_label, worded
from film_datasets.schema import dimension_of, has_failed, require_impacts, swept_name, words_of
from film_model.base.errors import did_you_mean, shown
from film_model.base.foreign import DataArray, Dataset, Figure
from film_model.base.units import format_si
from film_model.plot.style import COLOURS
from film_model.solve.history import SUMMARY

TORNADO = "tornado"
KINDS = ("histogram", "ecdf", "scatter", TORNADO)

DEFAULT_QUANTITY = "coefficient_of_restitution"

MARKED = (0.05, 0.5, 0.95)
"""Fractions of the impacts whose quantiles are marked."""


def draw_distribution(
    ds: Dataset, kind: str, quantity: str | None, over: Sequence[str] | str | None
) -> Callable[[Figure], None]:
    """A function that draws a kind of `KINDS` into a figure. over: for a scatter plot, the quantity along x."""
    if kind not in KINDS:
        raise ValueError(f"kind: {shown(kind)} is not allowed: {', '.join(KINDS)}{did_you_mean(kind, KINDS)}")
    require_impacts(ds)
    swept = [swept_name(path) for path in str(ds.attrs["swept"]).split()]
    numbers = [name for name in (*swept, *SUMMARY) if name in ds and ds[name].dtype.kind == "f"]
    y = _known(
        quantity or next((name for name in (DEFAULT_QUANTITY, *SUMMARY) if name in numbers), numbers[0]), numbers
    )
    chosen = [over] if isinstance(over, str) else list(over or numbers[:1])
    if kind == "scatter" and len(chosen) != 1:
        raise ValueError("over: a scatter plot needs one quantity")
    if kind != "scatter" and over:
        raise ValueError(f"over: is not for a {kind}")
    x = _known(chosen[0], numbers)

    def fill(figure: Figure) -> None:
        figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.08)
        status = ds["status"]
        notes = [f"{int(has_failed(status.values).sum())} of {status.size} impacts failed and are not drawn"]
        notes = notes if has_failed(status.values).any() else []
        if kind == "scatter":
            _scatter(figure, ds, x, y, notes)
        else:
            _one(figure, ds[y].broadcast_like(status), kind, notes)
        set_title(figure, ds, notes)

    return fill


def _known(name: str, numbers: Sequence[str]) -> str:
    if name not in numbers:
        hint = did_you_mean(name, numbers) or f"; there are {', '.join(numbers)}"
        raise ValueError(f"quantity: {shown(name)} is not a number of this dataset{hint}")
    return name


def _one(figure: Figure, array: DataArray, kind: str, notes: list[str]) -> None:
    """A histogram or empirical distribution, with quantiles."""
    import xarray as xr

    panel = figure.add_subplot()
    flat = xr.DataArray(array.values.ravel(), name=array.name, attrs=array.attrs)
    flat = flat[np.isfinite(flat.values)]
    if not flat.size:
        raise ValueError(f"{array.name}: no impact has a value")
    values, text = values_and_label(flat)
    if kind == "histogram":
        panel.hist(values, bins=_bins(values), color=COLOURS[0])
        panel.set(xlabel=text, ylabel="impacts")
    else:
        panel.ecdf(values, color=COLOURS[0])
        panel.set(xlabel=text, ylabel="fraction of impacts", ylim=(0.0, 1.02))
    for fraction, place in zip(MARKED, np.quantile(values, MARKED), strict=True):
        panel.axvline(place, color="0.4", linestyle="-" if fraction == 0.5 else "--", linewidth=0.8)
    marks = (format_si(v, dimension_of(array), 4) for v in np.quantile(flat.values, MARKED).tolist())
    notes.append("quantiles " + ", ".join(f"{100 * f:g} %: {m}" for f, m in zip(MARKED, marks, strict=True)))


def _bins(values: Any) -> int:
    """Number of bars by the rule of Freedman and Diaconis (1981), 10 to 200."""
    low, high = np.quantile(values, (0.25, 0.75))
    width = 2.0 * float(high - low) / values.size ** (1 / 3)
    wanted = math.ceil(float(np.ptp(values)) / width) if width > 0.0 else 0
    return min(max(wanted, 10), 200)


def _scatter(figure: Figure, ds: Dataset, x: str, y: str, notes: list[str]) -> None:
    """A point for each impact, in the colour of its word if words were swept."""
    import xarray as xr

    panel = figure.add_subplot()
    family = worded(ds, (x, y))
    drawn: list[DataArray] = []
    for name in filter(None, (x, y, family)):
        values = ds[name].broadcast_like(ds["status"]).transpose(*ds["status"].dims).values.ravel()
        drawn.append(xr.DataArray(values[some_of(values.size, MOST_POINTS)], name=name, attrs=ds[name].attrs))
    pair = drawn[:2]
    if pair[0].size < ds["status"].size:
        notes.append(f"{pair[0].size} of {ds['status'].size} impacts are drawn")
    known = np.isfinite(pair[0].values) & np.isfinite(pair[1].values)
    (x_values, x_label), (y_values, y_label) = (values_and_label(array[known]) for array in pair)
    words = words_of(drawn[2][known]) if family else []
    draw_points(panel, x_values, y_values, words, family or "", markersize=3, alpha=0.5)
    panel.set(xlabel=x_label, ylabel=y_label)
    format_axis(panel, "x", ds[x], pair[0][known])
