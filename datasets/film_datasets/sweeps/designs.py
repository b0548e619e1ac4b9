"""Designs: how the impacts of a sweep are placed, the points of the sampled ones, and the parts that are computed."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array
from film_model.base.errors import Mistake, did_you_mean, shown

GRID, ZIP = "grid", "zip"
SAMPLED = ("random", "sobol", "latin-hypercube")
DESIGNS = (GRID, ZIP, *SAMPLED)

MOST_SAMPLES = {"random": 2**53, "sobol": 2**30, "latin-hypercube": 20_000_000}
"""Largest number of impacts of a sampled design; a Latin hypercube is a permutation of 4 bytes an
impact and dimension held in memory."""


class Points:
    """Points of a sampled design in the unit cube.

    Any range of them can be asked for, by any worker and in any order, and is always the same.
    """

    def __init__(self, design: str, dimensions: int, samples: int, seed: int) -> None:
        self._design, self._dimensions, self._samples, self._seed = design, dimensions, samples, seed
        self._lock, self._engine, self._next = threading.Lock(), None, 0

    def __call__(self, first: int, count: int) -> Array:
        """Points first … first + count - 1: (count, dimensions) numbers between 0 and 1."""
        if self._design == "random":
            return self._random(first, count)
        if self._design == "sobol":
            return self._sobol(first, count)
        return self._latin_hypercube(first, count)

    def _random(self, first: int, count: int) -> Array:
        words, per_step = first * self._dimensions, 4  # Philox makes four numbers in a step of its counter
        generator = np.random.Philox(key=self._seed)
        generator.advance(words // per_step)
        numbers = np.random.Generator(generator).random(words % per_step + count * self._dimensions)
        return numbers[words % per_step :].reshape(count, self._dimensions)

    def _latin_hypercube(self, first: int, count: int) -> Array:
        """Bit for bit SciPy's `qmc.LatinHypercube`, which needs 16 times the memory: of its numbers only the
        permutations are kept, and the offsets within the cells are drawn again where they are asked for."""
        cells = _cells(self._dimensions, self._samples, self._seed)[:, first : first + count]
        generator = _offsets(self._seed).advance(first * self._dimensions)
        return (cells.T - np.random.Generator(generator).random((count, self._dimensions))) / self._samples

    def _sobol(self, first: int, count: int) -> Array:
        """Sobol's sequence, scrambled (Owen). SciPy's engine only goes forward: a range behind it needs a new one."""
        from scipy.stats import qmc  # lazy: importing scipy.stats takes 1 s

        with self._lock:
            if self._engine is None or first < self._next:
                self._engine, self._next = qmc.Sobol(self._dimensions, scramble=True, rng=self._seed), 0
            if first > self._next:
                self._engine.fast_forward(first - self._next)
            self._next = first + count
            # the first point is drawn alone: SciPy warns if the first draw's size is not a power of two
            draws = (1, count - 1) if first == 0 else (count,)
            return np.concatenate([self._engine.random(draw) for draw in draws if draw])


@lru_cache(maxsize=1)
def _cells(dimensions: int, samples: int, seed: int) -> NDArray[np.int32]:
    """The cells of a Latin hypercube, 1 … samples, along each dimension."""
    generator = np.random.Generator(_offsets(seed).advance(samples * dimensions))  # after the offsets
    cells = np.empty((dimensions, samples), np.int32)
    for row in cells:
        row[:] = np.arange(1, samples + 1, dtype=np.int32)
        generator.shuffle(row)
    return cells


def _offsets(seed: int) -> np.random.PCG64:
    """The generator of SciPy's engines for a seed."""
    return np.random.PCG64(np.random.SeedSequence(seed).spawn(1)[0])


@lru_cache(maxsize=4)
def points(design: str, dimensions: int, samples: int, seed: int) -> Points:
    """The points of a design: one object per process, so that its Sobol engine is shared by all threads."""
    return Points(design, dimensions, samples, seed)


def option_mistakes(design: object, samples: object, seed: object) -> list[Mistake]:
    """Mistakes of a design and of its number of samples and seed."""
    found: dict[str, str] = {}
    if design not in DESIGNS:
        words = ", ".join(f'"{word}"' for word in DESIGNS)
        hint = did_you_mean(design, DESIGNS) if isinstance(design, str) else ""
        found["design"] = f"{shown(design)} is not allowed: one of {words} is needed{hint}"
    elif design not in SAMPLED:
        given = [key for key, value in (("samples", samples), ("seed", seed)) if value is not None]
        found |= {key: f'is not for design "{design}"' for key in given}
    else:
        most = MOST_SAMPLES[str(design)]
        if samples is None:
            found["samples"] = f'missing: design "{design}" needs the number of impacts'
        elif isinstance(samples, bool) or not isinstance(samples, int) or not 1 <= samples <= most:
            found["samples"] = f"{shown(samples)} is not allowed: a whole number from 1 to {most} is needed"
        if seed is not None and (isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64):
            found["seed"] = f"{shown(seed)} is not allowed: a whole number from 0 to 2^64 - 1 is needed"
    return [Mistake(None, None, key, message) for key, message in found.items()]


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
