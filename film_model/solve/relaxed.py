"""Impacts of viscoelastic bodies: the core's relaxing contact, with steps as short as the accuracy needs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, either, greater
from film_model.base.errors import CoreError
from film_model.core import native, relaxing
from film_model.core.columns import Columns
from film_model.problem.problem import TRIAL_TOLERANCE, Problem
from film_model.problem.summary import difference, rounding
from film_model.scene import DEFAULT_ACCURACY, Solver
from film_model.solve.accuracy import raise_failure

FINER, FINEST = 0.1, 1e-10
"""Tolerances of a step: of a run over that of the one before, and the least. The first run is the trial."""

FACTOR, FALL, FLOOR = 2.0, 10.0, 0.01
"""Bound on the error of a run over its difference to the run before, by how much a run divides the error at most, and
bound on the error over the tolerance: two runs may agree by chance. Of 900 random impacts the estimate bounds the error
of all; tests/test_viscoelasticity.py draws some."""


@dataclass(frozen=True)
class Relaxed:
    """An impact of viscoelastic bodies, in the units of the march."""

    record: relaxing.Record = field(repr=False)

    @property
    def status(self) -> int:
        """The core's."""
        return self.record.status

    @property
    def summary(self) -> native.Summary:
        """As the core's of a march."""
        return self.record.summary

    @property
    def steps(self) -> int:
        """Number of steps."""
        return int(self.summary.lines)

    def sample(self, times: Array) -> tuple[Array, NDArray[np.int8]]:
        """(count, 5) values ξ, ξ', f, ν, target displacement at ascending times, and branch of each."""
        return self.record.sample(times)

    @property
    def events(self) -> list[tuple[str, float, int]]:
        """Events in the order of their times: name, time, and branch after it."""
        core = self.summary
        found = [("contact_begins", 0.0, 0)]
        if core.maximum_indentation > 0.0:
            found.append(("maximum_indentation", core.time_of_maximum_indentation, native.BRANCH))
        stops, turn = core.time_impactor_stops, core.time_of_maximum_indentation
        if stops == stops:
            turned = core.maximum_indentation > 0.0 and stops >= turn
            found.append(("impactor_stops", stops, native.BRANCH if turned else 0))
        if self.status == native.EVENT:
            found.append(("contact_ends", core.contact_duration, native.FREE))
        return sorted(found, key=lambda event: event[1])


def relax(problem: Problem, accuracy: float, warnings: list[str]) -> tuple[Relaxed, float, float]:
    """One impact with steps that meet the accuracy; the error estimate, and the tolerance of the steps."""
    tolerance, estimated = finest(problem, accuracy)
    if estimated > accuracy:
        warnings.append(f"accuracy {accuracy:g} is not reached: the estimated relative error is {estimated:.1e}")
    assert problem.relaxation is not None
    record = relaxing.Record(problem.relaxation.law(problem.scales.time), problem.start, tolerance)
    raise_failure(record.status, problem)
    return Relaxed(record), estimated, tolerance


def finest(problem: Problem, accuracy: float) -> tuple[float, float]:
    """The tolerance of the steps of one impact that meets the accuracy, and the error estimate."""
    tolerance, before, (status, coarse, _) = TRIAL_TOLERANCE, 1.0, problem.trial
    raise_failure(status, problem)
    while True:
        tolerance *= FINER
        status, fine = problem.relax(tolerance)
        raise_failure(status, problem)
        estimated, before = _estimate(problem, coarse, fine, before, tolerance)
        if estimated <= accuracy or tolerance < FINEST:
            return tolerance, estimated
        coarse = fine


def _estimate(problem: Problem, coarse: Any, fine: Any, before: Any, tolerance: float) -> tuple[Any, Any]:
    """Bound on the error of one impact or of many, and the difference of two runs. before: that of the runs before; 1
    if there were none."""
    here = difference(problem, coarse, fine)
    apart = greater(here, either(before < 1.0, before / FALL, 0.0))
    return FACTOR * apart + FLOOR * tolerance + rounding(problem, fine), here


def relax_many(problem: Problem, solver: Solver) -> tuple[NDArray[np.int32], Columns, Array]:
    """Statuses, summaries and error estimates of many impacts, each with steps that meet the accuracy."""
    accuracy = solver.accuracy or DEFAULT_ACCURACY
    status, core = problem.trial.status.copy(), Columns(problem.trial.summary.table.copy())
    estimated, before = np.full(status.size, np.nan), np.ones(status.size)
    left, tolerance = np.flatnonzero(status >= 0), TRIAL_TOLERANCE
    while left.size and tolerance >= FINEST:
        tolerance *= FINER
        part = problem.part(left)
        found, fine = part.relax(tolerance)
        coarse = Columns(core.table[left])
        estimated[left], before[left] = _estimate(part, coarse, fine, before[left], tolerance)
        status[left], core.table[left] = found, fine.table
        estimated[status < 0] = np.nan
        left = left[(estimated[left] > accuracy) & (found >= 0)]
    return status, core, estimated


def tolerance_for(problem: Problem, accuracy: float) -> float:
    """The tolerance for stepping: that of the impact, or where there is none, that of a typical one."""
    if not problem.approach > 0.0:
        return TRIAL_TOLERANCE * FINER
    try:
        return finest(problem, accuracy)[0]
    except CoreError:  # the undisturbed impact is not solved, but other inputs may be
        return TRIAL_TOLERANCE * FINER
