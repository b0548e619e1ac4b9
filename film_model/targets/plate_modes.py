"""Natural vibrations of simply supported rectangular plates, in closed form."""

from __future__ import annotations

import math

import numpy as np

from film_model.targets.modes import Array, Modes, Points, check_count, sorted_modes
from film_model.targets.plate_statics import anisotropy


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
    (d11, _, d22, _), (a, b) = stiffness, size
    coupling = stiffness[1] + 2 * stiffness[3]
    bound = highest**2 * mass_per_area / math.pi**4 / min(1.0, (1.0 + anisotropy(*stiffness)) / 2)
    most = [(bound / d) ** 0.25 * length + 2.0 for d, length in ((d11, a), (d22, b))]
    check_count(most[0] * most[1])
    i, j = (np.arange(1.0, end) for end in most)
    u, v = (i / a)[:, None] ** 2, (j / b) ** 2
    square = math.pi**4 / mass_per_area * (d11 * u**2 + 2 * coupling * u * v + d22 * v**2)
    if foundation:
        square += foundation / mass_per_area
    shape, *elsewhere = (
        _waves(i, a, x, p)[:, None] * _waves(j, b, y, q)
        for x, y, p, q in (((*point, 0.0, 0.0)[:4]) for point in (position, *others))
    )
    factor = np.array([shape * other * 4 / (mass_per_area * a * b) for other in elsewhere])
    return sorted_modes(np.sqrt(square), shape**2 * 4 / (mass_per_area * a * b), highest, factor)


def _waves(number: Array, side: float, at: float, order: float) -> Array:
    """A derivative of sin(nπx/a), 1/m^order."""
    return (number * math.pi / side) ** order * np.sin(number * math.pi * at / side + order * math.pi / 2)
