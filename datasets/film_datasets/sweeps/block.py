"""One block of a sweep."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Block:
    """A part of a sweep: its region of the arrays, and its impacts `first` … `first + count - 1` in C order."""

    region: tuple[slice, ...]
    first: int
    count: int

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the region."""
        return tuple(part.stop - part.start for part in self.region)
