"""Natural vibrations and static deflection of rectangular plates with any edges, by Ritz's method.

The deflection is a sum of products f_p(x) g_q(y) of the functions of :mod:`film_model.targets.line_functions`, and the
energy is ½ ∫∫ D11 w_xx² + 2 D12 w_xx w_yy + D22 w_yy² + 4 D66 w_xy² + k_f w² + edge springs. Functions of different
symmetry do not interact. Each half-wave along a simply supported direction vibrates alone (Lévy's solution): its
functions across are all polynomials up to a degree, which converge faster than any power of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from typing import Any, cast

import numpy as np

from film_model.base.arrays import Array, Index
from film_model.base.errors import SimulationError, TooManyModes
from film_model.base.threads import one_thread
from film_model.core import panels
from film_model.targets.line_functions import SIMPLE, Line, line, polynomials
from film_model.targets.modes import Modes, Points, check_count, projected, sorted_modes, without_rounding

Block = tuple[Index, Index]
"""Numbers p and q of some products."""

MOST_FUNCTIONS = 1200
"""Largest number of products that interact: their vibrations take 0.2 s and 40 MB."""

SIMPLER = "set boundary_reflections = false in [effects] or, of a beam, shorten it: far ends do not matter"
"""What needs fewer functions, in words."""

MOST_WAVES = 160
"""Most half-waves along a side, twice as many if its ends are alike, unless two opposite edges are simply supported:
their shapes take 0.2 s."""

SHARPNESS = ((2.0, 300), (1.6, 1000), (1.3, MOST_FUNCTIONS))
"""Highest frequency of the products over the highest that is asked for, and the number of products that it may take.
Errors of the highest frequency are then up to 1e-3, 2e-3 and 4e-3; below half of it up to 1e-4, 1e-4 and 2e-4. With
1.2, contact times on clamped strips of 30 widths are 6e-4 off."""

MOST_STRIPS = 1e9
"""Largest sum of the cubes of the numbers of polynomials of all half-waves: their vibrations take 0.4 s."""

WORK_OF_A_STRIP = 5e5
"""What each half-wave adds to that sum, however few its polynomials."""

SPARE = 12
"""Degree of the polynomials across a strip beyond what waves and decay need: errors are then below 1e-9."""

FEWEST = 0.6
"""Least number of products below a frequency over that of the half-waves along both sides: π/4 in isotropic plates,
0.66 if D12 + 2 D66 = 3 √(D11 D22). Clamped edges take away up to two of the half-waves."""

NODE = 1e-9
"""A function that is smaller at the struck point, in units of 2/√(a b), has a node there."""

LOOSE = 1e-12
"""Energy of a motion, over that of bending across the sides, below which it is one without energy."""

SHIFT = 1e-8
"""Least shift of the eigenvalues over their median: errors are then below 1e-7 at the median, 1e-10 at the lowest."""

ROUNDED = 1e-14
"""Eigenvalues of the inverse over the largest, below which they are rounding."""

SMALL, AT_ONCE = 64, 1 << 18
"""Matrices of up to so many rows are solved together, so many numbers at a time: one of 24 then takes half of the time.
Larger ones take less without their eigenvectors."""

TOO_SOFT = "the stiffness of the plate's edges or bed is too small, or too large, beside its own"

LEAST = 8
"""Shapes along each side at least: ten vibrations then have errors below 1e-5, with corners clamped-free 1e-4."""

DIGITS = 12
"""Significant digits of the ratios by which plates are similar: rounding in the division changes the last four."""


@dataclass(frozen=True)
class Panel:
    """A rectangular plate. mass_per_area: kg/m². stiffness: D11, D12, D22, D66, N·m. size: m.

    edges: at x = 0, x = a, y = 0, y = b: "simply supported", "clamped" or "free". springs: stiffness per length of
    elastic supports there, N/m². foundation: stiffness per area of an elastic bed, N/m³.
    """

    mass_per_area: float
    stiffness: tuple[float, float, float, float]
    size: tuple[float, float]
    edges: tuple[str, str, str, str]
    springs: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    foundation: float = 0.0

    @property
    def ends(self) -> tuple[tuple[str, str], tuple[str, str]]:
        """The edges that bound x, and those that bound y."""
        return self.edges[:2], self.edges[2:]

    @property
    def exact(self) -> bool:
        """Whether its frequencies are: each half-wave between two simply supported edges vibrates alone."""
        return SIMPLE in self.ends

    @property
    def crossing(self) -> float:
        """About the rate at which bending crosses the shorter side, 1/s."""
        sides = zip(self.stiffness[::2], self.size, strict=True)
        return math.pi * max(math.sqrt(d / self.mass_per_area) / side**2 for d, side in sides)

    @property
    def cornered(self) -> bool:
        """Whether a clamped edge meets a free one: the moment there has no bound."""
        return any({one, other} == {"clamped", "free"} for one, other in product(*self.ends))

    @cached_property
    def core(self) -> panels.Panel:
        """The same in the core."""
        edges = tuple(map(panels.EDGES.index, self.edges))
        return panels.Panel(self.mass_per_area, *self.stiffness, *self.size, self.springs, self.foundation, edges)

    @cached_property
    def unit(self) -> Panel:
        """The similar plate with a = D11 = ρ_A = 1, whose time is in a² √(ρ_A/D11): that of any thickness, without
        springs and bed. Its numbers are rounded to `DIGITS`."""
        (a, b), d = self.size, self.stiffness[0]
        d11, d12, d22, d66 = (to_digits(each / d) for each in self.stiffness)
        s1, s2, s3, s4 = (to_digits(k * a**3 / d) for k in self.springs)
        bed = to_digits(self.foundation * a**4 / d)
        return Panel(1.0, (d11, d12, d22, d66), (1.0, b / a), self.edges, (s1, s2, s3, s4), bed)


def to_digits(value: float) -> float:
    """The value to `DIGITS` significant digits."""
    return float(f"{value:.{DIGITS}g}")


def panel_modes(panel: Panel, position: tuple[float, float], highest: float, others: Points = ()) -> Modes:
    """The vibrations of a plate struck at `position` [m] up to the frequency `highest` [rad/s]. others: sensors, m, or
    with orders of derivatives.

    Those of the similar plate `Panel.unit`: plates of all thicknesses share them. TooManyModes beyond MOST_FUNCTIONS.
    """
    a, points = panel.size[0], (position, *others)
    rate, mass = math.sqrt(panel.stiffness[0] / panel.mass_per_area) / a**2, panel.mass_per_area * a**2
    places = tuple((x / a, y / a, *orders) for x, y, *orders in points)
    found = unit_modes(panel.unit, places, to_digits(highest / rate))
    slopes = a ** -np.array([sum(point[2:]) for point in others], float)[:, None]
    return Modes(rate * found.frequency, found.share / mass, factor=found.factor / mass * slopes)


@lru_cache(maxsize=32)
@one_thread
def unit_modes(panel: Panel, points: Points, highest: float) -> Modes:
    """The same of any plate by itself, struck at the first of the points."""
    position = points[0][:2]
    if panel.exact:
        return seen_modes(panel, _strips(panel, points, highest), highest)
    waves = [panels.waves(panel.core, along, highest) for along in (0, 1)]
    for along, number in enumerate(waves):
        if number > (most := MOST_WAVES * (2 if symmetric(panel, along) else 1)):
            raise TooManyModes(
                f"the vibrations of this plate need {number:.0f} half-waves along one side, but at most {most} are "
                f"allowed: take simply supported edges, or {SIMPLER}"
            )
    groups = math.prod(2 if symmetric(panel, along) else 1 for along in (0, 1))
    least = FEWEST * math.prod(max(number - 2, 0.0) for number in waves) / groups
    if least > MOST_FUNCTIONS:
        raise TooManyModes(_too_many(least))
    lines, blocks, largest = list[Line](), list[Block](), 0
    for sharpness, most in SHARPNESS:
        if least > most:  # certainly too many
            continue
        lines = [_line(panel, along, sharpness * highest) for along in (0, 1)]
        blocks = split(panel, lines, shapes_at(panel, lines, position), highest, sharpness)
        largest = max(p.size for p, _ in blocks)
        if largest <= most:
            break
    if largest > MOST_FUNCTIONS:
        raise TooManyModes(_too_many(largest))
    seen = np.array([shapes_at(panel, lines, point) for point in points])
    found = [_vibrations(panel, lines, block, seen[:, *block]) for block in blocks]
    return seen_modes(panel, found, highest)


def seen_modes(panel: Panel, found: list[tuple[Array, Array]], highest: float) -> Modes:
    """The modes of all groups: frequencies, rad/s, and shapes at the struck point and the sensors, one per row."""
    frequency, seen = (np.concatenate(columns, axis=-1) for columns in zip(*found, strict=True))
    return sorted_modes(
        frequency, seen[0] ** 2 / panel.mass_per_area, highest, seen[0] * seen[1:] / panel.mass_per_area
    )


def _strips(panel: Panel, points: Points, highest: float) -> list[tuple[Array, Array]]:
    """Frequencies, rad/s, and shapes of a plate with two opposite edges simply supported, each half-wave alone."""
    if panel.ends[0] != SIMPLE:
        panel, points = turned(panel), tuple((*point[1::-1], *point[:1:-1]) for point in points)
    (d11, d12, d22, _), (a, b) = panel.stiffness, panel.size
    # half-waves have at least the energy of the stiffness D11 − D12²/D22: edges that are free let the plate curl
    waves = panels.waves(panel.core, 0, highest) * (1.0 - d12**2 / (d11 * d22)) ** -0.25
    check_count(waves)
    wave = np.arange(1.0, max(LEAST, int(waves)) + 1.0) * math.pi / a
    wave = wave[np.abs(np.sin(wave * points[0][0])) > NODE]
    places, orders = np.split(np.array([(*point, 0.0, 0.0)[:4] for point in points]).T, 2)
    degree = np.array([panels.degree(panel.core, k, highest, SPARE) for k in wave])
    groups, sines = 2 if symmetric(panel, 1) else 1, panels.Functions(int(waves) + LEAST)
    if float(np.sum((degree / groups) ** 3 + WORK_OF_A_STRIP)) > MOST_STRIPS:
        raise TooManyModes(
            f"the vibrations of this plate need {wave.size} half-waves along one side, each with up to "
            f"{degree.max()} polynomials across, which takes too long: {SIMPLER}"
        )
    found: list[tuple[Array, Array]] = []
    for size in np.unique(degree):
        across = polynomials(panel.ends[1], int(size))
        seen = np.array([_at(across, y, b, order) for y, order in zip(places[1], orders[1], strict=True)])
        seen = seen * 2.0 / math.sqrt(a * b)
        for odd in (False, True)[:groups]:
            q = np.flatnonzero(across.odd == odd) if groups == 2 else np.arange(seen.shape[1])
            k = wave[degree == size, None]
            there = (k ** orders[0] * np.sin(k * places[0] + orders[0] * (math.pi / 2)))[..., None] * seen[:, q]
            moves = np.abs(there[:, 0]).max(axis=1) > NODE
            if moves.any():
                along = np.rint(k[moves, 0] * a / math.pi).astype(np.intp) - 1
                found.append(_half_waves_alone(panel, (sines, across.core), along, q, there[moves]))
    return found


def turned(panel: Panel) -> Panel:
    """The same plate with its sides exchanged."""
    (d11, d12, d22, d66), (a, b), edges, springs = panel.stiffness, panel.size, panel.edges, panel.springs
    turned = (d22, d12, d11, d66), (b, a), (*edges[2:], *edges[:2]), (*springs[2:], *springs[:2])
    return Panel(panel.mass_per_area, *turned, panel.foundation)


def _half_waves_alone(panel: Panel, lines: tuple[Any, Any], along: Index, q: Index, seen: Array) -> tuple[Array, Array]:
    """Frequencies and shapes of half-waves along a strip, each with the functions q across. seen: the functions at
    points, (waves, points, functions)."""
    least, large = least_stiffness(panel), q.size > SMALL
    many = along.size if large else along.size * q.size**2 // AT_ONCE + 1
    found = list[tuple[Array, Array]]()
    for part, at in zip(np.array_split(along, many), np.array_split(seen, many), strict=True):
        energy = np.stack([panels.energy(panel.core, *lines, np.full(q.size, p), q) for p in part])
        found.append(spectrum(energy[0], at[0], least) if large else _spectra(energy, at, least))
    square, moved = (np.concatenate(columns, axis=-1) for columns in zip(*found, strict=True))
    return np.sqrt(np.maximum(square, 0.0) / panel.mass_per_area), moved


def least_stiffness(panel: Panel) -> float:
    """A stiffness per area below that of the first vibration, N/m³."""
    return min(d / side**4 for d, side in zip(panel.stiffness[::2], panel.size, strict=True))


def _line(panel: Panel, along: int, highest: float) -> Line:
    """Functions along one side that resolve all waves up to a frequency."""
    return line(panel.ends[along], max(LEAST, int(panels.waves(panel.core, along, highest)) + 2))


def _too_many(count: float) -> str:
    return (
        f"the vibrations of this plate need {count:.0f} functions that interact, but at most {MOST_FUNCTIONS} are "
        f"allowed: take simply supported edges, or {SIMPLER}"
    )


def energy_of(panel: Panel, lines: list[Line], p: Index, q: Index) -> Array:
    """Matrix of the energy of products f_p(x) g_q(y) that are orthonormal in ∫∫w²."""
    return panels.energy(panel.core, lines[0].core, lines[1].core, p, q)


def shapes_at(panel: Panel, lines: list[Line], point: tuple[float, ...]) -> Array:
    """All products, orthonormal in ∫∫w², or their derivatives, at a point: by p and q."""
    a, b = panel.size
    places = zip(lines, point[:2], panel.size, point[2:] or (0.0, 0.0), strict=True)
    x, y = (_at(own, at, side, order) for own, at, side, order in places)
    return x[:, None] * y * (2.0 / math.sqrt(a * b))


def _at(line: Line, at: float, side: float, order: float) -> Array:
    """The functions along a side, or their derivatives, 1/m^order, at a distance from its end."""
    return line.at(2.0 * at / side - 1.0, int(order)) * (2.0 / side) ** order


def split(
    panel: Panel, lines: list[Line], struck: Array, highest: float = math.inf, sharpness: float = 1.0
) -> list[Block]:
    """The products that vibrations up to a frequency need, in groups that do not interact; those that are 0 at the
    struck point are left out. struck: `shapes_at` there. The first of each side are taken however low the frequency:
    the first vibrations are then accurate."""
    blocks = panels.groups(panel.core, lines[0].core, lines[1].core, highest, sharpness, LEAST)
    return [block for block in blocks if np.abs(struck[block]).max() > NODE] or blocks[:1]


def symmetric(panel: Panel, along: int) -> bool:
    """Whether even and odd functions along one side do not interact."""
    (one, other), springs = panel.ends[along], panel.springs[2 * along : 2 * along + 2]
    return one == other and springs[0] == springs[1]


def _vibrations(panel: Panel, lines: list[Line], block: Block, seen: Array) -> tuple[Array, Array]:
    """Frequencies, rad/s, and shapes at points of a group of products. seen: these there, (points, products)."""
    square, moved = spectrum(energy_of(panel, lines, *block), seen, least_stiffness(panel))
    square[: loose_motions(panel, lines, block).shape[1]] = 0.0
    return np.sqrt(np.maximum(square, 0.0) / panel.mass_per_area), moved


def spectrum(energy: Array, seen: Array, least: float) -> tuple[Array, Array]:
    """Eigenvalues, ascending, and the components of each row of `seen` along the eigenvectors.

    Those of the inverse of energy + shift, from Cholesky's factor of the matrix with a diagonal of ones: `eigh` leaves
    errors of ε times the largest eigenvalue in all of them, of a long strip with free edges 3e-5 of the lowest
    frequency, and a percent of what the vibrations leave of the static compliance. Here the lowest have errors of
    1e-12. The shift, `least` or more, is small beside eigenvalues that are not 0, and leaves the high ones 8 digits.

    A reflection turns the first row into the first axis, and the reduction to a tridiagonal matrix leaves that axis
    alone: the first entries of the tridiagonal matrix's eigenvectors are the components (Golub & Welsch 1969). The
    other rows are turned likewise. The core turns rows, not eigenvectors, which would take most of the time.
    """
    import scipy.linalg  # takes as long as thousands of impacts, and most plates need no spectrum

    blas, lapack = cast("tuple[Any, ...]", (scipy.linalg.blas, scipy.linalg.lapack))
    (struck, *others), count = seen, seen.shape[1]
    size = float(np.linalg.norm(struck))
    shift = max(least, SHIFT * float(np.median(np.diag(energy))))
    energy[np.diag_indices(count)] += shift
    scale = 1.0 / np.sqrt(np.diag(energy))
    energy *= np.outer(scale, scale)
    factor, failed = lapack.dpotrf(energy.T, lower=1, clean=0, overwrite_a=1)
    if failed:
        raise SimulationError(TOO_SOFT)
    inverse = lapack.dpotri(factor, lower=1, overwrite_c=1)[0]
    inverse *= np.outer(scale, scale)
    mirror = struck.copy()
    mirror[0] += math.copysign(size, struck[0])
    mirror *= math.sqrt(2.0) / np.linalg.norm(mirror)
    turned = blas.dsymv(1.0, inverse, mirror, lower=1)
    turned -= 0.5 * float(mirror @ turned) * mirror
    inverse = blas.dsyr2(-1.0, mirror, turned, lower=1, a=inverse, overwrite_a=1)
    work = int(lapack.dsytrd_lwork(count, lower=1)[0])
    reduced, diagonal, beside, turns, _ = lapack.dsytrd(inverse, lower=1, lwork=work, overwrite_a=1)
    rows = np.zeros_like(seen)
    rows[0, 0] = -math.copysign(size, struck[0])
    if others:
        turned = np.array([row - (mirror @ row) * mirror for row in others]).T
        if count > 1:
            turned[1:] = lapack.dormqr("L", "T", reduced[1:, :-1], turns, turned[1:], 64 * count)[0]
        rows[1:] = turned.T
    values, found = panels.tridiagonal(diagonal, beside, rows)
    found = without_rounding(found, values, np.linalg.norm(seen, axis=1, keepdims=True))
    known = values[::-1] > ROUNDED * values[-1]
    return 1.0 / values[::-1][known] - shift, found[:, ::-1][:, known]


def _spectra(energy: Array, seen: Array, least: float) -> tuple[Array, Array]:
    """The same of small matrices, (matrices, n, n), and points, (matrices, points, n), with all eigenvectors."""
    at = np.arange(energy.shape[-1])
    shift = np.maximum(least, SHIFT * np.median(energy[:, at, at], axis=1))[:, None]
    energy[:, at, at] += shift
    scale = 1.0 / np.sqrt(energy[:, at, at])
    try:
        factor = np.linalg.inv(np.linalg.cholesky(energy * scale[:, None] * scale[..., None])) * scale[:, None]
    except np.linalg.LinAlgError:
        raise SimulationError(TOO_SOFT) from None
    values, vectors = np.linalg.eigh(np.swapaxes(factor, 1, 2) @ factor)
    known = values > ROUNDED * values[:, -1:]
    moved = np.swapaxes(projected(seen, values[:, None], vectors), 0, 1)
    return 1.0 / values[known] - np.broadcast_to(shift, values.shape)[known], moved[:, known]


def loose_motions(panel: Panel, lines: list[Line], block: Block) -> Array:
    """Orthonormal combinations of the products of a group that move without energy, one per column."""
    p, q = block
    rigid = () if panel.foundation else np.flatnonzero((lines[0].bent[p] == 0.0) & (lines[1].bent[q] == 0.0))
    if len(rigid) == 0:
        return np.zeros((p.size, 0))
    energy = energy_of(panel, lines, p[rigid], q[rigid])
    values, shapes = np.linalg.eigh(energy)
    a, b = panel.size
    least = LOOSE * (max(panel.stiffness) / (a * b) ** 2 + max(panel.springs) / min(a, b))
    found = np.zeros((p.size, int(np.count_nonzero(values < least))))
    found[rigid] = shapes[:, : found.shape[1]]
    return found


def loose(panel: Panel) -> bool:
    """Whether the plate can move without bending: nothing holds it, or it turns about one edge."""
    lines = [line(ends, LEAST) for ends in panel.ends]
    every = [indices.ravel() for indices in np.indices([each.bent.size for each in lines])]
    return loose_motions(panel, lines, (every[0], every[1])).shape[1] > 0
