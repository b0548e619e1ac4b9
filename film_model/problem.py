"""A scene without its units: the numbers the core marches with, and the way back from them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from film_model.bodies import STANDARD_GRAVITY, Body
from film_model.core import native
from film_model.curve import Curve, curve_of
from film_model.errors import SimulationError
from film_model.laws.law import AbstractLaw
from film_model.scales import Scales, scales_of
from film_model.scene import Scene

if TYPE_CHECKING:
    from film_model.effects import Effect

Array = NDArray[np.float64]

CONTACT_LIMIT = 100.0
"""A contact that a load holds shut is followed for this many elastic contact times and relaxation times m/Z."""


@dataclass(frozen=True)
class Problem:
    """What the core needs of a scene, and what turns its answers into the laboratory's.

    gamma: F_s/(Z v_s). load: external force over F_s. damping: factor of a damped law's c over F_s/v_s. approach:
    relative velocity over v_s. drift, share: the impactor's velocity is drift + share·ν v_s, a free target's
    drift − (1 − share)·ν v_s; drift 0 and share 1 unless the target is a free body. vibrates: the target moves by its
    modes, which the core knows nothing of.
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
    scene: Scene = field(repr=False)
    damping: float = 0.0
    vibrates: bool = False

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """What the scene calls for, and what it would call for: every effect with the number that decides."""
        from film_model.effects import effects_of

        return effects_of(self.scene)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a user of these results should know, in sentences: of the law, and of effects that are not modelled."""
        found = (effect.warning for effect in self.effects)
        return (*self.law.remarks(), *self.curve.warnings, *(warning for warning in found if warning is not None))

    @property
    def impedance(self) -> float:
        """Target impedance, N s/m; infinite where it is not what the target moves by."""
        return math.inf if self.gamma == 0.0 else self.scales.force / (self.gamma * self.scales.velocity)

    @property
    def compliance(self) -> float:
        """Static compliance of the target, m/N; 0 where it is not what the target moves by."""
        return self.curve.native.compliance * self.scales.length / self.scales.force

    @property
    def start(self) -> native.Start:
        """The contact as the core starts it."""
        return native.Start(self.approach, self.gamma, self.load, self.stop_velocity, self.limit, self.damping)

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
        return motion_of(self.scales, self.drift, self.share, self.share < 1.0, t, values)


def motion_of(s: Scales, drift: Any, share: Any, free: bool, t: Any, values: Any) -> dict[str, Any]:
    """SI motion from the core's values ξ, ξ', f, ν, target displacement (last axis) at times t [s].

    s, drift, share: numbers, or arrays that broadcast with t. free: whether the target is a free body.
    """
    xi, rate, force, nu, shift = (values[..., k] for k in range(5))
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


def contact_limit(approach: Any, gamma: Any) -> Any:
    """Time after which a contact under load is left; 3 ν^{-1/5} is about the duration of an elastic contact."""
    return CONTACT_LIMIT * (3.0 * np.maximum(approach, 1e-3) ** -0.2 + gamma)


def problem_of(scene: Scene) -> Problem:
    """The dimensionless problem of a scene, with the effects it calls for."""
    from film_model.effects import choose

    return choose(scene)


def assemble(
    scene: Scene, law: AbstractLaw, impedance: float, load: float, compliance: float = 0.0, vibrates: bool = False
) -> Problem:
    """The dimensionless problem of a scene under a law, for a target impedance [N s/m] and a load [N].

    compliance: of a target that follows the force statically, m/N. vibrates: it moves by its modes instead.
    """
    mass, approach = scene.effective_mass, scene.approach_velocity
    energy = max(0.5 * mass * approach**2, load * 1e-3 * scene.effective_radius)
    if energy == 0.0:  # a ball at rest, for a component: what its weight would do
        energy = mass * STANDARD_GRAVITY * 1e-3 * scene.effective_radius
    scales = scales_of(law, energy, mass)
    drift, share = 0.0, 1.0
    if isinstance(scene.target, Body):
        share = mass / scene.mass  # m2/(m1 + m2)
        drift = scene.impactor.speed - share * approach
    return Problem(
        law=law,
        curve=curve_of(law, compliance * scales.force / scales.length),
        scales=scales,
        gamma=0.0 if math.isinf(impedance) else scales.force / (impedance * scales.velocity),
        load=load / scales.force,
        damping=float(law.damping_factor(mass, approach, scales.length)) * scales.velocity / scales.force,
        approach=approach / scales.velocity,
        drift=drift,
        share=share,
        mass=mass,
        scene=scene,
        vibrates=vibrates,
    )


def refuse_vibrations(problem: Problem, what: str) -> None:
    """SimulationError where the target moves by its modes and `what` is not to be had for it."""
    if problem.vibrates:
        raise SimulationError(vibrations_refused(what))


def vibrations_refused(what: str) -> str:
    """That `what` is not to be had for a target that moves by its modes."""
    return (
        f"{what} is not to be had for a target that vibrates between its edges: simulate() gives its motion; "
        "boundary_reflections = false in [effects] makes a plate infinite"
    )
