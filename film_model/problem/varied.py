"""Curves that share their pieces and differ in numbers, such as a ratio of stiffnesses: the numbers of each impact."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, agree
from film_model.core import native
from film_model.laws.law import AbstractLaw, Power, Stage, origin_of
from film_model.problem.curve import curve_of
from film_model.problem.fit import functions_of
from film_model.problem.law_of_scene import SceneLaw

_NUMBERS = ("constant", "slope", "square", "coefficient")
"""What may vary of a power, with its origin: with its exponent, the pieces of a fit would vary too. Where a stage ends
may vary, too, if the pieces before do not depend on it, and the stage behind is not fitted."""


class Varied(NamedTuple):
    """curve: one for all impacts. places: of its doubles that differ. values: of each impact, a row each."""

    curve: native.Curve
    places: NDArray[np.int32]
    values: Array

    def part(self, places: Any) -> Varied:
        """Of some of the impacts."""
        return self._replace(values=self.values[places])

    def curve_at(self, place: int) -> native.Curve:
        """The curve of one impact."""
        made = native.Curve.from_buffer_copy(self.curve)
        doubles = (ctypes.c_double * (ctypes.sizeof(made) // 8)).from_buffer(made)
        for at, value in zip(self.places.tolist(), self.values[place].tolist(), strict=True):
            doubles[at] = value
        return made


def varied_of(law: SceneLaw, count: int) -> Varied | None:
    """What differs between the curves of `count` laws with arrays; None if it is more than numbers of powers.

    The stages are evaluated once with arrays.
    """
    if law.rule is not None or isinstance(law.law, AbstractLaw) or law.law.shaped_by:
        return None
    try:
        numbers = _numbers(law.at(slice(None)).stages())
        if not agree(_flat(numbers), lambda place: _flat(_numbers(law.at(place).stages())), count):
            return None
        curve = curve_of(law.at(0)).native
    except (TypeError, ValueError):  # stages that cannot be evaluated with arrays
        return None
    if curve.stages != len(numbers):  # a stage was split where its force has an extreme
        return None
    places, columns = list[int](), list[Any]()
    for number, stage in enumerate(numbers):
        for (function, name), value in stage.items():
            if not isinstance(value, np.ndarray):
                continue
            at = list(_places(curve, number, function, name, stage))
            if not at:
                return None
            places += at
            columns += [np.broadcast_to(value, (count,))] * len(at)
    return Varied(curve, np.array(places, np.int32), np.stack(columns, axis=-1)) if places else None


def _places(
    curve: native.Curve, number: int, function: str, name: str, stage: Mapping[tuple[str, str], Any]
) -> Iterator[int]:
    """Where a number of a stage is among the doubles of the curve; none if it cannot vary."""
    entry = curve.stage[number]
    if function == "stage":
        fitted = any(key[1] == "function" for key in stage)
        if name not in ("begin", "end") or (fitted and (name == "begin" or stage["stage", "reach"] is None)):
            return
        begin = native.Curve.stage.offset + number * ctypes.sizeof(native.Stage)
        yield (begin + getattr(native.Stage, name).offset) // 8
        if name == "end" and not fitted:
            yield _place(entry.first + entry.count - 1, "end")
    elif name in (*_NUMBERS, "origin"):
        for piece in range(entry.first, entry.first + entry.count):
            yield _place(piece, function, name)


def _numbers(stages: tuple[Stage, ...]) -> list[dict[tuple[str, str], Any]]:
    """What the core's curve is made of: of each stage by function and name."""
    return [dict(_of_stage(stage)) for stage in stages]


def _of_stage(stage: Stage) -> Iterator[tuple[tuple[str, str], Any]]:
    unloading = stage.unloading
    for name in ("begin", "end", "root", "knots", "pulls", "reach"):
        yield ("stage", name), getattr(stage, name)
    if unloading is not None:
        yield ("stage", "rule"), (unloading.rule[0], unloading.reload_exponent)
    for name, function in functions_of(stage).items():
        if not isinstance(function, Power):
            yield (name, "function"), function
            continue
        # the work of a force counts from its origin: with another one than the stage's it would vary too
        moved = name == "force" and bool(np.any(origin_of(function, stage) != stage.begin))
        for field in ("exponent", *_NUMBERS):
            yield (name, f"moved {field}" if moved else field), getattr(function, field)
        yield (name, "moved origin" if moved else "origin"), origin_of(function, stage)


def _flat(numbers: list[dict[tuple[str, str], Any]]) -> list[Any]:
    return [each for stage in numbers for item in stage.items() for each in item]


def _place(piece: int, function: str, name: str | None = None) -> int:
    """The place of a number of a piece, or of its power, among the doubles of the core's curve."""
    begin = native.Curve.piece.offset + piece * ctypes.sizeof(native.Piece) + getattr(native.Piece, function).offset
    return (begin + (0 if name is None else getattr(native.Function, name).offset)) // 8


def fitted_by(law: SceneLaw) -> dict[str, Array]:
    """Those besides the law's shape, of a law that has one: for each of their values it is fitted again."""
    if law.rule is not None or isinstance(law.law, AbstractLaw) or not law.law.shaped_by:
        return {}
    return {name: value for name, value in law.read.items() if name not in law.law.shaped_by}
