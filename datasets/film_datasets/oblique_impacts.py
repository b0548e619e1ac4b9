"""Impacts with friction: results along the surface beside those of the summary, one value per impact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from film_datasets.impacts import scene_with_numbers, simulate_impacts
from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.oblique.result import OBLIQUE
from film_model.scene import Scene
from film_model.solve.history import SUMMARY
from film_model.solve.simulate import simulate_quietly

RESULTS: dict[str, tuple[str, str]] = {**SUMMARY, **OBLIQUE}
"""Results of the normal motion and along the surface, with dimension and meaning."""

TANGENTIAL = ("contact.friction", "impactor.spin", "impactor.inertia")
"""Numbers of a scene on which the normal motion does not depend."""


def results_of(
    scene: Scene, numbers: Mapping[str, Array], names: Sequence[str], needed: NDArray[np.bool_] | None = None
) -> dict[str, Array]:
    """Results `names` of impacts in which some numbers vary, SI by path; NaN where there is none.

    Those of the normal motion are computed on arrays, those along the surface one by one, of the `needed` impacts.
    Raises SimulationError if friction is not given, or no impact with friction can be simulated.
    """
    smooth = scene.replace(dict.fromkeys(TANGENTIAL))
    normal = {path: values for path, values in numbers.items() if path not in TANGENTIAL}
    count = next(iter(numbers.values())).size
    found, asked = dict[str, Array](), [name for name in names if name in OBLIQUE]
    if normal and len(asked) < len(names):
        found = simulate_impacts(smooth, normal).summary
    elif len(asked) < len(names):
        values = simulate_quietly(smooth).summary
        found = {name: np.full(count, np.nan if value is None else value) for name, value in values.items()}
    if asked and scene.contact.friction is None and "contact.friction" not in numbers:
        raise SimulationError(f"{', '.join(asked)}: friction in [contact] is needed, with a value to begin with")
    rows = np.arange(count) if needed is None else np.flatnonzero(needed)
    columns = _along_the_surface(scene, numbers, asked, rows, count) if asked else {}
    return {name: columns[name] if name in columns else found[name] for name in names}


def _along_the_surface(
    scene: Scene, numbers: Mapping[str, Array], names: Sequence[str], rows: NDArray[np.intp], count: int
) -> dict[str, Array]:
    columns, failed = {name: np.full(count, np.nan) for name in names}, list[SimulationError]()
    for row in rows.tolist():
        own = scene_with_numbers(scene, {path: float(values[row]) for path, values in numbers.items()})
        try:
            oblique = simulate_quietly(own).oblique
        except SimulationError as error:
            failed.append(error)
            continue
        if oblique is not None:  # something slides
            for name in names:
                columns[name][row] = oblique.summary[name]
    if failed and len(failed) == rows.size:
        raise failed[0]
    return columns
