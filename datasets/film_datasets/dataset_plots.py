"""plot: a figure of any dataset; sweeps are in `sweep_plots`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from film_datasets.axis_style import finite, format_axis, label, set_title
from film_datasets.bounce_dataset import bounces_of
from film_datasets.cost_dataset import study_of
from film_datasets.csv_measurement import measured_over
from film_datasets.distribution_plots import DEFAULT_QUANTITY, TORNADO, draw_distribution
from film_datasets.history_dataset import trace_of
from film_datasets.schema import BOUNCES, CHAIN, COST, HISTORY, MEASUREMENT, SWEEP, dimension_of, kind_of
from film_datasets.sweep_plots import FEW_POINTS, draw_sweep
from film_datasets.sweeps.definition import Sweep
from film_datasets.tornado_plot import draw_tornado
from film_model.base.foreign import Dataset, Figure
from film_model.plot.bounces import plot_bounces
from film_model.plot.chain import plot_chain
from film_model.plot.cost import plot_study
from film_model.plot.history import plot_history
from film_model.plot.style import COLOURS, picture, prefixed_unit
from film_model.scene.chain import Chain
from film_model.solve.chain_motion import simulate_chain_quietly

SIZE = (7.2, 4.6)  # inches


def plot(
    ds: Dataset,
    path: str | os.PathLike[str] | None = None,
    quantity: str | None = None,
    over: Sequence[str] | str | None = None,
    at: Mapping[str, Any] | None = None,
    kind: str | None = None,
    dpi: float = 200.0,
) -> Figure:
    """A figure of a dataset, written to `path` if given.

    Of a history, the whole contact; of the run of an FMU, its samples; of a measurement, its points; of bounces,
    height over time; of a chain, velocities and forces over time; of a cost study, error against time. The other
    arguments are for sweeps:

    quantity: of the summary; the coefficient of restitution unless given. over: one or two names in the dataset such
    as "impactor_velocity"; unless given, the first two with many values. One gives lines, a line for each value of
    another swept quantity that has names or few values; two give a heat map. A sampled sweep gives a scatter plot.
    at: values of the other swept quantities ("70 g" or SI, of which the nearest is taken, or a name); their first
    values unless given. The title states them. kind: "histogram" or "ecdf" (empirical distribution) of the quantity
    over all impacts, or "scatter", a point for each impact, over one swept or summary quantity; "tornado", how far each
    swept number moves the quantity, alone, for which a few impacts are simulated.

    Raises ValueError for an unknown name, an argument that is not for such a dataset, a run without contact or a suffix
    other than .png, .svg and .pdf; ImportError without matplotlib; OSError if the file cannot be written.

    >>> figure = fd.plot(fd.load("zener"), "restitution.png")
    """
    schema = kind_of(ds)
    options = (("quantity", quantity), ("over", over), ("at", at), ("kind", kind))
    given = [name for name, value in options if value]
    if schema != SWEEP and given:
        raise ValueError(f"{given[0]}: is for sweeps, this is an {schema.replace('_', ' ')}")
    if kind:
        if at:
            raise ValueError(f"at: is not for a {kind}, which has all impacts")
        if kind == TORNADO:
            if over:
                raise ValueError(f"over: is not for a {kind}")
            return picture(path, draw_tornado(Sweep.of_dataset(ds), quantity or DEFAULT_QUANTITY), SIZE, dpi)
        return picture(path, draw_distribution(ds, kind, quantity, over), SIZE, dpi)
    if schema == HISTORY:
        return plot_history(trace_of(ds), path, dpi)
    if schema == BOUNCES:
        return plot_bounces(bounces_of(ds), path, dpi)
    if schema == CHAIN:
        chain = Chain.from_text(str(ds.attrs["scene_toml"]), "scene_toml", None)
        return plot_chain(simulate_chain_quietly(chain), path, dpi)
    if schema == COST:
        return plot_study(study_of(ds), path, dpi)
    if schema == MEASUREMENT:
        size = SIZE[0], max(SIZE[1], 2.2 * (len(ds.variables) - 1))
        return picture(path, lambda figure: _draw_measurement(figure, ds), size, dpi)
    return picture(path, draw_sweep(ds, quantity, over, at), SIZE, dpi)


def _draw_measurement(figure: Figure, ds: Dataset) -> None:
    """The points of a measurement, a panel for each quantity."""
    figure.set_layout_engine("constrained", w_pad=0.1, h_pad=0.04)
    along, names = measured_over(ds)
    x_size, x_unit = prefixed_unit(ds[along].values, dimension_of(ds[along]))
    panels: Any = np.ravel(figure.subplots(len(names), sharex=True, squeeze=False))
    for panel, name in zip(panels, names, strict=True):
        size, unit = prefixed_unit(finite(ds[name]), dimension_of(ds[name]))
        style = {"markersize": 4.0 if ds[name].size <= FEW_POINTS else 2.0, "color": COLOURS[0]}
        panel.plot(ds[along].values / x_size, ds[name].values / size, "o", **style)
        panel.set_ylabel(label(name, unit))
    panels[-1].set_xlabel(label("time" if along == "t" else along, x_unit))
    if along != "t":
        format_axis(panels[-1], "x", ds[along])
    set_title(figure, ds)
