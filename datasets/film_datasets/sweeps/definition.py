"""A sweep: a scene, the axes over which it is varied, and a design that places the impacts."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.impacts import scene_with_numbers
from film_datasets.scene_constants import common_constants, scene_key
from film_datasets.schema import CHOOSABLE, CONSTANTS, Variable, derivative_variables, sweep_variables, swept_name
from film_datasets.schema.sensor_variables import peak_variables
from film_datasets.sweeps.axis import Axis
from film_datasets.sweeps.axis_reading import read_axes, swept_mistakes
from film_datasets.sweeps.design_table import is_table, over_of_table
from film_datasets.sweeps.designs import DESIGNS, GRID, SAMPLED, ZIP, option_mistakes, points
from film_datasets.sweeps.distributions import correlated, correlation_factor
from film_model.base.arrays import Array, Index, Mask
from film_model.base.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.base.foreign import Dataset
from film_model.effects.edge_effects import edged
from film_model.problem.law_of_scene import DAMPED, ELASTIC, POWER, STEEP, YIELDING
from film_model.problem.summary import SUMMARY
from film_model.scene import Scene
from film_model.scene.columns import scene_of_columns
from film_model.scene.paths import number_text
from film_model.scene.toml import NO_FILES, toml_table
from film_model.solve.derivatives import Entry, entries_of
from film_model.targets.sensors import sensor_words

MOST_COMBINATIONS = 10_000
"""Combinations of choices that a sweep may have: a scene is held for each."""

OPTIONS = ("samples", "seed", "correlation", "derivatives", "variables")
"""Keys of a sweep file that are optional arguments of `Sweep.of`."""


@dataclass(frozen=True)
class Sweep:
    """Impacts of a scene over some axes, made by `Sweep.of`; `read_sweep` reads one from a sweep file.

    design: "grid" (every combination), "zip" (lists side by side), or "random", "sobol", "latin-hypercube" with
    `samples` impacts drawn with `seed`. keep: "summary", "segments" (exact histories too) or "samples" (histories at
    `dense` normalised times too). first: the scene with the first choice of each axis that has choices. correlation:
    matrix of a Gaussian copula over the axes, or empty. derivatives: numbers by which the summary is differentiated.
    chosen: the only ones of the schema's `CHOOSABLE` variables that are kept; empty for all.
    """

    scene: Scene
    axes: tuple[Axis, ...]
    design: str
    samples: int
    seed: int
    keep: str
    dense: int
    first: Scene = field(repr=False)
    correlation: tuple[tuple[float, ...], ...] = ()
    derivatives: tuple[Entry, ...] = ()
    chosen: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        scene: Scene,
        over: Mapping[str, Any],
        design: str = GRID,
        *,
        samples: int | None = None,
        seed: int | None = None,
        keep: str = "summary",
        correlation: Any = None,
        derivatives: Sequence[str] = (),
        variables: Sequence[str] = (),
    ) -> Sweep:
        """A sweep; see `film_datasets.sweep`. Raises SceneError with all mistakes."""
        if is_table(over):
            over, design = over_of_table(over), ZIP if design == GRID else design
        mistakes = [*option_mistakes(design, samples, seed), *_variable_mistakes(variables)]
        kept, dense = _read_keep(keep)
        axes: tuple[Axis, ...] = ()
        first = scene
        try:
            assumed = GRID if samples is None else SAMPLED[0]  # by which axes are read if the design is unknown
            axes, first = read_axes(scene, over, design if design in DESIGNS else assumed)
        except SceneError as error:
            mistakes += error.mistakes
        raise_all(mistakes)
        matrix = () if correlation is None else _read_correlation(correlation, axes, design)
        entries = _read_derivatives(derivatives, first, axes)
        drawn = samples or 0, 1 if seed is None else seed
        chosen = tuple(name for name in CHOOSABLE if name in variables)
        sweep = cls(scene, axes, design, *drawn, kept, dense, first, matrix, entries, chosen)
        count = sweep.combinations if design != ZIP else len(sweep.combinations_used)
        if count > MOST_COMBINATIONS:
            paths = " and ".join(axis.path for axis in sweep.choice_axes)
            message = f"{count} combinations of {paths}; at most {MOST_COMBINATIONS} are allowed"
            raise SceneError([Mistake(None, None, "over", message)])
        sweep._check_numbers()
        return sweep

    @classmethod
    def of_dataset(cls, ds: Dataset) -> Sweep:
        """The sweep that a dataset was made by."""
        base = Scene.from_stored_text(str(ds.attrs["scene_toml"]), "scene_toml")
        kept = str(ds.attrs["kept"]).split()
        keep = next((word for word in ("segments", "samples") if word in kept), "summary")
        keep = keep if keep != "samples" else f"samples={ds.sizes['normalised_time']}"
        table = toml_table(str(ds.attrs["sweep_toml"]), "sweep_toml")
        over = table["over"]
        _refuse_files(over)
        for path, given in over.items():
            if isinstance(given, Mapping) and "listed" in given:  # too many values for sweep_toml
                array = ds[swept_name(path)]
                over[path] = [f"{value!r} {array.attrs.get('units', '')}" for value in array.values.tolist()]
        options = {key: table[key] for key in OPTIONS if key in table}
        return cls.of(base, over, table["design"], **options, keep=keep)

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Of every variable."""
        if self.design == GRID:
            return tuple(axis.count for axis in self.axes)
        return (self.axes[0].count if self.design == ZIP else self.samples,)

    @cached_property
    def dims(self) -> tuple[str, ...]:
        """Dimensions of every variable: the swept quantities, or `impact`."""
        return tuple(axis.name for axis in self.axes) if self.design == GRID else ("impact",)

    @cached_property
    def size(self) -> int:
        """Number of impacts."""
        return math.prod(self.shape)

    @cached_property
    def kept(self) -> tuple[str, ...]:
        """What is kept of every impact."""
        steps = ("steps",) if self.keep == "segments" and self._may_vibrate else ()
        return (*dict.fromkeys(("summary", self.keep)), *steps, *(("friction",) if self._slides else ()))

    @cached_property
    def _scenes_of_numbers(self) -> list[Scene]:
        """The scene with different values of each axis of numbers, as arrays."""
        return [scene_of_columns(self.first, {a.path: a.probes()}) for a in self.axes if a.kind != "choices"]

    @cached_property
    def _may_vibrate(self) -> bool:
        """Whether there may be impacts on targets that vibrate."""
        return any(map(edged, itertools.chain(self._used_scenes, self._scenes_of_numbers)))

    @cached_property
    def _slides(self) -> bool:
        """Whether there may be friction."""
        scenes = (*self._used_scenes, *self._scenes_of_numbers)
        return any(scene.contact.friction is not None for scene in scenes)

    @cached_property
    def laws(self) -> tuple[str, ...]:
        """Names of the contact laws that may occur, in the order of the flags of `law`."""
        auto = {True: (ELASTIC, YIELDING, DAMPED, *STEEP.values()), False: (POWER,)}
        names = (
            name
            for scene in self._used_scenes
            for name in (auto[scene.nose is None] if scene.contact.law == "auto" else (scene.contact.law_name,))
        )
        return tuple(dict.fromkeys(names))

    @cached_property
    def accuracies(self) -> tuple[float | None, ...]:
        """Requested accuracies, each once; None where segments are given instead."""
        return tuple(dict.fromkeys(scene.solver.accuracy for scene in self._used_scenes))

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """The schema's variables for this sweep: swept quantities, then what is kept."""
        swept = tuple(axis.variable((axis.name,) if self.design == GRID else ("impact",)) for axis in self.axes)
        constants = (variable for variable in CONSTANTS if variable.name in self.constants)
        slopes = (derivative_variables(e.path, _cf_unit(e), self.chosen, self.dims) for e in self.derivatives)
        strained = any(sensor.strain for scene in self._used_scenes for sensor in scene.target.sensors or ())
        peaks = peak_variables(sensor_words(self.sensors), self.dims, strained)
        own = sweep_variables(self.kept, self.chosen, self.dims)
        return (*swept, *own, *itertools.chain(*slopes), *peaks, *constants)

    @cached_property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors of all targets that may vibrate."""
        scenes = self._used_scenes if self._may_vibrate else ()
        return tuple(dict.fromkeys(sensor.name for scene in scenes for sensor in scene.target.sensors or ()))

    @cached_property
    def row_variables(self) -> tuple[Variable, ...]:
        """The variables of the blocks: those with values for each impact."""
        own = self.variables[len(self.axes) :] if self.design == GRID else self.variables
        return tuple(variable for variable in own if variable.dims[: len(self.dims)] == self.dims)

    @cached_property
    def constants(self) -> dict[str, Any]:
        """The values of the schema's `CONSTANTS` that are the same for all impacts."""
        return common_constants(itertools.chain(self._used_scenes, self._scenes_of_numbers))

    @cached_property
    def scene_key(self) -> int:
        """See `film_datasets.scene_constants.scene_key`."""
        return scene_key(self.scene.archived_text(), (axis.meaning for axis in self.axes))

    def text(self) -> str:
        """The sweep file, except for the line that names the scene."""
        head = [f'design = "{self.design}"']
        if self.design in SAMPLED:
            head += [f"samples = {self.samples}", f"seed = {self.seed}"]
        if self.correlation:
            head.append(f"correlation = {json.dumps(self.correlation)}")
        if self.derivatives:
            head.append(f"derivatives = {json.dumps([entry.path for entry in self.derivatives])}")
        if self.chosen:
            head.append(f"variables = {json.dumps(self.chosen)}")
        return "\n".join([*head, "", "[over]", *(f'"{axis.path}" = {axis.text()}' for axis in self.axes), ""])

    def values(self, first: int, count: int) -> list[NDArray[Any]]:
        """For each axis, the values of impacts first … first + count - 1 in C order: SI, or numbers of choices."""
        if self.design in SAMPLED:
            u = points(self.design, len(self.axes), self.samples, self.seed)(first, count)
            if self.correlation:
                u = correlated(u, self._factor)
            return [axis.quantile(u[:, k]) for k, axis in enumerate(self.axes)]
        flat = np.arange(first, first + count)
        places = np.unravel_index(flat, self.shape) if self.design == GRID else [flat] * len(self.axes)
        return [axis.at(place) for axis, place in zip(self.axes, places, strict=True)]

    @cached_property
    def _factor(self) -> Array:
        return correlation_factor(self.correlation, [axis.path for axis in self.axes])

    # ---------------------------------------------------------------- combinations of choices: a scene for each

    @property
    def choice_axes(self) -> list[Axis]:
        """The axes that have choices."""
        return [axis for axis in self.axes if axis.kind == "choices"]

    @property
    def combinations(self) -> int:
        """Number of combinations of choices."""
        return math.prod(len(axis.choices) for axis in self.choice_axes)

    @cached_property
    def combinations_used(self) -> Sequence[int]:
        """Numbers of the combinations that impacts may have: for lists side by side not all."""
        axes = self.choice_axes
        if self.design != ZIP or not axes:
            return range(self.combinations)
        sizes = [len(axis.choices) for axis in axes]
        return np.unique(np.ravel_multi_index([axis.indices for axis in axes], sizes)).tolist()

    def combination_numbers(self, values: Sequence[NDArray[Any]]) -> NDArray[np.int64]:
        """The number of each impact's combination, from its values along the axes."""
        numbers = np.zeros(len(values[0]), np.int64)
        for axis, value in zip(self.axes, values, strict=True):
            if axis.kind == "choices":
                numbers = numbers * len(axis.choices) + value
        return numbers

    @cached_property
    def _scenes(self) -> dict[int, Scene]:
        return {}

    def combination(self, number: int) -> Scene:
        """The scene of a combination of choices."""
        if number not in self._scenes:
            axes = self.choice_axes
            places = np.unravel_index(number, [len(axis.choices) for axis in axes]) if axes else ()
            changes = {axis.path: axis.choices[int(place)] for axis, place in zip(axes, places, strict=True)}
            self._scenes[number] = self.first.replace(changes) if changes else self.scene
        return self._scenes[number]

    @property
    def _used_scenes(self) -> Iterator[Scene]:
        return (self.combination(number) for number in self.combinations_used)

    def parts(
        self, values: Sequence[NDArray[Any]], wanted: Mask
    ) -> Iterator[tuple[Scene, Index, dict[str, NDArray[Any]]]]:
        """The impacts that are wanted of those with these values along the axes, by combination of choices: its scene,
        the places of its impacts, and their numbers by path, at least one."""
        combination = self.combination_numbers(values)
        few = self.combinations <= MOST_COMBINATIONS
        for number in (np.flatnonzero(np.bincount(combination)) if few else np.unique(combination)).tolist():
            index = np.flatnonzero((combination == number) & wanted)
            if index.size:
                scene, pairs = self.combination(number), zip(self.axes, values, strict=True)
                numbers = {axis.path: value[index] for axis, value in pairs if axis.kind != "choices"}
                yield scene, index, numbers or {"impactor.velocity": np.full(index.size, scene.impactor.speed)}

    def scene_of(self, impact: int) -> Scene | None:
        """The scene of one impact, by its place in C order; None if a value is out of range."""
        values = self.values(impact, 1)
        numbers: dict[str, float] = {}
        for axis, value in zip(self.axes, values, strict=True):
            if axis.kind == "choices":
                continue
            if axis.outside(value)[0]:
                return None
            numbers[axis.path] = float(value[0])
        return scene_with_numbers(self.combination(int(self.combination_numbers(values)[0])), numbers)

    def _check_numbers(self) -> None:
        """Raise SceneError if no corner of the design makes a valid scene; single impacts may fail, with a status."""
        axes = [axis for axis in self.axes if axis.kind != "choices"]
        ends = [axis.typical for axis in axes]
        for number in self.combinations_used:
            first = None
            for corner in itertools.islice(itertools.product(*ends), 64):
                pairs = zip(axes, corner, strict=True)
                try:
                    self.combination(number).replace({axis.path: number_text(v, axis.unit) for axis, v in pairs})
                    break
                except SceneError as error:
                    first = first or error
            else:
                assert first is not None
                raise SceneError(swept_mistakes(first, [axis.path for axis in self.choice_axes]))


def _variable_mistakes(given: Any) -> list[Mistake]:
    """Mistakes of the variables that are to be kept."""
    if not isinstance(given, list | tuple):
        return [Mistake(None, None, "variables", f"{shown(given)} is not a list of names of variables")]
    unknown = (name for name in given if name not in CHOOSABLE)
    messages = (f"{shown(name)} is not a variable that can be chosen{_closest(name)}" for name in unknown)
    return [Mistake(None, None, "variables", message) for message in messages]


def _closest(name: Any) -> str:
    hint = (did_you_mean(name, SUMMARY) or did_you_mean(name, CHOOSABLE)) if isinstance(name, str) else ""
    return hint or f": {', '.join(CHOOSABLE)}"


def _read_correlation(given: Any, axes: Sequence[Axis], design: str) -> tuple[tuple[float, ...], ...]:
    """The correlation matrix of the swept quantities. Raises SceneError."""
    try:
        if design not in SAMPLED:
            raise ValueError(f'is not for design "{design}"')
        correlation_factor(given, [axis.path for axis in axes])
    except ValueError as error:
        raise SceneError([Mistake(None, None, "correlation", str(error))]) from None
    return tuple(tuple(map(float, row)) for row in given)


def _read_derivatives(given: Any, first: Scene, axes: Sequence[Axis]) -> tuple[Entry, ...]:
    """The numbers by which the summary is differentiated; swept ones need not be in the scene. Raises SceneError."""
    if not isinstance(given, str | list | tuple):
        raise SceneError([Mistake(None, None, "derivatives", f"{shown(given)} is not a list of keys of the scene")])
    swept = {axis.path: axis.typical[-1] for axis in axes if axis.kind != "choices"}
    return entries_of(scene_with_numbers(first, swept), given, swept)


def _cf_unit(entry: Entry) -> Callable[[str], str | None]:
    """The units of the derivatives by a number; none where UDUNITS has no such unit."""
    return lambda name: None if entry.dimension == "meyer_stiffness" else entry.unit_of(name)


def _refuse_files(over: Mapping[str, Any]) -> None:
    """Raise SceneError if a choice of a stored sweep names a file."""
    sections = [section for choices in over.values() if isinstance(choices, list) for section in choices]
    if any(path.endswith(".file") for path in over) or any(
        isinstance(section, Mapping) and "file" in section for section in sections
    ):
        raise SceneError([Mistake("sweep_toml", None, "over", NO_FILES)])


def _read_keep(keep: str) -> tuple[str, int]:
    """What is kept, and the number of normalised times of "samples=…"."""
    word, _, number = keep.partition("=")
    if word == "samples" and number.isascii() and number.isdigit() and 2 <= int(number) <= 1_000_000:
        return word, int(number)
    if keep in ("summary", "segments"):
        return keep, 0
    message = f"{shown(keep)} is not allowed: summary, segments or samples=201 is needed"
    raise SceneError([Mistake(None, None, "keep", message)])
