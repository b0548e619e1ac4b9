"""Vibrations and static deflection of beams with any ends: Euler and Bernoulli's theory, and Timoshenko's.

Timoshenko: energy ½ ∫ EI ψ′² + κGA γ² dx of the curvature ψ′ and the shear γ = w′ − ψ, inertia ρA of w and ρI of ψ.
Euler and Bernoulli: γ = 0 and ρI = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from film_model.base.arrays import Number, same
from film_model.base.errors import TooManyModes
from film_model.base.threads import one_thread
from film_model.targets.line_functions import Line as Functions
from film_model.targets.line_functions import line, polynomials
from film_model.targets.modes import Array, Modes, Points, check_count, projected, sorted_modes

MOST_SHEARED = 200
"""The same in Timoshenko's theory."""

LEAST = 8
"""Half-waves that are described at least."""


@dataclass(frozen=True)
class Line:
    """A uniform beam. mass: per length, kg/m. bending: EI, N·m². ends: "simply supported", "clamped" or "free".

    shear: κGA, N, infinite in Euler and Bernoulli's theory. turning: rotary inertia per length, ρI, kg·m.
    """

    mass: Number
    bending: Number
    length: Number
    ends: tuple[str, str]
    shear: Number = math.inf
    turning: Number = 0.0

    @property
    def held(self) -> bool:
        """Whether the supports hold it."""
        return "clamped" in self.ends or self.ends == ("simply supported", "simply supported")

    @property
    def rigid(self) -> int:
        """Number of motions as a rigid body."""
        return 0 if self.held else self.ends.count("free")


def beam_shear_coefficient(poissons_ratio: float) -> float:
    """κ = 10 (1 + ν)/(12 + 11 ν) of a rectangular section (Cowper 1966, J. Appl. Mech. 33:335); 0.85 for ν = 0.3."""
    return 10 * (1 + poissons_ratio) / (12 + 11 * poissons_ratio)


@lru_cache(maxsize=64)
def line_modes(beam: Line, position: float, highest: float, others: Points = ()) -> Modes:
    """The vibrations of a beam struck at `position` [m] up to the frequency `highest` [rad/s]. others: sensors, m, or
    with the order 2 for the curvature, w″ or ψ′."""
    most_waves = 300  # most half-waves of a beam that is not simply supported: their vibrations take half a second
    places = ((position,), *others)
    simple = beam.ends == ("simply supported", "simply supported")
    if math.isinf(beam.shear):
        waves = math.sqrt(highest * math.sqrt(beam.mass / beam.bending)) * beam.length / math.pi
    else:
        waves = wave_number(beam, highest) * beam.length / math.pi
    check_count(waves)
    if simple:
        return _simple(beam, places, highest, waves)
    if waves > (most := most_waves if math.isinf(beam.shear) else MOST_SHEARED):
        raise TooManyModes(
            f"the vibrations of this beam need {waves:.0f} half-waves, but at most {most} are allowed: take "
            "simply supported ends"
        )
    count = max(LEAST, int(waves) + 2)
    if math.isinf(beam.shear):
        shapes = line(beam.ends, count)
        frequency = np.sqrt(beam.bending / beam.mass * shapes.bent) * (2.0 / beam.length) ** 2
        seen = np.array([_deflection(beam, shapes, *place) for place in places])[:, : shapes.shapes]
        products = seen[0] * seen * 2.0 / (beam.mass * beam.length)
        return sorted_modes(frequency[: shapes.shapes], products[0], highest, products[1:])
    frequency, products = _timoshenko(beam, places, 2 * count + 12)
    return sorted_modes(frequency, products[0], highest, products[1:])


def _deflection(beam: Line, shapes: Functions, at: float, order: float = 0.0) -> Array:
    """The functions, or their derivatives, 1/m^order, at a place."""
    return shapes.at(2.0 * at / beam.length - 1.0, int(order)) * (2.0 / beam.length) ** order


def wave_number(beam: Line, frequency: float) -> float:
    """The larger wave number of Timoshenko's bending waves, 1/m."""
    slow, turn = beam.mass / beam.shear * frequency**2, beam.turning / beam.bending * frequency**2
    bent = beam.mass / beam.bending * frequency**2
    return math.sqrt((slow + turn) / 2 + math.sqrt(((slow - turn) / 2) ** 2 + bent))


def _simple(beam: Line, places: Points, highest: float, waves: float) -> Modes:
    """Modes of a simply supported beam: w = sin(βx), ψ = Ψ cos(βx), β = nπ/L.

    Timoshenko: both waves of :func:`sheared_waves`.
    """
    n = np.arange(1.0, waves + 2.0)
    beta = n * math.pi / beam.length
    struck = np.sin(beta * places[0][0])
    sines = np.array([struck * np.sin(beta * at) for at, *_ in places])
    curved = [k for k, (_, *order) in enumerate(places) if order]
    half = beam.mass * beam.length / 2
    if math.isinf(beam.shear):
        found = sines / half
        found[curved] *= -(beta**2)
        return sorted_modes(beta**2 * math.sqrt(beam.bending / beam.mass), found[0], highest, found[1:])
    square, turn = (np.concatenate(each) for each in sheared_waves(beam, beta))
    found = np.hstack([sines, sines]) / (half + beam.turning * beam.length / 2 * turn**2)
    found[curved] *= -np.concatenate([beta, beta]) * turn
    return sorted_modes(np.sqrt(square), found[0], highest, found[1:])


def sheared_waves(beam: Line, beta: Array) -> tuple[Array, Array]:
    """ω² of the waves w = sin(βx), ψ = Ψ cos(βx) of Timoshenko's beam, and Ψ: in bending and in thickness shear.

    (κGA β² − ρA ω²)(EI β² + κGA − ρI ω²) = (κGA β)².
    """
    bent = beam.bending * beta**2 + beam.shear
    last = beam.shear * beam.bending * beta**4  # ρA ρI ω⁴ − middle ω² + last = 0
    middle = beam.mass * bent + beam.turning * beam.shear * beta**2
    large = (middle + np.sqrt(middle**2 - 4 * beam.mass * beam.turning * last)) / 2
    square = np.array([last / large, large / (beam.mass * beam.turning)])
    return square, (beam.shear * beta**2 - beam.mass * square) / (beam.shear * beta)


@one_thread
def _timoshenko(beam: Line, places: Points, degree: int) -> tuple[Array, Array]:
    """Frequencies, and shares and factors, one per row, of all vibrations of a beam in a space of polynomials.

    The curvature and the shear are Legendre series, w and ψ their integrals. The energy is then diagonal, so slender
    beams are as accurate as thick ones. The supports are conditions on five coefficients.
    """
    length, half = beam.length, beam.length / 2
    k = np.arange(degree + 1.0)
    bend, shear = (np.sqrt((2 * k + 1) / (beam.length * stiffness)) for stiffness in (beam.bending, beam.shear))
    one = np.eye(degree + 4)
    slope = np.zeros((2 * degree + 3, degree + 4))  # ψ: Legendre coefficients of each function, one per row
    slope[1, 0] = 1.0 / length
    slope[2 : degree + 3] = half * bend[:, None] * _integrated(one[: degree + 1])
    sheared = np.zeros_like(slope)
    sheared[degree + 3 :] = shear[:-1, None] * one[:degree]
    moved = half * _integrated(slope + sheared)
    moved[0, 0] = 1.0
    space = _space(beam.ends, moved, slope)
    moved, slope = space @ moved, space @ slope
    unit = np.sqrt(length / (2.0 * np.arange(degree + 4.0) + 1.0))
    factor = np.hstack([math.sqrt(beam.mass) * moved * unit, math.sqrt(beam.turning) * slope * unit])
    bent = space[:, 2:] @ space[:, 2:].T  # each function of the series has the energy ½ J
    shift = beam.bending / (beam.mass * length**4)
    root = np.linalg.inv(np.linalg.cholesky(bent + shift * factor @ factor.T))
    at = np.polynomial.legendre.legvander(2.0 * np.array([place[0] for place in places]) / length - 1.0, degree + 3)
    curvature = np.polynomial.legendre.legder(slope, axis=1) / half
    moves = [curvature @ row[:-1] if len(place) > 1 else moved @ row for place, row in zip(places, at, strict=True)]
    shapes, size, _ = np.linalg.svd(root @ factor, full_matrices=False)  # more accurate than `eigh`: see line_functions
    seen = np.array([projected(root @ move, size[::-1], shapes[:, ::-1])[::-1] for move in moves])
    kept = size > 1e-7 * size[0]
    inverse, seen = size[kept] ** 2, seen[:, kept]
    square = 1.0 / inverse - shift
    square[: beam.rigid] = 0.0
    return np.sqrt(np.maximum(square, 0.0)), seen[0] * seen / inverse


def _integrated(series: Array) -> Array:
    """∫ from −1 of Legendre series, in the same number of coefficients: those of the highest degree must be 0."""
    found = np.polynomial.legendre.legint(series, lbnd=-1, axis=1)[:, : series.shape[1]]
    return np.asarray(found, dtype=np.float64)


def _space(ends: tuple[str, str], moved: Array, slope: Array) -> Array:
    """Orthonormal combinations of the functions that satisfy the supports, one per row."""
    conditions: list[Array] = []
    for s, end in ((-1.0, ends[0]), (1.0, ends[1])):
        signs = s ** np.arange(moved.shape[1])
        conditions += [moved @ signs] if end != "free" else []
        conditions += [slope @ signs] if end == "clamped" else []
    if not conditions:
        return np.eye(len(moved))
    rows = np.array([row / np.linalg.norm(row) for row in conditions])
    used = np.flatnonzero(np.abs(rows).max(axis=0) > 1e-15)
    _, sizes, turned = np.linalg.svd(rows[:, used])
    free = turned[np.count_nonzero(sizes > 1e-12) :]
    space = np.zeros((len(moved) - len(conditions), len(moved)))
    space[: len(free), used] = free
    others = np.setdiff1d(np.arange(len(moved)), used)
    space[len(free) :, others] = np.eye(others.size)
    return space


def line_compliance(beam: Line, position: Number) -> Any:
    """Static deflection over force of a beam at `position` [m], m/N, exact; of many beams that are held, an array.

    Of a beam that nothing holds, the deflection without its motion as a rigid body: the vibrations of polynomials, and
    the exact deflection of a cantilever less theirs, because both lack the same kink under the force.
    """
    several = any(isinstance(number, np.ndarray) for number in (beam.bending, beam.length, beam.shear, position))
    if several and not beam.held:
        raise TypeError("a beam that nothing holds has one compliance at a time")
    return _exact(beam, position) if several else _one_compliance(beam, position)


@lru_cache(maxsize=64)
def _one_compliance(beam: Line, position: float) -> float:
    """The same of one beam."""
    if beam.held:
        return _exact(beam, position)
    free_end = beam.ends[1] == "free" and (beam.ends[0] != "free" or position >= beam.length / 2)
    like = Line(
        beam.mass, beam.bending, beam.length, ("clamped", "free") if free_end else ("free", "clamped"), beam.shear,
        beam.turning,
    )  # fmt: skip
    return _exact(like, position) + _sum(beam, position) - _sum(like, position)


def _sum(beam: Line, position: float) -> float:
    """Compliance of all vibrations in a space of polynomials."""
    static = 40  # degree of the polynomials that correct the compliance of a beam that nothing holds
    if not math.isinf(beam.shear):
        frequency, (share,) = _timoshenko(beam, ((position,),), static)
    else:
        shapes = polynomials(beam.ends, static)
        frequency = np.sqrt(beam.bending / beam.mass * shapes.bent) * (2.0 / beam.length) ** 2
        share = shapes.at(2.0 * position / beam.length - 1.0) ** 2 * 2.0 / (beam.mass * beam.length)
    return Modes(frequency, share).compliance


def _exact(beam: Line, position: Number) -> Any:
    """By two elements that are exact for a force between them (Przemieniecki 1968, section 5.6)."""
    lengths = position, beam.length - position
    total = np.zeros((*np.broadcast(beam.bending, beam.shear, *lengths).shape, 6, 6))
    count = {"clamped": 2, "simply supported": 1, "free": 0}
    held = [node + k for node, end in zip((0, 4), beam.ends, strict=True) for k in range(count[end])]
    for k, x in enumerate(lengths):
        if same(x == 0.0):  # the force is at an end: its element has no length
            held += [4 * k, 4 * k + 1]
            continue
        ratio = 12 * beam.bending / (beam.shear * x**2)
        element = [
            [12, 6 * x, -12, 6 * x],
            [6 * x, (4 + ratio) * x**2, -6 * x, (2 - ratio) * x**2],
            [-12, -6 * x, 12, -6 * x],
            [6 * x, (2 - ratio) * x**2, -6 * x, (4 + ratio) * x**2],
        ]
        for row, column in product(range(4), range(4)):
            stiffness = beam.bending / (x**3 * (1 + ratio)) * element[row][column]
            total[..., 2 * k + row, 2 * k + column] += stiffness
    free = [k for k in range(6) if k not in held]
    force = np.array([[float(k == 2)] for k in free])
    bent = np.linalg.solve(total[..., free, :][..., free], force)[..., free.index(2), 0]
    return bent if bent.ndim else bent.item()
