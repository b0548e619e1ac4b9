"""Vibrations and static deflection of thick rectangular plates: Mindlin's theory, with shear and rotary inertia.

Energy ½ ∫∫ D11 ψx,x² + 2 D12 ψx,x ψy,y + D22 ψy,y² + D66 (ψx,y + ψy,x)² + S |∇w − ψ|² + k_f w² and that of edge
springs; inertia ρ_A w² + ρ h³/12 |ψ|². Where an edge is supported or clamped, w and the rotation along it are 0; where
it is clamped, that across it too. w and both rotations are sums of products of Legendre polynomials in x and in y.

Both faces move by w + f (ψx,x + ψy,y), f = ν h²/(12 (1 − ν)): the plate gets thinner and thicker as it bends. With that
and S = κ G h, κ = 5/(6 − ν), simply supported plates have the frequencies and the deflections of three-dimensional
elasticity to the first power of k² h² in waves of 2π/k. Shorter waves than π h are left out: the half-space of the
contact law has them (core/plate/film_plate.c).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import product

import numpy as np

from film_model.base.arrays import Number
from film_model.base.threads import one_thread
from film_model.core import plates
from film_model.targets.beam_theory import Line, wave_number
from film_model.targets.line_functions import SIMPLE, line
from film_model.targets.modes import Array, Modes, Points
from film_model.targets.panel_statics import REMAINDER, compliance_and_error, degrees_along, ritz_compliance
from film_model.targets.plate_modes import Point, Shear, numbers_of
from film_model.targets.plate_statics import shear_compliance
from film_model.targets.ritz import LEAST, NODE, Panel, least_stiffness, loose_motions, seen_modes, spectrum, symmetric

DEGREES = 1.6, 8
"""Degree of the polynomials for each half-wave, and beyond: errors of frequencies are then below 1e-6, with corners
clamped-free 1e-5."""


def shear_of(bending: Number, thickness: Number, ratio: Number) -> Shear:
    """h, 1/S and f, with κ = 5/(6 − ν): S = 6 (1 − ν) κ D/h²."""
    square = thickness**2
    return thickness, square * (6 - ratio) / (30 * (1 - ratio) * bending), ratio * square / 12 / (1 - ratio)


@dataclass(frozen=True)
class ThickPanel:
    """A thick isotropic plate. thin: the same without shear. shear: of :func:`shear_of`."""

    thin: Panel
    shear: Shear

    @property
    def thickness(self) -> float:
        """h, m."""
        return self.shear[0]

    @property
    def bulge(self) -> float:
        """f, m²."""
        return self.shear[2]

    @property
    def strip(self) -> Line:
        """A strip of unit width whose vibrations are waves of the plate."""
        density = self.thin.mass_per_area
        return Line(density, self.thin.stiffness[0], 1.0, SIMPLE, 1 / self.shear[1], density * self.thickness**2 / 12)

    @property
    def highest(self) -> float:
        """Frequency of the shortest waves, rad/s."""
        thin = self.thin
        given = thin.mass_per_area, thin.stiffness, thin.size, thin.size, 0.0, self.shear
        return plates.highest(plates.Plate(*numbers_of(*given)))

    def half_waves(self, highest: float) -> list[float]:
        """Half-waves along both sides up to a frequency."""
        return [wave_number(self.strip, highest) * side / math.pi for side in self.thin.size]

    def degrees(self, highest: float) -> list[int]:
        """Degrees of the polynomials along both sides that resolve them."""
        return [DEGREES[1] + math.ceil(DEGREES[0] * number) for number in self.half_waves(highest)]

    @property
    def missing(self) -> str:
        """Why its motion is not known; empty if it is."""
        most_functions = 1500  # largest number of products that interact: their vibrations take a second
        sides = enumerate(self.degrees(self.highest))
        largest = 3 * math.prod((n + 2) // 2 if symmetric(self.thin, k) else n + 1 for k, n in sides)
        return "the plate is so thin that it has too many vibrations for it" if largest > most_functions else ""


def thick_modes(plate: ThickPanel, position: Point, highest: float, others: Points = ()) -> Modes:
    """The bending vibrations of a plate that is not simply supported, struck at `position` [m], up to the frequency
    `highest` [rad/s] and the core's shortest waves. others: sensors, m, or with orders of derivatives; those of the
    second order are curvatures of ψ."""
    return _thick_modes(plate, (position, *others), min(highest, plate.highest))


@lru_cache(maxsize=16)
@one_thread
def _thick_modes(plate: ThickPanel, points: Points, highest: float) -> Modes:
    return seen_modes(plate.thin, list(_ritz(plate, points, plate.degrees(highest))), highest)


# ---------------------------------------------------------------- Ritz


Term = tuple[int, float, tuple[int, int]]
"""One of w, ψx and ψy (0, 1, 2), a factor, and the orders of its derivatives along x and y."""


@cache
def _functions(held: tuple[bool, bool], degree: int) -> tuple[Array, Array]:
    """Orthonormal polynomials up to a degree, in normed Legendre polynomials, one per row, and whether each is odd;
    False if the ends differ. held: whether they are 0 at s = −1 and 1."""
    ends = np.array([_normed(s, degree + 1) for s in (-1.0, 1.0)])[list(held)]
    halves = 2 if held[0] == held[1] else 1
    found, odd = list[Array](), list[Array]()
    for half in range(halves):
        own = np.zeros((degree + 1, degree + 1))[: (degree + halves - half) // halves]
        own[:, half::halves] = np.linalg.svd(np.vstack([ends[:, half::halves], own[:1, half::halves]]))[2]
        found.append(own[any(held) * len(ends) // halves :])
        odd.append(np.full(len(found[-1]), half == 1))
    return np.concatenate(found), np.concatenate(odd)


def _normed(s: float, count: int) -> Array:
    """Normed Legendre polynomials at a point."""
    values: Array = np.polynomial.legendre.legvander(np.array([s]), count - 1)[0]
    return values * np.sqrt(np.arange(count) + 0.5)


@cache
def _slope(degree: int) -> Array:
    """Derivatives of normed Legendre polynomials in such, one per row."""
    n = np.arange(degree + 1.0)
    return np.tril(2.0 * np.sqrt(np.outer(n + 0.5, n + 0.5)) * ((n[:, None] - n) % 2 == 1), -1)


@dataclass(frozen=True)
class _Products:
    """Products of functions of x and y for w, ψx and ψy, orthonormal in the inertia. lines: coefficients of those along
    x and along y, of each. scale: of each."""

    size: tuple[float, float]
    lines: list[tuple[Array, Array]]
    scale: tuple[float, float, float]

    def _derived(self, term: Term) -> list[Array]:
        return [
            rows @ np.linalg.matrix_power(_slope(rows.shape[1] - 1) * (2.0 / side), order)
            for rows, side, order in zip(self.lines[term[0]], self.size, term[2], strict=True)
        ]

    def at(self, point: tuple[float, ...], terms: list[Term]) -> Array:
        """What the terms of each product are together at a point."""
        found = [np.zeros(len(x) * len(y)) for x, y in self.lines]
        for term in terms:
            values = [
                rows @ _normed(2.0 * at / side - 1.0, rows.shape[1]) * math.sqrt(2.0 / side)
                for rows, at, side in zip(self._derived(term), point, self.size, strict=True)
            ]
            found[term[0]] += self.scale[term[0]] * term[1] * np.outer(*values).ravel()
        return np.concatenate(found)

    def energy(self, pairs: list[tuple[float, list[Term], list[Term]]]) -> Array:
        """Σ stiffness ∫∫ one · other of pairs of strains."""
        ends = np.cumsum([0, *(len(x) * len(y) for x, y in self.lines)])
        found = np.zeros((ends[-1], ends[-1]))
        for stiffness, one, other in pairs:
            for i, j in product(one, other):
                along, across = (p @ q.T for p, q in zip(self._derived(i), self._derived(j), strict=True))
                factor = stiffness * i[1] * j[1] * self.scale[i[0]] * self.scale[j[0]]
                found[ends[i[0]] : ends[i[0] + 1], ends[j[0]] : ends[j[0] + 1]] += factor * np.kron(along, across)
        return found


_MOVED: list[Term] = [(0, 1.0, (0, 0))]
_CURVED: list[list[Term]] = [[(1, 1.0, (1, 0))], [(2, 1.0, (0, 1))], [(1, 1.0, (0, 1)), (2, 1.0, (1, 0))]]
_SHEARED: list[list[Term]] = [[(0, 1.0, (1, 0)), (1, -1.0, (0, 0))], [(0, 1.0, (0, 1)), (2, -1.0, (0, 0))]]


def _at_a_point(plate: ThickPanel, orders: tuple[float, ...]) -> list[Term]:
    """The deflection of a face, its slope, or the curvature."""
    m, n = (int(order) for order in orders or (0, 0))
    if m + n == 2:
        return [(k, c / len(_CURVED[n % 2 * 2 + n // 2]), d) for k, c, d in _CURVED[n % 2 * 2 + n // 2]]
    bulged: list[Term] = [(k, plate.bulge, d) for k, _, d in _CURVED[0] + _CURVED[1]]
    return [(0, 1.0, (m, n)), *(bulged if m + n == 0 else [])]


def _ritz(plate: ThickPanel, points: Points, degrees: Sequence[int]) -> Iterator[tuple[Array, Array]]:
    """Frequencies, rad/s, and shapes at the points of each group of products that do not interact."""
    thin, shear = plate.thin, 1 / plate.shear[1]
    d11, d12, d22, d66 = thin.stiffness
    k_x, k_y, k_xy = _CURVED
    pairs = [(d11, k_x, k_x), (d22, k_y, k_y), (d12, k_x, k_y), (d12, k_y, k_x), (d66, k_xy, k_xy)]
    pairs += [(shear, each, each) for each in _SHEARED] + [(thin.foundation, _MOVED, _MOVED)]
    bent = [line(ends, LEAST) for ends in thin.ends]
    for parities in product(*((0, 1) if symmetric(thin, along) else (None,) for along in (0, 1))):
        made = _products(plate, degrees, parities)
        seen = np.array([made.at(point[:2], _at_a_point(plate, point[2:])) for point in points])
        if np.abs(seen[0]).max() <= NODE * 2.0 / math.sqrt(math.prod(thin.size)):
            continue
        energy, count = made.energy(pairs), math.prod(map(len, made.lines[0]))
        energy[:count, :count] += _springs(thin, made)
        square, moved = spectrum(energy, seen, least_stiffness(thin))
        p, q = (
            np.flatnonzero((parity is None) | (own.odd == parity)) for own, parity in zip(bent, parities, strict=True)
        )
        block = np.repeat(p, q.size), np.tile(q, p.size)
        square[: loose_motions(thin, bent, block).shape[1]] = 0.0
        yield np.sqrt(np.maximum(square, 0.0) / thin.mass_per_area), moved


def _products(plate: ThickPanel, degrees: Sequence[int], parities: tuple[int | None, ...]) -> _Products:
    """Those in which w is even (0) or odd (1) in x and in y, or both (None)."""
    held, clamped = (
        [(ends[0] in kinds, ends[1] in kinds) for ends in plate.thin.ends]
        for kinds in (("simply supported", "clamped"), ("clamped",))
    )
    fields = ((held[0], held[1]), (clamped[0], held[1]), (held[0], clamped[1]))
    lines = list[tuple[Array, Array]]()
    for number, ends in enumerate(fields):
        rows = list[Array]()
        for along, parity in enumerate(parities):
            whole, odd = _functions(ends[along], degrees[along])
            turned = number == along + 1  # ψx is odd in x where w is even
            rows.append(whole if parity is None else whole[odd == (bool(parity) != turned)])
        lines.append((rows[0], rows[1]))
    rotation = math.sqrt(12.0) / plate.thickness
    return _Products(plate.thin.size, lines, (1.0, rotation, rotation))


def _springs(thin: Panel, made: _Products) -> Array:
    """The energy of w in the springs along the edges."""
    x, y = made.lines[0]
    found = np.zeros((len(x) * len(y),) * 2)
    for edge, stiffness in enumerate(thin.springs):
        if stiffness:
            rows, side = ((x, thin.size[0]), (y, thin.size[1]))[edge // 2]
            end = rows @ _normed(2.0 * (edge % 2) - 1.0, rows.shape[1]) * math.sqrt(2.0 / side)
            own = np.outer(end, end)
            found += stiffness * (np.kron(own, np.eye(len(y))) if edge < 2 else np.kron(np.eye(len(x)), own))
    return found


# ---------------------------------------------------------------- static deflection


@lru_cache(maxsize=64)
@one_thread
def thick_compliance(plate: ThickPanel, position: Point) -> tuple[float, float]:
    """Static deflection over force less that of the contact's half-space, m/N, and a bound on its error.

    The part of shear differs from that of simply supported edges, `shear_compliance`, by what Ritz's method gives for
    both, because their polynomials lack the same around the force.
    """
    # Degree of the polynomials of the static deflection by shear, and of those that give a bound on the rest
    static_degree, lower_degree = 22, 18
    thin = plate.thin
    bent, error = compliance_and_error(thin, position)
    simple = Panel(thin.mass_per_area, thin.stiffness, thin.size, SIMPLE + SIMPLE)
    sheared = shear_compliance(thin.stiffness, thin.size, position, plate.shear)
    lower, last = (
        _shear_of(plate, position, degree) - _shear_of(replace(plate, thin=simple), position, degree)
        for degree in (lower_degree, static_degree)
    )
    return bent + sheared + last, error + REMAINDER * abs(last - lower)


def _shear_of(plate: ThickPanel, position: Point, degree: int) -> float:
    """Deflection over force of polynomials with shear less that without."""
    total = -ritz_compliance(plate.thin, position, degree)
    for frequency, moved in _ritz(plate, (position,), degrees_along(plate.thin, degree)):
        bends = frequency > 0.0
        total += float(np.sum(moved[0, bends] ** 2 / frequency[bends] ** 2)) / plate.thin.mass_per_area
    return total
