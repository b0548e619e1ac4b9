"""Natural vibrations of simply supported rectangular plates, in closed form."""

from __future__ import annotations

import numpy as np

from film_model.core import plates
from film_model.targets.modes import Modes, Points, check_count, sorted_modes


def plate_modes(
    mass_per_area: float,
    stiffness: tuple[float, float, float, float],
    size: tuple[float, float],
    position: tuple[float, float],
    highest: float,
    foundation: float = 0.0,
    others: Points = (),
) -> Modes:
    """Modes up to the frequency `highest` [rad/s] of a simply supported rectangular plate, isotropic or orthotropic.

    φ = sin(iπx/a) sin(jπy/b), M = ρ_A a b/4, ω² = (π⁴/ρ_A)(D11 i⁴/a⁴ + 2 (D12 + 2 D66) i²j²/(a²b²) + D22 j⁴/b⁴) +
    k_f/ρ_A on an elastic bed of `foundation` k_f [N/m³]. Modes with a node line through the struck point `position` are
    omitted. others: sensors, m, or with orders of derivatives. Valid for thin plates: wavelengths must be long compared
    with the thickness.
    """
    (d11, d12, d22, d66), (a, b) = stiffness, size
    plate = plates.Plate(a, b, mass_per_area, d11, d12 + 2 * d66, d22, foundation)
    check_count(plates.most(plate, highest))
    points = np.array([(*point, 0.0, 0.0)[:4] for point in (position, *others)])
    frequency, (struck, *elsewhere) = plates.modes(plate, highest, points)
    scale = 4 / (mass_per_area * a * b)
    factor = np.array([struck * other * scale for other in elsewhere])
    return sorted_modes(frequency, struck**2 * scale, highest, factor)
