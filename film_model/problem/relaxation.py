"""The relaxation of a contact: the Prony series of two bodies as one, and impacts under it.

The contact modulus of a body is E/(1 − ν²), ν constant. Deformations of the two bodies add, at the same force: their
moduli, as functions of Laplace's variable s, combine as 1/M = 1/M₁ + 1/M₂ with M₁ = E∞ + Σ E_i s/(s + 1/τ_i). M is such
a series again, whose rates are the roots of M₁ + M₂ between the rates of both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from film_model.base.materials import Material
from film_model.scene import Scene

if TYPE_CHECKING:
    from film_model.core import relaxing

_ROOT = np.float64(1e-15)  # relative, of the rates

Series = tuple[float, tuple[tuple[float, float], ...]]
"""Instantaneous contact modulus, Pa; and of each exponential its part of it, Pa, and its rate, 1/s."""


@dataclass(frozen=True)
class Relaxation:
    """e(t) = rest + Σ share exp(−rate t), the contact modulus over the instantaneous one; rates in 1/s."""

    rest: float
    share: tuple[float, ...]
    rate: tuple[float, ...]

    def law(self, unit: float) -> relaxing.Law:
        """For the core, with times in `unit` [s]."""
        from film_model.core import relaxing

        law = relaxing.Law(len(self.rate), 0, self.rest)
        law.share[: len(self.share)] = self.share
        law.rate[: len(self.rate)] = [rate * unit for rate in self.rate]
        return law

    def march(self, unit: Any, start: Any, tolerance: float) -> tuple[Any, Any]:
        """The core's status and summary of one impact (native.Start), or of many (START_DTYPE, an array of units)."""
        from film_model.core import relaxing

        if not isinstance(start, np.ndarray):
            return relaxing.impact(self.law(unit), start, tolerance)
        laws = np.frombuffer(b"".join(bytes(self.law(one)) for one in unit.tolist()), relaxing.LAW_DTYPE)
        return relaxing.batch(laws, start, tolerance)

    @property
    def mean_time(self) -> float:
        """Mean of the relaxation times, weighted with the shares, s."""
        return sum(s / r for s, r in zip(self.share, self.rate, strict=True)) / sum(self.share)


def relaxation_of(scene: Scene) -> Relaxation | None:
    """The relaxation of a scene's contact; None if no material has a prony series, or if one material is unknown.

    Raises TypeError for a scene with arrays in place of moduli.
    """
    own, other = scene.impactor.material, scene.target.material
    if own is None or other is None or (own.prony is None and other.prony is None):
        return None
    one, two = _series(own), _series(other)
    if isinstance(one[0] + two[0], np.ndarray):
        raise TypeError("moduli that vary have a relaxation each")
    return _combined(one, two)


def _series(of: Material) -> Series:
    modulus = of.youngs_modulus / (1.0 - of.poissons_ratio**2)
    return modulus, tuple((modulus * g, 1.0 / time) for g, time in of.prony or ())


@lru_cache(maxsize=256)
def _combined(one: Series, two: Series) -> Relaxation:
    """1/M = 1/M₁ + 1/M₂."""
    from scipy.optimize import brentq  # a run without a prony series needs no scipy

    parts = sorted((rate, part, of) for of, series in enumerate((one, two)) for part, rate in series[1])
    groups: list[tuple[float, list[float]]] = []  # rates, and the parts of both bodies
    for rate, part, of in parts:
        if not groups or rate > groups[-1][0] * (1.0 + 1e-9):
            groups.append((rate, [0.0, 0.0]))
        groups[-1][1][of] += part
    total, terms = one[0] + two[0], list[tuple[float, float]]()

    def modulus(x: float, series: int) -> float:  # M at s = −x
        return (one, two)[series][0] - sum(part[series] * rate / (rate - x) for rate, part in groups)

    below = 0.0
    for rate, part in groups:
        if part[0] > 0.0 and part[1] > 0.0:
            terms.append((part[0] * part[1] / (part[0] + part[1]), rate))
        low, high = below * (1.0 + 1e-13), rate * (1.0 - 1e-13)
        x: Any = brentq(lambda x: modulus(x, 0) + modulus(x, 1), low, high, xtol=1e-300, rtol=_ROOT)
        slope = sum(sum(both) * own / (own - x) ** 2 for own, both in groups)
        terms.append((modulus(x, 0) ** 2 / (x * slope), x))
        below = rate
    whole = one[0] * two[0] / total
    terms = [(part / whole, rate) for part, rate in sorted(terms, key=lambda term: term[1]) if part > 1e-16 * whole]
    rest = 1.0 - math.fsum(part for part, _ in terms)
    return Relaxation(rest, tuple(part for part, _ in terms), tuple(rate for _, rate in terms))
