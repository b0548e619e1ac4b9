"""Adams: the function IMPACT(x, x', x1, k, e, cmax, d), a power-law spring and a damper that fades in."""

from __future__ import annotations

from typing import Any

import numpy as np

from film_model.translate.law import Engine, EngineLaw, Pair, Parameter, Values


def step(x: Any, full: Any) -> Any:
    """STEP(x, 0, 0, full, 1): the cubic 3u² − 2u³ of u = x/full, from 0 to 1."""
    u = np.clip(x / full, 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)


def _paste(pair: Pair, values: Values) -> str:
    k, e, damping, full = (float(values[name]) for name in ("k", "e", "cmax", "d"))
    millimetres = f"{1e3 * pair.ball_radius:.6g}, {k * 1e-3**e:.6g}, {e:.6g}, {1e-3 * damping:.6g}, {1e3 * full:.6g}"
    return f"""! x: distance of the ball's centre from the target's surface, vx: its rate
! SI (m, N, s):
IMPACT(x, vx, {pair.ball_radius:.6g}, {k:.6g}, {e:.6g}, {damping:.6g}, {full:.6g})
! MMKS (mm, N, s), Adams' default:
IMPACT(x, vx, {millimetres})"""


IMPACT = EngineLaw(
    name="impact",
    formula="F = k δ^e + cmax STEP(δ, 0, 0, d, 1) δ'",
    source="Adams Solver manual, functions IMPACT and STEP",
    parameters=(
        Parameter("k", "N/m^e", "stiffness", 1e-12, logarithmic=True),
        Parameter("e", "", "exponent", 1.0, 3.0),
        Parameter("cmax", "N s/m", "largest damping coefficient"),
        Parameter("d", "m", "penetration at which damping is full", 0.05, 100.0, True, per_depth=True),
    ),
    force=lambda _, v, depth, rate: v["k"] * np.power(depth, v["e"]) + v["cmax"] * step(depth, v["d"]) * rate,
    start=lambda pair, middle: {
        "k": middle.stiffness(1.5),
        "e": 1.5,
        "cmax": 1.5 * middle.damping(pair.mass),
        "d": 0.3 * middle.depth,
    },
    paste=_paste,
    notes=("k is per metre to the power e: in millimetres it is another number, given below",),
)

ADAMS = Engine("adams", "Adams", (IMPACT,))
