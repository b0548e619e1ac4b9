"""Effects that the impacts of a sweep need and a simulation has not, said of a few of its impacts."""

from __future__ import annotations

import itertools

import numpy as np

from film_datasets.design import GRID
from film_datasets.sweeps import Sweep
from film_model.effects import NOT_MODELLED, effects_of, percent
from film_model.errors import SimulationError

MOST_ROWS = 8
"""Impacts of a sweep that are looked at: it is 0.1 ms for each."""


def unmodelled(made: Sweep) -> list[str]:
    """Sentences on effects that matter and are not computed, and by how much at most.

    Effects grow or fall steadily with what is swept, so the corners of a grid are looked at; of other designs, impacts
    from the first to the last.
    """
    rows = _rows(made)
    found: dict[str, list[float | None]] = {}
    looked = 0
    for row in rows:
        scene = made.scene_of(row)
        if scene is None or not scene.approach_velocity > 0.0:
            continue  # its status says why, as do those of impacts that make no problem
        try:
            effects = effects_of(scene)
        except (SimulationError, ValueError):
            continue
        looked += 1
        for effect in effects:
            if effect.state == NOT_MODELLED:
                found.setdefault(effect.name, []).append(effect.change)
    return [_sentence(name, changes, looked) for name, changes in found.items()]


def _rows(made: Sweep) -> list[int]:
    """Places in C order of the impacts that are looked at."""
    if made.design != GRID:
        return np.unique(np.linspace(0, made.size - 1, MOST_ROWS).astype(np.int64)).tolist()
    ends = [dict.fromkeys((0, count - 1)) for count in made.shape]
    corners = itertools.islice(itertools.product(*ends), MOST_ROWS)
    return [int(np.ravel_multi_index(corner, made.shape)) for corner in corners]


def _sentence(name: str, changes: list[float | None], looked: int) -> str:
    known = [change for change in changes if change is not None]
    size = f"by up to {percent(max(known))}" if known else "by an amount that is not known"
    where = f"in {len(changes)} of the {looked} impacts that were looked at"
    return f"not modelled: {name.replace('_', ' ')}, which would change the summary {size} {where}"
