"""Bodies of a chain on a target that vibrates: its vibrations for the core, with as many as the accuracy needs.

Those above the highest frequency are one more at each point that is touched, as in :mod:`film_model.solve.structures`:
with the static compliance that the others lack there.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import TooManyModes
from film_model.core import chaining, native
from film_model.core.refining import MOST_FOLLOWED, error_of
from film_model.problem.chain_contacts import ChainContact, speed_of
from film_model.scene.chain import Chain, Link
from film_model.solve.mode_formulas import FIRST_PHASE
from film_model.solve.structures import rounded
from film_model.targets import AbstractTarget, Modes
from film_model.targets.ritz_errors import raised
from film_model.targets.several import omitted, seen

STEP = 0.01
"""Tolerance of a step over the accuracy."""


class Followed(NamedTuple):
    """How a chain was followed: up to which frequency of the target, rad/s, and with which tolerance of a step. softer:
    with the errors of the frequencies and of the static compliances added to them."""

    highest: float
    tolerance: float
    softer: bool = False


@dataclass(frozen=True)
class Structure:
    """A target that vibrates, with the points where it is touched: sensors, or its own. No other target has points."""

    target: AbstractTarget | None
    points: tuple[str, ...]

    @classmethod
    def of(cls, chain: Chain) -> Structure:
        """That of a chain."""
        touched = dict.fromkeys(link.at for link in chain.links if None in link[:2])
        return cls(chain.target, tuple(touched)) if chain.vibrates else cls(None, ())

    def place(self, link: Link) -> tuple[int, int]:
        """Point and side of the structure that a link touches, as the core takes them."""
        if not self.points or None not in link[:2]:
            return -1, 0
        return self.points.index(link.at), 1 if link.behind is None else -1

    @property
    def inexact(self) -> bool:
        """Whether the static compliances have errors, and frequencies may have."""
        return self.target is not None and self.target.compliance_error > 0.0

    def at_links(self, chain: Chain, points: Array) -> Array:
        """Of the motions of the points, (points, times), that at each link; 0 away from the target."""
        found = np.zeros((len(chain.links), points.shape[1]))
        for k, link in enumerate(chain.links):
            if (place := self.place(link)[0]) >= 0:
                found[k] = points[place]
        return found

    def vibrations(self, followed: Followed, mass: float, time: float) -> chaining.Vibrations:
        """The vibrations for the core, in units of mass [kg] and time [s]."""
        if self.target is None:
            return chaining.RIGID
        square, drag, shapes = _vibrations(self.target, self.points, followed.highest, followed.softer)
        return chaining.Vibrations(square * time**2, drag * time, shapes * math.sqrt(mass))


def _vibrations(target: AbstractTarget, points: tuple[str, ...], highest: float, softer: bool) -> chaining.Vibrations:
    """The same in SI. A vibration stands for those above the highest at each point."""
    rounding = 1e-9  # part of the static compliance that is rounding
    found = seen(target, points, highest)
    count = found.frequency.size
    if count > MOST_FOLLOWED:
        raise TooManyModes(
            f"{count} natural vibrations would be needed, more than {MOST_FOLLOWED}: give a lower accuracy"
        )
    inexact = target.inexact if softer else None
    frequency, _ = raised(inexact, found.frequency, found.frequency, highest)
    more = np.zeros((len(found.shapes), len(points)))
    for k, point in enumerate(points):
        modes = Modes(found.frequency, found.shapes[k] ** 2)
        lacking, error = omitted(target, point, modes, highest)
        error += raised(inexact, modes.frequency, modes.share, highest)[1]
        more[k, k] = math.sqrt(lacking * (lacking > rounding * modes.compliance) + error * softer)
    above = np.full(len(points), 1.5 * highest)  # frequency of the modes that stand for the omitted ones
    drag = np.append(2.0 * found.ratio * frequency, 0.0 * above)
    frequency = np.append(frequency, above)
    used = np.append(np.ones(count, dtype=bool), more.any(axis=0))
    return chaining.Vibrations(
        *(part[..., used] for part in (frequency**2, drag, np.hstack([found.shapes, more * above])))
    )


def first_frequency(chain: Chain, contacts: list[ChainContact]) -> float:
    """Highest frequency of the first run, rad/s, from the time to the deepest point of the quickest contact."""
    to_deepest = 1.5  # time to the deepest point of Hertz's contact over depth and velocity: 1.47
    quickest = min(contact.length * contact.depth for contact in contacts) / speed_of(chain)
    return rounded(FIRST_PHASE / (to_deepest * quickest))


def refined(
    run: Callable[[Followed], chaining.Run],
    difference: Callable[[chaining.Run, chaining.Run], float],
    accuracy: float,
    first: float,
    damped: bool,
    inexact: bool,
) -> tuple[chaining.Run, Followed, float]:
    """The run with as many vibrations as the accuracy needs, how it was followed, and its error estimate.

    first: highest frequency of the first run, rad/s. It is doubled until three runs agree, as in
    `film_model.solve.vibration.vibrate`. damped: whether a law is. inexact: whether frequencies or static
    compliances have errors; their effect is that of one more run.
    """
    growth = 5  # work of a run over that of one with half the highest frequency, about
    followed, runs, work, estimated = [Followed(first, STEP * accuracy)], list[chaining.Run](), 0, math.inf
    while True:
        try:
            runs.append(run(followed[-1]))
        except TooManyModes:
            if len(runs) < 2:
                raise
            break
        if runs[-1].status < 0:
            if len(runs) < 3 or runs[-1].status != native.TOO_MANY:
                return runs[-1], followed[-1], math.inf
            runs.pop()
            break
        work += runs[-1].work
        changes = [difference(*pair) for pair in pairwise(runs[-3:])]
        if changes:
            estimated = float(error_of(damped, changes[0], changes[-1])) + followed[-1].tolerance
        if len(runs) > 2 and (estimated <= accuracy or work + growth * runs[-1].work > chaining.MOST_WORK):
            break
        followed.append(Followed(2.0 * followed[-1].highest, followed[-1].tolerance))
    last = len(runs) - 1
    if inexact:
        estimated += difference(run(followed[last - 1]._replace(softer=True)), runs[last - 1])
    return runs[last], followed[last], estimated
