"""How an impact on a vibrating target is followed: formulas, which the page records, of numbers of its impacts."""

from __future__ import annotations

import math
from typing import Any

from film_model.base.arrays import either, greater, lesser, logarithm, root
from film_model.problem.problem import Problem

MODES_FACTOR = 3.0
"""Bound on the error of a run over its difference to a run with half the highest frequency.

`benchmarks/random_structures.py` compares estimates with errors: of 400 impacts 397 have smaller ones.
"""

MODES_FALL = 8.0
"""By how much doubling the highest frequency divides the error at least. If a difference falls by more, two runs may
agree by chance: the estimate is then from the difference before. With 4 and with 12 as many errors are bounded."""

IMPULSES = 80.0
"""Factor of the impulse that scales the tolerance of a step. With half or twice as much impacts take about as long."""

FIRST_PHASE = 24.0
"""Highest frequency of the first run times the time from touch to the deepest point."""


def swiftness(problem: Problem, core: Any, shares: Any, highest: Any) -> Any:
    """Rate at which the contact follows the structure, 1/s: its stiffness times the sum of the modes' shares [1/kg],
    which is about proportional to the highest frequency [rad/s], over that."""
    deep, scales = core.maximum_indentation > 0.0, problem.scales
    stiffness = either(deep, core.maximum_force / either(deep, core.maximum_indentation, 1.0), 0.0)
    return stiffness * scales.force / scales.length * shares / highest


def step_share(problem: Problem, core: Any, swift: Any) -> Any:
    """Factor of the steps' tolerance, at most 1: the impulse of the largest force over the time that contact takes to
    follow the structure, times `IMPULSES`, over the momentum. An error as large would change that force as much."""
    slowest = 1e-3  # velocity of an impact without one, over δ_s/t_s, as in the core
    rate, impulse = swift * problem.scales.time, IMPULSES * core.maximum_force
    moves = rate > 0.0
    return either(moves, lesser(1.0, impulse / (either(moves, rate, 1.0) * greater(problem.approach, slowest))), 1.0)


def softness(problem: Problem, core: Any) -> Any:
    """Compliance of the contact, m/N: largest indentation over largest force."""
    unit, pressed = problem.scales.length / problem.scales.force, core.maximum_force > 0.0
    return either(pressed, core.maximum_indentation / either(pressed, core.maximum_force, 1.0) * unit, 0.0)


def following(problem: Problem, still: Any, compliance: Any, lowest: Any) -> tuple[Any, Any]:
    """Time limit, s, and least highest frequency of the first run, rad/s. still: the core's summary of the impact on a
    fixed target. compliance: of the target, m/N. lowest: frequency of its vibrations, rad/s, or 0."""
    # Time limit over the sum of contact times on a fixed target and on the static stiffness, and the longest period
    longest = 3.0
    unit, bends = problem.scales.time, lowest > 0.0
    slow, period = math.pi * root(problem.mass * compliance), 2.0 * math.pi / either(bends, lowest, math.inf)
    limit = longest * (still.contact_duration * unit + slow + period)
    return limit, greater(FIRST_PHASE / (still.time_of_maximum_indentation * unit), 4.0 * lowest)


def error_of(damped: bool, before: Any, change: Any) -> Any:
    """Bound on the error of a run, of a law with damping or without. change: its difference to a run with half the
    highest frequency; before: the same of that run."""
    # the omitted compliance of damped laws is a mode: their errors are up to 4 times the difference
    factor, fall = (5.0, 4.0) if damped else (MODES_FACTOR, MODES_FALL)
    return factor * greater(change, before / fall)


def falling(estimate: Any, earlier: Any, higher: Any) -> Any:
    """Estimate with vibrations up to `higher` times the highest frequency, if it falls as since a quarter of it,
    where it was `earlier`: forces of damped laws may begin so suddenly that they show ever higher ones."""
    return estimate * lesser(estimate / earlier, 1.0) ** (logarithm(higher) / math.log(4.0))
