"""The contact law of a scene, with its values: numbers for one impact, arrays for many."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from typing import Any, cast

import numpy as np

from film_model.base.arrays import ALL, Array, agree, all_of, any_of, column
from film_model.base.errors import Mistake, SceneError
from film_model.laws import LAWS, AbstractLaw, BrakeUnloading, Retrace
from film_model.laws.law import law_fields
from film_model.scene import Scene

ELASTIC, YIELDING, DAMPED = "hertz", "elastoplastic", "tsuji"
"""What law "auto" means below and above yield, and where the losses of the materials matter more than yield;
docs/validation.md compares the laws with measurements."""

STEEP = {ELASTIC: "large-slope", DAMPED: "damped-large-slope"}
"""What law "auto" means in place of these where the slopes of the surfaces matter."""

POWER = "meyer"
"""What law "auto" means for a cone and a flat punch."""

ASSUMED_POISSONS_RATIO = 0.3
"""Of a body that yields under law "auto" if the scene gives none."""

_FROM_SCENE = {
    "effective_modulus": "effective_modulus",
    "radius": "effective_radius",
    "yield_strength": "yield_strength",
    "poissons_ratio": "poissons_ratio",
    "strain_hardening_exponent": "strain_hardening_exponent",
    "elastic_share": "elastic_share",
    "softer_curvature": "softer_curvature",
    "slope_coefficient": "slope_coefficient",
    "work_of_adhesion": "work_of_adhesion",
}
"""Fields of laws that are taken from the scene → properties of the scene."""


@dataclass(frozen=True)
class SceneLaw:
    """The law of one impact or of many.

    law: a law for all impacts, or the class of their laws. values: fields of that class, numbers or arrays with one
    value per impact. rule: name of the unloading rule that replaces the law's own, or None. sphere: arguments of
    Brake's rule.
    """

    law: AbstractLaw | type[AbstractLaw]
    values: Mapping[str, Any]
    rule: str | None
    sphere: Mapping[str, Any]

    @classmethod
    def of(cls, scene: Scene, law: AbstractLaw | type[AbstractLaw]) -> SceneLaw:
        """A law with its values from the scene."""
        values = {} if isinstance(law, AbstractLaw) else law_values(scene, law)
        chosen = scene.contact.law == "auto" and law.damped  # takes no rule of unloading
        rule, sphere = None if chosen else scene.contact.unloading_name, dict[str, Any]()
        if rule == "brake":
            sphere = {"effective_modulus": scene.effective_modulus, "radius": scene.effective_radius}
        return cls(law, values, rule, sphere)

    def at(self, places: Any = None) -> AbstractLaw:
        """The law of one impact; for several impacts, with arrays in its fields."""
        if places is ALL or not self._varies:
            return self._whole
        return self.first if isinstance(places, int) and places == 0 else self._made(places)

    @cached_property
    def _varies(self) -> bool:
        return any([isinstance(value, np.ndarray) for value in (*self.values.values(), *self.sphere.values())])

    @cached_property
    def _whole(self) -> AbstractLaw:
        return self._made(ALL)

    @cached_property
    def first(self) -> AbstractLaw:
        """That of one impact, or of the first of many."""
        return self._made(0)

    def _made(self, places: Any) -> AbstractLaw:
        try:
            law = self.law if isinstance(self.law, AbstractLaw) else self.law(**_picked(self.values, places))
        except ValueError as error:
            raise SceneError([Mistake(None, None, "contact.law", str(error))]) from None
        if self.rule is None:
            return law
        return Retrace(law) if self.rule == "retrace" else BrakeUnloading(law, **_picked(self.sphere, places))

    def value(self, name: str) -> Any:
        """A field of the law; None if it has none of this name."""
        return self.values.get(name, getattr(self.law, name, None))

    @property
    def strength(self) -> Any:
        """The law's yield strength, Pa; None if it has none."""
        return self.value("yield_strength")

    @cached_property
    def read(self) -> dict[str, Array]:
        """The values that vary, and on which the law's stages depend."""
        varying = {name: value for name, value in self.values.items() if isinstance(value, np.ndarray)}
        if isinstance(self.law, AbstractLaw) or not varying:
            return {}
        made: Any = object.__new__(_watched(self.law, tuple(varying)))
        seen = set[str]()
        made.__dict__.update(_picked(self.values, 0), _seen=seen)
        made.stages()
        return {name: value for name, value in varying.items() if name in seen}

    def strengthened(self, factor: Any) -> SceneLaw:
        """The law with `factor` times its yield strength; an array of factors gives one law per impact."""
        values = self.values
        if isinstance(self.law, AbstractLaw):
            values = {one.name: getattr(self.law, one.name) for one in fields(cast("Any", self.law))}
        kind = type(self.law) if isinstance(self.law, AbstractLaw) else self.law
        return SceneLaw(kind, {**values, "yield_strength": self.strength * factor}, self.rule, self.sphere)

    def reduced(self) -> SceneLaw:
        """The same with a number in place of every array of equal values."""
        alike = {name: value for name, value in self.values.items() if isinstance(value, np.ndarray)}
        alike = {name: value.flat[0].item() for name, value in alike.items() if (value == value.flat[0]).all()}
        return SceneLaw(self.law, {**self.values, **alike}, self.rule, self.sphere)

    def part(self, places: Any) -> SceneLaw:
        """The law of some of the impacts."""
        return SceneLaw(self.law, _picked(self.values, places), self.rule, _picked(self.sphere, places))

    def on_arrays(self, formula: Callable[[AbstractLaw, Any], tuple[Any, ...]], count: int) -> list[Array]:
        """A formula of the law and of places, for each of many impacts.

        It is evaluated on whole arrays if this gives the same values (:func:`agree`), otherwise one by one.
        """
        try:
            found = [column(value, count) for value in formula(self.at(ALL), ALL)]
            if count == 1 or agree(found, lambda place: formula(self.at(place), place), count):
                return found
        except (TypeError, ValueError):
            pass
        table = np.array([formula(self.at(place), place) for place in range(count)])
        return list(table.T)


@lru_cache(maxsize=64)
def _watched(law: type[AbstractLaw], names: tuple[str, ...]) -> type[AbstractLaw]:
    """The law with fields that note in `_seen` when they are read."""

    def field(name: str) -> property:
        def value(made: Any) -> Any:
            made._seen.add(name)
            return made.__dict__[name]

        return property(value)

    kind: Any = type(law)  # that of abstract classes
    return kind(law.__name__, (law,), {name: field(name) for name in names})


def _picked(values: Mapping[str, Any], places: Any) -> dict[str, Any]:
    """The values at one place (floats) or at several (arrays)."""
    at = {name: value[places] if isinstance(value, np.ndarray) else value for name, value in values.items()}
    return {name: value.item() if isinstance(value, np.generic) else value for name, value in at.items()}


def law_values(scene: Scene, law: type[AbstractLaw]) -> dict[str, Any]:
    """Values of a law's fields from the scene; with the parameters in [contact] if it is the scene's law."""
    names = law_fields(law)
    filled = {field: getattr(scene, _FROM_SCENE[field]) for field in names if field in _FROM_SCENE}
    if "yield_strength" in filled and "strain_hardening_exponent" not in names:
        filled["yield_strength"] = scene.flow_strength  # see base/flow_stress.py
    if scene.contact.law != law.name and filled.get("poissons_ratio", 0.0) is None:
        filled["poissons_ratio"] = ASSUMED_POISSONS_RATIO
    if scene.flow_strength is not None:
        filled |= law.over_strength(scene.flow_strength)
    if law.name in (DAMPED, STEEP[DAMPED]) and scene.contact.law == "auto" and scene.loss_factor is not None:
        filled["restitution"] = scene.loss_restitution
    if law.name == POWER and scene.contact.law == "auto" and scene.nose is not None:
        filled |= {"stiffness": scene.nose.factor * scene.effective_modulus, "exponent": scene.nose.exponent}
    return filled | (dict(scene.contact.parameters) if scene.contact.law == law.name else {})


def law_named(scene: Scene, name: str) -> SceneLaw:
    """The named law with its values from the scene; [contact] unloading applies only to the law named there."""
    law = SceneLaw.of(scene, LAWS[name])
    return law if scene.contact.law in ("auto", name) else SceneLaw(law.law, law.values, None, {})


def yielding_entries(scene: Scene) -> dict[str, Any]:
    """Entries with which a scene of law "auto" names the law that yields."""
    known = scene.poissons_ratio is not None
    return {"contact.law": YIELDING} | ({} if known else {"contact.poissons_ratio": ASSUMED_POISSONS_RATIO})


def laws_of(scene: Scene) -> list[tuple[AbstractLaw | type[AbstractLaw], Any]]:
    """The laws of a scene's impacts before plasticity is tried: the one of one impact, and True; of a scene with
    arrays each, with which impacts have it, a mask, or True for all."""
    law, plastic = scene.contact.law, scene.effects.plasticity
    if law != "auto":
        return [(law if isinstance(law, AbstractLaw) else LAWS[law], True)]
    if scene.nose is not None:
        return [(LAWS[POWER], True)]
    damps = scene.effects.material_damping if scene.loss_factor is not None else False
    if damps is True and plastic is not True:
        return [(LAWS[STEEP[DAMPED] if scene.effects.small_slope is True else DAMPED], True)]
    if plastic == "auto":
        plastic = False if scene.reaches_yield is None else scene.reaches_yield & scene.can_yield
    if all_of(plastic):
        return [(LAWS[YIELDING], plastic)]
    fixed = scene.effects.small_slope is True and damps is False and plastic is False
    elastic = LAWS[STEEP[ELASTIC] if fixed else ELASTIC], np.logical_not(plastic)
    return [elastic, (LAWS[YIELDING], plastic)] if any_of(plastic) else [elastic]
