"""Restitution of damped contacts that end at zero force, and the damping that gives a restitution."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from film_model.base.arrays import Array, exponential

_STRONGEST = 1e6  # upper bound of the damping ratio, at which e = 2.5e-13
_REMAINDER = [1.0 / k for k in range(13, 1, -1)]  # of (−x − ln(1 − x))/x², the highest power first
_ALMOST = 1.0 - 1e-15  # excludes the end of an interval, where the logarithm is singular

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
    """ζ for a restitution in (0, 1], or for an array of them: the inverse of :func:`spring_restitution`."""
    if isinstance(restitution, np.ndarray):
        return _spring_ratios(restitution)
    wanted = math.log(max(restitution, spring_restitution(_STRONGEST)))
    return _root(lambda ratio: math.log(spring_restitution(ratio)) - wanted, 0.0, _STRONGEST)


def _spring_ratios(restitution: Array) -> Array:
    """ζ = sin φ with (π − 2φ) tan φ = −ln e below 1, ζ = cosh u with 2 u/tanh u = −ln e above."""
    near = 1e-9  # distance from the end of an interval at which a limit of 0/0 is reached to the last digit
    wanted = -np.log(np.maximum(restitution, spring_restitution(_STRONGEST)))
    ratio, under = np.empty(wanted.shape), wanted < 2.0
    angle = _roots(lambda at, w: (math.pi - 2.0 * at) * np.tan(at) - w, 0.0, 0.5 * math.pi - near, wanted[under])
    beyond = _roots(lambda at, w: 2.0 * at / np.tanh(at) - w, near, math.acosh(_STRONGEST), wanted[~under])
    ratio[under], ratio[~under] = np.sin(angle), np.cosh(beyond)
    return ratio


def hunt_crossley_strength(restitution: Any) -> Any:
    """λ = χ V_0 of F = K δⁿ (1 + χ δ̇) for a restitution e in (0, 1], or for an array of them: the root of λ (1 + e) =
    ln((1 + λ)/(1 − λ e)), for any n."""
    if isinstance(restitution, np.ndarray):
        return _hunt_crossley_strengths(restitution)
    if restitution > 1.0 - 1e-9:
        return 1.5 * (1.0 - restitution)
    low = 0.75 * (1.0 - restitution)  # half of the small-damping limit: always below the root
    high = _ALMOST / restitution
    if _hunt_crossley(high, restitution) > 0.0:  # 1 − λ e = e^{−λ (1 + e)} is below the rounding error
        return 1.0 / restitution
    return _root(lambda strength: _hunt_crossley(strength, restitution), low, high)


def _hunt_crossley_strengths(restitution: Array) -> Array:
    strength, high = 1.5 * (1.0 - restitution), _ALMOST / restitution
    inside = restitution <= 1.0 - 1e-9
    steep = inside & (_hunt_crossley(high, restitution) > 0.0)
    strength[steep] = 1.0 / restitution[steep]
    inside &= ~steep
    e = restitution[inside]
    strength[inside] = _roots(_hunt_crossley, 0.75 * (1.0 - e), high[inside], e)
    return strength


def _hunt_crossley(strength: Any, e: Any) -> Any:
    return _log_remainder(strength) - _log_remainder(-strength * e)


def _log_remainder(x: Any) -> Any:
    """x − ln(1 + x), without cancellation."""
    if isinstance(x, np.ndarray):
        small = np.clip(-x, -0.05, 0.05)
        return np.where(abs(x) > 0.05, x - np.log1p(x), small * small * np.polyval(_REMAINDER, small))
    if abs(x) > 0.05:
        return x - math.log1p(x)
    return sum((-x) ** k / k for k in range(2, 14))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    tightest: Any = 1e-15
    root: Any = brentq(function, low, high, xtol=1e-300, rtol=tightest)
    return float(root)


def _roots(function: Callable[[Any, Any], Any], low: Any, high: Any, given: Array) -> Array:
    """The root between low and high of function(x, given) for each of the given values."""
    from scipy.optimize import elementwise

    if not given.size:
        return given
    ends: Any = tuple(np.broadcast_to(end, given.shape) for end in (low, high))
    return elementwise.find_root(function, ends, args=(given,)).x
