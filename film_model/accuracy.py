"""What `accuracy` asks of the mesh: segments are doubled until two meshes agree; their difference is the estimate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from film_model.core import native
from film_model.errors import Outcome, SimulationError
from film_model.scene import Scene, Solver

if TYPE_CHECKING:
    from film_model.curve import Curve
    from film_model.problem import Problem

Linearisation: TypeAlias = Literal["work-preserving", "chord"]

FIRST_SEGMENTS = 6
"""Segments a stage of the first trial; from here on the error falls by 16 when segments are doubled."""

MOST_SEGMENTS = 6 * 2**13

STEEP = 2.0
"""Exponent of unloading above which its first segments leave more error than those of loading."""

ORDER_FACTOR = {
    # bound on error of n segments over |difference to 2n|, and on error of 2n over the same
    "work-preserving": (1.6, 0.5),
    "chord": (2.0, 0.6),
}
"""Asymptotically 16/15 and 1/15 for fourth order, 4/3 and 1/3 for second; with room for what is not asymptotic yet."""

ROUNDING = 2e-14
"""Relative accuracy that rounding leaves, times the square root of the number of lines over a hundred."""

_HALVINGS = 32
"""Of the time that a load is followed, down to the first touch, where motion that creeps in is compared."""

FLOOR = 1e-3
"""Velocities and dents smaller than this part of their scale are judged against it."""


def solver_for(
    given: Solver, accuracy: float | None, segments: int | None, linearisation: Linearisation | None
) -> Solver:
    """The scene's solver with the options of a call in place of its own. Raises SceneError for a bad option."""
    if accuracy is None and segments is None:
        accuracy, segments = (None, given.segments) if given.segments is not None else (given.accuracy, None)
    line = given.linearisation if linearisation is None else linearisation
    return Solver(accuracy=accuracy, segments=segments, linearisation=line)


def mesh_of(solver: Solver, counts: tuple[int, int]) -> native.Mesh:
    """The mesh for loading and unloading segment counts."""
    kind = native.CHORD if solver.linearisation == "chord" else native.WORK_PRESERVING
    return native.mesh(kind, *counts)


def mesh_for(
    scene: Scene,
    problem: Problem,
    accuracy: float | None,
    segments: int | None,
    linearisation: Linearisation | None,
    fallback: tuple[int, int],
) -> tuple[tuple[int, int], native.Mesh]:
    """Segment counts and mesh for a scene whose impact is not simulated in one go.

    fallback: the counts without an impact, and the least for a load that meets no impactor in motion: it may creep in,
    of which a summary tells no more than the end.
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


def _impact(problem: Problem, solver: Solver, counts: tuple[int, int]) -> native.Summary:
    status, summary = native.impact(problem.curve.native, mesh_of(solver, counts), problem.start)
    raise_failure(status, problem)
    return summary


def _apart(
    problem: Problem, solver: Solver, counts: Sequence[tuple[int, int]], a: native.Summary, b: native.Summary
) -> float:
    """Largest relative difference between the summaries of two meshes; of the motion on the way where nothing turns."""
    if a.maximum_indentation > 0.0 or b.maximum_indentation > 0.0 or not math.isfinite(problem.limit):
        return difference(problem, a, b)
    first, second = (_creeping(problem, mesh_of(solver, each)) for each in counts)
    off, largest = abs(first - second).max(axis=0), abs(second).max(axis=0)
    return max(difference(problem, a, b), *(off / np.maximum(largest, 1e-300)).tolist())


def _creeping(problem: Problem, mesh: native.Mesh) -> NDArray[np.float64]:
    """(times, 2) values ξ, ν of an impactor that a load pushes in, at halves of halves of the time it is followed."""
    curve, found = problem.curve.native, list[tuple[float, float]]()
    state = native.initial_state(curve, problem.start)
    for k in range(_HALVINGS, -1, -1):
        until = problem.limit * 2.0**-k
        while native.step(curve, mesh, state, max(until - state.time, 0.0)) == native.EVENT:
            pass
        found.append((state.xi, state.nu))
    return np.array(found)


def refine(problem: Problem, solver: Solver, warnings: list[str]) -> tuple[tuple[int, int], float]:
    """Segment counts that meet the accuracy, doubled until two meshes agree, and the error estimate."""
    assert solver.accuracy is not None
    n, ratio = first_segments(problem.damping), unloading_ratio(problem.curve)
    factor = ORDER_FACTOR[solver.linearisation][1]
    coarse, last = _impact(problem, solver, (n, ratio * n)), math.inf
    while True:
        n *= 2
        fine = _impact(problem, solver, (n, ratio * n))
        apart = _apart(problem, solver, [(k, ratio * k) for k in (n // 2, n)], coarse, fine)
        estimated = factor * apart + ROUNDING * math.sqrt(fine.lines / 100.0)
        if estimated <= solver.accuracy:
            return (n, ratio * n), estimated
        if n >= MOST_SEGMENTS or (estimated > 0.7 * last and estimated < 1e-9):
            warnings.append(
                f"accuracy {solver.accuracy:g} cannot be had: the error is estimated at {estimated:.1e} with {n} "
                "segments a stage"
            )
            return (n, ratio * n), estimated
        coarse, last = fine, estimated


def first_segments(damping: float) -> int:
    """Segments of the first trial: more for a strong damping, which stops the impactor early in the stage."""
    return FIRST_SEGMENTS * min(2 ** int(math.log2(1.0 + damping)), 256)


def estimate(problem: Problem, solver: Solver) -> float:
    """Error estimate for the number of segments that was asked for."""
    n = solver.segments
    assert n is not None
    counts = [(k, k) for k in (n, min(2 * n, native.MAX_SEGMENTS))]
    given, double = (_impact(problem, solver, each) for each in counts)
    return ORDER_FACTOR[solver.linearisation][0] * _apart(problem, solver, counts, given, double) + ROUNDING


def unloading_ratio(curve: Curve) -> int:
    """Unloading segments for one loading segment where contact does not fade out slowly: where it does, the core draws
    two or four times as many (`film_unloading`)."""
    return 2 if curve.steepest > STEEP else 1


def difference(problem: Problem, a: native.Summary, b: native.Summary) -> float:
    """Largest relative difference between two summaries, over the values of `b`; what exists in one only counts as 1.

    Dents and velocities smaller than `FLOOR` of the depth and the approach are held against that, work against the
    impact energy.
    """
    depth, speed = b.maximum_indentation, max(problem.approach, 1e-300)
    share, drift = problem.share, problem.drift / problem.scales.velocity
    pairs = [
        (a.maximum_force, b.maximum_force, b.maximum_force),
        (a.maximum_indentation, depth, depth),
        (a.time_of_maximum_indentation, b.time_of_maximum_indentation, b.time_of_maximum_indentation),
        (a.time_impactor_stops, b.time_impactor_stops, b.time_impactor_stops),
        (a.contact_duration, b.contact_duration, b.contact_duration),
        (a.permanent_indentation, b.permanent_indentation, max(abs(b.permanent_indentation), FLOOR * depth)),
        (a.final_velocity, b.final_velocity, max(abs(b.final_velocity), FLOOR * speed)),
        (a.final_velocity, b.final_velocity, max(abs(drift / share + b.final_velocity), FLOOR * speed)),
        (a.work, b.work, max(0.5 * speed**2, abs(b.work))),
    ]
    if problem.approach == 0.0:
        pairs = pairs[:3]  # a ball laid down comes back with no velocity: whether it separates is rounding
    worst = 0.0
    for first, second, scale in pairs:
        if first != first and second != second:
            continue
        relative = 0.0 if scale == 0.0 else abs(first - second) / scale
        worst = max(worst, relative if relative == relative else 1.0)
    return worst


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
