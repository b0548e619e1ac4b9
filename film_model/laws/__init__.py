"""The contact laws, one file each, and the list of the named ones.

To add a law (docs/adding_a_law.md): its file, its name in `LAWS`, and for editors its import here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_model.base.late import LateClasses
from film_model.laws.law import AbstractLaw, Parameter, Power, Stage, Unloading
from film_model.laws.unloading import BrakeUnloading, Retrace

if TYPE_CHECKING:
    from film_model.laws.big_alabo import BigAlabo as BigAlabo
    from film_model.laws.damped_large_slope import DampedLargeSlope as DampedLargeSlope
    from film_model.laws.dmt import Dmt as Dmt
    from film_model.laws.elastoplastic import Elastoplastic as Elastoplastic
    from film_model.laws.hertz import Hertz as Hertz
    from film_model.laws.hunt_crossley import HuntCrossley as HuntCrossley
    from film_model.laws.jackson_green import JacksonGreen as JacksonGreen
    from film_model.laws.jkr import Jkr as Jkr
    from film_model.laws.kogut_etsion import KogutEtsion as KogutEtsion
    from film_model.laws.kuwabara_kono import KuwabaraKono as KuwabaraKono
    from film_model.laws.large_slope import LargeSlope as LargeSlope
    from film_model.laws.linear_dashpot import LinearDashpot as LinearDashpot
    from film_model.laws.luding import Luding as Luding
    from film_model.laws.meyer import Meyer as Meyer
    from film_model.laws.rigid_plastic import RigidPlastic as RigidPlastic
    from film_model.laws.stronge import Stronge as Stronge
    from film_model.laws.tabulated import Tabulated as Tabulated
    from film_model.laws.tan_sun import TanSun as TanSun
    from film_model.laws.thornton import Thornton as Thornton
    from film_model.laws.thornton_ning import ThorntonNing as ThorntonNing
    from film_model.laws.tsuji import Tsuji as Tsuji
    from film_model.laws.walton_braun import WaltonBraun as WaltonBraun
    from film_model.laws.yigit_christoforou import YigitChristoforou as YigitChristoforou

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

__getattr__ = LAWS.called

__all__ = ["LAWS", "AbstractLaw", "BrakeUnloading", "Parameter", "Power", "Retrace", "Stage", "Unloading"]
__all__ += LAWS.class_names  # pyright: ignore[reportUnsupportedDunderAll]
