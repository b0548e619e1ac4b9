"""Static deflection of rectangular plates, simply supported or clamped, isotropic or orthotropic."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np

from film_model.base.arrays import Number, of_each, root
from film_model.core import plates


def anisotropy(d11: float, d12: float, d22: float, d66: float) -> float:
    """A = (D12 + 2 D66)/√(D11 D22): 1 for an isotropic plate; the bending energy is positive only if A > −1."""
    return (d12 + 2 * d66) / root(d11 * d22)


def plate_compliance(
    stiffness: tuple[Number, Number, Number, Number], size: tuple[float, float], position: tuple[float, float]
) -> Number:
    """Static deflection over force at the struck point of a simply supported rectangular plate, m/N.

    An array if the stiffness is of many plates.

    Navier's double series (4/(ab)) Σ φ²/(ρ_A ω²) over the modes i, j. The sum over j is done in closed form by partial
    fractions. The terms of the sum over i approach those of Σ sin²(iπx/a)/i³ exponentially; that sum is known, and the
    remainder is added up to rounding. The result is 0.0116008 L²/D at the centre of a square isotropic plate.
    """
    d11, _, d22, _ = stiffness
    return of_each(_of_unit_stiffness, anisotropy(*stiffness), d11 / d22, *size, *position) / d22


@lru_cache(maxsize=64)
def _of_unit_stiffness(ratio: float, stiffer: float, a: float, b: float, x: float, y: float) -> float:
    """The same of a plate with D22 = 1, the anisotropy `ratio` and D11 = stiffer: the same for all isotropic
    materials."""
    return plates.compliance(plates.Plate(a, b, 1.0, stiffer, ratio * math.sqrt(stiffer), 1.0, 0.0), x, y)


def levy_compliance(
    stiffness: tuple[float, float, float, float],
    size: tuple[float, float],
    ends: tuple[str, str],
    position: tuple[float, float],
    springs: tuple[float, float] = (0.0, 0.0),
    foundation: float = 0.0,
) -> float:
    """Static deflection over force of a plate with the edges `ends` at x = 0 and x = a, simply supported at y = 0 and
    b.

    Lévy's solution: w = Σ w_j(x) sin(jπy/b), where D11 w⁗ − 2 (D12 + 2 D66) k² w″ + (D22 k⁴ + k_f) w = (2/b) F
    sin(jπy/b) δ(x), k = jπ/b, on an elastic bed of `foundation` k_f [N/m³]. Each w_j is the solution on an infinite
    strip and four exponentials that satisfy the edges; `springs` [N/m²] hold free ones. The terms approach a multiple
    of sin²/j³, whose sum is known; the remainder is below 1e-7.
    """
    (d11, d12, d22, d66), (a, b), (x, y) = stiffness, size, position
    j = np.arange(1.0, LEVY_TERMS + 1.0)
    k = j * math.pi / b
    mean, bed = (d12 + 2 * d66) / d11, foundation / k**4
    spread = np.emath.sqrt(((d12 + 2 * d66) ** 2 - d11 * (d22 + bed)).astype(complex)) / d11
    # the roots of an isotropic plate coincide: they are moved apart
    spread = np.where(np.abs(spread) < DISTINCT * abs(mean), DISTINCT * abs(mean), spread)
    one, two = (np.sqrt(mean + sign * spread) * k for sign in (1, -1))
    scale = 2 * d11 * (one**2 - two**2)

    def alone(distance: float, n: int) -> Any:
        """n-th derivative of the solution on the infinite strip, |x| = distance, towards growing |x|."""
        return ((-two) ** n * np.exp(-two * distance) / two - (-one) ** n * np.exp(-one * distance) / one) / scale

    matrix, right = np.zeros((j.size, 4, 4), complex), np.zeros((j.size, 4), complex)
    for end, (kind, distance) in enumerate(zip(ends, (x, a - x), strict=True)):
        wanted = {"clamped": (0, 1), "simply supported": (0, 2), "free": (2, 3)}[kind]
        for row, n in enumerate(wanted, 2 * end):
            # every function is written from this edge inwards; derivatives are taken outwards
            less = {2: d12, 3: d12 + 4 * d66}[n] / d11 * k**2 if kind == "free" else 0.0
            held = springs[end] / d11 if n == 3 else 0.0
            for column, rate in enumerate((one, two)):
                near = rate**n - less * rate ** (n - 2.0) - held
                far = (-rate) ** n - less * (-rate) ** (n - 2.0) - held
                matrix[:, row, 2 * end + column] = near
                matrix[:, row, 2 * (1 - end) + column] = far * np.exp(-rate * a)
            lower = alone(distance, n - 2) if kind == "free" else 0.0
            right[:, row] = -(alone(distance, n) - less * lower - held * alone(distance, 0))
    found = np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
    waves = np.stack([np.exp(-rate * distance) for distance in (x, a - x) for rate in (one, two)], axis=1)
    terms = (alone(0.0, 0) + np.sum(found * waves, axis=1)).real
    limit = float(terms[-1] * j[-1] ** 3)
    sines = np.sin(j * math.pi * y / b) ** 2
    cosines = float(np.sum(np.cos(2 * math.pi * y / b * j) / j**3))
    return float(2 / b * (np.sum(sines * (terms - limit / j**3)) + limit * (_ZETA_3 - cosines) / 2))


LEVY_TERMS = 2000

DISTINCT = 1e-4
"""Least relative distance of the roots' squares: the error is its square, the loss of digits by rounding its
inverse."""

_ZETA_3 = 1.2020569031595942  # Σ 1/i³
