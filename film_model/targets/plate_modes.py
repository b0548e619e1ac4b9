"""Natural vibrations of simply supported rectangular plates, in closed form."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from film_model.base.arrays import Number
from film_model.core import plates
from film_model.targets.modes import Modes, Points, check_count, sorted_modes

Shear: TypeAlias = tuple[Number, Number, Number]
"""Thickness h, m, 1/S, m/N, and f, m², of Mindlin's theory (`targets/thick_plate.py`)."""

THIN: Shear = (0.0, 0.0, 0.0)
"""Those of Kirchhoff's theory."""

Stiffness: TypeAlias = tuple[Number, Number, Number, Number]
"""D11, D12, D22 and D66, N·m."""

Point: TypeAlias = tuple[float, float]


def numbers_of(
    mass_per_area: Number, stiffness: Stiffness, size: Point, position: Point, foundation: float, shear: Shear
) -> tuple[Number, ...]:
    """The numbers of a plate of the core."""
    d11, d12, d22, d66 = stiffness
    return (*size, *position, mass_per_area, d11, d12 + 2 * d66, d22, foundation, *shear)


def plate_modes(
    mass_per_area: float,
    stiffness: Stiffness,
    size: Point,
    position: Point,
    highest: float,
    foundation: float = 0.0,
    others: Points = (),
    shear: Shear = THIN,
) -> Modes:
    """Modes up to the frequency `highest` [rad/s] of a simply supported rectangular plate, isotropic or orthotropic.

    w = sin(iπx/a) sin(jπy/b). Kirchhoff's theory: M = ρ_A a b/4, ω² = (π⁴/ρ_A)(D11 i⁴/a⁴ + 2 (D12 + 2 D66) i²j²/(a²b²)
    + D22 j⁴/b⁴) + k_f/ρ_A on an elastic bed of `foundation` k_f [N/m³]. With `shear` Mindlin's, of isotropic plates, up
    to waves of k h = 1.2 (core/plate/film_plate.h), where the core knows shear. Modes with a node line through the
    struck point `position` are omitted. others: sensors, m, or with orders of derivatives.
    """
    plate = plates.Plate(*numbers_of(mass_per_area, stiffness, size, position, foundation, shear))
    check_count(plates.most(plate, highest))
    points = np.array([(*point, 0.0, 0.0)[:4] for point in others]).reshape(-1, 4)
    frequency, (struck, *elsewhere) = plates.modes(plate, highest, points)
    return sorted_modes(frequency, struck**2, highest, np.array([struck * other for other in elsewhere]))
