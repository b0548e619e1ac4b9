"""A free body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from film_model.base.errors import raise_all
from film_model.base.fields import entry, fill_ball, measure
from film_model.base.materials import MASS, MATERIAL, Material, MaterialLike, sphere_mass
from film_model.base.turning import TURNING, Turning, contradictions
from film_model.base.units import Value
from film_model.targets.target import AbstractTarget


@dataclass(frozen=True, init=False, repr=False)
class Body(Turning, AbstractTarget):
    """A free body: a second ball.

    material: name or table. radius: m; or, to the constructor, diameter. mass: kg; default density × sphere volume.
    velocity: m/s, positive in the impactor's direction; default 0. spin: rad/s, in the sense of the impactor's, so that
    it adds to sliding if it is positive; default 0. shape: "solid" ball or thin "shell". inertia: moment of inertia of
    another body about its centre of mass, kg·m²; default that of the shape.

    >>> round(fm.Body("mild steel", diameter="20 mm").own_mass, 5)  # kg
    0.03288
    """

    kind: ClassVar[str] = "body"
    free: ClassVar[bool] = True
    material: Material | None = entry(MATERIAL)
    radius: float = entry(measure("length", 1e-10, 1e3, required=True))
    mass: float | None = entry(MASS)
    velocity: float = entry(measure("velocity", -2e4, 2e4, required=True))
    spin: float | None = entry(TURNING["spin"])
    shape: str | None = entry(TURNING["shape"])
    inertia: float | None = entry(TURNING["inertia"])

    def __init__(
        self,
        material: MaterialLike | None = None,
        radius: Value | None = None,
        mass: Value | None = None,
        velocity: Value = "0 m/s",
        diameter: Value | None = None,
        spin: Value | None = None,
        shape: Literal["solid", "shell"] | None = None,
        inertia: Value | None = None,
    ) -> None:
        raise_all(fill_ball(self, locals()) or contradictions(self))

    @property
    def own_mass(self) -> float | None:
        """The given mass, or density × sphere volume, kg; None if neither is known."""
        return sphere_mass(self.mass, self.radius, self.material)
