"""A scene: what hits what, how fast, and how it is to be solved."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce
from typing import Any, ClassVar, Literal, TypeAlias

from film_model.bodies import STANDARD_GRAVITY, Beam, BendingStiffness, Body, HalfSpace, Plate, Rod, Sphere, Target
from film_model.contact import Contact
from film_model.elementwise import either, endless, lesser
from film_model.errors import Mistake, raise_all, shown
from film_model.fields import Field, choice, fill, measure, whole
from film_model.materials import Material

__all__ = [
    "STANDARD_GRAVITY",
    "Beam",
    "BendingStiffness",
    "Body",
    "Contact",
    "Effects",
    "HalfSpace",
    "Material",
    "Plate",
    "Rod",
    "Scene",
    "Solver",
    "Sphere",
    "Target",
]

DEFAULT_ACCURACY = 1e-4
DEFAULT_TOLERANCE = 0.01

Switch: TypeAlias = Literal["auto"] | bool


@dataclass(frozen=True, init=False)
class Effects:
    """Which effects are computed: each "auto", True or False.

    boundary_reflections: waves that come back from the edges of a plate; where False, the plate is infinite.
    target_inertia: of a plate or beam with edges; where False, it follows the force with its static stiffness alone.
    tolerance: "auto" computes an effect if leaving it out would change a summary value by more than this, relative; and
    an effect beyond it that cannot be computed is warned of. Left out: 1 %, or the accuracy asked for if that is
    larger. It does not follow finer accuracies, so that a scene keeps its physics while its error is driven down.
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        **{
            name: choice("auto", True, False)
            for name in ("plasticity", "target_motion", "gravity", "boundary_reflections", "target_inertia")
        },
        "tolerance": measure("dimensionless", 1e-12, 1),
    }

    plasticity: Switch
    target_motion: Switch
    gravity: Switch
    boundary_reflections: Switch
    target_inertia: Switch
    tolerance: float | None

    def __init__(
        self,
        plasticity: Switch = "auto",
        target_motion: Switch = "auto",
        gravity: Switch = "auto",
        tolerance: float | None = None,
        boundary_reflections: Switch = "auto",
        target_inertia: Switch = "auto",
    ) -> None:
        raise_all(fill(self, locals()))


@dataclass(frozen=True, init=False)
class Solver:
    """How finely the motion is cut.

    accuracy: relative, of the summary, 1e-4 if nothing is given; or segments: a stage. linearisation: of the force,
    "work-preserving", or "chord" as in the paper.
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "accuracy": measure("dimensionless", 1e-14, 0.1),
        "segments": whole(1, 1_000_000),
        "linearisation": choice("work-preserving", "chord"),
    }

    accuracy: float | None
    segments: int | None
    linearisation: Literal["work-preserving", "chord"]

    def __init__(
        self,
        accuracy: float | None = None,
        segments: int | None = None,
        linearisation: Literal["work-preserving", "chord"] = "work-preserving",
    ) -> None:
        mistakes = fill(self, locals())
        if accuracy is None and segments is None:
            object.__setattr__(self, "accuracy", DEFAULT_ACCURACY)
        if accuracy is not None and segments is not None:
            mistakes.append(Mistake(None, None, "Solver.segments", "give accuracy or segments, not both"))
        raise_all(mistakes)


@dataclass(frozen=True)
class Scene:
    """One impact. The derived properties are SI floats."""

    impactor: Sphere
    target: Target
    contact: Contact = field(default_factory=Contact)
    effects: Effects = field(default_factory=Effects)
    solver: Solver = field(default_factory=Solver)
    title: str = ""

    def __post_init__(self) -> None:
        raise_all(self._wrong_types() or self._mistakes())

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str]) -> Scene:
        """Read a scene file; all its mistakes are raised in one SceneError."""
        from film_model.scene_file import read_scene

        return read_scene(path)

    @classmethod
    def from_text(cls, text: str, name: str = "scene") -> Scene:
        """Read the text of a scene file; `name` stands for the file in messages."""
        from film_model.scene_file import scene_from_text

        return scene_from_text(text, name)

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Scene:
        """Make a scene from nested tables laid out as in a scene file."""
        from film_model.scene_file import scene_from_table

        return scene_from_table(table)

    def to_table(self) -> dict[str, Any]:
        """Nested tables, as in a scene file, from which :meth:`from_table` makes the same scene, to the last bit."""
        from film_model.scene_file import table_from_scene

        return table_from_scene(self)

    def to_toml(self) -> str:
        """The text of a scene file, from which :meth:`from_text` makes the same scene, to the last bit."""
        from film_model.scene_file import text_from_table

        return text_from_table(self.to_table())

    def replace(self, changes: Mapping[str, Any]) -> Scene:
        """The scene with some entries changed, e.g. {"impactor.velocity": "1 m/s"}; None takes an entry out.

        solver.segments takes the place of solver.accuracy, and the other way round.
        """
        from film_model.scene_file import change_table

        return Scene.from_table(change_table(self.to_table(), changes))

    @property
    def mass(self) -> float:
        """Mass of the impactor, kg."""
        mass = self.impactor.own_mass
        assert mass is not None
        return mass

    @property
    def effective_mass(self) -> float:
        """1/(1/m + 1/m_t) for a free target, else the mass of the impactor, kg."""
        if not isinstance(self.target, Body):
            return self.mass
        other = self.target.own_mass
        assert other is not None
        return self.mass * other / (self.mass + other)

    @property
    def effective_radius(self) -> float:
        """1/(1/R + 1/R_t), m."""
        own, other = self.impactor.radius, self.target.radius
        return own if endless(other) else own * other / (own + other)

    @property
    def effective_modulus(self) -> float | None:
        """1/((1 − ν²)/E + (1 − ν_t²)/E_t), or what [contact] says, Pa; None only if the law needs none."""
        if self.contact.effective_modulus is not None:
            return self.contact.effective_modulus
        one, two = self.impactor.material, self.target.material
        if one is None or two is None:
            return None
        return 1 / sum((1 - m.poissons_ratio**2) / m.youngs_modulus for m in (one, two))

    @property
    def yield_strength(self) -> float | None:
        """What [contact] says, or the lower of the materials' own, Pa; None if none is given."""
        if self.contact.yield_strength is not None:
            return self.contact.yield_strength
        materials = (self.impactor.material, self.target.material)
        strengths = [m.yield_strength for m in materials if m is not None and m.yield_strength is not None]
        return reduce(lesser, strengths) if strengths else None

    @property
    def poissons_ratio(self) -> float | None:
        """Of the body that yields first, or what [contact] says; without yield strengths, the target's."""
        if self.contact.poissons_ratio is not None:
            return self.contact.poissons_ratio
        own, other = self.target.material, self.impactor.material
        if own is None or other is None:
            only = own or other
            return None if only is None else only.poissons_ratio
        one, two = (math.inf if m.yield_strength is None else m.yield_strength for m in (own, other))
        return either(one <= two, own.poissons_ratio, other.poissons_ratio)

    @property
    def approach_velocity(self) -> float:
        """Velocity of the impactor relative to the target when contact begins, m/s."""
        return self.impactor.speed - (self.target.velocity if isinstance(self.target, Body) else 0.0)

    @property
    def target_impedance(self) -> float:
        """Wave impedance of the target, N·s/m; infinite for a half-space, and for a body, which moves as a whole."""
        return self.target.impedance if isinstance(self.target, Plate | Rod) else math.inf

    @property
    def kinetic_energy(self) -> float:
        """½ m v² of the effective mass at the approach velocity, J: what the contact can take up."""
        return 0.5 * self.effective_mass * self.approach_velocity**2

    @property
    def effect_tolerance(self) -> float:
        """Relative change of the summary up to which an effect may be left out; see :class:`Effects`."""
        if self.effects.tolerance is not None:
            return self.effects.tolerance
        return max(DEFAULT_TOLERANCE, self.solver.accuracy or 0.0)

    def _wrong_types(self) -> list[Mistake]:
        parts = {"impactor": Sphere, "target": Target, "contact": Contact, "effects": Effects, "solver": Solver}
        return [
            Mistake(
                None, None, f"Scene.{name}", f"{shown(getattr(self, name))} is not allowed: {_names(kind)} is needed"
            )
            for name, kind in {**parts, "title": str}.items()
            if not isinstance(getattr(self, name), kind)
        ]

    def _mistakes(self) -> list[Mistake]:
        """What is wrong between the parts of the scene."""
        found: dict[str, str] = {}
        contact, target, name = self.contact, self.target, self.contact.law_name
        if self.impactor.own_mass is None:
            found["impactor.mass"] = "missing: give mass, or a material (the mass is then density × sphere volume)"
        if isinstance(target, Body):
            if target.own_mass is None:
                found["target.mass"] = "missing: give mass, or a material (the mass is then density × sphere volume)"
            if self.approach_velocity <= 0:
                found["target.velocity"] = (
                    f"{target.velocity:g} m/s must be < the impactor's {self.impactor.speed:g} m/s"
                )
        if contact.needs("effective_modulus") and self.effective_modulus is None:
            both = (("impactor", self.impactor), ("target", target))
            missing = " and ".join(f"{part}.material" for part, body in both if body.material is None)
            found["contact.effective_modulus"] = f"missing: give {missing}, or effective_modulus"
        if contact.needs("poissons_ratio") and self.poissons_ratio is None:
            found["contact.poissons_ratio"] = f'missing: law "{name}" needs it: give a material, or poissons_ratio'
        if self.yield_strength is None:
            where = "give yield_strength in [target.material], [impactor.material] or [contact]"
            if contact.needs("yield_strength"):
                found["contact.law"] = f'law "{name}" needs a yield strength: {where}'
            elif self.effects.plasticity is True and name == "auto":
                found["effects.plasticity"] = f"plasticity needs a yield strength: {where}"
        return [Mistake(None, None, f"Scene.{key}", message) for key, message in found.items()]


def _names(kind: Any) -> str:
    return " or ".join(k.__name__ for k in getattr(kind, "__args__", (kind,)))
