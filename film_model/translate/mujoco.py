"""MuJoCo: a soft constraint whose impedance grows with depth (solref, solimp)."""

from __future__ import annotations

from typing import Any

import numpy as np

from film_model.translate.law import Engine, EngineLaw, Middle, Pair, Parameter, Values

IMPEDANCE = 0.95
"""solimp's dwidth, MuJoCo's default. The force depends on d(r)/dwidth only, so this value is free."""


def impedance(values: Values, depth: Any) -> Any:
    """d(r): d0 at the surface, `IMPEDANCE` from `width` on, between them a sigmoid of two powers."""
    x = np.minimum(depth / values["width"], 1.0)
    p, middle = values["power"], values["midpoint"]
    rising = np.power(x, p) / np.power(middle, p - 1.0)
    falling = 1.0 - np.power(1.0 - x, p) / np.power(1.0 - middle, p - 1.0)
    return values["d0"] + (IMPEDANCE - values["d0"]) * np.where(x <= middle, rising, falling)


def _force(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    """m d (b δ' + k δ): a1 + d (b v + k r) = (1 − d) a0 with a0 = 0, b = damping/dw, k = stiffness d/dw²."""
    d = impedance(values, depth)
    b, k = values["damping"] / IMPEDANCE, values["stiffness"] * d / IMPEDANCE**2
    return pair.mass * d * (b * rate + k * depth)


def _start(pair: Pair, middle: Middle) -> dict[str, float]:
    stiffness = 1.4 * middle.stiffness(1.0) / pair.mass
    return {
        "stiffness": stiffness,
        "damping": 2.0 * middle.damping_ratio * stiffness**0.5,
        "d0": 0.4,
        "width": 3.0 * middle.depth,
        "midpoint": 0.1,
        "power": 2.5,
    }


def _paste(pair: Pair, values: Values) -> str:
    v = {name: f"{value:.6g}" for name, value in values.items()}
    contact = (
        f'solref="-{v["stiffness"]} -{v["damping"]}"\n'
        f'        solimp="{v["d0"]} {IMPEDANCE} {v["width"]} {v["midpoint"]} {v["power"]}"'
    )
    if pair.fixed:
        other = f'<geom name="target" {_shape(pair)}/>'
    else:
        other = (
            f'<body pos="0 0 {-pair.target_radius:.6g}">\n      <freejoint/>\n'
            f'      <geom name="target" type="sphere" size="{pair.target_radius:.6g}" mass="{pair.target_mass:.6g}"/>\n'
            "    </body>"
        )
    return f"""<mujoco>
  <option timestep="{_step(pair, values):.1e}" cone="elliptic"/>
  <worldbody>
    {other}
    <body name="ball" pos="0 0 {pair.ball_radius:.6g}">
      <freejoint/>
      <geom name="ball" type="sphere" size="{pair.ball_radius:.6g}" mass="{pair.ball_mass:.6g}"/>
    </body>
  </worldbody>
  <contact>
    <pair geom1="ball" geom2="target" condim="1"
        {contact}/>
  </contact>
</mujoco>"""


def _shape(pair: Pair) -> str:
    if np.isinf(pair.target_radius):
        return 'type="plane" size="1 1 1"'
    return f'type="sphere" size="{pair.target_radius:.6g}" pos="0 0 {-pair.target_radius:.6g}"'


def _step(pair: Pair, values: Values) -> float:
    """A two-hundredth of the period of the constraint's oscillation: about 100 steps in the shortest contact."""
    return 2.0 * np.pi / float(values["stiffness"]) ** 0.5 / 200.0


CONSTRAINT = EngineLaw(
    name="constraint",
    formula="F = m d (b δ' + k d δ), b = damping/dw, k = stiffness/dw², impedance d(δ) from d0 to dw at depth width",
    source="MuJoCo documentation, Computation: Constraint model; Modeling: Solver parameters (solref < 0, solimp)",
    parameters=(
        Parameter("stiffness", "1/s^2", "solref[0], with a minus sign", 1e-6, logarithmic=True),
        Parameter("damping", "1/s", "solref[1], with a minus sign"),
        Parameter("d0", "", "solimp[0], impedance at the surface", 0.001, IMPEDANCE),
        Parameter("width", "m", "solimp[2], depth of full impedance", 0.1, 1e4, True, per_depth=True),
        Parameter("midpoint", "", "solimp[3]", 0.001, 0.95),
        Parameter("power", "", "solimp[4]", 1.0, 6.0),
    ),
    force=_force,
    start=_start,
    paste=_paste,
    notes=(
        "solref is per unit mass: another mass needs another fit",
        "with friction use the elliptic cone: with the pyramidal one the same parameters give another force",
        "the integrator is of first order: 100 steps in the shortest contact change the force by about 0.2 %",
    ),
)

MUJOCO = Engine("mujoco", "MuJoCo", (CONSTRAINT,))
