"""The picture of an oblique impact as a strobe sees it: the ball at even times before and after, with its spin."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from film_model.base.foreign import Figure
from film_model.base.units import format_si
from film_model.plot.style import COLOURS, HIGHLIGHT, picture, plain
from film_model.solve.history import History

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BALLS = 4
"""Before and after the impact, beside the ball in contact."""

SPACING = 2.3
"""Distance of the balls on the faster path, in radii."""

SIZE, BOX = (8.0, 4.6), (0.02, 0.09, 0.96, 0.72)
"""Inches; left, bottom, width and height of the panel as fractions of them."""

BEFORE, AFTER = COLOURS[0], HIGHLIGHT


class Seen(NamedTuple):
    """A ball at a flash. time: from the impact, s. x: along the surface, z: height of the centre above it, m. turn: by
    which it has turned since the impact, rad, positive if its lowest point moves along x."""

    time: float
    x: float
    z: float
    turn: float


class Path(NamedTuple):
    """Velocities of a ball along the surface and away from it, m/s, and its spin, rad/s."""

    along: float
    away: float
    spin: float


def paths(history: History) -> tuple[Path, Path]:
    """Before and after the impact.

    Raises ValueError if contact did not end, or for an impact at an angle or with spin whose friction is not given.
    """
    ball, rebound = history.scene.impactor, history.summary["rebound_velocity"]
    if not history.scene.is_round:
        raise ValueError("a strobe picture shows a ball, and this contact is not one")
    if rebound is None:
        raise ValueError("a strobe picture shows the rebound, but contact does not end")
    before = Path(ball.tangential_speed, -ball.speed, ball.spin or 0.0)
    if history.oblique is not None:
        found = history.oblique.summary
        return before, Path(found["tangential_rebound_velocity"], -rebound, found["rebound_spin"])
    if history.scene.contact.friction is None and (before.along != 0.0 or before.spin != 0.0):
        raise ValueError("a strobe picture of an impact at an angle or with spin needs friction in [contact]")
    return before, before._replace(away=-rebound)


def flashes(history: History) -> tuple[float, list[Seen]]:
    """Time between two flashes, s, and the balls, that at first touch in the middle. Contact is taken as a moment."""
    radius = history.scene.impactor.radius
    pair = paths(history)
    interval = SPACING * radius / max(math.hypot(path.along, path.away) for path in pair)
    return interval, [
        Seen(t, path.along * t, radius + path.away * t, path.spin * t)
        for k in range(-BALLS, BALLS + 1)
        for t, path in [(k * interval, pair[k > 0])]
    ]


def plot_strobe(history: History, path: str | os.PathLike[str] | None = None, dpi: float = 200.0) -> Figure:
    """The ball at even times before and after the impact; a radius shows how far it has turned.

    Files, errors and dpi: see `style.picture`; ValueError also for an impact without a known rebound.
    """
    interval, seen = flashes(history)
    return picture(path, lambda figure: _draw(figure, history, interval, seen), SIZE, dpi)


def _draw(figure: Figure, history: History, interval: float, seen: list[Seen]) -> None:
    from matplotlib.patches import Circle

    panel: Axes = figure.add_axes(BOX)
    radius, target = history.scene.impactor.radius, history.scene.target
    for k, ball in enumerate(seen):
        colour = BEFORE if ball.time < 0.0 else AFTER if ball.time > 0.0 else "0.3"
        faint = 0.35 + 0.65 * (k + 1) / len(seen)
        panel.add_patch(Circle((ball.x, ball.z), radius, fill=False, color=colour, alpha=faint, linewidth=1.2))
        tip = ball.x + radius * math.sin(ball.turn), ball.z - radius * math.cos(ball.turn)
        panel.plot([ball.x, tip[0]], [ball.z, tip[1]], color=colour, alpha=faint, linewidth=1.2)
    panel.plot([ball.x for ball in seen], [ball.z for ball in seen], ":", color="0.5", linewidth=0.8, zorder=0)
    left, right = (end(ball.x for ball in seen) for end in (min, max))
    low, high = -0.6 * radius, max(ball.z for ball in seen) + 1.1 * radius
    inch = max((right - left + 2.4 * radius) / (SIZE[0] * BOX[2]), (high - low) / (SIZE[1] * BOX[3]))  # m
    middle, half = 0.5 * (left + right), 0.5 * inch * SIZE[0] * BOX[2]
    panel.set(xlim=(middle - half, middle + half), ylim=(low, low + inch * SIZE[1] * BOX[3]))
    if math.isinf(target.radius):
        panel.fill_between([middle - half, middle + half], low, 0.0, color="0.85", linewidth=0.0)
    elif target.radius < 0.0:  # a hollow
        x = np.linspace(-1.0, 1.0, 201) * min(half, -target.radius)
        panel.fill_between(x, low, -target.radius - np.sqrt(target.radius**2 - x * x), color="0.85", linewidth=0.0)
    else:
        panel.add_patch(Circle((0.0, -target.radius), target.radius, color="0.85"))
    panel.set_axis_off()
    title = " ".join((history.scene.title or f"Impact on a {target.kind}").split())
    figure.text(0.02, 0.93, plain(title), fontsize=min(12.0, 760.0 / len(title)), fontweight="bold")
    for height, (word, text, colour) in zip((0.885, 0.845), _words(history), strict=True):
        figure.text(0.02, height, f"{word}: {text}", fontsize=8, color=colour)
    figure.text(0.02, 0.03, f"one picture every {format_si(interval, 'time', 3)}", fontsize=8, color="0.25")


def _words(history: History) -> Iterator[tuple[str, str, str]]:
    """Speed, angle to the normal and spin before and after."""
    for word, path, colour in zip(("before", "after"), paths(history), (BEFORE, AFTER), strict=True):
        speed = format_si(math.hypot(path.along, path.away), "velocity", 3)
        angle = math.degrees(math.atan2(path.along, abs(path.away)))
        spin = format_si(path.spin, "angular_frequency", 3)
        yield word, f"{speed} at {angle:.3g}° to the normal, spin {spin}".replace("-", "−"), colour
