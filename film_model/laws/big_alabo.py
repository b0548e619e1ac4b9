"""Big-Alabo, Harrison and Cartmell's elastoplastic law: four loading stages of Meyer's form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.law import Parameter, Power, Stage, Unloading
from film_model.laws.yielding import YieldingSphere

FULLY_PLASTIC = 82.5  # δ_p/δ_y


@dataclass(frozen=True)
class BigAlabo(YieldingSphere):
    """Big-Alabo, Cartmell & Harrison 2017, equations (19) and (20).

        f = F/F_y, d = δ/δ_y
        f = d^{3/2}                         d ≤ 1
        f = 1 + (d − 1)^{3/2}               d ≤ 13.93
        f = f_tep + 5.40 (d − 13.93)        d ≤ 82.5
        f = f_p + (4.6/1.1)(d − 82.5)       beyond

    Unloading is Hertz's with the deformed radius R_d of (20). constants "continuous": f_tep = 1 + 12.93^{3/2},
    f_p = f_tep + 5.40 · 68.57. "printed": F(δ_p) = 70.0 K_l δ_y + 47.6 K δ_y^{3/2}, a jump by 1.9 %, and
    δ_tep − δ_y = 11.93 δ_y in (20), as in the paper's Table 3. Restitution falls until 1.7 V_Y and rises until 8.5 V_Y.
    """

    name: ClassVar[str] = "big-alabo"
    summary: ClassVar[str] = "elastic, two elastoplastic and a fully plastic stage; Hertz unloading with R_d"
    source: ClassVar[str] = "Big-Alabo, Cartmell & Harrison 2017, equations (19) and (20)"
    validity: ClassVar[str] = (
        "a/R below about 0.2; the force has a plateau above yield, so restitution is not monotone in velocity"
    )
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "constants": Parameter(
            "stage constants: continuous force, or as printed in the paper",
            choices=("continuous", "printed"),
            required=False,
        )
    }

    constants: str = "continuous"

    def stages(self) -> tuple[Stage, ...]:
        linear_slope = 5.40  # K_l/(K √δ_y)
        transition = 13.93  # δ_tep/δ_y
        printed = self.constants == "printed"
        f_transition = 1.0 + (transition - 1.0) ** 1.5
        f_plastic = f_transition + linear_slope * (FULLY_PLASTIC - transition)
        if printed:
            f_plastic = 70.0 * linear_slope + 47.6
        width = 11.93 if printed else transition - 1.0
        radius = (
            Power(constant=1.0, coefficient=width**-1.5, exponent=1.5),
            Power(constant=2.0, slope=0.8 / (FULLY_PLASTIC - transition)),
            Power(constant=2.8),
        )
        # slope K_p δ_y/F_y, from K_p = 4.6 π R S_y and F_y = 1.1 π R S_y δ_y
        return (
            Stage("elastic", 0.0, 1.0, Power(coefficient=1.0, exponent=1.5)),
            Stage(
                "elastoplastic",
                1.0,
                transition,
                Power(constant=1.0, coefficient=1.0, exponent=1.5),
                Unloading(radius_ratio=radius[0]),
            ),
            Stage(
                "linear elastoplastic",
                transition,
                FULLY_PLASTIC,
                Power(constant=f_transition, slope=linear_slope),
                Unloading(radius_ratio=radius[1]),
            ),
            Stage(
                "fully plastic",
                FULLY_PLASTIC,
                float("inf"),
                Power(constant=f_plastic, slope=4.6 / 1.1),
                Unloading(radius_ratio=radius[2]),
            ),
        )
