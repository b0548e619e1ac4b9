"""Stronge's elastic–plastic law, with its logarithmic elastoplastic stage."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from film_model.laws.law import Array, Power, Stage, Unloading
from film_model.laws.yielding import YIELD_PRESSURE_RATIO, YieldingSphere

FULLY_PLASTIC_PRESSURE = 2.8  # p̄/Y
X_PLASTIC = math.exp(3.3 * (FULLY_PLASTIC_PRESSURE / YIELD_PRESSURE_RATIO - 1.0))  # (a/a_Y)² there
FULLY_PLASTIC = 0.5 * (X_PLASTIC + 1.0)  # δ_p/δ_y = 82.511


def _elastoplastic(d: Array) -> Array:
    x = 2.0 * d - 1.0
    return x * (1.0 + np.log(x) / 3.3)


def _work(d: Array) -> Array:
    """Exact integral of (2) from δ_y, in F_y δ_y: (35/66)(x² − 1) + (25/132) x² ln x, times W_y/(F_y δ_y) = 0.4."""
    x = 2.0 * d - 1.0
    return 0.4 * (35.0 / 66.0 * (x * x - 1.0) + 25.0 / 132.0 * x * x * np.log(x))


@dataclass(frozen=True)
class Stronge(YieldingSphere):
    """Stronge 2000; Big-Alabo, Cartmell & Harrison 2017, equation (2).

        x = 2δ/δ_y − 1 = (a/a_Y)²
        f = x (1 + ln x/3.3)     from yield to x_p = exp(3.3 (2.8/1.1 − 1)) = 164, mean pressure 2.8 S_y
        f = (2.8/1.1) x          beyond
        R_d = x R                of Hertz's unloading

    Work is the exact integral, not the rounded (23). The force exceeds Hertz's until 15 δ_y; where more energy
    returns than was stored, a run warns.
    """

    name: ClassVar[str] = "stronge"
    summary: ClassVar[str] = (
        "elastic, logarithmic elastoplastic, fully plastic; Hertz unloading with R_d = (2δ/δy − 1)R"
    )
    source: ClassVar[str] = "Stronge 2000; Big-Alabo, Cartmell & Harrison 2017, equation (2)"
    validity: ClassVar[str] = "a/R below about 0.2; returns more than it stored between 1 and 2.54 V_Y"

    def stages(self) -> tuple[Stage, ...]:
        unloading = Unloading(radius_ratio=Power(constant=-1.0, slope=2.0, origin=0.0))
        pressure = FULLY_PLASTIC_PRESSURE / YIELD_PRESSURE_RATIO
        return (
            Stage("elastic", 0.0, 1.0, Power(coefficient=1.0, exponent=1.5)),
            Stage("elastoplastic", 1.0, FULLY_PLASTIC, _elastoplastic, unloading, work=_work),
            Stage(
                "fully plastic",
                FULLY_PLASTIC,
                float("inf"),
                Power(constant=pressure * X_PLASTIC, slope=2.0 * pressure),
                unloading,
            ),
        )
