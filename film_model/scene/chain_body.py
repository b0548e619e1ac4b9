"""A body of a chain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

from film_model.base.errors import raise_all, shown
from film_model.base.fields import Field, InUnits, choice, entry, fill_ball, measure, whole, words
from film_model.base.materials import MASS, MATERIAL, Material, MaterialLike, sphere_mass
from film_model.base.units import Value
from film_model.scene.contact import Contact, contact_table
from film_model.scene.impactor import STEEPEST

MOST_BODIES = 10_000

GAP = measure("length", 0, 1e5)


def _contact_of(value: object) -> Contact:
    if isinstance(value, Contact):
        return value
    if isinstance(value, Mapping):
        return Contact(**cast("dict[str, Any]", value))
    raise ValueError(f"{shown(value)} is not allowed: a Contact is needed")


@dataclass(frozen=True, init=False, repr=False)
class ChainBody(InUnits):
    """A body of a chain, or several alike.

    radius: of the contacting surfaces, m; or, to the constructor, diameter. mass: kg; default density × sphere volume.
    material: name or table. velocity: at the start, m/s, positive towards the end of the chain; default 0. gap: to the
    bodies behind it, or of the last one to the half-space, m; default 0, touching. count: of such bodies, one after the
    other, with that gap behind each. contact: the law behind each of them, where it differs from the chain's.

    Of a chain that branches: name, for those that follow. behind: name of the body that it touches from behind; default
    the one before it. angle: between the line along which it moves and the line of that body, rad, at most 89.95° to
    either side; default 0. front_gap: to that body, m, in place of that body's gap. With a count, a name is that of the
    last, and the others are of the first.

    On a target that vibrates: at: name of the sensor where the body touches it; default the target's position. The next
    section then begins another row. behind: "target" of a body that it pushes, which touches it at `at`, too, at the
    distance front_gap. fixed: true of a stop, which does not move and needs no mass.
    """

    is_ball: ClassVar[bool] = True
    radius: float = entry(measure("length", 1e-10, 1e3, required=True))
    mass: float | None = entry(MASS)
    material: Material | None = entry(MATERIAL)
    velocity: float = entry(measure("velocity", -2e4, 2e4, required=True))
    gap: float = entry(replace(GAP, required=True))
    count: int = entry(whole(1, MOST_BODIES))
    contact: Contact | None = entry(Field(_contact_of, "a Contact is needed", write=contact_table))
    name: str = entry(words("a name"))
    behind: str = entry(words("the name of a body"))
    angle: float | None = entry(measure("angle", -STEEPEST, STEEPEST))
    front_gap: float | None = entry(GAP)
    at: str = entry(words("the name of a sensor"))
    fixed: bool | None = entry(replace(choice(True, False), required=False))

    def __init__(
        self,
        radius: Value | None = None,
        mass: Value | None = None,
        material: MaterialLike | None = None,
        velocity: Value = "0 m/s",
        gap: Value = "0 m",
        count: int = 1,
        contact: Contact | Mapping[str, Any] | None = None,
        diameter: Value | None = None,
        name: str = "",
        behind: str = "",
        angle: Value | None = None,
        front_gap: Value | None = None,
        at: str = "",
        fixed: bool | None = None,
    ) -> None:
        raise_all(fill_ball(self, locals()))

    @property
    def own_mass(self) -> float | None:
        """The given mass, or density × sphere volume, kg; None if neither is known."""
        return sphere_mass(self.mass, self.radius, self.material)
