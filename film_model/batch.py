"""Many impacts of one scene: simulate_batch(scene, velocity=…) → BatchResult."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model import units
from film_model.accuracy import (
    FIRST_SEGMENTS,
    MOST_SEGMENTS,
    ORDER_FACTOR,
    ROUNDING,
    difference,
    mesh_of,
    solver_for,
    unloading_ratio,
)
from film_model.bodies import STANDARD_GRAVITY, Body, Sphere
from film_model.core import native
from film_model.effects import GRAVITY_THRESHOLD
from film_model.errors import SimulationError
from film_model.problem import Problem, contact_limit, problem_of, refuse_vibrations
from film_model.scene import Scene, Solver


@dataclass(frozen=True)
class BatchResult:
    """Summaries of many impacts: arrays of one shape, SI, by the names of `history.SUMMARY` (nan: did not happen).

    estimated: bound on the relative error of every value, from the impacts that were tried on two meshes. segments:
    loading and unloading lines. failed: True where the core could not follow the impact (its values are nan).
    """

    summary: dict[str, NDArray[np.float64]]
    estimated: float
    segments: tuple[int, int]
    failed: NDArray[np.bool_]


def simulate_batch(
    scene: Scene, *, velocity: Any, mass: Any = None, accuracy: float | None = None, segments: int | None = None
) -> BatchResult:
    """Impacts of one scene at many velocities, and masses if given; arrays with units that broadcast together.

    Law "auto" is decided at the largest velocity, gravity "auto" for every impact. With an accuracy, up to 64 of the
    impacts, the extremes among them, are tried to find the mesh. A free body as target, and one that vibrates, are
    refused with SimulationError.
    """
    speeds = units.array_to_si(velocity, "velocity")
    masses = np.asarray(scene.effective_mass) if mass is None else units.array_to_si(mass, "mass")
    speeds, masses = np.broadcast_arrays(speeds, masses)
    if isinstance(scene.target, Body):
        raise SimulationError("a free body as target cannot be run as a batch: its reduced mass depends on both")
    if speeds.size == 0 or not ((speeds > 0.0).all() and (masses > 0.0).all()):
        raise ValueError("velocity and mass must be > 0, and there must be at least one impact")
    problem = problem_of(_at_velocity(scene, float(speeds.max())))
    refuse_vibrations(problem, "a batch")
    scales = problem.scales
    start: Any = np.zeros(speeds.size, native.START_DTYPE)
    clock = np.sqrt(masses.ravel() / problem.mass)  # t_s and 1/v_s grow with √m
    start["nu"] = speeds.ravel() * clock / scales.velocity
    start["gamma"] = problem.gamma * clock
    start["time_limit"] = math.inf
    heavy = _heavy(scene, problem, start, masses.ravel())
    start["load"][heavy] = masses.ravel()[heavy] * STANDARD_GRAVITY / scales.force
    start["time_limit"][heavy] = contact_limit(start["nu"][heavy], start["gamma"][heavy])
    solver = solver_for(scene.solver, accuracy, segments, None)
    trial = start[np.unique(np.linspace(0, start.size - 1, 64).astype(int))]
    order = np.argsort(start["gamma"] * start["nu"] ** 0.2 + 1e-9 * start["nu"])
    trial = np.concatenate([trial, start[order[[0, -1]]], start[[start["nu"].argmin(), start["nu"].argmax()]]])
    counts, estimated = _batch_mesh(problem, solver, trial)
    status, core = native.batch(problem.curve.native, mesh_of(solver, counts), start)
    values = _batch_summary(problem, core, start, clock)
    failed = status < 0
    for column in values.values():
        column[failed] = np.nan
    shaped = {name: column.reshape(speeds.shape) for name, column in values.items()}
    return BatchResult(shaped, estimated, counts, failed.reshape(speeds.shape))


def _at_velocity(scene: Scene, velocity: float) -> Scene:
    ball = scene.impactor
    mass = None if ball.mass is None else f"{ball.mass!r} kg"
    impactor = Sphere(f"{ball.radius!r} m", velocity=f"{velocity!r} m/s", mass=mass, material=ball.material)
    return replace(scene, impactor=impactor)


def _heavy(scene: Scene, problem: Problem, start: Any, mass: Any) -> NDArray[np.bool_]:
    """Which impacts are simulated with their weight: the rule of `effects`, for each."""
    wanted = scene.effects.gravity
    if wanted != "auto":
        return np.full(mass.shape, wanted)
    still = start.copy()
    still["gamma"] = 0.0
    status, summary = native.batch(problem.curve.native, native.mesh(native.WORK_PRESERVING, 1, 1), still)
    force = np.where(status == native.EVENT, summary["maximum_force"] * problem.scales.force, np.nan)
    return ~(mass * STANDARD_GRAVITY <= GRAVITY_THRESHOLD * force)


def _batch_mesh(problem: Problem, solver: Solver, trial: Any) -> tuple[tuple[int, int], float]:
    """Smallest mesh on which every trial impact meets the accuracy, seen from twice as many segments."""
    ratio = unloading_ratio(problem)
    n = solver.segments or 4
    before, after = ORDER_FACTOR[solver.linearisation]
    while True:
        counts = (n, n) if solver.segments else (n, ratio * n)
        coarse, fine = (
            native.batch(problem.curve.native, mesh_of(solver, (k * counts[0], k * counts[1])), trial) for k in (1, 2)
        )
        ended = (coarse[0] >= 0) & (fine[0] >= 0)
        pairs = zip(coarse[1][ended], fine[1][ended], trial[ended], strict=True)
        worst = max((difference(problem, _summary(a), _summary(b), start["nu"]) for a, b, start in pairs), default=0.0)
        estimated = before * worst + ROUNDING
        if solver.segments is not None:
            return counts, estimated
        assert solver.accuracy is not None
        if estimated <= solver.accuracy or n >= MOST_SEGMENTS:
            return counts, estimated
        if after * worst <= solver.accuracy and n >= FIRST_SEGMENTS:
            # between n and 2n the error falls with the fourth power
            n = min(2 * n, max(n + 1, math.ceil(n * (1.1 * before * worst / solver.accuracy) ** 0.25)))
        else:
            n *= 2


def _summary(row: Any) -> native.Summary:
    return native.Summary.from_buffer_copy(row)


def _batch_summary(problem: Problem, core: Any, start: Any, clock: Any) -> dict[str, NDArray[np.float64]]:
    """Summary columns in SI from the core's."""
    s = problem.scales
    speed, energy = s.velocity / clock, s.energy
    radiated = 0.5 * (start["nu"] ** 2 - core["final_velocity"] ** 2) - core["work"]
    radiated += start["load"] * (core["permanent_indentation"] + core["shift"])
    return {
        "maximum_force": core["maximum_force"] * s.force,
        "maximum_indentation": core["maximum_indentation"] * s.length,
        "time_of_maximum_indentation": core["time_of_maximum_indentation"] * s.time * clock,
        "time_impactor_stops": core["time_impactor_stops"] * s.time * clock,
        "contact_duration": core["contact_duration"] * s.time * clock,
        "permanent_indentation": core["permanent_indentation"] * s.length,
        "rebound_velocity": core["final_velocity"] * speed,
        "coefficient_of_restitution": -core["final_velocity"] / start["nu"],
        "energy_absorbed": core["work"] * energy,
        "energy_radiated": np.where(start["gamma"] > 0.0, radiated * energy, 0.0),
    }
