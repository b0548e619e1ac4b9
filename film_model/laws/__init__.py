"""The contact laws, one file each, and the list of the named ones.

To add a law (docs/adding_a_law.md): its file, its name in `LAWS`, and for editors and `from film_model import *` its
import here and its class in `__all__`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_model.base.late import LateClasses
from film_model.laws.law import AbstractLaw, Parameter, Power, Stage, Unloading
from film_model.laws.unloading import BrakeUnloading, Retrace

if TYPE_CHECKING:
    from film_model.laws.big_alabo import BigAlabo
    from film_model.laws.damped_large_slope import DampedLargeSlope
    from film_model.laws.dmt import Dmt
    from film_model.laws.elastoplastic import Elastoplastic
    from film_model.laws.hertz import Hertz
    from film_model.laws.hunt_crossley import HuntCrossley
    from film_model.laws.jackson_green import JacksonGreen
    from film_model.laws.jkr import Jkr
    from film_model.laws.kogut_etsion import KogutEtsion
    from film_model.laws.kuwabara_kono import KuwabaraKono
    from film_model.laws.large_slope import LargeSlope
    from film_model.laws.linear_dashpot import LinearDashpot
    from film_model.laws.luding import Luding
    from film_model.laws.meyer import Meyer
    from film_model.laws.rigid_plastic import RigidPlastic
    from film_model.laws.stronge import Stronge
    from film_model.laws.tabulated import Tabulated
    from film_model.laws.tan_sun import TanSun
    from film_model.laws.thornton import Thornton
    from film_model.laws.thornton_ning import ThorntonNing
    from film_model.laws.tsuji import Tsuji
    from film_model.laws.walton_braun import WaltonBraun
    from film_model.laws.yigit_christoforou import YigitChristoforou

LAWS: LateClasses[AbstractLaw] = LateClasses(
    __name__,
    (
        *("hertz", "large-slope", "meyer", "elastoplastic", "big-alabo", "stronge", "thornton", "kogut-etsion"),
        *("jackson-green", "yigit-christoforou", "rigid-plastic", "walton-braun", "luding", "tan-sun", "tabulated"),
        *("linear-dashpot", "tsuji", "damped-large-slope", "hunt-crossley", "kuwabara-kono"),
        *("jkr", "dmt", "thornton-ning"),
    ),
)
"""Every named law, in the order of lists, pictures and pages. All of these, and the tests, are made from it."""


def __getattr__(name: str) -> type[AbstractLaw]:
    return LAWS.called(name)


__all__ = [
    "LAWS",
    "AbstractLaw",
    "BigAlabo",
    "BrakeUnloading",
    "DampedLargeSlope",
    "Dmt",
    "Elastoplastic",
    "Hertz",
    "HuntCrossley",
    "JacksonGreen",
    "Jkr",
    "KogutEtsion",
    "KuwabaraKono",
    "LargeSlope",
    "LinearDashpot",
    "Luding",
    "Meyer",
    "Parameter",
    "Power",
    "Retrace",
    "RigidPlastic",
    "Stage",
    "Stronge",
    "Tabulated",
    "TanSun",
    "Thornton",
    "ThorntonNing",
    "Tsuji",
    "Unloading",
    "WaltonBraun",
    "YigitChristoforou",
]
