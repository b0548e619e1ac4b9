"""Vibrations of plates by other methods than the package's, to judge its impacts by.

Simply supported ones: Navier's series, with shear where the plate has it. Others: Ritz's method with B-splines of
degree 9, of each half-wave alone between two opposite simply supported edges. The deflection that vibrations above the
highest add is that under F exp(s t) of B-splines whose cells shrink towards the force and the edges, less that of those
below.
"""

from __future__ import annotations

import math
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
from scipy.interpolate import BSpline

import film_model as fm
from benchmarks.other_modes import COUNT, HINGED, NODE, Array, OtherModes, gauss, with_rest
from film_model.targets.supports import four

DEGREE = 9
PER_WAVE = 1.35
"""B-splines for each half-wave of the highest frequency: errors of frequencies are then below 1e-4."""

MOST_FUNCTIONS = 2000
"""B-splines that interact: their vibrations take about a second."""

MOST_WORK = 6e8
"""Sum of the cubes of their numbers of half-waves alone."""

TERMS = 2e6
"""Of Navier's series; the rest is that of a constant density of shares: the error is 1e-8."""


class Statics(NamedTuple):
    """B-splines for the static deflection: cells towards the force and towards an edge, ratio of neighbours, degree."""

    layers: int
    corners: int
    shrink: float
    degree: int


FINE, COARSE = Statics(15, 7, 0.6, 7), Statics(11, 6, 0.5, 6)
"""Errors of the static deflection of 1e-7 and 1e-6; beside corners, and of plates ten times as stiff one way, ten times
as large."""


def of_plate(target: Any, highest: float, statics: Statics = FINE) -> OtherModes:
    """Those of a plate or a wide beam up to `highest` [rad/s], or to what can be computed in about two seconds.
    statics: of the splines for the static deflection."""
    plate = _Plate.of(target)
    return plate.closed(highest) if plate.hinged == [True, True] else plate.splines(highest, statics)


class _Splines:
    """Combinations of B-splines that satisfy the ends of a side, orthonormal in ∫ f g; their ∫ f′ g′, f″ g″ and f″ g,
    values at a place and at both ends. parity: 0 or 1 for even or odd ones, of ends that are alike."""

    def __init__(
        self, knots: Array, ends: tuple[str, str], at: float, degree: int = DEGREE, parity: int | None = None
    ) -> None:
        whole = np.concatenate([np.full(degree, knots[0]), knots, np.full(degree, knots[-1])])
        count = whole.size - degree - 1
        taken = np.eye(count)[:, COUNT[ends[0]] : count - COUNT[ends[1]]]
        if parity is not None:
            taken = taken[:, : (taken.shape[1] + 1 - parity) // 2]
            taken = taken + (-1) ** parity * taken[::-1]
        basis = BSpline(whole, taken, degree)
        places, weights = gauss(knots, degree + 1)
        value, slope, curve = (basis(places, order) * np.sqrt(weights)[:, None] for order in (0, 1, 2))
        # orthonormal in both by a factorisation of the values: the matrix of ∫ f″ g″ would lose half of the digits
        length = knots[-1] - knots[0]
        joint, root = np.linalg.qr(np.concatenate([value, curve * (length / math.pi) ** 2]))
        _, size, turn = np.linalg.svd(joint[: len(value)], full_matrices=False)
        combined = scipy.linalg.solve_triangular(root, turn.T / size)
        value, slope, curve = value @ combined, slope @ combined, curve @ combined
        self.slope, self.curve, self.mixed = slope.T @ slope, curve.T @ curve, curve.T @ value
        self.at, self.low, self.high = basis(np.array([at, knots[0], knots[-1]])) @ combined


def _graded(at: float, side: float, statics: Statics) -> Array:
    """Knots from 0 to a side, closer and closer towards a place, and towards both ends."""
    inner, outer = (statics.shrink ** np.arange(*span) for span in ((0.0, statics.layers), (2.0, statics.corners)))
    part = np.sort(np.concatenate([[0.0], inner, 1.0 - outer]))
    return np.unique(np.concatenate([at - at * part, at + (side - at) * part]))


class _Plate(NamedTuple):
    """A plate: mass per area, D11, D12, D22, D66, sides, struck point, edges, springs and bed; and h and ν of one with
    shear, else 0."""

    mass: float
    stiffness: tuple[float, ...]
    size: tuple[float, ...]
    at: tuple[float, ...]
    ends: tuple[tuple[str, str], tuple[str, str]]
    springs: tuple[float, ...]
    bed: float
    sheared: tuple[float, float]

    @classmethod
    def of(cls, target: Any) -> _Plate:
        material, h, shear = target.material, target.thickness, False
        if isinstance(target, fm.Beam):
            edges: Any = ((target.ends,) * 2 if isinstance(target.ends, str) else target.ends, ("free", "free"))
            size, at = (target.length, target.width), (target.struck, target.width / 2)
            springs, bed = (0.0,) * 4, 0.0
        else:
            words: Any = four(target.edges)
            edges = words[:2], words[2:]
            size, at, shear = target.size, target.struck, target.sheared
            springs, bed = four(target.edge_stiffness or 0.0), target.foundation_stiffness or 0.0
            if (given := target.bending_stiffness) is not None:
                stiffness = given.D11, given.D12, given.D22, given.D66
                return cls(target.mass_per_area, stiffness, size, at, edges, springs, bed, (0.0, 0.0))
        ratio = material.poissons_ratio
        d = material.youngs_modulus * h**3 / 12 / (1 - ratio**2)
        stiffness, sheared = (d, ratio * d, d, (1 - ratio) / 2 * d), (h, ratio) if shear else (0.0, 0.0)
        return cls(material.density * h, stiffness, size, at, edges, springs, bed, sheared)

    @property
    def hinged(self) -> list[bool]:
        """Whether both edges that bound x, and y, are simply supported."""
        return [ends == HINGED for ends in self.ends]

    @property
    def slow(self) -> float:
        """A frequency of about the lowest, rad/s."""
        d11, _, d22, _ = self.stiffness
        return math.pi**2 * math.sqrt(min(d11 / self.size[0] ** 4, d22 / self.size[1] ** 4) / self.mass)

    def half_waves(self, highest: float) -> list[float]:
        """Along both sides up to a frequency, of the direction in which they are shortest."""
        d11, d12, d22, d66 = self.stiffness
        least = min(1.0, (1 + (d12 + 2 * d66) / math.sqrt(d11 * d22)) / 2)
        rate = self.mass * highest**2 / least
        return [side / math.pi * (rate / d) ** 0.25 for side, d in zip(self.size, (d11, d22), strict=True)]

    # ------------------------------------------------------------ simply supported

    def closed(self, highest: float) -> OtherModes:
        """Navier's series; with shear, up to waves of k h = 1.2."""
        frequency, share = self.series(highest)
        many = highest * max(1.0, math.sqrt(TERMS / (math.prod(self.half_waves(highest)) + 1)))
        every, all_shares = self._replace(sheared=(0.0, 0.0)).series(many)
        static = float(np.sum(all_shares / every**2) + np.sum(all_shares) / many**2)
        h, _ = self.sheared
        if h:
            static += h**2 / (10 * math.pi * self.stiffness[0]) * (math.log(self.reach() / h) - 1.054)
        return OtherModes(highest, frequency, share, max(static - float(np.sum(share / frequency**2)), 0.0))

    def series(self, highest: float) -> tuple[Array, Array]:
        """Frequencies, ascending, and shares."""
        (d11, d12, d22, d66), (a, b), (h, ratio) = self.stiffness, self.size, self.sheared
        most = [int(1.5 * number) + 2 if h else int(number) + 1 for number in self.half_waves(highest)]
        kx, ky = (np.arange(1.0, n + 1.0) * math.pi / side for n, side in zip(most, self.size, strict=True))
        seen = np.outer(np.sin(kx * self.at[0]) ** 2, np.sin(ky * self.at[1]) ** 2) * 4 / (a * b * self.mass)
        bent = d11 * kx[:, None] ** 4 + 2 * (d12 + 2 * d66) * np.outer(kx**2, ky**2) + d22 * ky**4 + self.bed
        square, k = bent / self.mass, np.hypot(kx[:, None], ky)
        if h:
            shear, turning = 5 / (6 - ratio) * 6 * (1 - ratio) * d11 / h**2, self.mass * h**2 / 12
            # (S k² − ρ ω²) (D k² + S − I ω²) = S² k², ψ = Ψ cos: the lower root
            middle = self.mass * (d11 * k**2 + shear) + turning * shear * k**2
            square = 2 * shear * d11 * k**4
            square = square / (middle + np.sqrt(middle**2 - 2 * self.mass * turning * square))
            psi = (shear * k**2 - self.mass * square) / (shear * k)
            bulge = ratio * h**2 / 12 / (1 - ratio)
            seen = seen * (1 - bulge * k * psi) ** 2 / (1 + turning / self.mass * psi**2)
        kept = (square <= highest**2) & (k * h <= 1.2) & (seen > NODE * seen.max())
        order = np.argsort(square[kept])
        return np.sqrt(square[kept][order]), seen[kept][order]

    def reach(self) -> float:
        """ℓ of a membrane between the edges: its deflection next to a force is −ln(r/ℓ)/(2π)."""
        (a, b), (x, y) = self.size, self.at
        k = np.arange(1.0, 2000.0) * math.pi / a
        fades = np.exp(-2 * k * b), np.exp(-2 * k * y), np.exp(-2 * k * (b - y))
        beside = ((1 - fades[1]) * (1 - fades[2]) / (1 - fades[0]) - 1) / k * np.sin(k * x) ** 2
        return 2 * a / math.pi * math.sin(math.pi * x / a) * math.exp(2 * math.pi / a * float(np.sum(beside)))

    # ------------------------------------------------------------ other edges

    def splines(self, highest: float, statics: Statics) -> OtherModes:
        """By B-splines, up to the frequency that their number allows."""
        plate = self
        if self.hinged[1]:
            (d11, d12, d22, d66), springs = self.stiffness, self.springs
            plate = self._replace(
                stiffness=(d22, d12, d11, d66), size=self.size[::-1], at=self.at[::-1], ends=self.ends[::-1],
                springs=springs[2:] + springs[:2],
            )  # fmt: skip
        find = plate.each_half_wave if plate.hinged[0] else plate.together
        while (found := find(highest)) is None:
            highest /= 2**0.25
        square, share = found
        square[np.abs(square) < 1e-6 * plate.slow**2] = 0.0
        return with_rest(highest, np.sqrt(square), share, plate.slow, plate.receptance(statics))

    def line(self, highest: float, along: int, parity: int | None = None) -> _Splines:
        """Along a side, for frequencies up to the highest."""
        cells = max(8, math.ceil(PER_WAVE * self.half_waves(highest)[along]) + 1)
        knots = np.linspace(0.0, self.size[along], cells + 1)
        return _Splines(knots, self.ends[along], self.at[along], parity=parity)

    def across(self, y: _Splines, k: float) -> Array:
        """The energy across a half-wave sin(k x), over a/2."""
        d11, d12, d22, d66 = self.stiffness
        found = (d11 * k**4 + self.bed) * np.eye(y.at.size) + d22 * y.curve + 4 * d66 * k**2 * y.slope
        return found - d12 * k**2 * (y.mixed + y.mixed.T) + self.held(y, 1)

    def held(self, y: _Splines, along: int) -> Array:
        """The energy of the springs at both ends of a side."""
        low, high = self.springs[2 * along : 2 * along + 2]
        return low * np.outer(y.low, y.low) + high * np.outer(y.high, y.high)

    def each_half_wave(self, highest: float) -> tuple[Array, Array] | None:
        """ω² and shares between two simply supported edges; None if they take too long."""
        waves, y = self.half_waves(highest), self.line(highest, 1)
        d11, d12, d22, _ = self.stiffness
        number = int(waves[0] * (1 - d12**2 / (d11 * d22)) ** -0.25) + 1  # free edges let the plate curl
        if number * y.at.size**3 > MOST_WORK:
            return None
        squares, shares = list[Array](), list[Array]()
        for k in np.arange(1.0, number + 1.0) * math.pi / self.size[0]:
            value, part = _seen_spectrum(self.across(y, k) / self.mass, y.at, self.slow**2)
            squares.append(value[value <= highest**2])
            seen = math.sin(k * self.at[0]) ** 2 * 2 / (self.size[0] * self.mass)
            shares.append(seen * part[value <= highest**2])
        return np.concatenate(squares), np.concatenate(shares)

    def energy(self, x: _Splines, y: _Splines) -> Array:
        """Of products of those along x and along y."""
        d11, d12, d22, d66 = self.stiffness
        one, other = np.eye(x.at.size), np.eye(y.at.size)
        found = np.kron(d11 * x.curve + self.held(x, 0) + self.bed * one, other)
        found += np.kron(one, d22 * y.curve + self.held(y, 1)) + np.kron(4 * d66 * x.slope, y.slope)
        twist = np.kron(d12 * x.mixed, y.mixed.T)
        return found + twist + twist.T

    def together(self, highest: float) -> tuple[Array, Array] | None:
        """ω² and shares of all products; None if they are too many. Even and odd ones do not interact."""
        lines = [[self.line(highest, along, parity) for parity in self.parities(along)] for along in (0, 1)]
        if math.prod(max(line.at.size for line in each) for each in lines) > MOST_FUNCTIONS:
            return None
        squares, shares = list[Array](), list[Array]()
        for x, y in product(*lines):
            seen = np.outer(x.at, y.at).ravel()
            if np.linalg.norm(seen) > 1e-9 * seen.size:
                value, part = _seen_spectrum(self.energy(x, y) / self.mass, seen, self.slow**2)
                squares.append(value[value <= highest**2])
                shares.append(part[value <= highest**2] / self.mass)
        return np.concatenate(squares), np.concatenate(shares)

    def parities(self, along: int) -> tuple[int | None, ...]:
        """Even and odd where both ends are alike."""
        low, high = self.springs[2 * along : 2 * along + 2]
        return (0, 1) if self.ends[along][0] == self.ends[along][1] and low == high else (None,)

    def receptance(self, statics: Statics) -> float:
        """Deflection over a force that grows as exp(s t), s = `slow`: cells shrink towards the force and the edges."""
        x, y = (
            _Splines(_graded(at, side, statics), ends, at, statics.degree)
            for at, side, ends in zip(self.at, self.size, self.ends, strict=True)
        )
        energy = self.energy(x, y)
        energy[np.diag_indices(len(energy))] += self.mass * self.slow**2
        scale, seen = 1 / np.sqrt(np.diag(energy)), np.outer(x.at, y.at).ravel()
        energy *= scale[:, None] * scale
        return float(seen * scale @ scipy.linalg.solve(energy, seen * scale, assume_a="pos", overwrite_a=True))


def _seen_spectrum(matrix: Array, seen: Array, shift: float) -> tuple[Array, Array]:
    """Eigenvalues of a matrix and the squares of the components of `seen` along the eigenvectors.

    Of the inverse of the matrix + shift, where the lowest keep their digits. A reflection turns `seen` into the first
    axis; then the eigenvectors of the tridiagonal matrix have the components in their first row.
    """
    lapack: Any = scipy.linalg.lapack
    matrix[np.diag_indices(seen.size)] += shift
    scale = 1 / np.sqrt(np.diag(matrix))
    matrix *= scale[:, None] * scale
    lower = np.tril(lapack.dpotri(lapack.dpotrf(matrix.T, lower=1, overwrite_a=1)[0], lower=1, overwrite_c=1)[0])
    inverse = (lower + np.tril(lower, -1).T) * (scale[:, None] * scale)
    size = float(np.linalg.norm(seen))
    mirror = seen / size
    mirror[0] += math.copysign(1.0, mirror[0])
    mirror /= np.linalg.norm(mirror)
    turned = inverse @ mirror
    turned -= (mirror @ turned) * mirror
    inverse -= 2 * (np.outer(mirror, turned) + np.outer(turned, mirror))
    room = int(lapack.dsytrd_lwork(seen.size, lower=1)[0])
    _, diagonal, beside, _, _ = lapack.dsytrd(inverse.T, lower=1, lwork=room, overwrite_a=1)
    value, vector = scipy.linalg.eigh_tridiagonal(diagonal, beside)
    return 1 / value - shift, (size * vector[0]) ** 2
