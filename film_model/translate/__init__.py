"""Parameters with which the contact laws of other engines reproduce an impact: one engine per file, and their list.

A new engine is one file with an `Engine`, and its name below.
"""

from __future__ import annotations

from film_model.base.errors import did_you_mean
from film_model.translate.adams import ADAMS
from film_model.translate.bullet import BULLET
from film_model.translate.chrono import CHRONO
from film_model.translate.drake import DRAKE
from film_model.translate.fit import Translation, contact_for
from film_model.translate.lammps import LAMMPS
from film_model.translate.law import Engine, EngineLaw
from film_model.translate.liggghts import LIGGGHTS
from film_model.translate.modelica import MODELICA
from film_model.translate.mujoco import MUJOCO
from film_model.translate.newton import NEWTON
from film_model.translate.yade import YADE

_ALL = (MUJOCO, DRAKE, BULLET, NEWTON, CHRONO, ADAMS, MODELICA, LAMMPS, YADE, LIGGGHTS)
ENGINES = {engine.name: engine for engine in _ALL}
"""The engines, by the name that is typed."""


def engine_named(name: str) -> Engine:
    """The engine of that name. Raises ValueError with the list."""
    if name not in ENGINES:
        raise ValueError(f'unknown engine "{name}": choose {", ".join(ENGINES)}{did_you_mean(name, ENGINES)}')
    return ENGINES[name]


__all__ = ["ENGINES", "Engine", "EngineLaw", "Translation", "contact_for", "engine_named"]
