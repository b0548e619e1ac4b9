"""Restitution of damped contacts that end at zero force, and the damping that gives a restitution."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from film_model.base.arrays import (
    all_of,
    any_of,
    cosh,
    either,
    exponential,
    greater,
    logarithm,
    ratio,
    sine,
    tangent,
    tanh,
)

_STRONGEST = 1e6  # upper bound of the damping ratio, at which e = 2.5e-13
_REMAINDER = [1.0 / k for k in range(13, 1, -1)]  # of (−x − ln(1 − x))/x², the highest power first
_MOST_STEPS, _LAST_STEP = 100, 1e-11  # of Newton's method; the step after this one, over the root, is below 1e-16

LOSS_SLOPE = 1.2048
"""(1 − e)/tan δ of a weak loss factor: less than the π/2 of half a cycle, because the force is zero before the
indentation is."""


def loss_restitution(loss_factor: Any) -> Any:
    """e of a ball on a half-space under Hertz's law, of materials with the same tan δ at all frequencies.

    The modulus then relaxes as t^−β with tan δ = tan(πβ/2); the contact is that of Lee & Radok 1960 on the way in and
    Ting 1966 on the way out, on a fixed target. Fitted to its integration from tan δ = 0.003 to 10 within 4e-4
    (tests/test_material_damping.py). e = 1 − 1.2048 tan δ is right to 1 % of e up to tan δ = 0.12.
    """
    t = loss_factor
    above, below = LOSS_SLOPE + t * (0.849 + 0.429 * t), 1.0 + t * (0.497 + t * (0.521 + 0.07 * t))
    return exponential(-t * above / below)


def spring_restitution(ratio: float) -> float:
    """e of a spring k with a dashpot c = 2 ζ √(m k) from first touch until k δ + c δ̇ = 0; ratio = ζ ≥ 0.

    e = exp(−ζ/√(1 − ζ²) atan2(2ζ√(1 − ζ²), 2ζ² − 1)), e^{−2} at ζ = 1, exp(−2ζ/√(ζ² − 1) acosh ζ) above.
    """
    if ratio == 1.0:
        return math.exp(-2.0)
    root = math.sqrt(abs((1.0 - ratio) * (1.0 + ratio)))  # 1 − ζ² would lose digits near 1
    angle = math.atan2(2.0 * ratio * root, 2.0 * ratio * ratio - 1.0) if ratio < 1.0 else 2.0 * math.acosh(ratio)
    return math.exp(-ratio / root * angle)


def spring_ratio(restitution: Any) -> Any:
    """ζ for a restitution in (0, 1], or for an array of them: the inverse of :func:`spring_restitution`.

    ζ = sin φ with (π − 2φ) tan φ = −ln e below 1, ζ = cosh u with 2 u/tanh u = −ln e above.
    """
    near = 1e-9  # distance from the end of an interval at which a limit of 0/0 is reached to the last digit
    wanted = -logarithm(greater(restitution, spring_restitution(_STRONGEST)))
    under = wanted < 2.0
    if any_of(under) and not all_of(under):
        found = np.empty(wanted.shape)
        found[under], found[~under] = spring_ratio(restitution[under]), spring_ratio(restitution[~under])
        return found

    def below(at: Any) -> tuple[Any, Any]:
        left, slope = math.pi - 2.0 * at, tangent(at)
        return left * slope - wanted, left * (1.0 + slope * slope) - 2.0 * slope

    def above(at: Any) -> tuple[Any, Any]:
        share = tanh(at)
        return 2.0 * at / share - wanted, 2.0 / share - 2.0 * at * (1.0 / share**2 - 1.0)

    least = 0.0 * wanted
    if any_of(under):
        return sine(_root(below, least, least, 0.5 * math.pi - near))
    most = least + math.acosh(_STRONGEST)
    return cosh(_root(above, most, near, most))


def hunt_crossley_strength(restitution: Any) -> Any:
    """λ = χ V_0 of F = K δⁿ (1 + χ δ̇) for a restitution e in (0, 1], or for an array of them: the root of λ (1 + e) =
    ln((1 + λ)/(1 − λ e)), for any n."""
    e, rounded = restitution, 1e-15

    def lacking(left: Any) -> tuple[Any, Any]:
        """Of −ln(1 − λ e), in which the root is not near a pole."""
        share = exponential(-left)
        strength = (1.0 - share) / e
        slope = strength * (e * e - share / (1.0 + strength)) / e
        return _log_remainder(share - 1.0) - _log_remainder(strength), slope

    low, high = (-logarithm(greater(1.0 - times * (1.0 - e), rounded)) for times in (0.75 * e, 1.5))
    found = (1.0 - exponential(-_root(lacking, high, low, high))) / e
    return either(e > 1.0 - 1e-9, 1.5 * (1.0 - e), found)


def _log_remainder(x: Any) -> Any:
    """x − ln(1 + x), without cancellation."""
    if isinstance(x, np.ndarray):
        small = np.clip(-x, -0.05, 0.05)
        return np.where(abs(x) > 0.05, x - np.log1p(x), small * small * np.polyval(_REMAINDER, small))
    if abs(x) > 0.05:
        return x - math.log1p(x)
    return sum((-x) ** k / k for k in range(2, 14))


def _root(lacking: Callable[[Any], tuple[Any, Any]], at: Any, low: Any, high: Any) -> Any:
    """Where a rising function is 0, between low and high, by Newton's method from `at`; the middle where that leaves
    them. lacking: value and slope of the function."""
    for _ in range(_MOST_STEPS):
        value, slope = lacking(at)
        low, high = either(value < 0.0, at, low), either(value < 0.0, high, at)
        ahead = at - ratio(value, slope)
        ahead = either((ahead >= low) & (ahead <= high), ahead, 0.5 * (low + high))
        at, moved = ahead, abs(ahead - at)
        if all_of(moved <= _LAST_STEP * at):
            break
    return at
