"""A measured or computed force-indentation curve."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from film_model.base.errors import shown
from film_model.base.files import read_bytes
from film_model.base.tables import HEADING, rows_of
from film_model.base.units import to_si
from film_model.laws.law import AbstractLaw, Array, ExampleBall, Family, Parameter, Stage

MOST_ROWS = 5000

_CLOSE = 1e-9  # relative to the largest force: a smaller deviation needs no more points
_COLUMNS = {"indentation": "length", "force": "force"}
_EXAMPLE = np.array([[0.0, 0.1, 0.25, 0.5, 0.8, 1.1, 1.5, 2.0], [0.0, 0.03, 0.1, 0.27, 0.46, 0.62, 0.8, 1.0]])


@dataclass(frozen=True)
class _Interpolated:
    """The monotone cubic interpolant of Fritsch and Carlson through points, for ξ and f."""

    points: tuple[tuple[float, float], ...]

    def __call__(self, xi: Array) -> Array:
        return _interpolant(self.points)(xi)


@lru_cache(maxsize=64)
def _interpolant(points: tuple[tuple[float, float], ...]) -> Any:
    from scipy.interpolate import PchipInterpolator

    xi, force = np.array(points).T
    return PchipInterpolator(xi, force)


@lru_cache(maxsize=64)
def _thinned(indentation: tuple[float, ...], force: tuple[float, ...]) -> tuple[tuple[tuple[float, float], ...], float]:
    """At most MOST_KNOTS points (ξ, f), and the largest deviation of the others relative to the largest force."""
    most_knots = 60  # of a longer table so many points are interpolated
    xi, f = np.array(indentation) / indentation[-1], np.array(force) / max(force)
    chosen = set(range(len(xi))) if len(xi) <= most_knots else {0, len(xi) - 1}
    while True:
        points = tuple((float(xi[k]), float(f[k])) for k in sorted(chosen))
        misses = np.abs(_interpolant.__wrapped__(points)(xi) - f)
        worst = int(np.argmax(misses))
        if misses[worst] <= _CLOSE or len(chosen) >= most_knots:
            return points, float(misses[worst])
        chosen.add(worst)


@dataclass(frozen=True)
class Tabulated(AbstractLaw):
    """F(δ) through given points, by monotone cubic interpolation (Fritsch & Carlson 1980).

    Forces are ≥ 0. Of more points 60 are interpolated, added where the deviation is largest; a run reports what
    remains. In a scene it unloads by Brake's rule.
    """

    name: ClassVar[str] = "tabulated"
    family: ClassVar[Family] = "measured"
    summary: ClassVar[str] = "a measured or computed curve, by monotone interpolation; Brake's unloading"
    source: ClassVar[str] = "Fritsch & Carlson 1980, SIAM J. Numer. Anal. 17:238 (interpolation)"
    validity: ClassVar[str] = "from zero to the last indentation of the table"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "file": Parameter("CSV with the columns indentation and force, units in the heading", "file", required=False),
        "indentation": Parameter("from 0 on, increasing", "length", required=False, several=True),
        "force": Parameter("as many values, not decreasing", "force", required=False, several=True),
    }
    default_unloading: ClassVar[str | None] = "brake"

    indentation: tuple[float, ...]
    force: tuple[float, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "indentation", tuple(map(float, self.indentation)))
        object.__setattr__(self, "force", tuple(map(float, self.force)))
        for name, message in _mistakes(self.indentation, self.force).items():
            raise ValueError(f"Tabulated.{name}: {message}")

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        return {
            "indentation": tuple(_EXAMPLE[0] * ball.depth),
            "force": tuple(_EXAMPLE[1] * ball.stiffness * ball.depth**1.5),
        }

    def scales(self, energy: float) -> tuple[float, float]:
        return self.indentation[-1], max(self.force)

    def stages(self) -> tuple[Stage, ...]:
        points, _ = _thinned(self.indentation, self.force)
        inner = tuple(xi for xi, _ in points[1:-1])
        return (Stage("table", 0.0, 1.0, _Interpolated(points), knots=inner),)

    def remarks(self) -> tuple[str, ...]:
        points, miss = _thinned(self.indentation, self.force)
        if len(points) == len(self.force) or miss <= _CLOSE:
            return ()
        return (
            f"law tabulated: {len(points)} of the table's {len(self.force)} points are interpolated; the others lie "
            f"off by up to {100 * miss:.2g} % of its largest force",
        )

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        lists = [name for name in _COLUMNS if name in values]
        path = values.pop("file", None)
        if path is not None and lists:
            return {lists[0]: "give file, or indentation and force, not both"}
        if path is None and len(lists) < 2:
            missing = next(name for name in _COLUMNS if name not in values)
            return {missing: 'missing: law "tabulated" needs file, or indentation and force'}
        if path is not None:
            try:
                values["indentation"], values["force"] = read_table(path)
            except (OSError, ValueError) as error:
                reason = f"{shown(path)} cannot be read: {error.strerror}" if isinstance(error, OSError) else str(error)
                return {"file": reason}
        wrong = _mistakes(values["indentation"], values["force"])
        if path is not None and wrong:
            return {"file": f"{shown(path)}: " + "; ".join(f"{name}: {text}" for name, text in wrong.items())}
        return wrong


def _mistakes(indentation: Sequence[float], force: Sequence[float]) -> dict[str, str]:
    """Messages about a table, by column; points are counted from 1."""
    if len(indentation) != len(force):
        return {"force": f"{len(force)} values for {len(indentation)} indentations"}
    if not 2 <= len(force) <= MOST_ROWS:
        return {"force": f"{len(force)} points; 2 to {MOST_ROWS} are allowed"}
    if indentation[0] != 0.0:
        return {"indentation": f"the first value is {indentation[0]:g} m; it must be 0 m"}
    for k, (a, b) in enumerate(pairwise(indentation), 2):
        if not b > a:
            return {"indentation": f"point {k}, {b:g} m, is not above the one before, {a:g} m: it must increase"}
        if b - a < 1e-9 * indentation[-1]:  # the slopes between closer points are rounding
            return {"indentation": f"point {k}, {b:g} m, is too close to the one before, {a:g} m: leave one out"}
    if not force[0] >= 0.0:
        return {"force": f"the first value is {force[0]:g} N; it must be >= 0 N"}
    for k, (a, b) in enumerate(pairwise(force), 2):
        if not b >= a:
            return {"force": f"point {k}, {b:g} N, is below the one before, {a:g} N: it must not decrease"}
    return {} if force[-1] > 0.0 else {"force": "is zero everywhere"}


def read_table(path: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Indentations [m] and forces [N] of a CSV file: UTF-8, separated by commas, semicolons or tabs; a first row such
    as "indentation (um), force (N)", lines that begin with # and other columns are ignored.

    Raises OSError, or ValueError with the line of what is wrong.
    """
    columns: tuple[list[float], list[float]] = ([], [])
    try:
        rows = rows_of(path, read_bytes(path, 50_000_000).decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise ValueError(f"{shown(path)} is not a text in UTF-8: byte {error.start}") from None
    except ValueError as error:
        raise ValueError(f"{shown(path)} {error}") from None
    line, heading = next(rows, (1, []))
    where = dict(_heading(path, line, heading))
    if set(where) != set(_COLUMNS):
        example = '"indentation (um), force (N)"'
        raise ValueError(f"{shown(path)}, line {line}: a heading is needed, with units, such as {example}")
    for line, cells in rows:
        if len(columns[0]) == MOST_ROWS:
            raise ValueError(f"{shown(path)}, line {line}: more than {MOST_ROWS} rows")
        for values, (name, dimension) in zip(columns, _COLUMNS.items(), strict=True):
            place, unit = where[name]
            cell = cells[place].strip() if place < len(cells) else ""
            try:
                values.append(to_si(f"{cell} {unit}", dimension))
            except ValueError:
                raise ValueError(f"{shown(path)}, line {line}: {name} is {shown(cell)}, a number is needed") from None
    return tuple(columns[0]), tuple(columns[1])


def _heading(path: str, line: int, cells: list[str]) -> Iterator[tuple[str, tuple[int, str]]]:
    """Column name → its place and unit."""
    for place, cell in enumerate(cells):
        match = HEADING.fullmatch(cell)
        name = match[1].lower() if match else ""
        if match is not None and match[2] is not None and name in _COLUMNS:
            try:
                to_si(f"1 {match[2]}", _COLUMNS[name])
            except ValueError as error:
                raise ValueError(f"{shown(path)}, line {line}: {name}: {error}") from None
            yield name, (place, match[2])
