"""simulate(scene) → History: the mesh that meets the accuracy, and the record of the impact on it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model import units
from film_model.bodies import Body, Sphere
from film_model.core import native
from film_model.errors import Outcome, SimulationError
from film_model.history import SUMMARY, Accuracy, Event, History, stage_names
from film_model.problem import Problem, problem_of
from film_model.scene import Scene, Solver

FIRST_SEGMENTS = 6
"""Segments a stage of the first trial; from here on the error falls by 16 when segments are doubled."""

MOST_SEGMENTS = 6 * 2**13

_ORDER_FACTOR = {
    # bound on error of n segments over |difference to 2n|, and on error of 2n over the same
    "work-preserving": (1.6, 0.3),
    "chord": (2.0, 0.6),
}
"""Asymptotically 16/15 and 1/15 for fourth order, 4/3 and 1/3 for second; with room for what is not asymptotic yet."""

_ROUNDING = 2e-14
"""Relative accuracy that rounding leaves, times the square root of the number of lines over a hundred."""

_FLOOR = 1e-3
"""Velocities and dents smaller than this part of their scale are judged against it."""


def simulate(
    scene: Scene, *, accuracy: float | None = None, segments: int | None = None, linearisation: str | None = None
) -> History:
    """The impact a scene describes, from first touch to the end of contact.

    accuracy: relative, of every summary value; or segments: lines a stage; both default to the scene's. The march is
    FILM (Big-Alabo, Cartmell & Harrison 2017) on graded work-preserving lines, of fourth order in the number of
    segments; linearisation="chord" is the paper's, of second order. The error estimate is the difference between two
    meshes, one with twice the segments of the other.

    Raises SceneError for a bad option, SimulationError for a contact the core cannot follow.
    """
    solver = _solver(scene.solver, accuracy, segments, linearisation)
    problem = problem_of(scene)
    if problem.approach == 0.0 and problem.load <= 0.0:
        raise SimulationError("the impactor has no velocity and no force pushes it: there is no impact")
    warnings = list(problem.curve.warnings)
    if solver.segments is not None:
        counts, estimated = (solver.segments, solver.segments), _estimate(problem, solver)
    else:
        counts, estimated = _refine(problem, solver, warnings)
    estimated += problem.curve.fit_error
    status, lines, states = _record(problem, solver, counts)
    events = events_of(problem, states)
    summary = _summarise(problem, events, states[-1])
    warnings.extend(_energy_warning(problem, summary))
    return History(
        scene=replace(scene, solver=solver),
        problem=problem,
        lines=lines,
        events=events,
        outcome=_outcome(status),
        summary=summary,
        accuracy=Accuracy(solver.accuracy if solver.segments is None else None, estimated, *counts, lines.size - 1),
        warnings=tuple(warnings),
    )


@dataclass(frozen=True)
class BatchResult:
    """Summaries of many impacts: arrays of one shape, SI, by the names of `history.SUMMARY` (nan: did not happen).

    estimated: bound on the relative error of every value, from the impacts that were tried on two meshes. segments:
    loading and unloading lines. failed: True where the core could not follow the impact (its values are nan).
    """

    summary: dict[str, NDArray[np.float64]]
    estimated: float
    segments: tuple[int, int]
    failed: NDArray[np.bool_]


def simulate_batch(
    scene: Scene, *, velocity: Any, mass: Any = None, accuracy: float | None = None, segments: int | None = None
) -> BatchResult:
    """Impacts of one scene at many velocities, and masses if given; arrays with units that broadcast together.

    Law and effects are those of the scene, whatever the velocity (law "auto" is decided at the largest one). With an
    accuracy, up to 64 of the impacts, the extremes among them, are tried to find the mesh. A free body as target is
    refused with SimulationError.
    """
    speeds = units.array_to_si(velocity, "velocity")
    masses = np.asarray(scene.effective_mass) if mass is None else units.array_to_si(mass, "mass")
    speeds, masses = np.broadcast_arrays(speeds, masses)
    if isinstance(scene.target, Body):
        raise SimulationError("a free body as target cannot be run as a batch: its reduced mass depends on both")
    if speeds.size == 0 or not ((speeds > 0.0).all() and (masses > 0.0).all()):
        raise ValueError("velocity and mass must be > 0, and there must be at least one impact")
    problem = problem_of(_at_velocity(scene, float(speeds.max())))
    scales = problem.scales
    start = np.zeros(speeds.size, native.START_DTYPE)
    clock = np.sqrt(masses.ravel() / problem.mass)  # t_s and 1/v_s grow with √m
    start["nu"] = speeds.ravel() * clock / scales.velocity
    start["gamma"] = problem.gamma * clock
    start["load"] = problem.load * (masses.ravel() / problem.mass)
    start["time_limit"] = problem.limit
    solver = _solver(scene.solver, accuracy, segments, None)
    trial = start[np.unique(np.linspace(0, start.size - 1, 64).astype(int))]
    order = np.argsort(start["gamma"] * start["nu"] ** 0.2 + 1e-9 * start["nu"])
    trial = np.concatenate([trial, start[order[[0, -1]]], start[[start["nu"].argmin(), start["nu"].argmax()]]])
    counts, estimated = _batch_mesh(problem, solver, trial)
    status, core = native.batch(problem.curve.native, _mesh(solver, counts), start)
    values = _batch_summary(problem, core, start, clock)
    failed = status < 0
    for column in values.values():
        column[failed] = np.nan
    shaped = {name: column.reshape(speeds.shape) for name, column in values.items()}
    return BatchResult(shaped, estimated, counts, failed.reshape(speeds.shape))


def _at_velocity(scene: Scene, velocity: float) -> Scene:
    ball = scene.impactor
    mass = None if ball.mass is None else f"{ball.mass!r} kg"
    impactor = Sphere(f"{ball.radius!r} m", velocity=f"{velocity!r} m/s", mass=mass, material=ball.material)
    return replace(scene, impactor=impactor)


def _batch_mesh(problem: Problem, solver: Solver, trial: Any) -> tuple[tuple[int, int], float]:
    """Smallest mesh on which every trial impact meets the accuracy, seen from twice as many segments."""
    ratio = _unloading_ratio(problem)
    n = solver.segments or 4
    before, after = _ORDER_FACTOR[solver.linearisation]
    while True:
        counts = (n, n) if solver.segments else (n, ratio * n)
        coarse, fine = (
            native.batch(problem.curve.native, _mesh(solver, (k * counts[0], k * counts[1])), trial) for k in (1, 2)
        )
        ended = (coarse[0] >= 0) & (fine[0] >= 0)
        worst = max(
            (_difference(problem, native.Summary.from_buffer_copy(a), native.Summary.from_buffer_copy(b), start["nu"]))
            for a, b, start in zip(coarse[1][ended], fine[1][ended], trial[ended], strict=True)
        ) if ended.any() else 0.0
        estimated = before * worst + _ROUNDING
        if solver.segments is not None:
            return counts, estimated
        assert solver.accuracy is not None
        if estimated <= solver.accuracy or n >= MOST_SEGMENTS:
            return counts, estimated
        if after * worst <= solver.accuracy and n >= FIRST_SEGMENTS:
            # between n and 2n the error falls with the fourth power
            n = min(2 * n, max(n + 1, math.ceil(n * (1.1 * before * worst / solver.accuracy) ** 0.25)))
        else:
            n *= 2


def _solver(given: Solver, accuracy: float | None, segments: int | None, linearisation: str | None) -> Solver:
    if accuracy is None and segments is None:
        accuracy, segments = (None, given.segments) if given.segments is not None else (given.accuracy, None)
    return Solver(accuracy=accuracy, segments=segments, linearisation=linearisation or given.linearisation)


def _mesh(solver: Solver, counts: tuple[int, int]) -> native.Mesh:
    """The mesh for loading and unloading segment counts."""
    kind = native.CHORD if solver.linearisation == "chord" else native.WORK_PRESERVING
    return native.mesh(kind, *counts)


def mesh_for(
    scene: Scene,
    problem: Problem,
    accuracy: float | None,
    segments: int | None,
    linearisation: str | None,
    fallback: tuple[int, int],
) -> tuple[tuple[int, int], native.Mesh]:
    """Segment counts and mesh for a scene whose impact is not simulated in one go; `fallback` without an impact."""
    solver = _solver(scene.solver, accuracy, segments, linearisation)
    if solver.segments is not None:
        counts = (solver.segments, solver.segments)
    else:
        counts = _refine(problem, solver, [])[0] if problem.approach > 0.0 else fallback
    return counts, _mesh(solver, counts)


def _impact(problem: Problem, solver: Solver, counts: tuple[int, int]) -> native.Summary:
    status, summary = native.impact(problem.curve.native, _mesh(solver, counts), problem.start)
    raise_failure(status, problem)
    return summary


def _refine(problem: Problem, solver: Solver, warnings: list[str]) -> tuple[tuple[int, int], float]:
    """Segment counts that meet the accuracy, doubled until two meshes agree, and the error estimate."""
    assert solver.accuracy is not None
    n, ratio = FIRST_SEGMENTS, _unloading_ratio(problem)
    factor = _ORDER_FACTOR[solver.linearisation][1]
    coarse, last = _impact(problem, solver, (n, ratio * n)), math.inf
    while True:
        n *= 2
        fine = _impact(problem, solver, (n, ratio * n))
        estimated = factor * _difference(problem, coarse, fine) + _ROUNDING * math.sqrt(fine.lines / 100.0)
        if estimated <= solver.accuracy:
            return (n, ratio * n), estimated
        if n >= MOST_SEGMENTS or (estimated > 0.7 * last and estimated < 1e-9):
            warnings.append(
                f"accuracy {solver.accuracy:g} cannot be had: the error is estimated at {estimated:.1e} with {n} "
                "segments a stage"
            )
            return (n, ratio * n), estimated
        coarse, last = fine, estimated


def _estimate(problem: Problem, solver: Solver) -> float:
    """Error estimate for the number of segments that was asked for."""
    n = solver.segments
    assert n is not None
    given, double = (_impact(problem, solver, (k, k)) for k in (n, min(2 * n, native.MAX_SEGMENTS)))
    return _ORDER_FACTOR[solver.linearisation][0] * _difference(problem, given, double) + _ROUNDING


def _unloading_ratio(problem: Problem) -> int:
    """Unloading segments for one loading segment: more where the contact fades out slowly.

    `slow` is Zener's λ of the scaled problem; measured over λ from 0.001 to 8, this keeps the errors of loading and
    unloading alike.
    """
    slow = problem.gamma * problem.approach**0.2
    return 1 if slow == 0.0 else 2 if slow < 1.5 else 4


def _difference(problem: Problem, a: native.Summary, b: native.Summary, approach: float | None = None) -> float:
    """Largest relative difference between two summaries; values that exist in one only count as 1."""
    depth, speed = b.maximum_indentation, max(problem.approach if approach is None else approach, 1e-300)
    share, drift = problem.share, problem.drift / problem.scales.velocity
    pairs = [
        (a.maximum_force, b.maximum_force, b.maximum_force),
        (a.maximum_indentation, depth, depth),
        (a.time_of_maximum_indentation, b.time_of_maximum_indentation, b.time_of_maximum_indentation),
        (a.time_impactor_stops, b.time_impactor_stops, b.time_impactor_stops),
        (a.contact_duration, b.contact_duration, b.contact_duration),
        (a.permanent_indentation, b.permanent_indentation, max(abs(b.permanent_indentation), _FLOOR * depth)),
        (a.final_velocity, b.final_velocity, max(abs(b.final_velocity), _FLOOR * speed)),
        (a.final_velocity, b.final_velocity, max(abs(drift / share + b.final_velocity), _FLOOR * speed)),
        (a.work, b.work, max(0.5 * speed**2, abs(b.work))),
    ]
    worst = 0.0
    for first, second, scale in pairs:
        if first != first and second != second:
            continue
        difference = abs(first - second) / scale if scale > 0.0 else 0.0
        worst = max(worst, difference if difference == difference else 1.0)
    return worst


def _batch_summary(problem: Problem, core: Any, start: Any, clock: Any) -> dict[str, NDArray[np.float64]]:
    """Summary columns in SI from the core's."""
    s = problem.scales
    speed, energy = s.velocity / clock, s.energy
    radiated = 0.5 * (start["nu"] ** 2 - core["final_velocity"] ** 2) - core["work"]
    radiated += start["load"] * (core["permanent_indentation"] + core["shift"])
    return {
        "maximum_force": core["maximum_force"] * s.force,
        "maximum_indentation": core["maximum_indentation"] * s.length,
        "time_of_maximum_indentation": core["time_of_maximum_indentation"] * s.time * clock,
        "time_impactor_stops": core["time_impactor_stops"] * s.time * clock,
        "contact_duration": core["contact_duration"] * s.time * clock,
        "permanent_indentation": core["permanent_indentation"] * s.length,
        "rebound_velocity": core["final_velocity"] * speed,
        "coefficient_of_restitution": -core["final_velocity"] / start["nu"],
        "energy_absorbed": core["work"] * energy,
        "energy_radiated": np.where(start["gamma"] > 0.0, radiated * energy, 0.0),
    }


def _record(problem: Problem, solver: Solver, counts: tuple[int, int]) -> tuple[int, Any, Any]:
    """Status, lines and states at events."""
    state = native.initial_state(problem.curve.native, problem.start)
    room = (counts[0] + 2) * (problem.curve.native.stages + 1) + counts[1] + 64
    status, lines, states = native.record(problem.curve.native, _mesh(solver, counts), state, problem.limit, room)
    raise_failure(status, problem)
    return status, lines, states


def events_of(problem: Problem, states: Any) -> tuple[Event, ...]:
    """Events in SI from the core's states (STATE_DTYPE) at them."""
    t = states["time"] * problem.scales.time
    relative = states["nu"] - problem.gamma * states["force"]
    values = np.stack([states["xi"], relative, states["force"], states["nu"], states["shift"]], axis=-1)
    columns = [column.tolist() for column in problem.motion(t, values).values()]
    names = stage_names(problem)
    heads = zip(states["event"].tolist(), t.tolist(), states["branch"].tolist(), strict=True)
    return tuple(
        Event(native.EVENTS[kind], time, names[branch], *motion)
        for (kind, time, branch), motion in zip(heads, zip(*columns, strict=True), strict=True)
    )


def _outcome(status: int) -> Outcome:
    if status == native.EVENT:
        return Outcome.SEPARATED
    return Outcome.RESTING if status == native.ENDLESS else Outcome.TIME_LIMIT


def raise_failure(status: int, problem: Problem) -> None:
    """SimulationError for a failure of the core, nothing otherwise."""
    if status >= 0:
        return
    law = problem.law.name
    raise SimulationError(
        {
            native.BEYOND_LAW: f"law {law}: {Outcome.BEYOND_LAW.value}; it cannot stop this impactor",
            native.TOO_MANY: Outcome.TOO_MANY_SEGMENTS.value,
            native.TOO_STIFF: f"law {law}: its force at first touch is more than the target's impedance can resist",
            native.BAD_UNLOADING: f"law {law}: its unloading from the deepest point reached has no length",
        }.get(status, f"the core refused the numbers of this scene (status {status})")
    )


def _summarise(problem: Problem, events: tuple[Event, ...], last: Any) -> dict[str, float | None]:
    """Summary in SI, with the core's state at the last event; None for what did not happen."""
    first = {event.name: event for event in reversed(events)}
    turns = [event for event in events if event.name == "maximum_indentation"]
    deepest = max(turns, key=lambda event: event.indentation, default=None)
    stops, ends = first.get("impactor_stops"), first.get("contact_ends")
    summary: dict[str, float | None] = dict.fromkeys(SUMMARY)
    summary["maximum_force"] = float(last["force_peak"]) * problem.scales.force
    if deepest is not None:
        summary["maximum_indentation"] = deepest.indentation
        summary["time_of_maximum_indentation"] = deepest.time
    if stops is not None:
        summary["time_impactor_stops"] = stops.time
    if ends is not None:
        summary["contact_duration"] = ends.time
        summary["permanent_indentation"] = ends.indentation
        summary["rebound_velocity"] = ends.impactor_velocity
        summary["coefficient_of_restitution"] = -float(last["nu"]) / problem.approach if problem.approach else None
        spent = float(last["spent"])
        rounding = 1e-14 * problem.approach**2
        summary["energy_absorbed"] = spent * problem.scales.energy if abs(spent) > rounding else 0.0
        summary["energy_radiated"] = _radiated(problem, ends, last)
    return summary


def _radiated(problem: Problem, ends: Event, last: Any) -> float:
    """Energy in target motion, J: kinetic energy gained by a free target, or ∫F²/Z dt, from the balance of energy."""
    if problem.share < 1.0:
        mass, before = problem.mass / (1.0 - problem.share), problem.drift - (
            1.0 - problem.share
        ) * problem.approach * problem.scales.velocity
        return 0.5 * mass * (ends.target_velocity**2 - before**2)
    if problem.gamma == 0.0:
        return 0.0
    lost = 0.5 * (problem.approach**2 - float(last["nu"]) ** 2) - float(last["spent"])
    return (lost + problem.load * (float(last["xi"]) + float(last["shift"]))) * problem.scales.energy


def _energy_warning(problem: Problem, summary: dict[str, float | None]) -> list[str]:
    absorbed = summary["energy_absorbed"]
    impact = 0.5 * problem.approach**2 * problem.scales.energy
    if absorbed is None or absorbed >= -1e-9 * impact:
        return []
    return [
        f"law {problem.law.name}: its unloading returns {-absorbed:.4g} J ({-100 * absorbed / impact:.3g} % of the impact "
        "energy) more than its loading stored"
    ]
