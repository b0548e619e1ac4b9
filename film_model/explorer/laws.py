"""The laws that the page offers: their curves, and the formulas of their scales."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from film_model.base.fields import measure
from film_model.base.units import DIMENSIONS
from film_model.explorer.formulas import (
    FROM_SCENE,
    LEAST_RESTITUTION,
    entry_of,
    example_function,
    problem_function,
    varying_of,
)
from film_model.explorer.inputs import Input
from film_model.laws import LAWS, AbstractLaw
from film_model.laws.example_ball import STEEL_BALL, example_ball
from film_model.laws.law import law_fields
from film_model.oblique.friction import convex_power
from film_model.problem.curve import Curve, can_be_in_series, curve_of
from film_model.problem.families import EDGES, Page, page_between, page_of, shared_part
from film_model.problem.law_of_scene import SceneLaw, law_named
from film_model.scene import Scene

FAMILIES = ("elastic", "yields", "damped")
"""Families whose laws are offered for every scene; the law that a scene names is offered too."""

ALL_SHAPES = float(EDGES[0]), float(EDGES[-1])
"""Least and largest shape of a law that the page has."""

_OWN_RANGE = (1e-6, 1e6)
"""Range of a law's own parameter, over its value in the scene or in the law's example."""


@dataclass(frozen=True)
class PageLaw:
    """A law as the page has it.

    law: with the scene's values. derived: its required parameters follow from them, unless the reader gives others.
    fixed: names of values on which the curve depends. The page offers the law only for these values of them.
    """

    name: str
    law: AbstractLaw
    derived: bool
    fixed: frozenset[str]

    @property
    def page(self) -> Page | None:
        """The curves of all shapes that a law with a shape may have here, with one value for all scenes of the numbers
        beside it that the page changes: its formulas compute what depends on them."""
        if page_of(self.law) is None:
            return None
        beside = {
            name: ends for name, ends in self.law.shaped_beside.items() if entry_of(name, type(self.law)) in FROM_SCENE
        }
        middle = {name: 0.5 * sum(ends) for name, ends in beside.items() if name not in self.fixed}
        one: Any = self.law.of_shape(EDGES[2])
        return page_between(replace(one, **middle), *ALL_SHAPES)

    @property
    def curve(self) -> Curve:
        """Its curve."""
        return curve_of(self.law)

    @property
    def _derived(self) -> list[str]:
        return list(LAWS[self.name].example(STEEL_BALL)) if self.derived else []

    @cached_property
    def live(self) -> tuple[str, ...]:
        """Its own parameters that may change on the page: the curve does not depend on them."""
        return tuple(name for name, value in self.own.items() if name in self._derived or self._may_change(name, value))

    def _may_change(self, name: str, value: Any) -> bool:
        plain = isinstance(value, float) and LAWS[self.name].parameters[name].dimension in DIMENSIONS
        if name == "restitution":
            return plain and value >= LEAST_RESTITUTION
        return plain and value > 0.0 and not _shapes(self.law, name, (0.7, 0.9))  # a factor says nothing of 0

    def _inputs(self) -> Iterator[Input]:
        for name in self.live:
            value, dimension = self.own[name], LAWS[self.name].parameters[name].dimension
            low, high = _OWN_RANGE[0] * value, _OWN_RANGE[1] * (value or 1.0)
            if name == "restitution":
                low, high = LEAST_RESTITUTION, 1.0
            yield Input(f"contact.{name}", measure(dimension, low, high), value)

    @property
    def own(self) -> Mapping[str, Any]:
        """Its own parameters, SI or words."""
        inner = getattr(self.law, "law", self.law)
        names = self._derived if self.derived else type(inner).parameters
        return {name: getattr(inner, name) for name in names if getattr(inner, name, None) is not None}

    def function(self, template: Scene) -> str:
        """The JavaScript of its scales and starting values."""
        return problem_function(template, self.law, self.fixed, self.live)

    @property
    def example(self) -> str:
        """The JavaScript of its required parameters from the scene."""
        return example_function(LAWS[self.name]) if self.derived else ""

    @property
    def embedded(self) -> bytes:
        """The curve for the page; of a law with a shape, all pieces that any needs, without what the shape gives."""
        if self.page is None:
            return bytes(self.curve.native)
        doubles = np.frombuffer(bytes(self.page.whole)).copy()
        doubles[places_of(self.page)] = 0.0
        return doubles.tobytes()

    def to_dict(self, function: str, place: int) -> dict[str, Any]:
        """What the page needs of it. place: of its curve among the curves of the page."""
        curve, kind = self.curve, LAWS[self.name]
        return {
            "name": self.name,
            "family": kind.family,
            "function": function,
            "curve": place,
            "stages": list(curve.stage_names),
            "fit_error": curve.fit_error,
            "clearance": curve.clearance,
            "ratio": curve.unloading_ratio,
            "dissipates": not curve.reversible,
            "first_end": end if math.isfinite(end := curve.stages[0].end) else None,
            "power": None
            if (power := convex_power(curve)) is None
            else [power.slope, power.coefficient, power.exponent],
            "series": can_be_in_series(self.law, 1e6),
            "remarks": [*self.law.remarks(), *curve.warnings],
            "shape": None if self.page is None else _shape_data(self.page, varying_of(self.law)),
            "needs": [
                entry
                for name in law_fields(kind)
                if (entry := entry_of(name, kind)) in FROM_SCENE and name not in self.fixed
            ],
            "derived": self.derived,
            "live": [
                entry.to_dict() | ({"value": None, "optional": True, "empty": "example"} if self.derived else {})
                for entry in self._inputs()
            ],
            "fixed": {entry_of(name, kind): value for name, value in _values(self.law).items() if name in self.fixed},
            "own": {key: list(value) if isinstance(value, tuple) else value for key, value in self.own.items()},
        }


def laws_of(scene: Scene, names: Iterable[str] = LAWS) -> Iterator[PageLaw]:
    """The laws among `names` that a scene allows: the scene's own, and those of `FAMILIES`."""
    for name, kind in ((name, LAWS[name]) for name in names):
        own = scene.contact.law == name
        if not (own or (kind.family in FAMILIES and _plain(kind))):
            continue
        try:
            law = _law(scene, name, own)
        except (TypeError, ValueError):  # a value is missing, or outside the law's range
            continue
        absent = {field for field in _values(law) if getattr(scene, entry_of(field, kind)) is None}
        fixed = absent | {field for field in _values(law) if _shapes(law, field)}
        if not curve_of(law).pulls:
            yield PageLaw(name, law, not own and bool(kind.example(STEEL_BALL)), frozenset(fixed))


def _law(scene: Scene, name: str, own: bool) -> AbstractLaw:
    """A named law with the scene's values, and with those of its example if the scene does not have them."""
    kind = LAWS[name]
    if own or not kind.example(STEEL_BALL):
        law = law_named(scene, name).at()
    else:
        ball = example_ball(
            *(getattr(scene, entry) for entry in ("effective_modulus", "effective_radius", "flow_strength")),
            *(getattr(scene, entry) for entry in ("poissons_ratio", "effective_mass", "approach_velocity")),
        )
        named = law_named(scene, name)
        rule = None if kind.damped else named.rule
        law = SceneLaw(kind, {**named.values, **kind.example(ball)}, rule, named.sphere).at()
    law.scales(1.0)
    return law


def _plain(kind: type[AbstractLaw]) -> bool:
    """Whether the parameters of the law's example have plain units."""
    return all(kind.parameters[name].dimension in DIMENSIONS for name in kind.example(STEEL_BALL))


def _values(law: AbstractLaw) -> dict[str, Any]:
    """The values that a law, and the law inside it, take from the scene."""
    inner = getattr(law, "law", None)
    found = _values(inner) if isinstance(inner, AbstractLaw) else {}
    return found | {name: value for name, value in vars(law).items() if entry_of(name, type(law)) in FROM_SCENE}


def _changed(law: AbstractLaw, name: str, factor: float) -> AbstractLaw:
    changes: dict[str, Any] = {}
    for field, value in vars(law).items():
        if isinstance(value, AbstractLaw):
            changes[field] = _changed(value, name, factor)
        elif field == name:
            # of 0 a factor says nothing
            changes[field] = (value or 0.1) * factor
    return replace(law, **changes)  # type: ignore[type-var]


def _shapes(law: AbstractLaw, name: str, probes: tuple[float, ...] = (0.7, 1.3)) -> bool:
    """Whether the dimensionless curve depends on a value; of a law with a shape, what it does not compute from n."""
    if page_of(law) is not None and name in (*law.shaped_by, *law.shaped_beside):
        return False
    try:
        base = _rest(law)
        return any(_rest(_changed(law, name, factor)) != base for factor in probes)
    except ValueError:
        return True


def _rest(law: AbstractLaw) -> Any:
    """The part of the curve that the page has as it is."""
    if page_of(law) is None:
        return bytes(curve_of(law).native)
    return shared_part(law.stages())


def _shape_data(page: Page, names: tuple[str, ...]) -> dict[str, Any]:
    """The pieces of the last stage, and the places in the curve of what depends on the shape, piece by piece.

    names: of the functions that do; their terms follow those of the force and of its mean.
    """
    whole = page.whole
    first = whole.stage[whole.stages - 1].first
    ends = [whole.piece[k].end for k in range(first, whole.pieces)]
    series = ("force", "mean", *names[1:])
    terms = [[getattr(whole.piece[k], name).terms for name in series] for k in range(first, whole.pieces)]
    begin = whole.stage[whole.stages - 1].begin
    found = {"edges": [begin, *ends], "terms": terms, "places": places_of(page)}
    return found | {"names": list(names), "range": list(ALL_SHAPES)}


def places_of(page: Page) -> list[int]:
    """The places in the curve, among its doubles, of what depends on the shape."""
    family = page.family
    return family.memory[family.nodes : family.nodes + family.varying].astype(int).tolist()
