"""Vibrations in results of finite-element programs, before a place and a direction are chosen."""

from __future__ import annotations

import heapq
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from film_model.base.arrays import Array

ROUNDED = 1e-6
"""Difference from 1 up to which the largest displacements of vibrations are those of shapes normalised to 1."""

Moved = Mapping[int, Sequence[float]]
"""Displacements by node, along x, y and z of its own system."""


def frequency_of(square: float) -> float:
    """In Hz, of ω², (rad/s)²; below 0 where that is."""
    return math.copysign(math.sqrt(abs(square)), square) / (2.0 * math.pi)


@dataclass
class ResultModes:
    """Vibrations by their number: frequency, Hz, nan if unknown; modal mass and damping ratio, where the file has them;
    and displacements, in units of the model.

    normalised: whether shapes without modal masses are of mass 1. unit: whether the largest displacement or rotation
    of every vibration is 1; None if displacements show it. places: of the nodes, where the file has them and the user
    may not know the numbers.
    """

    frequency: dict[int, float] = field(default_factory=dict)
    mass: dict[int, float] = field(default_factory=dict)
    damping: dict[int, float] = field(default_factory=dict)
    shape: dict[int, Moved] = field(default_factory=dict)
    normalised: bool = True
    unit: bool | None = None
    places: Moved = field(default_factory=dict)

    def add(self, path: Path, number: int, frequency: float) -> dict[int, Sequence[float]]:
        """A vibration, and where its displacements go."""
        if number in self.shape:
            raise ValueError(f"{path}: vibration {number} is there twice: export those of one analysis")
        self.frequency[number] = frequency
        self.shape[number] = moved = dict[int, Sequence[float]]()
        return moved

    def complete(self, path: Path, frequencies: list[float], masses: list[float]) -> None:
        """Take frequencies, Hz, and modal masses, of each vibration by number, in place of the file's, unless empty.

        One mass is that of all vibrations; 1 says that shapes are normalised by mass.
        """
        numbers = sorted(self.shape)
        for option, given in (("--frequencies", frequencies), ("--modal-masses", masses)):
            if given and len(given) != len(numbers) and (option == "--frequencies" or len(given) > 1):
                raise ValueError(f"{option}: {len(given)} values for {len(numbers)} vibrations in {path}")
        self.frequency |= dict(zip(numbers, frequencies, strict=False))
        if masses:
            self.normalised = set(masses) == {1.0}
            each = masses * len(numbers) if len(masses) == 1 else masses
            self.mass = {} if self.normalised else dict(zip(numbers, each, strict=True))

    def at(self, path: Path, nodes: list[int]) -> tuple[Array, Array, Array, Array | None]:
        """Frequencies, Hz, modal masses, displacements (vibration, node, x y z), and damping ratios if one is not 0, by
        ascending frequency. Raises ValueError without vibrations, a node, a frequency or a modal mass, or with an
        eigenvalue below 0."""
        if not self.shape:
            need = "a modal analysis (Nastran: solution 103; Abaqus and CalculiX: *FREQUENCY) is needed"
            raise ValueError(f"{path} has no real vibrations: {need}")
        if any(math.isnan(frequency) for frequency in self.frequency.values()):
            raise ValueError(
                f"{path} has no frequencies: give --frequencies, {len(self.shape)} in the order of the shapes"
            )
        numbers = sorted(self.shape, key=self.frequency.__getitem__)
        for number in numbers:
            for node in nodes:
                if node not in self.shape[number]:
                    near = heapq.nsmallest(2, self.shape[number], key=lambda known: (abs(known - node), known))
                    told = f"; the nearest numbers are {' and '.join(map(str, sorted(near)))}" if near else ""
                    raise ValueError(f"{path}: vibration {number} has no node {node}{told}")
        moved = np.array([[self.shape[number][node] for node in nodes] for number in numbers])
        if not self.mass and not self.normalised:
            raise ValueError(f"{path} does not say how its shapes are normalised: give --modal-masses, 1 if by mass")
        unit = self.unit
        if unit is None:
            unit = all(abs(self._largest(number) - 1.0) < ROUNDED for number in numbers)
        if unit and not self.mass:
            need = "its modal mass is needed (--modal-masses), or vibrations normalised by mass"
            raise ValueError(f"{path}: the largest displacement of every vibration is 1: {need}")
        frequency = np.array([self.frequency[number] for number in numbers])
        if not (np.isfinite(moved).all() and np.isfinite(frequency).all()):
            raise ValueError(f"{path}: a number is not finite")
        if frequency[0] < -1e-3 * frequency[-1]:
            square = -((2.0 * math.pi * frequency[0]) ** 2)
            raise ValueError(f"{path}: an eigenvalue is {square:g}: the structure is unstable")
        mass = np.array([self.mass.get(number, 1.0) for number in numbers])
        damping = np.array([self.damping.get(number, 0.0) for number in numbers])
        return np.maximum(frequency, 0.0), mass, moved, damping if damping.any() else None

    def _largest(self, number: int) -> float:
        return max(abs(part) for moved in self.shape[number].values() for part in moved)
