"""simulate(scene) → History: the mesh for the requested accuracy, and the impact recorded on it."""

from __future__ import annotations

import warnings as python_warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias, cast

import numpy as np

from film_model.base.errors import ImpactWarning, Outcome, SimulationError, shown
from film_model.core import native
from film_model.effects.choose import Choice, choose
from film_model.effects.effect import NOT_JUDGED
from film_model.problem.problem import Problem
from film_model.problem.summary import energy_warning, summary_of
from film_model.scene import DEFAULT_ACCURACY, Scene, Solver
from film_model.solve.accuracy import Linearisation, estimate, mesh_of, raise_failure, refine, solver_for
from film_model.solve.history import MOTION, Accuracy, Event, History, stages_at

if TYPE_CHECKING:
    from film_model.solve.vibration import Vibration


def simulate(
    scene: Scene,
    *,
    accuracy: float | None = None,
    segments: int | None = None,
    linearisation: Linearisation | None = None,
    derivatives: Sequence[str] = (),
) -> History:
    """The impact a scene describes, from first touch to the end of contact.

    accuracy: relative, of every summary value, but ten times as large of the time of the largest indentation on a
    vibrating target; or segments: number per stage; both default to the scene's. The method is FILM (Big-Alabo,
    Cartmell & Harrison 2017) with work-preserving segments on graded nodes, of fourth order in the number of segments;
    linearisation="chord" is the paper's, of second order. The error is estimated from the difference of two meshes, one
    with twice the segments of the other. An impactor without velocity, which its weight presses in, is followed until
    it moves in again: that swing repeats or fades.

    A target whose vibrations matter is followed by its natural modes, as many as the accuracy needs. The contact of
    viscoelastic bodies is solved by collocation in time, with steps as short as the accuracy needs.

    derivatives: keys of the scene, such as "impactor.velocity", by which the summary and the results along the surface
    are differentiated, with the other entries of the scene and the decisions about effects held fixed; see
    `film_model.Derivatives`.

    Every entry of the history's `warnings` is issued as an ImpactWarning too.

    Raises SceneError for a bad option, SimulationError for a contact that the core cannot march or for a derivative by
    a number with which the target's crowded frequencies change, TypeError if `scene` is not a Scene.

    >>> history = fm.simulate(scene)
    >>> print(f"{history.maximum_force.to('kN'):.3f~P}")
    1.444 kN
    """
    if not isinstance(scene, Scene):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"simulate takes a Scene, not {shown(scene)}: Scene.from_toml reads one from a file")
    history = simulate_quietly(
        scene, accuracy=accuracy, segments=segments, linearisation=linearisation, derivatives=derivatives
    )
    for sentence in history.warnings if _warnings_are_shown() else ():
        python_warnings.warn(sentence, ImpactWarning, stacklevel=2)
    return history


def _warnings_are_shown() -> bool:
    """Whether Python may show an ImpactWarning: if not, the effects that only cause warnings need not be estimated."""
    for action, message, category, module, line in python_warnings.filters:
        everywhere = message is None and module is None and line == 0
        if issubclass(ImpactWarning, category) and (everywhere or action != "ignore"):
            return action != "ignore"
    return True


def simulate_quietly(
    scene: Scene,
    *,
    accuracy: float | None = None,
    segments: int | None = None,
    linearisation: Linearisation | None = None,
    derivatives: Sequence[str] = (),
) -> History:
    """As :func:`simulate`, without Python warnings: for callers that show `warnings` themselves or try many scenes."""
    solver = solver_for(scene.solver, accuracy, segments, linearisation)
    if not derivatives:
        return simulate_chosen(choose(scene), solver)
    from film_model.solve.derivatives import derivatives_of, entries_of

    entries, choice = entries_of(scene, derivatives), choose(scene)
    history = simulate_chosen(choice, solver)
    vibration = cast("Vibration | None", history.vibration)  # simulated here, not read from a file
    return replace(history, derivatives=derivatives_of(choice, solver, entries, vibration, history.oblique is not None))


def simulate_chosen(choice: Choice, solver: Solver) -> History:
    """As :func:`simulate`, for effects that are already chosen."""
    history = _normal(choice, solver)
    if history.scene.contact.friction is None:
        return history
    from film_model.oblique.friction import oblique_of

    rebound = history.summary["rebound_velocity"]
    begins, ends = ([e.time for e in history.events if e.name == f"contact_{what}"] for what in ("begins", "ends"))
    estimated = history.accuracy.estimated
    found = oblique_of(history.scene, history.problem, rebound, history.sample_si, (begins, ends), estimated)
    return replace(history, oblique=found)


def _normal(choice: Choice, solver: Solver) -> History:
    """The normal motion, which friction does not change."""
    problem, scene = choice.problem, choice.scene
    if problem.approach == 0.0 and problem.load <= 0.0:
        raise SimulationError("the impactor has no velocity and no force pushes it: there is no impact")
    scene = scene if solver is scene.solver else replace(scene, solver=solver)
    way = _on_modes if problem.vibrates else _on_lines if problem.relaxation is None else _relaxing
    remarks = list[str]()
    if scene.target.sensors and not problem.vibrates:
        remarks.append(f"sensors are left out: the vibrations of the {scene.target.kind} are not simulated")
    values, parts = way(scene, choice, remarks)
    summary = {name: value if value == value else None for name, value in values.items()}  # None: did not happen
    remarks += energy_warning(problem, summary)
    parts.setdefault("lines", np.empty(0, native.LINE_DTYPE))
    return History(scene=scene, choice=choice, summary=summary, remarks=tuple(remarks), **parts)


_Parts: TypeAlias = tuple[dict[str, Any], dict[str, Any]]
"""The summary of a motion, nan for what did not happen, and the parts of its history by their names."""


def _on_lines(scene: Scene, choice: Choice, warnings: list[str]) -> _Parts:
    """An impact that the core marches."""
    problem, solver = choice.problem, scene.solver
    if solver.segments is not None:
        counts, estimated = (solver.segments, solver.segments), estimate(problem, solver)
    else:
        counts, estimated = refine(problem, solver, warnings)
    estimated += problem.curve.fit_error
    status, lines, states, summary = _record(problem, solver, counts)
    target, outcome = scene.target, _outcome(status)
    if outcome is Outcome.TIME_LIMIT and target.structural and not target.finite:
        warnings.append(
            f"contact does not end: no wave comes back to the impactor in an infinite {target.kind}; "
            f"give target.{target.extent}"
        )
    accuracy = Accuracy(solver.accuracy, estimated, *counts, lines.size - 1)
    events = _events_on_lines(problem, states)
    found = {"lines": lines, "events": events, "outcome": outcome, "accuracy": accuracy}
    return summary_of(problem, status, summary), found


def _record(problem: Problem, solver: Solver, counts: tuple[int, int]) -> tuple[int, Any, Any, native.Summary]:
    """Status, segments, states at events, and the core's summary."""
    state = native.initial_state(problem.curve.native, problem.start)
    room = (counts[0] + 2) * (problem.curve.native.stages + 1) + 4 * counts[1] + 64
    cut = mesh_of(solver, counts)
    status, lines, states, summary = native.record(problem.curve.native, cut, state, problem.start.time_limit, room)
    raise_failure(status, problem)
    if status == native.OK and problem.approach == 0.0:
        returns = np.flatnonzero(states["event"] == native.EVENTS.index("reloading_begins"))
        if returns.size:
            status, states = native.ENDLESS, states[: returns[0] + 1]  # what follows repeats this swing, or fades
    return status, lines, states, summary


def _events_on_lines(problem: Problem, states: Any) -> tuple[Event, ...]:
    """Events, from the core's states (STATE_DTYPE) there."""
    curve, force, nu = problem.curve.native, states["force"], states["nu"]
    values: Any = (states["xi"], nu - problem.gamma * force, force, nu, states["shift"])
    if curve.compliance > 0.0:
        values = np.stack([native.motion(curve, native.State.from_buffer_copy(state)) for state in states], axis=1)
    names = [native.EVENTS[kind] for kind in states["event"].tolist()]
    return _events(problem, names, states["time"], values, states["branch"].tolist())


def _events(problem: Problem, names: list[str], times: Any, values: Any, branches: list[int]) -> tuple[Event, ...]:
    """Events in SI. times: in the march's unit. values: the core's five there (`motion_of`). branches: after them."""
    times = times * problem.scales.time
    motion = problem.motion(times, values)
    columns = [motion[name].tolist() for name in MOTION]
    return tuple(map(Event._make, zip(names, times.tolist(), stages_at(problem, branches), *columns, strict=True)))


def _outcome(status: int) -> Outcome:
    if status == native.EVENT:
        return Outcome.SEPARATED
    return Outcome.RESTING if status == native.ENDLESS else Outcome.TIME_LIMIT


def _on_modes(scene: Scene, choice: Choice, warnings: list[str]) -> _Parts:
    """An impact on a vibrating target."""
    from film_model.solve.vibration import unused_options, vibrate

    target, solver, problem = scene.target, scene.solver, choice.problem
    asked = solver.accuracy or DEFAULT_ACCURACY
    warnings.extend(unused_options(solver))
    vibration, estimated = vibrate(problem, target, asked, warnings)
    values = summary_of(problem, native.EVENT if vibration.separated else native.OK, vibration.summary)
    values |= vibration.energies_in_si(problem)
    met = vibration.met
    events = _events(
        problem, vibration.event_names, met["time"] / vibration.unit, met["values"].T, met["branch"].tolist()
    )
    lost = [event.time for event in events if event.name == "contact_ends"]
    if len(lost) > 1:
        warnings.append(
            f"there are {len(lost)} contacts: contact_duration is that of the first, which ends after {lost[0]:.4g} s; "
            f"the rebound is that after the last, which ends after {lost[-1]:.4g} s{_unknown_shear(choice)}"
        )
    if vibration.waited:
        warnings.append("the target still vibrates so far that it may touch the impactor again")
    accuracy = Accuracy(solver.accuracy, estimated + problem.curve.fit_error, 0, 0, 0, vibration.modes)
    return values, {"events": events, "outcome": vibration.outcome, "accuracy": accuracy, "vibration": vibration}


def _relaxing(scene: Scene, choice: Choice, warnings: list[str]) -> _Parts:
    """An impact of viscoelastic bodies."""
    from film_model.solve.relaxed import relax
    from film_model.solve.vibration import unused_options

    solver, problem = scene.solver, choice.problem
    warnings.extend(unused_options(solver, "the contact of viscoelastic bodies is solved"))
    relaxed, estimated, _ = relax(problem, solver.accuracy or DEFAULT_ACCURACY, warnings)
    names, times, branches = zip(*relaxed.events, strict=True)
    values, _ = relaxed.sample(np.array(times))
    events = _events(problem, list(names), np.array(times), values.T, list(branches))
    accuracy, outcome = Accuracy(solver.accuracy, estimated, 0, 0, relaxed.steps), _outcome(relaxed.status)
    found = {"events": events, "outcome": outcome, "accuracy": accuracy, "relaxed": relaxed}
    return summary_of(problem, relaxed.status, relaxed.summary), found


def _unknown_shear(choice: Choice) -> str:
    """The end of the warning about several contacts, if the theory of the target neglects shear."""
    shear = next(effect for effect in choice.effects if effect.name == "thickness")
    if shear.state != NOT_JUDGED:
        return ""
    kind = choice.scene.target.kind
    return f"; how shear of the {kind}, which is neglected, would change the later ones cannot be judged"
