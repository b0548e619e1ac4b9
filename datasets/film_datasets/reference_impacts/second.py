"""A second computation of an impact by another method: SciPy's DOP853 on the law's own functions, without the core.

On a target that vibrates the force is the core's, and friction in part by the core's springs, neither by its march.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from scipy.integrate import solve_ivp as integrate

from film_model.core.springs import power
from film_model.laws.hertz import hertz_stiffness
from film_model.oblique import springs
from film_model.oblique.friction import contact_radii, results
from film_model.problem.problem import Problem
from film_model.scene import STANDARD_GRAVITY, Scene
from film_model.scene.chain import Chain
from film_model.scene.rolling import sliding_of
from film_model.solve import structures
from film_model.solve.history import History
from film_model.solve.vibration import Vibration, time_limit
from film_model.studies import modal_reference
from film_model.studies.impact_ode import INTEGRATED_VALUES, impact_of
from film_model.studies.integrators import solve_ivp
from film_model.studies.relaxation_reference import TOLERANCES, Ting

RTOL, ON_MODES = 3e-14, 1e-11
"""Of DOP853: just above the least that SciPy takes; and with many modes."""

ERRORS = {"stages": 5e-12, "tabulated": 1e-10, "walton-braun": 5e-10, "viscoelastic": 5e-10, "vibrating": 1e-10}
"""Relative errors of the second computation. The slope of a table jumps inside a step; steps on straight lines are so
long that their interpolation, on which an event is found, is less exact; the way out of a viscoelastic contact
interpolates the way in. Measured on all cases (tests/test_reference_impacts.py)."""

IN_CHAINS = (2e-11, 2e-12, 5e-11)
"""Errors of the second computation of a chain: of velocities over the largest, of forces, and of times, which are found
on the interpolation of a step; relative."""

STEPS = 4096
"""Of friction, by springs beside each other."""

_Found: TypeAlias = tuple[str, Mapping[str, float], float]

FRICTION = (
    *("tangential_rebound_velocity", "rebound_spin", "rebound_angle"),
    *("contact_point_rebound_velocity", "tangential_impulse"),
)


class Second(NamedTuple):
    """How it was computed, the values, SI, by their names in the summary, and the errors of these values: relative, or
    absolute by the names."""

    how: str
    values: Mapping[str, float]
    error: float
    errors: Mapping[str, float] = {}


def second(history: History) -> Second:
    """The normal motion once more."""
    problem = history.problem
    way = _on_modes if problem.vibrates else _along_stages if problem.relaxation is None else _relaxing
    how, found, error = way(problem, history)
    return Second(how, {name: value for name, value in _in_si(problem, found).items() if value == value}, error)


def _in_si(problem: Problem, found: Mapping[str, float]) -> dict[str, float]:
    """From the units of the march."""
    s = problem.scales
    units = (s.force, s.length, s.time, s.time, s.time, 1.0)
    values = {name: found[name] * unit for name, unit in zip(INTEGRATED_VALUES, units, strict=True)}
    final = found["rebound_velocity"]
    values["rebound_velocity"] = problem.drift + problem.share * (final * s.velocity)
    values["coefficient_of_restitution"] = -final / problem.approach
    if problem.free:
        del values["time_impactor_stops"]  # of a velocity relative to the other body
    return values


def _along_stages(problem: Problem, history: History) -> _Found:
    impact = impact_of(problem.law, problem.approach, problem.gamma, problem.load, problem.damping)
    values = solve_ivp("DOP853", RTOL, impact)
    error = ERRORS.get(problem.law.name, ERRORS["stages"])
    return f"DOP853 at rtol {RTOL:g}", dict(zip(INTEGRATED_VALUES, values, strict=True)), error


def _relaxing(problem: Problem, history: History) -> _Found:
    relaxation, unit = problem.relaxation, problem.scales.time
    assert relaxation is not None
    terms = [(g, 1.0 / (rate * unit)) for g, rate in zip(relaxation.share, relaxation.rate, strict=True)]
    exact = Ting(terms, problem.approach, problem.gamma, problem.load)
    values = (exact.largest, exact.deepest, exact.turn, exact.turn, exact.end, exact.final)
    how = f"DOP853 at rtol {TOLERANCES[0]:g} on the way in and {TOLERANCES[1]:g} on the way out"
    return how, dict(zip(INTEGRATED_VALUES, values, strict=True)), ERRORS["viscoelastic"]


def _on_modes(problem: Problem, history: History) -> _Found:
    vibration, unit, scales, target = history.vibration, problem.scales.time, problem.scales, history.scene.target
    assert isinstance(vibration, Vibration)
    structure = structures.structure_of(target, vibration.highest, unit)
    rest = structure.omitted * scales.force / scales.length
    tables = structure.tables
    given = tables.frequency * unit, tables.share * problem.mass, rest, 1.0, time_limit(problem, target) / unit
    core = modal_reference.integrate(problem, *given, ON_MODES, tables.ratio).summary
    values = {name: float(getattr(core, name)) for name in INTEGRATED_VALUES if name != "rebound_velocity"}
    values["rebound_velocity"] = float(core.final_velocity)
    return f"DOP853 at rtol {ON_MODES:g} on the same modes", values, ERRORS["vibrating"]


def second_friction(history: History) -> Second:
    """The tangential part of an elastic impact once more: in closed form if it slides throughout, which similar spheres
    do from ψ₁ = 4χ − 1 on (Maw, Barber & Fawcett 1976), else by springs that slip, with the estimate of their error."""
    scene, found = history.scene, history.oblique
    given = sliding_of(scene)
    assert given is not None and found is not None
    rebound, before = cast("float", history.summary["rebound_velocity"]), given.velocity
    known = results(scene, given, rebound, before, (0.0, 0.0))
    if abs(known["impact_number"]) > 4.0 * known["tangential_parameter"] - 1.0:
        pushed = given.friction * scene.mass * (scene.approach_velocity + abs(rebound)) / given.mass
        after, error, how = before - math.copysign(pushed, before), ERRORS["stages"] * abs(before), "closed form"
    else:
        times = np.linspace(0.0, history.duration, STEPS + 1)
        seen = history.sample_si(times)
        force = np.maximum(seen.contact_force, 0.0)
        radius, *_ = contact_radii(history.problem, np.asarray(seen.indentation), force)
        contact = np.stack([times, force, radius])[:, None]
        run = springs.tangential(given, power(history.problem.curve.native), *contact)
        after, error = run.after, run.estimated
        how = f"{springs.SPRINGS} springs beside each other in {STEPS} steps"
    error += found.estimated * abs(before)
    values, moved = (results(scene, given, rebound, end, (0.0, 0.0)) for end in (after, after + error))
    errors = {name: abs(moved[name] - values[name]) + 1e-10 * abs(values[name]) for name in FRICTION}
    return Second(f"friction: {how}", {name: values[name] for name in FRICTION}, 0.0, errors)


def second_bounces(scene: Scene, problem: Problem, count: int) -> Second:
    """Bounces of an undamped ball on a target without edges, whose surface stays where a contact has moved it: single
    impacts and flights of 2 v/g."""
    values, time, speed, scales = dict[str, float](), 0.0, scene.approach_velocity, problem.scales
    time = speed / STANDARD_GRAVITY
    for k in range(1, count + 1):
        nu = speed / scales.velocity
        impact = impact_of(problem.law, nu, problem.gamma, problem.load)
        found = dict(zip(INTEGRATED_VALUES, solve_ivp("DOP853", RTOL, impact), strict=True))
        after, lasts = found["rebound_velocity"] * scales.velocity, found["contact_duration"] * scales.time
        force = found["maximum_force"] * scales.force
        each = {"time": time, "velocity_after": after, "maximum_force": force, "contact_duration": lasts}
        values |= {f"bounce_{k}_{name}": value for name, value in each.items()}
        time, speed = time + lasts + 2.0 * abs(after) / STANDARD_GRAVITY, abs(after)
    return Second(f"DOP853 at rtol {RTOL:g}, bounce after bounce", values, count * ERRORS["stages"])


def second_chain(chain: Chain, end: float) -> Second:
    """Bodies under Hertz's law up to a time: SciPy's DOP853 on their displacements, without the core."""
    row, links, pairs = chain.row, chain.links, chain.pairs(1.0)
    count, contacts = len(row), len(links)
    mass = np.array([body.own_mass for body in row])
    gaps = np.array([link.gap for link in links])
    stiffness = np.array(
        [hertz_stiffness(cast("float", pair.effective_modulus), pair.effective_radius) for pair in pairs]
    )
    speeds = np.array([body.velocity for body in row])
    closing = np.zeros((contacts, count))  # the way of each contact, of those of the bodies
    for k, link in enumerate(links):
        closing[k, link.front] = link.along
        if link.behind is not None:
            closing[k, link.behind] = -1.0

    def forces(z: Any) -> Any:
        return stiffness * np.maximum(closing @ z[:count] - gaps, 0.0) ** 1.5

    def rates(_: float, z: Any) -> Any:
        return np.concatenate((z[count:], -(forces(z) @ closing) / mass))

    def turn(k: int) -> Any:
        return lambda _, z: float(closing[k] @ z[count:])  # pyright: ignore[reportUnknownLambdaType]

    start = np.concatenate((np.zeros(count), speeds))
    small = np.concatenate((np.full(count, 1e-15), np.full(count, 1e-11))) * np.abs(speeds).max() * 1e-4
    turns = [turn(k) for k in range(contacts)]
    found = integrate(rates, (0.0, end), start, "DOP853", events=turns, rtol=RTOL, atol=small, max_step=end / 50)
    values = {f"final_velocity_{k + 1}": float(v) for k, v in enumerate(found.y[count:, -1])}
    errors = {name: IN_CHAINS[0] * float(np.abs(speeds).max()) for name in values}
    for k, (times, states) in enumerate(zip(found.t_events, found.y_events, strict=True)):
        seen = [float(forces(state)[k]) for state in states]
        best = int(np.argmax(seen))
        own = {f"largest_force_{k + 1}": seen[best], f"time_of_largest_force_{k + 1}": float(times[best])}
        values |= own
        errors |= {name: part * value for (name, value), part in zip(own.items(), IN_CHAINS[1:], strict=True)}
    return Second(f"DOP853 of SciPy at rtol {RTOL:g} on displacements", values, 0.0, errors)
