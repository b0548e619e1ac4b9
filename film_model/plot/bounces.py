"""The picture of all bounces of a ball: its height over time."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from film_model.base.arrays import Array
from film_model.base.foreign import Figure
from film_model.plot.style import COLOURS, HIGHLIGHT, picture, plain, prefixed_unit
from film_model.scene import STANDARD_GRAVITY
from film_model.solve.bounce import Bounces

PARABOLA = 33
"""Points of each flight."""

SIZE = (7.2, 4.2)  # inches


def plot_bounces(bounces: Bounces, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """Height over time, a parabola for each flight. Files, errors and dpi: see `style.picture`."""
    return picture(path, lambda figure: _draw(figure, bounces), SIZE, dpi)


def heights(bounces: Bounces) -> tuple[Array, Array]:
    """Times [s] and heights above the place of contact [m], from the release of a ball with a drop height."""
    begins, durations = bounces.column("time"), bounces.column("contact_duration")
    speeds = np.maximum(-bounces.column("velocity_after"), 0.0)
    part = np.linspace(0.0, 1.0, PARABOLA)
    ends = begins + np.nan_to_num(durations)
    flight = np.append(begins[1:] - ends[:-1], 2.0 * speeds[-1] / STANDARD_GRAVITY)[:, None] * part
    t = ends[:, None] + flight
    z = flight * (speeds[:, None] - 0.5 * STANDARD_GRAVITY * flight)
    fall = begins[0] * part  # none for a ball that is followed from first touch
    fallen = 0.5 * STANDARD_GRAVITY * (begins[0] ** 2 - fall**2)
    return np.concatenate([fall, t.ravel()]), np.concatenate([fallen, np.maximum(z, 0.0).ravel()])


def _draw(figure: Figure, bounces: Bounces) -> None:
    figure.set_layout_engine("constrained")
    t, z = heights(bounces)
    (second, unit_of_time), (metre, unit_of_height) = prefixed_unit(t, "time"), prefixed_unit(z, "length")
    panel: Any = figure.subplots()
    panel.plot(t / second, z / metre, color=COLOURS[0], linewidth=1.2)
    top = bounces.column("time") + np.nan_to_num(bounces.column("contact_duration"))
    top = top + np.maximum(-bounces.column("velocity_after"), 0.0) / STANDARD_GRAVITY
    panel.plot(top / second, bounces.column("height") / metre, ".", color=HIGHLIGHT, markersize=4.0)
    panel.set(xlabel=f"time ({unit_of_time})", ylabel=f"height ({unit_of_height})")
    panel.set(xlim=(0.0, None), ylim=(0.0, None))
    title = " ".join(bounces.scene.title.split()) or f"Bounces on a {bounces.scene.target.kind}"
    panel.set_title(plain(title), fontsize=min(11.0, 600.0 / len(title)), fontweight="bold", loc="left")
    panel.text(
        1.0, 0.97, plain(bounces.outcome.partition(":")[0]), transform=panel.transAxes, ha="right", va="top", fontsize=8
    )
