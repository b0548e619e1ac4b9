"""Many impacts of one scene: simulate_rows(scene, columns) → RowResult, and simulate_batch(scene, velocity=…)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model import units
from film_model.accuracy import (
    FLOOR,
    MOST_SEGMENTS,
    ORDER_FACTOR,
    ROUNDING,
    first_segments,
    mesh_of,
    solver_for,
    unloading_ratio,
)
from film_model.bodies import SLOWEST, Body, Sphere
from film_model.core import native
from film_model.errors import Outcome, SimulationError
from film_model.history import SUMMARY
from film_model.problem import Array, vibrations_refused
from film_model.row_problems import Rows
from film_model.rows import VIBRATES, rows_of, scene_of_columns
from film_model.scene import Scene, Solver

TRIED_LEAST, TRIED_SHARE = 64, 256
"""So many rows at least, and one in so many, are tried on two meshes."""

NO_VELOCITY = -100
"""Status of a row whose impactor does not approach; the others are the core's."""

STATUSES: dict[int, tuple[str, str]] = {
    native.EVENT: ("separated", Outcome.SEPARATED.value),
    native.ENDLESS: ("resting", Outcome.RESTING.value),
    native.OK: ("time_limit", Outcome.TIME_LIMIT.value),
    native.BEYOND_LAW: ("beyond_law", Outcome.BEYOND_LAW.value),
    native.TOO_MANY: ("too_many_segments", Outcome.TOO_MANY_SEGMENTS.value),
    native.BAD_UNLOADING: ("bad_unloading", "the law's unloading from the deepest point reached has no length"),
    native.TOO_STIFF: ("too_stiff", "the law's force at first touch is more than the target's impedance can resist"),
    native.BAD_NUMBER: ("bad_number", "the values of this row make no impact"),
    VIBRATES: (
        "vibrates",
        "the target vibrates between its edges: simulate() gives its motion; boundary_reflections = false in [effects] "
        "makes a plate infinite",
    ),
    NO_VELOCITY: ("no_velocity", "the impactor does not approach the target"),
}
"""How a row can end: a word, and a sentence. Negative: it failed, and its values are nan."""


@dataclass(frozen=True)
class RowResult:
    """Many impacts, one a row. summary: arrays, SI, by the names of `history.SUMMARY` (nan: did not happen).

    status: keys of `STATUSES`. laws: names, and law: the number of each row's among them. segments: loading and
    unloading lines of each row, as `Accuracy` has them. estimated: bound on the relative error of every value, from
    the rows that were tried on two meshes. parts: the problems behind the rows.
    """

    summary: dict[str, Array]
    status: NDArray[np.int32]
    laws: tuple[str, ...]
    law: NDArray[np.int8]
    segments: NDArray[np.int32]
    estimated: float
    parts: tuple[Rows, ...]


@dataclass(frozen=True)
class BatchResult:
    """Summaries of many impacts: arrays of one shape, SI, by the names of `history.SUMMARY` (nan: did not happen).

    estimated: bound on the relative error of every value, from the impacts that were tried on two meshes. segments:
    most loading and unloading lines. failed: True where the core could not follow the impact (its values are nan).
    """

    summary: dict[str, Array]
    estimated: float
    segments: tuple[int, int]
    failed: NDArray[np.bool_]


def simulate_batch(
    scene: Scene, *, velocity: Any, mass: Any = None, accuracy: float | None = None, segments: int | None = None
) -> BatchResult:
    """Impacts of one scene at many velocities, and masses if given; arrays with units that broadcast together.

    Law "auto" and gravity "auto" are decided for every impact. With an accuracy, 64 of the impacts or more, the
    extremes among them, are tried to find the mesh.

    Raises ValueError for a velocity or mass that is not > 0 or out of the range of scenes, a velocity that is not above
    a free target's, or none at all; SceneError for a bad option; SimulationError if the target vibrates in all impacts
    (if only in some, those have failed).
    """
    speeds = units.array_to_si(velocity, "velocity")
    masses = None if mass is None else units.array_to_si(mass, "mass")
    shape = np.broadcast_shapes(speeds.shape, () if masses is None else masses.shape)
    given = {"impactor.velocity": speeds, "impactor.mass": masses}
    columns = {path: np.broadcast_to(values, shape).ravel() for path, values in given.items() if values is not None}
    least = max(scene.target.velocity, 0.0) if isinstance(scene.target, Body) else 0.0
    for name, values, unit, floor in (("velocity", speeds, "m/s", least), ("mass", masses, "kg", 0.0)):
        if values is None:
            continue
        if values.size == 0:
            raise ValueError(f"{name}: no values, at least one is needed")
        if not values.min() > floor:
            whose = ", the target's" if floor > 0.0 else ""
            raise ValueError(f"{name}: {values.min():g} {unit} must be > {floor:g} {unit}{whose}")
        field = Sphere.FIELDS[name]
        low, high = max(field.low or 0.0, SLOWEST), field.high or math.inf
        wrong = values[(values < low) | (values > high)]
        if wrong.size:
            raise ValueError(f"{name}: {wrong[0]:g} {unit} is out of range: from {low:g} to {high:g} {unit}")
    solver = solver_for(scene.solver, accuracy, segments, None)
    result = simulate_rows(scene, columns, solver)
    if (result.status == VIBRATES).all():
        raise SimulationError(vibrations_refused("a batch"))
    shaped = {name: column.reshape(shape) for name, column in result.summary.items()}
    counts = result.segments.max(axis=0).tolist()
    return BatchResult(shaped, result.estimated, (counts[0], counts[1]), (result.status < 0).reshape(shape))


def simulate_rows(scene: Scene, columns: Mapping[str, Array], solver: Solver | None = None) -> RowResult:
    """Impacts of one scene, some of whose numbers are columns: path such as "impactor.velocity" → SI values.

    The columns are of one length and within the ranges of scenes. Each path must have a number in `scene`, and
    `columns` one column at least. solver: the scene's unless given.
    """
    solver = solver or scene.solver
    count = len(next(iter(columns.values())))
    summary = {name: np.full(count, np.nan) for name in SUMMARY}
    speed = scene_of_columns(scene, columns).approach_velocity
    status = np.full(count, native.BAD_NUMBER, np.int32)
    status[np.broadcast_to(np.less_equal(speed, 0.0), (count,))] = NO_VELOCITY
    law = np.zeros(count, np.int8)
    segments, laws, estimated, parts = np.zeros((count, 2), np.int32), [], 0.0, []
    for rows in rows_of(scene, columns, count, status):
        if rows.law not in laws:
            laws.append(rows.law)
        counts, error = _mesh(rows, solver)
        ended, core = native.batch(rows.curve.native, mesh_of(solver, counts), rows.start)
        law[rows.index] = laws.index(rows.law)
        segments[rows.index] = counts
        status[rows.index] = ended
        for name, column in _summary(rows, ended, core).items():
            summary[name][rows.index] = column
        estimated = max(estimated, error + rows.curve.fit_error)
        parts.append(rows)
    return RowResult(summary, status, tuple(laws), law, segments, estimated, tuple(parts))


def _mesh(rows: Rows, solver: Solver) -> tuple[tuple[int, int], float]:
    """Smallest mesh on which every trial impact meets the accuracy, seen from twice as many segments."""
    some = rows.start[_trial(rows.start)]
    damping = float(some["damping"].max(initial=0.0))
    n = solver.segments or (first_segments(damping) if damping > 0.0 else 4)
    ratio = 1 if solver.segments else unloading_ratio(rows.curve)
    before, after = ORDER_FACTOR[solver.linearisation]
    while True:
        counts = (n, ratio * n)
        coarse, fine = (
            native.batch(rows.curve.native, mesh_of(solver, (k * counts[0], k * counts[1])), some) for k in (1, 2)
        )
        ended = (coarse[0] >= 0) & (fine[0] >= 0)
        off = differences(coarse[1][ended], fine[1][ended], some["nu"][ended], some["stop_velocity"][ended])
        worst = float(off.max(initial=0.0))
        estimated = before * worst + ROUNDING
        if solver.segments is not None:
            return counts, estimated
        assert solver.accuracy is not None
        if estimated <= solver.accuracy or n >= MOST_SEGMENTS:
            return counts, estimated
        if after * worst <= solver.accuracy:
            # between n and 2n the error falls with the fourth power
            n = min(2 * n, max(n + 1, math.ceil(n * (1.1 * before * worst / solver.accuracy) ** 0.25)))
        else:
            n *= 2


def _trial(start: NDArray[Any]) -> NDArray[np.intp]:
    """Rows to try: spread evenly, and the extremes of velocity, Zener's number and load."""
    sound = np.flatnonzero(np.isfinite(start["nu"] + start["gamma"] + start["load"]))
    nu, gamma, load = (start[name][sound] for name in ("nu", "gamma", "load"))
    count = sound.size
    if count == 0:
        return sound
    spread = np.linspace(0, count - 1, min(count, max(TRIED_LEAST, count // TRIED_SHARE))).astype(np.intp)
    measures = (nu, gamma * nu**0.2 + 1e-9 * nu, load)
    extremes = [pick(values) for values in measures for pick in (np.argmin, np.argmax)]
    return sound[np.unique(np.concatenate([spread, extremes]))]


def differences(a: NDArray[Any], b: NDArray[Any], nu: Array, stop_velocity: Array) -> Array:
    """Largest relative difference of each pair of summaries: `accuracy.difference` for arrays."""
    depth, speed = b["maximum_indentation"], np.maximum(nu, 1e-300)
    final = b["final_velocity"]
    scales = {
        "maximum_force": (b["maximum_force"],),
        "maximum_indentation": (depth,),
        "time_of_maximum_indentation": (b["time_of_maximum_indentation"],),
        "time_impactor_stops": (b["time_impactor_stops"],),
        "contact_duration": (b["contact_duration"],),
        "permanent_indentation": (np.maximum(np.abs(b["permanent_indentation"]), FLOOR * depth),),
        "final_velocity": tuple(np.maximum(np.abs(v), FLOOR * speed) for v in (final, final - stop_velocity)),
        "work": (np.maximum(0.5 * speed**2, np.abs(b["work"])),),
    }
    worst = np.zeros(nu.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        for name, sizes in scales.items():
            missing = np.isnan(a[name]) & np.isnan(b[name])
            for size in sizes:
                relative = np.where(size > 0.0, np.abs(a[name] - b[name]) / size, np.where(np.isnan(size), 1.0, 0.0))
                worst = np.maximum(worst, np.where(missing, 0.0, np.where(np.isnan(relative), 1.0, relative)))
    return worst


def _summary(rows: Rows, status: NDArray[np.int32], core: NDArray[Any]) -> dict[str, Array]:
    """Summary columns in SI from the core's; nan for what did not happen, and everywhere in a row that failed."""
    s, share, drift, start = rows.scales, rows.share, rows.drift, rows.start
    nu, final = start["nu"], core["final_velocity"]
    failed, over = status < 0, status == native.EVENT
    turned = core["maximum_indentation"] > 0.0
    absorbed = np.where(np.abs(core["work"]) > 1e-14 * nu**2, core["work"], 0.0)  # less is rounding
    permanent = core["permanent_indentation"] * s.length
    columns = {
        "maximum_force": core["maximum_force"] * s.force,
        "maximum_indentation": np.where(turned, core["maximum_indentation"] * s.length, np.nan),
        "time_of_maximum_indentation": np.where(turned, core["time_of_maximum_indentation"] * s.time, np.nan),
        "time_impactor_stops": core["time_impactor_stops"] * s.time,
        "contact_duration": core["contact_duration"] * s.time,
        "permanent_indentation": np.where(start["damping"] > 0.0, np.where(over, 0.0, np.nan), permanent),
        "rebound_velocity": drift + share * final * s.velocity,
        "coefficient_of_restitution": -final / nu,
        "energy_absorbed": np.where(over, absorbed * s.energy, np.nan),
        "energy_radiated": np.where(over, _radiated(rows, core), np.nan),
    }
    if not failed.any():
        return columns
    return {name: np.where(failed, np.nan, column) for name, column in columns.items()}


def _radiated(rows: Rows, core: NDArray[Any]) -> Array:
    """Energy in target motion, J, as `solve` has it."""
    s, start, free = rows.scales, rows.start, rows.share < 1.0
    lost = 0.5 * (start["nu"] ** 2 - core["final_velocity"] ** 2) - core["work"]
    lost += start["load"] * (core["permanent_indentation"] + core["shift"])
    radiated = np.where(start["gamma"] > 0.0, lost * s.energy, 0.0)
    if free.any():
        other = 1.0 - rows.share
        with np.errstate(divide="ignore", invalid="ignore"):
            before, after = (rows.drift - other * nu * s.velocity for nu in (start["nu"], core["final_velocity"]))
            radiated = np.where(free, 0.5 * rows.mass / other * (after**2 - before**2), radiated)
    return radiated
