"""Bullet: contact stiffness and damping, a linear spring and dashpot that the solver takes as one implicit step."""

from __future__ import annotations

import math

from film_model.translate import granular
from film_model.translate.law import Engine, EngineLaw, Pair, Values


def _paste(pair: Pair, values: Values) -> str:
    numbers = f"contactStiffness={2.0 * values['kn']:.6g}, contactDamping={0.5 * values['cn']:.6g}"
    flat = math.isinf(pair.target_radius)
    shape = "p.GEOM_PLANE" if flat else f"p.GEOM_SPHERE, radius={pair.target_radius:.6g}"
    mass, height = 0.0 if pair.fixed else pair.target_mass, 0.0 if flat else -pair.target_radius
    return f"""ball = p.createMultiBody({pair.ball_mass:.6g}, p.createCollisionShape(p.GEOM_SPHERE, \
radius={pair.ball_radius:.6g}), basePosition=[0, 0, {pair.ball_radius:.6g}])
target = p.createMultiBody({mass:.6g}, p.createCollisionShape({shape}), basePosition=[0, 0, {height:.6g}])
for body in (ball, target):  # stiffnesses act in series, dampings add
    p.changeDynamics(body, -1, {numbers}, restitution=0,
                     linearDamping=0, angularDamping=0, lateralFriction={pair.friction or 0.0:.6g})
p.setPhysicsEngineParameter(contactSlop=0)"""


CONTACT = EngineLaw(
    name="contact",
    formula="F = k δ + d δ'",
    source="Bullet's source, btSequentialImpulseConstraintSolver: cfm = 1/(Δt k + d), erp = Δt k/(Δt k + d)",
    parameters=granular.SPRING_AND_DASHPOT,
    force=granular.spring_and_dashpot,
    start=granular.start_spring_and_dashpot,
    paste=_paste,
    notes=(
        "give both bodies numbers: one without has a damping of 0.1 and no compliance",
        "contactSlop=0: PyBullet lets bodies overlap by 10 µm without force otherwise",
        "the integrator is of first order: 2000 steps in the contact change the restitution by about 0.2 %",
    ),
)

BULLET = Engine("bullet", "Bullet", (CONTACT,))
