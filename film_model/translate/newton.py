"""Newton: the penalty contact of its semi-implicit solver, a spring and a dashpot that acts on approach only."""

from __future__ import annotations

import math

import numpy as np

from film_model.translate.law import Engine, EngineLaw, Pair, Parameter, Values


def _paste(pair: Pair, values: Values) -> str:
    numbers = f"ke={values['ke']:.6g}, kd={values['kd']:.6g}, kf=0, mu={pair.friction or 0.0:.6g}, density=0"
    radius = pair.target_radius
    if math.isinf(radius):
        other = "builder.add_ground_plane(cfg=contact)"
    elif pair.fixed:
        other = f"""builder.add_shape_sphere(-1, xform=wp.transform((0, 0, {-radius:.6g}), wp.quat_identity()),
    radius={radius:.6g}, cfg=contact)"""
    else:
        other = _body("target", -radius, pair.target_mass, radius)
    return f"""contact = newton.ModelBuilder.ShapeConfig({numbers})
{_body("ball", pair.ball_radius, pair.ball_mass, pair.ball_radius)}
{other}
# then newton.solvers.SolverSemiImplicit(builder.finalize())"""


def _body(name: str, height: float, mass: float, radius: float) -> str:
    """A solid sphere with its centre at a height."""
    inertia = f"{0.4 * mass * radius**2:.6g}"
    return f"""{name} = builder.add_body(xform=wp.transform((0, 0, {height:.6g}), wp.quat_identity()), mass={mass:.6g},
    inertia=wp.mat33({inertia}, 0, 0, 0, {inertia}, 0, 0, 0, {inertia}))
builder.add_shape_sphere({name}, radius={radius:.6g}, cfg=contact)"""


SEMI_IMPLICIT = EngineLaw(
    name="semi-implicit",
    formula="F = ke δ + kd max(δ', 0)",
    source="Newton 1.8, newton/_src/solvers/semi_implicit/kernels_contact.py",
    parameters=(
        Parameter("ke", "N/m", "stiffness, of both shapes", 1e-12, logarithmic=True),
        Parameter("kd", "N s/m", "damping, of both shapes"),
    ),
    force=lambda _, values, depth, rate: values["ke"] * depth + values["kd"] * np.maximum(rate, 0.0),
    # the dashpot acts in half of the contact: twice the damping of a spring and dashpot
    start=lambda pair, middle: {"ke": middle.stiffness(1.0), "kd": 2.0 * middle.damping(pair.mass)},
    paste=_paste,
    notes=(
        "two shapes take the mean of their numbers, so that both are given the same",
        "positions are 32-bit numbers: a ball 1 m from the origin has its depth to 0.1 µm",
        "other solvers of Newton take ke and kd as parameters of their own laws: fit MuJoCo's for SolverMuJoCo",
    ),
)

NEWTON = Engine("newton", "Newton", (SEMI_IMPLICIT,))
