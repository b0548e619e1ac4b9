"""Vibrations in meshes with vectors at their points: files of VTK, XDMF and MED, which meshio reads, and series of them
that a file of ParaView (.pvd) lists."""

from __future__ import annotations

import importlib
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import shown
from film_model.targets.result_modes import ROUNDED, ResultModes

SERIES = ".pvd"
FORMATS = {".vtu": "vtu", ".vtk": "vtk", ".xdmf": "xdmf", ".xmf": "xdmf", ".med": "med", ".rmed": "med"}
"""Modules of meshio that read files, by suffix."""

_STEP = re.compile(r"(.*)\[(\d+)\] - ([-+.\deE]+)")
"""Name that meshio gives a field of a MED file at one of several steps: the field, the step and its time, which is the
frequency in results of code_aster."""

_NUMBERED = re.compile(r"(.*?)(\d+)(\D*)")
"""Name of an array of one vibration: `displacement EigenMode3` of Elmer, `mode_3`, `u003` of SfePy."""

_Step = tuple[float, Array, Mapping[str, Any]]
"""Time, or nan; points; arrays at the points."""


class _Points(Mapping[int, Sequence[float]]):
    """Rows of an array by their number from 1; two or three columns, and others that are not displacements."""

    def __init__(self, rows: Array) -> None:
        self.rows = rows

    def __getitem__(self, number: int) -> Sequence[float]:
        if not 1 <= number <= len(self.rows):
            raise KeyError(number)
        return (*self.rows[number - 1, :3].tolist(), 0.0)[:3]

    def __iter__(self) -> Iterator[int]:
        return iter(range(1, len(self.rows) + 1))

    def __len__(self) -> int:
        return len(self.rows)


def read_mesh(path: Path, array: str | None) -> ResultModes:
    """Of a mesh with an array for each vibration, or of a series with one mesh for each; its nodes are points, from 1.

    array: the name of the arrays, without their number, where there are several. Frequencies are the times of the
    steps, unless these only count (0, 1, 2 or 1, 2, 3). Such files do not say how shapes are normalised. Raises
    ModuleNotFoundError without meshio.
    """
    try:
        steps = list(_steps(path))
    except (ModuleNotFoundError, FileNotFoundError):
        raise
    except Exception as error:  # what meshio raises for damaged files is not documented
        reason = str(error) or "it is damaged, or of another format"
        raise ValueError(f"{path} cannot be read as a mesh: {reason}") from None
    vectors = dict[str, dict[int, tuple[float, Array]]]()
    for k, (time, _, data) in enumerate(steps):
        for name, values in data.items():
            rows = np.asarray(values)
            if rows.dtype.kind != "f" or rows.ndim != 2 or rows.shape[1] < 2:
                continue
            stem, number, at = name, k, time
            if len(steps) == 1 and (match := _STEP.fullmatch(name)):
                stem, number, at = match[1], int(match[2]), float(match[3])
            elif len(steps) == 1 and (match := _NUMBERED.fullmatch(name)):
                stem, number = match[1] + match[3], int(match[2])
            vectors.setdefault(stem, {})[number] = at, rows
    found = ResultModes(normalised=False, places=_Points(steps[0][1]) if steps else {})
    several = {name: own for name, own in vectors.items() if len(own) > 1} or vectors
    names = [name for name in several if array in (None, name)]
    if len(names) != 1:
        has = ", ".join(map(shown, several)) or "none"
        if several and array is None:
            raise ValueError(f"{path} has several vectors at its points: give --array, one of {has}")
        raise ValueError(
            f"{path} has no vectors {'' if array is None else shown(array) + ' '}at its points; it has {has}"
        )
    vibrations = sorted(several[names[0]].items())
    times = [time for _, (time, _) in vibrations]
    counted = times in ([float(k + first) for k in range(len(times))] for first in (0, 1))
    found.unit = all(abs(np.nanmax(np.abs(rows), initial=0.0) - 1.0) < ROUNDED for _, (_, rows) in vibrations)
    for number, (_, (time, rows)) in enumerate(vibrations, 1):
        found.add(path, number, math.nan if counted else time)
        found.shape[number] = _Points(rows)
    return found


def _steps(path: Path) -> Iterator[_Step]:
    """The meshes of a file or series."""
    if path.suffix.lower() == SERIES:
        for entry in ElementTree.parse(path).getroot().iter("DataSet"):
            if entry.get("part", "0") != "0":
                raise ValueError("it lists meshes in parts, whole ones are needed")
            for _, points, data in _steps(path.parent / entry.attrib["file"]):
                yield float(entry.attrib["timestep"]), points, data
        return
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"files {path.suffix} in it are not read")
    meshio: Any = importlib.import_module("meshio")
    name = FORMATS[path.suffix.lower()]
    if name == "xdmf":
        try:
            with meshio.xdmf.TimeSeriesReader(path) as series:
                points, _ = series.read_points_cells()
                for k in range(series.num_steps):
                    time, data, _ = series.read_data(k)
                    yield time, points, data
            return
        except meshio.ReadError:  # not a series
            pass
    mesh = getattr(meshio, name).read(str(path))
    yield math.nan, mesh.points, mesh.point_data
