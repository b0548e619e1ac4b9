"""Yigit and Christoforou: elastic, then a line, and the elastic curve moved down."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from film_model.laws.law import Power, Stage, Unloading
from film_model.laws.yielding import YieldingSphere


@dataclass(frozen=True)
class YigitChristoforou(YieldingSphere):
    """Yigit & Christoforou 1994, Compos. Eng. 4:1143.

        F = K δ^{3/2},  K = (4/3) E √R
        F = F_y + K_y (δ − δ_y),  K_y = (3/2) K √δ_y,  δ_y = 0.6806 π² R S_y²/E²     beyond δ_y, mean pressure 1.1 S_y
        F = K (δ^{3/2} − δ_m^{3/2}) + F_m,  δ_f^{3/2} = δ_m^{3/2} − F_m/K           unloading

    For laminates take twice the shear strength as S_y.
    """

    name: ClassVar[str] = "yigit-christoforou"
    summary: ClassVar[str] = "elastic, then linear with the slope at yield; unloads along Hertz's curve shifted down"
    source: ClassVar[str] = "Yigit & Christoforou 1994, Compos. Eng. 4:1143"
    validity: ClassVar[str] = "a/R below about 0.2; moderate plasticity"

    def stages(self) -> tuple[Stage, ...]:
        shifted = Unloading(shifted=Power(constant=1.0))
        return (
            Stage("elastic", 0.0, 1.0, Power(coefficient=1.0, exponent=1.5)),
            Stage("plastic", 1.0, float("inf"), Power(constant=1.0, slope=1.5), shifted),
        )
