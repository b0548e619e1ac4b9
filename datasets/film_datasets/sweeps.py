"""Sweeps: what they vary, their blocks, and the columns of a block."""

from __future__ import annotations

import difflib
import itertools
import math
import os
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_datasets.design import (
    DESIGNS,
    DISTRIBUTIONS,
    GRID,
    MOST_CASES,
    MOST_SAMPLES,
    RANGE,
    SAMPLED,
    ZIP,
    Axis,
    points,
    read_axes,
    swept_mistakes,
)
from film_datasets.schema import REFUSED, SWEEP, TABLE, Variable, swept_name
from film_model.accuracy import mesh_of
from film_model.batch import NO_VELOCITY, RowResult, simulate_rows
from film_model.core import native
from film_model.edges import edged, wide
from film_model.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.history import MOTION
from film_model.problem import motion_of
from film_model.row_problems import Rows
from film_model.rows import scene_of_columns
from film_model.scene import Scene
from film_model.scene_file import line_of, lines_of_keys, read_text, toml_table

BLOCK_BYTES, BLOCK_ROWS = 6_000_000, 65_536
"""A block has about so many bytes of data, and no more rows; results do not depend on who computes it."""

OWN_CURVES = 1024
"""Rows of a block where each may take a curve of its own, 91 kB: on beams and static stiffnesses."""

MOST_CORNERS = 64
"""Corners of a design that are tried for one that makes a scene."""

LINES_GUESSED = 32
"""Segments of an impact, about, at the default accuracy."""

KEYS = ("scene", "design", "samples", "seed", "over")


class Block(NamedTuple):
    """A part of a sweep: its place in the arrays, and the impacts in C order that it has."""

    region: tuple[slice, ...]
    first: int
    count: int


@dataclass(frozen=True)
class Sweep:
    """Impacts of a scene over some axes. Made by `Sweep.of`, or from a sweep file by `Sweep.from_toml`.

    design: "grid" (every combination), "zip" (lists side by side), or "random", "sobol", "latin-hypercube" with
    `samples` impacts drawn with `seed`. keep: "summary", "segments" (the exact histories too) or "samples" (dense
    ones too, `dense` on normalised time).
    """

    scene: Scene
    axes: tuple[Axis, ...]
    design: str
    samples: int
    seed: int
    keep: str
    dense: int
    first: Scene = field(repr=False)

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
    ) -> Sweep:
        """A sweep; see `film_datasets.sweep`. Raises SceneError with all mistakes."""
        mistakes = _option_mistakes(design, samples, seed)
        kept, dense = _read_keep(keep)
        axes: tuple[Axis, ...] = ()
        first = scene
        try:
            axes, first = read_axes(scene, over, design if design in DESIGNS else GRID)
        except SceneError as error:
            mistakes += error.mistakes
        raise_all(mistakes)
        made = cls(scene, axes, design, samples or 0, 1 if seed is None else seed, kept, dense, first)
        if (count := made.cases if design != ZIP else len(made.occurring)) > MOST_CASES:
            words = " and ".join(axis.path for axis in axes if axis.kind == "words")
            message = f"{count} combinations of {words}; at most {MOST_CASES} are allowed"
            raise SceneError([Mistake(None, None, "over", message)])
        made._check_numbers()
        return made

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str], keep: str = "summary") -> Sweep:
        """Read a sweep file; the scene it names lies beside it. All mistakes are raised in one SceneError."""
        text, name = read_text(path)
        folder = Path(path).parent
        return cls.from_text(text, name, lambda scene: Scene.from_toml(folder / scene), keep, folder)

    @classmethod
    def from_text(
        cls, text: str, name: str, scene: Callable[[str], Scene], keep: str = "summary", folder: Path = Path()
    ) -> Sweep:
        """A sweep from the text of a sweep file called `name`; `scene` finds the scene by its file's name.

        Files of laws are looked for in `folder`.
        """
        given = toml_table(text, name)
        table = {_meant(key): value for key, value in given.items()} | given
        mistakes = _table_mistakes(given, table)
        there = isinstance(table.get("over"), Mapping)
        over = _flat(table["over"]) if there else {}
        sections = over.get("contact")
        for section in sections if isinstance(sections, list) else ():
            if isinstance(section, dict) and isinstance(section.get("file"), str):
                section["file"] = str(folder / section["file"])
        options = {key: table[key] for key in ("samples", "seed") if key in table}
        design, base, made = table.get("design", GRID), None, None
        try:
            base = scene(table["scene"]) if isinstance(table.get("scene"), str) else None
            made = cls.of(base, over, design, **options, keep=keep) if base is not None and there else None
        except SceneError as error:
            mistakes += error.mistakes
        if base is None or not there:  # what `of` had no occasion to say
            mistakes += _option_mistakes(design, options.get("samples"), options.get("seed"))
        if made is None or mistakes:
            lines = lines_of_keys(text)
            own = [m if m.file else replace(m, file=name, line=_line(lines, m.key, over)) for m in mistakes]
            raise SceneError(sorted(own, key=lambda m: (m.file != name, m.line or 0)))
        return made

    @classmethod
    def of_dataset(cls, ds: xr.Dataset) -> Sweep:
        """The sweep that a dataset was made by."""
        base = Scene.from_text(str(ds.attrs["scene_toml"]), "scene_toml")
        kept = str(ds.attrs["kept"]).split()
        keep = kept[-1] if kept[-1] != "samples" else f"samples={ds.sizes['normalised_time']}"
        table = tomllib.loads(str(ds.attrs["sweep_toml"]))
        over = table["over"]
        for path, given in over.items():
            if isinstance(given, Mapping) and "listed" in given:  # too many for sweep_toml
                array = ds[swept_name(path)]
                over[path] = [f"{value!r} {array.attrs.get('units', '')}" for value in array.values.tolist()]
        options = {key: table[key] for key in ("samples", "seed") if key in table}
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
        return tuple(dict.fromkeys(("summary", self.keep)))

    @cached_property
    def laws(self) -> tuple[str, ...]:
        """Names of the contact laws that may occur, in the order of the flags of `law`."""
        names: list[str] = []
        for number in self.occurring:
            contact = self.case(number).contact
            names += ["hertz", "big-alabo"] if contact.law == "auto" else [contact.law_name]
        return tuple(dict.fromkeys(names))

    @cached_property
    def accuracies(self) -> tuple[float | None, ...]:
        """What is asked of the impacts, each once; None where segments are."""
        return tuple(dict.fromkeys(self.case(number).solver.accuracy for number in self.occurring))

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """The rows of the schema's table for this sweep: swept quantities, then what is kept."""
        swept = tuple(axis.variable((axis.name,) if self.design == GRID else ("impact",)) for axis in self.axes)
        kept = [SWEEP, *(f"{SWEEP} {word}" for word in self.kept if f"{SWEEP} {word}" in TABLE)]
        return (*swept, *(variable.over(self.dims) for key in kept for variable in TABLE[key]))

    @property
    def bytes_a_row(self) -> int:
        """About what an impact takes in a file."""
        own = sum(v.dtype.itemsize for v in self.variables if v.dims == self.dims)
        lines = {"segments": LINES_GUESSED * native.LINE_DTYPE.itemsize, "samples": 8 * len(MOTION) * self.dense}
        return own + lines.get(self.keep, 0)

    def text(self) -> str:
        """The sweep file, but for the scene."""
        head = [f'design = "{self.design}"']
        if self.design in SAMPLED:
            head += [f"samples = {self.samples}", f"seed = {self.seed}"]
        return "\n".join([*head, "", "[over]", *(f'"{axis.path}" = {axis.text()}' for axis in self.axes), ""])

    # ---------------------------------------------------------------- blocks

    @cached_property
    def _layout(self) -> tuple[int, int, int]:
        """Axis that is cut, rows of it in a block, and blocks along it: later axes are whole, earlier ones single."""
        cases = (self.case(k) for k in self.occurring)
        rows = OWN_CURVES if any(edged(case) and not wide(case) for case in cases) else BLOCK_ROWS
        most = max(1, min(rows, BLOCK_BYTES // self.bytes_a_row))
        shape = self.shape
        cut = next((k for k in range(len(shape)) if math.prod(shape[k + 1 :]) <= most), len(shape) - 1)
        parts = -(-shape[cut] // max(1, most // math.prod(shape[cut + 1 :])))
        along = -(-shape[cut] // parts)
        return cut, along, -(-shape[cut] // along)

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        cut, _, parts = self._layout
        return math.prod(self.shape[:cut]) * parts

    @property
    def chunks(self) -> tuple[int, ...]:
        """Shape of a block."""
        cut, along, _ = self._layout
        return (*(1,) * cut, along, *self.shape[cut + 1 :])

    def block(self, number: int) -> Block:
        """One of the blocks; they follow each other in C order."""
        cut, along, parts = self._layout
        outer, part = divmod(number, parts)
        lead = np.unravel_index(outer, self.shape[:cut]) if cut else ()
        begin, end = part * along, min((part + 1) * along, self.shape[cut])
        inner = math.prod(self.shape[cut + 1 :])
        region = (*(slice(int(k), int(k) + 1) for k in lead), slice(begin, end), *map(slice, self.shape[cut + 1 :]))
        return Block(region, (outer * self.shape[cut] + begin) * inner, (end - begin) * inner)

    def values(self, first: int, count: int) -> list[NDArray[Any]]:
        """What each axis has for impacts first … first + count − 1, in C order: SI, or numbers of words."""
        if self.design in SAMPLED:
            u = points(self.design, len(self.axes), self.samples, self.seed)(first, count)
            return [axis.quantile(u[:, k]) for k, axis in enumerate(self.axes)]
        flat = np.arange(first, first + count)
        places = np.unravel_index(flat, self.shape) if self.design == GRID else [flat] * len(self.axes)
        return [axis.at(place) for axis, place in zip(self.axes, places, strict=True)]

    # ---------------------------------------------------------------- cases: the scenes between which words choose

    @property
    def _word_axes(self) -> list[Axis]:
        return [axis for axis in self.axes if axis.kind == "words"]

    @property
    def cases(self) -> int:
        """Number of combinations of words."""
        return math.prod(len(axis.words) for axis in self._word_axes)

    @cached_property
    def occurring(self) -> Sequence[int]:
        """Numbers of the combinations that the design may have: those of its rows where lists go side by side."""
        axes = self._word_axes
        if self.design != ZIP or not axes:
            return range(self.cases)
        return np.unique(np.ravel_multi_index([axis.places for axis in axes], [len(a.words) for a in axes])).tolist()

    @cached_property
    def _scenes(self) -> dict[int, Scene]:
        return {}

    def case(self, number: int) -> Scene:
        """The scene of a combination of words."""
        if number not in self._scenes:
            axes = self._word_axes
            places = np.unravel_index(number, [len(axis.words) for axis in axes]) if axes else ()
            changes = {axis.path: axis.words[int(place)] for axis, place in zip(axes, places, strict=True)}
            self._scenes[number] = self.first.replace(changes) if changes else self.scene
        return self._scenes[number]

    def scene_of(self, row: int) -> Scene | None:
        """The scene of one impact, by its place in C order; None where a value is out of range."""
        case, numbers = 0, dict[str, Any]()
        for axis, value in zip(self.axes, self.values(row, 1), strict=True):
            if axis.kind == "words":
                case = case * len(axis.words) + int(value[0])
            elif axis.outside(value)[0]:
                return None
            else:
                numbers[axis.path] = float(value[0])
        return scene_of_columns(self.case(case), numbers)

    def _check_numbers(self) -> None:
        """Refuse a sweep whose numbers make no scene at all; a number that fails here and there fails in its row."""
        numbers = [axis for axis in self.axes if axis.kind != "words"]
        ends = [
            ((a.numbers[0],) if a.kind in ("normal", "lognormal") else (a.numbers[0], a.numbers[-1])) for a in numbers
        ]
        for number in self.occurring:
            first = None
            for corner in itertools.islice(itertools.product(*ends), MOST_CORNERS):
                pairs = zip(numbers, corner, strict=True)
                changes = {axis.path: f"{v!r} {axis.unit}" if axis.unit else v for axis, v in pairs}
                try:
                    self.case(number).replace(changes)
                    break
                except SceneError as error:
                    first = first or error
            else:
                assert first is not None
                raise SceneError(swept_mistakes(first, [axis.path for axis in self._word_axes]))

    # ---------------------------------------------------------------- columns

    def compute(self, number: int) -> dict[str, NDArray[Any]]:
        """The columns of a block by the names of variables, in C order; `estimated` and `gained` go beside them.

        `estimated`: the largest for each of `accuracies`. `gained`: impacts of each law that return more energy than
        their loading stored.
        """
        _, first, count = self.block(number)
        values = self.values(first, count)
        columns = self._empty(count)
        if self.design != GRID:
            columns |= {axis.name: value for axis, value in zip(self.axes, values, strict=True)}
        case = np.zeros(count, np.int64)
        sound = np.ones(count, np.bool_)
        numbers: dict[str, NDArray[Any]] = {}
        for place, (axis, value) in enumerate(zip(self.axes, values, strict=True)):
            if axis.kind == "words":
                case = case * len(axis.words) + value
            else:
                numbers[axis.path] = value
                outside = axis.outside(value) & sound
                columns["status"][outside] = REFUSED + place
                sound &= ~outside
        lines: dict[int, NDArray[Any]] = {}
        there = np.flatnonzero(np.bincount(case)) if self.cases <= MOST_CASES else np.unique(case)
        for number in there.tolist():
            rows = np.flatnonzero((case == number) & sound) if self.cases > 1 or not sound.all() else np.arange(count)
            if rows.size:
                self._fill(columns, lines, self.case(number), rows, numbers)
        if self.keep == "segments":
            columns |= _segment_columns(lines, count)
        return columns

    def _empty(self, count: int) -> dict[str, NDArray[Any]]:
        columns: dict[str, NDArray[Any]] = {
            "estimated": np.zeros(len(self.accuracies)),
            "gained": np.zeros(len(self.laws), np.int64),
        }
        for variable in self.variables[len(self.axes) :]:
            if variable.dims[: len(self.dims)] == self.dims:
                shape = (count, self.dense) if "normalised_time" in variable.dims else (count,)
                columns[variable.name] = np.full(shape, np.nan if variable.optional else 0, variable.dtype)
        columns["status"][:] = NO_VELOCITY
        columns["law"][:] = -1
        return columns

    def _fill(
        self,
        columns: dict[str, NDArray[Any]],
        lines: dict[int, NDArray[Any]],
        scene: Scene,
        rows: NDArray[np.intp],
        numbers: Mapping[str, NDArray[Any]],
    ) -> None:
        """Simulate some rows of a block and put what they did into its columns and lines."""
        picked = {path: value[rows] for path, value in numbers.items()}
        if not picked:
            picked = {"impactor.velocity": np.full(rows.size, scene.impactor.speed)}
        result = simulate_rows(scene, picked)
        for name, column in result.summary.items():
            columns[name][rows] = column
        columns["status"][rows] = result.status
        asked = self.accuracies.index(scene.solver.accuracy)
        columns["estimated"][asked] = max(columns["estimated"][asked], result.estimated)
        for part in result.parts:
            own, law = rows[part.index], self.laws.index(part.law)
            columns["law"][own] = law
            columns["zener_number"][own] = part.zener
            energy = 0.5 * part.mass * (part.start["nu"] * part.scales.velocity) ** 2
            columns["gained"][law] += np.count_nonzero(result.summary["energy_absorbed"][part.index] < -1e-9 * energy)
            if self.keep != "summary":
                self._histories(columns, lines, scene, result, part, own)

    def _histories(
        self,
        columns: dict[str, NDArray[Any]],
        lines: dict[int, NDArray[Any]],
        scene: Scene,
        result: RowResult,
        part: Rows,
        own: NDArray[np.intp],
    ) -> None:
        """The segments of the rows `own`, or samples of them."""
        counts = tuple(result.segments[part.index[0]].tolist())
        room = (counts[0] + 2) * (part.curve.native.stages + 1) + counts[1] + 64
        found = native.record_many(part.curve.native, mesh_of(scene.solver, counts), part.start, room)
        if self.keep == "segments":
            lines.update(zip(own.tolist(), found, strict=True))
            units = {f"scale_{name}": value for name, value in vars(part.scales).items()}
            units.update(drift_velocity=part.drift, impactor_share=part.share)
            for name, value in {**units, "target_compliance": part.curve.native.compliance}.items():
                columns[name][own] = value
            return
        duration = result.summary["contact_duration"][part.index]
        ended = np.flatnonzero(np.isfinite(duration))
        scales = type(part.scales)(*(value[ended, None] for value in vars(part.scales).values()))
        t = np.linspace(0.0, 1.0, self.dense) * duration[ended, None]
        values = np.empty((*t.shape, 5))
        for k, row in enumerate(ended.tolist()):
            values[k] = native.sample(part.curve.native, found[row], t[k] / scales.time[k])[0]
        drift, share = part.drift[ended, None], part.share[ended, None]
        motion = motion_of(scales, drift, share, bool((share < 1.0).any()), t, values)
        for name in MOTION:
            columns[f"sampled_{name}"][own[ended]] = motion[name]


def _segment_columns(lines: Mapping[int, NDArray[Any]], count: int) -> dict[str, NDArray[Any]]:
    none = np.empty(0, native.LINE_DTYPE)
    each = [lines.get(row, none) for row in range(count)]
    whole = np.concatenate(each)
    counts = np.array([one.size for one in each], np.int32)
    return {"segment_count": counts, **{f"segment_{name}": whole[name] for name in native.LINE_DTYPE.names or ()}}


def _option_mistakes(design: object, samples: object, seed: object) -> list[Mistake]:
    found: dict[str, str] = {}
    if design not in DESIGNS:
        words = ", ".join(f'"{word}"' for word in DESIGNS)
        hint = did_you_mean(design, DESIGNS) if isinstance(design, str) else ""
        found["design"] = f"{shown(design)} is not allowed: one of {words} is needed{hint}"
    elif design not in SAMPLED:
        given = [key for key, value in (("samples", samples), ("seed", seed)) if value is not None]
        found |= {key: f'is not for design "{design}"' for key in given}
    else:
        most = MOST_SAMPLES[str(design)]
        if samples is None:
            found["samples"] = f'missing: design "{design}" needs the number of impacts'
        elif isinstance(samples, bool) or not isinstance(samples, int) or not 1 <= samples <= most:
            found["samples"] = f"{shown(samples)} is not allowed: a whole number from 1 to {most} is needed"
        if seed is not None and (isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64):
            found["seed"] = f"{shown(seed)} is not allowed: a whole number from 0 to 2^64 - 1 is needed"
    return [Mistake(None, None, key, message) for key, message in found.items()]


def _read_keep(keep: str) -> tuple[str, int]:
    """What is kept, and the number of dense samples."""
    word, _, number = keep.partition("=")
    if word == "samples" and number.isascii() and number.isdigit() and 2 <= int(number) <= 1_000_000:
        return word, int(number)
    if keep in ("summary", "segments"):
        return keep, 0
    message = f"{shown(keep)} is not allowed: summary, segments or samples=201 is needed"
    raise SceneError([Mistake(None, None, "keep", message)])


def _meant(key: str) -> str:
    """The key of a sweep file that was probably meant."""
    return next(iter(difflib.get_close_matches(key, KEYS, 1)), key)


def _table_mistakes(given: Mapping[str, Any], table: Mapping[str, Any]) -> list[Mistake]:
    """What is wrong with the keys of a sweep file themselves; `table` has them as they were meant, too."""
    mistakes = [Mistake(None, None, key, f"unknown key{did_you_mean(key, KEYS)}") for key in given if key not in KEYS]
    for key, kind, what in (("scene", str, "the name of a scene file"), ("over", Mapping, "a section [over]")):
        if key not in table:
            mistakes.append(Mistake(None, None, key, f"missing: {what} is needed"))
        elif not isinstance(table[key], kind):
            mistakes.append(Mistake(None, None, key, f"{shown(table[key])} is not allowed: {what} is needed"))
    return mistakes


def _flat(table: Mapping[str, Any], head: str = "") -> dict[str, Any]:
    """Tables inside tables, as unquoted keys with dots make them, by their paths."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        plain = not isinstance(value, Mapping) or "." in key or any(k in (*RANGE, *DISTRIBUTIONS) for k in value)
        flat |= {head + key: value} if plain else _flat(value, f"{head}{key}.")
    return flat


def _line(lines: Mapping[str, int], key: str, over: Mapping[str, Any]) -> int | None:
    """The line of a key; those of `over` are quoted in the file."""
    for path in over:
        if key == f"over.{path}" or key.startswith(f"over.{path}."):
            return lines.get(f'over."{path}"') or line_of(lines, key)
    return line_of(lines, key)
