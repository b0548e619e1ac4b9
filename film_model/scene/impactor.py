"""The impactor: a sphere, a compact body whose contacting surface is spherical, or a nose of another shape."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, cast

from film_model.base.arrays import cosine, root, sine
from film_model.base.errors import Mistake, raise_all, shown
from film_model.base.fields import InUnits, choice, entry, fill_ball, measure, mistake, one_of
from film_model.base.materials import MASS, MATERIAL, Material, MaterialLike, sphere_mass
from film_model.base.turning import SHAPES, TURNING, Turning, contradictions
from film_model.base.units import Value
from film_model.scene.noses import OWN, VOLUMES

STANDARD_GRAVITY = 9.80665  # m/s²

STEEPEST = 1.57
"""Largest angle of impact, rad (89.95°)."""

SLOWEST = 1e-100
"""Least velocity, m/s: the square of a smaller one underflows to 0."""


@dataclass(frozen=True, init=False, repr=False)
class Sphere(Turning, InUnits):
    """The impactor.

    radius: of the contacting surface, m; or, to the constructor, diameter. velocity: towards the target, m/s; or
    drop_height: of a fall from rest, m. mass: kg; default density × sphere volume. material: name or table. angle:
    between the velocity and the normal of the surface, rad; default 0. The normal motion is that of the component
    velocity × cos(angle); with friction in [contact] the tangential motion and the spin are simulated beside it. spin:
    about the axis across the plane of incidence, rad/s, positive if it adds to sliding; default 0. shape: "solid" ball
    or thin "shell", which turns as a whole; or a nose on a flat, with an elastic law: "cone", of which the radius is
    that of its base, "flat punch", "cylinder" on its flat end, "ellipsoid" with a second radius of curvature. inertia:
    moment of inertia of another body about its centre of mass, kg·m²; default that of the shape. half_angle: of a cone,
    between axis and side, rad. second_radius: of an ellipsoid, in the other principal plane, m. length: of a cylinder,
    or an ellipsoid's whole height, m, for its mass; default none, and the mass is needed.

    >>> fm.Sphere(diameter="20 mm", drop_height="0.5 m", material="bearing steel").speed  # m/s
    3.1315...
    """

    radius: float = entry(measure("length", 1e-10, 1e3, required=True))
    velocity: float | None = entry(measure("velocity", 0, 2e4))
    drop_height: float | None = entry(measure("length", 0, 1e5))
    mass: float | None = entry(MASS)
    material: Material | None = entry(MATERIAL)
    angle: float | None = entry(measure("angle", 0, STEEPEST))
    spin: float | None = entry(TURNING["spin"])
    shape: str | None = entry(replace(choice(*SHAPES, *VOLUMES), required=False))
    inertia: float | None = entry(TURNING["inertia"])
    half_angle: float | None = entry(measure("angle", 1e-3, STEEPEST))
    second_radius: float | None = entry(measure("length", 1e-10, 1e3))
    length: float | None = entry(measure("length", 1e-10, 1e3))

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
        shape: Literal["solid", "shell", "cone", "flat punch", "cylinder", "ellipsoid"] | None = None,
        inertia: Value | None = None,
        half_angle: Value | None = None,
        second_radius: Value | None = None,
        length: Value | None = None,
    ) -> None:
        mistakes = fill_ball(self, locals()) + one_of(self, velocity=velocity, drop_height=drop_height)
        if not mistakes and 0.0 < self.speed < SLOWEST:
            name = "drop_height" if velocity is None else "velocity"
            mistakes.append(mistake(self, name, f"{self.speed:g} m/s must be 0 or at least {SLOWEST:g} m/s"))
        raise_all(mistakes or self._mistakes_of_shape() or contradictions(self))

    def _mistakes_of_shape(self) -> list[Mistake]:
        """Mistakes of entries that another shape has, or that this one needs."""
        own, nose = OWN.get(self.shape or "", ()), self.shape in VOLUMES
        found = {
            name: f"only shape {' or '.join(shown(shape) for shape, names in OWN.items() if name in names)} has it"
            for names in OWN.values()
            for name in names
            if name not in own and getattr(self, name) is not None
        }
        found |= {
            name: f"missing: shape {shown(self.shape)} needs it"
            for name in own
            if name != "length" and getattr(self, name) is None
        }
        turned = {"angle": self.angle, "spin": self.spin, "inertia": self.inertia}
        found |= {
            name: f"only a ball has it, not shape {shown(self.shape)}" for name in turned if nose and turned[name]
        }
        return [mistake(self, name, why) for name, why in found.items()]

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
    def own_mass(self) -> float | None:
        """The given mass, or density × volume, kg; None if neither is known."""
        shape = self.shape or "solid"
        if self.mass is not None or shape not in VOLUMES:
            return sphere_mass(self.mass, self.radius, self.material)
        volume, whole = VOLUMES[shape], "length" not in OWN.get(shape, ()) or self.length is not None
        return self.material.density * volume(self) if volume and whole and self.material else None

    @property
    def noun(self) -> str:
        """The shape in words."""
        return "ball" if self.shape is None or self.shape in SHAPES else self.shape

    @property
    def mass_needed(self) -> str:
        """What to give where the mass is missing."""
        shape = self.shape or "solid"
        if shape not in VOLUMES:
            return "give mass, or a material (the mass is then density × sphere volume)"
        if VOLUMES[shape] is None:
            return f"give mass: the volume of shape {shown(shape)} is unknown"
        return f"give mass, or a material{' and length' if 'length' in OWN[shape] else ''} (density × volume)"
