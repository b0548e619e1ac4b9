"""The units of the dimensionless march."""

from __future__ import annotations

import math
from dataclasses import dataclass

from film_model.elementwise import root
from film_model.laws.law import AbstractLaw


@dataclass(frozen=True)
class Scales:
    """Units of the march in SI: length δ_s, force F_s, time t_s = √(m δ_s/F_s), velocity δ_s/t_s."""

    length: float
    force: float
    time: float
    velocity: float

    @property
    def energy(self) -> float:
        """F_s δ_s, J."""
        return self.force * self.length


def scales_of(law: AbstractLaw, energy: float, mass: float) -> Scales:
    """Scales of a law for an impactor of `mass` [kg]; `energy` [J] > 0 sets them for a law without its own.

    Raises ValueError for scales that are not finite and > 0.
    """
    length, force = law.scales(energy)
    if not (0.0 < length < math.inf and 0.0 < force < math.inf):
        raise ValueError(f"law {law.name!r}: scales of {length!r} m and {force!r} N; both must be finite and > 0")
    time = root(mass * length / force)
    return Scales(length, force, time, length / time)
