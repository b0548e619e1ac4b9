"""What friction depends on besides the normal motion: inertia, stiffness along the surface, and the sliding velocity.

Every formula serves one impact, whose numbers are floats, and many, whose numbers are arrays with one value per impact.
"""

from __future__ import annotations

import math
from typing import NamedTuple, cast

import numpy as np

from film_model.base.arrays import Number, all_of, endless
from film_model.base.errors import SimulationError
from film_model.base.materials import Material
from film_model.scene import Scene


class Body(NamedTuple):
    """What moves along the surface. mass: kg; infinite if nothing does. lever: from the centre to the contact, m.
    inertia: about the centre, kg·m²."""

    mass: Number
    lever: Number
    inertia: Number

    @property
    def mobility(self) -> Number:
        """Of its contacting point, 1/m + R²/J, 1/kg."""
        return 1.0 / self.mass + self.lever**2 / self.inertia


class Sliding(NamedTuple):
    """What friction depends on besides the normal motion. ratio: κ = E*/(4 G*). modulus: G*, Pa. mass: m_t, kg.
    velocity: of sliding before, m/s. along: tangential velocity of the centre before, m/s."""

    friction: Number
    ratio: Number
    modulus: Number
    mass: Number
    impactor: Body
    velocity: Number
    along: Number

    @property
    def parameter(self) -> Number:
        """m/m_t over κ, for m = 1 kg."""
        return 1.0 / (self.mass * self.ratio)


def sliding_of(scene: Scene, at_rest: bool = False) -> Sliding | None:
    """What friction depends on; None without friction, or if nothing slides, unless at_rest is true.

    Raises SimulationError if the stiffness along the surface is not known.
    """
    ball, friction = scene.impactor, scene.contact.friction
    if friction is None:
        return None
    angle, spin = 0.0 if ball.angle is None else ball.angle, spin_of(scene)
    along = ball.path_speed * (np.sin(angle) if isinstance(angle, np.ndarray) else math.sin(angle))
    velocity = along + spin * ball.radius
    if not at_rest and all_of(velocity == 0.0):
        return None
    materials = [ball.material, scene.target.material]
    if None in materials or scene.contact.effective_modulus is not None:
        raise SimulationError(
            "friction needs Young's modulus and Poisson's ratio of both bodies: give impactor.material and "
            "target.material, without effective_modulus in [contact]"
        )
    softness = sum((2.0 - m.poissons_ratio) / _shear_modulus(m) for m in cast("list[Material]", materials))
    impactor = Body(scene.mass, ball.radius, ball.inertia_number * scene.mass * ball.radius**2)
    mobility = impactor.mobility + _mobility_of_target(scene)
    modulus = cast("float", scene.effective_modulus)
    return Sliding(friction, modulus * softness / 4.0, 1.0 / softness, 1.0 / mobility, impactor, velocity, along)


def spin_of(scene: Scene) -> Number:
    """Spin of the impactor before, rad/s."""
    spin = scene.impactor.spin
    return 0.0 if spin is None else spin


def _shear_modulus(of: Material) -> Number:
    return of.youngs_modulus / (2.0 * (1.0 + of.poissons_ratio))


def _mobility_of_target(scene: Scene) -> Number:
    """A ball moves and turns, other targets are immovable in their plane, 1/kg."""
    target = scene.target
    if not target.free or endless(cast("float", target.own_mass)):
        return 0.0
    mass = cast("float", target.own_mass)
    return Body(mass, target.radius, 0.4 * mass * target.radius**2).mobility
