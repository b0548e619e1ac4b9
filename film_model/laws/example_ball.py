"""The steel ball on steel of the gallery, and any law for it with the law's own example values."""

from __future__ import annotations

from film_model.laws.hertz import hertz_stiffness
from film_model.laws.law import SCENE_FIELDS, AbstractLaw, ExampleBall, law_fields
from film_model.laws.yielding import yield_velocity

VELOCITY_RATIO = 50.0
"""Approach velocity of the steel ball over the velocity at which it yields."""


def example_ball(
    effective_modulus: float, radius: float, yield_strength: float, poissons_ratio: float, mass: float, velocity: float
) -> ExampleBall:
    """A ball from its SI values, with the stiffness and the depth that Hertz's law gives it."""
    stiffness = hertz_stiffness(effective_modulus, radius)
    depth = (2.5 * (0.5 * mass * velocity**2) / stiffness) ** 0.4
    return ExampleBall(effective_modulus, radius, yield_strength, poissons_ratio, mass, velocity, stiffness, depth)


STEEL_BALL = example_ball(
    115e9, 0.01, 0.5e9, 0.3, 0.0329, VELOCITY_RATIO * yield_velocity(115e9, 0.01, 0.5e9, mass=0.0329)
)
"""A steel ball of 20 mm diameter on steel."""


def example_law(law: type[AbstractLaw], ball: ExampleBall = STEEL_BALL) -> AbstractLaw:
    """The law for a ball: the fields that a scene fills from the ball, its own parameters from its example."""
    fields = {name: getattr(ball, name) for name in SCENE_FIELDS if name in law_fields(law)}
    return law(**fields, **law.example(ball))
