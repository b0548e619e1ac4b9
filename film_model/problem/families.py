"""Families of curves: laws whose stages depend on one more number, their shape, such as S_y/E.

A page of a family covers a range of shapes. On it every coefficient of the law's series, and the end of its last stage,
is a Chebyshev series in ln(shape), from which the core writes the curve of a shape (`film_shape`). A page is made once.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from film_model.core import native
from film_model.core.families import Family, shaped
from film_model.laws.law import AbstractLaw, Array, Function, Stage
from film_model.problem.fit import FIT_ROUNDING, Span, assemble, checked, fit, halved, values_of
from film_model.problem.series import coefficients, mean_series

EDGES = np.array([1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 2.5e-2, 5e-2, 0.1])
"""Shapes between which the pages lie; a law with a shape outside has a curve of its own."""

LAST_PAGE = EDGES.size - 1

NODES = 20
"""Chebyshev terms in ln(shape) over a factor of ten: the relative error of the force is about 1e-13."""

TERMS = 18
"""Chebyshev terms in ξ on a piece, whose ends differ by a factor of two."""

ANY_SHAPE = 1e-3
"""Shape of the law that stands for all laws of a family, so that a page is found again whatever law asks for it."""

CHECKED = (-0.97, -0.31, 0.44, 0.89)
"""2 ln(shape/low)/ln(high/low) − 1, where a page is compared with the law."""


@dataclass(frozen=True)
class Page:
    """The curves of a law for shapes from low to high.

    whole: a curve with all pieces that any of the shapes needs. fit_error: largest relative difference between the
    force and the law. steepest: the largest exponent of an unloading branch. marks: of a mixture, see
    :mod:`film_model.problem.mixtures`.
    """

    whole: native.Curve = field(repr=False, compare=False)
    family: Family = field(repr=False, compare=False)
    fit_error: float
    steepest: float
    marks: Array | None = field(default=None, repr=False, compare=False)

    def at(self, shape: float | Array) -> native.Curve:
        """The curve of a shape; of a mixture, of the numbers of one law."""
        return shaped(self.family, self.whole, shape)


def page_number(shape: Any) -> Any:
    """Number of the page of a shape, or of each of many; negative, or too large, outside of all pages."""
    return np.searchsorted(EDGES, shape, side="right") - 1


def page_of(law: AbstractLaw) -> Page | None:
    """The page of a law; None if the law has no shape, or none within the pages."""
    shape = law.shape
    if shape is None or not EDGES[0] <= shape < EDGES[-1]:
        return None
    number = int(page_number(shape))
    return page_between(law.of_shape(ANY_SHAPE), float(EDGES[number]), float(EDGES[number + 1]))


@lru_cache(maxsize=64)
def page_between(law: AbstractLaw, low: float, high: float) -> Page:
    """The page of the laws `law.of_shape(s)` for shapes s from low to high."""
    z = np.polynomial.chebyshev.chebpts1(NODES)
    given = [law.of_shape(low * (high / low) ** (0.5 * (1.0 + x))).stages() for x in z.tolist()]
    first, last = given[NODES // 2][:-1], given[NODES // 2][-1]
    for stages in given:
        if stages[:-1] != first or replace(stages[-1], end=last.end, force=last.force) != last:
            raise ValueError(f"law {law.name!r}: only the force and the end of the last stage may depend on its shape")
    edges = edges_of(last, max(stages[-1].end for stages in given))
    xi = nodes_of(edges)
    values = np.array([values_of(stages[-1].force, xi.ravel(), stages[-1]) for stages in given])
    force = applied(series_matrix(TERMS), values.reshape(NODES, *xi.shape))
    mean = applied(mean_matrix(), force)
    work = np.diff(edges) * mean.sum(axis=-1)
    work_before = np.cumsum(work, axis=-1) - work
    kept = [force[NODES // 2, k, : needed(force[:, k])] for k in range(edges.size - 1)]
    whole, error, steepest = whole_of(law, (*first, last), edges, kept)
    places, columns = places_of(whole, -work_before, force, mean)
    ends = coefficients(np.log([stages[-1].end for stages in given]))
    table = applied(series_matrix(NODES), np.array(columns)).T
    page = Page(whole, Family.of(low, high, ends, places, table), error, steepest)
    tried = (low * (high / low) ** (0.5 * (1.0 + x)) for x in CHECKED)
    off = (difference(page.at(shape), law.of_shape(shape).stages()[-1]) for shape in tried)
    return replace(page, fit_error=max(error, *off))


def whole_of(
    law: AbstractLaw, stages: tuple[Stage, ...], edges: Array, force: Sequence[Array]
) -> tuple[native.Curve, float, float]:
    """As `assemble`: the curve whose last stage consists of the pieces between `edges`. force: the series of each."""
    name, last = f"law {law.name!r}", replace(stages[-1], end=float(edges[-1]))

    def pieces(stage: Stage, functions: Mapping[str, Function], room: int) -> tuple[list[Span], float]:
        if stage.begin != last.begin:
            return halved(stage, functions, room)
        others = {name: f for name, f in functions.items() if callable(f) and name != "force"}
        fits = [fit(others, a, b, False) for a, b in pairwise(edges.tolist())]
        found = zip(pairwise(edges.tolist()), fits, force, strict=True)
        return [(*ends, False, {**series, "force": own}) for ends, (series, _), own in found], max(
            off for _, off in fits
        )

    return assemble(name, checked(name, (*stages[:-1], last)), pieces)


def edges_of(last: Stage, end: float) -> Array:
    """Ends of the pieces: each twice the one before, and the knots."""
    doublings = math.ceil(math.log2(end / last.begin) - 1e-9)
    ends = [last.begin * 2.0**k for k in range(doublings + 1)]
    return np.unique([*ends, *(knot for knot in last.knots if knot < ends[-1])])


def nodes_of(edges: Array) -> Array:
    """Where the force is evaluated: the nodes of `TERMS` on each piece."""
    return edges[:-1, None] + np.diff(edges)[:, None] * 0.5 * (1.0 + np.polynomial.chebyshev.chebpts1(TERMS))


def applied(matrix: Array, values: Array) -> Array:
    """A matrix applied to the last axis, summed without BLAS: its rounding is the same on every processor."""
    return (values[..., None, :] * matrix).sum(axis=-1)


@lru_cache(maxsize=3)
def series_matrix(count: int) -> Array:
    """The Chebyshev series through `count` values, as a matrix on the values."""
    return np.array([coefficients(unit) for unit in np.eye(count)]).T


@lru_cache(maxsize=1)
def mean_matrix() -> Array:
    """The series of the running mean, as a matrix on the series."""
    return np.array([mean_series(unit, False) for unit in np.eye(TERMS)]).T


def needed(series: Array) -> int:
    """Terms that no shape can do without."""
    largest = np.abs(series).max(axis=0)
    return int(np.flatnonzero(largest > FIT_ROUNDING * largest.max()).max()) + 1


def places_of(whole: native.Curve, works: Array, force: Array, mean: Array) -> tuple[list[int], list[Array]]:
    """Places of the doubles that vary among those of the curve, and the values of each over the shapes."""
    size, places, columns = 8, list[int](), list[Array]()
    first = whole.stage[whole.stages - 1].first
    series = native.Function.series.offset
    for k in range(works.shape[1]):
        begin = native.Curve.piece.offset + (first + k) * ctypes.sizeof(native.Piece)
        places.append((begin + native.Piece.work_at_begin.offset) // size)
        columns.append(works[:, k])
        for name, values in (("force", force), ("mean", mean)):
            count = getattr(whole.piece[first + k], name).terms
            at = (begin + getattr(native.Piece, name).offset + series) // size
            places += range(at, at + count)
            columns += list(values[:, k, :count].T)
    return places, columns


def difference(curve: native.Curve, stage: Stage) -> float:
    """Largest relative difference, on a piece, of the force of the curve's last stage and the law's."""
    entry = curve.stage[curve.stages - 1]
    pieces = curve.piece[entry.first : entry.first + entry.count]
    force = [piece.force for piece in pieces]
    span = np.array([1.0 / function.per_span for function in force])
    origin = np.array([function.origin for function in force])
    x = (
        np.minimum(1.0, (np.array([piece.end for piece in pieces]) - origin) / span)
        * np.linspace(0.0, 1.0, 29)[:, None]
    )
    exact = values_of(stage.force, (origin + x * span).ravel(), stage).reshape(x.shape)
    series = np.zeros((native.MAX_TERMS, len(force)))
    for k, function in enumerate(force):
        series[: function.terms, k] = function.series[: function.terms]
    found = np.polynomial.chebyshev.chebval(2.0 * x - 1.0, series, tensor=False)
    return float((abs(found - exact).max(axis=0) / abs(exact).max(axis=0)).max())
