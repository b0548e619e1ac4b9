"""Families of curves: laws whose stages depend on one more number, their shape, such as S_y/E.

A page of a family covers a range of shapes. On it every coefficient of the law's series, and the end of its last stage,
is a Chebyshev series in ln(shape), from which the core writes the curve of a shape (`film_shape`). A page is made once.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

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

TOGETHER, POOR = 256, 1e-9
"""Laws that are fitted at a time, so that arrays stay in the processor's cache; relative error of a fit that fails."""

CONTINUOUS = 1e-9
"""Relative difference of the force up to which it does not jump between stages."""

CHECKED = (-0.97, -0.31, 0.44, 0.89)
"""2 ln(shape/low)/ln(high/low) − 1, where a page is compared with the law."""


@dataclass(frozen=True)
class Page:
    """The curves of a law for shapes from low to high.

    whole: a curve with all pieces that any of the shapes needs. fit_error: largest relative difference between the
    force and the law. steepest: the largest exponent of an unloading branch.
    """

    whole: native.Curve = field(repr=False, compare=False)
    family: Family = field(repr=False, compare=False)
    fit_error: float
    steepest: float

    def at(self, shape: float) -> native.Curve:
        """The curve of a shape."""
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
    return page_between(law.of_shape(1e-3), float(EDGES[number]), float(EDGES[number + 1]))


@lru_cache(maxsize=64)
def page_between(law: AbstractLaw, low: float, high: float) -> Page:
    """The page of the laws `law.of_shape(s)` for shapes s from low to high."""
    z = np.polynomial.chebyshev.chebpts1(NODES)
    given = [law.of_shape(low * (high / low) ** (0.5 * (1.0 + x))).stages() for x in z.tolist()]
    first, last = given[NODES // 2][:-1], given[NODES // 2][-1]
    for stages in given:
        if stages[:-1] != first or replace(stages[-1], end=last.end, force=last.force) != last:
            raise ValueError(f"law {law.name!r}: only the force and the end of the last stage may depend on its shape")
    edges = _edges(last, max(stages[-1].end for stages in given))
    xi = _nodes(edges)
    values = np.array([values_of(stages[-1].force, xi.ravel(), stages[-1]) for stages in given])
    force = applied(series_matrix(TERMS), values.reshape(NODES, *xi.shape))
    mean = applied(mean_matrix(), force)
    work = np.diff(edges) * mean.sum(axis=-1)
    work_before = np.cumsum(work, axis=-1) - work
    kept = [force[NODES // 2, k, : _needed(force[:, k])] for k in range(edges.size - 1)]
    whole, error, steepest = _whole(law, (*first, last), edges, kept)
    places, columns = _places(whole, -work_before, force, mean)
    ends = coefficients(np.log([stages[-1].end for stages in given]))
    table = applied(series_matrix(NODES), np.array(columns)).T
    page = Page(whole, Family.of(low, high, ends, places, table), error, steepest)
    tried = (low * (high / low) ** (0.5 * (1.0 + x)) for x in CHECKED)
    return replace(page, fit_error=max(error, *(_difference(page, law, shape) for shape in tried)))


def _whole(
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


def _edges(last: Stage, end: float) -> Array:
    """Ends of the pieces: each twice the one before, and the knots."""
    doublings = math.ceil(math.log2(end / last.begin) - 1e-9)
    ends = [last.begin * 2.0**k for k in range(doublings + 1)]
    return np.unique([*ends, *(knot for knot in last.knots if knot < ends[-1])])


def _nodes(edges: Array) -> Array:
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


def _needed(series: Array) -> int:
    """Terms that no shape can do without."""
    largest = np.abs(series).max(axis=0)
    return int(np.flatnonzero(largest > FIT_ROUNDING * largest.max()).max()) + 1


def _places(whole: native.Curve, works: Array, force: Array, mean: Array) -> tuple[list[int], list[Array]]:
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


def _difference(page: Page, law: AbstractLaw, shape: float) -> float:
    """Largest relative difference of force between the curve of a shape and the law."""
    curve, stage = page.at(shape), law.of_shape(shape).stages()[-1]
    entry, worst = curve.stage[curve.stages - 1], 0.0
    x = np.linspace(0.0, 1.0, 29)
    for k in range(entry.first, entry.first + entry.count):
        function = curve.piece[k].force
        part = x * min(1.0, (curve.piece[k].end - function.origin) * function.per_span)
        exact = values_of(stage.force, function.origin + part / function.per_span, stage)
        found = np.polynomial.chebyshev.chebval(2.0 * part - 1.0, np.array(function.series[: function.terms]))
        worst = max(worst, float(np.abs(found - exact).max() / np.abs(exact).max()))
    return worst


def fitted_curves(law_at: Callable[[Any], AbstractLaw], count: int) -> tuple[native.Curve, NDArray[np.int32], Array]:
    """The curves of `count` laws that differ in the force of their last stage and its end, each fitted by itself.

    law_at: the law at an index, or, at several indices, with arrays of their shape in its fields. Returned are a curve
    with all pieces, the places of its doubles that differ, and their values for each law. Raises ValueError where the
    laws differ in more, or where the fit of the first, middle or last differs from the law by more than `POOR`.
    """
    every, some = law_at((slice(None), None, None)).stages(), {at: law_at(at) for at in (0, count // 2, count - 1)}
    given, law = some[0].stages(), some[0]
    last = given[-1]
    for stages in (every, *(one.stages() for one in some.values())):
        if stages[:-1] != given[:-1] or replace(stages[-1], end=last.end, force=last.force) != last:
            raise ValueError(f"law {law.name!r}: only the force and the end of the last stage may differ")
    ends = np.broadcast_to(np.asarray(every[-1].end), (count, 1, 1)).ravel()
    edges = _edges(last, float(ends.max()))
    values = np.empty((count, edges.size - 1, 2 + 2 * TERMS))  # of each piece: end, work_at_begin, force, mean
    for begin in range(0, count, TOGETHER):
        part = slice(begin, begin + TOGETHER)
        force: Any = law_at((part, None, None)).stages()[-1].force
        series = _summed(force(_nodes(edges)), series_matrix(TERMS))
        mean = _summed(series, mean_matrix())
        work = np.diff(edges) * mean.sum(axis=-1)
        values[part, :, 0], values[part, :, 1] = (
            np.minimum(edges[1:], ends[part, None]),
            work - np.cumsum(work, axis=-1),
        )
        values[part, :, 2 : 2 + TERMS], values[part, :, 2 + TERMS :] = series, mean
    whole = _whole(law, given, edges, list(values[0, :, 2 : 2 + TERMS]))[0]
    for at, one in some.items():
        if (off := _distance(one.stages()[-1], values[at, :, 0], values[at, :, 2 : 2 + TERMS], edges)) > POOR:
            raise ValueError(f"law {law.name!r}: the fit of its last stage differs from the law by {off:.1e}")
    return whole, _own_places(whole), np.concatenate([ends[:, None], values.reshape(count, -1)], axis=1)


def _summed(values: Array, matrix: Array) -> Array:
    """As `applied`, of many: the terms of each sum are added one after the other."""
    total = values[..., :1] * matrix[:, 0]
    for k in range(1, matrix.shape[1]):
        total += values[..., k, None] * matrix[:, k]
    return total


def never_fall(values: Array, before: float) -> NDArray[np.bool_]:
    """Whether the forces of `fitted_curves` are sure not to fall on any piece, and begin with `before`.

    values: as given there. On a piece the slope is at least a₁ − Σ k² |a_k|, because T_k′ ≤ k².
    """
    series = values[:, 1:].reshape(len(values), -1, 2 + 2 * TERMS)[:, :, 2 : 2 + TERMS]
    k = np.arange(2, TERMS)
    rises = series[:, :, 1] >= (abs(series[:, :, 2:]) * k**2).sum(axis=-1)
    begins = (series[:, 0] * (-1.0) ** np.arange(TERMS)).sum(axis=-1)
    return rises.all(axis=1) & (abs(begins - before) <= CONTINUOUS * before)


def _own_places(whole: native.Curve) -> NDArray[np.int32]:
    """Places of the doubles that `fitted_curves` writes: the end of the last stage; then those of its pieces."""
    stage = native.Curve.stage.offset + (whole.stages - 1) * ctypes.sizeof(native.Stage) + native.Stage.end.offset
    starts = [native.Piece.end.offset, native.Piece.work_at_begin.offset]
    for name in ("force", "mean"):
        begin = getattr(native.Piece, name).offset + native.Function.series.offset
        starts += [begin + 8 * k for k in range(TERMS)]
    first, count = whole.stage[whole.stages - 1].first, whole.stage[whole.stages - 1].count
    pieces = native.Curve.piece.offset + ctypes.sizeof(native.Piece) * np.arange(first, first + count)
    return np.concatenate([[stage], np.add.outer(pieces, starts).ravel()]).astype(np.int32) // 8


def _distance(stage: Stage, ends: Array, series: Array, edges: Array) -> float:
    """Largest relative difference between series and the force of a stage, on its pieces."""
    worst, z = 0.0, np.linspace(-0.97, 0.97, 9)
    for k in np.flatnonzero(edges[:-1] < ends).tolist():
        exact = values_of(stage.force, edges[k] + 0.5 * (edges[k + 1] - edges[k]) * (1.0 + z), stage)
        off = np.abs(np.polynomial.chebyshev.chebval(z, series[k]) - exact).max()
        worst = max(worst, float(off / np.abs(exact).max()))
    return worst
