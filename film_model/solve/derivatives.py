"""Derivatives of the summary of one impact by numbers of its scene, with the decisions of the impact held fixed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from film_model.base import units
from film_model.base.arrays import Array
from film_model.base.errors import Mistake, raise_all, shown
from film_model.effects.choose import Choice
from film_model.effects.decided import decisions_of
from film_model.problem.problem import refuse_vibrations
from film_model.problem.summary import SUMMARY
from film_model.scene import Scene, Solver
from film_model.scene.paths import field_at, unit_of
from film_model.solve.chain import slopes
from film_model.solve.slopes import NO_DERIVATIVE, SMOOTH, STEP, TARGET, Pairs, Slopes

POOR = 1e-6
"""Estimated relative error from which a warning names the derivative."""

NEAR = 0.03
"""Change by neglecting an effect, relative to the tolerance less 1, up to which another decision is near: several times
the reach of a stencil. Needed by tests/test_derivatives.py."""


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
        dimension = SUMMARY[quantity][0]
        if self.dimension == "meyer_stiffness":
            return f"{units.si_unit(dimension)}/({self.unit})"
        return units.quotient_unit(dimension, self.dimension)

    @property
    def text(self) -> str:
        """The value with its unit."""
        return f"{self.value:.6g} {self.unit}".rstrip()

    def step(self, value: Any) -> Any:
        """Step of a stencil at some values."""
        return np.where(value == 0.0, STEP * self.zero_step, STEP * np.abs(value))


@dataclass(frozen=True)
class Derivatives:
    """∂(summary value)/∂(number of the scene) of one impact, SI.

    entries: by path. values: by summary name, then by path; None where there is no derivative. errors: the same,
    estimated, relative to the larger of the derivative and the summary value over the number. warnings: sentences
    about kinks, one-sided derivatives and effects about to be decided otherwise.
    """

    entries: Mapping[str, Entry]
    values: Mapping[str, Mapping[str, float | None]]
    errors: Mapping[str, Mapping[str, float | None]]
    warnings: tuple[str, ...]

    def of(self, quantity: str, path: str) -> Any:
        """One derivative as a pint quantity; None if there is none. Raises KeyError for an unknown name.

        >>> history = fm.simulate(scene, derivatives=["impactor.velocity"])
        >>> print(f"{history.derivatives.of('maximum_force', 'impactor.velocity').to('N*s/m'):.1f~P}")
        1322.9 N·s/m
        """
        value = self.values[quantity][path]
        if value is None:
            return None
        above = units.quantity(value, SUMMARY[quantity][0])
        return above / above._REGISTRY.Quantity(1.0, self.entries[path].unit)

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON: by summary name and path, the value, its units and its estimated relative error."""
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


def entries_of(scene: Scene, paths: Iterable[str]) -> tuple[Entry, ...]:
    """The numbers of a scene at some paths. Raises SceneError for a path that has none, or none to differentiate by."""
    found, mistakes = dict[str, Entry](), list[Mistake]()
    for path in [paths] if isinstance(paths, str) else paths:
        try:
            found[path] = _entry(scene, path)
        except ValueError as error:
            mistakes.append(Mistake(None, None, f"derivatives.{path}", str(error)))
    raise_all(mistakes)
    return tuple(found.values())


def _entry(scene: Scene, path: object) -> Entry:
    if not isinstance(path, str):
        raise ValueError(f'{shown(path)} is not the key of a scene such as "impactor.velocity"')
    field = field_at(scene, path)
    if field is None:
        raise ValueError("is not a number: there is no derivative by it")
    *sections, name = path.split(".")
    owner: Any = scene
    for section in sections:
        owner = getattr(owner, section)
    value = getattr(owner, "parameters", {}).get(name, getattr(owner, name, None))
    if value is None or not math.isfinite(value):
        raise ValueError("is not given in the scene: give it there first")
    of_zero = {"velocity": scene.approach_velocity, "angle": 1.0, "dimensionless": 1.0}.get(field.dimension, 0.0)
    if value == 0.0 and not of_zero > 0.0:
        raise ValueError("is 0: a derivative by it needs another value")
    low, high = (math.inf * sign if end is None else end for end, sign in ((field.low, -1), (field.high, 1)))
    return Entry(path, float(value), field.dimension, unit_of(scene, field), low, high, of_zero)


def derivatives_of(choice: Choice, solver: Solver, entries: Sequence[Entry]) -> Derivatives:
    """Derivatives of the summary of an impact whose effects are chosen; SimulationError on a vibrating target."""
    refuse_vibrations(choice.problem, "a derivative")
    (decision,) = decisions_of(choice.problem)
    strength = np.array([choice.problem.impacts.law.strength]) if decision.hard else None
    found = slopes(pairs_of(decision.put_into(choice.scene), {}, entries, 1, strength), solver, TARGET)

    def table(columns: Array) -> dict[str, dict[str, float | None]]:
        return {
            name: {
                entry.path: None if math.isnan(value) else value for entry, value in zip(entries, row, strict=True)
            }
            for name, row in zip(SUMMARY, columns.T.tolist(), strict=True)
        }

    said = (*_kinks(entries, found), *_poor(entries, found), *_near_thresholds(choice))
    return Derivatives({e.path: e for e in entries}, table(found.values), table(found.errors), said)


def pairs_of(
    scene: Scene, columns: Mapping[str, Array], entries: Sequence[Entry], count: int, strength: Array | None
) -> Pairs:
    """Each of `count` impacts with each of the numbers, those of an impact together.

    columns: numbers that vary, SI. strength: of each impact, if the scene has rate hardening.
    """
    given = {entry.path: np.full(count, entry.value) for entry in entries} | dict(columns)
    which = np.tile(np.arange(len(entries)), count)
    step = np.stack([entry.step(given[entry.path]) for entry in entries], axis=1).ravel()
    low, high = (np.array([getattr(entry, end) for entry in entries])[which] for end in ("low", "high"))
    repeated = {path: np.repeat(values, len(entries)) for path, values in given.items()}
    hard = None if strength is None else np.repeat(strength, len(entries))
    return Pairs(scene, repeated, tuple(entry.path for entry in entries), which, step, low, high, hard)


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


def _poor(entries: Sequence[Entry], found: Slopes) -> Iterable[str]:
    for k, entry in enumerate(entries):
        worst = max(found.errors[k].tolist(), key=lambda error: error if error > POOR else 0.0)
        if worst > POOR:
            yield f"derivatives by {entry.path}: estimated relative error up to {worst:.1e}"


def _near_thresholds(choice: Choice) -> Iterable[str]:
    """Sentences about effects that "auto" would decide otherwise for slightly other numbers."""
    scene, tolerance = choice.scene, choice.scene.effect_tolerance
    for effect in choice.effects:
        if effect.change is None or getattr(scene.effects, effect.name, False) != "auto":
            continue
        if abs(effect.change / tolerance - 1.0) < NEAR:
            yield (
                f"{effect.name.replace('_', ' ')} is {effect.state}, and decided otherwise for slightly other numbers: "
                f"neglecting it changes a result by {100 * effect.change:.4g} %, the threshold is {100 * tolerance:g} %"
            )
