"""A structure as several contacts see it: its vibrations and static compliances at the points where they are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.base.fields import build, table_of
from film_model.targets.beam import Beam
from film_model.targets.modes import Modes
from film_model.targets.plate import Plate
from film_model.targets.sensors import Sensor
from film_model.targets.structure import Structure
from film_model.targets.target import AbstractTarget

STRUCK = ""
"""Name of the target's own point of impact, beside those of its sensors."""

OFF_NODES = (math.sqrt(5.0) - 1.0) / 2.0, math.sqrt(2.0) - 1.0
"""A point over the sides of a plate that is on no node line of sines: of all fractions these are the farthest from
rational ones. From it all vibrations are seen."""


class Seen(NamedTuple):
    """Vibrations of a structure, by ascending frequency: ω, rad/s, ζ, and the shapes φ/√M, 1/√kg, (rows, modes): of the
    points, the sensors, and of what `AbstractTarget.strains` takes."""

    frequency: Array
    ratio: Array
    shapes: Array


def seen(target: AbstractTarget, points: Sequence[str], highest: float) -> Seen:
    """The vibrations up to the frequency `highest`, rad/s. points: names of sensors, or `STRUCK`."""
    unseen = 1e-12  # deflection over the largest, below which a vibration has nodes at all contacts and is left out
    names = [sensor.name for sensor in target.sensors or ()]
    if isinstance(target, Structure):
        modes = target.modes(highest)
        root = np.sqrt(modes.share)
        factor, own = modes.factor / root, root
    else:
        added = Sensor("'".join([*names, "struck"]), [f"{x!r} m" for x in _place(target, STRUCK)])
        modes = _moved(target, _off_nodes(target), (*(target.sensors or ()), added)).modes(highest)
        root = np.sqrt(modes.share)
        factor, own = modes.factor[:-1] / root, modes.factor[-1] / root
    rows = [own if point == STRUCK else factor[names.index(point)] for point in points]
    strains = modes.strain / root if modes.strain.size else np.zeros((0, root.size))
    reach = np.abs(rows).max(axis=0)
    kept = reach > unseen * reach.max(initial=0.0)
    shapes = np.vstack([*rows, factor, strains])[:, kept]
    return Seen(modes.frequency[kept], modes.damping_ratio[kept], shapes)


def omitted(target: AbstractTarget, point: str, modes: Modes, highest: float) -> tuple[float, float]:
    """Static deflection over force at a point of the vibrations above `highest` [rad/s], m/N, and a bound on its error.
    modes: those up to it, as seen there."""
    if point == STRUCK or not isinstance(target, Structure):
        return struck_at(target, point).omitted(modes, highest)
    found = seen(target, [point], math.inf)
    above = found.frequency > highest
    return float(((found.shapes[0, above] / found.frequency[above]) ** 2).sum()), 0.0


def struck_at(target: AbstractTarget, point: str) -> AbstractTarget:
    """A plate or beam struck at a point; SceneError where a support holds it. A structure as it is."""
    return target if isinstance(target, Structure) else _moved(target, _place(target, point), None)


def _moved(target: AbstractTarget, place: tuple[float, ...], sensors: tuple[Sensor, ...] | None) -> AbstractTarget:
    """The same struck elsewhere, m, with other sensors."""
    written = [f"{x!r} m" for x in place]
    table = table_of(target) | {"position": written if len(written) > 1 else written[0], "sensors": sensors}
    return build(type(target), table)


def _place(target: AbstractTarget, point: str) -> tuple[float, ...]:
    """A point of a plate or beam, m."""
    if point != STRUCK:
        return next(sensor.position or () for sensor in target.sensors or () if sensor.name == point)
    assert isinstance(target, Plate | Beam)
    return target.struck if isinstance(target, Plate) else (target.struck,)


def _off_nodes(target: AbstractTarget) -> tuple[float, ...]:
    assert isinstance(target, Plate | Beam)
    sides = target.size if isinstance(target, Plate) else (target.length,)
    return tuple(part * side for part, side in zip(OFF_NODES, sides or (), strict=False))
