"""Static deflection of rectangular plates, simply supported or clamped, isotropic or orthotropic."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from film_model.base.arrays import Number, of_each
from film_model.core import panels, plates
from film_model.targets.bending_stiffness import anisotropy
from film_model.targets.plate_modes import THIN, Point, Shear, Stiffness, numbers_of


def plate_compliance(stiffness: Stiffness, size: Point, position: Point, shear: Shear = THIN) -> Number:
    """Static deflection over force at the struck point of a simply supported rectangular plate, m/N.

    An array if the stiffness is of many plates.

    Navier's double series (4/(ab)) Σ φ²/(ρ_A ω²) over the modes i, j. The sum over j is done in closed form by partial
    fractions. The terms of the sum over i approach those of Σ sin²(iπx/a)/i³ exponentially; that sum is known, and the
    remainder is added up to rounding. The result is 0.0116008 L²/D at the centre of a square isotropic plate. With
    `shear`, h²/(10π D) (ln(ℓ/h) − 1.054) more, as of `plate_shear.shear_around`.
    """
    d11, _, d22, _ = stiffness
    bent = of_each(_of_unit_stiffness, anisotropy(*stiffness), d11 / d22, *size, *position) / d22
    return bent if shear is THIN else bent + shear_compliance(stiffness, size, position, shear)


def shear_compliance(stiffness: Stiffness, size: Point, position: Point, shear: Shear) -> Number:
    """The part of shear in that; 0 where the core does not know it."""
    numbers = numbers_of(1.0, stiffness, size, position, 0.0, shear)
    several = any(isinstance(number, np.ndarray) for number in numbers)
    return plates.shear(np.stack(np.broadcast_arrays(*numbers), axis=-1)) if several else _of_shear(numbers)


@lru_cache(maxsize=64)
def _of_shear(numbers: tuple[float, ...]) -> float:
    return plates.shear(np.array([numbers])).item()


@lru_cache(maxsize=64)
def _of_unit_stiffness(ratio: float, stiffer: float, a: float, b: float, x: float, y: float) -> float:
    """The compliance of a plate with D22 = 1, the anisotropy `ratio` and D11 = stiffer: the same for all isotropic
    materials."""
    return plates.compliance(plates.Plate(a, b, x, y, 1.0, stiffer, ratio * math.sqrt(stiffer), 1.0))


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
    edges = (*map(panels.EDGES.index, ends), 0, 0)
    return panels.levy(panels.Panel(1.0, *stiffness, *size, (*springs, 0.0, 0.0), foundation, edges), *position)
