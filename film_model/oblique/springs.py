"""Friction in any contact, by many springs beside each other that slip: for laws that yield or are damped.

The core has the springs (core/springs.py). Errors fall as the square of one over their number; they are
estimated from half and a quarter of both.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import add, sub
from typing import Any, NamedTuple

from film_model.base.arrays import Array, Number, either, greater, lesser
from film_model.base.errors import SimulationError
from film_model.core import springs as core
from film_model.oblique.result import error_of_force
from film_model.scene.rolling import Sliding

SPRINGS = 256
STEPS = 2048
EASY, FEWEST = 8, 128
"""Up to EASY contacts have STEPS steps each; more contacts share as many in all, but each has FEWEST at least."""

SAFETY = 0.8
"""Of the error that half and a quarter of the springs and steps tell (tests/test_friction_estimate.py)."""

LEVELS = ((32, 128), (48, 192), (64, 256), (96, 384), (128, 512), (SPRINGS, STEPS))
"""Springs and steps in batches, as many as the accuracy needs. Half of the steps are before the turn."""

TURN = 3.0
"""Error of the sliding velocity over that before, of a contact whose radius jumps at the turn, in steps of the contact
(test_brackets_of_contacts_that_yield)."""

SLIDING = 1e-6
"""Share of the impulse of friction that may lack to its limit where the closed form of sliding throughout holds."""


def judged(
    ends: Sequence[Number] | Array, errors: Sequence[Number] | Array, steps: Number, before: Number, normal: Number
) -> tuple[Number, Any]:
    """Error of the sliding velocity over that before, and its bounds after an impact under two models of a contact that
    yields, less and plus their errors; None of one model. ends, errors: of the runs of the models in so many steps,
    m/s. before: of sliding, m/s. normal: relative error of the normal force."""
    of_force = error_of_force(normal)
    error = errors[0] / before + of_force
    if len(errors) == 1:
        return error, (None, None)
    off = error * before, greater(errors[1], TURN * before / steps) + of_force * before
    return error, (lesser(*map(sub, ends, off)), greater(*map(add, ends, off)))


def normal_error(estimated: Any, seen: Any, impulse: Any) -> Any:
    """Relative error of the normal force: that of its motion, or what its samples miss of the impulse."""
    return greater(estimated, abs(seen / impulse - 1.0))


def ended(slack: Number, slides: Number, after: Number) -> Number:
    """The sliding velocity after a run, m/s: of a contact that slides throughout, where the run does."""
    return either(slack <= SLIDING, slides, after)


class Run(NamedTuple):
    """The sliding velocity, m/s, the friction force, N, and the radius inside which all sticks, m, at the times; after:
    the last velocity; regime: place in `REGIMES`; slack: what friction lacks to its limit, a share of the impulse;
    estimated: error of any velocity, m/s; phases: time, s, and kind."""

    velocity: Array
    force: Array
    stuck: Array
    after: float
    regime: int
    slack: float
    estimated: float
    phases: list[tuple[float, int]]


def steps_of(contacts: Any) -> Any:
    """Steps of each of so many contacts."""
    return greater(STEPS * EASY // greater(contacts, EASY) // 4 * 4, FEWEST)


def tangential(given: Sliding, power: float, times: Array, force: Array, radius: Array) -> Run:
    """The tangential motion over contacts that follow each other, each at evenly spaced times, s, (contacts, times).
    power: of the contact radius with which the depth grows. force: F ≥ 0, N. radius: of the contact, m; both 0 without
    contact. Raises SimulationError for numbers out of range."""
    numbers = float(given.modulus), power, float(given.mass), float(given.velocity)
    found, motion = core.impact(SPRINGS, numbers, given.pairs, times[:, 1] - times[:, 0], force, radius, times[:, 0])
    if found is None:
        raise SimulationError("friction: a number is out of the range of the springs")
    velocity, friction, stuck = motion.T
    error, phases = SAFETY * found.error, found.watch.phases
    return Run(velocity, friction, stuck, found.velocity, found.regime, found.slack, error, phases)
