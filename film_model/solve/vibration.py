"""Impacts on vibrating targets: the core's contact on modes, with as many modes as the accuracy needs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import greater
from film_model.base.errors import CoreError, Outcome, TooManyModes
from film_model.core import modal, native
from film_model.problem.curve import curve_of
from film_model.problem.problem import Problem
from film_model.problem.summary import differences, radiated
from film_model.scene import DEFAULT_ACCURACY, Solver
from film_model.solve import structures
from film_model.solve.accuracy import raise_failure
from film_model.solve.modal_motion import ModalMotion
from film_model.solve.mode_formulas import MODES_FALL, error_of, falling, following, softness, step_share, swiftness
from film_model.targets import AbstractTarget

STEP = 0.03
"""Tolerance of a step over the requested accuracy. The error of a time or a slow rebound may be 40 times as large."""

TIGHTEST = 1e-13
"""Least tolerance of a step: for a smaller one rounding makes its steps too short."""

REFINED = 2.0
"""Tolerance of a step over that of the run with twice the highest frequency."""

FOLLOWED = 1.0
"""Rate at which contact follows the structure, over the highest frequency, from which on runs are compared: below it
results converge. On 24 plates an accuracy of 1e-3 is reached at 0.04 to 0.12."""

UNRESOLVED = 0.25
"""Highest frequency over that of the first run, below which the contact is not resolved and the scene is refused."""

NEGLIGIBLE = 1e-3
"""Error of the omitted compliance that does not matter, over that and the contact's, and over the accuracy."""

HIGHEST = 64.0
"""Highest frequency over that of the first run, where more modes cannot be computed, or where the omitted compliance is
a mode: a stiffer one takes shorter steps and changes no result."""

STIFFER = 4.0
"""By how much the highest frequency grows from run to run of a damped law, once there are no more modes: then only the
omitted compliance is stiffer, and errors about halve with each doubling."""

MANY = 400
"""Modes of a run of a damped law from which on the next is recorded although it may not be the last: that takes 3 % of
it, and which run shows that more bring no accuracy is not known before."""

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
    """Relative error of the summary by the error of the target's static compliance."""

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
        return float(radiated(problem, self.summary)) if self.damped else self.energy

    def energies_in_si(self, problem: Problem) -> dict[str, float]:
        """The summary's energies, J, from those of the modes; none if the last contact has not ended."""
        given = {"energy_radiated": self.transferred(problem) * problem.scales.energy}
        return (given | ({"energy_absorbed": 0.0} if self.reversible else {})) if self.separated else {}

    @property
    def work(self) -> int:
        """Steps times modes, as limited by `modal.MOST_WORK`."""
        return int(self.summary.lines) * (self.modes + modal.MODES_OF_A_STEP)


ModesUpTo = Callable[[float], structures.Structure]
"""The modes up to a frequency, rad/s."""


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

    The highest frequency is doubled, or grows by `STIFFER`, with a smaller tolerance of the steps, until three runs
    agree; after the first run without a run, as long as contact follows modes near it quickly. If more modes are needed
    than are allowed, or all runs together would take more work, the result is that of the last run, and a warning gives
    the accuracy reached.
    """
    unit, (limit, least) = problem.scales.time, _following(problem, target)
    first = structures.on_grid(target, least)
    tried, carried = [first], structures.CARRIED if problem.stretches else 0

    def modes(highest: float) -> structures.Structure:
        tried.append(highest)
        return structures.structure_of(target, highest, unit, carried)

    try:
        rattles = structures.omitted_as_mode(problem, target, first)
        between = first, HIGHEST * first if rattles else math.inf
        *runs, estimated = _refined(problem, modes, limit, between, accuracy, warnings, recorded)
    except TooManyModes:
        most = structures.computable(target, tried[-1] / 2.0**0.5, unit, UNRESOLVED * first)
        *runs, estimated = _refined(problem, modes, limit, (most / 4.0, most), accuracy, warnings, recorded)
    coarse, found = runs
    if recorded and not found.met.size:
        found = _recorded(problem, found)
    changes = _target_errors(problem, (few := modes(coarse.highest)), coarse, accuracy)
    own = float(max(changes.values(), default=0.0))
    if own > accuracy or estimated <= accuracy < estimated + own:
        known, poor = few.error / few.omitted if few.omitted else 1.0, _above(changes, min(accuracy, 0.99 * own))
        warnings.append(
            f"accuracy {accuracy:g} is not reached: how far vibrations above those that are followed deflect the "
            f"{target.kind} is known within {known:.1e}, which changes at most {poor}"
        )
    if carried:
        fewer = structures.structure_of(target, found.highest, unit, carried // 2)
        own += _membrane_error(problem, found, fewer, accuracy, warnings)
    return replace(found, target_error=own), estimated + own


MEMBRANE_FACTOR = 2.0
"""Bound on the error by the number of vibrations with membrane forces over the change if only half of them have these:
the error is about inversely proportional to the number."""


def _membrane_error(
    problem: Problem, found: Vibration, fewer: structures.Structure, accuracy: float, warnings: list[str]
) -> float:
    """The error by membrane forces on the lowest vibrations alone, with a warning if it is above the accuracy."""
    other = run(problem, fewer, found.start.tolerance, found.start.limit, recorded=False)
    error = MEMBRANE_FACTOR * max(map(float, differences(problem, other.summary, found.summary).values()))
    if error > accuracy:
        count = found.tables.forms.shape[1]
        warnings.append(
            f"accuracy {accuracy:g} is not reached: only the {count} lowest vibrations have membrane forces, which "
            f"changes the summary by up to {error:.1e}"
        )
    return error


def _target_errors(
    problem: Problem, structure: structures.Structure, found: Vibration, accuracy: float
) -> dict[str, float]:
    """Relative changes of the summary by the error of the omitted compliance: from a run with fewer modes than the last
    and one with more compliance. None if it is too small to matter."""
    core, error = found.summary, structure.error
    if negligible(error, softness(problem, core) + structure.omitted, accuracy):
        return {}
    other = run(problem, structures.softer(structure, error), found.start.tolerance, found.start.limit, recorded=False)
    return differences(problem, core, other.summary)


def _refined(
    problem: Problem,
    modes: ModesUpTo,
    limit: float,
    between: tuple[float, float],
    accuracy: float,
    warnings: list[str],
    recorded: bool,
) -> tuple[Vibration, Vibration, float]:
    """`vibrate` with the highest frequency between two values: the last two runs, and the estimate. limit: as of `run`.
    recorded: whether a run that is or may be the last is recorded at once."""
    (highest, most), tolerance, damped = between, tightened(accuracy, STEP), problem.law.damped
    estimates = [math.inf]

    def follow(upto: float, tolerance: float, expected: int = 0) -> Vibration:
        return run(problem, modes(upto), tolerance, limit, expected > 0, expected)

    modes(2.0 * highest)  # TooManyModes before a run
    runs = [follow(highest, REFINED * tolerance)]
    swift = _swiftness(problem, runs[0], modes(highest))
    tolerance = tightened(tolerance, step_share(problem, runs[0].summary, swift))
    while math.isinf(most) and _swiftness(problem, runs[0], modes(2.0 * highest)) > FOLLOWED * 2.0 * highest:
        highest *= 2.0
    while True:
        work, same = sum(each.work for each in runs), len(runs) > 1 and runs[-1].modes == runs[-2].modes
        upto = min((STIFFER if same else 2.0) * highest, most)
        sure = upto >= most or work + 5 * runs[-1].work > modal.MOST_WORK  # if more modes take no less
        many = damped and runs[-1].modes >= MANY
        final = recorded and (sure or many or estimates[-1] <= MODES_FALL * accuracy)
        try:
            runs.append(follow(upto, tolerance, 2 * int(runs[-1].summary.lines) * final))
            highest = upto
            work += 5 * runs[-1].work
            last = highest >= most or work > modal.MOST_WORK or 4 * runs[-1].modes > structures.MOST_MODES
        except (CoreError, TooManyModes) as error:  # of steps: a stiff omitted mode rattles between the others
            if len(runs) == 1 or (isinstance(error, CoreError) and error.status != native.TOO_MANY):
                raise
            last = True
        if last and len(runs) == 2:  # the difference to fewer modes than those of the first run is known quickly
            runs.insert(0, follow(highest / 4.0, REFINED**2 * tolerance))
        if len(runs) > 2:
            before, change = (differences(problem, *(r.summary for r in pair)) for pair in (runs[-3:-1], runs[-2:]))
            errors = {name: float(error_of(damped, before[name], change[name])) + tolerance for name in change}
            estimates.append(max(errors.values()))
            if estimates[-1] <= accuracy:
                return runs[-2], runs[-1], estimates[-1]
            if last or (damped and _out_of_reach(estimates, accuracy, most / highest, same)):
                return runs[-2], runs[-1], _unreached(runs[-1], errors, accuracy, warnings)
        tolerance = tightened(tolerance, 1.0 / REFINED)


def _out_of_reach(estimates: list[float], accuracy: float, higher: float, stiffer: bool) -> bool:
    """Whether the accuracy is not reached with vibrations up to `higher` times the highest frequency, as it seems.
    stiffer: the last step was `STIFFER`."""
    return len(estimates) > 3 and float(falling(estimates[-1], estimates[-2 if stiffer else -3], higher)) > accuracy


def _recorded(problem: Problem, found: Vibration) -> Vibration:
    """The same run with its record: most runs are compared only, and recording takes as long as the steps."""
    again = modal.impact(found.tables, found.curve, found.start, int(found.summary.lines))
    _check(again.status, problem, found.tables)
    return replace(found, segments=again.segments, flights=again.flights, met=again.events)


def _unreached(found: Vibration, errors: dict[str, float], accuracy: float, warnings: list[str]) -> float:
    """The estimate of a run, with the warning that it is above the accuracy."""
    poor = _above(errors, accuracy)
    warnings.append(
        f"accuracy {accuracy:g} is not reached: with {found.modes} modes the estimated relative errors are {poor}"
    )
    return max(errors.values())


def _above(errors: dict[str, float], limit: float) -> str:
    return ", ".join(f"{name} {value:.1e}" for name, value in errors.items() if value > limit)


def _swiftness(problem: Problem, found: Vibration, structure: structures.Structure) -> float:
    """That of a run with the modes of a structure."""
    return swiftness(problem, found.summary, float(structure.tables.share.sum()), structure.highest)


def tightened(tolerance: Any, share: Any) -> Any:
    """A share of a tolerance, as far as a step can meet it."""
    return greater(tolerance * share, TIGHTEST)


def negligible(error: Any, compliance: Any, accuracy: Any) -> Any:
    """Whether an error of the omitted compliance does not matter beside that and the contact's, all in m/N."""
    return error <= NEGLIGIBLE * accuracy * compliance


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
