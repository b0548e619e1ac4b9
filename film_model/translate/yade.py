"""Yade: Hertz–Mindlin with a damping ratio, and the linear viscoelastic contact."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from film_model.translate import granular
from film_model.translate.law import Engine, EngineLaw, Middle, Pair, Parameter, Values


def _mindlin(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    """k δ^1.5 + 2 β √(m kt) δ', with kt = 1.5 k √δ."""
    k = 4.0 / 3.0 * pair.effective_modulus(values["young"]) * _radius(pair) ** 0.5
    return k * depth**1.5 + 2.0 * values["betan"] * np.sqrt(1.5 * pair.mass * k * np.sqrt(depth)) * rate


def _radius(pair: Pair) -> float:
    """Yade gives a wall or facet the ball's radius: the effective radius is half of the ball's."""
    return 0.5 * pair.ball_radius if math.isinf(pair.target_radius) else pair.radius


def _start_mindlin(pair: Pair, middle: Middle) -> dict[str, float]:
    begin = granular.start_by_restitution(replace(pair, radius=_radius(pair)), middle)
    return {"young": begin["youngs_modulus"], "betan": middle.damping_ratio}


def _angle(pair: Pair) -> float:
    return math.atan(pair.friction or 0.0)


def _paste_mindlin(pair: Pair, values: Values) -> str:
    return f"""O.materials.append(FrictMat(young={values["young"]:.6g}, poisson={pair.poissons_ratio:.6g}, \
frictionAngle={_angle(pair):.6g}, density=1))  # of both bodies; set the ball's mass to \
{pair.ball_mass:.6g}
InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
    [Ip2_FrictMat_FrictMat_MindlinPhys(betan={values["betan"]:.6g}, betas=0)],
    [Law2_ScGeom_MindlinPhys_Mindlin()])"""


def _paste_linear(pair: Pair, values: Values) -> str:
    kn, cn = 2.0 * values["kn"], 2.0 * values["cn"]
    ks = 0.0 if pair.friction is None else kn / pair.ratio
    return f"""O.materials.append(ViscElMat(kn={kn:.6g}, cn={cn:.6g}, ks={ks:.6g}, cs=0, \
frictionAngle={_angle(pair):.6g}, density=1))
# of both bodies: they act in series; set the ball's mass to {pair.ball_mass:.6g}
InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
    [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
    [Law2_ScGeom_ViscElPhys_Basic()])"""


MINDLIN = EngineLaw(
    name="mindlin",
    formula="F = k δ^1.5 + 2 β √(m kt) δ', k = 4/3 E* √R, kt = 1.5 k √δ; R is half the ball's radius on a wall",
    source="Yade documentation, Ip2_FrictMat_FrictMat_MindlinPhys and Law2_ScGeom_MindlinPhys_Mindlin",
    parameters=(granular.modulus("young"), Parameter("betan", "", "damping ratio", 0.0, 1.0)),
    force=_mindlin,
    start=_start_mindlin,
    paste=_paste_mindlin,
    tangential={"MindlinPhys": "mindlin/force"},
    notes=(
        "Yade takes the ball's radius for that of a flat target, so young is √2 times Hertz's there",
        "betan instead of en: Yade's formula for en has changed between versions",
    ),
)

LINEAR = EngineLaw(
    name="viscoelastic",
    formula="F = kn δ + cn δ'",
    source="Yade documentation, ViscElMat and Law2_ScGeom_ViscElPhys_Basic",
    parameters=granular.SPRING_AND_DASHPOT,
    force=granular.spring_and_dashpot,
    start=granular.start_spring_and_dashpot,
    paste=_paste_linear,
    tangential={"ViscElPhys": "hooke"},
)

YADE = Engine("yade", "Yade", (MINDLIN, LINEAR))
