"""A hard case, and what was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from film_model.laws import AbstractLaw

ACCURACY = 1e-11
"""Relative accuracy that the mesh of an impact is refined to."""

ALLOWED = 1e-9
"""Largest relative error of any summary value, unless a case states a larger one."""

STEPPED = 1e-11
"""Largest difference of steps, batches and balances, relative to the largest value of each kind."""


@dataclass(frozen=True)
class Finding:
    """The result of a case: outcome, largest relative error, allowed error, segments per stage, and for a single impact
    the relative error of the balance of momentum or energy."""

    outcome: str
    error: float
    allowed: float = ALLOWED
    segments: int | None = None
    balance: float | None = None

    @property
    def good(self) -> bool:
        """Whether the case passed."""
        return self.error <= self.allowed


@dataclass(frozen=True)
class HardCase:
    """One case. run: examines it. impact: law, mass, velocity and impedance of a case that is a single impact."""

    name: str
    why: str
    run: Callable[[], Finding]
    impact: tuple[AbstractLaw, float, float, float] | None = None
