"""The units of the dimensionless march, and the way back from it to motion in SI.

Formulas serve one impact, whose numbers are floats, and many, whose numbers are arrays with one value per impact.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

from film_model.base.arrays import Number, root
from film_model.laws.law import AbstractLaw


class Scales(NamedTuple):
    """Units of the march in SI: length δ_s, force F_s, time t_s = √(m δ_s/F_s), velocity δ_s/t_s."""

    length: Number
    force: Number
    time: Number
    velocity: Number

    @property
    def energy(self) -> Number:
        """F_s δ_s, J."""
        return self.force * self.length

    def part(self, places: Any) -> Scales:
        """The scales of some of many impacts."""
        return Scales(self.length[places], self.force[places], self.time[places], self.velocity[places])


def scales_of(law: AbstractLaw, energy: float, mass: float) -> Scales:
    """Scales of a law for an impactor of `mass` [kg]; `energy` [J] > 0 sets them if the law has no scale of its own.

    Raises ValueError for scales that are not finite and > 0.
    """
    length, force = law.scales(energy)
    if not (0.0 < length < math.inf and 0.0 < force < math.inf):
        raise ValueError(f"law {law.name!r}: scales of {length!r} m and {force!r} N; both must be finite and > 0")
    return scales_from(length, force, mass)


def scales_from(length: Number, force: Number, mass: Number) -> Scales:
    """Scales from indentation δ_s [m], force F_s [N] and effective mass [kg]."""
    time = root(mass * length / force)
    return Scales(length, force, time, length / time)


def motion_of(s: Scales, drift: Any, share: Any, free: bool, t: Any, values: Iterable[Any]) -> dict[str, Any]:
    """SI motion from the core's five values ξ, ξ', f, ν, target displacement, numbers or arrays, at times t [s].

    s, drift, share: numbers, or arrays that broadcast with t. free: whether the target is a free body.
    """
    xi, rate, force, nu, shift = values
    indentation, velocity, moved = xi * s.length, nu * s.velocity, shift * s.length
    if free:
        other = 1.0 - share
        impactor = drift * t + share * indentation, drift + share * velocity
        target = drift * t - other * indentation, drift - other * velocity
    else:
        impactor, target = (indentation + moved, velocity), (moved, velocity - rate * s.velocity)
    return {
        "indentation": indentation,
        "relative_velocity": rate * s.velocity,
        "contact_force": force * s.force,
        "impactor_displacement": impactor[0],
        "impactor_velocity": impactor[1],
        "target_displacement": target[0],
        "target_velocity": target[1],
    }
