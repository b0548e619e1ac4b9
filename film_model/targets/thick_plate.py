"""Vibrations and static deflection of thick rectangular plates: Mindlin's theory, with shear and rotary inertia.

Energy ½ ∫∫ D11 ψx,x² + 2 D12 ψx,x ψy,y + D22 ψy,y² + D66 (ψx,y + ψy,x)² + S |∇w − ψ|² + k_f w² and that of edge
springs; inertia ρ_A w² + ρ h³/12 |ψ|². Where an edge is supported or clamped, w and the rotation along it are 0; where
it is clamped, that across it too. w and both rotations are sums of products of Legendre polynomials in x and in y.

Both faces move by w + f (ψx,x + ψy,y), f = ν h²/(12 (1 − ν)): the plate gets thinner and thicker as it bends. With that
and S = κ G h, κ = 5/(6 − ν), simply supported plates have the frequencies and the deflections of three-dimensional
elasticity to the first power of k² h² in waves of 2π/k. Shorter waves than π h are left out: the half-space of the
contact law has them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import product

import numpy as np

from film_model.base.threads import one_thread
from film_model.targets.beam_theory import Line, sheared_waves, wave_number
from film_model.targets.line_functions import SIMPLE, line
from film_model.targets.modes import Array, Modes, Points, sorted_modes
from film_model.targets.panel_statics import REMAINDER, compliance_and_error, ritz_compliance
from film_model.targets.plate_shear import LOCAL, reach_of_simple
from film_model.targets.ritz import LEAST, NODE, Panel, least_stiffness, loose_motions, seen_modes, spectrum, symmetric

SHORTEST = 1.2
"""k h of the shortest waves. From 1.4 on all waves together deflect more than the layer less the half-space."""

DEGREES = 1.6, 8
"""Degree of the polynomials for each half-wave, and beyond: errors of frequencies are then below 1e-6, with corners
clamped-free 1e-5."""

MOST_FUNCTIONS = 1500
"""Largest number of products that interact: their vibrations take a second."""

STATIC_DEGREE, LOWER_DEGREE = 22, 18
"""Degree of the polynomials of the static deflection by shear, and of those that give a bound on the rest."""


@dataclass(frozen=True)
class ThickPanel:
    """A thick isotropic plate. thin: the same without shear. thickness: m. ratio: Poisson's. shear: S, N/m."""

    thin: Panel
    thickness: float
    ratio: float
    shear: float

    @classmethod
    def of(cls, thin: Panel, thickness: float, ratio: float) -> ThickPanel:
        """With κ = 5/(6 − ν): S = 6 (1 − ν) κ D/h²."""
        coefficient = 5 / (6 - ratio)
        return cls(thin, thickness, ratio, 6 * (1 - ratio) * coefficient * thin.stiffness[0] / thickness**2)

    @property
    def strip(self) -> Line:
        """A strip of unit width whose vibrations are waves of the plate."""
        density = self.thin.mass_per_area
        return Line(density, self.thin.stiffness[0], 1.0, SIMPLE, self.shear, density * self.thickness**2 / 12)

    @property
    def bulge(self) -> float:
        """f, m²."""
        return self.ratio * self.thickness**2 / 12 / (1 - self.ratio)

    @property
    def highest(self) -> float:
        """Frequency of the shortest waves, rad/s."""
        return math.sqrt(sheared_waves(self.strip, np.array([SHORTEST / self.thickness]))[0][0, 0])

    def half_waves(self, highest: float) -> list[float]:
        """Half-waves along both sides up to a frequency."""
        return [wave_number(self.strip, highest) * side / math.pi for side in self.thin.size]

    def degrees(self, highest: float) -> list[int]:
        """Degrees of the polynomials along both sides that resolve them."""
        return [DEGREES[1] + math.ceil(DEGREES[0] * number) for number in self.half_waves(highest)]

    def missing(self, position: tuple[float, float]) -> str:
        """Why its motion is not known where it is struck; empty if it is."""
        (a, b), (x, y) = self.thin.size, position
        near = zip(self.thin.edges, (x, a - x, y, b - y), strict=True)
        if any(edge == "free" and distance < self.thickness for edge, distance in near):
            return "the plate is struck within its thickness of a free edge"
        sides = enumerate(self.degrees(self.highest))
        largest = 3 * math.prod((n + 2) // 2 if symmetric(self.thin, k) else n + 1 for k, n in sides)
        many = largest > MOST_FUNCTIONS and self.thin.ends != (SIMPLE, SIMPLE)
        return "the plate is so thin that it has too many vibrations for it" if many else ""


def thick_modes(plate: ThickPanel, position: tuple[float, float], highest: float, others: Points = ()) -> Modes:
    """The bending vibrations of a plate struck at `position` [m] up to the frequency `highest` [rad/s], and waves of
    k h = `SHORTEST`. others: sensors, m, or with orders of derivatives; those of the second order are curvatures of
    ψ."""
    return _thick_modes(plate, (position, *others), min(highest, plate.highest))


@lru_cache(maxsize=16)
@one_thread
def _thick_modes(plate: ThickPanel, points: Points, highest: float) -> Modes:
    if plate.thin.ends == (SIMPLE, SIMPLE):
        return _simple(plate, points, highest)
    return seen_modes(plate.thin, list(_ritz(plate, points, plate.degrees(highest))), highest)


def _simple(plate: ThickPanel, points: Points, highest: float) -> Modes:
    """Of simply supported edges: w = sin(iπx/a) sin(jπy/b), ψ = Ψ ∇w/k."""
    (a, b), thin = plate.thin.size, plate.thin
    i, j = (
        np.arange(1.0, number + 1.0) * math.pi / side
        for number, side in zip(plate.half_waves(highest), (a, b), strict=True)
    )
    along, across = (each.ravel() for each in np.meshgrid(i, j, indexing="ij"))
    k = np.hypot(along, across)
    square, turn = (each[0] for each in sheared_waves(plate.strip, k, thin.foundation))
    seen = list[Array]()
    for x, y, *orders in points:
        m, n = orders or (0.0, 0.0)
        factor = 1.0 - plate.bulge * k * turn if m + n == 0.0 else turn / k if m + n == 2.0 else 1.0
        waves = along**m * np.sin(along * x + m * math.pi / 2) * across**n * np.sin(across * y + n * math.pi / 2)
        seen.append(factor * waves)
    moved = np.array(seen) * 2.0 / np.sqrt(a * b * (thin.mass_per_area + plate.strip.turning * turn**2))
    return sorted_modes(np.sqrt(square), moved[0] ** 2, highest, moved[0] * moved[1:])


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


def _ritz(plate: ThickPanel, points: Points, degrees: list[int]) -> Iterator[tuple[Array, Array]]:
    """Frequencies, rad/s, and shapes at the points of each group of products that do not interact."""
    thin, shear = plate.thin, plate.shear
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


def _products(plate: ThickPanel, degrees: list[int], parities: tuple[int | None, ...]) -> _Products:
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
def thick_compliance(plate: ThickPanel, position: tuple[float, float]) -> tuple[float, float]:
    """Static deflection over force less that of the contact's half-space, m/N, and a bound on its error.

    Simply supported: that of the thin plate and 6 (1 − ν²)/(5π E h) (ln(ℓ/h) − 1.054), as of `shear_around`. Others
    differ from that by what Ritz's method gives for both, because their polynomials lack the same around the force.
    """
    thin = plate.thin
    bent, error = compliance_and_error(thin, position)
    simple = Panel(thin.mass_per_area, thin.stiffness, thin.size, SIMPLE + SIMPLE)
    softness = plate.thickness**2 / (10 * math.pi * thin.stiffness[0])
    sheared = softness * (math.log(reach_of_simple(thin.size, position) / plate.thickness) - LOCAL)
    if thin == simple:
        return bent + sheared, error
    lower, last = (
        _shear_of(plate, position, degree) - _shear_of(replace(plate, thin=simple), position, degree)
        for degree in (LOWER_DEGREE, STATIC_DEGREE)
    )
    return bent + sheared + last, error + REMAINDER * abs(last - lower)


def _shear_of(plate: ThickPanel, position: tuple[float, float], degree: int) -> float:
    """Deflection over force of polynomials with shear less that without."""
    total = -ritz_compliance(plate.thin, position, degree)
    for frequency, moved in _ritz(plate, (position,), [degree, degree]):
        bends = frequency > 0.0
        total += float(np.sum(moved[0, bends] ** 2 / frequency[bends] ** 2)) / plate.thin.mass_per_area
    return total
