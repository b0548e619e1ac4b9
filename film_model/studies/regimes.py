"""Regimes of an impact over Zener's λ and V/V_Y: a grid of impacts under Big-Alabo's law.

That law has one dimensionless form, so that on a target with an impedance the two numbers say everything: λ how much
the target gives way, V/V_Y how far the contact yields. In the core's units (K = m = 1) λ = γ ν^{1/5}.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.core.columns import Columns
from film_model.effects.case import Pulse
from film_model.laws import BigAlabo
from film_model.laws.big_alabo import FULLY_PLASTIC
from film_model.laws.yielding import yield_velocity
from film_model.problem.curve import curve_of
from film_model.problem.numbers import zener
from film_model.scene import Scene

LAMBDAS, RATIOS = (1e-3, 10.0), (0.1, 1000.0)
"""Ranges of λ and V/V_Y; they are widened to take in the scene, by no more than `WIDEST` each way."""

WIDEST = 10.0


class Regimes(NamedTuple):
    """Fields over V/V_Y (rows) and λ (columns), and where the scene is (None: not known, or no such thing).

    motion: change by target motion, relative. depth: δ_m/δ_y. reflections: change by waves from the edges. rests:
    contact time over the slowest period of the plate, or over the return time of a rod's wave.
    """

    lambdas: Array
    ratios: Array
    motion: Array
    depth: Array
    reflections: Array | None
    rests: Array | None
    value: float | None
    ratio: float | None


def regimes(scene: Scene) -> Regimes:
    """The grid for a scene: its target's mass and sides are kept while the stiffness goes with λ.

    Raises SimulationError for a beam.
    """
    points = 121  # a side of the grid
    if scene.target.structural and math.isinf(scene.target_impedance):
        raise SimulationError(
            f"a {scene.target.kind} has no place on a map of regimes: without a wave impedance it has no λ"
        )
    value, ratio = _place(scene)
    lambdas = np.geomspace(*_range(LAMBDAS, value), points)
    ratios = np.geomspace(*_range(RATIOS, ratio), points)
    nu = np.repeat(math.sqrt(0.8) * ratios, points)
    start: Any = np.zeros(nu.size, native.START_DTYPE)
    start["nu"], start["gamma"], start["time_limit"] = nu, np.tile(lambdas, points) / nu**0.2, math.inf
    still = start[::points].copy()
    still["gamma"] = 0.0
    mesh, curve = native.mesh(native.WORK_PRESERVING, 8, 16), curve_of(BigAlabo(1.0, 1.0, 1.0)).native
    _, moved = native.batch(curve, mesh, start)
    held = np.repeat(native.batch(curve, mesh, still)[1], points)
    impact = 0.5 * nu**2
    with np.errstate(divide="ignore", invalid="ignore"):  # a contact that never turns
        radiated = (impact - 0.5 * moved["final_velocity"] ** 2 - moved["work"]) / impact
        ends = ("maximum_force", "maximum_indentation", "contact_duration")
        off = [abs(held[name] / moved[name] - 1.0) for name in ends]
    off += [abs(held["final_velocity"] - moved["final_velocity"]) / nu, abs(held["work"] - moved["work"]) / impact]
    motion = np.nan_to_num(np.maximum.reduce([*off, radiated]), nan=1.0, posinf=1.0)
    reflected, rests = _boundaries(scene, start, moved)
    shape = (points, points)
    return Regimes(
        lambdas,
        ratios,
        motion.reshape(shape),
        moved["maximum_indentation"].reshape(shape),
        None if reflected is None else reflected.reshape(shape),
        None if rests is None else rests.reshape(shape),
        value,
        ratio,
    )


class Limits(NamedTuple):
    """Points (λ, V/V_Y) at which the contact yields, becomes fully plastic, and target motion begins to matter."""

    yields: list[tuple[float, float]]
    plastic: list[tuple[float, float]]
    moves: list[tuple[float, float]]


def limits(found: Regimes, tolerance: float) -> Limits:
    """The boundaries of a map, by interpolation between its points; what lies beyond the map is left out.

    Depth grows with the velocity, and the change by target motion with λ.
    """

    def crossings(level: float, lines: Array, along: Array) -> Iterator[tuple[int, float]]:
        for k, line in enumerate(lines):
            if line[0] < level < line[-1]:
                at = np.interp(math.log(level), np.log(np.maximum(line, 1e-300)), np.log(along))
                yield k, float(f"{math.exp(at):.5g}")

    def above(level: float) -> list[tuple[float, float]]:
        found_at = crossings(level, found.depth.T, found.ratios)
        return [(float(f"{found.lambdas[k]:.5g}"), ratio) for k, ratio in found_at]

    beside = crossings(tolerance, found.motion, found.lambdas)
    moves = [(value, float(f"{found.ratios[k]:.5g}")) for k, value in beside]
    return Limits(above(1.0), above(FULLY_PLASTIC), moves)


def _place(scene: Scene) -> tuple[float | None, float | None]:
    """λ and V/V_Y of the scene."""
    impedance, strength, modulus = scene.target_impedance, scene.yield_strength, scene.effective_modulus
    value = None if math.isinf(impedance) or modulus is None else zener(scene, impedance)
    if strength is None or modulus is None or scene.approach_velocity == 0.0:
        return value, None
    limit = yield_velocity(modulus, scene.effective_radius, strength, scene.effective_mass)
    return value, scene.approach_velocity / limit


def _range(usual: tuple[float, float], place: float | None) -> tuple[float, float]:
    low, high = usual
    if not place:
        return low, high
    return min(low, max(place / 3.0, low / WIDEST)), max(high, min(3.0 * place, high * WIDEST))


def _boundaries(scene: Scene, start: Any, moved: Any) -> tuple[Array | None, Array | None]:
    """Change by reflections, and contact time over the longest time of the target: times go with m/Z."""
    target, mass, impedance = scene.target, scene.effective_mass, scene.target_impedance
    unit = moved["contact_duration"] / start["gamma"]  # contact time over m/Z
    if target.longest_time is None:
        return None, None
    rests = unit * mass / impedance / target.longest_time
    if not target.structural:
        return None, rests
    returns = target.return_time * impedance / mass * start["gamma"]
    pulse = Pulse.of(start["nu"], start["gamma"], Columns(moved))
    return scene.target.reflection_change(pulse.motion, pulse.restitution, pulse.back / returns), rests
