"""A scene: impactor, target, contact law, effects and solver options."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, reduce
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from film_model.base.arrays import any_of, either, endless, greater, lesser, root
from film_model.base.errors import Mistake, SceneError, raise_all, shown
from film_model.base.fields import mistake
from film_model.base.flow_stress import flow_of_yield
from film_model.base.late import Late
from film_model.base.materials import Material
from film_model.base.rate_law import RateHardening, rate_constants
from film_model.base.text import Text
from film_model.base.units import format_si
from film_model.laws import AbstractLaw
from film_model.laws.damping import loss_restitution
from film_model.laws.elastoplastic import COMPARED_STRAIN, FITTED
from film_model.laws.hertz import hertz_stiffness
from film_model.laws.yielding import LEAST_YIELD_STRAIN, MOST_YIELD_STRAIN, yield_point
from film_model.scene.contact import Contact
from film_model.scene.impactor import STANDARD_GRAVITY, Sphere
from film_model.scene.mistakes import mistakes_of, remarks_about
from film_model.scene.noses import Nose, Oval, nose_of, oval_of, relative_radius
from film_model.scene.options import Effects, Solver, tolerance_for
from film_model.scene.sections import SECTIONS, parts_of, section_of
from film_model.scene.slope import slope_coefficient
from film_model.scene.toml import (
    change_table,
    find_files,
    placed,
    read_text,
    refuse_others,
    text_from_table,
    toml_table,
)
from film_model.targets import TARGETS, AbstractTarget


@dataclass(frozen=True)
class Scene:
    """One impact. The derived properties are SI floats.

    >>> fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    Scene(ball of radius 10 mm, 32.71 g, 1 m/s, on mild steel half-space; law auto)
    """

    impactor: Sphere
    target: AbstractTarget
    contact: Contact = field(default_factory=Contact)
    effects: Effects = field(default_factory=Effects)
    solver: Solver = field(default_factory=Solver)
    title: str = ""

    if TYPE_CHECKING:

        def explain(self, *, verbose: bool = False) -> Text: ...
        def _repr_html_(self) -> str: ...
    else:
        explain = Late("film_model.methods:explain")
        _repr_html_ = Late("film_model.methods:scene_as_html")

    def __post_init__(self) -> None:
        raise_all(self._wrong_types() or mistakes_of(self))

    def __repr__(self) -> str:
        radius, mass = format_si(self.impactor.radius, "length"), format_si(self.mass, "mass")
        ball = f"{self.impactor.noun} of radius {radius}, {mass}, {format_si(self.impactor.speed, 'velocity')}"
        target = " ".join(filter(None, (getattr(self.target.material, "name", ""), self.target.kind)))
        title = f"{shown(self.title)}: " if self.title else ""
        return f"Scene({title}{ball}, on {target}; law {self.contact.law_name})"

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str]) -> Scene:
        """Read a scene file; all its mistakes are raised in one SceneError."""
        text, name = read_text(path)
        return cls.from_text(text, name, os.path.dirname(os.fspath(path)))

    @classmethod
    def from_text(cls, text: str, name: str = "scene", folder: str = "") -> Scene:
        """Read the text of a scene file. name: of the file, in messages. folder: for the relative paths in the text."""
        return scene_of(toml_table(text, name), text, name, folder)

    @classmethod
    def from_stored_text(cls, text: str, name: str) -> Scene:
        """Read the text of a scene that was stored with results, in a dataset or an FMU: its tables are in the text, so
        that a path in it is refused and nothing else is read."""
        return scene_of(toml_table(text, name), text, name, None)

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Scene:
        """Make a scene from nested tables laid out as in a scene file."""
        return cls._of(table, {})

    @classmethod
    def _of(cls, table: Mapping[str, Any], others: Mapping[str, Any]) -> Scene:
        """The same, with parts that are made already."""
        parts, mistakes = parts_of(table)
        missing = [key for key in ("impactor", "target") if key not in table and key not in others]
        mistakes += [Mistake(None, None, key, f"missing: a section [{key}] is needed") for key in missing]
        if not isinstance(parts.get("title", ""), str):
            mistakes.append(Mistake(None, None, "title", f"{shown(parts['title'])} is not a text"))
        raise_all(mistakes)
        try:
            return cls(**others, **parts)
        except SceneError as error:
            raise SceneError(found.moved("") for found in error.mistakes) from None

    def to_table(self) -> dict[str, Any]:
        """Nested tables, as in a scene file, from which :meth:`from_table` makes the same scene, to the last bit."""
        title = {"title": self.title} if self.title else {}
        return title | {name: section_of(name, getattr(self, name)) for name in SECTIONS}

    def to_toml(self) -> str:
        """The text of a scene file, from which :meth:`from_text` makes the same scene, to the last bit."""
        return text_from_table(self.to_table())

    def archived_text(self) -> str:
        """The text of a scene file to be stored with results; a law that is not in `LAWS` is given by its name only."""
        table = self.to_table()
        if isinstance(self.contact.law, AbstractLaw):
            table["contact"]["law"] = self.contact.law.name
        return text_from_table(table)

    def replace(self, changes: Mapping[str, Any]) -> Scene:
        """The scene with some entries changed, e.g. {"impactor.velocity": "1 m/s"}; None removes an entry.

        solver.segments replaces solver.accuracy, and vice versa.

        >>> scene.replace({"impactor.velocity": "2 m/s", "contact.law": "stronge"})
        Scene(ball of radius 10 mm, 32.71 g, 2 m/s, on mild steel half-space; law stronge)
        """
        changed = {path.partition(".")[0] for path in changes}
        others = {name: getattr(self, name) for name in (*SECTIONS, "title") if name not in changed}
        sections = {name: section_of(name, getattr(self, name), whole=True) for name in SECTIONS if name in changed}
        return Scene._of(change_table(sections, changes), others)

    @cached_property
    def mass(self) -> float:
        """Mass of the impactor, kg."""
        mass = self.impactor.own_mass
        assert mass is not None
        return mass

    @cached_property
    def effective_mass(self) -> float:
        """1/(1/m + 1/m_t) for a free target, otherwise the mass of the impactor, kg."""
        other = self.target.own_mass
        assert other is not None
        return self.mass if endless(other) else self.mass * other / (self.mass + other)

    @cached_property
    def effective_radius(self) -> float:
        """1/(1/R + 1/R_t), m, nan in a too narrow hollow; that of a ball of equal force if contact is elliptic."""
        return relative_radius(self.impactor.radius, self.target.radius) if self.oval is None else self.oval.radius

    @cached_property
    def oval(self) -> Oval | None:
        """The elliptic contact of surfaces with a second radius of curvature; None if they have none."""
        return oval_of(self.impactor, self.target)

    @cached_property
    def nose(self) -> Nose | None:
        """The elastic contact of a cone or a flat end; None of a ball or an ellipsoid."""
        return nose_of(self.impactor)

    @cached_property
    def is_round(self) -> bool:
        """Whether contact is that of a ball, as of all laws but those of a power and of a table."""
        return self.oval is None and self.nose is None

    @cached_property
    def effective_modulus(self) -> float | None:
        """1/((1 − ν²)/E + (1 − ν_t²)/E_t), or the value in [contact], Pa; None only if the law does not need it."""
        if self.contact.effective_modulus is not None:
            return self.contact.effective_modulus
        one, two = self.impactor.material, self.target.material
        if one is None or two is None:
            return None
        return 1 / ((1 - one.poissons_ratio**2) / one.youngs_modulus + (1 - two.poissons_ratio**2) / two.youngs_modulus)

    @cached_property
    def loss_factor(self) -> float | None:
        """Of both bodies: each weighted with its share of the compliance 1/E; one that is not given, and that of a
        material with a prony series, counts as 0. None if none is given."""
        known = [m for m in (self.impactor.material, self.target.material) if m is not None]
        lossy = [m for m in known if m.loss_factor is not None and m.prony is None]
        if not lossy or self.effective_modulus is None:
            return None
        finite = [either(cast("float", m.loss_factor) < math.inf, m.loss_factor, 0.0) for m in lossy]
        soft = [(1 - m.poissons_ratio**2) / m.youngs_modulus for m in lossy]
        return sum(loss * part * self.effective_modulus for loss, part in zip(finite, soft, strict=True))

    @cached_property
    def loss_restitution(self) -> float:
        """The restitution that the loss factors leave; 1 without."""
        return 1.0 if self.loss_factor is None else loss_restitution(self.loss_factor)

    @cached_property
    def yield_strength(self) -> float | None:
        """Strength at first yield: the value in [contact], or the lower of the materials', Pa; None if unknown."""
        return self._lower_strength("initial_strength")

    @cached_property
    def flow_strength(self) -> float | None:
        """Strength of laws without hardening: the value in [contact], or the lower of the materials' flow stresses at
        8 % plastic strain, Pa; None if unknown."""
        return self._lower_strength("flow_strength")

    def _lower_strength(self, name: str) -> float | None:
        if self.contact.yield_strength is not None:
            return self.contact.yield_strength
        found = [getattr(m, name) for m in (self.impactor.material, self.target.material) if m is not None]
        strengths = [strength for strength in found if strength is not None]
        return reduce(lesser, strengths) if strengths else None

    @cached_property
    def first_to_yield(self) -> Material | None:
        """The material with the lowest yield strength; the impactor's of two alike. Not for a scene with arrays."""
        return min(self._yielding, key=lambda m: cast("float", m.initial_strength), default=None)

    @cached_property
    def _yielding(self) -> list[Material]:
        both = self.impactor.material, self.target.material
        return [m for m in both if m is not None and m.initial_strength is not None]

    def _of_first_to_yield(self, value: Callable[[Material], Any]) -> Any:
        """A value of the material with the lowest yield strength; None if no strength is known."""
        known = self._yielding
        if len(known) < 2:
            return value(known[0]) if known else None
        own, other = map(value, known)
        return either(cast("Any", known[0].initial_strength) <= known[1].initial_strength, own, other)

    @cached_property
    def strain_hardening_exponent(self) -> float:
        """n of the body that yields first; 0 if its material gives none."""
        found = self._of_first_to_yield(lambda material: material.hardening_exponent)
        return 0.0 if found is None else found

    @cached_property
    def elastic_share(self) -> float:
        """h of law elastoplastic: the part of the compliance of the body that yields later, or not at all, as far as it
        stays elastic. 0 if a material, or the strength of both, is unknown."""
        one, two = self.impactor.material, self.target.material
        if one is None or two is None or not self._yielding:
            return 0.0
        strengths: list[Any] = [math.inf if m.initial_strength is None else m.initial_strength for m in (one, two)]
        stiff = [m.youngs_modulus / (1.0 - m.poissons_ratio**2) for m in (one, two)]
        flows = [
            flow_of_yield(strength, m.hardening_exponent, m.youngs_modulus, COMPARED_STRAIN)
            for strength, m in zip(strengths, (one, two), strict=True)
        ]
        first = strengths[0] <= strengths[1]
        given = self.yield_strength, self.strain_hardening_exponent, self._of_first_to_yield(lambda m: m.youngs_modulus)
        ratio = either(first, *reversed(flows)) / flow_of_yield(*given, COMPARED_STRAIN)
        return FITTED.elastic_share(ratio, either(first, *reversed(stiff)) / either(first, *stiff))

    @cached_property
    def softer_curvature(self) -> float:
        """x of law elastoplastic: the part of the curvature 1/R that the body which yields first has; 0 if h is 0."""
        if not any_of(self.elastic_share > 0.0):
            return 0.0
        own = self._of_first_to_yield(lambda m: (self.impactor if m is self.impactor.material else self.target).radius)
        return lesser(greater(self.effective_radius / own, 0.0), 1.0)

    @cached_property
    def rate_hardening(self) -> RateHardening | None:
        """The rate law of the body that yields first; None if it is unknown, with nan where it is for some of many
        impacts."""
        constants = [self._of_first_to_yield(lambda material, k=k: rate_constants(material)[k]) for k in range(3)]
        if constants[0] is None or np.isnan(constants[0]).all():
            return None
        return RateHardening(*constants)

    @cached_property
    def poissons_ratio(self) -> float | None:
        """The value in [contact], or that of the body that yields first; without yield strengths, the target's."""
        if self.contact.poissons_ratio is not None:
            return self.contact.poissons_ratio
        own, other = self.target.material, self.impactor.material
        if own is None or other is None:
            only = own or other
            return None if only is None else only.poissons_ratio
        one, two = (math.inf if m.initial_strength is None else m.initial_strength for m in (own, other))
        return either(one <= two, own.poissons_ratio, other.poissons_ratio)

    @cached_property
    def stressed_poissons_ratio(self) -> float | None:
        """The value in [contact], or the smaller one of the bodies: where it is smaller, the shear stress is larger."""
        known = [m.poissons_ratio for m in (self.impactor.material, self.target.material) if m is not None]
        if self.contact.poissons_ratio is not None or not known:
            return self.contact.poissons_ratio
        return either(known[0] <= known[-1], known[0], known[-1])

    @property
    def work_of_adhesion(self) -> float | None:
        """The value in [contact], or 2 √(γ₁ γ₂) from the materials' surface energies, J/m²; None if unknown."""
        if self.contact.work_of_adhesion is not None:
            return self.contact.work_of_adhesion
        energies = [m and m.surface_energy for m in (self.impactor.material, self.target.material)]
        return None if None in energies else 2.0 * root(math.prod(cast("list[float]", energies)))

    @cached_property
    def slope_coefficient(self) -> float | None:
        """c of law large-slope; None if it is unknown, or contact is not that of a ball."""
        return slope_coefficient(self.impactor, self.target, self.effective_modulus) if self.is_round else None

    @cached_property
    def approach_velocity(self) -> float:
        """Velocity of the impactor relative to the target when contact begins, m/s."""
        return self.impactor.speed - self.target.velocity

    @cached_property
    def target_impedance(self) -> float:
        """Wave impedance of the target, N·s/m; infinite if it has none: a half-space, a beam, a free body."""
        return self.target.impedance

    @cached_property
    def kinetic_energy(self) -> float:
        """½ m v² of the effective mass at the approach velocity, J: the impact energy."""
        return 0.5 * self.effective_mass * self.approach_velocity**2

    @cached_property
    def hertz_stiffness(self) -> float:
        """K of F = K δ^{3/2}, the elastic contact of a ball, N/m^1.5; nan without the effective modulus."""
        own = self.effective_modulus
        return hertz_stiffness(math.nan if own is None else own, self.effective_radius)

    @cached_property
    def elastic_impact(self) -> tuple[float, float]:
        """Contact time 2.943 (5 m/(4 K))^{2/5} V^{-1/5} [s] and largest force K (5 m V²/(4 K))^{3/5} [N] of the elastic
        impact of a ball; nan without the effective modulus."""
        stiffness, shape = self.hertz_stiffness, 2.9432751843  # 2 √π Γ(7/5)/Γ(9/10): contact time × velocity/depth
        duration = (
            shape * (1.25 * self.effective_mass / stiffness) ** 0.4 * greater(self.approach_velocity, 1e-300) ** -0.2
        )
        return duration, stiffness * (2.5 * self.kinetic_energy / stiffness) ** 0.6

    @cached_property
    def yield_point(self) -> tuple[float, float] | None:
        """Indentation [m] and force [N] at first yield in slow loading; None without a strength or a modulus."""
        strength, modulus = self.yield_strength, self.effective_modulus
        if strength is None or modulus is None:
            return None
        return yield_point(modulus, self.effective_radius, strength)

    @cached_property
    def reaches_yield(self) -> bool | None:
        """Whether the impact energy and the work of the weight exceed the elastic work up to the yield point,
        0.4 F_y δ_y; None if unknown, or not of a ball."""
        if self.yield_point is None or not self.is_round:
            return None
        (indentation, force), light = self.yield_point, self.effects.gravity is False or self.target.free
        weight = 0.0 if light else self.effective_mass * STANDARD_GRAVITY
        return self.kinetic_energy + weight * indentation > 0.4 * force * indentation

    @cached_property
    def can_yield(self) -> bool:
        """Whether S_y/E is in the range of the law that yields."""
        strength, modulus = self.yield_strength, self.effective_modulus
        if strength is None or modulus is None:
            return True
        return (strength >= LEAST_YIELD_STRAIN * modulus) & (strength < MOST_YIELD_STRAIN * modulus)

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """Sentences about numbers that are possible, but more often a mistake of units."""
        return remarks_about(self)

    @cached_property
    def effect_tolerance(self) -> float:
        """Largest relative change of the summary by a neglected effect; see :class:`Effects`."""
        given = self.effects.tolerance
        return tolerance_for(self.solver.accuracy or 0.0) if given is None else given

    def _wrong_types(self) -> list[Mistake]:
        kinds = zip(self.__dataclass_fields__, (Sphere, AbstractTarget, Contact, Effects, Solver, str), strict=True)
        wrong = {name: kind for name, kind in kinds if not isinstance(getattr(self, name), kind)}
        allowed = {name: TARGETS.values() if name == "target" else [kind] for name, kind in wrong.items()}
        names = {name: " or ".join(one.__name__ for one in kinds) for name, kinds in allowed.items()}
        given = {name: shown(getattr(self, name)) for name in wrong}
        return [mistake(self, name, f"{given[name]} is not allowed: {names[name]} is needed") for name in wrong]


def scene_of(table: dict[str, Any], text: str, name: str, folder: str | None) -> Scene:
    """The scene in the table of a text. name: of its file, in messages. folder: of relative paths; None: no paths."""
    refuse_others(table, text, name)
    find_files(table, text, name, folder)
    try:
        return Scene.from_table(table)
    except SceneError as error:
        raise placed(error.mistakes, text, name) from None
