"""Many impacts of one scene: the only module here that uses film_model's solver for arrays of impacts.

The rest of film_datasets sees plain arrays with one value per impact.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index, index_or_all
from film_model.base.errors import SceneError
from film_model.core import native
from film_model.core.records import Lines, record_many, sample_many
from film_model.effects.choose import problem_of
from film_model.effects.edge_effects import edged, infinite_unless_judged
from film_model.effects.many import rows_of
from film_model.problem.problem import Problem, refuse_relaxation
from film_model.problem.scales import Scales, motion_of
from film_model.scene import DEFAULT_ACCURACY, Scene
from film_model.scene.columns import scene_of_columns
from film_model.solve.accuracy import mesh_of
from film_model.solve.batch import simulate_many
from film_model.solve.derivatives import Entry, entries_of
from film_model.solve.history import MOTION
from film_model.solve.many_derivatives import ManyDerivatives, derivatives_of_many
from film_model.solve.simulate import simulate_quietly

SEGMENT_UNITS = (*(f"scale_{scale.name}" for scale in fields(Scales)), "drift_velocity", "impactor_share")
"""Values that convert an impact's segments to SI, by the names of the schema."""

ENERGY_GAIN = 1e-9
"""Fraction of the kinetic energy: a smaller negative energy_absorbed is rounding error, not a law that gains energy."""


@dataclass(frozen=True)
class Segments:
    """Segments of impacts that share a contact law.

    index: of the impacts. lines: the segments of each, in the core's units.
    units: the values of `SEGMENT_UNITS` and the target's compliance, one of each per impact.
    """

    index: Index
    lines: Lines
    units: dict[str, Array]


@dataclass(frozen=True)
class Impacts:
    """Simulated impacts of a scene; each array has one value per impact.

    summary: SI, by the names of film_model's summary, NaN where there is no value. status: keys of
    `film_model.base.errors.STATUSES`. law: numbers of `laws`, -1 for an impact that has none. gains_energy: whether the
    unloading returned more energy than the loading stored. estimated: bound on the relative error of every value, NaN
    for an impact that failed.
    """

    scene: Scene
    summary: dict[str, Array]
    status: NDArray[np.int32]
    laws: tuple[str, ...]
    law: NDArray[np.int8]
    zener_number: Array
    gains_energy: NDArray[np.bool_]
    estimated: Array
    _problems: tuple[Problem, ...] = field(repr=False)
    _segments: NDArray[np.int32] = field(repr=False)
    _numbers: Mapping[str, Array] = field(repr=False)

    @property
    def on_modes(self) -> NDArray[np.bool_]:
        """Which impacts are on targets that vibrate: their motion has no segments of the march."""
        return (self._segments[:, 0] == 0) & (self.status >= 0)

    def segments(self) -> Iterator[Segments]:
        """The closed-form segments of all impacts that have a contact law, except those on targets that vibrate."""
        for problem in self._curves():
            units = {f"scale_{name}": value for name, value in vars(problem.scales).items()}
            units.update(drift_velocity=problem.drift, impactor_share=problem.share)
            index = rows_of(problem)
            units["target_compliance"] = np.full(index.size, problem.curve.native.compliance)
            yield Segments(index, self._record(problem), units)

    def samples(self, count: int) -> dict[str, Array]:
        """Motion at `count` evenly spaced times of each contact: (impacts, count), NaN if the contact does not end.

        On targets that vibrate, of the first contact.
        """
        return self.motion(np.linspace(0.0, 1.0, count) * self.summary["contact_duration"][:, None])

    def motion(self, times: Array) -> dict[str, Array]:
        """Motion at ascending times [s] of each impact: (impacts, times); NaN where the times are NaN, and of impacts
        that failed. Impacts on targets that vibrate have no segments: they are simulated again, one by one."""
        motion = {name: np.full(times.shape, np.nan) for name in MOTION}
        for problem in self._curves():
            index, lines = rows_of(problem), self._record(problem)
            known = np.flatnonzero(np.isfinite(times[index, -1]) & (lines.counts > 0))
            t, scales = times[index[known]], problem.scales.part((known, None))
            time: Any = scales.time
            values = sample_many(problem.curve.native, lines.part(known), t / time)
            drift, share = problem.drift[known, None], problem.share[known, None]
            found = motion_of(scales, drift, share, problem.free, t, np.moveaxis(values, -1, 0))
            for name, column in motion.items():
                column[index[known]] = found[name]
        for row in np.flatnonzero(self.on_modes & np.isfinite(times[:, -1])).tolist():
            own = scene_with_numbers(self.scene, {path: float(values[row]) for path, values in self._numbers.items()})
            found = simulate_quietly(own).sample_si(times[row])
            for name, column in motion.items():
                column[row] = getattr(found, name)
        return motion

    def _curves(self) -> Iterator[Problem]:
        for problem in self._problems:
            yield from problem.by_curve()

    def _record(self, problem: Problem) -> Lines:
        """The segments of each impact, on its own mesh."""
        refuse_relaxation(problem, "storing the motion of many impacts")
        own, parts = self._segments[rows_of(problem)], list[tuple[Index, Lines]]()
        for counts in np.unique(own, axis=0).tolist():
            places = np.flatnonzero((own == counts).all(axis=1))
            mesh = mesh_of(self.scene.solver, tuple(counts))
            parts.append((places, record_many(problem.curve.native, mesh, problem.start[places])))
        return Lines.together(parts, len(own))

    def derivatives(self, numbers: Mapping[str, Array], asked: Iterable[Entry]) -> tuple[list[Entry], ManyDerivatives]:
        """Derivatives by those of the numbers asked for that the scene has, as exact as its accuracy.

        numbers: those that vary, as for :func:`simulate_impacts`.
        """
        known: list[Entry] = []
        for entry in asked:
            with suppress(SceneError):
                known += [entry] if entry.path in numbers else entries_of(self.scene, [entry.path])
        solver = self.scene.solver
        target = solver.accuracy or DEFAULT_ACCURACY
        return known, derivatives_of_many(self.scene, numbers, known, self._problems, self.on_modes, solver, target)


def simulate_impacts(scene: Scene, numbers: Mapping[str, Array]) -> Impacts:
    """Impacts of a scene in which some numbers vary: path such as "impactor.velocity" → SI values, one per impact.

    The values must be within the ranges that a scene allows, and at least one path is needed.
    """
    found = simulate_many(scene, numbers)
    law = np.full(found.status.size, -1, np.int8)
    zener_number = np.full(law.size, np.nan)
    gains_energy = np.zeros(law.size, np.bool_)
    on_modes = found.on_modes
    law[on_modes] = found.law[on_modes]
    for problem in found.problems:
        index = index_or_all(rows_of(problem), law.size)
        law[index] = found.law[index]
        zener_number[index] = problem.impacts.zener
        energy = 0.5 * problem.mass * (problem.approach * problem.scales.velocity) ** 2
        gains_energy[index] = found.summary["energy_absorbed"][index] < -ENERGY_GAIN * energy
    return Impacts(
        scene,
        found.summary,
        found.status,
        found.laws,
        law,
        zener_number,
        gains_energy,
        found.estimated,
        found.problems,
        found.segments,
        numbers,
    )


def sample_segments(scene: Scene, lines: NDArray[Any], units: Mapping[str, float], times: Array) -> dict[str, Array]:
    """Motion of one impact at any times [s] from its stored segments. units: the values of `SEGMENT_UNITS`."""
    *scales, drift, share = (units[name] for name in SEGMENT_UNITS)
    order = np.argsort(times, kind="stable")
    problem, units_of_lines = problem_of(scene), Scales(*scales)
    values = np.empty((times.size, 5))
    values[order] = native.sample(problem.curve.native, lines, times[order] / units_of_lines.time)[0]
    return motion_of(units_of_lines, drift, share, problem.free, times, values.T)


def scene_with_numbers(scene: Scene, numbers: Mapping[str, float]) -> Scene:
    """The scene with some of its numbers replaced [SI], by path, without the checks of `Scene.replace`."""
    values: dict[str, Any] = dict(numbers)
    return scene_of_columns(scene, values)


def one_curve_per_impact(scene: Scene) -> bool:
    """Whether impacts of the scene may differ in their dimensionless curve: a static stiffness is part of the curve."""
    return edged(scene) and not infinite_unless_judged(scene)
