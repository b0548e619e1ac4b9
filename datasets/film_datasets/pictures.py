"""Pictures of datasets: of a history, a measurement or a study; of a sweep, a quantity over one swept or two."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from film_datasets.cost import study_of
from film_datasets.history import trace_of
from film_datasets.schema import COST, HISTORY, MEASUREMENT, REFUSED, SWEEP, dimension_of, kind_of, pieces, swept_name
from film_model.errors import did_you_mean, shown
from film_model.history import SUMMARY
from film_model.plot import COLOURS, picture, plot_history, prefixed_unit
from film_model.plot_study import plot_study
from film_model.units import to_si

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DEFAULT = "coefficient_of_restitution"

SIZE = (7.2, 4.6)  # inches

MOST_POINTS = 20_000
"""Points along a line or of a cloud; of more, every so many are drawn."""

FAMILY = 9
"""A swept quantity of no more values than this makes lines, each with its name, rather than an axis."""

FEW_POINTS = 200
"""A cloud of no more points than this has large ones."""

MOST_CELLS = 1500
"""Cells of a heat map along one side."""

LOG_FROM = 30.0
"""Ratio of the largest to the smallest value from which an axis is logarithmic, if the values are all > 0."""

LOG_SPACED_FROM = 3.0
"""The same ratio for values in a geometric sequence."""

MOST_NAMED = 2000.0
"""Ratio up to which a logarithmic axis has a number at 1, 2 and 5 of each decade; beyond, powers of ten."""

STROKES = ("-", "--", ":", "-.")

MAP = "cividis"
"""Safe for the colour-blind, and even in grey."""


def plot(
    ds: xr.Dataset,
    path: str | os.PathLike[str] | None = None,
    quantity: str | None = None,
    over: Sequence[str] | str | None = None,
    at: Mapping[str, Any] | None = None,
    dpi: float = 200.0,
) -> Figure:
    """A figure of a dataset, written to `path` if given.

    Of a history, the whole contact; of the run of an FMU, its samples; of a measurement, its points; of a cost study,
    error against time. The other arguments are for sweeps:

    quantity: of the summary, the coefficient of restitution unless given. over: names in the dataset such as
    "impactor_velocity"; unless given, the first two with many values. One makes lines, one for each word or each of a
    few values that are swept beside it; two make a heat map, or a cloud of a sampled sweep. at: values of the other
    swept quantities ("70 g" or SI, the nearest is taken, or a word); their first unless given, and named in the title.

    Raises ValueError for a name that is not there, an argument that is not for such a dataset, a run without contact or
    another suffix than .png, .svg and .pdf; ImportError without matplotlib; OSError where the file cannot be written.
    """
    kind = kind_of(ds)
    given = [name for name, value in (("quantity", quantity), ("over", over), ("at", at)) if value]
    if kind != SWEEP and given:
        raise ValueError(f"{given[0]}: is for sweeps, this is an {kind.replace('_', ' ')}")
    if kind == HISTORY:
        return plot_history(trace_of(ds), path, dpi)
    if kind == COST:
        return plot_study(study_of(ds), path, dpi)
    if kind == MEASUREMENT:
        size = SIZE[0], max(SIZE[1], 2.2 * (len(ds.variables) - 1))
        return picture(path, lambda figure: _points(figure, ds), size, dpi)
    quantity = quantity or DEFAULT
    known = [name for name in (*SUMMARY, "zener_number") if name in ds]
    if quantity not in known:
        hint = did_you_mean(quantity, known) or f"; there are {', '.join(known)}"
        raise ValueError(f"quantity: {shown(quantity)} is not a summary quantity of this dataset{hint}")
    swept = [swept_name(path) for path in str(ds.attrs["swept"]).split()]
    alone = [name for name in swept if ds[name].ndim == 0]  # in a selection
    if alone:
        ds = ds[[quantity, "status", *swept]].expand_dims(alone)
    numbers = [name for name in swept if "flag_meanings" not in ds[name].attrs and ds[name].size > 1]
    fine = [name for name in numbers if ds[name].size > FAMILY]
    chosen = [over] if isinstance(over, str) else list(over or fine[:2] or numbers[:1] or swept[:1])
    wrong = [name for name in chosen if name not in swept]
    if wrong:
        hint = did_you_mean(wrong[0], swept)
        raise ValueError(f"over: {shown(wrong[0])} is not swept{hint}; swept: {', '.join(swept)}")
    if len(chosen) > 2:
        raise ValueError("over: one swept quantity or two, no more")
    if len(set(chosen)) < len(chosen):
        raise ValueError(f"over: {shown(chosen[0])} is given twice")
    draw = _cloud if "impact" in ds[quantity].dims else _map if len(chosen) == 2 else _lines

    def fill(figure: Figure) -> None:
        figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.08)
        draw(figure, ds, quantity, chosen, dict(at or {}))

    return picture(path, fill, SIZE, dpi)


def _points(figure: Figure, ds: xr.Dataset) -> None:
    """The points of a measurement, a panel for each quantity."""
    figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.04)
    along = "t" if ds.attrs["measured"] == "history" else "impactor_velocity"
    names = [str(name) for name in ds.data_vars if name != along]
    x_size, x_unit = prefixed_unit(ds[along].values, dimension_of(ds[along]))
    panels = figure.subplots(len(names), sharex=True, squeeze=False)[:, 0]
    for panel, name in zip(panels, names, strict=True):
        size, unit = prefixed_unit(_finite(ds[name]), dimension_of(ds[name]))
        style = {"markersize": 4.0 if ds[name].size <= FEW_POINTS else 2.0, "color": COLOURS[0]}
        panel.plot(ds[along].values / x_size, ds[name].values / size, "o", **style)
        panel.set_ylabel(_label(name, unit))
    panels[-1].set_xlabel(_label("time" if along == "t" else along, x_unit))
    if along != "t":
        _scale(panels[-1].xaxis, panels[-1].set_xscale, ds[along])
    _title(figure, ds)


def _lines(figure: Figure, ds: xr.Dataset, quantity: str, over: list[str], at: dict[str, Any]) -> None:
    """One line for each word, or each of a few values, of another swept quantity."""
    panel = figure.add_subplot()
    (x,) = over
    others = [str(name) for name in ds[quantity].dims if name != x and name not in at and 1 < ds[name].size <= FAMILY]
    words = [str(name) for name in ds[quantity].dims if name != x and "flag_meanings" in ds[name].attrs]
    word = next((name for name in [*words, *others] if name not in at), None)
    free = [x] if word is None else [x, word]
    array, said = _fixed(ds, quantity, free, at)
    array = array.isel({x: _spread(array.sizes[x], MOST_POINTS)}).load()
    size, unit = prefixed_unit(_finite(array), dimension_of(array))
    x_values, x_label = _axis(array[x])
    labels = [""] if word is None else _names(ds[word])
    apart = "flag_meanings" in ds[x].attrs  # words have nothing between them
    marker = "o" if apart or array.sizes[x] <= 12 else None
    for k, label in enumerate(labels):
        line = array if word is None else array.isel({word: k})
        stroke = "none" if apart else STROKES[k // len(COLOURS) % len(STROKES)]
        style: dict[str, Any] = {"linestyle": stroke, "color": COLOURS[k % len(COLOURS)], "marker": marker}
        panel.plot(x_values, line.values / size, label=label, **style)
    panel.set(xlabel=x_label, ylabel=_label(quantity, unit))
    _ticks(panel.xaxis, ds[x])
    _scale(panel.xaxis, panel.set_xscale, array[x])
    if word is not None:
        panel.legend(title=_plain(word), frameon=False, fontsize=8)
    _title(figure, ds, said, _fixed(ds, "status", free, at)[0])


def _map(figure: Figure, ds: xr.Dataset, quantity: str, over: list[str], at: dict[str, Any]) -> None:
    """A heat map over two swept quantities."""
    panel = figure.add_subplot()
    x, y = over
    array, said = _fixed(ds, quantity, [y, x], at)
    array = array.isel({name: _spread(array.sizes[name], MOST_CELLS) for name in over}).transpose(y, x).load()
    size, unit = prefixed_unit(_finite(array), dimension_of(array))
    (x_values, x_label), (y_values, y_label) = _axis(array[x]), _axis(array[y])
    mesh = panel.pcolormesh(x_values, y_values, array.values / size, cmap=MAP, shading="nearest", rasterized=True)
    figure.colorbar(mesh, ax=panel, label=_label(quantity, unit))
    panel.set(xlabel=x_label, ylabel=y_label)
    for axis, name, scale in ((panel.xaxis, x, panel.set_xscale), (panel.yaxis, y, panel.set_yscale)):
        _ticks(axis, ds[name])
        _scale(axis, scale, array[name])
    _title(figure, ds, said, _fixed(ds, "status", over, at)[0])


def _cloud(figure: Figure, ds: xr.Dataset, quantity: str, over: list[str], at: dict[str, Any]) -> None:
    """A point for every impact: over one quantity, or coloured over two."""
    if at:
        raise ValueError("at: a sampled sweep has no grid to pick from")
    panel, status = figure.add_subplot(), ds["status"]
    ds = ds.isel(impact=_spread(ds.sizes["impact"], MOST_POINTS))
    array = ds[quantity].load()
    size, unit = prefixed_unit(_finite(array), dimension_of(array))
    x_values, x_label = _axis(ds[over[0]])
    few = array.size <= FEW_POINTS
    if len(over) == 1:
        style: dict[str, Any] = {"markersize": 9} if few else {"markersize": 3, "alpha": 0.5}
        panel.plot(x_values, array.values / size, ".", color=COLOURS[0], rasterized=True, **style)
        panel.set(xlabel=x_label, ylabel=_label(quantity, unit))
    else:
        y_values, y_label = _axis(ds[over[1]])
        points = panel.scatter(x_values, y_values, 25 if few else 4, array.values / size, cmap=MAP, rasterized=True)
        figure.colorbar(points, ax=panel, label=_label(quantity, unit))
        panel.set(xlabel=x_label, ylabel=y_label)
        _ticks(panel.yaxis, ds[over[1]])
        _scale(panel.yaxis, panel.set_yscale, ds[over[1]])
    _ticks(panel.xaxis, ds[over[0]])
    _scale(panel.xaxis, panel.set_xscale, ds[over[0]])
    _title(figure, ds, [], status)


def _fixed(ds: xr.Dataset, quantity: str, free: list[str], at: dict[str, Any]) -> tuple[xr.DataArray, list[str]]:
    """The quantity over the dimensions `free`, at a place of all others, and what to say of it."""
    places, said = {}, []
    unknown = [name for name in at if name not in ds[quantity].dims or name in free]
    if unknown:
        raise ValueError(f"at: {shown(unknown[0])} is no other swept quantity")
    for name in map(str, ds[quantity].dims):
        if name in free:
            continue
        words = _words(ds[name])
        value = at.get(name)
        if words:
            if value is not None and str(value) not in words:
                raise ValueError(f"at: {name} has {', '.join(words)}, not {shown(value)}")
            places[name] = 0 if value is None else words.index(str(value))
            said.append(f"{name.replace('_', ' ')} {words[places[name]]}")
        else:
            wanted = ds[name].values[0] if value is None else to_si(value, dimension_of(ds[name]), bare=True)
            places[name] = int(np.abs(ds[name].values - wanted).argmin())
            size, unit = prefixed_unit(ds[name].values[places[name]][None], dimension_of(ds[name]))
            said.append(f"{name.replace('_', ' ')} {ds[name].values[places[name]] / size:.4g} {unit}".rstrip())
    return ds[quantity].isel(places), said


def _words(array: xr.DataArray) -> list[str]:
    """The words of a swept quantity that are there, which may be a selection; none if it is of numbers."""
    words = str(array.attrs.get("flag_meanings", "")).split()
    return [words[number] for number in array.values.tolist()] if words else []


def _names(array: xr.DataArray) -> list[str]:
    """The values of a swept quantity as texts."""
    if "flag_meanings" in array.attrs:
        return _words(array)
    size, unit = prefixed_unit(array.values, dimension_of(array))
    return [f"{value:.4g} {unit}".rstrip() for value in (array.values / size).tolist()]


def _spread(size: int, most: int) -> slice:
    return slice(None, None, max(1, -(-size // most)))


def _finite(array: xr.DataArray) -> Any:
    values = array.values[np.isfinite(array.values)]
    return values if values.size else np.zeros(1)


def _axis(array: xr.DataArray) -> tuple[Any, str]:
    """Values in a unit that reads well, and the label of the axis."""
    if "flag_meanings" in array.attrs:
        return array.values, _plain(str(array.name))
    size, unit = prefixed_unit(array.values, dimension_of(array))
    return array.values / size, _label(str(array.name), unit)


def _label(name: str, unit: str) -> str:
    return _plain(name) + (f" ({unit})" if unit else "")


def _ticks(axis: Any, array: xr.DataArray) -> None:
    """Words along an axis of words."""
    words = str(array.attrs.get("flag_meanings", "")).split()
    if words:
        axis.set_ticks(range(len(words)), words)


def _scale(axis: Any, set_scale: Any, array: xr.DataArray) -> None:
    """A logarithmic axis, with plain numbers, for values that span much or are spaced so; `array` is the dataset's."""
    values = np.asarray(array.values[:: max(1, array.size // MOST_POINTS)], np.float64)
    low, high = float(values.min()), float(values.max())
    if "flag_meanings" in array.attrs or not (low > 0.0 and math.isfinite(high)):
        return
    steps = values[1:] / values[:-1]
    even = steps.size > 1 and high >= LOG_SPACED_FROM * low and np.ptp(steps) <= 1e-6 * abs(steps[0])
    if even or high >= LOG_FROM * low:
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        set_scale("log")
        if high <= MOST_NAMED * low:
            axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def _plain(name: str) -> str:
    return name.replace("_", " ").replace("$", r"\$")


def _title(figure: Figure, ds: xr.Dataset, said: Sequence[str] = (), status: xr.DataArray | None = None) -> None:
    """The title, and below it where the picture is and how many of its impacts are not in it."""
    title = str(ds.attrs["title"]).partition(": sweep over")[0]
    figure.suptitle(title.replace("$", r"\$"), fontsize=min(11.0, 620.0 / max(len(title), 1)), fontweight="bold")
    notes = ["at " + ", ".join(said)] if said else []
    if status is not None:
        failed = sum(int(np.count_nonzero((codes < 0) | (codes >= REFUSED))) for codes in pieces(status))
        notes += [f"{failed} of {status.size} impacts failed and are not drawn"] if failed else []
    if notes:
        figure.axes[0].set_title("; ".join(notes).replace("$", r"\$"), fontsize=8)
