"""Elastic contacts of large slope: how an impact differs from Hertz's half-spaces and paraboloids."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

COMPUTED = 0.5
"""√(δ/R) up to which the force was computed."""

BALL = (0.976, 0.137, 4.445)
"""c₁, c₂, c₃ of an elastic ball on a rigid plane."""

HALF_SPACE = (0.157, 0.0, 0.0)
"""The same of a rigid ball on an elastic half-space."""


class Body(NamedTuple):
    """Share of the indentation, and R over the body's own radius: 0 of a half-space."""

    share: float
    curvature: float


def excess(bodies: Iterable[Body]) -> tuple[float, ...]:
    """c₁, c₂, c₃ of F = K δ^{3/2} (1 + c₁ x + c₂ x² + c₃ x³), x = √(δ/R): elastic contacts of large slope.

    An elastic ball is compressed as a whole, which its own inertia balances, and contact is flat, so that the pressure
    is parallel to the axis: fitted to finite elements of a ball on a rigid plane, ν = 0.3, up to x = 0.5, within 0.5 %
    of the force (examples/finite_elements/elastic.py, docs/finite_elements.md). For ν from 0.2 to 0.45 the series of an
    elastic sphere has an excess that differs by at most 16 % at x = 0.1 and 0.2. A rigid ball on a half-space differs
    less. Each body counts by its share of the indentation, with its own a/R: exact to first order.
    """
    found = [0.0, 0.0, 0.0]
    for share, curvature in bodies:
        own = HALF_SPACE if curvature == 0.0 else [c * curvature**k for k, c in enumerate(BALL, 1)]
        found = [c + share * more for c, more in zip(found, own, strict=True)]
    return tuple(found)


def change(terms: tuple[float, ...], slope: float) -> float:
    """Relative change of the largest indentation of an impact that is computed by Hertz's law instead.

    terms: of :func:`excess`. slope: √(δ/R) by Hertz's law. With y = δ/δ_Hertz, the energy gives
    y^{5/2} (1 + Σ c_k x^k y^{k/2}/(1 + k/5)) = 1. The ball's own vibrations are left out. With them, finite elements
    give 0.9 times this change for ν = 0.3 at x = 0.13, 0.27 and 0.42.
    """
    depth, sized = 1.0, [term * slope**k for k, term in enumerate(terms, 1)]
    for _ in range(30):  # each leaves a fifth of the error, or less
        depth = (1.0 + sum(c * depth ** (0.5 * k) / (1.0 + 0.2 * k) for k, c in enumerate(sized, 1))) ** -0.4
    return abs(1.0 / depth - 1.0)
