"""The mesh for a requested accuracy: segments are doubled until two meshes agree; the difference gives the estimate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import any_of, either
from film_model.base.errors import STATUSES, CoreError
from film_model.core import native
from film_model.problem.problem import Problem
from film_model.problem.summary import difference, rounding
from film_model.scene import Scene, Solver

Linearisation: TypeAlias = Literal["work-preserving", "chord"]

REGULAR_FALL = {"work-preserving": 16.0, "chord": 4.0}
"""By how much doubling the segments divides the error. If the difference of two meshes falls by more, they may agree by
chance: the estimate is then from the meshes before. Needed by tests/test_one_and_many.py."""

FIRST_SEGMENTS = 6
"""Segments per stage of the first trial of one impact; from here on, doubling divides the error by about 16."""

MOST_SEGMENTS = 6 * 2**13

ORDER_FACTOR = {
    # bound on error of n segments over |difference to 2n|, and on error of 2n over the same
    "work-preserving": (1.6, 0.5),
    "chord": (2.4, 0.6),
}
"""Asymptotically 16/15 and 1/15 for fourth order, 4/3 and 1/3 for second; larger, for meshes that are still coarse."""

COARSE_FACTOR, COARSE = 2.0, 24
"""Bound on the error over the difference to half as many segments, up to so many segments; it falls as 1/n to that of
`ORDER_FACTOR`. Where errors do not yet fall with the fourth power, at kinks of the law and in slow contacts under a
load, the two meshes may agree by chance. Of one impact only under a load, because three meshes judge it. Needed by
tests/test_sweep_accuracy.py and tests/test_estimates.py."""

STOP_IN_A_LINE = 0.25
"""Bound on the relative error of the time at which the impactor stops within the first line from first touch, over the
fraction of the approach velocity that it loses until then; of chords over 1. 0.006 under Hertz's law, 0.09 under
`tsuji`, 0.2 under `hunt-crossley`. Needed by tests/test_estimates.py."""

_HALVINGS = 32
"""Times at which slow motion under a load is compared: the time limit, halved up to this often."""


def solver_for(
    given: Solver, accuracy: float | None, segments: int | None, linearisation: Linearisation | None
) -> Solver:
    """The scene's solver, with the options of a call replacing its own. Raises SceneError for a bad option."""
    if accuracy is None and segments is None:
        if linearisation is None:
            return given
        accuracy, segments = (None, given.segments) if given.segments is not None else (given.accuracy, None)
    line = given.linearisation if linearisation is None else linearisation
    return Solver(accuracy=accuracy, segments=segments, linearisation=line)


def mesh_of(solver: Solver, counts: tuple[int, int]) -> native.Mesh:
    """The mesh for loading and unloading segment counts. Those that the solver gives are lines, by no shorter way."""
    kind = native.CHORD if solver.linearisation == "chord" else native.WORK_PRESERVING
    return native.mesh(kind, *counts, native.ANY_WAY if solver.segments is None else native.LINES)


def mesh_for(
    scene: Scene,
    problem: Problem,
    accuracy: float | None,
    segments: int | None,
    linearisation: Linearisation | None,
    fallback: tuple[int, int],
) -> tuple[tuple[int, int], native.Mesh]:
    """Segment counts and mesh for a scene that is simulated in steps.

    fallback: the counts if there is no impact, and the least counts if a load presses an impactor at rest: the summary,
    from which the error is estimated, contains only the end of such slow motion.
    """
    solver = solver_for(scene.solver, accuracy, segments, linearisation)
    if solver.segments is not None:
        counts = (solver.segments, solver.segments)
    elif problem.approach > 0.0:
        counts = refine(problem, solver, [])[0]
    elif problem.load > 0.0:
        found = refine(problem, solver, [])[0]
        counts = (max(found[0], fallback[0]), max(found[1], fallback[1]))
    else:
        counts = fallback
    return counts, mesh_of(solver, counts)


def first_segments(damping: float, least: int = FIRST_SEGMENTS) -> int:
    """Segments of the first trial: more for strong damping, which stops the impactor early in the stage."""
    return least * min(2 ** int(math.log2(1.0 + damping)), 256)


def refine(problem: Problem, solver: Solver, warnings: list[str]) -> tuple[tuple[int, int], float]:
    """Segment counts of one impact that meet the accuracy, doubled until two meshes agree, and the error estimate."""
    assert solver.accuracy is not None
    n, counts_for = first_segments(problem.damping), problem.curve.segments
    factor, regular = ORDER_FACTOR[solver.linearisation][1], REGULAR_FALL[solver.linearisation]
    counts = [counts_for(n // 2), counts_for(n)]
    coarsest, coarse = (_impact(problem, solver, each) for each in counts)
    before, last = _apart(problem, solver, counts, coarsest, coarse), math.inf
    while True:
        n *= 2
        counts = [counts[1], counts_for(n)]
        fine = _impact(problem, solver, counts[1])
        here = _apart(problem, solver, counts, coarse, fine)
        apart, falls, before = max(here, before / regular), here < 0.5 * before, here
        bound = coarse_factor(n, solver) if problem.load > 0.0 else factor
        found, rounds = max(bound * apart, unseen(problem, solver, n, fine)), rounding(problem, fine)
        estimated = found + rounds
        if estimated <= solver.accuracy:
            return counts[1], estimated
        settled = (found < rounds and not falls) or (estimated > 0.7 * last and estimated < 1e-9)
        if n >= MOST_SEGMENTS or settled:
            warnings.append(
                f"accuracy {solver.accuracy:g} is not reached: the estimated relative error is {estimated:.1e} "
                f"with {n} segments per stage"
            )
            return counts[1], estimated
        coarse, last = fine, estimated


def coarse_factor(n: int, solver: Solver) -> float:
    """Bound on the error of n segments over the difference to n/2, where the order has not set in."""
    return max(ORDER_FACTOR[solver.linearisation][1], COARSE_FACTOR * min(1.0, COARSE / n))


def estimate(problem: Problem, solver: Solver) -> float:
    """Error estimate for the requested number of segments."""
    n = solver.segments
    assert n is not None
    counts = [(k, k) for k in (n, min(2 * n, native.MAX_SEGMENTS))]
    given, double = (_impact(problem, solver, each) for each in counts)
    apart = _apart(problem, solver, counts, given, double)
    found = max(ORDER_FACTOR[solver.linearisation][0] * apart, unseen(problem, solver, n, given))
    return found + rounding(problem, given)


def unseen(problem: Problem, solver: Solver, n: int, core: Any) -> Any:
    """Bound on the relative error of the time at which the impactor stops where two meshes do not show it; 0 elsewhere.

    A line that reaches the impactor's stop is made again to end there. If that is the first of n lines, meshes of fewer
    segments have the same line up to the stop; nor do they show much if the first line takes half of that way. It
    happens only where a free target moves towards a slower impactor.
    """
    if not any_of(problem.stop_velocity > 0.0):
        return 0.0
    chords = solver.linearisation == "chord"
    # The first node over the depth, if that is in the first stage.
    first = 1.0 / n if chords else math.sin(0.5 * math.pi / n) ** 2
    within = core.time_impactor_stops * problem.approach < 2.0 * first * core.maximum_indentation
    lost = 1.0 if chords else 1.0 - problem.stop_velocity / problem.approach
    return either(within, STOP_IN_A_LINE * lost, 0.0)


def _impact(problem: Problem, solver: Solver, counts: tuple[int, int]) -> native.Summary:
    status, summary = problem.march(mesh_of(solver, counts))
    raise_failure(status, problem)
    return summary


def _apart(
    problem: Problem, solver: Solver, counts: Sequence[tuple[int, int]], a: native.Summary, b: native.Summary
) -> float:
    """Largest relative difference of the summaries on two meshes; of the motion itself if there is no maximum."""
    if a.maximum_indentation > 0.0 or b.maximum_indentation > 0.0 or not math.isfinite(problem.limit):
        return difference(problem, a, b)
    first, second = (_creeping(problem, mesh_of(solver, each)) for each in counts)
    off, largest = abs(first - second).max(axis=0), abs(second).max(axis=0)
    return max(difference(problem, a, b), *(off / np.maximum(largest, 1e-300)).tolist())


def _creeping(problem: Problem, mesh: native.Mesh) -> NDArray[np.float64]:
    """(times, 2) values ξ, ν of an impactor pressed in by a load, at the time limit divided by powers of 2."""
    curve, found = problem.curve.native, list[tuple[float, float]]()
    state = native.initial_state(curve, problem.start)
    for k in range(_HALVINGS, -1, -1):
        until = problem.limit * 2.0**-k
        while native.step(curve, mesh, state, max(until - state.time, 0.0)) == native.EVENT:
            pass
        found.append((state.xi, state.nu))
    return np.array(found)


def raise_failure(status: int, problem: Problem, where: str = "") -> None:
    """SimulationError if the core failed. where: added to the message."""
    if status < 0:
        law = problem.law
        valid = f" ({law.validity})" if law.validity and status == native.BEYOND_LAW else ""
        raise CoreError(f"law {law.name}: {STATUSES[status].sentence}{valid}{where}", status)
