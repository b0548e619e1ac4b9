"""Errors of the frequencies that Ritz's method finds, which are too high."""

from __future__ import annotations

from typing import Any

import numpy as np

from film_model.base.arrays import Array, either
from film_model.targets.ritz import Panel

CORNER, OTHER, HIGH = 3.5e-5, 2e-6, 6e-4
"""Relative errors of frequencies: of low ones with a corner between a clamped and a free edge, and without, and what
the highest have more. Those of half of the frequencies of a plate are smaller, of nine in ten at most twice as
large."""


def missed(over: Any, cornered: Any) -> Any:
    """By which part frequencies may be too high. over: they over the highest. cornered: as `Panel.cornered`."""
    return either(cornered, CORNER, OTHER) + HIGH * over**2


def raised(panel: Panel | None, frequency: Array, share: Array, highest: float) -> tuple[Array, float]:
    """Frequencies [rad/s] that are higher by the errors of a set up to twice the highest, and what the vibrations then
    lack of the deflection over force around the struck point, m/N: under a force that grows as bending crosses the
    shorter side, which long strips feel nearby alone. The same and 0 without a panel."""
    if panel is None:
        return frequency, 0.0
    higher, rate = frequency * (1.0 + missed(0.5 * frequency / highest, panel.cornered)), panel.crossing
    lacking = share / (frequency**2 + rate**2) - share / (higher**2 + rate**2)
    return higher, float(np.sum(lacking))
