"""Orthonormal functions on a line for Ritz's method: the shapes of a beam with given ends, made of Legendre
polynomials.

The polynomials are those that satisfy the supports: combinations of 1, s, s², s³, and ∫∫P_k with k ≥ 2, which vanish
with their slopes at both ends. Their curvatures are orthogonal, so the equations are well-conditioned at any degree.

A beam's shapes have neither curvature nor shear force at a free end, but the edge of a plate has a curvature there, and
sums of such shapes converge with the first power of their number. So the polynomials of lowest degree join them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from film_model.base.threads import one_thread
from film_model.core import panels
from film_model.targets.modes import Array

SIMPLE = "simply supported", "simply supported"

BEYOND = 12
"""Degrees of the polynomials beyond twice the number of shapes that are made of them."""


@dataclass(frozen=True)
class Line:
    """Functions f_p(s), −1 ≤ s ≤ 1, orthonormal in ∫f² ds and orthogonal in ∫f″² ds.

    polynomials: Legendre coefficients, one row per function. bent: ∫f_p″² ds, exactly 0 for rigid motions. sloped:
    ∫f_p′ f_q′ ds. crossed: ∫f_p″ f_q ds. odd: whether f_p is odd; False if the ends differ.
    """

    shapes: int
    polynomials: Array
    bent: Array
    sloped: Array
    crossed: Array
    odd: NDArray[np.bool_]

    @cached_property
    def core(self) -> panels.Functions:
        """The same in the core."""
        arrays = self.polynomials, self.bent, self.sloped, self.crossed, self.odd
        return panels.functions(self.shapes, arrays, 1 + bool(self.odd.any()))

    def at(self, s: float, order: int = 0) -> Array:
        """f_p(s), or a derivative."""
        series = _derivative(self.polynomials, order)
        return series @ _legendre(s, series.shape[1])


@lru_cache(maxsize=64)
def _legendre(s: float, count: int) -> Array:
    """P_0(s), P_1(s), …, `count` of them: for one place in less time than NumPy's `legvander`."""
    values = [1.0, s]
    for n in range(2, count):
        values.append((values[-1] * s * (2 * n - 1) - values[-2] * (n - 1)) / n)
    return np.array(values[:count])


def _derivative(series: Array, order: int) -> Array:
    """Legendre coefficients of a derivative of the series, one per row: P_n′ = Σ (2k + 1) P_k, k = n − 1, n − 3, …"""
    for _ in range(order):
        sums = np.empty_like(series)
        for highest in (-1, -2):
            sums[:, highest::-2] = np.cumsum(series[:, highest::-2], axis=1)
        series = (2.0 * np.arange(series.shape[1] - 1.0) + 1.0) * sums[:, 1:]
    return series


@lru_cache(maxsize=32)
def line(ends: tuple[str, str], count: int) -> Line:
    """`count` shapes, and four more functions unless both ends are simply supported.

    ends: "clamped", "simply supported" or "free".
    """
    # Polynomials that join the shapes of a beam: four cubics and quintics give any curvature and shear at both ends
    joined = 4
    parts = _parts(ends, 2 * count + BEYOND)  # a shape of n half-waves takes polynomials up to degree 2 n
    known = [_shapes(part) for part in parts]
    highest = np.sort(np.concatenate([bent for bent, _ in known]))[count - 1]
    more = 0 if ends == SIMPLE else joined // len(parts)
    rows = [_joined(part, *shapes, highest, more) for part, shapes in zip(parts, known, strict=True)]
    return _line(rows, more * len(parts))


@lru_cache(maxsize=32)
def polynomials(ends: tuple[str, str], degree: int) -> Line:
    """All polynomials up to a degree that satisfy the supports."""
    return _line([_shapes(part)[1] for part in _parts(ends, degree)], 0)


def _line(rows: list[Array], more: int) -> Line:
    """The line with functions of given coefficients: even and odd ones, or all. more: how many are not shapes."""
    rigid = 1e-9  # ∫f″² of a function of unit ∫f² below which it is the rounding of a motion as a rigid body
    made = np.concatenate(rows)
    odd = np.repeat([False, True][: len(rows)], [len(part) for part in rows])
    unit = 2.0 / (2.0 * np.arange(made.shape[1]) + 1.0)
    slope, curve = (_derivative(made, n) for n in (1, 2))
    bent = np.sum(curve**2 * unit[:-2], axis=1)
    bent[bent < rigid] = 0.0
    sloped, crossed = (slope * unit[:-1]) @ slope.T, (curve * unit[:-2]) @ made[:, :-2].T
    order = np.argsort(bent, kind="stable")
    both = np.ix_(order, order)
    whole, bends, slopes, crosses = map(np.ascontiguousarray, (made[order], bent[order], sloped[both], crossed[both]))
    return Line(len(made) - more, whole, bends, slopes, crosses, np.ascontiguousarray(odd[order]))


def _parts(ends: tuple[str, str], degree: int) -> list[Array]:
    """The polynomials that satisfy the supports; if the ends are equal, the even and the odd ones."""
    space = _polynomials(ends, degree)
    odd = np.abs(space[:, 1::2]).sum(axis=1) > 0.0
    return [space[~odd], space[odd]] if ends[0] == ends[1] else [space]


def _polynomials(ends: tuple[str, str], degree: int) -> Array:
    """Legendre coefficients of even and odd polynomials, if the ends are equal, that satisfy the supports."""
    conditions: list[Array] = []
    for s, end in ((-1.0, ends[0]), (1.0, ends[1])):
        n = np.arange(4.0)
        if end != "free":
            conditions.append(s**n)
        if end == "clamped":
            conditions.append(s ** (n + 1) * n * (n + 1) / 2)
    if ends[0] == ends[1] and conditions:  # with the same conditions at both ends, each serves both parities
        rows = np.array(conditions[: len(conditions) // 2])
        low = np.concatenate([_unconditional(rows[:, k::2], k, degree) for k in (0, 1)])
    else:
        low = _unconditional(np.array(conditions).reshape(-1, 4), None, degree)
    k = np.arange(2, degree - 1)
    parts = 1.0 / ((2 * k - 1) * (2 * k + 1)), -2.0 / ((2 * k - 1) * (2 * k + 3)), 1.0 / ((2 * k + 1) * (2 * k + 3))
    bubbles = np.zeros((k.size, degree + 1))
    for shift, part in zip((-2, 0, 2), parts, strict=True):  # ∫∫P_k
        bubbles[k - 2, k + shift] = np.sqrt((2 * k + 1) / 2) * part
    return np.concatenate([low, bubbles])


def _unconditional(conditions: Array, parity: int | None, degree: int) -> Array:
    """Combinations of P_0 … P_3, or of the even or odd ones, on which the conditions are 0."""
    _, sizes, rows = np.linalg.svd(conditions)
    rows = rows[np.count_nonzero(sizes > 1e-12) :]
    rows = np.linalg.svd(rows[:, rows.shape[1] // 2 :])[0].T[::-1] @ rows  # rigid motions first, and alone
    rows[np.abs(rows) < 1e-15] = 0.0
    found = np.zeros((len(rows), degree + 1))
    found[:, slice(0, 4) if parity is None else slice(parity, 4, 2)] = rows
    return found


@one_thread
def _shapes(space: Array) -> tuple[Array, Array]:
    """∫f″² and coefficients of the functions of a space that are orthonormal in ∫f² and orthogonal in ∫f″².

    Motions as a rigid body come first; the others, less what they have of these, are made orthonormal in ∫f″². Singular
    values of their √mass are accurate relative to each, because the polynomials' are graded; eigenvalues of the mass
    itself are accurate relative to the largest, which spoils the shapes beside free ends, 1e-9 of the 48th and 1e-6 of
    the 300th. The highest, far above all waves that are resolved, are what a free edge's curvature is made of: without
    those above 1e14 frequencies of plates with a free edge have errors of 1e-4 from degree 112 on.
    """
    root = np.sqrt(2.0 / (2.0 * np.arange(space.shape[1]) + 1.0))
    curve = _derivative(space, 2)[:, :2] * root[:2]
    bends = np.abs(space[:, 4:]).max(axis=1) > 0.0
    low = np.flatnonzero(~bends)
    stiff = np.abs(curve[low]).max(axis=1) > 0.0
    rigid, low = space[low[~stiff]], low[stiff]
    rigid = np.linalg.qr((rigid * root).T)[0].T / root
    space = np.concatenate([np.linalg.solve(np.linalg.cholesky(curve[low] @ curve[low].T), space[low]), space[bends]])
    space -= ((space * root) @ (rigid * root).T) @ rigid
    turned, size, _ = np.linalg.svd(space * root, full_matrices=False)
    found = (turned.T @ space) / size[:, None]
    return np.concatenate([np.zeros(len(rigid)), size**-2.0]), np.concatenate([rigid, found])


def _joined(space: Array, bent: Array, rows: Array, highest: float, more: int) -> Array:
    """The shapes with ∫f″² up to `highest`, and `more` functions for the lowest polynomials of the space.

    bent, rows: of `_shapes`.
    """
    among = bent <= highest * (1 + 1e-9)
    taken, rest = rows[among], rows[~among]
    if more == 0:
        return taken
    unit = 2.0 / (2.0 * np.arange(space.shape[1] - 2) + 1.0)
    curve, rest_curve = (_derivative(part, 2) for part in (space, rest))
    curve = curve[np.abs(curve).sum(axis=1) > 0.0][:more]
    parts = (curve * unit) @ rest_curve.T / bent[~among]  # ∫f p = ∫f″p″/∫f″²: what the shapes lack of these polynomials
    parts /= np.linalg.norm(parts, axis=1)[:, None]
    chosen = np.linalg.qr(parts.T)[0].T
    turned = np.linalg.eigh((chosen * bent[~among]) @ chosen.T)[1]
    return np.concatenate([taken, turned.T @ chosen @ rest])
