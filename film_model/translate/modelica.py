"""Modelica: `ElastoGap` of the Modelica Standard Library, a power-law spring whose damper never exceeds it."""

from __future__ import annotations

from typing import Any

import numpy as np

from film_model.translate.law import Engine, EngineLaw, Pair, Parameter, Values


def _force(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    """f_c + f_d with f_c = c δ^n and f_d = d δ', |f_d| <= f_c."""
    spring = values["c"] * np.power(depth, values["n"])
    return spring + np.clip(values["d"] * rate, -spring, spring)


def _paste(pair: Pair, values: Values) -> str:
    return f"""Modelica.Mechanics.Translational.Components.ElastoGap contact(
  c = {values["c"]:.6g}, d = {values["d"]:.6g}, n = {values["n"]:.6g}, s_rel0 = {pair.ball_radius:.6g});
// flange_a at the target's surface, flange_b at the ball's centre; the ball's mass is {pair.ball_mass:.6g} kg"""


ELASTO_GAP = EngineLaw(
    name="elasto-gap",
    formula="F = c δ^n + f_d, f_d = d δ' but |f_d| <= c δ^n",
    source="Modelica Standard Library, Modelica.Mechanics.Translational.Components.ElastoGap",
    parameters=(
        Parameter("c", "N/m^n", "spring constant", 1e-12, logarithmic=True),
        Parameter("d", "N s/m", "damping constant"),
        Parameter("n", "", "exponent", 1.0, 3.0),
    ),
    force=_force,
    start=lambda pair, middle: {"c": middle.stiffness(1.5), "d": middle.damping(pair.mass), "n": 1.5},
    paste=_paste,
    notes=("c is per metre to the power n: with the default n = 1 another c is closest",),
)

MODELICA = Engine("modelica", "Modelica", (ELASTO_GAP,))
