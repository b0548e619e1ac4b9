"""The map of regimes: where a scene stands over Zener's λ and V/V_Y."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from film_model.base.foreign import Figure
from film_model.effects.effect import percent
from film_model.laws.big_alabo import FULLY_PLASTIC
from film_model.plot.style import HIGHLIGHT, REGIMES, picture, plain
from film_model.scene import Scene
from film_model.studies.regimes import Regimes, regimes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = (7.6, 5.4)  # inches
_RATIO = r"$V_0/V_\mathrm{Y}$"


def plot_regimes(scene: Scene, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """A map of regimes over Zener's λ and V/V_Y with the scene on it. Files, errors and dpi: see `picture`."""
    return picture(path, lambda figure: _draw(figure, scene, regimes(scene)), SIZE, dpi)


def _draw(figure: Figure, scene: Scene, areas: Regimes) -> None:
    panel = figure.add_axes((0.095, 0.235, 0.88, 0.635))
    keys = _target_regimes(panel, scene, areas)
    _stage_limits(panel, areas)
    where = _mark_scene(panel, areas)
    keys += panel.get_legend_handles_labels()[0]
    panel.set(xscale="log", yscale="log", xlim=areas.lambdas[[0, -1]], ylim=areas.ratios[[0, -1]])
    panel.set(xlabel="Zener's inelasticity number λ", ylabel=f"approach velocity over yield velocity {_RATIO}")
    figure.legend(handles=keys, loc="upper left", bbox_to_anchor=(0.085, 0.16), ncols=2, frameon=False, fontsize=8)
    title = " ".join(scene.title.split()) or f"Impact on a {scene.target.kind}"
    figure.text(0.095, 0.945, plain(title), fontsize=min(12.0, 760.0 / len(title)), fontweight="bold")
    figure.text(0.095, 0.905, f"{where}  ·  boundaries by Big-Alabo's law", fontsize=8, color="0.25")


def _target_regimes(panel: Axes, scene: Scene, areas: Regimes) -> list[Any]:
    """Fill the areas in which the target behaves differently; the legend's entries."""
    from matplotlib.patches import Patch

    tolerance, kind = scene.effect_tolerance, scene.target.kind
    across, up = np.meshgrid(areas.lambdas, areas.ratios)
    panel.set_facecolor(REGIMES["moving"][0])
    keys: list[Any] = []
    left = np.ones(across.shape, bool)  # of the map, where no area has been filled yet

    def fill(field: Any, low: float, high: float, name: str, word: str) -> None:
        colour, hatch = REGIMES[name]
        inside = (field >= low) & (field <= high)
        if inside.any():
            area = panel.contourf(across, up, field, [low, high], colors=[colour], hatches=[hatch])
            area.set(edgecolor="0.6", linewidth=0.0)  # of the hatch
            keys.append(Patch(facecolor=colour, hatch=hatch, edgecolor="0.55", linewidth=0.6, label=word))
            left[inside] = False

    small = percent(tolerance)
    fill(areas.motion, -1.0, tolerance, "half-space", f"half-space: target motion changes less than {small}")
    if kind == "rod" and areas.rests is not None:
        fill(areas.rests, 1.0, math.inf, "reflections", "finite rod: the wave returns before contact ends")
    elif areas.reflections is not None and areas.rests is not None:
        fill(areas.reflections, tolerance, math.inf, "reflections", f"finite plate: its edges change more than {small}")
        fill(areas.rests, 1.0, math.inf, "quasi-static", "quasi-static: contact longer than the plate's period")
    panel.contourf(across, up, areas.motion, [-1.0, tolerance], colors=[REGIMES["half-space"][0]])  # above the others
    if left.any():
        infinite = kind if kind in ("plate", "rod") else "plate or rod"
        word = f"infinite {infinite}: no wave comes back while it moves"
        keys.append(Patch(facecolor=REGIMES["moving"][0], edgecolor="0.55", linewidth=0.6, label=word))
    return keys


def _stage_limits(panel: Axes, areas: Regimes) -> None:
    """Lines at which the contact yields and becomes fully plastic, with the names of the areas between them."""
    across, up = np.meshgrid(areas.lambdas, areas.ratios)
    left, white = areas.lambdas[0] * 1.25, {"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 1.0}
    for level, stroke, above in ((1.0, "-", "elastoplastic"), (FULLY_PLASTIC, "--", "fully plastic")):
        panel.contour(across, up, areas.depth, [level], colors="0.15", linewidths=1.4, linestyles=stroke)
        edge = float(np.interp(level, areas.depth[:, 0], areas.ratios))
        panel.text(left, edge * 1.2, above, va="bottom", color="0.15", bbox=white)
        if level == 1.0:
            panel.text(left, edge / 1.2, "elastic", va="top", color="0.15", bbox=white)


def _mark_scene(panel: Axes, areas: Regimes) -> str:
    """Draw the scene: a point, or a line if one of its numbers is unknown. Returns its place in words."""
    style: dict[str, Any] = {"color": HIGHLIGHT, "zorder": 5}
    value, ratio = areas.value, areas.ratio
    if value is not None and ratio is not None:
        at = np.clip(value, *areas.lambdas[[0, -1]]), np.clip(ratio, *areas.ratios[[0, -1]])
        label = "this scene" if at == (value, ratio) else "this scene, beyond the map"
        panel.plot(*at, "o", markersize=9, markeredgecolor="white", clip_on=False, label=label, **style)
        return f"λ = {value:.3g}, {_RATIO} = {ratio:.3g}"
    if value is not None:
        panel.axvline(value, linewidth=1.8, label="this scene, yield velocity not known", **style)
        return f"λ = {value:.3g}, {_RATIO} not known"
    if ratio is not None:
        panel.plot(areas.lambdas[0], ratio, "<", markersize=11, clip_on=False, label="this scene, λ = 0", **style)
        return f"λ = 0, {_RATIO} = {ratio:.3g}"
    panel.plot([], [], " ", label="this scene has neither λ nor a yield velocity")
    return "neither number is known"
