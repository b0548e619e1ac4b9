"""Meshes for many impacts of one curve: most share one, found from a sample; each is refined if its estimate asks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, Mask, all_of, any_of
from film_model.core import native
from film_model.core.columns import Columns
from film_model.core.solving import MOST_LINES, MOST_SEGMENTS, bound_coarse, bound_fine, first_segments
from film_model.laws.law import Power
from film_model.problem.problem import Problem
from film_model.problem.summary import difference, rounding
from film_model.scene import Solver
from film_model.solve.accuracy import line_kind, mesh_of
from film_model.solve.relaxed import relax_many

FIRST_SEGMENTS = 8
"""Segments per stage of the first trial: few, because every segment costs time in all impacts. Lanes need three on the
mesh of half as many, and meshes of three agree by chance (tests/test_sweep_accuracy.py)."""

SMALL = 1e-9
"""Refinement ends if an estimate below this stalls: the rest is rounding."""


@dataclass(frozen=True)
class Marched:
    """Many impacts, marched. status, core: as `Problem.march` returns them. segments: per loading stage and of
    unloading, (impacts, 2). estimated: bound on the relative error of every value, of each impact; nan if it failed.
    apart: largest relative difference of the last two meshes of each; 0 where there were none."""

    status: NDArray[np.int32]
    core: Columns
    segments: NDArray[np.int32]
    estimated: Array
    apart: Array


def march_many(problem: Problem, solver: Solver) -> Marched:
    """March many impacts on meshes that meet the accuracy, or on the given number of segments; those of viscoelastic
    bodies have no segments.

    Every impact is marched on two meshes, and their difference gives its estimate. The two meshes have n and about n/2
    segments; an impact whose estimate exceeds the accuracy is marched again with 2n, and so on as `accuracy.refine`.
    """
    if problem.relaxation is not None:
        status, core, estimated = relax_many(problem, solver)
        return Marched(status, core, np.zeros((status.size, 2), np.int32), estimated, np.zeros(status.size))
    if solver.segments is not None:
        return _with_segments(problem, solver, solver.segments)
    n = _shared_segments(problem, solver)
    coarse = _march(problem, solver, _half(n, solver))
    status, core = _march(problem, solver, n)
    segments = np.empty((status.size, 2), np.int32)
    segments[:] = problem.curve.segments(n)
    size = status.size
    made, every = Marched(status, core, segments, np.empty(size), np.zeros(size)), np.arange(size)
    left = every[_estimate(problem, solver, made, every, n, coarse, (status, core))]
    left = _doubted(problem, solver, made, left, n)
    while left.size and n < MOST_SEGMENTS:
        n *= 2
        left = _refine(problem if left.size == every.size else problem.part(left), solver, made, left, n)
    return made


def recorded_segments(problem: Problem, solver: Solver, segments: NDArray[np.int32]) -> NDArray[np.int32]:
    """Segments with which the recorded lines of impacts meet the accuracy, at least those of `march_many`: summaries
    need fewer where tables, polynomials or integrals replace the lines."""
    if solver.accuracy is None or solver.linearisation == "chord":
        return segments
    fixed = (problem.gamma == 0.0) & (problem.damping == 0.0)
    # relative error of times on a fixed target, n lines a leg, without damping: < 0.2/n⁴ (docs/method.md, section 4)
    least = min(math.ceil((0.2 / solver.accuracy) ** 0.25), MOST_SEGMENTS)
    found = np.where(fixed[:, None], np.maximum(segments, problem.curve.segments(least)), segments)
    others = np.flatnonzero(~fixed)
    if others.size:
        found[others] = np.maximum(found[others], _segments_of_lines(problem.part(others), solver))
    return found


def _segments_of_lines(problem: Problem, solver: Solver) -> NDArray[np.int32]:
    """Segments, doubled until the lines of two meshes agree."""
    assert solver.accuracy is not None
    n, left = FIRST_SEGMENTS, np.arange(problem.start.size)
    found, before, coarse = np.empty((left.size, 2), np.int32), np.zeros(left.size), _lines(problem, solver, n // 2)[1]
    while left.size:
        part, mesh = problem.part(left), mesh_of(solver, problem.curve.segments(n))
        status, fine = _lines(part, solver, n)
        apart = difference(part, coarse, fine)
        bound = bound_fine(mesh, part.start, coarse.table, fine.table, apart, before)
        found[left] = part.curve.segments(n)
        wrong = (bound > max(solver.accuracy, SMALL)) | (n < first_segments(part.damping, FIRST_SEGMENTS))
        wrong &= (status >= 0) & (fine.lines < MOST_LINES // 2) & (2 * n <= MOST_SEGMENTS)
        left, coarse, before, n = left[wrong], Columns(fine.table[wrong]), apart[wrong], 2 * n
    return found


def _doubted(problem: Problem, solver: Solver, made: Marched, left: Index, n: int) -> Index:
    """The places to refine, with those where the meshes of n and n/2 segments agreed by chance: a third mesh of 3n/4
    judges lines on moving targets and under a load, which no table or polynomial replaces; the larger estimate
    counts."""
    assert solver.accuracy is not None
    # Near the accuracy estimates are from three meshes where lines decide: two agree by chance in about one of 50,000
    # impacts, and in few of these to a small fraction of the error (tests/hostile/scenes/chance_6961.toml).
    doubtful = ((problem.gamma > 0.0) | (problem.load > 0.0)) & (made.estimated > 0.05 * solver.accuracy)
    doubtful[left] = False
    if _by_powers(problem) or not any_of(doubtful):
        return left
    places = doubtful.nonzero()[0]
    part, fine = problem.part(places), (made.status[places], Columns(made.core.table[places]))
    before, apart = made.estimated[places], made.apart[places]
    third = _march(part, solver, (3 * n + 3) // 4)
    wrong = _estimate(part, solver, made, places, n, third, fine)
    made.estimated[places] = np.fmax(made.estimated[places], before)
    made.apart[places] = np.maximum(made.apart[places], apart)
    return np.union1d(left, places[wrong])


def _by_powers(problem: Problem) -> bool:
    """Whether tables or Taylor polynomials replace the lines of all stages and branches on moving targets."""
    tabled = 1.5  # of forces and branches that the core has tables and polynomials for (docs/method.md, section 10)
    forces = [stage.force for stage in problem.curve.stages]
    powers = all(isinstance(f, Power) and not f.square and (f.exponent == tabled or not f.coefficient) for f in forces)
    return powers and problem.curve.steepest in (0.0, 1.0, tabled)  # lines of straight branches are exact


def _refine(part: Problem, solver: Solver, made: Marched, places: Index, n: int) -> Index:
    """March the impacts at `places` with n segments; the places whose estimates still exceed the accuracy."""
    status, core = _march(part, solver, n)
    known = status >= 0  # an impact that fails on a finer mesh only keeps its result
    if not all_of(known):
        part, places, status, core = part.part(known), places[known], status[known], Columns(core.table[known])
    before, last = (made.status[places], Columns(made.core.table[places])), made.estimated[places]
    made.status[places], made.core.table[places] = status, core.table
    made.segments[places] = part.curve.segments(n)
    wrong = _estimate(part, solver, made, places, n, before, (status, core))
    if any_of(wrong):
        now = made.estimated[places]
        wrong &= ~((now > 0.7 * last) & (now < SMALL))
    return places[wrong]


def _estimate(
    problem: Problem,
    solver: Solver,
    made: Marched,
    places: Index,
    n: int,
    coarser: tuple[NDArray[np.int32], Columns],
    finer: tuple[NDArray[np.int32], Columns],
) -> Mask:
    """Set the estimates at `places` from two meshes; whether each is to be refined: more segments would lower it."""
    assert solver.accuracy is not None
    (coarse_status, coarse), (status, core) = coarser, finer
    apart, rounds, failed = difference(problem, coarse, core), _floor(problem, core), status < 0
    mesh = mesh_of(solver, problem.curve.segments(n))
    found = bound_fine(mesh, problem.start, coarse.table, core.table, apart, made.apart[places])
    found[coarse_status < 0] = 1.0
    made.apart[places] = apart
    loaded = problem.load > 0.0
    if n <= FIRST_SEGMENTS and (problem.curve.pulls or problem.loaded):
        # Meshes that agree to 1e-6 under a load or of a law that pulls are no evidence: they agree by chance, or an
        # impactor that turns back within the first lines of both has the same lines on both
        # (tests/test_one_and_many.py).
        found[(apart <= 1e-6) & (loaded | problem.curve.pulls)] = 1.0
    if problem.loaded and problem.damps:  # by lines, of which the first ones stop the impactor
        found[loaded & (n < first_segments(problem.damping, FIRST_SEGMENTS))] = 1.0
    if problem.loaded:
        # Under a load two meshes may agree by chance, where their difference changes sign
        # (tests/test_sweep_accuracy.py).
        found = np.where(loaded, np.maximum(found, 0.05 * solver.accuracy), found)
    estimated = np.minimum(found + rounds, 1.0)
    estimated[failed] = math.nan
    made.estimated[places] = estimated
    costly = core.lines > MOST_LINES // 2
    return (found > np.maximum(solver.accuracy - rounds, rounds)) & ~failed & ~costly


def _floor(problem: Problem, core: Columns) -> Array:
    """Error that remains on any mesh: rounding, and on targets that move the tables of whole ways."""
    # error of the core's tables of whole ways (tests/test_batch.py), which no mesh changes
    return rounding(problem, core) + 2e-14 * (problem.gamma > 0.0)


def _with_segments(problem: Problem, solver: Solver, n: int) -> Marched:
    """March with the given number of segments; the estimates are from twice as many."""
    (status, core), (other, fine) = (problem.march(mesh_of(solver, (k, k))) for k in (n, 2 * n))
    apart = np.where(other >= 0, difference(problem, core, fine), 1.0)
    found = bound_coarse(mesh_of(solver, (n, n)), problem.start, core.table, apart)
    estimated = np.where(status < 0, math.nan, np.minimum(found + _floor(problem, core), 1.0))
    return Marched(status, core, np.full((status.size, 2), n, np.int32), estimated, apart)


def _shared_segments(problem: Problem, solver: Solver) -> int:
    """Segments per stage with which `EASY` of a sample meet the accuracy."""
    sample_least = 64  # and 1/256 of the impacts
    assert solver.accuracy is not None
    count = problem.approach.size
    n = FIRST_SEGMENTS
    if count <= sample_least:
        return n
    spread = np.linspace(0, count - 1, max(sample_least, count // 256)).astype(np.intp)
    sample = problem.part(spread)
    while n < MOST_SEGMENTS:
        (status, coarse), (other, fine) = (_march(sample, solver, k) for k in (_half(n, solver), n))
        off = difference(sample, coarse, fine)
        mesh = mesh_of(solver, sample.curve.segments(n))
        bound = bound_fine(mesh, sample.start, coarse.table, fine.table, off, np.zeros_like(off))
        rounds = _floor(sample, fine)
        over = bound / np.maximum(solver.accuracy - rounds, rounds)
        refined = (status >= 0) & (other >= 0) & (fine.lines <= MOST_LINES // 2)
        # refining the others costs less than finer lines for all
        typical = float(np.quantile(np.where(refined, over, 0.0), 0.9))
        if typical <= 1.0:
            break
        # the difference decreases with about the fourth power of the segments
        wanted = math.ceil(n * typical**0.25)
        n = min(2 * n, max(wanted, n + (2 if solver.linearisation == "chord" else 1)))
    return n


def _half(n: int, solver: Solver) -> int:
    """Segments of the coarser mesh: half, rounded up; chords, of second order, need a complete halving."""
    return n // 2 if solver.linearisation == "chord" else (n + 1) // 2


def _march(problem: Problem, solver: Solver, n: int) -> tuple[NDArray[np.int32], Columns]:
    # Contacts that creep take lanes up to 80 times as long on each line, for all impacts of a block; so few need as
    # many segments that lanes bring nothing (tests/hostile/scenes/creeping_500131.toml).
    if problem.law.damped and n > 512:
        return _lines(problem, solver, n)
    return problem.march(mesh_of(solver, problem.curve.segments(n)))


def _lines(problem: Problem, solver: Solver, n: int) -> tuple[NDArray[np.int32], Columns]:
    """By the lines of the mesh, and no shorter way."""
    return problem.march(native.mesh(line_kind(solver), *problem.curve.segments(n), native.LINES))
