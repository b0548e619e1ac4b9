"""What a contact law is: scales and a few dimensionless stages.

A law gives two scales, an indentation δ_s and a force F_s, and its loading stages as functions of ξ = δ/δ_s that
return f = F/F_s. Nothing else is needed: work is integrated, functions that the core cannot evaluate are fitted
(:mod:`film_model.curve`), and the motion is the core's affair.
"""

from __future__ import annotations

import math
import numbers
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from film_model.errors import shown

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Power:
    """f(ξ) = constant + slope·x + coefficient·x^exponent with x = ξ − origin; the core evaluates it exactly.

    `origin` defaults to the beginning of the stage the function belongs to.
    """

    constant: float = 0.0
    slope: float = 0.0
    coefficient: float = 0.0
    exponent: float = 1.5
    origin: float | None = None


Function = Power | Callable[[Array], Array]
"""A function of ξ: a :class:`Power`, or any callable on arrays, which is fitted."""


@dataclass(frozen=True)
class Unloading:
    """The branch f = f_m ((ξ − ξ_f)/(ξ_m − ξ_f))^q on which a contact that turned at ξ_m opens and reloads.

    Give one of, as a function of ξ_m,

    * `radius_ratio` R_d/R: ξ_m − ξ_f = (f_m/√(R_d/R))^(1/q), which is Hertz with the deformed radius R_d when the
      force scale is F_s = K δ_s^{3/2};
    * `residual` ξ_f;
    * `secant`, the stiffness f_m/(ξ_m − ξ_f) of the chord; ξ_f is not below 0;
    * `shifted` c: the branch is f = f_m − c (ξ_m^q − ξ^q) down to f = 0, the curve c ξ^q moved down.

    `exponent` q may be a function of ξ_m too. `reload_exponent` r ≤ q: a contact that is pushed in again does so along
    f_m ((ξ − ξ_f)/(ξ_m − ξ_f))^r up to the turning point, and not the way it opened.
    """

    radius_ratio: Function | None = None
    residual: Function | None = None
    secant: Function | None = None
    shifted: Function | None = None
    exponent: Function | float = 1.5
    reload_exponent: float | None = None

    def __post_init__(self) -> None:
        if sum(rule is not None for rule in self._rules().values()) != 1:
            raise ValueError("Unloading: give one of " + ", ".join(self._rules()))
        r, q = self.reload_exponent, self.exponent
        if r is not None and not (r > 0.0 and not (isinstance(q, float | int) and r > q)):
            raise ValueError(f"Unloading: reload_exponent {r!r} must be > 0 and at most the exponent: it gives energy")

    def _rules(self) -> dict[str, Function | None]:
        names = ("radius_ratio", "residual", "secant", "shifted")
        return {name: getattr(self, name) for name in names}

    @property
    def rule(self) -> tuple[str, Function]:
        """Which of the four was given, and the function."""
        return next((name, function) for name, function in self._rules().items() if function is not None)


@dataclass(frozen=True)
class Stage:
    """One loading stage, begin ≤ ξ ≤ end, of a law.

    force: f(ξ). work: ∫f dξ from `begin`, if it is known in closed form: a check, since what is used is integrated.
    unloading: the branch of a contact that turns in this stage; None: it goes back along the loading curve.
    root: the force is smooth in √(ξ − begin) rather than in ξ (only asked of functions that are fitted). knots: where,
    inside the stage, the force is less smooth than elsewhere; a fitted function is fitted piece by piece between them.
    damping: c(ξ) over the law's `damping_factor`, for F = f + c ξ̇; only a law of one reversible stage may have it.
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


def origin_of(power: Power, stage: Stage) -> float:
    """ξ from which a power of a stage is counted: its own origin, or where the stage begins."""
    return stage.begin if power.origin is None else power.origin


@dataclass(frozen=True)
class Parameter:
    """A law's own entry in a scene's [contact]: its dimension or its choices, and whether it may be left out.

    dimension: of `units.DIMENSIONS`, or "meyer_stiffness" (N/m^q with the entry `exponent`), or "file" (a path).
    several: a list of values.
    """

    help: str
    dimension: str = "dimensionless"
    choices: tuple[str, ...] = ()
    required: bool = True
    minimum: float | None = None
    above: float | None = 0.0
    several: bool = False


class AbstractLaw(ABC):
    """A contact law. Implementations are frozen dataclasses whose fields are SI floats.

    Fields named `effective_modulus` [Pa], `radius` [m], `yield_strength` [Pa] and `poissons_ratio` are filled from the
    scene; all others are the law's own `parameters`, by their names in the scene file.

    validity: in a sentence, where the law is right. default_unloading: name of the unloading rule
    (:mod:`film_model.laws.unloading`) of a law that has none of its own. damped: its stage has damping.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    source: ClassVar[str]
    validity: ClassVar[str] = ""
    parameters: ClassVar[Mapping[str, Parameter]] = {}
    default_unloading: ClassVar[str | None] = None
    damped: ClassVar[bool] = False

    @abstractmethod
    def scales(self, energy: float) -> tuple[float, float]:
        """Indentation scale δ_s [m] and force scale F_s [N].

        A law with no scale of its own (Hertz, Meyer) takes one from the impact energy [J], so that numbers in the
        march are near one.
        """

    @abstractmethod
    def stages(self) -> tuple[Stage, ...]:
        """The loading stages in order; the first begins at 0 and each begins where the one before ends."""

    @classmethod
    def settle(cls, values: dict[str, Any]) -> dict[str, str]:
        """What is wrong between the law's own parameters, by their names; `values` may be completed in place."""
        return {}

    def damping_factor(self, mass: Any, velocity: Any, length: float) -> Any:
        """What the stage's damping is to be multiplied with [N s/m]; 0 for a law without damping.

        mass: effective, kg, and velocity: of approach, m/s, which may be arrays; length: δ_s, m.
        """
        return 0.0

    def remarks(self) -> tuple[str, ...]:
        """What a user of this law with these values should know, in sentences."""
        return ()


def law_fields(law: type[AbstractLaw]) -> Mapping[str, Any]:
    """The dataclass fields of a law, by name."""
    return getattr(law, "__dataclass_fields__", {})


def wrong_restitution(values: Mapping[str, Any], other: str | None = None) -> dict[str, str]:
    """What is wrong with a law's restitution, or with the parameter `other` that may be given instead of it."""
    restitution = values.get("restitution")
    if other is not None and (restitution is None) == (values.get(other) is None):
        return {other: f"give restitution or {other}" + ("" if restitution is None else ", not both")}
    if restitution is not None and not 0.0 < restitution <= 1.0:
        return {"restitution": f"{restitution:g} must be above 0 and at most 1"}
    return {}


_OF_THE_SCENE = {
    "effective_modulus": (0.0, math.inf),
    "radius": (0.0, math.inf),
    "yield_strength": (0.0, math.inf),
    "poissons_ratio": (-1.0, 0.5),
}
"""Fields that are filled from the scene, and the ends between which they lie."""


def wrong_values(law: AbstractLaw) -> dict[str, str]:
    """What is wrong with the values of a law that was made in Python, by their names: what a scene would refuse."""
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
        elif parameter is not None or name in _OF_THE_SCENE:
            low, high = _OF_THE_SCENE.get(name, (-math.inf, math.inf))
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
    """ValueError for what `settle` finds wrong with a law's own values."""
    for name, message in type(law).settle(dict(vars(law))).items():
        raise ValueError(f"{type(law).__name__}.{name}: {message}")
