"""Many impacts of one scene: the only module here that uses film_model's solver for arrays of impacts.

The rest of film_datasets sees plain arrays with one value per impact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.friction_dataset import ERROR, REGIME
from film_model.base.arrays import Array, Index, Mask, index_or_all, index_or_span
from film_model.base.errors import SceneError, SimulationError
from film_model.core import native
from film_model.core.records import Rows, record_many, recorded, sample_many
from film_model.effects.choose import problem_of
from film_model.effects.many import rows_of
from film_model.oblique.result import OBLIQUE
from film_model.problem.problem import Problem, refuse_relaxation
from film_model.problem.scales import Scales, motion_of
from film_model.problem.summary import gains_energy, gains_from_weight
from film_model.scene import DEFAULT_ACCURACY, Scene
from film_model.scene.columns import scene_of_columns
from film_model.solve.accuracy import mesh_of
from film_model.solve.batch import simulate_many
from film_model.solve.closed_form import TABLES, ClosedForm
from film_model.solve.derivatives import Entry, entries_of
from film_model.solve.history import MOTION
from film_model.solve.many_derivatives import ManyDerivatives, derivatives_of_many
from film_model.solve.many_meshes import recorded_segments
from film_model.solve.many_modes import Followed, closed_forms, sensor_peaks
from film_model.solve.sensed import quantities_of

SEGMENT_UNITS = (*(f"scale_{name}" for name in Scales._fields), "drift_velocity", "impactor_share")
"""Values that convert an impact's closed form to SI, by the names of the schema."""


@dataclass(frozen=True)
class ClosedForms:
    """The motions of impacts that share a contact law and modes, in closed form.

    index: of the impacts. tables: the rows of each, and shared: the rows that are the same for all, by the names of
    `film_model.solve.closed_form.TABLES`. units: the values of `SEGMENT_UNITS` and the target's compliance, one of each
    per impact.
    """

    index: Index
    tables: dict[str, Rows]
    shared: dict[str, NDArray[Any]]
    units: dict[str, Array]


@dataclass(frozen=True)
class Impacts:
    """Simulated impacts of a scene; each array has one value per impact.

    summary: SI, by the names of film_model's summary, NaN where there is no value. status: keys of
    `film_model.base.errors.STATUSES`. law: numbers of `laws`, -1 for an impact that has none. gains_energy: whether the
    unloading returned more energy than the loading stored. faster: whether the weight makes an impact leave faster than
    it comes. estimated: bound on the relative error of every value, NaN
    for an impact that failed. friction: by the names of the schema; empty without friction.
    """

    scene: Scene
    summary: dict[str, Array]
    status: NDArray[np.int32]
    laws: tuple[str, ...]
    law: NDArray[np.int8]
    zener_number: Array
    gains_energy: Mask
    faster: Mask
    estimated: Array
    friction: dict[str, NDArray[Any]]
    _problems: tuple[Problem, ...] = field(repr=False)
    _segments: NDArray[np.int32] = field(repr=False)
    _followed: tuple[Followed, ...] = field(repr=False)

    @property
    def on_modes(self) -> Mask:
        """Which impacts are on targets that vibrate."""
        return (self._segments[:, 0] == 0) & (self.status >= 0)

    def closed_forms(self) -> Iterator[ClosedForms]:
        """The motions of all impacts that have a contact law."""
        for problem in self._curves():
            index = rows_of(problem)
            compliance = np.full(index.size, problem.curve.native.compliance)
            curve, start = problem.curve.native, problem.start
            parts = [(places, record_many(curve, mesh, start[places])) for places, mesh in self._meshes(problem)]
            lines = Rows.together(parts, index.size, TABLES["segment"])
            yield ClosedForms(index, {"segment": lines}, {}, _units(problem, compliance))
        for followed in self._followed:
            found = zip(followed.rows.tolist(), closed_forms(followed), strict=True)
            yield _on_modes(followed, {row: form for row, form in found if form is not None})

    def sensor_peaks(self) -> dict[str, dict[str, Array]]:
        """Largest values of the quantities of each sensor of the scene, SI; NaN where the target does not vibrate."""
        names = [sensor.name for sensor in self.scene.target.sensors or ()]
        known = quantities_of(self.scene.target)
        found = np.full((len(names), len(known), self.status.size), np.nan)
        for followed in self._followed if names else ():
            found[:, :, followed.rows] = sensor_peaks(followed)
        return {name: dict(zip(known, own, strict=True)) for name, own in zip(names, found, strict=True)}

    def samples(self, count: int, into: Mapping[str, Array], rows: Index) -> None:
        """Put the motion at `count` even times of each contact into the `rows` of arrays, by the names of `MOTION`.

        On targets that vibrate, of the first contact. The rows of an impact whose contact does not end are not changed.
        """
        unit, duration = np.linspace(0.0, 1.0, count), self.summary["contact_duration"]
        self._put_motion(lambda places: unit * duration[places, None], into, rows)

    def motion(self, times: Array) -> dict[str, Array]:
        """Motion at ascending times [s] of each impact: (impacts, times); NaN where the times are NaN, and of impacts
        that failed."""
        motion = {name: np.full(times.shape, np.nan) for name in MOTION}
        self._put_motion(lambda places: times[places], motion, np.arange(len(times)))
        return motion

    def _put_motion(self, times_of: Callable[[Index], Array], into: Mapping[str, Array], rows: Index) -> None:
        """Put the motion of each impact at its times into the rows of arrays, by the names of `MOTION`."""
        for problem in self._curves():
            index = rows_of(problem)
            for places, mesh in self._meshes(problem):
                for part, lines in recorded(problem.curve.native, mesh, problem.start[places]):
                    some = places[part]
                    t, scales = times_of(index[some]), problem.scales.part((some, None))
                    values = sample_many(problem.curve.native, lines, t / scales.time)
                    drift, share = problem.drift[some, None], problem.share[some, None]
                    found = motion_of(scales, drift, share, problem.free, t, values)
                    known = np.flatnonzero(np.isfinite(t[:, -1]) & (lines.counts > 0))
                    of, at = index_or_all(known, some.size), index_or_span(rows[index[some[known]]])
                    for name, column in into.items():
                        column[at] = found[name][of]
        for followed in self._followed:
            units = _units(followed.problem, followed.start["rest"])
            for place, (row, form) in enumerate(zip(followed.rows.tolist(), closed_forms(followed), strict=True)):
                t = times_of(followed.rows[place : place + 1])[0]
                if form is None or not np.isfinite(t[-1]):
                    continue
                own = {name: float(column[place]) for name, column in units.items()}
                found = motion_of_form(followed.problem, form, own, t)
                for name, column in into.items():
                    column[rows[row]] = found[name]

    def _curves(self) -> Iterator[Problem]:
        for problem in self._problems:
            yield from problem.by_curve()

    def _meshes(self, problem: Problem) -> Iterator[tuple[Index, native.Mesh]]:
        """The meshes on which the impacts of a problem are recorded, and the places of theirs."""
        refuse_relaxation(problem, "storing the motion of many impacts")
        own = recorded_segments(problem, self.scene.solver, self._segments[rows_of(problem)])
        for counts in np.unique(own, axis=0).tolist():
            yield np.flatnonzero((own == counts).all(axis=1)), mesh_of(self.scene.solver, tuple(counts))

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


def _units(problem: Problem, compliance: Array) -> dict[str, Array]:
    """The units of the closed forms of impacts. compliance: of the target, for each."""
    units = {f"scale_{name}": value for name, value in problem.scales._asdict().items()}
    units |= {"drift_velocity": problem.drift, "impactor_share": problem.share, "target_compliance": compliance}
    return {name: np.broadcast_to(value, compliance.shape) for name, value in units.items()}


def _on_modes(followed: Followed, forms: Mapping[int, ClosedForm]) -> ClosedForms:
    """The motions of impacts on the same modes, by their rows."""
    rows = np.array(list(forms), np.intp)
    tables: dict[str, Rows] = {}
    for name in ("step", "flight_mode"):
        each = [form.tables[name] for form in forms.values()]
        joined = np.concatenate(each) if each else np.empty(0, TABLES[name])
        tables[name] = Rows.of_table(joined, np.array([table.size for table in each], np.int32))
    shared = {"mode": next(iter(forms.values())).tables["mode"]} if forms else {}
    units, kept = _units(followed.problem, followed.start["rest"]), np.isin(followed.rows, rows)
    return ClosedForms(rows, tables, shared, {name: column[kept] for name, column in units.items()})


def simulate_impacts(scene: Scene, numbers: Mapping[str, Array]) -> Impacts:
    """Impacts of a scene in which some numbers vary: path such as "impactor.velocity" → SI values, one per impact.

    The values must be within the ranges that a scene allows, and at least one path is needed.
    """
    found = simulate_many(scene, numbers)
    law = np.full(found.status.size, -1, np.int8)
    zener_number = np.full(law.size, np.nan)
    gains, faster = np.zeros(law.size, np.bool_), np.zeros(law.size, np.bool_)
    on_modes = found.on_modes
    law[on_modes] = found.law[on_modes]
    for problem in found.problems:
        index = index_or_all(rows_of(problem), law.size)
        law[index] = found.law[index]
        zener_number[index] = problem.impacts.zener
        own = {name: found.summary[name][index] for name in ("coefficient_of_restitution", "energy_absorbed")}
        gains[index] = gains_energy(problem, own["energy_absorbed"])
        faster[index] = gains_from_weight(problem, own)
    friction, sliding = dict[str, NDArray[Any]](), found.oblique
    if sliding is not None:
        friction = {**sliding.summary, REGIME: sliding.regime, ERROR: sliding.estimated}
    known = (scene, found.summary, found.status, found.laws, law, zener_number, gains, faster)
    return Impacts(*known, found.estimated, friction, found.problems, found.segments, found.followed)


def results_of(scene: Scene, numbers: Mapping[str, Array], names: Sequence[str]) -> dict[str, Array]:
    """Results `names` of impacts in which some numbers vary, SI by path; NaN where there is none.

    Raises SimulationError if friction is not given.
    """
    asked = [name for name in names if name in OBLIQUE]
    if asked and scene.contact.friction is None and "contact.friction" not in numbers:
        raise SimulationError(f"{', '.join(asked)}: friction in [contact] is needed, with a value to begin with")
    found = simulate_impacts(scene, numbers)
    together = {**found.summary, **found.friction}
    return {name: together[name] for name in names}


def sample_closed_form(scene: Scene, form: ClosedForm, units: Mapping[str, float], times: Array) -> dict[str, Array]:
    """Motion of one impact at any times [s] from its stored closed form. units: the values of `SEGMENT_UNITS`.

    Raises ValueError for a motion on modes that is damaged.
    """
    return motion_of_form(problem_of(scene), form, units, times)


def motion_of_form(problem: Problem, form: ClosedForm, units: Mapping[str, float], times: Array) -> dict[str, Array]:
    """The same; problem: one with the law of the impact."""
    *scales, drift, share = (units[name] for name in SEGMENT_UNITS)
    own, order, values = Scales(*scales), np.argsort(times, kind="stable"), np.empty((times.size, 5))
    values[order] = form.sample(problem, own.time, times[order] / own.time)[0]
    return motion_of(own, drift, share, problem.free, times, values.T)


def scene_with_numbers(scene: Scene, numbers: Mapping[str, float]) -> Scene:
    """The scene with some of its numbers replaced [SI], by path, without the checks of `Scene.replace`."""
    values: dict[str, Any] = dict(numbers)
    return scene_of_columns(scene, values)
