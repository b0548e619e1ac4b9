"""simulate(scene) → History: the mesh that meets the accuracy, and the record of the impact on it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from film_model.accuracy import Linearisation, estimate, mesh_of, raise_failure, refine, solver_for
from film_model.core import native
from film_model.errors import Outcome, SimulationError, shown
from film_model.history import SUMMARY, Accuracy, Event, History, stage_names
from film_model.problem import Problem, problem_of
from film_model.scene import DEFAULT_ACCURACY, Beam, Plate, Scene, Solver
from film_model.vibration import vibrate

GRAZING = 1e-12
"""Kinetic energy of a ball laid down, over what its load has put in: less, where it lifts off, is rounding."""


def simulate(
    scene: Scene,
    *,
    accuracy: float | None = None,
    segments: int | None = None,
    linearisation: Linearisation | None = None,
) -> History:
    """The impact a scene describes, from first touch to the end of contact.

    accuracy: relative, of every summary value; or segments: lines a stage; both default to the scene's. The march is
    FILM (Big-Alabo, Cartmell & Harrison 2017) on graded work-preserving lines, of fourth order in the number of
    segments; linearisation="chord" is the paper's, of second order. The error estimate is the difference between two
    meshes, one with twice the segments of the other.

    A plate or beam whose vibrations matter is integrated with so many of its modes as the accuracy needs.

    Raises SceneError for a bad option, SimulationError for a contact the core cannot follow, TypeError for what is no
    scene.
    """
    if not isinstance(scene, Scene):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"simulate takes a Scene, not {shown(scene)}: Scene.from_toml reads one from a file")
    solver = solver_for(scene.solver, accuracy, segments, linearisation)
    problem = problem_of(scene)
    if problem.approach == 0.0 and problem.load <= 0.0:
        raise SimulationError("the impactor has no velocity and no force pushes it: there is no impact")
    warnings: list[str] = []
    if problem.vibrates:
        return _on_modes(replace(scene, solver=solver), problem, warnings)
    if solver.segments is not None:
        counts, estimated = (solver.segments, solver.segments), estimate(problem, solver)
    else:
        counts, estimated = refine(problem, solver, warnings)
    estimated += problem.curve.fit_error
    status, lines, states, peak = _record(problem, solver, counts)
    events = events_of(problem, states)
    summary = _summarise(problem, events, states[-1], peak)
    warnings.extend(_energy_warning(problem, summary))
    return History(
        scene=replace(scene, solver=solver),
        problem=problem,
        lines=lines,
        events=events,
        outcome=_outcome(status),
        summary=summary,
        accuracy=Accuracy(solver.accuracy, estimated, *counts, lines.size - 1),
        remarks=tuple(warnings),
    )


def _record(problem: Problem, solver: Solver, counts: tuple[int, int]) -> tuple[int, Any, Any, float]:
    """Status, lines, states at events, and the largest force."""
    state = native.initial_state(problem.curve.native, problem.start)
    room = (counts[0] + 2) * (problem.curve.native.stages + 1) + 4 * counts[1] + 64
    status, lines, states = native.record(problem.curve.native, mesh_of(solver, counts), state, problem.limit, room)
    raise_failure(status, problem)
    peak = max(state.force_peak, state.force)
    if (
        problem.approach == 0.0
        and status == native.EVENT
        and state.nu**2 <= GRAZING * problem.load * states["xi"].max()
    ):
        status, states = native.OK, states[:-1]  # at first touch again, without velocity: the load presses it back
    return status, lines, states, peak


def events_of(problem: Problem, states: Any) -> tuple[Event, ...]:
    """Events in SI from the core's states (STATE_DTYPE) at them."""
    t = states["time"] * problem.scales.time
    relative = states["nu"] - problem.gamma * states["force"]
    values = np.stack([states["xi"], relative, states["force"], states["nu"], states["shift"]], axis=-1)
    if problem.curve.native.compliance > 0.0:
        at = [native.State.from_buffer_copy(state) for state in states]
        values = np.array([native.motion(problem.curve.native, state) for state in at]).reshape(-1, 5)
    kinds = [native.EVENTS[kind] for kind in states["event"].tolist()]
    return _events(problem, kinds, t, values, states["branch"].tolist())


def _events(problem: Problem, kinds: list[str], t: Any, values: Any, branches: list[int]) -> tuple[Event, ...]:
    columns = [column.tolist() for column in problem.motion(t, values).values()]
    names = stage_names(problem)
    rows = zip(kinds, t.tolist(), branches, zip(*columns, strict=True), strict=True)
    return tuple(Event(kind, time, names[branch], *motion) for kind, time, branch, motion in rows)


def _on_modes(scene: Scene, problem: Problem, warnings: list[str]) -> History:
    """The history of an impact on a vibrating target."""
    target, solver = scene.target, scene.solver
    assert isinstance(target, Plate | Beam) and target.compliance is not None
    asked = solver.accuracy or DEFAULT_ACCURACY
    if solver.segments is not None or solver.linearisation == "chord":
        warnings.append(
            f"segments and linearisation are not used: the target vibrates and is integrated, at accuracy {asked:g}"
        )
    vibration, estimated = vibrate(problem, target.modes, target.compliance, asked, warnings)
    scales, found, moments = problem.scales, vibration.summary, vibration.events
    t = np.array([moment.time for moment in moments]) * scales.time
    values = np.stack([moment.values for moment in moments])
    events = _events(problem, [m.name for m in moments], t, values, [m.branch for m in moments])
    units = {"force": scales.force, "length": scales.length, "time": scales.time}
    summary: dict[str, float | None] = dict.fromkeys(SUMMARY)
    for name in native.SUMMARY:
        value = getattr(found, name)
        if name in SUMMARY and not math.isnan(value):
            summary[name] = value * units[SUMMARY[name][0]]
    lost = [event.time for event in events if event.name == "contact_ends"]
    if vibration.outcome is Outcome.SEPARATED:
        summary["rebound_velocity"] = found.final_velocity * scales.velocity
        summary["coefficient_of_restitution"] = -found.final_velocity / problem.approach if problem.approach else None
        small = asked * problem.approach**2
        summary["energy_absorbed"] = found.work * scales.energy if abs(found.work) > small else 0.0
        summary["energy_radiated"] = vibration.energy * scales.energy
    if len(lost) > 1:
        warnings.append(
            f"contact is lost after {lost[0]:.4g} s and comes back: contact_duration is that of the first of "
            f"{len(lost)} contacts, the rebound that after the last, which ends after {lost[-1]:.4g} s"
        )
    if vibration.waited:
        warnings.append("the target still vibrates within reach of the impactor and might touch it again")
    return History(
        scene=scene,
        problem=problem,
        lines=np.empty(0, native.LINE_DTYPE),
        events=events,
        outcome=vibration.outcome,
        summary=summary,
        accuracy=Accuracy(solver.accuracy, estimated + problem.curve.fit_error, 0, 0, 0, vibration.modes),
        remarks=tuple(warnings),
        vibration=vibration,
    )


def _outcome(status: int) -> Outcome:
    if status == native.EVENT:
        return Outcome.SEPARATED
    return Outcome.RESTING if status == native.ENDLESS else Outcome.TIME_LIMIT


def _summarise(problem: Problem, events: tuple[Event, ...], last: Any, peak: float) -> dict[str, float | None]:
    """Summary in SI, with the core's state at the last event and largest force; None for what did not happen."""
    first = {event.name: event for event in reversed(events)}
    turns = [event for event in events if event.name == "maximum_indentation"]
    deepest = max(turns, key=lambda event: event.indentation, default=None)
    stops, ends = first.get("impactor_stops"), first.get("contact_ends")
    summary: dict[str, float | None] = dict.fromkeys(SUMMARY)
    summary["maximum_force"] = peak * problem.scales.force
    if deepest is not None:
        summary["maximum_indentation"] = deepest.indentation
        summary["time_of_maximum_indentation"] = deepest.time
    if stops is not None:
        summary["time_impactor_stops"] = stops.time
    if ends is not None:
        summary["contact_duration"] = ends.time
        summary["permanent_indentation"] = float(last["xi_free"]) * problem.scales.length
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
        other = 1.0 - problem.share
        mass, before = problem.mass / other, problem.drift - other * problem.approach * problem.scales.velocity
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
    share = f" ({-100 * absorbed / impact:.3g} % of the impact energy)" if impact > 0.0 else ""
    return [f"law {problem.law.name}: its unloading returns {-absorbed:.4g} J{share} more than its loading stored"]
