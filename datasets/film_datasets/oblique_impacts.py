"""Impacts with friction: results along the surface beside those of the summary, one value per impact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from film_datasets.impacts import simulate_impacts
from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.oblique.result import OBLIQUE
from film_model.scene import Scene
from film_model.solve.history import SUMMARY

RESULTS: dict[str, tuple[str, str]] = {**SUMMARY, **OBLIQUE}
"""Results of the normal motion and along the surface, with dimension and meaning."""


def results_of(scene: Scene, numbers: Mapping[str, Array], names: Sequence[str]) -> dict[str, Array]:
    """Results `names` of impacts in which some numbers vary, SI by path; NaN where there is none.

    Raises SimulationError if friction is not given.
    """
    asked = [name for name in names if name in OBLIQUE]
    if asked and scene.contact.friction is None and "contact.friction" not in numbers:
        raise SimulationError(f"{', '.join(asked)}: friction in [contact] is needed, with a value to begin with")
    found = simulate_impacts(scene, numbers)
    together = {**found.summary, **found.friction}
    return {name: together[name] for name in names}
