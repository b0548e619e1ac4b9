"""How an impact on a vibrating target is followed: formulas, which the page records, of numbers of its impacts."""

from __future__ import annotations

import math
from typing import Any

from film_model.base.arrays import either, greater, root
from film_model.problem.problem import Problem
from film_model.problem.summary import radiated

FIRST_PHASE = 24.0
"""Highest frequency of the first run times the time from touch to the deepest point."""


def following(problem: Problem, still: Any, compliance: Any, lowest: Any) -> tuple[Any, Any]:
    """Time limit, s, and least highest frequency of the first run, rad/s. still: the core's summary of the impact on a
    fixed target. compliance: of the target, m/N. lowest: frequency of its vibrations, rad/s, or 0."""
    # Time limit over the sum of contact times on a fixed target and on the static stiffness, and the longest period
    longest = 3.0
    unit, bends = problem.scales.time, lowest > 0.0
    slow, period = math.pi * root(problem.mass * compliance), 2.0 * math.pi / either(bends, lowest, math.inf)
    limit = longest * (still.contact_duration * unit + slow + period)
    return limit, greater(FIRST_PHASE / (still.time_of_maximum_indentation * unit), 4.0 * lowest)


def transferred(problem: Problem, core: Any, damped: Any, energy: Any) -> Any:
    """Energy that went into the target: that of the modes or, if these are damped, the remainder in the balance."""
    return either(damped, radiated(problem, core), energy)
