"""Warnings about a law in the impact at hand: restitution that rises with velocity, and depths beyond its fit."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.problem.problem import Problem


def law_warnings(problem: Problem, depth: Any = None) -> list[str]:
    """Sentences about the law of one impact or of many. depth: largest indentations over δ_s."""
    reached = np.atleast_1d(np.asarray(problem.trial.summary.maximum_indentation if depth is None else depth, float))
    speed = np.atleast_1d(np.asarray(problem.scales.velocity, float))
    name, said = problem.law.name, list[str]()
    for rise in problem.curve.rises:
        inside = (reached > rise.shallow) & (reached < rise.deep)
        if inside.any():
            slow, fast = (value * float(speed[inside][0]) for value in (rise.slow, rise.fast))
            said.append(
                f"law {name}: its restitution rises with velocity{_share(inside)}: from {rise.low:.3f} at "
                f"{slow:.4g} m/s to {rise.high:.3f} at {fast:.4g} m/s on a fixed target; measured, it falls"
            )
    deepest = float(np.nanmax(reached, initial=0.0))
    outside = problem.law.outside(deepest)
    if outside:
        said.append(f"law {name}: outside its range: {outside}")
    return said


def _share(inside: NDArray[np.bool_]) -> str:
    return "" if inside.size == 1 else f" in {np.count_nonzero(inside)} of {inside.size} impacts"
