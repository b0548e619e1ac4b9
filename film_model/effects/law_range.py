"""Warnings about a law in the impact at hand: restitution that rises with velocity, and depths beyond its fit."""

from __future__ import annotations

from typing import Any

import numpy as np

from film_model.base.arrays import any_of, largest
from film_model.problem.problem import Problem


def law_warnings(problem: Problem, depth: Any = None) -> list[str]:
    """Sentences about the law of one impact or of many. depth: largest indentations over δ_s."""
    reached = problem.trial.summary.maximum_indentation if depth is None else depth
    name, said = problem.law.name, list[str]()
    for rise in problem.curve.rises:
        inside = (reached > rise.shallow) & (reached < rise.deep)
        if any_of(inside):
            speed = problem.scales.velocity
            speed = float(speed[inside][0]) if isinstance(inside, np.ndarray) else speed
            slow, fast = rise.slow * speed, rise.fast * speed
            said.append(
                f"law {name}: its restitution rises with velocity{_share(inside)}: from {rise.low:.3f} at "
                f"{slow:.4g} m/s to {rise.high:.3f} at {fast:.4g} m/s on a fixed target; measured, it falls"
            )
    outside = problem.law.outside(largest(reached))
    if outside:
        said.append(f"law {name}: outside its range: {outside}")
    return said


def _share(inside: Any) -> str:
    if not isinstance(inside, np.ndarray) or inside.size == 1:
        return ""
    return f" in {np.count_nonzero(inside)} of {inside.size} impacts"
