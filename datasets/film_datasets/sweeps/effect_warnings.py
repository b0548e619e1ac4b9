"""Warnings about effects that a sweep needs and film_model does not model, checked on a few of its impacts."""

from __future__ import annotations

import itertools

import numpy as np

from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import GRID
from film_model.base.errors import SimulationError
from film_model.effects.choose import choose
from film_model.effects.effect import NOT_MODELLED, percent
from film_model.effects.many import law_warnings_of_each
from film_model.scene import SLOWEST

MOST_CHECKED = 8
"""Impacts that are checked: each takes 0.1 ms."""


def effect_warnings(sweep: Sweep) -> list[str]:
    """Sentences about effects that matter and are not modelled, with the largest change of the summary.

    Effects vary monotonically with most swept quantities, so the corners of a grid are checked; of other designs,
    evenly spaced impacts from the first to the last.
    """
    changes: dict[str, list[float | None]] = {}
    unlikely: dict[str, str] = {}
    checked = 0
    for impact in _checked_impacts(sweep):
        scene = sweep.scene_of(impact)
        if scene is None or not scene.approach_velocity >= SLOWEST:
            continue  # its status gives the reason
        try:
            effects = choose(scene).effects
        except (SimulationError, ValueError):
            continue  # no problem can be made of the scene: its status gives the reason
        checked += 1
        unlikely.update((remark.partition(":")[0], remark) for remark in scene.remarks)
        for effect in effects:
            if effect.state == NOT_MODELLED:
                changes.setdefault(effect.name, []).append(effect.change)
    return [*unlikely.values(), *(_sentence(name, found, checked) for name, found in changes.items())]


def sweep_law_warnings(sweep: Sweep) -> list[str]:
    """Warnings about the laws, from evenly spaced impacts: the first of each kind, and in how many it occurs."""
    found: dict[str, list[str]] = {}
    places = np.unique(np.linspace(0, sweep.size - 1, 2 * MOST_CHECKED).astype(np.int64))
    values = [
        np.concatenate(parts) for parts in zip(*(sweep.values(place, 1) for place in places.tolist()), strict=True)
    ]
    numbers = [(axis, value) for axis, value in zip(sweep.axes, values, strict=True) if axis.kind != "choices"]
    outside = np.any([np.zeros(places.size, np.bool_), *(axis.outside(value) for axis, value in numbers)], axis=0)
    said: dict[int, list[str]] = {}
    for scene, index, columns in sweep.parts(values, ~outside):
        said |= zip(index.tolist(), law_warnings_of_each(scene, columns, index.size), strict=True)
    for sentence in itertools.chain.from_iterable(said[place] for place in sorted(said)):
        found.setdefault(" ".join(sentence.split()[:5]), []).append(sentence)
    return [
        f"{alike[0]} (one of {len(alike)} such impacts of the {places.size} that were looked at)"
        for alike in found.values()
    ]


def _checked_impacts(sweep: Sweep) -> list[int]:
    """Places in C order of the impacts that are checked."""
    if sweep.design != GRID:
        return np.unique(np.linspace(0, sweep.size - 1, MOST_CHECKED).astype(np.int64)).tolist()
    ends = [dict.fromkeys((0, count - 1)) for count in sweep.shape]
    corners = itertools.islice(itertools.product(*ends), MOST_CHECKED)
    return [int(np.ravel_multi_index(corner, sweep.shape)) for corner in corners]


def _sentence(name: str, changes: list[float | None], checked: int) -> str:
    known = [change for change in changes if change is not None]
    size = f"by up to {percent(max(known))}" if known else "by an amount that is not known"
    where = f"in {len(changes)} of the {checked} impacts that were looked at"
    return f"not modelled: {name.replace('_', ' ')}, which would change the summary {size} {where}"
