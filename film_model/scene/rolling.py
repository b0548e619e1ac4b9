"""What friction depends on besides the normal motion: inertia, stiffness along the surface, and the sliding velocity.

Every formula serves one impact, whose numbers are floats, and many, whose numbers are arrays with one value per impact.
"""

from __future__ import annotations

from typing import NamedTuple, cast

import numpy as np

from film_model import targets
from film_model.base.arrays import Array, Number, all_of, endless
from film_model.base.errors import SimulationError
from film_model.base.materials import Material
from film_model.scene import Scene, Sphere
from film_model.scene.friction_table import FrictionTable

MATERIALS = (
    "friction needs Young's modulus and Poisson's ratio of both bodies: give impactor.material and target.material, "
    "without effective_modulus in [contact]"
)
"""What is missing where κ is not known."""


class Body(NamedTuple):
    """What moves along the surface. mass: kg. lever: from the centre to the contact, m. inertia: about the centre,
    kg·m². spin: before, rad/s."""

    mass: Number
    lever: Number
    inertia: Number
    spin: Number

    @property
    def mobility(self) -> Number:
        """Of its contacting point, 1/m + R²/J, 1/kg."""
        return 1.0 / self.mass + self.lever**2 / self.inertia

    @property
    def turning(self) -> Number:
        """Velocity of its contacting point by its spin, m/s."""
        return self.spin * self.lever


class Sliding(NamedTuple):
    """What friction depends on besides the normal motion. friction: µ at the sliding velocity before; table: of µ, if
    it is not constant. ratio: κ = E*/(4 G*). modulus: G*, Pa. mass: m_t, kg.
    target: the target's body; None of one that is immovable in its plane. velocity: of sliding before, m/s. along:
    tangential velocity of the impactor's centre before, m/s."""

    friction: Number
    ratio: Number
    modulus: Number
    mass: Number
    impactor: Body
    target: Body | None
    velocity: Number
    along: Number
    table: FrictionTable | None

    @property
    def parameter(self) -> Number:
        """m/m_t over κ, for m = 1 kg."""
        return 1.0 / (self.mass * self.ratio)

    @property
    def pairs(self) -> Array:
        """Pairs of speed, m/s, and coefficient, for the core."""
        return np.array([[0.0, self.friction]]) if self.table is None else self.table.pairs


def sliding_of(scene: Scene, at_rest: bool = False) -> Sliding | None:
    """What friction depends on; None without friction, or if nothing slides, unless at_rest is true.

    Raises SimulationError if the stiffness along the surface is not known.
    """
    friction = scene.contact.friction
    if friction is None:
        return None
    velocity = sliding_before(scene)
    if not at_rest and all_of(velocity == 0.0):
        return None
    ratio = stiffness_ratio(scene)
    if ratio is None or scene.contact.effective_modulus is not None:
        raise SimulationError(MATERIALS)
    modulus = 1.0 / _softness(_materials(scene))
    mass, bodies = 1.0 / tangential_mobility(scene), (_impactor(scene), _target(scene))
    table = friction if isinstance(friction, FrictionTable) else None
    now = friction if table is None else table.at(abs(velocity))
    return Sliding(now, ratio, modulus, mass, *bodies, velocity, scene.impactor.tangential_speed, table)


def sliding_before(scene: Scene) -> Number:
    """Velocity of the impactor's contacting point on the target's at first touch, m/s."""
    target = _target(scene)
    turning = _impactor(scene).turning + (0.0 if target is None else target.turning)
    return scene.impactor.tangential_speed + turning


def stiffness_ratio(scene: Scene) -> Number | None:
    """κ = E*/(4 G*) of the materials; None if one of them is not known."""
    materials = _materials(scene)
    if not materials:
        return None
    one, two = ((1 - m.poissons_ratio**2) / m.youngs_modulus for m in materials)
    return 1 / (one + two) * _softness(materials) / 4.0


def tangential_mobility(scene: Scene) -> Number:
    """1/m_t = Σ (1/m + R²/J) of the bodies that are free, 1/kg."""
    target = _target(scene)
    return _impactor(scene).mobility + (0.0 if target is None else target.mobility)


def _impactor(scene: Scene) -> Body:
    return _ball(scene.impactor, scene.mass)


def _target(scene: Scene) -> Body | None:
    """A ball; other targets are immovable in their plane."""
    target = scene.target
    if not isinstance(target, targets.Body) or endless(cast("float", target.own_mass)):
        return None
    return _ball(target, cast("float", target.own_mass))


def _ball(ball: Sphere | targets.Body, mass: Number) -> Body:
    inertia = ball.inertia_number * mass * ball.radius**2
    return Body(mass, ball.radius, inertia, 0.0 if ball.spin is None else ball.spin)


def _materials(scene: Scene) -> tuple[Material, ...]:
    """Those of both bodies; none if one of them is not known."""
    one, two = scene.impactor.material, scene.target.material
    return () if one is None or two is None else (one, two)


def _softness(materials: tuple[Material, ...]) -> Number:
    """1/G* = Σ (2 − ν)/G, 1/Pa."""
    shear = [m.youngs_modulus / (2.0 * (1.0 + m.poissons_ratio)) for m in materials]
    return sum((2.0 - m.poissons_ratio) / g for m, g in zip(materials, shear, strict=True))
