"""The picture of a chain of bodies: velocities and contact forces over time, of many bodies as waves along the row."""

from __future__ import annotations

import os
from itertools import cycle
from typing import Any

import numpy as np

from film_model.base.foreign import Figure
from film_model.plot.style import COLOURS, picture, plain, prefixed_unit
from film_model.solve.chain_motion import ChainMotion

SIZE = (7.2, 5.4)  # inches


def plot_chain(motion: ChainMotion, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """Velocities and forces over time, while forces act. Files, errors and dpi: see `style.picture`."""
    return picture(path, lambda figure: _draw(figure, motion), SIZE, dpi)


def _draw(figure: Figure, motion: ChainMotion) -> None:
    figure.set_layout_engine("constrained")
    times = np.linspace(*motion.span, 501)
    values = motion.sample_si(times)
    second, unit_of_time = prefixed_unit(times, "time")
    panels: Any = figure.subplots(2, sharex=True)
    for panel, name, dimension, what in zip(
        panels, ("velocity", "contact_force"), ("velocity", "force"), ("body", "contact"), strict=True
    ):
        rows = values[name]
        names = motion.chain.link_names if what == "contact" else range(1, len(rows) + 1)
        size, unit = prefixed_unit(rows, dimension)
        label = f"{dimension} ({unit})"
        if len(motion.values["body_mass"]) > 6:  # more bodies are a map
            edges = np.arange(len(rows) + 1) + 0.5
            drawn = panel.pcolormesh(_edges(times) / second, edges, rows / size, cmap="viridis", rasterized=True)
            figure.colorbar(drawn, ax=panel, label=label)
            panel.set_ylabel(what)
            for link in motion.chain.links:
                if link.behind not in (None, link.body + 1):  # a branch begins; its contact has the number before
                    panel.axhline(link.behind + (0.5 if what == "body" else -0.5), color="white", linewidth=1.0)
            continue
        for number, row, colour in zip(names, rows, cycle(COLOURS), strict=False):
            panel.plot(times / second, row / size, color=colour, label=f"{what} {number}")
        panel.set_ylabel(label)
        panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    panels[-1].set_xlabel(f"time ({unit_of_time})")
    panels[-1].set_xlim(times[0] / second, times[-1] / second)
    title = " ".join(motion.chain.title.split()) or f"Chain of {len(motion.values['body_mass'])} bodies"
    panels[0].set_title(plain(title), fontsize=min(11.0, 600.0 / len(title)), fontweight="bold", loc="left")


def _edges(times: np.ndarray[Any, Any]) -> Any:
    """Edges of cells around even times."""
    half = 0.5 * (times[1] - times[0])
    return np.append(times - half, times[-1] + half)
