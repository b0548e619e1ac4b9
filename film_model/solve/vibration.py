"""Impacts on vibrating targets: the core's contact on modes, with as many modes as the accuracy needs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.errors import CoreError, Outcome, TooManyModes
from film_model.core import modal, native, refining
from film_model.problem.curve import curve_of
from film_model.problem.problem import Problem
from film_model.problem.summary import COMPARED
from film_model.scene import DEFAULT_ACCURACY, Solver
from film_model.solve import structures
from film_model.solve.accuracy import raise_failure
from film_model.solve.modal_motion import ModalMotion
from film_model.solve.mode_formulas import following, transferred
from film_model.targets import AbstractTarget

UNRESOLVED = 0.25
"""Highest frequency over that of the first run, below which the contact is not resolved and the scene is refused."""

HIGHEST = 64.0
"""Highest frequency over that of the first run, where more modes cannot be computed, or where the omitted compliance is
a mode: a stiffer one takes shorter steps and changes no result."""

_OUTCOMES = {native.EVENT: Outcome.SEPARATED, native.ENDLESS: Outcome.RESTING, native.OK: Outcome.TIME_LIMIT}
_STATUSES = {outcome: status for status, outcome in _OUTCOMES.items()}


@dataclass(frozen=True)
class Vibration(ModalMotion):
    """An impact on a vibrating target and how it was followed, in the units of the march. `summary` as the core's.

    start: as given to the core. met: the events, as the core records them. contacts: how many ended.
    """

    start: modal.Start = field(repr=False)
    met: NDArray[Any] = field(repr=False)
    outcome: Outcome
    summary: native.Summary = field(repr=False)
    contacts: int
    waited: bool
    target_error: float = 0.0
    """Relative error of the summary by the errors of the target's frequencies and static compliance."""

    @property
    def event_names(self) -> list[str]:
        """Names of the events."""
        return [native.EVENTS[kind] for kind in self.met["event"].tolist()]

    @property
    def status(self) -> int:
        """The core's status that the outcome comes from."""
        return _STATUSES[self.outcome]

    @property
    def separated(self) -> bool:
        """Whether the last contact has ended."""
        return self.outcome is Outcome.SEPARATED

    @property
    def reversible(self) -> bool:
        """Whether the contact gives back all the work on it: it is not damped, and unloads as it loads."""
        stages = self.curve.stage[: self.curve.stages]
        return all(stage.unloading == native.RETRACE and not stage.damped for stage in stages)

    def transferred(self, problem: Problem) -> float:
        """Energy that went into the target: that of the modes or, if these are damped, the remainder in the balance."""
        return float(transferred(problem, self.summary, self.damped, self.energy))

    def energies_in_si(self, problem: Problem) -> dict[str, float]:
        """The summary's energies, J, from those of the modes; none if the last contact has not ended."""
        given = {"energy_radiated": self.transferred(problem) * problem.scales.energy}
        return (given | ({"energy_absorbed": 0.0} if self.reversible else {})) if self.separated else {}

    @property
    def work(self) -> int:
        """Steps times modes, as limited by `modal.MOST_WORK`."""
        return int(self.summary.lines) * (self.modes + modal.MODES_OF_A_STEP)


def unused_options(solver: Solver, what: str = "the vibrating target is followed") -> list[str]:
    """The warning that a solver's options do not concern this kind of motion, if it has such."""
    if solver.segments is None and solver.linearisation != "chord":
        return []
    asked = solver.accuracy or DEFAULT_ACCURACY
    return [f"segments and linearisation are not used: {what} with accuracy {asked:g}"]


def vibrate(
    problem: Problem, target: AbstractTarget, accuracy: float, warnings: list[str], recorded: bool = True
) -> tuple[Vibration, float]:
    """The impact with as many modes as the accuracy needs, and the error estimate. recorded: with its motion.

    The highest frequency is raised, with a smaller tolerance of the steps, until three runs agree; after the first run
    without a run, as long as contact follows modes near it quickly: film_refine.c decides by how much. If more modes
    are needed than are allowed, or all runs together would take more work, the result is that of the last run, and a
    warning gives the accuracy reached.
    """
    unit, (limit, least) = problem.scales.time, _following(problem, target)
    first = structures.on_grid(target, least)
    tried, carried = [first], structures.CARRIED if problem.stretches else 0

    def modes(highest: float, share: int = 1) -> structures.Structure:
        tried.append(highest)
        return structures.structure_of(target, highest, unit, carried // share)

    scales = problem.scales
    units = scales.length, scales.force, scales.time
    plan = refining.Refinement(problem.start, *units, accuracy, math.inf, modal.MOST_WORK)
    plan.damped, plan.reversible, plan.carried = problem.law.damped, problem.curve.reversible, carried > 0
    try:
        rattles = structures.omitted_as_mode(problem, target, first)
        plan.skips, plan.most = not rattles, HIGHEST * first if rattles else math.inf
        found = _refined(problem, modes, limit, plan, first, recorded)
    except TooManyModes:
        plan.most = structures.computable(target, tried[-1] / 2.0**0.5, unit, UNRESOLVED * first)
        plan.skips = False
        found = _refined(problem, modes, limit, plan, plan.most / 4.0, recorded)
    if recorded and not found.met.size:
        found = _recorded(problem, found)
    warnings += _doubts(found, plan, modes(plan.below), target)
    return replace(found, target_error=plan.own), plan.estimated + plan.own


def _refined(
    problem: Problem, modes: Any, limit: float, plan: refining.Refinement, first: float, recorded: bool
) -> Vibration:
    """The runs that a plan asks for from a highest frequency on, and of them the result. limit: as of `run`. recorded:
    whether a run that is or may be the result is recorded at once."""
    found, lines = dict[float, Vibration](), 0
    modes(2.0 * first)  # TooManyModes before a run
    plan.begin(first)
    while plan.ask != refining.ENOUGH:
        try:
            structure, taken = modes(plan.highest, 1 + (plan.ask == refining.FEWER)), refining.Run()
            taken.shares = structure.tables.share.sum()
            if plan.ask == refining.SOFTER:
                structure = structure.softer
            if plan.ask != refining.SHARES:
                room = 2 * lines * (recorded and plan.final and plan.ask == refining.RUN)
                one = run(problem, structure, plan.tolerance, limit, room > 0, room)
                lines = int(one.summary.lines)
                taken.core, taken.modes = one.summary, one.modes
                taken.omitted, taken.error = structure.omitted, structure.doubt
                if plan.ask == refining.RUN:
                    found[plan.highest] = one
            plan.take(taken)
        except (CoreError, TooManyModes) as error:  # of steps: a stiff omitted mode rattles between the others
            plan.take(refining.Run(status=error.status if isinstance(error, CoreError) else native.TOO_MANY))
            if plan.ask == refining.FAILED:
                raise
    return found[plan.highest]


def _doubts(
    found: Vibration, plan: refining.Refinement, fewer: structures.Structure, target: AbstractTarget
) -> Iterator[str]:
    """Warnings of estimates above the accuracy. fewer: modes of the run before the last."""
    errors, changes = (dict(zip(COMPARED, each, strict=True)) for each in (plan.errors, plan.changes))
    accuracy, own = plan.accuracy, max(changes.values())
    missed = f"accuracy {accuracy:g} is not reached:"
    if plan.estimated > accuracy:
        poor = _above(errors, accuracy)
        yield f"{missed} with {found.modes} modes the estimated relative errors are {poor}"
    if own > accuracy or plan.estimated <= accuracy < plan.estimated + own:
        known, poor = fewer.error / fewer.omitted if fewer.omitted else 1.0, _above(changes, min(accuracy, 0.99 * own))
        also = ""
        if fewer.inexact is not None:
            high = float(fewer.raised[0][-1] / fewer.tables.frequency[-1]) - 1.0
            also = f"frequencies are known within {high:.1e}, and "
        yield (
            f"{missed} {also}how far vibrations above those that are followed deflect the {target.kind} is known "
            f"within {known:.1e}, which changes at most {poor}"
        )
    if plan.membrane > accuracy:
        yield (
            f"{missed} only the {found.tables.forms.shape[1]} lowest vibrations have membrane forces, which "
            f"changes the summary by up to {plan.membrane:.1e}"
        )


def _recorded(problem: Problem, found: Vibration) -> Vibration:
    """The same run with its record: most runs are compared only, and recording takes as long as the steps."""
    again = modal.impact(found.tables, found.curve, found.start, int(found.summary.lines))
    _check(again.status, problem, found.tables)
    return replace(found, segments=again.segments, flights=again.flights, met=again.events)


def _above(errors: dict[str, float], limit: float) -> str:
    return ", ".join(f"{name} {value:.1e}" for name, value in errors.items() if value > limit)


def time_limit(problem: Problem, target: AbstractTarget) -> float:
    """Time at which a contact is no longer followed, s."""
    return _following(problem, target)[0]


def _following(problem: Problem, target: AbstractTarget) -> tuple[float, float]:
    still = modal.still(curve_of(problem.law).native, problem.approach)
    return following(problem, still, target.compliance or 0.0, structures.lowest_frequency(target))


def run(
    problem: Problem,
    structure: structures.Structure,
    tolerance: float,
    limit: float,
    recorded: bool = True,
    expected: int = 0,
) -> Vibration:
    """The impact on these modes. tolerance: of a step. limit: time at which contact is no longer followed, s. recorded:
    with its motion and events. expected: number of segments for which there is room at once."""
    scales = problem.scales
    tables, rest = structures.tables_of(problem, structure, structure.omitted * scales.force / scales.length)
    curve = curve_of(problem.law).native
    start = modal.Start(
        *(problem.approach, problem.load, rest, problem.mass, scales.time, problem.damping, tolerance, limit),
        stretch=scales.length**2,
    )
    found = modal.impact(tables, curve, start, expected, recorded)
    _check(found.status, problem, tables)
    core = found.summary.core
    for name in ("time_of_maximum_indentation", "time_impactor_stops", "contact_duration"):
        setattr(core, name, getattr(core, name) / scales.time)
    return Vibration(
        curve=curve,
        tables=tables,
        unit=scales.time,
        segments=found.segments,
        flights=found.flights,
        energies=found.energies,
        highest=structure.highest,
        stretching=found.stretching,
        start=start,
        met=found.events,
        outcome=_OUTCOMES[found.status],
        summary=core,
        contacts=found.summary.contacts,
        waited=bool(found.summary.waited),
    )


def _check(status: int, problem: Problem, tables: modal.Tables) -> None:
    """Raise for a run that failed."""
    if status == native.TOO_MANY:
        raise CoreError(f"law {problem.law.name}: {_too_many_steps(problem, tables)}", status)
    raise_failure(status, problem)


def _too_many_steps(problem: Problem, tables: modal.Tables) -> str:
    """Why an impact on these modes takes too many steps, and what to do."""
    hertz, lightest = tables.frequency / (2.0 * math.pi), int(np.argmax(tables.share))
    return (
        f"the contact with {hertz.size} vibrations from {hertz[0]:.4g} to {hertz[-1]:.4g} Hz needs more steps than the "
        f"{modal.MOST_WORK // (hertz.size + modal.MODES_OF_A_STEP)} allowed. The lightest, at "
        f"{hertz[lightest]:.4g} Hz, has a modal mass of {1 / tables.share[lightest]:.3g} kg at the struck point, "
        f"the impactor {problem.mass:.3g} kg: check modal_mass or the shape of a structure; take "
        "static_stiffness for a plate or beam"
    )
