"""The impactor: a sphere, or a compact body whose contacting surface is spherical."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal, cast

from film_model.base.arrays import cosine, root, sine
from film_model.base.errors import raise_all
from film_model.base.fields import Field, InUnits, fill_ball, measure, mistake, one_of
from film_model.base.materials import MASS, MATERIAL, Material, MaterialLike, sphere_mass
from film_model.base.turning import TURNING, contradictions, inertia_number_of
from film_model.base.units import Value

STANDARD_GRAVITY = 9.80665  # m/s²

STEEPEST = 1.57
"""Largest angle of impact, rad (89.95°)."""

SLOWEST = 1e-100
"""Least velocity, m/s: the square of a smaller one underflows to 0."""


@dataclass(frozen=True, init=False, repr=False)
class Sphere(InUnits):
    """The impactor.

    radius: of the contacting surface, m; or, to the constructor, diameter. velocity: towards the target, m/s; or
    drop_height: of a fall from rest, m. mass: kg; default density × sphere volume. material: name or table. angle:
    between the velocity and the normal of the surface, rad; default 0. The normal motion is that of the component
    velocity × cos(angle); with friction in [contact] the tangential motion and the spin are simulated beside it. spin:
    about the axis across the plane of incidence, rad/s, positive if it adds to sliding; default 0. shape: "solid" ball
    or thin "shell", which turns as a whole. inertia: moment of inertia of another body about its centre of mass, kg·m²;
    default that of the shape.

    >>> fm.Sphere(diameter="20 mm", drop_height="0.5 m", material="bearing steel").speed  # m/s
    3.1315...
    """

    is_ball: ClassVar[bool] = True
    FIELDS: ClassVar[Mapping[str, Field]] = {
        "radius": measure("length", 1e-10, 1e3, required=True),
        "velocity": measure("velocity", 0, 2e4),
        "drop_height": measure("length", 0, 1e5),
        "mass": MASS,
        "material": MATERIAL,
        "angle": measure("angle", 0, STEEPEST),
        **TURNING,
    }

    radius: float
    velocity: float | None
    drop_height: float | None
    mass: float | None
    material: Material | None
    angle: float | None
    spin: float | None
    shape: str | None
    inertia: float | None

    def __init__(
        self,
        radius: Value | None = None,
        velocity: Value | None = None,
        drop_height: Value | None = None,
        mass: Value | None = None,
        material: MaterialLike | None = None,
        angle: Value | None = None,
        diameter: Value | None = None,
        spin: Value | None = None,
        shape: Literal["solid", "shell"] | None = None,
        inertia: Value | None = None,
    ) -> None:
        mistakes = fill_ball(self, locals()) + one_of(self, velocity=velocity, drop_height=drop_height)
        if not mistakes and 0.0 < self.speed < SLOWEST:
            name = "drop_height" if velocity is None else "velocity"
            mistakes.append(mistake(self, name, f"{self.speed:g} m/s must be 0 or at least {SLOWEST:g} m/s"))
        raise_all(mistakes or contradictions(self))

    @property
    def path_speed(self) -> float:
        """Velocity along the path when contact begins, m/s: the given one, or √(2 g h)."""
        if self.velocity is not None:
            return self.velocity
        return root(2 * STANDARD_GRAVITY * cast("float", self.drop_height))

    @property
    def speed(self) -> float:
        """The component of that velocity normal to the surface, m/s, which is simulated."""
        return self.path_speed if self.angle is None else self.path_speed * cosine(self.angle)

    @property
    def tangential_speed(self) -> float:
        """The component of that velocity along the surface, m/s."""
        return self.path_speed * sine(0.0 if self.angle is None else self.angle)

    @property
    def inertia_number(self) -> float:
        """J/(m R²)."""
        return inertia_number_of(self)

    @property
    def diameter(self) -> float:
        """Twice the radius, m."""
        return 2.0 * self.radius

    @property
    def own_mass(self) -> float | None:
        """The given mass, or density × sphere volume, kg; None if neither is known."""
        return sphere_mass(self.mass, self.radius, self.material)
