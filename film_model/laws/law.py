"""The interface of a contact law: two scales and a few dimensionless stages.

A law gives an indentation scale δ_s, a force scale F_s, and its loading stages as functions of ξ = δ/δ_s that return
f = F/F_s. The package derives the rest: it integrates the work, fits functions that the core cannot evaluate
(:mod:`film_model.problem.curve`), and the core computes the motion. docs/adding_a_law.md shows a complete law.
"""

from __future__ import annotations

import math
import numbers
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from film_model.base.arrays import Array, all_of
from film_model.base.errors import shown

Family = Literal["elastic", "yields", "spring", "measured", "damped", "adhesive"]
FAMILIES: dict[Family, str] = {
    "elastic": "elastic",
    "yields": "spheres that yield",
    "spring": "springs",
    "measured": "laminates and tables",
    "damped": "damped",
    "adhesive": "adhesive",
}
"""Families of laws with the headings under which pictures and pages show them, in their order."""


@dataclass(frozen=True)
class Power:
    """f(ξ) = constant + slope·x + square·x² + coefficient·x^exponent, x = ξ − origin; the core evaluates it exactly.

    `origin` defaults to the beginning of the stage the function belongs to.
    """

    constant: float = 0.0
    slope: float = 0.0
    coefficient: float = 0.0
    exponent: float = 1.5
    origin: float | None = None
    square: float = 0.0

    def at(self, x: Any) -> Any:
        """f at x ≥ 0."""
        return self.constant + (self.slope + self.square * x) * x + self.coefficient * x**self.exponent

    def work(self, x: Any) -> Any:
        """∫f dx from 0 to x ≥ 0."""
        power = self.coefficient * x**self.exponent / (self.exponent + 1.0)
        return x * (self.constant + (0.5 * self.slope + self.square * x / 3.0) * x + power)


Function = Power | Callable[[Array], Array]
"""A function of ξ: a :class:`Power`, which the core evaluates, or any callable on arrays, which is fitted."""


@dataclass(frozen=True)
class Unloading:
    """The branch f = f_m ((ξ − ξ_f)/(ξ_m − ξ_f))^q of a contact that turned at ξ_m, for unloading and reloading.

    Give exactly one of these, as a function of ξ_m:

    * `radius_ratio` R_d/R: ξ_m − ξ_f = (f_m/√(R_d/R))^(1/q), which is Hertz with the deformed radius R_d when the
      force scale is F_s = K δ_s^{3/2};
    * `residual` ξ_f;
    * `secant`, the stiffness f_m/(ξ_m − ξ_f) of the chord; a negative ξ_f is replaced by 0;
    * `shifted` c: the branch is f = f_m − c (ξ_m^q − ξ^q) down to f = 0, that is the curve c ξ^q moved down;
    * `contact_area` α², of a law that pulls: its reversible stages f₀, stretched, f = r f₀((ξ − ξ_f)/l), through
      (ξ_m, f_m). r = α³/(f_m + 2 α^{3/2}), at least 1, is the radius of curvature of the JKR contact of radius α a_c
      under f_m, over that of f₀; l = r^{1/3}. Between ξ_f and the end of contact the force does as in those stages.

    `exponent` q may be a function of ξ_m too. `reload_exponent` r ≤ q: reloading follows
    f_m ((ξ − ξ_f)/(ξ_m − ξ_f))^r up to the turning point instead of the unloading branch.
    """

    radius_ratio: Function | None = None
    residual: Function | None = None
    secant: Function | None = None
    shifted: Function | None = None
    contact_area: Function | None = None
    exponent: Function | float = 1.5
    reload_exponent: float | None = None

    def __post_init__(self) -> None:
        if sum(rule is not None for rule in self._rules().values()) != 1:
            raise ValueError("Unloading: give exactly one of " + ", ".join(self._rules()))
        r, q = self.reload_exponent, self.exponent
        if r is not None and not (r > 0.0 and not (isinstance(q, float | int) and r > q)):
            raise ValueError(
                f"Unloading: reload_exponent {r!r} must be > 0 and at most the exponent: reloading would gain energy"
            )

    def _rules(self) -> dict[str, Function | None]:
        names = ("radius_ratio", "residual", "secant", "shifted", "contact_area")
        return {name: getattr(self, name) for name in names}

    @property
    def rule(self) -> tuple[str, Function]:
        """Name of the rule that was given, and its function."""
        return next((name, function) for name, function in self._rules().items() if function is not None)


@dataclass(frozen=True)
class Stage:
    """One loading stage, begin ≤ ξ ≤ end, of a law.

    force: f(ξ). work: ∫f dξ from `begin`, if a closed form is known; it serves as a check only, the package integrates
    the force. unloading: the branch of a contact that turns in this stage; None: unloading retraces the loading curve.
    root: the force is smooth in √(ξ − begin) rather than in ξ (used only for functions that are fitted). knots: points
    inside the stage where a derivative of the force jumps; the fit is made piecewise between them.
    damping: c(ξ) divided by the law's `damping_factor`, for F = f + c ξ̇; only for a law of one reversible stage.
    pulls: the force may be negative; only for a law whose stages are reversible or, after those, unload by
    `contact_area`. Its first stage may begin below 0: contact then begins at 0 and ends where that stage begins. reach:
    how far the force of the last reversible stage is known beyond its end, for the branches of the stages after it.
    """

    name: str
    begin: float
    end: float
    force: Function
    unloading: Unloading | None = None
    work: Callable[[Array], Array] | None = None
    root: bool = False
    knots: tuple[float, ...] = ()
    damping: Function | None = None
    pulls: bool = False
    reach: float | None = None


def origin_of(power: Power, stage: Stage) -> float:
    """Origin of a power of a stage: its own, or the beginning of the stage."""
    return stage.begin if power.origin is None else power.origin


@dataclass(frozen=True)
class Parameter:
    """A law's own entry in the [contact] table of a scene: its dimension or its choices, and whether it is required.

    dimension: a key of `units.DIMENSIONS`, "meyer_stiffness" (N/m^q, q from the entry `exponent`) or "file" (a path).
    minimum, above: the value must be >= minimum or > above. several: the entry is a list of values.
    over_strength: an entry that is not given is this many times the strength of the body that yields.
    """

    help: str
    dimension: str = "dimensionless"
    choices: tuple[str, ...] = ()
    required: bool = True
    minimum: float | None = None
    above: float | None = 0.0
    several: bool = False
    over_strength: float | None = None


@dataclass(frozen=True)
class ExampleBall:
    """The ball of the gallery, from which a law derives example values of its own parameters. SI.

    velocity: of approach. stiffness: Hertz's K, N/m^1.5. depth: the largest indentation under Hertz's law, m.
    """

    effective_modulus: float
    radius: float
    yield_strength: float
    poissons_ratio: float
    mass: float
    velocity: float
    stiffness: float
    depth: float

    @property
    def spring(self) -> float:
        """Stiffness [N/m] of a linear spring that the ball compresses about as far as Hertz's law."""
        return 0.6 * self.stiffness * self.depth**0.5


class AbstractLaw(ABC):
    """A contact law. Implementations are frozen dataclasses whose fields are SI floats.

    Fields named `effective_modulus` [Pa], `radius` [m], `yield_strength` [Pa] and `poissons_ratio` are filled from the
    scene; all others are the law's own `parameters`, by their names in the scene file.

    name: in scene files. summary, source, validity: one phrase each for lists and pages; validity is the range in which
    the law holds. family: a key of `FAMILIES`; laws of a user's own script need none. default_unloading: name of the
    unloading rule (:mod:`film_model.laws.unloading`) for a law without one. damped: the stage of the law has damping.
    shaped_by: fields that enter the stages through `shape` only. shaped_beside: up to three more fields on which
    the functions and the end of the last stage depend smoothly, and the ends of their ranges. widening: a²/(R δ) of a
    contact of radius a that is not Hertz's; 0: that of law elastoplastic. steep: the force is that of steep surfaces.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    source: ClassVar[str]
    family: ClassVar[Family]
    validity: ClassVar[str] = ""
    parameters: ClassVar[Mapping[str, Parameter]] = {}
    default_unloading: ClassVar[str | None] = None
    damped: ClassVar[bool] = False
    steep: ClassVar[bool] = False
    widening: ClassVar[float] = 0.0
    shaped_by: ClassVar[tuple[str, ...]] = ()
    shaped_beside: ClassVar[Mapping[str, tuple[float, float]]] = {}

    @abstractmethod
    def scales(self, energy: float) -> tuple[float, float]:
        """Indentation scale δ_s [m] and force scale F_s [N].

        A law without a scale of its own (Hertz, Meyer) derives one from the impact energy [J], so that dimensionless
        values are of order one.
        """

    @abstractmethod
    def stages(self) -> tuple[Stage, ...]:
        """The loading stages in order; the first begins at 0 and each begins where the one before ends."""

    @property
    def shape(self) -> Any:
        """The one number on which functions and end of the last stage depend smoothly, such as S_y/E; None: none.

        For a law with a shape, the curves of all shapes are fitted together (:mod:`film_model.problem.families`).
        """
        return None

    def of_shape(self, shape: float) -> AbstractLaw:
        """The law with another shape. It is the same for laws that differ in shape and scales only."""
        raise NotImplementedError

    @classmethod
    def example(cls, ball: ExampleBall) -> Mapping[str, Any]:
        """Values, SI, of the law's required own parameters for a ball: pictures and tests run the law with them."""
        return cls.over_strength(ball.yield_strength)

    @classmethod
    def over_strength(cls, strength: Any) -> dict[str, Any]:
        """The own parameters that are multiples of the strength of the body that yields."""
        own = cls.parameters.items()
        return {name: each.over_strength * strength for name, each in own if each.over_strength is not None}

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        """Check the law's own parameters against each other: messages by name, empty if all is well.

        May complete `values` in place.
        """
        return {}

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        """Factor of the stage's damping [N s/m]; 0 for a law without damping.

        mass: effective, kg, and velocity: of approach, m/s, may be arrays. length: δ_s, m.
        """
        return 0.0

    def outside(self, depth: float) -> str:
        """What of an impact that reaches `depth` δ_s is outside the range in which the law holds; "" if nothing is."""
        return ""

    def remarks(self) -> tuple[str, ...]:
        """Warnings about this law with these values, in sentences."""
        return ()


def law_fields(law: type[AbstractLaw]) -> Mapping[str, Any]:
    """The dataclass fields of a law, by name."""
    return getattr(law, "__dataclass_fields__", {})


def wrong_restitution(values: Mapping[str, Any], other: str | None = None) -> dict[str, str]:
    """Message, by name, about a restitution outside (0, 1]; with `other`, also unless exactly one of both is given."""
    restitution = values.get("restitution")
    if other is not None and (restitution is None) == (values.get(other) is None):
        return {other: f"give restitution or {other}" + ("" if restitution is None else ", not both")}
    if restitution is None or all_of((restitution > 0.0) & (restitution <= 1.0)):
        return {}
    given = np.atleast_1d(restitution)
    return {"restitution": f"{given[~((given > 0.0) & (given <= 1.0))][0]:g} must be above 0 and at most 1"}


SCENE_FIELDS = {
    "effective_modulus": (0.0, math.inf),
    "radius": (0.0, math.inf),
    "yield_strength": (0.0, math.inf),
    "poissons_ratio": (-1.0, 0.5),
}
"""Open ranges of the fields that are filled from the scene."""


def wrong_values(law: AbstractLaw) -> dict[str, str]:
    """Messages, by name, about values of a law made in Python that a scene file would not accept."""
    wrong: dict[str, str] = {}
    for name in law_fields(type(law)):
        value, parameter = getattr(law, name), law.parameters.get(name)
        if isinstance(value, AbstractLaw):
            wrong |= wrong_values(value)
        elif parameter is not None and (parameter.several or (value is None and not parameter.required)):
            continue
        elif parameter is not None and parameter.choices:
            if value not in parameter.choices:
                wrong[name] = f"{shown(value)} is not allowed: {' or '.join(map(shown, parameter.choices))} is needed"
        elif parameter is not None or name in SCENE_FIELDS:
            low, high = SCENE_FIELDS.get(name, (-math.inf, math.inf))
            closed = parameter is not None and parameter.above is None
            if parameter is not None:
                least = parameter.minimum if closed else parameter.above
                low = low if least is None else least
            if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
                wrong[name] = f"{shown(value)} is not a finite number; a law's values are SI floats"
            elif not (low < float(value) < high or (closed and value == low)):
                between = f"{'>=' if closed else '>'} {low:g}" + (f" and < {high:g}" if high < math.inf else "")
                wrong[name] = f"{shown(value)} must be {between}"
    given = {name: getattr(law, name) for name in law_fields(type(law)) if getattr(law, name) is not None}
    return wrong or type(law).settle(given)


def raise_wrong(law: AbstractLaw) -> None:
    """Raise ValueError with the first message of `settle` about the law's own values."""
    for name, message in type(law).settle(dict(vars(law))).items():
        raise ValueError(f"{type(law).__name__}.{name}: {message}")
