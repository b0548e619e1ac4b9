"""Damped Hertz and Hooke forces that several engines share, in each engine's own words."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np

from film_model.translate.law import EngineLaw, Middle, Pair, Parameter, Values

RESTITUTION = Parameter("restitution", "", "coefficient of restitution", 0.01, 1.0)
SPRING_AND_DASHPOT = (
    Parameter("kn", "N/m", "stiffness of the pair; twice as much for each body", 1e-12, logarithmic=True),
    Parameter("cn", "N s/m", "damping of the pair"),
)


def modulus(name: str) -> Parameter:
    """Young's modulus of both bodies, under the engine's name for it."""
    return Parameter(name, "Pa", "Young's modulus of both bodies", 1e-12, logarithmic=True)


def log_decrement(restitution: Any) -> Any:
    """ζ = −ln e/√(π² + ln² e)."""
    log = np.log(restitution)
    return -log / np.sqrt(np.pi**2 + log**2)


def hertz_by_restitution(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    """4/3 E* √R δ^1.5 + 2 √(5/6) ζ √(S m) δ', S = 2 E* √(Rδ): the same restitution at every velocity.

    Exact if contact ends at zero depth (Tsuji et al. 1992; Antypov & Elliott 2011), that is with attraction kept.
    """
    root = np.sqrt(pair.radius * depth)
    s = 2.0 * pair.effective_modulus(values["youngs_modulus"]) * root
    damping = 2.0 * math.sqrt(5.0 / 6.0) * log_decrement(values["restitution"]) * np.sqrt(s * pair.mass)
    return 2.0 / 3.0 * s * depth + damping * rate


def hooke_by_restitution(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    """k δ + 2 ζ √(m k) δ', with the stiffness of `hooke_stiffness`."""
    k = hooke_stiffness(pair, pair.effective_modulus(values["youngs_modulus"]))
    return k * depth + 2.0 * log_decrement(values["restitution"]) * np.sqrt(pair.mass * k) * rate


def hooke_stiffness(pair: Pair, effective_modulus: Any) -> Any:
    """k of the spring that is as deep as Hertz's at the characteristic velocity, which is `pair.velocity`."""
    base = 16.0 / 15.0 * math.sqrt(pair.radius) * effective_modulus
    return base * (pair.mass * pair.velocity**2 / base) ** 0.2


def spring_and_dashpot(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
    """kn δ + cn δ'."""
    return values["kn"] * depth + values["cn"] * rate


def start_spring_and_dashpot(pair: Pair, middle: Middle) -> dict[str, float]:
    """The spring through the middle impact's largest force and depth, with its damping ratio."""
    return {"kn": middle.stiffness(1.0), "cn": middle.damping(pair.mass)}


def start_by_restitution(pair: Pair, middle: Middle) -> dict[str, float]:
    """The modulus of Hertz's law through the middle impact's largest force and depth, and its restitution."""
    effective = 0.75 * middle.stiffness(1.5) / math.sqrt(pair.radius)
    return {
        "youngs_modulus": pair.youngs_modulus(effective),
        "restitution": min(max(middle.restitution, 0.02), 0.999),
    }


def start_hooke(pair: Pair, middle: Middle) -> dict[str, float]:
    """The modulus for which `hooke_stiffness` is the middle impact's: k ∝ E^0.8."""
    begin = start_by_restitution(pair, middle)
    stiffness = hooke_stiffness(pair, pair.effective_modulus(begin["youngs_modulus"]))
    begin["youngs_modulus"] *= (middle.stiffness(1.0) / stiffness) ** 1.25
    return begin


def law_with_viscosity(
    name: str,
    formula: str,
    source: str,
    parameters: tuple[Parameter, Parameter],
    paste: Callable[[Pair, Values], str],
    scales: Callable[[Pair], tuple[float, float]] = lambda _: (1.0, 1.0),
    **others: Any,
) -> EngineLaw:
    """√(Rδ) (k δ + m γ δ'): damping in proportion to the contact radius. scales: k and γ over the engine's parameters.

    The fit begins with the damping ratio of the middle impact at half its depth.
    """
    stiffness, damping = (parameter.name for parameter in parameters)

    def force(pair: Pair, values: Values, depth: Any, rate: Any) -> Any:
        k, viscosity = (values[name] * scale for name, scale in zip((stiffness, damping), scales(pair), strict=True))
        return np.sqrt(pair.radius * depth) * (k * depth + pair.mass * viscosity * rate)

    def start(pair: Pair, middle: Middle) -> dict[str, float]:
        k = middle.stiffness(1.5) / math.sqrt(pair.radius)
        viscosity = 2.0 * middle.damping_ratio * math.sqrt(k * 0.5 * middle.depth / pair.mass)
        viscosity /= (0.5 * pair.radius * middle.depth) ** 0.25
        of_k, of_viscosity = scales(pair)
        return {stiffness: k / of_k, damping: viscosity / of_viscosity}

    return EngineLaw(name, formula, source, parameters, force, start, paste, **others)


def law_by_restitution(
    name: Literal["hertz", "hooke"],
    source: str,
    paste: Callable[[Pair, Values], str],
    pulls: bool,
    notes: tuple[str, ...],
    tangential: Mapping[str, str] | None = None,
) -> EngineLaw:
    """`hertz_by_restitution` or `hooke_by_restitution` in an engine's words."""
    formula, force, start = _BY_RESTITUTION[name]
    parameters = (modulus("youngs_modulus"), RESTITUTION)
    return EngineLaw(name, formula, source, parameters, force, start, paste, pulls, notes, tangential or {})


_BY_RESTITUTION = {
    "hertz": (
        "F = 4/3 E* √R δ^1.5 + 2 √(5/6) ζ √(S m) δ', S = 2 E* √(Rδ), ζ from the restitution",
        hertz_by_restitution,
        start_by_restitution,
    ),
    "hooke": (
        "F = k δ + 2 ζ √(m k) δ', k from E*, R, m and a characteristic velocity, ζ from the restitution",
        hooke_by_restitution,
        start_hooke,
    ),
}
