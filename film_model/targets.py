"""How a target gives way: wave impedances, natural vibrations and static compliances.

The impedance is the force that pushes the struck point at unit velocity while no wave has come back: it moves at F/Z,
and the indentation δ obeys δ̈ + Ḟ/Z + F/m = 0 (Zener 1941). What comes back from the edges is in the modes; a force
that changes slowly against all of them finds the static compliance. All arguments and results are SI floats; those of
impedances may be arrays of them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.elementwise import root
from film_model.errors import SimulationError


def plate_stiffness(youngs_modulus: float, poissons_ratio: float, thickness: float) -> float:
    """Bending stiffness D = E h³ / (12 (1 − ν²)) of an isotropic thin plate, N·m."""
    return youngs_modulus * thickness**3 / (12 * (1 - poissons_ratio**2))


def plate_impedance(mass_per_area: float, bending_stiffness: float) -> float:
    """Z = 8 √(ρ_A D) of an infinite isotropic thin plate, N·s/m (Zener 1941).

    Exact for Kirchhoff's plate; the contact must be long against the time a wave takes through the thickness, and
    over before a wave returns from an edge.
    """
    return 8 * root(mass_per_area * bending_stiffness)


def orthotropic_plate_impedance(mass_per_area: float, d11: float, d12: float, d22: float, d66: float) -> float:
    """Exact impedance of an infinite orthotropic thin plate, N·s/m.

    1/Z is the mean over all directions θ of 1/(8 √(ρ_A D(θ))), D(θ) = D11 c⁴ + 2 (D12 + 2 D66) c² s² + D22 s⁴, which
    integrates to Z = 8 √ρ_A (D11 D22)^¼ (π/2)/K(k²) with k² = (1 − A)/2, A = (D12 + 2 D66)/√(D11 D22) > −1. The
    complete elliptic integral is K(k²) = (π/2)/agm(1, √(1 − k²)).
    """
    mean = root(d11 * d22)
    return 8 * root(mass_per_area * mean) * _agm(1, root((1 + anisotropy(d11, d12, d22, d66)) / 2))


def paper_plate_impedance(mass_per_area: float, d11: float, d12: float, d22: float, d66: float) -> float:
    """Z = 8 √(ρ_A D) with D = [(A + 1)/2] √(D11 D22), N·s/m.

    The effective stiffness that reproduces the published FILM results for Olsson's plate (Big-Alabo, Cartmell &
    Harrison 2017). Right for an isotropic plate; below the exact value by 12.5 % for that one (A = 0.19).
    """
    effective = (anisotropy(d11, d12, d22, d66) + 1) / 2 * root(d11 * d22)
    return plate_impedance(mass_per_area, effective)


def anisotropy(d11: float, d12: float, d22: float, d66: float) -> float:
    """A = (D12 + 2 D66)/√(D11 D22): one for an isotropic plate; bending takes energy only if A > −1."""
    return (d12 + 2 * d66) / root(d11 * d22)


def rod_impedance(youngs_modulus: float, density: float, area: float) -> float:
    """Z = ρ c A with c = √(E/ρ) of a long thin rod struck on its end, N·s/m.

    One-dimensional theory: the contact must be long against the time a wave takes across the rod, and over before
    the wave returns from the far end, after 2L/c.
    """
    return area * root(youngs_modulus * density)


def _agm(a: Any, b: Any) -> Any:
    """Arithmetic-geometric mean of two positive numbers. It converges quadratically: 1e-150 and 1 take 13 rounds."""
    for _ in range(64):
        if np.all(abs(a - b) <= 4e-16 * a):
            break
        a, b = (a + b) / 2, root(a * b)
    return a


Array = NDArray[np.float64]


MOST_MODES = 10_000_000


@dataclass(frozen=True)
class Modes:
    """Natural vibrations of a structure as seen from the struck point, by ascending frequency.

    frequency: ω_n, rad/s. share: φ_n²/M_n, 1/kg: mode shape there squared over modal mass. The point's displacement is
    w = Σ w_n with ẅ_n + ω_n² w_n = (φ_n²/M_n) F.
    """

    frequency: Array
    share: Array

    @property
    def compliance(self) -> float:
        """Σ φ_n²/(M_n ω_n²), m/N: what these modes give way to a static force."""
        return float(np.sum(self.share / self.frequency**2))


def plate_modes(
    mass_per_area: float,
    stiffness: tuple[float, float, float, float],
    size: tuple[float, float],
    position: tuple[float, float],
    highest: float,
) -> Modes:
    """Modes up to the frequency `highest` [rad/s] of a simply supported rectangular plate, isotropic or orthotropic.

    φ = sin(iπx/a) sin(jπy/b), M = ρ_A a b/4, ω² = (π⁴/ρ_A)(D11 i⁴/a⁴ + 2 (D12 + 2 D66) i²j²/(a²b²) + D22 j⁴/b⁴); those
    with a node line through the struck point `position` are left out. Thin plates only: wavelengths long against the
    thickness.
    """
    (d11, _, d22, _), (a, b), (x, y) = stiffness, size, position
    coupling = stiffness[1] + 2 * stiffness[3]
    bound = highest**2 * mass_per_area / math.pi**4 / min(1.0, (1.0 + anisotropy(*stiffness)) / 2)
    most = [(bound / d) ** 0.25 * length + 2.0 for d, length in ((d11, a), (d22, b))]
    _check_room(most[0] * most[1])
    i, j = (np.arange(1.0, end) for end in most)
    u, v = (i / a)[:, None] ** 2, (j / b) ** 2
    square = math.pi**4 / mass_per_area * (d11 * u**2 + 2 * coupling * u * v + d22 * v**2)
    shape = (np.sin(i * math.pi * x / a)[:, None] * np.sin(j * math.pi * y / b)) ** 2
    return _sorted_modes(np.sqrt(square), shape * 4 / (mass_per_area * a * b), highest)


@lru_cache(maxsize=64)
def plate_compliance(
    stiffness: tuple[float, float, float, float], size: tuple[float, float], position: tuple[float, float]
) -> float:
    """Static deflection over force at the struck point of a simply supported rectangular plate, m/N.

    Navier's double series (4/(ab)) Σ φ²/(ρ_A ω²) of the modes above, with the sum over j in closed form by partial
    fractions and that over i to rounding: its terms are those of Σ sin²(iπx/a)/i³, but for some that vanish
    exponentially. A square isotropic plate yields 0.0116008 L²/D at its centre.
    """
    (d11, _, d22, _), (a, b), (x, y) = stiffness, size, position
    ratio = anisotropy(*stiffness)
    i = np.arange(1.0, 10_001.0)
    mean = (d11 / d22) ** 0.5 * (b / a) ** 2 * i**2  # p², q² = mean (A ± √(A² − 1)), the roots in −j²
    spread = np.emath.sqrt(complex(ratio**2 - 1))
    theta = 2 * math.pi * y / b

    def g(square: Any) -> Any:
        p = np.sqrt(square)
        far = np.exp(-2 * math.pi * p)
        return math.pi / (2 * p) * (1 + far - np.exp(-p * theta) - np.exp(-p * (2 * math.pi - theta))) / (1 - far)

    if abs(spread) > 1e-6 * abs(ratio):
        inner = ((g(mean * (ratio + spread)) - g(mean * (ratio - spread))) / (-4 * mean * spread)).real
    else:  # the derivative, by a complex step
        inner = -g(mean * ratio * (1 + 1e-8j)).imag / (2e-8 * mean * ratio)
    limit = math.pi / (4 * math.sqrt(2 * (1 + ratio))) * ((d11 / d22) ** 0.5 * (b / a) ** 2) ** -1.5
    waves = np.sin(i * math.pi * x / a) ** 2
    cosines = float(np.sum(np.cos(2 * math.pi * x / a * i) / i**3))
    total = float(np.sum(waves * (inner - limit / i**3))) + limit * (_ZETA_3 - cosines) / 2
    return float(4 * b**3 / (math.pi**4 * a * d22) * total)


@lru_cache(maxsize=64)
def clamped_plate_compliance(
    stiffness: tuple[float, float, float, float], size: tuple[float, float], position: tuple[float, float]
) -> float:
    """Static deflection over force at the struck point of a rectangular plate clamped on its four edges, m/N.

    Ritz's method with products of polynomials and the energy D11 w_xx² + 2 (D12 + 2 D66) w_xy² + D22 w_yy². What the
    polynomials miss of the singularity under the force they miss on simply supported edges too, where
    :func:`plate_compliance` knows it, and that much is added. A square isotropic plate yields 0.0056120 L²/D at its
    centre.
    """
    known = plate_compliance(stiffness, size, position)
    held, free = (_ritz(stiffness, size, position, first) for first in (2, 0))
    return known + (held - free)


_ZETA_3 = 1.2020569031595942  # Σ 1/i³
_RITZ_DEGREE = 16  # nine digits at the centre, four next to an edge


def _ritz(
    stiffness: tuple[float, float, float, float],
    size: tuple[float, float],
    position: tuple[float, float],
    first: int,
    last: int = _RITZ_DEGREE,
) -> float:
    """Compliance with functions whose second derivatives are Legendre's P_first … P_last, and which are 0 at both ends.

    From P_2 on they have no slope there either: clamped edges. With P_0 and P_1: simply supported ones.
    """
    (d11, _, d22, _), coupling = stiffness, stiffness[1] + 2 * stiffness[3]
    nodes, weights = np.polynomial.legendre.leggauss(last + 3)
    shapes: list[tuple[Array, Array]] = []
    for length, at in zip(size, position, strict=True):
        bent = [np.polynomial.Legendre.basis(n) for n in range(first, last + 1)]
        deflected = [s.integ(2, lbnd=-1) for s in bent]
        deflected = [s - np.polynomial.Legendre([0.5 * s(1.0), 0.5 * s(1.0)]) for s in deflected]
        values = [np.stack([s.deriv(n)(nodes) for s in deflected]) for n in (2, 1, 0)]
        grams = np.stack([(v * weights) @ v.T * (2 / length) ** n for v, n in zip(values, (3, 1, -1), strict=True)])
        shapes.append((grams, np.array([s(2 * at / length - 1) for s in deflected])))
    (gx, px), (gy, py) = shapes
    energy = d11 * np.kron(gx[0], gy[2]) + 2 * coupling * np.kron(gx[1], gy[1]) + d22 * np.kron(gx[2], gy[0])
    load = np.kron(px, py)
    scale = 1 / np.sqrt(np.diag(energy))
    return float(load * scale @ np.linalg.solve(energy * scale[:, None] * scale, load * scale))


def beam_modes(mass_per_length: float, bending: float, length: float, position: float, highest: float) -> Modes:
    """Modes of a simply supported beam of bending stiffness EI [N·m²]: ω = (nπ/L)² √(EI/ρA), φ = sin(nπx/L), M = ρAL/2.

    Slender beams only (Bernoulli's): wavelengths long against the thickness.
    """
    clock = math.sqrt(bending / mass_per_length) * (math.pi / length) ** 2
    most = math.sqrt(highest / clock) + 2.0
    _check_room(most)
    n = np.arange(1.0, most)
    return _sorted_modes(
        clock * n**2, np.sin(n * math.pi * position / length) ** 2 * 2 / (mass_per_length * length), highest
    )


def beam_compliance(bending: float, length: float, position: float, ends: str) -> float:
    """Static deflection over force of a beam struck at a from one end, b = L − a from the other, m/N.

    a²b²/(3 EI L) on simple supports, a³b³/(3 EI L³) clamped at both ends, a³/(3 EI) clamped at the first end only.
    """
    a, b = position, length - position
    lever = {"simply supported": a**2 * b**2 / length, "clamped": (a * b / length) ** 3, "cantilever": a**3}[ends]
    return lever / (3 * bending)


def _check_room(count: float) -> None:
    if count > MOST_MODES:
        raise SimulationError(
            f"some {count:.1e} natural vibrations would be needed: the contact is so short against them that the "
            "target has no edges (boundary_reflections = false in [effects])"
        )


def _sorted_modes(frequency: Array, share: Array, highest: float) -> Modes:
    order = np.argsort(frequency, axis=None, kind="stable")
    frequency, share = frequency.ravel()[order], share.ravel()[order]
    kept = (frequency <= highest) & (share > 1e-20 * share.max())
    return Modes(frequency[kept], share[kept])
