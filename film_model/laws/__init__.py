"""The contact laws by name, one file each."""

from __future__ import annotations

from film_model.laws.big_alabo import BigAlabo
from film_model.laws.hertz import Hertz
from film_model.laws.law import AbstractLaw, Parameter, Power, Stage, Unloading
from film_model.laws.meyer import Meyer
from film_model.laws.stronge import Stronge

LAWS: dict[str, type[AbstractLaw]] = {law.name: law for law in (Hertz, Meyer, BigAlabo, Stronge)}
"""Every named law. A new law: its own file, one word here, one line in the tests' list."""

__all__ = [
    "LAWS",
    "AbstractLaw",
    "BigAlabo",
    "Hertz",
    "Meyer",
    "Parameter",
    "Power",
    "Stage",
    "Stronge",
    "Unloading",
]
