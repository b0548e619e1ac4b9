"""Oblique impact by the tangential springs of discrete-element programs, beside the theory of `simulate`.

In the groups of Maw, Barber & Fawcett: ψ = v/(κ µ V_n) of the sliding velocity v, before and after an elastic impact,
and χ = (m/m_t)/(2 κ) with κ = E*/(4 G*). The tangential stiffness is Mindlin's, 8 G* a, in every model; what differs is
how the spring meets a contact that grows, shrinks and slips.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.scene import Contact, Effects, Scene
from film_model.scene.rolling import MATERIALS, stiffness_ratio, tangential_mobility
from film_model.solve.simulate import simulate_quietly

STEPS = 4000
"""Time steps of an impact; ψ₂ of a model then changes by less than 1e-3 when they are doubled."""


class Spring(NamedTuple):
    """One tangential spring with a slider. exponent: of the normal force. by_force: the force is accumulated, not the
    length of the spring. rescales: what is accumulated shrinks with the contact radius in unloading."""

    exponent: float
    by_force: bool = False
    rescales: bool = False


SPRINGS = {
    "mindlin": Spring(1.5),
    "mindlin_rescale": Spring(1.5, rescales=True),
    "mindlin/force": Spring(1.5, by_force=True),
    "mindlin_rescale/force": Spring(1.5, by_force=True, rescales=True),
    "hooke": Spring(1.0),
}
"""The springs of LAMMPS (pair_style granular) by its names, which other programs share; hooke has a linear normal force
and K_t = K_n/κ."""


def by_spring(spring: Spring, parameter: float, before: Array, steps: int = STEPS) -> Array:
    """ψ₂ for ψ₁ = before, by the velocity Verlet rule with the force cut at µ times the normal one after every step.

    z'' = −f(z), D'' = −2χ q with f = (n + 1)/2 zⁿ, and q = f'(z) times the length of the spring, or dq = f'(z) dD.
    parameter: χ.
    """
    n = spring.exponent
    step = 3.2 / steps  # contacts last 2.943 (n = 3/2) and π (n = 1)
    z, rate, f, stiffness = 0.0, 1.0, 0.0, 0.0
    slide, length, q = np.array(before, np.float64), np.zeros(np.size(before)), np.zeros(np.size(before))
    while True:
        rate -= 0.5 * step * f
        slide -= step * parameter * q
        z += step * rate
        if z <= 0.0:
            return slide
        last, f, stiffness = stiffness, 0.5 * (n + 1.0) * z**n, 0.5 * (n + 1.0) * n * z ** (n - 1.0)
        kept = stiffness / last if spring.rescales and rate < 0.0 and last > 0.0 else 1.0
        if spring.by_force:
            q = np.clip(kept * q + stiffness * step * slide, -f, f)
        else:
            length = np.clip(kept * length + step * slide, -f / stiffness, f / stiffness)
            q = stiffness * length
        rate -= 0.5 * step * f
        slide -= step * parameter * q


def rigid(parameter: float, before: Array) -> Array:
    """ψ₂ of a ball that slides until it rolls: max(ψ₁ − 4χ, 0); Walton's model with β₀ = 0."""
    return np.maximum(np.asarray(before) - 4.0 * parameter, 0.0)


MODELS: dict[str, Callable[[float, Array], Array]] = {
    **{name: partial(by_spring, spring) for name, spring in SPRINGS.items()},
    "rigid": rigid,
}
"""ψ₂ of a model for χ and ψ₁ >= 0, by name."""


class Groups(NamedTuple):
    """What ψ₂ over ψ₁ depends on. parameter: χ = (m/m_t)/(2 κ). ratio: κ = K_n/K_t = E*/(4 G*)."""

    parameter: float
    ratio: float


def groups(scene: Scene) -> Groups:
    """χ and κ of a scene, whatever its law, angle, spin and friction. Raises SimulationError without both materials."""
    ratio = stiffness_ratio(scene)
    if ratio is None:
        raise SimulationError(MATERIALS)
    return Groups(0.5 * tangential_mobility(scene) * scene.effective_mass / ratio, ratio)


def theory(scene: Scene, before: Array) -> Array:
    """ψ₂ for ψ₁ = before, from 0.02 on: simulated under Hertz's law at 45°, with the friction that belongs to ψ₁.

    Only the ratios of stiffnesses and of masses of the scene matter. Raises SimulationError as `simulate` does.
    """
    unit = _sliding(scene) / (groups(scene).ratio * _normal(scene))  # µ ψ₁
    rebounds = [_after(scene, unit / psi)["contact_point_rebound_velocity"] for psi in np.ravel(before).tolist()]
    return np.ravel(before) * np.array(rebounds) / _sliding(scene)


def _after(scene: Scene, friction: float) -> Mapping[str, float]:
    """The tangential results of the scene at 45° under Hertz's law."""
    still = Effects(gravity=False, target_motion=False, viscoelasticity=False)
    one = Scene(scene.impactor, scene.target, Contact("hertz", friction=friction), still)
    found = simulate_quietly(one.replace({"impactor.angle": "45 deg", "impactor.spin": None})).oblique
    assert found is not None
    return found.summary


def _sliding(scene: Scene) -> float:
    return scene.impactor.path_speed * math.sin(math.radians(45.0))


def _normal(scene: Scene) -> float:
    return scene.impactor.path_speed * math.cos(math.radians(45.0)) - scene.target.velocity
