"""The problems of many impacts of one scene, in which columns with one value per impact replace some numbers.

Impacts that share a law and a curve form one problem with arrays; its effects are decided together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import ALL, Array, Index, all_of, column
from film_model.base.errors import NO_VELOCITY, VIBRATES, SimulationError
from film_model.effects import rate_hardening
from film_model.effects.choose import decided, problem_of
from film_model.effects.edge_effects import ways_of
from film_model.effects.law_range import law_warnings
from film_model.effects.target_motion import Support
from film_model.laws import AbstractLaw
from film_model.laws.unloading import BrakeUnloading
from film_model.problem.families import LAST_PAGE, page_number
from film_model.problem.law_of_scene import SceneLaw, laws_of
from film_model.problem.problem import Given, Impacts, Problem
from film_model.problem.varied import fitted_by
from film_model.scene import Scene
from film_model.scene.columns import scene_of_columns, scene_of_row

FEW = 4
"""If fewer impacts than this share a curve, on average, they are set up one by one."""

_OF_THE_IMPACTOR = ("impactor.velocity", "impactor.mass")
_ASKED = 16  # if the target vibrates in so many impacts, evenly chosen by energy, then in all between them

MOST_KEPT = 1000
"""Problems of impacts on targets that vibrate that are kept, of some kB each."""


def problems_of(
    scene: Scene,
    columns: Mapping[str, Array],
    count: int,
    status: NDArray[np.int32] | None = None,
    vibrating: dict[int, Problem] | None = None,
) -> list[Problem]:
    """The problems of `count` impacts of a scene, some of whose numbers are columns (path → SI values, one each).

    Omitted are impacts that do not approach, those whose target vibrates, which have no lines, and those whose numbers
    raise an error; status is set to `NO_VELOCITY` and `VIBRATES` for the first two. If no impact remains because of
    errors, the first error is raised. vibrating: gets problems of the second, up to `MOST_KEPT`, by their rows.
    """
    status = np.zeros(count, np.int32) if status is None else status
    vibrating = {} if vibrating is None else vibrating
    part, found = scene_of_columns(scene, columns), list[Problem]()
    approaches = column(part.approach_velocity, count) > 0.0
    moving = approaches.nonzero()[0]
    if moving.size < count:
        status[~approaches] = NO_VELOCITY
        part = _part(scene, columns, moving)
    if moving.size == 1:  # arrays take three times as long
        return _one_by_one(scene, columns, moving, status, vibrating)
    try:
        groups = _groups(scene, columns, moving, part)
        found = [problem for light, support in groups for problem, *_ in decided(light, support)]
    except (TypeError, ValueError, SimulationError):  # a law or a target that accepts numbers only
        return _one_by_one(scene, columns, moving, status, vibrating)
    for problem in found:
        approaches[rows_of(problem)] = False
    left = approaches.nonzero()[0]
    return found + (_one_by_one(scene, columns, left, status, vibrating, bool(found)) if left.size else [])


def law_warnings_of_each(scene: Scene, columns: Mapping[str, Array], count: int) -> list[list[str]]:
    """The warnings about the law of each of `count` impacts, as :func:`problems_of` has them; none if it fails."""
    found, status, known = [list[str]() for _ in range(count)], np.zeros(count, np.int32), dict[int, Problem]()
    try:
        problems = problems_of(scene, columns, count, status, known)
    except (SimulationError, ValueError):
        return found
    for problem in problems:
        depths = problem.trial.summary.maximum_indentation
        for place, row in enumerate(rows_of(problem).tolist()):
            found[row] = law_warnings(problem.part(np.array([place])).as_first(), depths[place : place + 1])
    for row in (status == VIBRATES).nonzero()[0].tolist():
        found[row] = law_warnings(known.get(row) or problem_of(scene_of_row(scene, columns, row)))
    return found


def rows_of(problem: Problem) -> Index:
    """The indices of the impacts of a problem of many."""
    return cast("Index", problem.impacts.index)


def _one_by_one(
    scene: Scene,
    columns: Mapping[str, Array],
    rows: Index,
    status: NDArray[np.int32],
    vibrating: dict[int, Problem],
    others: bool = False,
) -> list[Problem]:
    """Problems from one scene per row. vibrating: as of `problems_of`. others: whether problems of other rows exist."""
    groups: dict[tuple[Any, ...], list[tuple[int, Problem]]] = {}
    first: Exception | None = None
    if set(columns) <= set(_OF_THE_IMPACTOR) and rows.size > 4 * _ASKED and _all_vibrate(scene, columns, rows):
        status[rows] = VIBRATES
        return []
    for row in rows.tolist():
        try:
            problem = problem_of(scene_of_row(scene, columns, row))
        except (SimulationError, ValueError) as error:
            first = first or error
            continue
        if problem.vibrates:
            status[row] = VIBRATES
            if len(vibrating) < MOST_KEPT:
                vibrating[row] = problem
            continue
        groups.setdefault((problem.law.name, id(problem.curve), problem.relaxation), []).append((row, problem))
    if not groups and not others and first is not None and not (status[rows] == VIBRATES).any():
        raise first
    return [_gathered(members, scene, columns) for members in groups.values()]


def _all_vibrate(scene: Scene, columns: Mapping[str, Array], rows: Index) -> bool:
    """Whether the target vibrates in each of some impacts, from the one with the least to that with the most energy."""
    part = _part(scene, columns, rows)
    order = np.argsort(np.broadcast_to(part.approach_velocity**2 * part.mass, rows.shape), kind="stable")
    for row in rows[order[np.linspace(0, rows.size - 1, _ASKED).astype(int)]].tolist():
        try:
            if not problem_of(scene_of_row(scene, columns, row)).vibrates:
                return False
        except (SimulationError, ValueError):
            return False
    return True


def _gathered(members: list[tuple[int, Problem]], scene: Scene, columns: Mapping[str, Array]) -> Problem:
    """One problem with arrays, from several problems that share a curve."""
    index, problems = np.array([row for row, _ in members]), [problem for _, problem in members]
    first = problems[0]

    names = ("gamma", "load", "damping", "approach", "drift", "share", "mass")
    return replace(
        first,
        impacts=Impacts.several(scene, _law_of_all(problems), index, _picked(columns, index)),
        scales=type(first.scales)(*map(np.array, zip(*(problem.scales for problem in problems), strict=True))),
        given=Given(*map(np.array, zip(*(problem.given for problem in problems), strict=True))),
        loaded=any(problem.loaded for problem in problems),
        **{name: np.array([getattr(problem, name) for problem in problems]) for name in names},
    )


def _law_of_all(problems: list[Problem]) -> SceneLaw:
    """The law of problems that share a curve, with the strength of each."""
    laws = [problem.impacts.law for problem in problems]
    strengths = [law.values.get("yield_strength") for law in laws]
    if None in strengths:
        return laws[0]
    return replace(laws[0], values={**laws[0].values, "yield_strength": np.array(strengths)})


def _part(scene: Scene, columns: Mapping[str, Array], index: Index) -> Scene:
    return scene_of_columns(scene, _picked(columns, index))


def _picked(columns: Mapping[str, Array], index: Index) -> dict[str, Array]:
    return {path: values[index] for path, values in columns.items()}


def _groups(scene: Scene, columns: Mapping[str, Array], index: Index, part: Scene) -> Iterator[tuple[Problem, Support]]:
    """The problems of the impacts of `index` by law and curve, without weight, and how their targets move.

    part: has their columns. Omitted are impacts that :func:`ways_of` omits.

    Raises ValueError where there are nearly as many curves as impacts.
    """
    for law, places in laws_of(part) if index.size else ():
        own = index if all_of(places) else index[places]
        picked = columns if own.size == len(next(iter(columns.values()))) else _picked(columns, own)
        varied = part if own.size == index.size else scene_of_columns(scene, picked)
        slow = Impacts.several(scene, SceneLaw.of(varied, law).reduced(), own, picked, varied)
        for places in _shared_curves(slow):
            for static, support, _ in ways_of(slow if places is ALL else _alike(slow, places)):
                for impacts, same in _by_curve(_hardened(static, support), static):
                    yield _light(impacts, support.part(same)), support.part(same)


def _by_curve(impacts: Impacts, shared: Impacts) -> Iterator[tuple[Impacts, Any]]:
    """The impacts by curve, and their places. shared: those with the strength of slow loading, which share a curve."""
    if impacts is shared:
        yield impacts, ALL
        return
    for places in _shared_curves(impacts):
        yield _alike(impacts, places), places


def _alike(impacts: Impacts, places: Any) -> Impacts:
    """Some impacts, with a number in place of what they have in common."""
    part = impacts.part(places)
    return part.under(part.law.reduced())


def _light(impacts: Impacts, support: Support) -> Problem:
    """The problem of impacts without weight."""
    return impacts.problem(support.impedance, impacts.column(0.0), support.compliance)


def _hardened(impacts: Impacts, support: Support) -> Impacts:
    """The impacts, those faster than 1/s with the yield strength at their own strain rate."""
    static, count = impacts.law, impacts.numbers.mass.size

    def rates(factor: Array) -> Array:
        strong, found = impacts.under(static.strengthened(factor)), np.empty(count)
        for places in _shared_curves(strong):
            found[places] = rate_hardening.strain_rate(_light(_alike(strong, places), support.part(places)))
        return found

    factor = rate_hardening.used(impacts, rates, np.ones(count))
    return impacts if factor is None else impacts.under(static.strengthened(factor))


def _shared_curves(*impacts: Impacts) -> Iterator[Any]:
    """The places of the impacts of each curve, if they are given under several laws under each; `ALL` if they share
    one. Most laws have stages that do not depend on the varied values."""
    shapes = list[Array]()
    if impacts[0].numbers.mass.size > 1:
        shapes = [shape for under in impacts for shape in (*curve_keys(under), *_few_valued(under.law))]
    if all(all_of(shape == shape[0]) for shape in shapes):
        yield ALL
        return
    _, first, group, sizes = np.unique(
        np.stack(shapes, axis=-1), axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    if first.size > max(group.size // FEW, 1):
        raise ValueError("nearly every impact has a curve of its own")
    for places in np.split(np.argsort(group.ravel(), kind="stable"), np.cumsum(sizes)[:-1]):
        yield np.sort(places)


def curve_keys(impacts: Impacts) -> list[Array]:
    """The varied values on which the curve depends, one array each; for a family of curves, the page."""
    shapes: list[Array] = []
    law, kind = impacts.law, impacts.law.law
    if not isinstance(kind, AbstractLaw):
        read = law.read
        if law.rule is None and read.keys() & {*kind.shaped_by}:
            shape = np.asarray(law.at(ALL).shape)
            page = page_number(shape)
            shapes.append(np.where((page >= 0) & (page < LAST_PAGE), page, shape))  # others have curves of their own
        elif read and not (law.rule is None and kind.shaped_by):
            shapes += [] if impacts.own.varied is not None else read.values()
    if law.rule == "brake":
        made = law.at(ALL)
        assert isinstance(made, BrakeUnloading)
        shapes += [made.ratio] if isinstance(made.ratio, np.ndarray) else []
    return shapes


def _few_valued(law: SceneLaw) -> list[Array]:
    """Numbers beside the shape that have one or two values, such as Poisson's ratio of the body that yields first.

    With one value each, laws are a family over one number, which takes less time.
    """
    beside = fitted_by(law).values()
    return [values for values in beside if np.unique(values[:_ASKED]).size <= 2 and np.unique(values).size <= 2]
