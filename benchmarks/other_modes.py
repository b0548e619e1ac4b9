"""Vibrations of rods and beams by other methods than the package's, to judge its impacts by.

Rods: closed form. Beams: roots of the dynamic stiffness of both theories, counted by Wittrick and Williams (1971, Q. J.
Mech. Appl. Math. 24:263), so that none is missed. The deflection that vibrations above the highest add is that of the
whole structure under F exp(s t) less that of those below.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import film_model as fm

Array = NDArray[Any]

NODE = 1e-20
"""Share over the largest, below which the struck point is a node."""

COUNT = {"simply supported": 1, "clamped": 2, "free": 0}
SIMPLE = "simply supported"
HINGED = (SIMPLE, SIMPLE)


class OtherModes(NamedTuple):
    """Vibrations up to a frequency, rad/s: frequency, share, 1/kg, and the compliance that all higher ones add, m/N."""

    highest: float
    frequency: Array
    share: Array
    omitted: float


def with_rest(highest: float, frequency: Array, share: Array, s: float, whole: float) -> OtherModes:
    """whole: deflection over a force that grows as exp(s t); above the highest frequency s changes it by its square
    over three times that of the frequency."""
    order = np.argsort(frequency)
    order = order[share[order] > NODE * share.max()]
    frequency, share = frequency[order], share[order]
    rest = (whole - float(np.sum(share / (frequency**2 + s**2)))) * (1 + (s / highest) ** 2 / 3)
    return OtherModes(highest, frequency, share, max(rest, 0.0))


def of_rod(rod: fm.Rod, highest: float) -> OtherModes:
    """u = cos(ω x/c): ω L/c is n π with a free far end, (n + 1/2) π with a fixed one."""
    assert rod.length is not None and rod.diameter is not None
    area, speed = math.pi / 4 * rod.diameter**2, math.sqrt(rod.material.youngs_modulus / rod.material.density)
    mass, rate, fixed = rod.material.density * area * rod.length, speed / rod.length, rod.far_end == "fixed"
    frequency = (np.arange(highest / rate / math.pi + 1.0) + 0.5 * fixed) * math.pi * rate
    frequency = frequency[frequency <= highest]
    share = np.where(frequency > 0.0, 2.0, 1.0) / mass
    whole = (math.tanh(1.0) if fixed else 1 / math.tanh(1.0)) / (mass * rate**2)
    return with_rest(highest, frequency, share, rate, whole)


def gauss(knots: Array, count: int) -> tuple[Array, Array]:
    """Gauss nodes and weights between all knots."""
    node, weight = np.polynomial.legendre.leggauss(count)
    half = np.diff(knots)[:, None] / 2
    return (knots[:-1, None] + half * (1 + node)).ravel(), (half * weight).ravel()


class _Line(NamedTuple):
    """A beam: mass and rotary inertia per length, EI, κGA (infinite by Euler and Bernoulli), struck at a place."""

    mass: float
    turning: float
    bending: float
    shear: float
    length: float
    at: float
    ends: tuple[str, str]

    @classmethod
    def of(cls, beam: fm.Beam) -> _Line:
        material, area, ratio = beam.material, beam.width * beam.thickness, beam.material.poissons_ratio
        second, modulus = area * beam.thickness**2 / 12, material.youngs_modulus
        shear = 10 * (1 + ratio) / (12 + 11 * ratio) * modulus / 2 / (1 + ratio) * area if beam.sheared else math.inf
        turning = material.density * second if beam.sheared else 0.0
        ends: Any = (beam.ends,) * 2 if isinstance(beam.ends, str) else beam.ends
        return cls(material.density * area, turning, modulus * second, shear, beam.length, beam.struck, ends)

    def waves(self, square: Array) -> tuple[Array, Array, Array, Array]:
        """Rates of the four exponentials at ω² = square, 1/m, and ψ, moment and shear force over w of each."""
        q, r = self.mass * square / self.shear, self.turning * square / self.bending
        root = np.emath.sqrt(((q - r) / 2) ** 2 + self.mass * square / self.bending + 0j)
        one, other = (np.emath.sqrt(-(q + r) / 2 + sign * root + 0j) for sign in (1, -1))
        rates = np.stack([-one, one, -other, other], axis=-1)
        turn = (rates**2 + q[..., None]) / rates
        force = -(self.bending * rates**2 + self.turning * square[..., None]) * turn
        return rates, turn, self.bending * turn * rates, force

    def at_places(self, rates: Array, places: Array) -> Array:
        """The exponentials, (…, places, 4), each at most 1 in size: exp(−r x) and exp(−r (L − x))."""
        x = places[:, None]
        return np.exp(rates[..., None, :] * np.where(np.arange(4) % 2 == 0, x, x - self.length))

    def stiffness(self, square: Array) -> Array:
        """Forces and moments at both ends over deflections and rotations there, (…, 4, 4)."""
        rates, turn, moment, force = self.waves(square)
        ends = self.at_places(rates, np.array([0.0, self.length]))
        here, there = ends[..., 0, :], ends[..., 1, :]
        moved = np.stack([here, here * turn, there, there * turn], axis=-2)
        pushed = np.stack([-here * force, -here * moment, there * force, there * moment], axis=-2)
        found = np.swapaxes(np.linalg.solve(np.swapaxes(moved, -1, -2), np.swapaxes(pushed, -1, -2)), -1, -2).real
        return (found + np.swapaxes(found, -1, -2)) / 2

    def free(self) -> list[int]:
        """Deflections (even) and rotations (odd) of the ends that are free."""
        return [2 * k + j for k, end in enumerate(self.ends) for j in (0, 1) if j >= COUNT[end]]

    def simple(self, highest: float) -> tuple[Array, Array]:
        """Frequencies up to the highest, and shares, of the same beam with simple supports, in no order."""
        most = int(self.length / math.pi * np.abs(self.waves(np.array(highest**2))[0]).max()) + 2
        beta = np.arange(0.0, most + 1.0) * math.pi / self.length
        square, turn = self.bending / self.mass * beta**4, beta
        if self.turning:
            middle = self.mass * (self.bending * beta**2 + self.shear) + self.turning * self.shear * beta**2
            last = self.shear * self.bending * beta**4
            high = middle + np.sqrt(middle**2 - 4 * self.mass * self.turning * last)
            square = np.append(2 * last / high, high / (2 * self.mass * self.turning))
            beta = np.append(beta, beta)
            turn = (self.shear * beta**2 - self.mass * square) / (self.shear * np.maximum(beta, 1e-9))
        kept = (square > 0.0) & (square <= highest**2)
        mass = (self.mass + self.turning * turn**2) * self.length / 2
        return np.sqrt(square[kept]), np.sin(beta[kept] * self.at) ** 2 / mass[kept]

    def number_below(self, frequency: Array) -> Array:
        """Number of frequencies below, of Wittrick and Williams."""
        matrix = self.stiffness(frequency**2)
        negative = [
            np.sum(np.linalg.eigvalsh(matrix[:, places][:, :, places]) < 0.0, axis=-1) if places else 0
            for places in (self.free(), [1, 3])
        ]
        simple = np.sort(self.simple(float(frequency.max()))[0])
        return np.searchsorted(simple, frequency) + negative[0] - negative[1]


def of_beam(target: fm.Beam, highest: float) -> OtherModes:
    """Those of a slender beam."""
    beam = _Line.of(target)
    rigid = 0 if "clamped" in beam.ends or beam.ends == HINGED else beam.ends.count("free")
    frequency, share = beam.simple(highest) if beam.ends == HINGED else _of_other_ends(beam, highest, rigid)
    s = math.sqrt(beam.bending / beam.mass) * (math.pi / beam.length) ** 2
    total = np.zeros((6, 6))
    for k, length in enumerate((beam.at, beam.length - beam.at)):
        total[2 * k : 2 * k + 4, 2 * k : 2 * k + 4] += beam._replace(length=length).stiffness(np.array(-(s**2)))
    kept = [2, *(k + 2 * (k > 1) for k in beam.free()), 3]
    whole = np.linalg.inv(total[np.ix_(kept, kept)])[0, 0]
    return with_rest(highest, frequency, share, s, float(whole))


def _of_other_ends(beam: _Line, highest: float, rigid: int) -> tuple[Array, Array]:
    """Frequencies up to the highest, by bisection of their number, and shares."""
    count = int(beam.number_below(np.array([highest]))[0])
    wanted = np.arange(rigid + 1, count + 1)
    low, high = np.zeros(wanted.size), np.full(wanted.size, highest)
    for _ in range(64 if wanted.size else 0):
        middle = (low + high) / 2
        under = beam.number_below(middle) < wanted
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    frequency, share = (low + high) / 2, np.zeros(wanted.size)
    places, weights = gauss(np.linspace(0.0, beam.length, 2 * count + 17), 6)
    for part in np.array_split(np.arange(wanted.size), wanted.size * places.size // 2_000_000 + 1):
        share[part] = _shares(beam, frequency[part], places, weights)
    own = beam.mass * beam.length
    if beam.ends == ("free", "free"):
        spin = own * beam.length**2 / 12 + beam.turning * beam.length
        solid = [1 / own, (beam.at - beam.length / 2) ** 2 / spin]
    else:
        arm = beam.at if beam.ends[0] == SIMPLE else beam.length - beam.at
        solid = [arm**2 / (own * beam.length**2 / 3 + beam.turning * beam.length)] * rigid
    return np.append(np.zeros(rigid), frequency), np.append(solid, share)


def _shares(beam: _Line, frequency: Array, places: Array, weights: Array) -> Array:
    """w² at the force over ∫ ρA w² + ρI ψ², of the exponentials that satisfy the four conditions of the ends."""
    rates, turn, moment, force = beam.waves(frequency**2)
    ends = beam.at_places(rates, np.array([0.0, beam.length]))
    rows = []
    for k, end in enumerate(beam.ends):
        kinds = {"clamped": (1.0, turn), SIMPLE: (1.0, moment), "free": (moment, force)}[end]
        rows += [kind * ends[:, k] for kind in kinds]
    matrix = np.stack(rows, axis=1)
    matrix /= np.abs(matrix).max(axis=-1, keepdims=True)
    shape = np.linalg.svd(matrix)[2][:, -1].conj()
    moved = beam.at_places(rates, np.append(places, beam.at))
    w, psi = np.einsum("npk,nk->np", moved, shape), np.einsum("npk,nk->np", moved, shape * turn)
    mass = (beam.mass * w[:, :-1] ** 2 + beam.turning * psi[:, :-1] ** 2) @ weights
    return (w[:, -1] ** 2 / mass).real
