"""Writes the suite of reference impacts: a folder of plain files for each case, the same bytes in every run."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import shutil
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from film_datasets.conversion import to_dataset
from film_datasets.reference_impacts.cases import Case, cases, chain_of, scene_of
from film_datasets.reference_impacts.second import Second, second, second_bounces, second_chain, second_friction
from film_datasets.tables import to_frame
from film_model.base.errors import did_you_mean
from film_model.base.foreign import DataFrame
from film_model.base.units import scene_unit, si_unit
from film_model.effects.choose import problem_of
from film_model.laws.law import AbstractLaw
from film_model.oblique.result import OBLIQUE
from film_model.problem.problem import Problem
from film_model.problem.summary import SUMMARY
from film_model.solve.bounce import COLUMNS, Bounces, bounce_quietly
from film_model.solve.chain_motion import BODIES, CONTACTS, FINEST, ChainMotion, simulate_chain_quietly
from film_model.solve.component import ImpactComponent
from film_model.solve.history import MOTION, History
from film_model.solve.simulate import simulate_quietly

FILES = Path(__file__).parent / "files"
"""Files of the whole suite: its description, licence, metadata, and the schema of summary.json."""

DIGITS = 10
"""Most digits of a value."""

BOUNCES = 4
"""Bounces of a bouncing case."""


class Value(NamedTuple):
    """A value, SI, with its unit, the bound of its error, and its difference to the second computation."""

    value: float
    unit: str
    bound: float
    difference: float

    def to_dict(self) -> dict[str, Any]:
        """For JSON. digits: that the bound certifies, at most `DIGITS`; the value is rounded to them."""
        digits = DIGITS if not self.bound else math.floor(math.log10(max(abs(self.value), 1e-300) / (2.0 * self.bound)))
        digits = min(max(digits, 0), DIGITS)
        return {
            "value": float(f"{self.value:.{max(digits, 1)}g}"),
            "units": self.unit,
            "digits": digits,
            "error_bound": float(f"{self.bound:.2g}"),
            "difference": float(f"{self.difference:.1g}"),
        }


class Computed(NamedTuple):
    """A case that is computed. motion: its history, its bounces, or that of a chain, whose problem is that of the first
    contact. how, second: in words."""

    case: Case
    problem: Problem
    motion: History | Bounces | ChainMotion
    how: str
    second: str
    values: Mapping[str, Value]

    def to_dict(self) -> dict[str, Any]:
        """summary.json."""
        motion, problem = self.motion, self.problem
        outcome = motion.outcome.value if isinstance(motion, History) else motion.outcome
        return {
            "case": self.case.name,
            "group": self.case.group,
            "law": _law(problem.law),
            "effective_mass": problem.mass,
            "target_impedance": None if math.isinf(problem.given.impedance) else problem.given.impedance,
            "load": problem.load * problem.scales.force,
            "outcome": outcome,
            "how": self.how,
            "second": self.second,
            "values": {name: value.to_dict() for name, value in self.values.items()},
        }


def _law(law: AbstractLaw) -> dict[str, Any]:
    """Name, source and parameters; of a rule of unloading, a parameter is the law that it unloads."""
    own = {field.name: getattr(law, field.name) for field in fields(cast("Any", law))}
    values = {name: _law(value) if isinstance(value, AbstractLaw) else value for name, value in own.items()}
    return {"name": law.name, "source": law.source, "parameters": values}


def compute(case: Case) -> Computed:
    """A case by the march and by its second computation."""
    if case.group == "chain":
        return _chain(case)
    scene = scene_of(case)
    history = simulate_quietly(scene)
    if case.group == "bouncing":
        return _bounces(case, history)
    again = second(history)
    values = _compared(history.summary, again, history.accuracy.estimated, history, SUMMARY)
    how, ways = f"{_march(history)}, accuracy {case.accuracy:g}", again.how
    if history.oblique is not None:
        slid = second_friction(history)
        values |= _compared(history.oblique.summary, slid, 0.0, history, OBLIQUE)
        ways = f"{ways}; {slid.how}"
    return Computed(case, history.problem, history, how, ways, values)


def _march(history: History) -> str:
    if history.vibration is not None:
        return f"{history.accuracy.modes} natural vibrations in closed form, contact by steps of degree 7"
    if history.relaxed is not None:
        return f"collocation in {history.accuracy.lines} steps"
    return f"{history.accuracy.lines} segments in closed form"


def _compared(
    found: Mapping[str, float | None], again: Second, estimated: float, history: History,
    table: Mapping[str, tuple[str, str]],
) -> dict[str, Value]:  # fmt: skip
    """Each value that both computations have. The bound is the sum of both errors."""
    approach, deepest = history.scene.approach_velocity, history.summary["maximum_indentation"] or 0.0
    # The error of a velocity or length is relative to at least this part of the approach velocity or the indentation;
    # that of a velocity on a free body, which may be a difference of large ones, to the approach velocity
    part = 1e-3
    least = {"length": part * deepest, "velocity": approach * (1.0 if history.problem.free else part)}
    values = dict[str, Value]()
    for name, other in again.values.items():
        own, dimension = found[name], table[name][0]
        if own is None:
            continue
        size = max(abs(own), least.get(dimension, part if dimension == "dimensionless" else 0.0))
        bound = again.errors[name] if again.errors else (estimated + again.error) * size
        values[name] = Value(own, si_unit(dimension), bound, abs(own - other))
    return values


def _bounces(case: Case, history: History) -> Computed:
    """The bound of a bounce is twice the change by a hundredfold accuracy, and the error of the second computation."""
    made, coarse = (bounce_quietly(history.scene, accuracy=factor * case.accuracy) for factor in (1.0, 1e2))
    again = second_bounces(history.scene, history.problem, BOUNCES)
    values = dict[str, Value]()
    for name, other in again.values.items():
        _, number, column = name.split("_", 2)
        own, less = (float(one.column(column)[int(number) - 1]) for one in (made, coarse))
        bound = 2.0 * abs(own - less) + again.error * abs(own)
        values[name] = Value(own, si_unit(COLUMNS[column][0]), bound, abs(own - other))
    how = f"component, accuracy {case.accuracy:g}, and flights in closed form"
    return Computed(case, history.problem, made, how, again.how, values)


def _chain(case: Case) -> Computed:
    """The bound is the sum of both errors; of times that of the second computation."""
    chain = chain_of(case)
    motion = simulate_chain_quietly(chain)
    again = second_chain(chain, motion.end)
    speed = max(abs(body.velocity) for body in chain.bodies)
    values = dict[str, Value]()
    for name, other in again.values.items():
        what, number = name.rsplit("_", 1)
        own, (dimension, _) = float(motion.values[what][int(number) - 1]), (BODIES | CONTACTS)[what]
        size = {"velocity": speed, "force": abs(own)}.get(dimension, 0.0)
        bound = motion.estimated * size + again.errors[name]
        values[name] = Value(own, si_unit(dimension), bound, abs(own - other))
    how = f"steps of order 8 that end at events, tolerance {FINEST:g}"
    return Computed(case, problem_of(chain.pairs(speed)[0]), motion, how, again.how, values)


def bouncing_motion(bounces: Bounces, accuracy: float, times: Any) -> dict[str, Any]:
    """The values of `MOTION` at ascending times [s] from the first touch on."""
    component = ImpactComponent(bounces.scene, accuracy=accuracy)
    component.initialize(time=bounces.bounces[0].time)
    rows = list[Any]()
    for time in times:
        component.step(max(time - component.time, 0.0))
        rows.append(component.outputs)
    return {name: np.array([getattr(row, name) for row in rows]) for name in MOTION}


def bouncing_times(bounces: Bounces) -> list[float]:
    """41 even times in each contact and 12 in each flight of the first bounces, s."""
    times = list[float]()
    for one, following in zip(bounces.bounces[:BOUNCES], bounces.bounces[1:], strict=False):
        end = one.time + (one.contact_duration or 0.0)
        times += [*np.linspace(one.time, end, 41), *np.linspace(end, following.time, 14)[1:-1]]
    return times


def _bouncing_table(bounces: Bounces, accuracy: float) -> DataFrame:
    """The motion of the first bounces, as a history's table."""
    import pandas as pd

    times = bouncing_times(bounces)
    motion = bouncing_motion(bounces, accuracy, times)
    heads = {name: f"{name} [{scene_unit(dimension)}]" for name, (dimension, _) in MOTION.items()}
    exact = [f"{time:.15g}" for time in times]  # a contact is short beside the time since the release
    return pd.DataFrame({"t [s]": exact, **{heads[name]: values for name, values in motion.items()}})


def chosen(names: Sequence[str] | None) -> list[Case]:
    """The cases of these names, or all. Raises ValueError for one that is not known."""
    known = cases()
    for name in names or ():
        if name not in known:
            raise ValueError(f'case "{name}" is not in the suite{did_you_mean(name, known)}')
    return [case for case in known.values() if not names or case.name in names]


def write_suite(
    folder: str | os.PathLike[str],
    names: Sequence[str] | None = None,
    workers: int = 1,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Write the suite, or the cases of these names, into a new or empty folder; returns the folders of the cases.

    The same bytes are written by any number of workers. Raises FileExistsError for a folder that has files, ValueError
    for an unknown name or fewer than one worker.

    >>> fd.write_suite("impacts", ["hertz-half-space-0.4"])
    [PosixPath('impacts/hertz-half-space-0.4')]
    """
    root, todo = Path(folder), chosen(names)
    if workers < 1:
        raise ValueError(f"workers: {workers} must be at least 1")
    if root.exists() and (not root.is_dir() or any(root.iterdir())):
        raise FileExistsError(f"{root}: exists and is not an empty folder")
    with _whole_folder(root) as beside:
        if workers == 1:
            names = _each(map(partial(_write_case, beside), todo), progress)
        else:
            with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
                names = _each(pool.map(partial(_write_case, beside), todo), progress)
        for file in sorted(FILES.iterdir()):
            shutil.copyfile(file, beside / ("." + file.name if file.name == "zenodo.json" else file.name))
        rows = (f"{one.name},{one.group},{one.scene['contact']['law']},{one.target}\n" for one in todo)
        _write(beside / "cases.csv", "case,group,law,target\n" + "".join(rows))
        made = sorted(path for path in beside.rglob("*") if path.is_file())
        sums = (
            hashlib.sha256(path.read_bytes()).hexdigest() + f"  {path.relative_to(beside).as_posix()}\n"
            for path in made
        )
        _write(beside / "SHA256SUMS", "".join(sums))
    return [root / name for name in names]


@contextlib.contextmanager
def _whole_folder(root: Path) -> Generator[Path]:
    """A new folder beside `root`, which it becomes if the block raises no exception: it is never written in part."""
    at = root.absolute()
    at.parent.mkdir(parents=True, exist_ok=True)
    beside = at.with_name(f".{at.name[:100]}.{os.urandom(4).hex()}.part")
    beside.mkdir()
    try:
        yield beside
        if at.exists():
            at.rmdir()
        beside.rename(at)
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _each(found: Any, progress: Callable[[str], None] | None) -> list[str]:
    names: list[str] = []
    for name in found:
        names.append(name)
        if progress is not None:
            progress(name)
    return names


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")


def _write_case(root: Path, case: Case) -> str:
    """The three files of a case; its name."""
    path, made = root / case.name, compute(case)
    path.mkdir()
    _write(path / "case.toml", (chain_of(case) if case.group == "chain" else scene_of(case)).to_toml())
    _write(path / "summary.json", json.dumps(made.to_dict(), indent=1, ensure_ascii=False, allow_nan=False) + "\n")
    motion = made.motion
    bounces = isinstance(motion, Bounces)
    table = _bouncing_table(motion, case.accuracy) if bounces else to_frame(to_dataset(motion, samples=201))
    _write(path / "reference.csv", table.to_csv(index=False, float_format=f"%.{DIGITS}g", lineterminator="\n"))
    return case.name
