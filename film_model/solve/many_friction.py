"""Friction in many impacts beside their normal motions: exact in one call of the core, others by springs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, column, either, index_or_all, index_or_span
from film_model.core import friction as core
from film_model.core import native
from film_model.effects.many import rows_of
from film_model.laws.law import Power
from film_model.oblique.friction import CLOSED, THROUGHOUT, exact_error, exact_force, numbers_of, refuse, results
from film_model.oblique.result import REGIMES, RESULTS
from film_model.problem.problem import Problem
from film_model.scene import Solver
from film_model.scene.rolling import sliding_of
from film_model.solve.many_springs import Normal, by_springs, coarseness


@dataclass(frozen=True)
class ManyOblique:
    """The tangential parts of many impacts; nan where nothing slides and of impacts that failed or whose contact does
    not end. summary: arrays, SI, by the names of `RESULTS`. regime: numbers in `REGIMES`, −1 for none. estimated: error
    of the sliding velocity after the impact over that before."""

    summary: dict[str, Array]
    regime: NDArray[np.int8]
    estimated: Array

    @classmethod
    def none_of(cls, count: int) -> ManyOblique:
        """Of impacts that are not known yet."""
        values = {name: np.full(count, np.nan) for name in RESULTS}
        return cls(values, np.full(count, -1, np.int8), np.full(count, np.nan))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The results, the words for the regimes ("" for none) as `sliding_regime`, and `estimated_error`."""
        words = np.array([*REGIMES, ""])[self.regime]
        return {**self.summary, "sliding_regime": words, "estimated_error": self.estimated}

    def known(self, rows: Any, summary: Mapping[str, Any], regime: Any, estimated: Any) -> None:
        """Put in the values of some rows."""
        for name, values in summary.items():
            self.summary[name][rows] = values
        self.regime[rows], self.estimated[rows] = regime, estimated


def oblique_of_many(
    problems: Iterable[Problem], normal: Normal, solver: Solver, bounded: bool = True
) -> tuple[ManyOblique, Index]:
    """The tangential parts of impacts whose normal motions are known; the rows of those that are left, such as on
    targets that vibrate.

    Impacts of laws whose friction is exact take one call of the core, which looks up those under Hertz's law on
    immovable targets if the accuracy allows it; springs follow others, as many as the accuracy needs. bounded: with
    `BOUNDS` of laws that yield. Raises SimulationError as :func:`oblique_of`.
    """
    found, ended = ManyOblique.none_of(normal.status.size), normal.status == native.EVENT
    left, coarse = ended.copy(), coarseness(solver)
    for problem in problems:
        refuse(problem)
        rows = rows_of(problem)
        if exact_force(problem) is not None:
            for part in problem.by_curve():
                own = rows_of(part)
                left[own] &= ~_exactly(found, part, normal.rebound[own], ended[own], coarse)
        others = np.flatnonzero(left[rows])
        if others.size:
            left[_by_springs(found, problem.part(others), normal.of(rows[others]), solver, bounded)] = False
    return found, left.nonzero()[0]


def _by_springs(found: ManyOblique, problem: Problem, normal: Normal, solver: Solver, bounded: bool) -> Index:
    """Put in the results by springs; the rows of impacts that are done with."""
    rows = rows_of(problem)
    known, summary, regime, estimated = by_springs(problem, normal, solver, bounded)
    slides = known & (estimated == estimated)
    found.known(
        rows[slides], {name: value[slides] for name, value in summary.items()}, regime[slides], estimated[slides]
    )
    return rows[known]


def _exactly(
    found: ManyOblique, problem: Problem, rebound: Array, ended: NDArray[np.bool_], coarse: int
) -> NDArray[np.bool_]:
    """The exact results of a problem, or coarse ones; which of its impacts are done with."""
    scene, count, force = problem.impacts.scene, rebound.size, exact_force(problem)
    given = sliding_of(scene)
    if given is None or force is None:
        return np.full(count, given is None)
    bodies = ("impactor", "target")
    given = given._replace(**{k: column(v, count) for k, v in given._asdict().items() if k not in bodies})
    with np.errstate(divide="ignore", invalid="ignore"):
        rate, before = numbers_of(given, problem, scene)
    slides = ended & (given.velocity != 0.0)
    solved = slides & (given.friction != 0.0)
    result: NDArray[Any] = np.zeros(count, core.MANY_DTYPE)
    rows = index_or_all(solved.nonzero()[0], count)
    normals = _normals(problem, force, count)[rows]
    result[rows] = core.many(normals, column(rate, count)[rows], before[rows], coarse)
    missed = solved & ((result["status"] != native.OK) | (result["closure"] > max(CLOSED, 10.0 * core.ERRORS[coarse])))
    unit, scales = given.friction * given.ratio, problem.scales
    after = either(solved, result["velocity"] * unit * scales.velocity, given.velocity)
    peak = result["force"] * given.friction * scales.force, result["time_of_force"] * scales.time
    values = results(scene, given, rebound, after, peak)
    regime = np.where(solved, result["regime"], REGIMES.index(THROUGHOUT))
    error = np.where(solved, exact_error(problem, np.where(solved, before, 1.0)), 0.0)
    if coarse:
        closed = (result["steps"] == 0) & (regime == REGIMES.index(THROUGHOUT))
        tabled = (result["steps"] == 0) | (coarse == core.COARSE)
        least = np.where(tabled, core.ERRORS[core.COARSE], core.ERRORS[core.QUICK])
        error = np.where(solved & ~closed, np.maximum(error, least), error)
    known = index_or_all((slides & ~missed).nonzero()[0], count)
    summary = {name: column(value, count)[known] for name, value in values.items()}
    found.known(index_or_span(rows_of(problem)[known]), summary, regime[known], error[known])
    return ~missed


def _normals(problem: Problem, force: Power, count: int) -> NDArray[Any]:
    """The normal motions for the core."""
    normal: NDArray[Any] = np.empty(count, core.NORMAL_DTYPE)
    normal["slope"], normal["coefficient"], normal["exponent"] = force.slope, force.coefficient, force.exponent
    normal["approach"], normal["gamma"], normal["load"] = problem.approach, problem.gamma, problem.load
    return normal
