"""Many impacts of one scene, some of whose numbers differ from row to row: the core's problems, one curve each."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from film_model.curve import Curve, curve_of
from film_model.edges import edged, wide
from film_model.effects import reaches_yield
from film_model.errors import SimulationError
from film_model.laws import LAWS, AbstractLaw
from film_model.laws.unloading import BrakeUnloading
from film_model.problem import Array, Problem, problem_of
from film_model.row_effects import decided
from film_model.row_problems import Group, Index, RowLaw, Rows, column, zener_numbers
from film_model.scales import Scales
from film_model.scene import Scene

VIBRATES = -101
"""Status of a row whose target vibrates between its edges."""

FEW = 4
"""Fewer impacts than this on a curve, on average, are made one by one."""


def scene_of_columns(scene: Scene, columns: Mapping[str, Array]) -> Scene:
    """The scene with arrays [SI] in place of some of its numbers, by path: its derived values are arrays too."""
    made = copy.copy(scene)
    for path, values in columns.items():
        *sections, name = path.split(".")
        owner: Any = made
        for section in sections:
            part = copy.copy(getattr(owner, section))
            object.__setattr__(owner, section, part)
            owner = part
        if path.startswith("contact.") and name not in owner.FIELDS:
            object.__setattr__(owner, "parameters", {**owner.parameters, name: values})
        else:
            object.__setattr__(owner, name, values)
    return made


def rows_of(
    scene: Scene, columns: Mapping[str, Array], count: int, status: NDArray[np.int32] | None = None
) -> list[Rows]:
    """The problems of `count` impacts of a scene, some of whose numbers are columns (path → SI values, one a row).

    They are those of `problem_of` for the scene of each row, computed on whole arrays, which some rows are checked
    for; where arrays do not serve, row by row. Rows whose laws have the same dimensionless stages share a curve. Rows
    whose impactor does not approach, or that make no problem, are left out; if none makes one, the first one's error
    is raised. Left out, too, are rows whose target vibrates, of which no curve knows; status takes `VIBRATES` for them.
    """
    status = np.zeros(count, np.int32) if status is None else status
    moving = np.flatnonzero(column(scene_of_columns(scene, columns).approach_velocity, count) > 0.0)
    part, found = _part(scene, columns, moving), []
    right = wide(part) or not edged(part)
    try:
        if right:
            found = [rows for group in _groups(scene, columns, moving) for rows in decided(group)]
            right = all(_agrees(rows, scene, columns) for rows in found)
    except (TypeError, ValueError, SimulationError):
        right = False
    if not right:
        return _one_by_one(scene, columns, moving, status)
    rest = np.zeros(count, np.bool_)
    rest[moving] = True
    for rows in found:
        rest[rows.index] = False
    left = np.flatnonzero(rest)
    return found + (_one_by_one(scene, columns, left, status, bool(found)) if left.size else [])


_NUMBERS = ("drift", "share", "mass")


def _agrees(rows: Rows, scene: Scene, columns: Mapping[str, Array]) -> bool:
    """Whether the first, middle and last row are what `problem_of` makes of their scenes."""
    for place in {0, rows.index.size // 2, rows.index.size - 1}:
        problem = problem_of(_at_row(scene, columns, int(rows.index[place])))
        same = [(getattr(rows, name)[place], getattr(problem, name)) for name in _NUMBERS]
        same += [(getattr(rows.scales, name)[place], value) for name, value in vars(problem.scales).items()]
        same += [(rows.start[name][place], getattr(problem.start, name)) for name in native.START_DTYPE.names or ()]
        curve = problem.curve is rows.curve or bytes(problem.curve.native) == bytes(rows.curve.native)
        if not (curve and problem.law.name == rows.law and np.allclose(*zip(*same, strict=True), rtol=1e-12, atol=0.0)):
            return False
    return True


def _one_by_one(
    scene: Scene,
    columns: Mapping[str, Array],
    moving: Index,
    status: NDArray[np.int32],
    others: bool = False,
) -> list[Rows]:
    """From the scene of every row. others: rows that make no problem are not all there are."""
    groups: dict[tuple[str, int], list[tuple[int, Problem]]] = {}
    first: Exception | None = None
    for row in moving.tolist():
        try:
            problem = problem_of(_at_row(scene, columns, row))
        except (SimulationError, ValueError) as error:
            first = first or error
            continue
        if problem.vibrates:
            status[row] = VIBRATES
            continue
        groups.setdefault((problem.law.name, id(problem.curve)), []).append((row, problem))
    if not groups and not others and first is not None and not (status[moving] == VIBRATES).any():
        raise first
    return [_gathered(members, scene, columns) for members in groups.values()]


def _gathered(members: list[tuple[int, Problem]], scene: Scene, columns: Mapping[str, Array]) -> Rows:
    index, problems = np.array([row for row, _ in members]), [problem for _, problem in members]
    numbers = {name: np.array([getattr(problem, name) for problem in problems]) for name in _NUMBERS}
    scales = [np.array([getattr(p.scales, scale.name) for p in problems]) for scale in fields(Scales)]
    start = np.concatenate([np.frombuffer(bytes(problem.start), native.START_DTYPE) for problem in problems])
    made = Scales(*cast("Any", scales))
    zener = zener_numbers(_part(scene, columns, index), index.size)
    return Rows(index, problems[0].law.name, problems[0].curve, made, start, **numbers, zener=zener)


def _at_row(scene: Scene, columns: Mapping[str, Array], row: int) -> Scene:
    return scene_of_columns(scene, {path: cast("Any", float(values[row])) for path, values in columns.items()})


def _part(scene: Scene, columns: Mapping[str, Array], index: Index) -> Scene:
    return scene_of_columns(scene, {path: values[index] for path, values in columns.items()})


def _groups(scene: Scene, columns: Mapping[str, Array], index: Index) -> Iterator[Group]:
    """The rows `index` by law and curve. Raises ValueError where there are nearly as many curves as rows."""
    for law, own in _laws(_part(scene, columns, index), index):
        part = _part(scene, columns, own)
        made = RowLaw.of(part, law)
        for curve, places in _curves(made, own.size):
            whole = places.size == own.size
            yield Group(part if whole else _part(scene, columns, own[places]), made.part(places), curve, own[places])


def _laws(scene: Scene, index: Index) -> Iterator[tuple[AbstractLaw | type[AbstractLaw], Index]]:
    """Laws and their rows out of `index`, of which `scene` has the columns, before plasticity is tried."""
    law, wanted = scene.contact.law, scene.effects.plasticity
    if index.size == 0:
        return
    if law != "auto":
        yield (law if isinstance(law, AbstractLaw) else LAWS[law]), index
        return
    plastic = reaches_yield(scene)
    if plastic is None or wanted != "auto":
        plastic = wanted is True
    plastic = column(plastic, index.size)
    for name, mask in (("hertz", ~plastic), ("big-alabo", plastic)):
        if mask.any():
            yield LAWS[name], index[mask]


def _curves(law: RowLaw, count: int) -> Iterator[tuple[Curve, Index]]:
    """Curves and their rows. Where the stages do not depend on what varies, which most laws' do not, there is one."""
    shapes = _shapes(law)
    if not shapes:
        yield curve_of(law.at(0)), np.arange(count)
        return
    _, first, group, sizes = np.unique(
        np.stack(shapes, axis=-1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    if first.size > max(count // FEW, 1):
        raise ValueError("nearly every row has a curve of its own")
    order = np.split(np.argsort(group.ravel(), kind="stable"), np.cumsum(sizes)[:-1])
    curves: dict[int, tuple[Curve, list[Index]]] = {}
    for row, places in zip(first.tolist(), order, strict=True):
        curve = curve_of(law.at(row))
        curves.setdefault(id(curve), (curve, []))[1].append(places)
    for curve, places in curves.values():
        yield curve, np.sort(np.concatenate(places))


def _shapes(law: RowLaw) -> list[Array]:
    """The numbers, an array each, on which the stages depend and that differ from row to row."""
    shapes: list[Array] = []
    if not isinstance(law.law, AbstractLaw):
        varying = {name: value for name, value in law.values.items() if isinstance(value, np.ndarray)}
        if varying and not _stages_are_blind_to(law.law, law.values, varying):
            shapes += varying.values()
    if law.rule == "brake":
        made = law.at(slice(None))
        assert isinstance(made, BrakeUnloading)
        shapes += [made.ratio] if isinstance(made.ratio, np.ndarray) else []
    return shapes


class _Seen(Exception):
    """A law's stages have asked for a value that varies."""


def _stages_are_blind_to(law: type[AbstractLaw], values: Mapping[str, Any], varying: Mapping[str, Any]) -> bool:
    """Whether stages() never reads these fields, and so gives the same stages whatever they are."""

    def look(_: AbstractLaw) -> Any:
        raise _Seen

    metaclass: Any = type(law)  # that of abstract classes
    blind = metaclass(law.__name__, (law,), {name: property(look) for name in varying})
    made = object.__new__(blind)
    for name, value in values.items():
        if name not in varying:
            object.__setattr__(made, name, value)
    try:
        made.stages()
    except _Seen:
        return False
    return True
