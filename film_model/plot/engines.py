"""Picture of an engine's fitted contact law beside our impacts: force over time, and what remains over velocity."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from film_model.base.foreign import Figure
from film_model.plot.style import COLOURS, HIGHLIGHT, MARKERS, picture, plain, prefixed_unit
from film_model.scene import Scene
from film_model.solve.simulate import simulate_quietly
from film_model.translate import Translation
from film_model.translate.fit import scene_at
from film_model.translate.march import march

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = (8.6, 6.2)  # inches
OURS, THEIRS = COLOURS[0], HIGHLIGHT


def plot_translation(
    scene: Scene, made: Translation, path: str | os.PathLike[str] | None = None, dpi: float = 200.0
) -> Figure:
    """Force histories at the lowest, middle and highest velocity; restitution and errors over velocity.

    Files, errors and dpi: see `picture`.
    """
    return picture(path, lambda figure: _draw(figure, scene, made), SIZE, dpi)


def _draw(figure: Figure, scene: Scene, made: Translation) -> None:
    speeds = made.velocities
    shown = sorted({0, len(speeds) // 2, len(speeds) - 1})
    impacts = march(made.law, made.pair, made.values, speeds)
    for place, at in enumerate(shown):
        panel = figure.add_axes((0.08 + 0.32 * place, 0.56, 0.24, 0.29))
        _history(panel, scene, made, impacts, at)
        if place == 0:
            figure.legend(*panel.get_legend_handles_labels(), loc="upper right", frameon=False, ncols=2)
    left = figure.add_axes((0.08, 0.09, 0.39, 0.33))
    for values, colour, marker in ((made.wanted, OURS, "o"), (made.found, THEIRS, "s")):
        left.plot(speeds, values["restitution"], marker=marker, color=colour, markersize=4)
    left.set(xlabel="approach velocity (m/s)", ylabel="coefficient of restitution")
    right = figure.add_axes((0.59, 0.09, 0.38, 0.33))
    right.axhline(0.0, color="0.7", linewidth=0.8)
    for name, colour, marker in zip(made.errors, (COLOURS[1], COLOURS[3], COLOURS[4]), MARKERS, strict=False):
        right.plot(
            speeds,
            100.0 * (made.found[name] / made.wanted[name] - 1.0),
            marker=marker,
            color=colour,
            markersize=4,
            label=name,
        )
    right.set(xlabel="approach velocity (m/s)", ylabel=f"error of {made.engine.title} (%)")
    right.legend(frameon=False, fontsize=8)
    if len(speeds) > 1:
        left.set_xscale("log")
        right.set_xscale("log")
    title = plain(" ".join(scene.title.split()) or "Impact")
    figure.text(0.08, 0.95, title, fontsize=min(12.0, 620.0 / len(title)), fontweight="bold")
    numbers = ", ".join(f"{p.name} {made.values[p.name]:.4g} {p.unit}".strip() for p in made.law.parameters)
    figure.text(0.08, 0.915, plain(f"{made.engine.title}, law {made.law.name}: {numbers}"), fontsize=7, color="0.25")


def _history(panel: Axes, scene: Scene, made: Translation, impacts: Any, at: int) -> None:
    """Both forces over time at one velocity."""
    speed = float(made.velocities[at])
    ours = simulate_quietly(scene_at(scene, speed))
    longest = max(made.wanted["duration"][at], made.found["duration"][at])
    times = np.linspace(0.0, longest, 300)
    forces = ours.sample_si(times).contact_force
    clock, second = prefixed_unit(times, "time")
    size, newton = prefixed_unit(forces, "force")
    panel.plot(times / clock, forces / size, color=OURS, label=f"film-model, {ours.problem.law.name}")
    inside = impacts.times[:, at] <= made.found["duration"][at]
    label = f"{made.engine.title}, {made.law.name}"
    panel.plot(impacts.times[inside, at] / clock, impacts.forces[inside, at] / size, "--", color=THEIRS, label=label)
    panel.set(xlabel=f"time ({second})", ylabel=f"contact force ({newton})")
    panel.set_title(f"{speed:.3g} m/s", fontsize=9)
