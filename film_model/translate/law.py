"""The contract of an engine's contact law: what two bodies meet, parameters with units, the force, and input to paste.

A law is a formula of the engine's manual. The engine's ball strikes a target that moves only if it is a free body, so
one coordinate is enough: m δ'' = −F(δ, δ'), with m the effective mass.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

Values: TypeAlias = Mapping[str, Any]
"""Parameters by name: SI floats, or arrays with one value per impact."""


@dataclass(frozen=True)
class Pair:
    """The two bodies that meet. All SI.

    mass, radius: effective, 1/(1/m + 1/m_t) and 1/(1/R + 1/R_t). ball_mass, ball_radius: of the ball. target_mass,
    target_radius: of the target; infinite mass if it is fixed, infinite radius if flat. poissons_ratio: given to
    engines that take a Young's modulus. velocity: geometric mean of the range. depth: of our impact near it. friction:
    coefficient, None without. ratio: κ = K_n/K_t of the normal and the tangential stiffness, where friction is given;
    poissons_ratio is then that of alike bodies with this κ.
    """

    mass: float
    radius: float
    ball_mass: float
    ball_radius: float
    target_mass: float
    target_radius: float
    poissons_ratio: float
    velocity: float
    depth: float
    friction: float | None = None
    ratio: float = 1.0

    @property
    def fixed(self) -> bool:
        """Whether the target does not move."""
        return math.isinf(self.target_mass)

    def youngs_modulus(self, effective_modulus: Any) -> Any:
        """The Young's modulus that both bodies need for an effective modulus: 1/E* = 2 (1 − ν²)/E."""
        return 2.0 * (1.0 - self.poissons_ratio**2) * effective_modulus

    def effective_modulus(self, youngs_modulus: Any) -> Any:
        """The inverse of `youngs_modulus`."""
        return youngs_modulus / (2.0 * (1.0 - self.poissons_ratio**2))


@dataclass(frozen=True)
class Middle:
    """The impact at the middle velocity, from which a fit begins: SI."""

    velocity: float
    force: float
    duration: float
    restitution: float
    depth: float

    @property
    def damping_ratio(self) -> float:
        """ζ of the linear spring and dashpot that has this restitution: −ln e/√(π² + ln² e)."""
        loss = -math.log(min(max(self.restitution, 0.01), 0.9999))
        return loss / math.hypot(math.pi, loss)

    def damping(self, mass: float) -> float:
        """Damping coefficient of that dashpot beside the spring through the largest force and depth, N s/m."""
        return 2.0 * self.damping_ratio * (mass * self.force / self.depth) ** 0.5

    def stiffness(self, exponent: float) -> float:
        """k of a spring F = k δ^n with this largest force at this depth."""
        return self.force / self.depth**exponent


@dataclass(frozen=True)
class Parameter:
    """A number that an engine asks for. unit: SI, as it is printed. low, high: limits of the engine or of the fit.

    logarithmic: fitted on a logarithmic scale, for values > 0 whose order of magnitude is sought. per_depth: limits are
    multiples of the middle impact's depth.
    """

    name: str
    unit: str
    meaning: str
    low: float = 0.0
    high: float = math.inf
    logarithmic: bool = False
    per_depth: bool = False


@dataclass(frozen=True)
class EngineLaw:
    """One contact law of an engine.

    formula: of the force, for a reader. source: of the formula. force(pair, values, depth, rate): N, before the engine
    cuts off attraction; depth >= 0. start(pair, middle): values from which the fit begins. paste(pair, values): text
    for the engine's input. pulls: whether the engine keeps an attractive force near the end of contact, so that contact
    ends at zero depth instead of zero force. notes: what a user must know. tangential: the engine's models of friction
    and the springs of `film_model.studies.tangential_models` that they are; the first is pasted.
    """

    name: str
    formula: str
    source: str
    parameters: tuple[Parameter, ...]
    force: Callable[[Pair, Values, Any, Any], Any]
    start: Callable[[Pair, Middle], dict[str, float]]
    paste: Callable[[Pair, Values], str]
    pulls: bool = False
    notes: tuple[str, ...] = ()
    tangential: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True)
class Engine:
    """An engine: name as typed, title, and its laws."""

    name: str
    title: str
    laws: tuple[EngineLaw, ...]

    def law(self, name: str) -> EngineLaw:
        """The law of that name. Raises ValueError with the names that exist."""
        for law in self.laws:
            if law.name == name:
                return law
        raise ValueError(f'{self.title} has no law "{name}" here: choose {" or ".join(law.name for law in self.laws)}')
