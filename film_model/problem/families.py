"""Families of curves: laws whose stages depend on one more number, their shape, such as S_y/E.

A page of a family covers a range of shapes. On it every coefficient of the law's series, of the force and of what else
depends on the shape in the last stage, and the end of that stage, is a Chebyshev series in ln(shape), from which the
core writes the curve of a shape (`film_shape`). A page is made once.
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
from film_model.laws.law import AbstractLaw, Array, Function, Power, Stage
from film_model.problem.fit import FIT_ROUNDING, Span, assemble, checked, fit, functions_of, halved, values_of
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

ONLY = "only the end and the functions of the last stage may depend on its shape"
"""What a law with a shape must keep to."""

CHECKED = (-0.97, -0.31, 0.44, 0.89)
"""2 ln(shape/low)/ln(high/low) − 1, where a page is compared with the law."""


@dataclass(frozen=True)
class Page:
    """The curves of a law for shapes from low to high.

    whole: a curve with all pieces that any of the shapes needs. fit_error: largest relative difference between the
    functions and the law. steepest: the largest exponent of an unloading branch. marks: of a mixture, see
    :mod:`film_model.problem.mixtures`.
    """

    whole: native.Curve = field(repr=False, compare=False)
    family: Family = field(repr=False, compare=False)
    fit_error: float
    steepest: float
    marks: Mapping[str, Array] | None = field(default=None, repr=False, compare=False)

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
    middle = given[NODES // 2]
    if any(shared_part(stages) != shared_part(middle) for stages in given):
        raise ValueError(f"law {law.name!r}: {ONLY}")
    names = varying((given[0][-1], given[-1][-1]))
    edges = edges_of(middle[-1], max(stages[-1].end for stages in given))
    xi = nodes_of(edges)
    table = np.array([values_at(stages[-1], dict.fromkeys(names, xi.ravel())) for stages in given])
    values = table.reshape(NODES, len(names), *xi.shape).swapaxes(0, 1)
    series = {name: applied(series_matrix(TERMS), own) for name, own in zip(names, values, strict=True)}
    mean = applied(mean_matrix(), series["force"])
    work = np.diff(edges) * mean.sum(axis=-1)
    work_before = np.cumsum(work, axis=-1) - work
    whole, error, steepest = whole_of(law, middle, edges, {name: trimmed(own) for name, own in series.items()})
    places, columns = places_of(whole, -work_before, {**series, "mean": mean})
    ends = coefficients(np.log([stages[-1].end for stages in given]))
    table = applied(series_matrix(NODES), np.array(columns)).T
    page = Page(whole, Family.of(low, high, ends, places, table), error, steepest)
    tried = (low * (high / low) ** (0.5 * (1.0 + x)) for x in CHECKED)
    off = (difference(page.at(shape), law.of_shape(shape).stages()[-1]) for shape in tried)
    return replace(page, fit_error=max(error, *off))


def shared_part(stages: tuple[Stage, ...]) -> tuple[Any, ...]:
    """What must be the same for all laws of a family: all but the end and the functions of the last stage."""
    *first, last = stages
    unloading = None if last.unloading is None else (last.unloading.rule[0], last.unloading.reload_exponent)
    return (*first, replace(last, end=math.inf, force=Power(), unloading=None), unloading)


def varying(stages: tuple[Stage, Stage]) -> tuple[str, ...]:
    """The functions that differ between two laws of a family, by their names: the force, and what else does."""
    one, other = map(functions_of, stages)
    others = ("recovery", "exponent")
    names = ("force", *(name for name in others if one.get(name) != other.get(name)))
    if any(isinstance(function[name], Power) for function in (one, other) for name in names):
        raise ValueError(f"stage {stages[0].name!r}: what depends on the shape must be a function of arrays")
    return names


def values_at(stage: Stage, points: Mapping[str, Array]) -> Array:
    """The named functions of a stage, each at its points, one behind the other."""
    functions: Any = functions_of(stage)
    found = [functions[name](xi) for name, xi in points.items()]
    laws = max((values.shape[:-1] for values in found), key=len)
    return np.concatenate([np.broadcast_to(values, (*laws, values.shape[-1])) for values in found], axis=-1)


def trimmed(series: Array) -> list[Array]:
    """The series of one law on each piece, with the terms that no law can do without."""
    middle = len(series) // 2
    return [series[middle, k, : needed(series[:, k])] for k in range(series.shape[1])]


def whole_of(
    law: AbstractLaw, stages: tuple[Stage, ...], edges: Array, series: Mapping[str, Sequence[Array]]
) -> tuple[native.Curve, float, float]:
    """As `assemble`: the curve whose last stage consists of the pieces between `edges`. series: of the functions that
    depend on the shape, by name, one for each piece."""
    name, last = f"law {law.name!r}", replace(stages[-1], end=float(edges[-1]))

    def pieces(stage: Stage, functions: Mapping[str, Function], room: int) -> tuple[list[Span], float]:
        if stage.begin != last.begin:
            return halved(stage, functions, room)
        others = {name: f for name, f in functions.items() if callable(f) and name not in series}
        fits = [fit(others, a, b, False) for a, b in pairwise(edges.tolist())]
        own = [dict(zip(series, each, strict=True)) for each in zip(*series.values(), strict=True)]
        spans = zip(pairwise(edges.tolist()), fits, own, strict=True)
        found = [(*ends, False, {**fitted, **given}) for ends, (fitted, _), given in spans]
        return found, max(off for _, off in fits)

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


def places_of(whole: native.Curve, works: Array, series: Mapping[str, Array]) -> tuple[list[int], list[Array]]:
    """Places of the doubles that vary among those of the curve, and the values of each over the shapes."""
    size, places, columns = 8, list[int](), list[Array]()
    first = whole.stage[whole.stages - 1].first
    inside = native.Function.series.offset
    for k in range(works.shape[1]):
        begin = native.Curve.piece.offset + (first + k) * ctypes.sizeof(native.Piece)
        places.append((begin + native.Piece.work_at_begin.offset) // size)
        columns.append(works[:, k])
        for name in sorted(series, key=lambda name: getattr(native.Piece, name).offset):
            count = getattr(whole.piece[first + k], name).terms
            at = (begin + getattr(native.Piece, name).offset + inside) // size
            places += range(at, at + count)
            columns += list(series[name][:, k, :count].T)
    return places, columns


def difference(curve: native.Curve, stage: Stage) -> float:
    """Largest relative difference, on a piece, of a function of the curve's last stage and the law's."""
    entry = curve.stage[curve.stages - 1]
    pieces = curve.piece[entry.first : entry.first + entry.count]
    fitted = {name: function for name, function in functions_of(stage).items() if not isinstance(function, Power)}
    return max(_difference(pieces, name, function, stage) for name, function in fitted.items())


def _difference(pieces: Sequence[native.Piece], name: str, function: Function, stage: Stage) -> float:
    parts = [getattr(piece, name) for piece in pieces]
    span = np.array([1.0 / part.per_span for part in parts])
    origin = np.array([part.origin for part in parts])
    x = (
        np.minimum(1.0, (np.array([piece.end for piece in pieces]) - origin) / span)
        * np.linspace(0.0, 1.0, 29)[:, None]
    )
    exact = values_of(function, (origin + x * span).ravel(), stage).reshape(x.shape)
    series = np.zeros((native.MAX_TERMS, len(parts)))
    for k, part in enumerate(parts):
        series[: part.terms, k] = part.series[: part.terms]
    found = np.polynomial.chebyshev.chebval(2.0 * x - 1.0, series, tensor=False)
    return float((abs(found - exact).max(axis=0) / abs(exact).max(axis=0)).max())
