"""The tangential part of an oblique impact: from a scene and its normal motion to velocities, spin and friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np

from film_model.base.arrays import Array, endless
from film_model.base.errors import SimulationError
from film_model.base.materials import Material
from film_model.core import native
from film_model.laws.law import Power
from film_model.oblique import elastic, springs
from film_model.oblique.result import Oblique
from film_model.problem.problem import Problem
from film_model.problem.stresses import contact_radius
from film_model.scene import Scene

STICKS, SLIDES, THROUGHOUT = "sticks first", "slides first", "slides throughout"

SLIDING = 1e-6
"""The impulse of friction is that of sliding throughout if it lacks less than this share of µ times the normal one."""

MISSED = 1e-6
"""Force beyond the limit of friction, over the largest limit, that rounding does not explain."""

POINTS = 65
"""Times in each phase of an exact solution at which its motion is recorded."""


class Body(NamedTuple):
    """What moves along the surface. mass: kg; infinite if nothing does. lever: from the centre to the contact, m.
    inertia: about the centre, kg·m²."""

    mass: float
    lever: float
    inertia: float

    @property
    def mobility(self) -> float:
        """Of its contacting point, 1/m + R²/J, 1/kg."""
        return 0.0 if endless(self.mass) else 1.0 / self.mass + self.lever**2 / self.inertia


class Sliding(NamedTuple):
    """What friction depends on besides the normal motion. ratio: κ = E*/(4 G*). modulus: G*, Pa. mass: m_t, kg.
    velocity: of sliding before, m/s. along: tangential velocity of the centre before, m/s."""

    friction: float
    ratio: float
    modulus: float
    mass: float
    impactor: Body
    velocity: float
    along: float

    @property
    def parameter(self) -> float:
        """m/m_t over κ, for m = 1 kg."""
        return 1.0 / (self.mass * self.ratio)


def sliding_of(scene: Scene) -> Sliding | None:
    """What friction depends on; None without friction, or if nothing slides.

    Raises SimulationError if the stiffness along the surface is not known.
    """
    ball, friction = scene.impactor, scene.contact.friction
    if friction is None:
        return None
    along, spin = ball.path_speed * math.sin(ball.angle or 0.0), ball.spin or 0.0
    velocity = along + spin * ball.radius
    if velocity == 0.0:
        return None
    materials = [ball.material, scene.target.material]
    if None in materials or scene.contact.effective_modulus is not None:
        raise SimulationError(
            "friction needs Young's modulus and Poisson's ratio of both bodies: give impactor.material and "
            "target.material, without effective_modulus in [contact]"
        )
    softness = sum((2.0 - m.poissons_ratio) / _shear_modulus(m) for m in cast("list[Material]", materials))
    impactor = Body(scene.mass, ball.radius, ball.inertia_number * scene.mass * ball.radius**2)
    mobility = impactor.mobility + _target(scene).mobility
    modulus = cast("float", scene.effective_modulus)
    return Sliding(friction, modulus * softness / 4.0, 1.0 / softness, 1.0 / mobility, impactor, velocity, along)


def _shear_modulus(of: Material) -> float:
    return of.youngs_modulus / (2.0 * (1.0 + of.poissons_ratio))


def _target(scene: Scene) -> Body:
    """The target along its surface: a ball moves and turns, others are immovable in their plane."""
    target = scene.target
    if not target.free:
        return Body(math.inf, 0.0, 1.0)
    mass = cast("float", target.own_mass)
    return Body(mass, target.radius, 0.4 * mass * target.radius**2)


def oblique_of(
    scene: Scene, problem: Problem, rebound: float | None, sample: Callable[[Array], Any], duration: float
) -> Oblique | None:
    """The tangential part of an impact whose normal motion is known; None without friction, or if nothing slides.

    rebound: normal velocity after the impact, m/s; None if contact did not end. sample: the normal motion at times, SI.
    duration: of the contacts, s. Raises SimulationError for a contact that does not end, sticks or creeps.
    """
    given = sliding_of(scene)
    if given is None:
        return None
    if problem.curve.pulls:
        raise SimulationError(f"law {problem.law.name}: friction under adhesion that pulls is not supported")
    if problem.relaxation is not None:
        raise SimulationError("friction is not supported with viscoelasticity: switch it off in [effects]")
    if rebound is None:
        raise SimulationError("friction needs a contact that ends")
    exact = _power(problem)
    found = None if exact is None else _exactly(scene, given, problem, exact, rebound)
    return found or _by_springs(scene, given, problem, rebound, sample, duration)


def _power(problem: Problem) -> Power | None:
    """The force of a law whose friction is exact: one convex power that unloading retraces."""
    stage, *others = problem.curve.stages
    force = stage.force
    if others or not isinstance(force, Power) or force.constant != 0.0 or stage.damping is not None:
        return None
    if stage.unloading is not None or problem.vibrates or problem.curve.native.compliance > 0.0:
        return None
    convex = force.slope >= 0.0 and force.coefficient >= 0.0 and (force.exponent >= 1.0 or force.coefficient == 0.0)
    return force if convex and not force.origin else None


def _exactly(scene: Scene, given: Sliding, problem: Problem, force: Power, rebound: float) -> Oblique | None:
    """The exact motion; None if an event was missed, which leaves a force beyond the limit of friction."""
    scales, unit = problem.scales, given.friction * given.ratio
    if given.friction == 0.0:
        return _without_friction(scene, given, problem, rebound)

    def law(z: float) -> tuple[float, float]:
        z = max(z, 0.0)
        power = (
            force.coefficient * z ** (force.exponent - 1.0) if z > 0.0 or force.exponent > 1.0 else force.coefficient
        )
        return force.slope * z + power * z, force.slope + force.exponent * power

    normal = elastic.Normal(law, problem.approach, problem.gamma, problem.load)
    rate = given.parameter * scene.effective_mass
    try:
        found = elastic.tangential(normal, rate, given.velocity / (unit * scales.velocity))
    except RuntimeError as error:
        raise SimulationError(str(error)) from None
    times = [np.linspace(phase.begin, phase.end, POINTS) for phase in found.phases]
    rows = np.array([phase.at(t) for phase, ts in zip(found.phases, times, strict=True) for t in ts.tolist()]).T
    limit = np.array([law(z)[0] for z in rows[0].tolist()])
    if (np.abs(rows[3]) > limit + MISSED * limit.max()).any():
        return None
    motion = {
        "time": np.concatenate(times) * scales.time,
        "sliding_velocity": rows[2] * unit * scales.velocity,
        "friction_force": rows[3] * given.friction * scales.force,
    }
    kinds = [phase.kind for phase in found.phases]
    regime = THROUGHOUT if kinds == [elastic.SLIDE] else STICKS if kinds[0] == elastic.STICK else SLIDES
    events = tuple((phase.begin * scales.time, phase.kind) for phase in found.phases)
    after = found.velocity * unit * scales.velocity
    return _results(scene, given, problem, rebound, after, motion, regime, events, 1e-8)


def _without_friction(scene: Scene, given: Sliding, problem: Problem, rebound: float) -> Oblique:
    motion = {name: np.zeros(1) for name in ("time", "friction_force")} | {
        "sliding_velocity": np.array([given.velocity])
    }
    return _results(scene, given, problem, rebound, given.velocity, motion, THROUGHOUT, ((0.0, "slides"),), 0.0)


def _by_springs(
    scene: Scene, given: Sliding, problem: Problem, rebound: float, sample: Callable[[Array], Any], duration: float
) -> Oblique:
    """By springs; under two models of the stiffness along the surface if the law yields."""
    times = np.linspace(0.0, duration, springs.STEPS + 1)
    seen = sample(times)
    force, depth = np.maximum(seen.contact_force, 0.0), np.asarray(seen.indentation)
    radius = np.where(force > 0.0, np.sqrt(scene.effective_radius * np.maximum(depth, 0.0)), 0.0)
    radii = [radius]
    if _yields(problem):
        radii = _radii_beyond_yield(scene, problem, depth, force)
    runs = [
        springs.tangential(springs.Grip(times, force, own), given.modulus, given.friction, given.mass, given.velocity)
        for own in radii
    ]
    first = runs[0]
    motion = {"time": times, "sliding_velocity": first.velocity, "friction_force": first.force}
    normal = float(np.trapezoid(force, times))
    slides = given.mass * abs(given.velocity - first.velocity[-1]) >= (1.0 - SLIDING) * given.friction * normal
    number = (
        abs(given.velocity) / (given.friction * given.ratio * scene.approach_velocity) if given.friction else math.inf
    )
    regime = THROUGHOUT if slides else STICKS if number < 1.0 else SLIDES
    ends = [float(run.velocity[-1]) for run in runs]
    events = ((0.0, "sticks" if regime == STICKS else "slides"),)
    error = first.estimated / abs(given.velocity)
    found = _results(scene, given, problem, rebound, ends[0], motion, regime, events, error)
    if len(ends) == 1:
        return found
    return replace(found, low=min(ends), high=max(ends))


def _yields(problem: Problem) -> bool:
    core = problem.curve.native
    return any(core.stage[k].unloading != native.RETRACE for k in range(core.stages))


def _radii_beyond_yield(scene: Scene, problem: Problem, depth: Array, force: Array) -> list[Array]:
    """The contact radius over time, m: that of the law in loading, and that of an elastic contact with the slope of its
    force; in unloading both shrink as those of a ball in its dent."""
    turn, found = int(np.argmax(depth)), list[Array]()
    loading, modulus = slice(0, turn + 1), cast("float", scene.effective_modulus)
    law, _ = contact_radius(problem.impacts, force[loading], depth[loading])
    slope = np.gradient(force[loading], depth[loading])
    left = float(depth[force > 0.0][-1]) if (force > 0.0).any() else 0.0
    opening = np.sqrt(np.clip((depth - left) / max(depth[turn] - left, 1e-300), 0.0, 1.0))
    for radius in (np.nan_to_num(np.asarray(law)), np.nan_to_num(slope) / (2.0 * modulus)):
        whole = float(np.nan_to_num(np.asarray(law))[-1]) * opening
        whole[loading] = np.maximum(radius, 0.0)
        found.append(np.where(force > 0.0, whole, 0.0))
    return found


def _results(
    scene: Scene,
    given: Sliding,
    problem: Problem,
    rebound: float,
    after: float,
    motion: Mapping[str, Array],
    regime: str,
    events: tuple[tuple[float, str], ...],
    estimated: float,
) -> Oblique:
    """The results from the sliding velocity after the impact, by the balances of momentum and angular momentum."""
    ball, impulse = given.impactor, given.mass * (given.velocity - after)
    along = given.along - impulse / ball.mass
    most = int(np.argmax(np.abs(motion["friction_force"])))
    number = (
        math.inf if given.friction == 0.0 else given.velocity / (given.ratio * given.friction * scene.approach_velocity)
    )
    summary = {
        "tangential_rebound_velocity": along,
        "rebound_spin": (scene.impactor.spin or 0.0) - ball.lever * impulse / ball.inertia,
        "rebound_angle": math.atan2(along, abs(rebound)),
        "contact_point_rebound_velocity": after,
        "tangential_restitution": along / given.along if given.along else math.nan,
        "tangential_impulse": impulse,
        "maximum_friction_force": float(np.abs(motion["friction_force"])[most]),
        "time_of_maximum_friction_force": float(motion["time"][most]),
        "friction_work": 0.5 * given.mass * (given.velocity - after) * (given.velocity + after),
        "impact_number": number,
        "tangential_parameter": 0.5 * given.parameter * scene.effective_mass,
    }
    return Oblique(summary, regime, events, motion, estimated)
