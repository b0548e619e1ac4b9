"""The tangential part of an oblique impact: from a scene and its normal motion to velocities, spin and friction.

A law that gives back its normal work as one convex power is solved exactly between events, in the core
(core/friction.py): the theory of Cattaneo, Mindlin, Jäger and Ciavarella for similar bodies; others by springs.
Formulas serve one impact (floats) and many (arrays).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from film_model.base.arrays import Array, Number, either, greater, ratio
from film_model.base.errors import SimulationError
from film_model.core import friction as core
from film_model.core import native
from film_model.core import springs as springs_core
from film_model.laws.law import Power
from film_model.oblique import springs
from film_model.oblique.result import KINDS, MOTION, REGIMES, Oblique
from film_model.problem.curve import Curve
from film_model.problem.problem import Problem
from film_model.problem.stresses import is_hertzian, radius_of
from film_model.scene import Scene
from film_model.scene.friction_table import FrictionTable
from film_model.scene.rolling import Sliding, sliding_of

*_, THROUGHOUT = REGIMES

SOURCE = "Mindlin 1949; Jäger 1994"
"""Of the theory of friction."""

CLOSED = 1e-6
"""Error of the stuck path's beginning, retraced, above which an exact solution has missed an event."""

EXACT, ROUNDED = 1e-10, 1e-14
"""Error of the exact sliding velocity over that before: at least, and over ψ₁; measured against smaller steps."""


def oblique_of(
    scene: Scene,
    problem: Problem,
    rebound: float | None,
    sample: Callable[[Array], Any],
    contacts: tuple[Sequence[float], Sequence[float]],
    estimated: float,
) -> Oblique | None:
    """The tangential part of an impact whose normal motion is known; None without friction, or if nothing slides.

    rebound: normal velocity after the impact, m/s; None if contact did not end. sample: the normal motion at times, SI.
    contacts: when they begin and end, s. estimated: relative error of the normal motion. Raises SimulationError for a
    contact that does not end, sticks or creeps.
    """
    given = sliding_of(scene)
    if given is None:
        return None
    refuse(problem)
    if rebound is None:
        raise SimulationError("friction needs a contact that ends")
    if given.table is None and given.friction == 0.0:
        return _without_friction(scene, given, problem, rebound)
    force = exact_force(problem)
    found = None if force is None else _exactly(scene, given, problem, force, rebound)
    return found or _by_springs(scene, given, problem, rebound, sample, contacts, estimated)


def refuse(problem: Problem) -> None:
    """Raise SimulationError for a problem whose friction is not known."""
    if problem.curve.pulls:
        raise SimulationError(f"law {problem.law.name}: friction under adhesion that pulls is not supported")
    if problem.relaxation is not None:
        raise SimulationError("friction is not supported with viscoelasticity: switch it off in [effects]")


def exact_force(problem: Problem) -> Power | None:
    """The force of a problem whose friction is exact: of `convex_power`, with one coefficient, on a target without
    vibrations and springs."""
    table = isinstance(problem.impacts.scene.contact.friction, FrictionTable)
    sprung = by_springs(table, problem.vibrates, problem.curve.native.compliance)
    return None if sprung else convex_power(problem.curve)


def by_springs(table: Any, vibrates: Any, compliance: Any) -> Any:
    """Whether friction is solved by springs under any law. table: of friction."""
    return table | vibrates | (compliance > 0.0)


def convex_power(curve: Curve) -> Power | None:
    """The force of a law that is one convex power, which unloading retraces; of a line the exponent is 1."""
    stage, *others = curve.stages
    force = stage.force
    if others or not isinstance(force, Power) or force.constant or force.square:
        return None
    if stage.unloading is not None or stage.damping is not None:
        return None
    convex = force.slope >= 0.0 and force.coefficient >= 0.0 and (force.exponent >= 1.0 or force.coefficient == 0.0)
    if not convex or force.origin:
        return None
    return force if force.coefficient else replace(force, exponent=1.0)


def numbers_of(given: Sliding, problem: Problem, scene: Scene) -> tuple[Number, Number]:
    """2χ, and D' before: sliding over κ µ times the unit of velocity."""
    rate = given.parameter * scene.effective_mass
    return rate, given.velocity / (given.friction * given.ratio * problem.scales.velocity)


def exact_error(problem: Problem, before: Number) -> Number:
    """Estimated error of the exact sliding velocity over that before. before: D'."""
    number = abs(before) / problem.approach
    slow = either(number < core.SLOW, core.SLOW, 0.0)  # in proportion to the result there
    return EXACT + slow + ROUNDED / greater(number, core.SLOW)


def _exactly(scene: Scene, given: Sliding, problem: Problem, force: Power, rebound: float) -> Oblique | None:
    """The exact motion; None if an event was missed."""
    scales, unit = problem.scales, given.friction * given.ratio
    normal = core.Normal(force.slope, force.coefficient, force.exponent, problem.approach, problem.gamma, problem.load)
    rate, before = numbers_of(given, problem, scene)
    status, found, rows = core.impact(normal, rate, before)
    if status != native.OK or found.closure > CLOSED:
        return None
    time, _, D, velocity, q, c = rows.T
    motion = {
        "time": time * scales.time,
        "sliding_velocity": velocity * unit * scales.velocity,
        "friction_force": q * given.friction * scales.force,
        "sliding_displacement": D * unit * scales.length,
        "stick_radius": np.sqrt(scene.effective_radius * c * scales.length),
    }
    events = tuple((time * scales.time, KINDS[kind]) for time, kind in found.events)
    peak = found.force * given.friction * scales.force, found.time_of_force * scales.time
    after = found.velocity * unit * scales.velocity
    summary = results(scene, given, rebound, after, peak)
    return Oblique(summary, REGIMES[found.regime], events, motion, exact_error(problem, before))


def _without_friction(scene: Scene, given: Sliding, problem: Problem, rebound: float) -> Oblique:
    motion = {name: np.zeros(1) for name in MOTION} | {"sliding_velocity": np.array([given.velocity])}
    summary = results(scene, given, rebound, given.velocity, (0.0, 0.0))
    return Oblique(summary, THROUGHOUT, ((0.0, "slides"),), motion, 0.0)


def _by_springs(
    scene: Scene,
    given: Sliding,
    problem: Problem,
    rebound: float,
    sample: Callable[[Array], Any],
    contacts: tuple[Sequence[float], Sequence[float]],
    estimated: float,
) -> Oblique:
    """By springs; under two models of the stiffness along the surface if the law yields."""
    steps = springs.steps_of(len(contacts[0]))
    times = np.linspace(*contacts, steps + 1, axis=1)
    seen = sample(times.ravel())
    force, depth = np.maximum(seen.contact_force, 0.0), np.asarray(seen.indentation)
    power = springs_core.power(problem.curve.native)
    models = [radius.reshape(times.shape) for radius in contact_radii(problem, depth, force, len(times))]
    runs = [springs.tangential(given, power, times, force.reshape(times.shape), radius) for radius in models]
    first, times = runs[0], times.ravel()
    moved = np.concatenate([[0.0], np.cumsum(_trapezoids(first.velocity, times))])
    motion = dict(zip(MOTION, (times, first.velocity, first.force, moved, first.stuck), strict=True))
    regime = REGIMES[first.regime]
    impulse = float(normal_impulse(scene, problem, rebound, times[-1]))
    ends = [springs.ended(run.slack, float(slid(given, impulse)), run.after) for run in runs]
    events = tuple((time, KINDS[kind]) for time, kind in first.phases)
    normal = springs.normal_error(estimated, float(_trapezoids(force, times).sum()), impulse)
    most = int(np.argmax(np.abs(first.force)))
    summary = results(scene, given, rebound, ends[0], (abs(float(first.force[most])), float(times[most])))
    errors, before = [run.estimated for run in runs], abs(float(given.velocity))
    error, bounds = springs.judged(ends, errors, steps, before, normal)
    return Oblique(summary, regime, events, motion, error, *bounds)


def _trapezoids(values: Array, times: Array) -> Array:
    """Integrals from one time to the next."""
    return 0.5 * (values[1:] + values[:-1]) * np.diff(times)


def slid(given: Sliding, impulse: Number) -> Number:
    """The sliding velocity after an impact that slides throughout, m/s: v' = −µ over the impulse over m_t. impulse: of
    the normal force, N·s."""
    impulse, table = impulse / given.mass, given.table
    if table is None:
        return given.velocity - np.copysign(given.friction * impulse, given.velocity)
    if not isinstance(impulse, np.ndarray):
        return springs_core.slid(table.pairs, float(given.velocity), impulse)
    each = zip(given.velocity.tolist(), impulse.tolist(), strict=True)
    return np.array([springs_core.slid(table.pairs, *one) for one in each])


def normal_impulse(scene: Scene, problem: Problem, rebound: Number, duration: Number) -> Number:
    """∫F dt by the balance of the impactor's momentum, N·s. rebound: as in :func:`oblique_of`. duration: up to the
    end of the last contact, s."""
    load = problem.load * problem.scales.force
    return scene.mass * (scene.impactor.speed - rebound) + load * duration


def contact_radii(problem: Problem, depth: Array, force: Array, contacts: int = 1) -> list[Array]:
    """Contact radii of one impact at times, m, by which its springs hold: of a law that yields under two models, else
    F′(δ)/(2 E*) of the force without damping, the radius of any elastic contact. depth: m. force: F ≥ 0, N. contacts:
    how many follow each other."""
    modulus = cast("float", problem.scene.effective_modulus)
    if not problem.curve.reversible:
        return [*springs_core.radii(force, depth, radius_beyond_yield(problem, depth, force), modulus, contacts)]
    return [elastic_radius(problem.curve.native, problem.scales, modulus, depth, force)]


def elastic_radius(curve: native.Curve, scales: Any, modulus: Number, depth: Array, force: Array) -> Array:
    """F′(δ)/(2 E*) of a reversible law, m; arrays of any shape, whose scales and modulus broadcast."""
    slope = springs_core.slopes(curve, force / scales.force, depth / scales.length)
    return slope * (scales.force / scales.length) / (2.0 * modulus)


def radius_beyond_yield(problem: Problem, depth: Array, force: Array, tabled: bool = False) -> Array:
    """The law's own contact radius, m; arrays (times,) of one impact or (times, impacts). tabled: within 1e-5."""
    depth = np.maximum(depth, 0.0)  # below 0 between two contacts
    elastic = is_hertzian(problem.impacts, force, depth)
    # a force that has left Hertz's, as where the first stage of its law ends, meets it again by chance alone
    leaving = leaves(elastic, depth, problem.curve.stages[0].end * problem.scales.length)
    left = np.logical_or.accumulate(leaving, axis=0)
    return np.asarray(radius_of(problem.impacts, ~left, depth, tabled))


def leaves(elastic: Any, depth: Any, end: Any) -> Any:
    """Whether a contact leaves Hertz's force: where it is another, or behind the end of the first stage, m."""
    return (depth > 0.0) & ~(elastic & (depth <= end))


def results(
    scene: Scene, given: Sliding, rebound: Number, after: Number, peak: tuple[Number, Number]
) -> dict[str, Number]:
    """The results from the sliding velocity after the impact, by the balances of momentum and angular momentum.

    rebound: normal velocity of the impactor after the impact, m/s. peak: largest friction force, N, and its time, s.
    """
    ball, impulse = given.impactor, given.mass * (given.velocity - after)
    along, limit = given.along - impulse / ball.mass, given.ratio * given.friction * scene.approach_velocity
    angle = np.arctan2 if isinstance(along, np.ndarray) else math.atan2
    number, other = ratio(given.velocity, limit), given.target
    found = {
        "tangential_rebound_velocity": along,
        "rebound_spin": ball.spin - ball.lever * impulse / ball.inertia,
        "rebound_angle": angle(along, abs(rebound)),
        "contact_point_rebound_velocity": after,
        "tangential_restitution": ratio(along, given.along),
        "tangential_impulse": impulse,
        "maximum_friction_force": peak[0],
        "time_of_maximum_friction_force": peak[1],
        "friction_work": 0.5 * given.mass * (given.velocity - after) * (given.velocity + after),
        "impact_number": either(number == number, number, math.inf),
        "tangential_parameter": 0.5 * given.parameter * scene.effective_mass,
    }
    if other is not None:
        found["target_tangential_velocity"] = impulse / other.mass
        found["target_rebound_spin"] = other.spin - other.lever * impulse / other.inertia
    return found
