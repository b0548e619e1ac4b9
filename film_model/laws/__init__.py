"""The contact laws, one file each, and the list of the named ones.

To add a law (docs/adding_a_law.md): its file, its import here, and its name in `LAWS` and in `__all__`.
"""

from __future__ import annotations

from film_model.laws.big_alabo import BigAlabo
from film_model.laws.dmt import Dmt
from film_model.laws.hertz import Hertz
from film_model.laws.hunt_crossley import HuntCrossley
from film_model.laws.jackson_green import JacksonGreen
from film_model.laws.jkr import Jkr
from film_model.laws.kogut_etsion import KogutEtsion
from film_model.laws.kuwabara_kono import KuwabaraKono
from film_model.laws.law import AbstractLaw, Parameter, Power, Stage, Unloading
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
from film_model.laws.unloading import BrakeUnloading, Retrace
from film_model.laws.walton_braun import WaltonBraun
from film_model.laws.yigit_christoforou import YigitChristoforou

LAWS: dict[str, type[AbstractLaw]] = {
    law.name: law
    for law in (
        *(Hertz, Meyer, BigAlabo, Stronge, Thornton, KogutEtsion, JacksonGreen, YigitChristoforou),
        *(RigidPlastic, WaltonBraun, Luding, TanSun, Tabulated),
        *(LinearDashpot, Tsuji, HuntCrossley, KuwabaraKono, Jkr, Dmt, ThorntonNing),
    )
}
"""Every named law, in the order of lists, pictures and pages. All of these, and the tests, are made from it."""

__all__ = [
    "LAWS",
    "AbstractLaw",
    "BigAlabo",
    "BrakeUnloading",
    "Dmt",
    "Hertz",
    "HuntCrossley",
    "JacksonGreen",
    "Jkr",
    "KogutEtsion",
    "KuwabaraKono",
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
