"""Numbers of a scene that do not depend on its law: mass, radius, velocities, impedance; of one impact or of many."""

from __future__ import annotations

import math
from typing import NamedTuple

from film_model.base.arrays import Number, column
from film_model.scene import STANDARD_GRAVITY, Scene


class Numbers(NamedTuple):
    """Numbers that do not depend on the law, SI: floats for one impact, arrays with one value per impact for many.

    mass, radius: effective. approach: velocity. impedance: of the target, infinite if the scene has target_motion =
    false. drift, share: as in :class:`Problem`, drift in m/s. energy: of the impact, ½ m V².
    """

    mass: Number
    radius: Number
    approach: Number
    impedance: Number
    drift: Number
    share: Number
    energy: Number

    @classmethod
    def of(cls, scene: Scene, count: int | None) -> Numbers:
        """From a scene, of one impact, or with arrays of `count` impacts."""
        mass, approach, drift, share = scene.effective_mass, scene.approach_velocity, 0.0, 1.0
        impedance = math.inf if scene.effects.target_motion is False else scene.target_impedance
        if scene.target.free:
            share = mass / scene.mass  # m2/(m1 + m2)
            drift = scene.impactor.speed - share * approach
        numbers = cls(mass, scene.effective_radius, approach, impedance, drift, share, 0.5 * mass * approach**2)
        if count is None:
            return numbers
        return cls(*(column(number, count) for number in numbers))

    @property
    def weight(self) -> Number:
        """Weight of the effective mass, N."""
        return self.mass * STANDARD_GRAVITY


def zener(scene: Scene, impedance: Number) -> Number:
    """λ = K^{2/5} m^{3/5} V^{1/5}/Z (Zener 1941), for Hertz's contact; nan for others, and without the modulus.

    impedance: Z, N s/m; a number, or an array if the scene has arrays.
    """
    stiffness = scene.hertz_stiffness if scene.nose is None else math.nan
    return stiffness**0.4 * scene.effective_mass**0.6 * scene.approach_velocity**0.2 / impedance
