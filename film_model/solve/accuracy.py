"""The mesh for a requested accuracy of one impact: the core doubles the segments until meshes agree (film_solve.c)."""

from __future__ import annotations

from typing import Literal, TypeAlias

from film_model.base.errors import STATUSES, CoreError
from film_model.core import native, solving
from film_model.problem.problem import Problem, refuse_relaxation
from film_model.scene import Solver

Linearisation: TypeAlias = Literal["work-preserving", "chord"]

FIRST_SEGMENTS = 6
"""Segments per stage of the first trial of one impact; from here on, doubling divides the error by about 16."""


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
    return native.mesh(line_kind(solver), *counts, native.ANY_WAY if solver.segments is None else native.LINES)


DEFAULT_SEGMENTS = (24, 48)
"""Of steps without an impact on which to try meshes, and the least where a load presses an impactor at rest: the
summary, from which the error is estimated, has only the end of such slow motion."""


def line_kind(solver: Solver) -> int:
    """The core's number of the linearisation."""
    return native.CHORD if solver.linearisation == "chord" else native.WORK_PRESERVING


def mesh_for(problem: Problem, solver: Solver) -> tuple[tuple[int, int], native.Mesh]:
    """Segment counts and mesh of an impact that is simulated in steps."""
    if solver.segments is not None:
        counts = (solver.segments, solver.segments)
    elif problem.approach > 0.0:
        counts = refine(problem, solver, [])[0]
    elif problem.load > 0.0:
        found = refine(problem, solver, [])[0]
        counts = (max(found[0], DEFAULT_SEGMENTS[0]), max(found[1], DEFAULT_SEGMENTS[1]))
    else:
        counts = DEFAULT_SEGMENTS
    return counts, mesh_of(solver, counts)


def refine(problem: Problem, solver: Solver, warnings: list[str]) -> tuple[tuple[int, int], float]:
    """Segment counts of one impact that meet the accuracy, doubled until meshes agree, and the error estimate."""
    assert solver.accuracy is not None
    refuse_relaxation(problem, "a march on lines")
    curve, first = problem.curve, problem.curve.segments(solving.first_segments(problem.damping, FIRST_SEGMENTS // 2))
    given = curve.native, problem.start, line_kind(solver), first, solver.accuracy, curve.clearance
    status, found = solving.solve(*given)
    raise_failure(status, problem)
    n = first[0] << found.level
    if not found.reached:
        warnings.append(
            f"accuracy {solver.accuracy:g} is not reached: the estimated relative error is {found.estimated:.1e} "
            f"with {n} segments per stage; ask for a looser accuracy"
        )
    return curve.segments(n), found.estimated


def estimate(problem: Problem, solver: Solver) -> float:
    """Error estimate for the requested number of segments."""
    n, curve = solver.segments, problem.curve
    assert n is not None
    refuse_relaxation(problem, "a march on lines")
    status, found = solving.estimate(curve.native, problem.start, line_kind(solver), (n, n), curve.clearance)
    raise_failure(status, problem)
    return found.estimated


def raise_failure(status: int, problem: Problem, where: str = "") -> None:
    """SimulationError if the core failed. where: added to the message."""
    if status < 0:
        law = problem.law
        valid = f" ({law.validity})" if law.validity and status == native.BEYOND_LAW else ""
        raise CoreError(f"law {law.name}: {STATUSES[status].sentence}{valid}{where}", status)
