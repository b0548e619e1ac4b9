"""A scene without its units: the numbers the core marches with, and the way back from them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.bodies import Body
from film_model.core import native
from film_model.curve import Curve, curve_of
from film_model.effects import Effect, choose
from film_model.errors import SimulationError
from film_model.laws.law import AbstractLaw
from film_model.scales import Scales, scales_of
from film_model.scene import Scene

Array = NDArray[np.float64]

CONTACT_LIMIT = 100.0
"""A contact that a load holds shut is followed for this many elastic contact times and relaxation times m/Z."""


@dataclass(frozen=True)
class Problem:
    """What the core needs of a scene, and what turns its answers into the laboratory's.

    gamma: F_s/(Z v_s). load: external force over F_s. approach: relative velocity over v_s. drift, share: the
    impactor's velocity is drift + share·ν v_s, a free target's drift − (1 − share)·ν v_s; drift 0 and share 1 unless
    the target is a free body. vibrates: the target moves by its modes, which the core knows nothing of.
    """

    law: AbstractLaw
    curve: Curve
    scales: Scales
    gamma: float
    load: float
    approach: float
    drift: float
    share: float
    mass: float
    effects: tuple[Effect, ...]
    vibrates: bool = False

    @property
    def start(self) -> native.Start:
        """The contact as the core starts it."""
        return native.Start(self.approach, self.gamma, self.load, self.stop_velocity, self.limit)

    @property
    def stop_velocity(self) -> float:
        """ν at which the impactor stands still in the laboratory."""
        return -self.drift / (self.share * self.scales.velocity)

    @property
    def limit(self) -> float:
        """Time after which a contact that a load holds shut is left."""
        if self.load <= 0.0:
            return math.inf
        return float(contact_limit(self.approach, self.gamma))

    def motion(self, t: Any, values: Any) -> dict[str, Any]:
        """SI motion from the core's values ξ, ξ', f, ν, target displacement (last axis) at times t [s]."""
        s = self.scales
        xi, rate, force, nu, shift = (values[..., k] for k in range(5))
        indentation, velocity, moved = xi * s.length, nu * s.velocity, shift * s.length
        if self.share == 1.0:
            impactor, target = (indentation + moved, velocity), (moved, velocity - rate * s.velocity)
        else:
            other = 1.0 - self.share
            impactor = self.drift * t + self.share * indentation, self.drift + self.share * velocity
            target = self.drift * t - other * indentation, self.drift - other * velocity
        return {
            "indentation": indentation,
            "relative_velocity": rate * s.velocity,
            "contact_force": force * s.force,
            "impactor_displacement": impactor[0],
            "impactor_velocity": impactor[1],
            "target_displacement": target[0],
            "target_velocity": target[1],
        }


def contact_limit(approach: Any, gamma: Any) -> Any:
    """Time after which a contact under load is left; 3 ν^{-1/5} is about the duration of an elastic contact."""
    return CONTACT_LIMIT * (3.0 * np.maximum(approach, 1e-3) ** -0.2 + gamma)


def problem_of(scene: Scene) -> Problem:
    """The dimensionless problem of a scene."""
    chosen = choose(scene)
    mass, approach = scene.effective_mass, scene.approach_velocity
    weight_energy = chosen.load * 1e-3 * scene.effective_radius  # a scale for a ball that is only laid down
    scales = scales_of(chosen.law, max(0.5 * mass * approach**2, weight_energy), mass)
    drift, share = 0.0, 1.0
    if isinstance(scene.target, Body):
        share = mass / scene.mass  # m2/(m1 + m2)
        drift = scene.impactor.speed - share * approach
    return Problem(
        law=chosen.law,
        curve=curve_of(chosen.law, chosen.compliance * scales.force / scales.length),
        scales=scales,
        gamma=0.0 if math.isinf(chosen.impedance) else scales.force / (chosen.impedance * scales.velocity),
        load=chosen.load / scales.force,
        approach=approach / scales.velocity,
        drift=drift,
        share=share,
        mass=mass,
        effects=chosen.effects,
        vibrates=chosen.vibrates,
    )


def refuse_vibrations(problem: Problem, what: str) -> None:
    """SimulationError where the target moves by its modes and `what` is not to be had for it."""
    if problem.vibrates:
        raise SimulationError(
            f"{what} is not to be had for a target that vibrates between its edges: simulate() gives its motion; "
            "boundary_reflections = false in [effects] makes a plate infinite"
        )
