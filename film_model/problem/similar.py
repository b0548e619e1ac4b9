"""Pages of laws all of whose stages depend on one number, their similarity: curves of many impacts that differ in it.

A page is a family of curves as in :mod:`film_model.problem.families`, in which also the ends of stages and pieces move
with the number. One impact has a curve of its own.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from film_model.core import native
from film_model.core.families import Family
from film_model.laws.law import AbstractLaw, Array, Function, Power, Stage
from film_model.problem.families import CHECKED, NODES, Page, applied, series_matrix
from film_model.problem.fit import FIT_ROUNDING, Span, assemble, checked, functions_of, halved, values_of
from film_model.problem.series import coefficients

_SERIES = native.Function.series.offset // 8


def number_of(law: type[AbstractLaw], similarity: Any) -> Any:
    """Number of the page of a similarity, or of each of many; negative, or too large, outside of all pages."""
    return np.searchsorted(law.similarities, similarity, side="right") - 1


def similar_page(law: AbstractLaw) -> Page | None:
    """The page of a law; None if it has no similarity, or none within the pages."""
    edges = law.similarities
    if len(edges) < 2 or not edges[0] <= law.similarity < edges[-1]:
        return None
    number = int(number_of(type(law), law.similarity))
    return _between(
        law.of_similarity(edges[number] ** 0.5 * edges[number + 1] ** 0.5), edges[number], edges[number + 1]
    )


@lru_cache(maxsize=64)
def _between(law: AbstractLaw, low: float, high: float) -> Page:
    """The page of the laws `law.of_similarity(s)` for s from low to high."""
    z = np.polynomial.chebyshev.chebpts1(NODES)
    given = [list(law.of_similarity(low * (high / low) ** (0.5 * (1.0 + x))).stages()) for x in z.tolist()]
    name = f"law {law.name!r}"
    checked(name, tuple(given[0]))
    made = [assemble(name, stages, _at_knots) for stages in given]
    whole, error, steepest = made[
        0
    ]  # that with the least ends: `film_shape` leaves out pieces that begin beyond the end
    values = np.array([np.frombuffer(bytes(curve), np.float64) for curve, _, _ in made])
    moved = (values.view(np.uint64) != values[0].view(np.uint64)).any(axis=0)
    if not np.isfinite(values[:, moved]).all():
        raise ValueError(f"{name}: the stages of laws from {low:g} to {high:g} differ in their number of pieces")
    for function, at in _fitted(whole):
        largest = abs(values[:, at + _SERIES : at + _SERIES + function.terms]).max(axis=0)
        function.terms = int(np.flatnonzero(largest > FIT_ROUNDING * largest.max()).max()) + 1
        moved[at + _SERIES + function.terms : at + _SERIES + native.MAX_TERMS] = False
    places = np.flatnonzero(moved)
    ends = coefficients(np.log([stages[-1].end for stages in given]))
    table = applied(series_matrix(NODES), np.ascontiguousarray(values[:, places].T)).T
    page = Page(whole, Family.of(low, high, ends, places.tolist(), table), error, steepest)
    tried = (low * (high / low) ** (0.5 * (1.0 + x)) for x in CHECKED)
    return replace(page, fit_error=max(error, *(_difference(page, law.of_similarity(each), each) for each in tried)))


def _at_knots(stage: Stage, functions: Mapping[str, Function], room: int) -> tuple[list[Span], float]:
    """The stage cut at its knots only, if its unloading is fitted: with all terms, and without a check."""
    if stage.unloading is None:
        return halved(stage, functions, room)
    edges = np.array([stage.begin, *stage.knots, stage.end])
    x = 0.5 * (1.0 + np.polynomial.chebyshev.chebpts1(native.MAX_TERMS))
    xi = edges[:-1, None] + np.diff(edges)[:, None] * x
    fitted = {name: function for name, function in functions.items() if not isinstance(function, Power)}
    series = {
        name: applied(series_matrix(native.MAX_TERMS), values_of(function, xi.ravel(), stage).reshape(xi.shape))
        for name, function in fitted.items()
    }
    spans = pairwise(edges.tolist())
    return [(a, b, False, {name: own[k] for name, own in series.items()}) for k, (a, b) in enumerate(spans)], 0.0


def _fitted(whole: native.Curve) -> Iterator[tuple[native.Function, int]]:
    """The fitted functions of the last stage, and the place of each among the doubles of the curve."""
    last = whole.stage[whole.stages - 1]
    for k in range(last.first, last.first + last.count):
        for name in ("force", "mean", "recovery", "exponent"):
            function = getattr(whole.piece[k], name)
            if function.form == native.SERIES:
                begin = native.Curve.piece.offset + k * ctypes.sizeof(native.Piece) + getattr(native.Piece, name).offset
                yield function, begin // 8


def _difference(page: Page, law: AbstractLaw, similarity: float) -> float:
    """Largest relative difference of a function of the last stage between the page's curve and the law."""
    curve, stage = page.at(similarity), law.stages()[-1]
    entry, functions, worst = curve.stage[curve.stages - 1], functions_of(stage), 0.0
    ends = [stage.begin, *stage.knots, stage.end]
    for k, (begin, end) in enumerate(pairwise(ends)):
        xi = np.linspace(begin, end, 31)[1:-1]
        for name, function in functions.items():
            exact = values_of(function, xi, stage)
            found = _evaluated(getattr(curve.piece[entry.first + k], name), xi)
            worst = max(worst, float(abs(found - exact).max() / abs(exact).max()))
    return worst


def _evaluated(function: native.Function, xi: Array) -> Array:
    """As the core evaluates it."""
    x = np.maximum((xi - function.origin) * function.per_span, 0.0)
    if function.form == native.SERIES:
        return np.polynomial.chebyshev.chebval(2.0 * x - 1.0, np.array(function.series[: function.terms]))
    return function.constant + function.slope * x + function.coefficient * x**function.exponent
