"""Natural vibrations of rods, in closed form."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from film_model.targets.modes import Array, Modes, Points, check_count, sorted_modes

EXTENSION = 64
"""Length of the rod that stands for an impedance behind the far end, over that of the rod."""


def rod_modes(impedance: float, travel: float, behind: float, highest: float, others: Points = ()) -> Modes:
    """The vibrations up to `highest` [rad/s] of a rod of impedance Z [N·s/m] struck on its end.

    travel: L/c, s. behind: impedance behind the far end: 0 of a free end, infinite of a fixed one. The mass of the rod
    is Z L/c. With θ = ω L/c: θ = nπ if free, (n + ½)π if fixed; M is half the mass, or all of it for n = 0.
    others: sensors, by their distance x over the length L; the shapes are cos(θ x/L).

    Another impedance is that of a second rod with the same wave speed, 64 times as long and free at its end. It has no
    damping, but nothing returns from it before 65 times 2L/c, and up to then the motion is exact.
    """
    most = highest * travel / math.pi + 1.0
    check_count(most * (EXTENSION + 1 if 0.0 < behind < math.inf else 1))
    n = np.arange(most)
    if behind == 0.0:
        theta, mass = n * math.pi, np.where(n == 0.0, 1.0, 0.5)
    elif math.isinf(behind):
        theta, mass = (n + 0.5) * math.pi, np.full(n.size, 0.5)
    else:
        theta = (n[:, None] * math.pi + _phases(behind / impedance)).ravel()
        mass = _masses(theta, behind / impedance)
    share = 1.0 / (mass * impedance * travel)
    factor = np.array([share * np.cos(theta * place) for (place,) in others])
    return sorted_modes(theta / travel, share, highest, factor)


@lru_cache(maxsize=16)
def _phases(ratio: float) -> Array:
    """Roots of sin θ cos Rθ + r cos θ sin Rθ = 0 in 0 <= θ < π, by bisection; r: ratio of the impedances.

    w = cos(θ x/L) in the rod and a multiple of cos(θ (x/L − 1 − R)) in the other have equal displacements and forces at
    x = L. Between two multiples of π/(2R) there is at most one root.
    """
    grid = np.linspace(0.0, math.pi, 40 * EXTENSION + 1)[:-1] + 1e-5  # no root lies on the grid
    low, high = grid, grid + math.pi / (40 * EXTENSION)

    def f(theta: Array) -> Array:
        return np.sin(theta) * np.cos(EXTENSION * theta) + ratio * np.cos(theta) * np.sin(EXTENSION * theta)

    crossed = f(low) * f(high) < 0.0
    low, high = low[crossed], high[crossed]
    for _ in range(60):
        middle = (low + high) / 2
        left = f(low) * f(middle) <= 0.0
        low, high = np.where(left, low, middle), np.where(left, middle, high)
    found = (low + high) / 2
    return np.concatenate([[0.0], found[found < math.pi - 1e-6]])


def _masses(theta: Array, ratio: float) -> Array:
    """Modal mass over the mass of the rod, for a displacement of 1 at the struck end."""
    long = EXTENSION * theta
    half = np.where(theta == 0.0, 1.0, 0.5 + _sinc(2 * theta) / 2)
    other = np.where(theta == 0.0, 1.0, 0.5 + _sinc(2 * long) / 2)
    by_displacement = np.cos(theta) ** 2 / np.maximum(np.cos(long) ** 2, 1e-300)
    by_force = np.sin(theta) ** 2 / (ratio * np.maximum(np.abs(np.sin(long)), 1e-150)) ** 2
    factor = np.where(np.abs(np.cos(long)) > np.abs(np.sin(long)), by_displacement, by_force)
    return half + ratio * EXTENSION * factor * other


def _sinc(x: Array) -> Array:
    return np.sinc(x / math.pi)


@lru_cache(maxsize=16)
def rod_compliance(impedance: float, travel: float, behind: float) -> float:
    """Static deflection over force of such a rod, m/N: L/(EA) = (L/c)/Z if fixed.

    Of a rod that is not fixed, without its motion as a whole: L/(3 EA) if free; else the sum over its vibrations, whose
    remainder falls as 1/θ², with 2/(π² n) of it beyond n multiples of π.
    """
    if math.isinf(behind):
        return travel / impedance
    if behind == 0.0:
        return travel / (3.0 * impedance)
    multiples = 2000
    modes = rod_modes(impedance, travel, behind, multiples * math.pi / travel)
    return modes.compliance + 2.0 / (math.pi**2 * multiples) * travel / impedance
