"""Effects of many impacts at once: the rules of `effects.choose`, for every row.

An effect is tried with one impact of each cell of dimensionless numbers. Where the outcome is clear it holds for the
impact's neighbours too; where it is not, each is tried itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.accuracy import unloading_ratio
from film_model.bodies import Body, Plate
from film_model.core import native
from film_model.curve import curve_of
from film_model.edges import edged
from film_model.effects import FIRST_ORDER_LOSS, TRIAL
from film_model.laws import LAWS
from film_model.laws.yielding import yield_velocity
from film_model.limits import reflection_change
from film_model.problem import Array
from film_model.row_problems import Group, Index, RowLaw, Rows
from film_model.scene import Scene

Mask = NDArray[np.bool_]

SURE = 3.0
"""Target motion and edges need no trial where their first-order size is so many times off the tolerance."""

PLASTIC_FROM = 2.0
"""Ratio to the yield velocity from which yielding changes the summary by more than 2 %."""

LEVELS = ((1.1, 2.0, 2.0), (1.01, 1.2, 1.1), (1.001, 1.05, 1.01))
"""Ratios that a cell spans in velocity, target compliance and damping; that it spans in load; and by which a change,
scaled with the load, must be off the tolerance to be clear for the whole cell. What is not clear is cut finer."""


def decided(group: Group) -> list[Rows]:
    """The problems of a group, with the effects they call for; some may come down to Hertz's law.

    Left out are impacts on a plate whose edges may matter.
    """
    found, scene = _on_infinite_targets(group), group.scene
    if edged(scene) and scene.effects.boundary_reflections == "auto":
        near = group.index[_edges_may_matter(group)]
        found = [rows.part(~np.isin(rows.index, near)) for rows in found]
    return [rows for rows in found if rows.index.size]


def _on_infinite_targets(group: Group) -> list[Rows]:
    scene = group.scene
    still = isinstance(scene.target, Body) or scene.effects.target_motion is False
    impedance = group.column(math.inf if still else scene.target_impedance)
    load = np.where(_heavy(group, impedance), group.weight, 0.0)
    if scene.effects.target_motion == "auto" and np.isfinite(impedance).any():
        impedance = np.where(_moves(group, impedance, load), impedance, math.inf)
    rows = group.assemble(impedance, load)
    if scene.contact.law != "auto" or scene.effects.plasticity != "auto" or group.law.law is LAWS["hertz"]:
        return [rows]
    law = RowLaw.of(scene, LAWS["hertz"])
    elastic = Group(scene, law, curve_of(law.at(0)), group.index).assemble(impedance, load)
    plastic = _plastic(scene, rows, elastic)
    return [rows.part(plastic), elastic.part(~plastic)]


def _edges_may_matter(group: Group) -> Mask:
    """Impacts on a plate with edges that need a trial to be on an infinite one."""
    scene = group.scene
    assert isinstance(scene.target, Plate)
    rows = group.assemble(group.column(scene.target_impedance), np.zeros(group.index.size))
    status, seen = native.batch(rows.curve.native, native.mesh(native.WORK_PRESERVING, 4, 8), rows.start)
    returns = group.column(scene.target.return_time) / rows.scales.time
    with np.errstate(divide="ignore", invalid="ignore"):
        off = reflection_change(rows.start["nu"], rows.start["gamma"], seen, returns)
    return (status != native.EVENT) | ~(off < scene.effect_tolerance / SURE)


def _heavy(group: Group, impedance: Array) -> Mask:
    """Which impacts are simulated with their weight."""
    scene, count = group.scene, group.index.size
    if isinstance(scene.target, Body) or scene.effects.gravity != "auto":
        return np.full(count, scene.effects.gravity is True and not isinstance(scene.target, Body))
    light, pressed = (group.assemble(impedance, load) for load in (np.zeros(count), group.weight))
    return _matters(pressed, np.arange(count), scene.effect_tolerance, lambda k: _change(pressed, light, k, True))


def _moves(group: Group, impedance: Array, load: Array) -> Mask:
    """Which impacts are simulated with the target's impedance, of those where it is finite."""
    moved, held = (group.assemble(z, load) for z in (impedance, np.full(group.index.size, math.inf)))
    tolerance = group.scene.effect_tolerance
    loss = FIRST_ORDER_LOSS * moved.zener
    found = loss > tolerance
    doubtful = np.flatnonzero(np.isfinite(impedance) & ~((loss < tolerance / SURE) | (loss > SURE * tolerance)))
    found[doubtful] = _matters(moved, doubtful, tolerance, lambda k: _change(moved, held, k))
    return found


def _plastic(scene: Scene, rows: Rows, elastic: Rows) -> Mask:
    """Which impacts beyond the yield point are not simulated with Hertz's law."""
    strength, modulus, tolerance = scene.yield_strength, scene.effective_modulus, scene.effect_tolerance
    assert strength is not None and modulus is not None
    limit = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
    found = np.broadcast_to(scene.approach_velocity > PLASTIC_FROM * limit, rows.index.shape) & (tolerance <= 0.02)
    doubtful = np.flatnonzero(~found)
    found[doubtful] = _matters(rows, doubtful, tolerance, lambda k: _change(rows, elastic, k))
    return found


def _matters(rows: Rows, places: Index, tolerance: float, change: Callable[[Index], Array]) -> Mask:
    """Where among `places` the change is more than the tolerance, or is not known.

    rows: with the effect, by whose numbers neighbours are found. change: what `_change` gives for some places.
    """
    size, left = np.full(places.size, np.nan), np.arange(places.size)
    for ratio, load_ratio, clear in LEVELS:
        load = rows.start["load"][places[left]]
        first, cell = _firsts(_cells(rows.start, places[left], ratio, load_ratio))
        tried = change(places[left[first]])
        with np.errstate(divide="ignore", invalid="ignore"):
            found = tried[cell] * np.where(load > 0.0, load / load[first][cell], 1.0)
        known = (found < tolerance / clear) | (found > clear * tolerance)
        found[first], known[first] = tried, True
        size[left[known]] = found[known]
        left = left[~known]
        if left.size == 0:
            break
    else:
        size[left] = change(places[left])
    return ~(size <= tolerance)


def _firsts(cells: NDArray[np.int64]) -> tuple[Index, Index]:
    """The first impact of each cell, and for every impact the place of its cell among these."""
    most = int(cells.max(initial=0))
    if most > 8 * cells.size:  # a table would be mostly empty
        _, first, cell = np.unique(cells, return_index=True, return_inverse=True)
        return first, cell
    table = np.full(most + 1, -1)
    table[cells[::-1]] = np.arange(cells.size - 1, -1, -1)  # of many in a cell the last one written stays: the first
    filled = np.flatnonzero(table >= 0)
    first = table[filled]
    table[filled] = np.arange(filled.size)
    return first, table[cells]


def _cells(start: NDArray[Any], places: Index, ratio: float, load_ratio: float) -> NDArray[np.int64]:
    """A number for each impact, the same for those whose dimensionless numbers are alike."""
    cells = np.zeros(places.size, np.int64)
    for name, width in (("nu", ratio), ("gamma", ratio), ("damping", ratio), ("load", load_ratio)):
        values = start[name][places]
        if values.any():
            with np.errstate(divide="ignore", invalid="ignore"):
                step = np.floor(np.log(values) / math.log(width))
            number = np.where(np.isfinite(step), step, 0.0).astype(np.int64)
            number = np.where(np.isfinite(step), number - number.min() + 1, 0)
            cells = cells * (number.max() + 1) + number
    return cells


def _change(full: Rows, without: Rows, places: Index, ending: bool = False) -> Array:
    """`effects.change` for the rows at `places`; nan where it is not known, with `ending` also without an end."""
    p, q = full.part(places), without.part(places)
    (status, a), (other, b) = _march(p), _march(q)
    length, force, time, speed = (
        getattr(q.scales, name) / getattr(p.scales, name) for name in ("length", "force", "time", "velocity")
    )
    nu, depth = p.start["nu"], a["maximum_indentation"]
    impact = 0.5 * nu**2
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.maximum.reduce([
            _relative(b["maximum_force"] * force, a["maximum_force"]),
            _relative(b["maximum_indentation"] * length, depth),
            _relative(b["time_of_maximum_indentation"] * time, a["time_of_maximum_indentation"]),
        ])  # fmt: skip
        radiated = np.abs(_radiated(q, b) * length * force - _radiated(p, a)) / impact
        whole = np.maximum.reduce([
            off,
            _relative(b["contact_duration"] * time, a["contact_duration"]),
            np.abs(b["permanent_indentation"] * length - a["permanent_indentation"]) / depth,
            np.abs(b["final_velocity"] * speed - a["final_velocity"]) / nu,
            np.abs(b["work"] * length * force - a["work"]) / impact,
            np.where((p.start["gamma"] > 0.0) | (q.start["gamma"] > 0.0), radiated, 0.0),
        ])  # fmt: skip
    ends, other_ends = status == native.EVENT, other == native.EVENT
    size = np.where(ends != other_ends, 1.0, np.where(ends, whole, off))
    unknown = (status < 0) | (other < 0) | (ending & ~other_ends)
    return np.where(unknown, np.nan, size)


def _relative(value: Array, to: Array) -> Array:
    """Relative difference; 1 where only one of the two has happened."""
    return np.where(value == to, 0.0, np.where((to > 0.0) & (value >= 0.0), np.abs(value / to - 1.0), 1.0))


def _radiated(rows: Rows, summary: NDArray[Any]) -> Array:
    """Energy that went into target motion, in the core's units."""
    weight = rows.start["load"] * (summary["permanent_indentation"] + summary["shift"])
    return 0.5 * (rows.start["nu"] ** 2 - summary["final_velocity"] ** 2) - summary["work"] + weight


def _march(rows: Rows) -> tuple[NDArray[np.int32], NDArray[Any]]:
    """The rows on the trial mesh, as `effects.march` does."""
    mesh = native.mesh(native.WORK_PRESERVING, TRIAL, unloading_ratio(rows.curve) * TRIAL)
    return native.batch(rows.curve.native, mesh, rows.start)
