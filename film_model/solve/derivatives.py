"""Derivatives of the results of one impact by numbers of its scene, with the decisions of the impact held fixed."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from film_model.base import units
from film_model.base.arrays import Array
from film_model.base.errors import Mistake, raise_all, shown
from film_model.base.late import Late
from film_model.effects.choose import Choice
from film_model.effects.decided import decisions_of
from film_model.oblique.result import OBLIQUE
from film_model.problem.summary import SUMMARY
from film_model.scene import DEFAULT_ACCURACY, Scene, Solver
from film_model.scene.friction_table import FrictionTable
from film_model.scene.paths import field_at, refuse_twice, unit_of
from film_model.solve.chain import slopes
from film_model.solve.slopes import NO_DERIVATIVE, SMOOTH, STEP, TARGET, Pairs, Slopes
from film_model.solve.slopes_along import REACH, slopes_along
from film_model.solve.stepped_slopes import slopes_of_relaxing, slopes_on_modes
from film_model.solve.vibration import Vibration

ALONG = " along the surface"


RESULTS = {**SUMMARY, **OBLIQUE}
"""What is differentiated, with dimension and meaning; results along the surface of impacts with friction only."""

SHOWN = ("maximum_force", "contact_duration", "coefficient_of_restitution")
"""Summary values whose derivatives `print` shows."""


class Entry(NamedTuple):
    """A number of a scene. value: SI. unit: as scene files write it. low, high: its range, SI. zero_step: of a
    derivative where the value is 0, SI; 0 if that is not defined."""

    path: str
    value: float
    dimension: str
    unit: str
    low: float
    high: float
    zero_step: float

    def unit_of(self, quantity: str) -> str:
        """The SI unit of the derivative of a summary value, as UDUNITS writes it if it can."""
        dimension = RESULTS[quantity][0]
        if self.dimension == "meyer_stiffness":
            return f"{units.si_unit(dimension)}/({self.unit})"
        return units.quotient_unit(dimension, self.dimension)

    @property
    def text(self) -> str:
        """The value with its unit."""
        return f"{self.value:.6g} {self.unit}".rstrip()


@dataclass(frozen=True, repr=False)
class Derivatives:
    """∂(result)/∂(number of the scene) of one impact, SI.

    entries: by path. values: by the names of the summary and, with friction, of `History.oblique`, then by path; None
    where there is no derivative. errors: the same, estimated, relative to the larger of the derivative and the value
    over the number.
    """

    entries: Mapping[str, Entry]
    values: Mapping[str, Mapping[str, float | None]]
    errors: Mapping[str, Mapping[str, float | None]]
    _slopes: Slopes = field(compare=False)
    _along: Slopes | None = field(compare=False)
    _choice: Choice = field(compare=False)

    _repr_html_ = Late("film_model.methods:derivatives_as_html")

    def __repr__(self) -> str:
        first, *others = self.entries
        more = f" and {len(others)} more" if len(others) > 1 else "".join(f" and {path}" for path in others)
        known = (error for row in self.errors.values() for error in row.values() if error is not None)
        said = f"; {len(self.warnings)} warnings" if self.warnings else ""
        return f"Derivatives(by {first}{more}, estimated relative error ≤ {max(known, default=0.0):.1e}{said})"

    def __str__(self) -> str:
        """A line for each number, with the derivatives of force, duration and restitution."""
        rows = [("", *SHOWN)] + [
            (f"by {path} = {entry.text}", *(self.text_of(name, path) or "-" for name in SHOWN))
            for path, entry in self.entries.items()
        ]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return "\n".join(
            "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows
        )

    def text_of(self, quantity: str, path: str) -> str:
        """One derivative as text with its SI unit; empty if there is none. Raises KeyError for an unknown name."""
        value, unit = self.values[quantity][path], self.entries[path].unit_of(quantity)
        return "" if value is None else f"{value:.6g} {unit.removeprefix('1')}".rstrip()

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about kinks, one-sided derivatives, large errors, and effects about to be decided otherwise."""
        entries, found = tuple(self.entries.values()), self._slopes
        along = (
            () if self._along is None else (*_kinks_along(entries, self._along), *_poor(entries, self._along, ALONG))
        )
        return (*_kinks(entries, found), *_poor(entries, found), *along, *_near_thresholds(self._choice))

    def of(self, quantity: str, path: str) -> Any:
        """One derivative as a pint quantity; None if there is none. Raises KeyError for an unknown name.

        >>> history = fm.simulate(scene, derivatives=["impactor.velocity"])
        >>> print(f"{history.derivatives.of('maximum_force', 'impactor.velocity').to('N*s/m'):.1f~P}")
        1606.9 N·s/m
        """
        value = self.values[quantity][path]
        if value is None:
            return None
        above = units.quantity(value, RESULTS[quantity][0])
        return above / above._REGISTRY.Quantity(1.0, self.entries[path].unit)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON: by result and path, the value, its units and its estimated relative error."""
        return {
            name: {
                path: {
                    "value": value,
                    "units": self.entries[path].unit_of(name),
                    "estimated_error": self.errors[name][path],
                }
                for path, value in row.items()
            }
            for name, row in self.values.items()
        }


def entries_of(scene: Scene, paths: Iterable[str], varied: Collection[str] = ()) -> tuple[Entry, ...]:
    """The numbers of a scene at some paths. varied: paths of numbers that vary.

    Raises SceneError for a path that has none, or none to differentiate by.
    """
    found, mistakes = dict[str, Entry](), list[Mistake]()
    asked = [paths] if isinstance(paths, str) else list(paths)
    for path in asked:
        try:
            found[path] = _entry(scene, path)
            refuse_twice(scene, path, [*asked, *varied])
        except ValueError as error:
            mistakes.append(Mistake(None, None, f"derivatives.{path}", str(error)))
    raise_all(mistakes)
    return tuple(found.values())


def _entry(scene: Scene, path: object) -> Entry:
    if not isinstance(path, str):
        raise ValueError(f'{shown(path)} is not the key of a scene such as "impactor.velocity"')
    number = field_at(scene, path)
    if number is None:
        raise ValueError("is not a number: there is no derivative by it")
    *sections, name = path.split(".")
    owner: Any = scene
    for section in sections:
        owner = getattr(owner, section)
    value = getattr(owner, "parameters", {}).get(name, getattr(owner, name, None))
    if isinstance(value, FrictionTable):
        raise ValueError("is a table: there is no derivative by it")
    if value is None or not math.isfinite(value):
        raise ValueError("is not given in the scene: give it there first")
    if name == "yield_strength" and getattr(owner, "hardness", None) is not None:
        raise ValueError("has no effect beside the hardness of the material: differentiate by that, or set it first")
    speed = scene.approach_velocity
    zeros = {"velocity": speed, "angular_frequency": speed / scene.impactor.radius, "angle": 1.0, "dimensionless": 1.0}
    of_zero = zeros.get(number.dimension, 0.0)
    if value == 0.0 and not of_zero > 0.0:
        raise ValueError("is 0: a derivative by it needs another value")
    low, high = (math.inf * sign if end is None else end for end, sign in ((number.low, -1), (number.high, 1)))
    return Entry(path, float(value), number.dimension, unit_of(scene, number), low, high, of_zero)


def derivatives_of(
    choice: Choice, solver: Solver, entries: Sequence[Entry], vibration: Vibration | None, slides: bool
) -> Derivatives:
    """Derivatives of the results of an impact whose effects are chosen. vibration: the impact on a vibrating target.
    slides: along the surface, with friction.

    Raises SimulationError for a number with which too many natural vibrations of the target change.
    """
    found, along = slopes_of(choice, solver, entries, vibration), None
    if slides and vibration is not None:
        along = Slopes.none(len(entries), len(OBLIQUE))
    elif slides:
        (decision,) = decisions_of(choice.problem)
        along = slopes_along(pairs_of(decision.put_into(choice.scene), {}, entries, 1, None))
    parts = [(SUMMARY, found)] + ([] if along is None else [(OBLIQUE, along)])
    by_path = {entry.path: entry for entry in entries}

    def table(of: str) -> dict[str, dict[str, float | None]]:
        made = dict[str, dict[str, float | None]]()
        for names, part in parts:
            columns = getattr(part, of)
            rows = np.where(np.isnan(columns), np.array(None), columns).T.tolist()
            made |= {name: dict(zip(by_path, row, strict=True)) for name, row in zip(names, rows, strict=True)}
        return made

    return Derivatives(by_path, table("values"), table("errors"), found, along, choice)


def slopes_of(choice: Choice, solver: Solver, entries: Sequence[Entry], vibration: Vibration | None) -> Slopes:
    """As :func:`derivatives_of`, as arrays."""
    (decision,) = decisions_of(choice.problem)
    strength = np.array([choice.problem.impacts.law.strength]) if decision.hard else None
    pairs = pairs_of(decision.put_into(choice.scene), {}, entries, 1, strength)
    if vibration is not None:
        return slopes_on_modes(choice, pairs, vibration, solver.accuracy or DEFAULT_ACCURACY)
    if choice.problem.relaxation is not None:
        return slopes_of_relaxing(choice, pairs)
    return slopes(pairs, solver, TARGET)


def pairs_of(
    scene: Scene, columns: Mapping[str, Array], entries: Sequence[Entry], count: int, strength: Array | None
) -> Pairs:
    """Each of `count` impacts with each of the numbers, those of an impact together.

    columns: numbers that vary, SI. strength: of each impact, if the scene has rate hardening.
    """
    given = {entry.path: np.full(count, entry.value) for entry in entries} | dict(columns)
    value = np.stack([given[entry.path] for entry in entries], axis=1)
    step = STEP * np.where(value == 0.0, [entry.zero_step for entry in entries], abs(value))
    low, high = (np.tile([getattr(entry, end) for entry in entries], count) for end in ("low", "high"))
    columns = {path: np.repeat(values, len(entries)) for path, values in given.items()}
    paths, which = tuple(entry.path for entry in entries), np.tile(np.arange(len(entries)), count)
    hard = None if strength is None else np.repeat(strength, len(entries))
    return Pairs(scene, columns, paths, which, value.ravel(), step.ravel(), low, high, hard)


def _kinks(entries: Sequence[Entry], found: Slopes) -> Iterable[str]:
    """Sentences about derivatives that are one-sided or do not exist."""
    for k, entry in enumerate(entries):
        side, within = int(found.side[k]), f"within {200.0 * STEP:g} % of {entry.text}"
        names = [name.replace("_", " ") for name, kinked in zip(SUMMARY, found.kinks[k], strict=True) if kinked]
        if names:
            yield f"no derivative of {', '.join(names)} by {entry.path}: there is a kink or jump {within}"
        if side == SMOOTH:
            continue
        why = "the stencil leaves the range of the entry"
        if found.other_end[k]:
            why = "contact ends otherwise, or the impact fails,"
        elif found.other_stage[k]:
            why = "contact reaches another stage of its law"
        if side == NO_DERIVATIVE:
            yield f"no derivatives by {entry.path}: {why} on both sides of {entry.text}"
        else:
            yield f"derivatives by {entry.path} are for {'smaller' if side < 0 else 'larger'} values: {why} {within}"


def _kinks_along(entries: Sequence[Entry], found: Slopes) -> Iterable[str]:
    """The same of results along the surface."""
    for entry, side in zip(entries, found.side.tolist(), strict=True):
        if side == NO_DERIVATIVE:
            why = f"within {REACH:g} % of {entry.text} the contact slides otherwise, or the target vibrates"
            yield f"no derivatives{ALONG} by {entry.path}: {why}"
        elif side != SMOOTH:
            which = "smaller" if side < 0 else "larger"
            yield f"derivatives{ALONG} by {entry.path} are for {which} values: beside them the contact slides otherwise"


def _poor(entries: Sequence[Entry], found: Slopes, which: str = "") -> Iterable[str]:
    poor = 1e-6
    for k, entry in enumerate(entries):
        worst = max(found.errors[k].tolist(), key=lambda error: error if error > poor else 0.0)
        if worst > poor:
            yield f"derivatives{which} by {entry.path}: estimated relative error up to {worst:.1e}"


def _near_thresholds(choice: Choice) -> Iterable[str]:
    """Sentences about effects that "auto" would decide otherwise for slightly other numbers."""
    scene, tolerance = choice.scene, choice.scene.effect_tolerance
    for effect in choice.effects:
        if effect.change is None or getattr(scene.effects, effect.name, False) != "auto":
            continue
        # another decision is near: within several times the reach of a stencil (tests/test_derivatives.py)
        if abs(effect.change / tolerance - 1.0) < 0.03:
            yield (
                f"{effect.name.replace('_', ' ')} is {effect.state}, and decided otherwise for slightly other numbers: "
                f"neglecting it changes a result by {100 * effect.change:.4g} %, the threshold is {100 * tolerance:g} %"
            )
