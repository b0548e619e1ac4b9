"""One comparison of an FMU with the library."""

from __future__ import annotations

from dataclasses import dataclass

STEPS_TOLERANCE = 1e-12
"""Allowed difference between Co-Simulation and the library, relative to the largest value of a variable."""


@dataclass(frozen=True)
class Finding:
    """One comparison: its name, the largest difference, the allowed difference, and the place."""

    what: str
    difference: float
    allowed: float
    where: str = ""

    @property
    def good(self) -> bool:
        """Whether the difference is allowed."""
        return self.difference <= self.allowed

    def share(self) -> float:
        """The difference over what is allowed; 0 where there is none. For findings that are good."""
        return self.difference / self.allowed if self.difference else 0.0
