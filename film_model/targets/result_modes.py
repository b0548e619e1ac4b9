"""Vibrations in results of finite-element programs, before a place and a direction are chosen."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from film_model.base.arrays import Array


@dataclass
class ResultModes:
    """Vibrations by their number: ω², (rad/s)²; modal mass, where the file has it; and the displacements
    of each node along x, y and z of its own system, in units of the model."""

    square: dict[int, float] = field(default_factory=dict)
    mass: dict[int, float] = field(default_factory=dict)
    shape: dict[int, dict[int, tuple[float, float, float]]] = field(default_factory=dict)

    def add(self, path: Path, number: int, square: float) -> dict[int, tuple[float, float, float]]:
        """A vibration, and where its displacements go."""
        if number in self.shape:
            raise ValueError(f"{path}: vibration {number} is there twice: export those of one subcase")
        self.square[number] = square
        return self.shape.setdefault(number, {})

    def at(self, path: Path, nodes: list[int]) -> tuple[Array, Array, Array]:
        """Frequencies, Hz, modal masses and displacements (vibration, node, x y z), by ascending frequency. Raises
        ValueError without vibrations, a node or a modal mass, or with an eigenvalue below 0."""
        if not self.shape:
            raise ValueError(f"{path} has no real vibrations: a modal analysis (Nastran: solution 103) is needed")
        numbers = sorted(self.shape, key=self.square.__getitem__)
        for number in numbers:
            for node in nodes:
                if node not in self.shape[number]:
                    raise ValueError(f"{path}: vibration {number} has no node {node}")
        moved = np.array([[self.shape[number][node] for node in nodes] for number in numbers])
        if not self.mass and all(self._largest(number) == 1.0 for number in numbers):
            raise ValueError(f"{path}: the largest displacement of every vibration is 1: its modal mass is needed, "
                             "or vibrations normalised by mass")  # fmt: skip
        square = np.array([self.square[number] for number in numbers])
        if not (np.isfinite(moved).all() and np.isfinite(square).all()):
            raise ValueError(f"{path}: a number is not finite")
        if square[0] < -1e-6 * square[-1]:
            raise ValueError(f"{path}: an eigenvalue is {square[0]:g}: the structure is unstable")
        mass = np.array([self.mass.get(number, 1.0) for number in numbers])
        return np.sqrt(np.maximum(square, 0.0)) / (2.0 * math.pi), mass, moved

    def _largest(self, number: int) -> float:
        return max(abs(part) for moved in self.shape[number].values() for part in moved)
