"""What a contact law is: scales and a few dimensionless stages.

A law gives two scales, an indentation δ_s and a force F_s, and its loading stages as functions of ξ = δ/δ_s that
return f = F/F_s. Nothing else is needed: work is integrated, functions that the core cannot evaluate are fitted
(:mod:`film_model.curve`), and the motion is the core's affair.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

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
    """The elastic branch f = f_m ((ξ − ξ_f)/(ξ_m − ξ_f))^q on which a contact that turned at ξ_m opens and reloads.

    Give one of

    * `radius_ratio` R_d/R as a function of ξ_m: ξ_m − ξ_f = (f_m/√(R_d/R))^(1/q), which is Hertz with the deformed
      radius R_d when the force scale is F_s = K δ_s^{3/2};
    * `residual` ξ_f as a function of ξ_m.

    `exponent` q may be a function of ξ_m too.
    """

    radius_ratio: Function | None = None
    residual: Function | None = None
    exponent: Function | float = 1.5

    def __post_init__(self) -> None:
        if (self.radius_ratio is None) == (self.residual is None):
            raise ValueError("Unloading: give one of radius_ratio and residual, not both and not neither")


@dataclass(frozen=True)
class Stage:
    """One loading stage, begin ≤ ξ ≤ end, of a law.

    force: f(ξ). work: ∫f dξ from `begin`, if it is known in closed form (else it is integrated from the fit).
    unloading: the branch of a contact that turns in this stage; None: it goes back along the loading curve.
    root: the force is smooth in √(ξ − begin) rather than in ξ (only asked of functions that are fitted).
    """

    name: str
    begin: float
    end: float
    force: Function
    unloading: Unloading | None = None
    work: Callable[[Array], Array] | None = None
    root: bool = False


@dataclass(frozen=True)
class Parameter:
    """A law's own entry in a scene's [contact]: its dimension or its choices, and whether it may be left out."""

    help: str
    dimension: str = "dimensionless"
    choices: tuple[str, ...] = ()
    required: bool = True
    minimum: float | None = None
    above: float | None = 0.0


class AbstractLaw(ABC):
    """A contact law. Implementations are frozen dataclasses whose fields are SI floats.

    Fields named `effective_modulus` [Pa], `radius` [m] and `yield_strength` [Pa] are filled from the scene; all
    others are the law's own `parameters`, by their names in the scene file.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    source: ClassVar[str]
    parameters: ClassVar[Mapping[str, Parameter]] = {}

    @abstractmethod
    def scales(self, energy: float) -> tuple[float, float]:
        """Indentation scale δ_s [m] and force scale F_s [N].

        A law with no scale of its own (Hertz, Meyer) takes one from the impact energy [J], so that numbers in the
        march are near one.
        """

    @abstractmethod
    def stages(self) -> tuple[Stage, ...]:
        """The loading stages in order; the first begins at 0 and each begins where the one before ends."""


def law_fields(law: type[AbstractLaw]) -> Mapping[str, Any]:
    """The dataclass fields of a law, by name."""
    return getattr(law, "__dataclass_fields__", {})
