"""Families of curves of laws whose last stage depends on more numbers beside the shape, such as Poisson's ratio.

The force at any indentation, and what else depends on these numbers, is interpolated between the law's own values at
few indentations, the marks: a sum of them times functions of the indentation that are the same for all laws of the
family. Marks and functions are found by cross approximation with full pivoting (Goreinov, Tyrtyshnikov & Zamarashkin
1997, Linear Algebra Appl. 261:1) of the values of laws at Chebyshev nodes in all these numbers. The core sums the curve
of a law from its values at the marks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import lru_cache
from itertools import cycle, islice
from typing import Any

import numpy as np

from film_model.base.arrays import Array, Index, agree
from film_model.core.families import Family
from film_model.laws.law import AbstractLaw
from film_model.problem.families import (
    ANY_SHAPE,
    CHECKED,
    EDGES,
    LAST_PAGE,
    NODES,
    ONLY,
    TERMS,
    Page,
    applied,
    difference,
    edges_of,
    mean_matrix,
    nodes_of,
    page_number,
    places_of,
    series_matrix,
    shared_part,
    trimmed,
    values_at,
    varying,
    whole_of,
)

BESIDE = {1: 12, 2: 7, 3: 6}
"""Chebyshev nodes in each number beside the shape, of which there are one to three. From 6 on, only rounding is left
of the error under jackson-green, 1e-14 to 5e-14; under elastoplastic, these leave 1e-11 where S_y/E is above 1e-4, or
1e-9 if x varies."""


def mixture_of(law: AbstractLaw, names: Iterable[str]) -> Page:
    """The page of a law for any values of some of its numbers beside the shape. ValueError if the shape is outside all
    pages."""
    number = int(page_number(law.shape))
    if not 0 <= number < LAST_PAGE:
        raise ValueError(f"law {law.name!r}: a shape of {law.shape:g} is outside of all pages")
    names = tuple(sorted(names))
    middle = {name: 0.5 * sum(law.shaped_beside[name]) for name in names}
    one = replace(law.of_shape(ANY_SHAPE), **middle)  # type: ignore[type-var]
    return _between(one, names, float(EDGES[number]), float(EDGES[number + 1]))


def mixed_numbers(page: Page, law_at: Callable[[Any], AbstractLaw], count: int) -> Array:
    """The family's numbers of `count` laws: values at the marks, and the end of the last stage; a row each.

    law_at: the law at an index, or, at several indices, with arrays of their shape in its fields. Raises ValueError if
    laws with arrays differ from laws alone.
    """
    together = 512  # laws that are evaluated at once: their arrays stay in the processor's cache
    marks = page.marks
    assert marks is not None
    found = np.empty((count, page.family.nodes + 1))
    for first in range(0, count, together):
        rows = slice(first, first + together)
        last: Any = law_at((rows, None)).stages()[-1]
        found[rows, :-1], found[rows, -1:] = values_at(last, marks), last.end

    def alone(place: int) -> list[Array]:
        one: Any = law_at(place).stages()[-1]
        return [np.append(values_at(one, marks), one.end)]

    if not agree([found], alone, count):
        raise ValueError("a law with arrays differs from that of one impact")
    return found


@lru_cache(maxsize=16)
def _between(law: AbstractLaw, beside: tuple[str, ...], low: float, high: float) -> Page:
    """The page for shapes from low to high. law: any of its laws with `ANY_SHAPE`. beside: the numbers that vary."""

    def law_at(*places: Any) -> Any:
        """That between the ends of the page, at −1, and 1."""
        shape: Any = low * (high / low) ** (0.5 * (1.0 + places[0]))
        numbers = dict[str, Any]()
        for name, y in zip(beside, places[1:], strict=True):
            least, most = law.shaped_beside[name]
            numbers[name] = least + 0.5 * (most - least) * (1.0 + y)
        return replace(law.of_shape(shape), **numbers)  # type: ignore[type-var]

    nodes = [NODES] + [BESIDE[len(beside)]] * len(beside)
    grid = np.meshgrid(*map(np.polynomial.chebyshev.chebpts1, nodes), indexing="ij")
    every = law_at(*(axis.reshape(-1, 1) for axis in grid)).stages()
    middle = law_at(*[0.0] * len(nodes)).stages()
    if shared_part(every) != shared_part(middle):
        raise ValueError(f"law {law.name!r}: {ONLY}")
    names = varying((law_at(*[-1.0] * len(nodes)).stages()[-1], law_at(*[1.0] * len(nodes)).stages()[-1]))
    edges = edges_of(middle[-1], float(every[-1].end.max()))
    xi = nodes_of(edges)
    table = values_at(every[-1], dict.fromkeys(names, xi.ravel()))
    values = table.reshape(len(table), len(names), *xi.shape)
    size = np.broadcast_to(abs(values).max(axis=(0, 3), keepdims=True), (1, *values.shape[1:])).ravel()
    laws, marks, shares = _cross(table / size)
    order = np.argsort(marks, kind="stable")  # those of the force first
    shares = shares[order] * (size / size[marks[order]][:, None])
    given = applied(series_matrix(TERMS), values[laws].swapaxes(0, 1))
    whole, error, steepest = whole_of(law, middle, edges, dict(zip(names, map(trimmed, given), strict=True)))
    found = applied(series_matrix(TERMS), shares.reshape(len(shares), len(names), *xi.shape).swapaxes(0, 1))
    series = dict(zip(names, found, strict=True))
    mean = applied(mean_matrix(), series["force"])
    work = np.diff(edges) * mean.sum(axis=-1)
    places, columns = places_of(whole, work - np.cumsum(work, axis=-1), {**series, "mean": mean})
    family = Family.of(0.0, 0.0, np.zeros(len(marks)), places, np.array(columns).T)
    number, place = np.divmod(marks[order], xi.size)
    points = {name: xi.ravel()[place[number == k]] for k, name in enumerate(names)}
    page = Page(whole, family, error, steepest, points)

    def off(*places: float) -> float:
        one = law_at(*places)
        return difference(page.at(mixed_numbers(page, lambda _: one, 1)[0]), one.stages()[-1])

    checked = zip(*islice(cycle((CHECKED, CHECKED[::-1])), len(nodes)), strict=True)
    return replace(page, fit_error=max(error, *(off(*each) for each in checked)))


def _cross(values: Array) -> tuple[Index, Index, Array]:
    """Rows and columns of `values`, and the shares by which the columns give all: values ≈ values[:, columns] @ shares.

    Elimination with full pivoting, without BLAS: its rounding is the same on every processor.
    """
    # Largest number of marks (FILM_MAX_NODES), of which laws need 20 to 90; remaining difference at which no more are
    # needed, over the largest force on a piece
    most_marks, small = 96, 1e-13
    left, rows, columns, pivots = values.copy(), list[int](), list[int](), list[Array]()
    while len(rows) < most_marks:
        row, column = divmod(int(abs(left).argmax()), left.shape[1])
        if not abs(left[row, column]) > small:
            break
        rows.append(row)
        columns.append(column)
        pivots.append(left[row].copy())
        left -= (left[:, column] / left[row, column])[:, None] * left[row]
    shares = np.array(pivots)
    for k in range(len(rows) - 1, -1, -1):
        for after in range(k + 1, len(rows)):
            shares[k] -= pivots[k][columns[after]] * shares[after]
        shares[k] /= pivots[k][columns[k]]
    return np.array(rows, np.intp), np.array(columns, np.intp), shares
