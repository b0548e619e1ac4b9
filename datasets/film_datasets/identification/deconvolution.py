"""A force from the motions that it caused: regularised deconvolution, with the time of the force among the unknowns.

The force is linear between even knots, and 0 up to the first and from the last on. Its second differences at the knots
and the noise are taken as independent normal numbers with the standard deviations τ and σ, so that the estimate
minimises |motion − response|² + (σ/τ)² |second differences|² (Tikhonov and Arsenin 1977). σ, τ and the first and last
knot are those with the largest marginal likelihood of the motions (generalised maximum likelihood, Wahba 1985, Annals
of Statistics 13:1378); the interval is that of the force's conditional distribution (Wahba 1983, J. R. Statist. Soc. B
45:133). A force that could last all the time would hardly be limited by accelerations, which do not show slow ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array, Index
from film_model.base.threads import one_thread

SHORTEST = 4
"""Rows of the shortest half-sine that the force may begin as, and fewest knots of a force."""

SINGULAR = 1e-15
"""Square of a singular value over the largest that is rounding."""

RATIOS = 10.0 ** np.linspace(-15.0, 0.0, 151)
"""(σ/τ)² that are tried, over the largest square of a singular value."""


@dataclass(frozen=True)
class Deconvolved:
    """rows: of the knots, in rows of the motions; the force is 0 at the first and the last. force, deviation: at the
    knots, and standard deviation. total, total_deviation: sum of the forces at the knots. step: rows between knots."""

    rows: Index
    force: Array
    deviation: Array
    total: float
    total_deviation: float
    step: int


class _Equations(NamedTuple):
    """AᵀA, Aᵀy, |y|² and the number of values, of the motions y by unit forces at the knots."""

    square: Array
    right: Array
    total: float
    values: int


@one_thread
def deconvolve(responses: Sequence[Array], motions: Sequence[Array]) -> Deconvolved:
    """The force behind motions, of equal noise and at rest in the first row. responses: of each, by row, to a force
    that rises evenly from 0 a row before the first to 1 in the first, and falls to 0 in the second."""
    first, last = _half_sine(responses, motions)
    width, count = last - first, motions[0].size
    # with so many times its length on both sides, where further contacts may be
    starts = dict.fromkeys((max(first - k * width, 0), min(last + k * width, count - 1)) for k in (0, 2, 8))
    return max((_Search(responses, motions, *start) for start in starts), key=lambda one: one.likelihood).best()


def _half_sine(responses: Sequence[Array], motions: Sequence[Array]) -> tuple[int, int]:
    """First and last row of the half-sine that explains the most of the motions; its length is a power of 2."""
    count, best = motions[0].size, (0.0, (0, min(SHORTEST, motions[0].size - 1)))
    size = 2 << count.bit_length()
    width = SHORTEST
    while width < count:
        pulse = np.fft.rfft(np.sin(math.pi / width * np.arange(width)), size)
        along, energy = np.zeros((2, count))
        for response, motion in zip(responses, motions, strict=True):
            moved = np.fft.irfft(np.fft.rfft(response, size) * pulse, size)[:count]
            along += np.fft.irfft(np.fft.rfft(motion, size) * np.fft.rfft(moved, size).conj(), size)[:count]
            energy += np.cumsum(moved**2)[::-1]
        explained = np.maximum(along, 0.0) ** 2 / np.maximum(energy, SINGULAR * energy[0])
        row = int(np.argmax(explained[: count - width]))
        best = max(best, (float(explained[row]), (row, row + width)))
        width *= 2
    return best[1]


class _Search:
    """The search for the first and the last knot, from a window of rows on."""

    def __init__(self, responses: Sequence[Array], motions: Sequence[Array], first: int, last: int) -> None:
        width = last - first
        # most knots: a half-sine that is linear between them differs by 6e-5 of its largest value
        self.step = -(-width // 150)
        self.knots = np.arange(max(first - width, self.step), min(last + width, motions[0].size), self.step)
        self.equations = _equations(responses, motions, self.knots, self.step)
        begin, end = (int(np.searchsorted(self.knots, row)) for row in (first, last))
        self.window = begin, min(end, self.knots.size - 1)
        self.known = dict[tuple[int, int], float]()
        self.likelihood = self.of(self.window)

    def of(self, window: tuple[int, int]) -> float:
        """The logarithm of the likelihood of a window of knots."""
        if window not in self.known:
            self.known[window] = _Fit.of(self.equations, *window).likelihood
        return self.known[window]

    def best(self) -> Deconvolved:
        """The force in the window from which no step leads to a likelier one."""
        window, move = self.window, max((self.window[1] - self.window[0]) // 4, 1)
        while True:
            moves = [(window[0] + a * move, window[1] + b * move) for a in (-1, 0, 1) for b in (-1, 0, 1)]
            allowed = [w for w in moves if 0 <= w[0] <= w[1] - SHORTEST and w[1] < self.knots.size]
            best = max(allowed, key=self.of, default=window)
            if self.of(best) > self.of(window):
                window = best
            elif move == 1:
                break
            else:
                move = (move + 1) // 2
        fit = _Fit.of(self.equations, *window)
        rows = self.knots[window[0]] + self.step * np.arange(-1, window[1] - window[0] + 2)
        force, deviation = (np.pad(values, 1) for values in (fit.force, fit.deviation))
        return Deconvolved(rows, force, deviation, fit.total, fit.total_deviation, self.step)


def _equations(responses: Sequence[Array], motions: Sequence[Array], knots: Index, step: int) -> _Equations:
    """The normal equations of forces at knots, which are linear over `step` rows to both sides."""
    count, square, right = motions[0].size, np.zeros((knots.size, knots.size)), np.zeros(knots.size)
    hat = 1.0 - np.abs(np.arange(1 - step, step)) / step
    columns = np.zeros((count, knots.size))
    for response, motion in zip(responses, motions, strict=True):
        moved = np.convolve(response, hat)[:count]
        for k, row in enumerate(knots.tolist()):
            columns[row - step + 1 :, k] = moved[: count - (row - step + 1)]
        square += columns.T @ columns
        right += columns.T @ motion
    total = sum(float(motion @ motion) for motion in motions)
    return _Equations(square, right, total, count * len(motions))


class _Fit(NamedTuple):
    """The force at some knots, and the logarithm of the likelihood but for a constant."""

    force: Array
    deviation: Array
    total: float
    total_deviation: float
    likelihood: float

    @classmethod
    def of(cls, equations: _Equations, first: int, last: int) -> _Fit:
        """The force at the knots `first` to `last`, 0 at those beside them.

        With u = L f, the second differences, and A L⁻¹ = U S Vᵀ, −2 ln p = N ln(|y|² − Σ b²/(s² + λ)) + Σ ln(1 + s²/λ),
        b = S Uᵀ y and λ = (σ/τ)², σ² being 1/N of the expression in the first logarithm.
        """
        part, size = slice(first, last + 1), last - first + 1
        differences = 2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)
        inverse = np.linalg.inv(differences)
        values, turned = np.linalg.eigh(inverse @ equations.square[part, part] @ inverse)
        values = np.maximum(values, SINGULAR * values[-1])
        b = turned.T @ (inverse @ equations.right[part])
        ratios = RATIOS * values[-1]
        least = max(equations.total - float(np.sum(b**2 / values)), SINGULAR * equations.total)
        share = ratios[:, None] / (values + ratios[:, None])
        left = least + share @ (b**2 / values)
        likelihood = -0.5 * (equations.values * np.log(left) + np.log1p(values / ratios[:, None]).sum(axis=1))
        best = int(np.argmax(likelihood))
        root = np.sqrt(values + ratios[best])
        spread = inverse @ turned / root * math.sqrt(float(left[best]) / equations.values)
        force = inverse @ (turned @ (b / root**2))
        return cls(
            force,
            np.linalg.norm(spread, axis=1),
            float(force.sum()),
            float(np.linalg.norm(spread.sum(axis=0))),
            float(likelihood[best]),
        )
