"""The score of another code: its histories beside the exact motion of the reference impacts."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from film_datasets.csv_measurement import csv_rows, from_csv, values_of
from film_datasets.reference_impacts.cases import Case, chain_of, scene_of
from film_datasets.reference_impacts.suite import bouncing_motion, bouncing_times, chosen
from film_datasets.schema import CHAIN, TABLE
from film_model.base.errors import Mistake, SceneError
from film_model.solve.bounce import bounce_quietly
from film_model.solve.chain_motion import simulate_chain_quietly
from film_model.solve.history import MOTION, History
from film_model.solve.simulate import simulate_quietly


@dataclass(frozen=True)
class Score:
    """Errors of one history. errors: by quantity, relative. Of a quantity over time the largest difference at the given
    times over the largest value of the reference; of a summary value over that value."""

    case: str
    rows: int
    errors: Mapping[str, float]


def score(path: str | os.PathLike[str], case: str | None = None) -> list[Score]:
    """Compare histories with the reference impacts.

    path: a file CASE.csv, or a folder of them. Columns as in `reference.csv`, of which `time` and one more are needed,
    with any units: `time [us], contact_force [kN]`; cells may be empty, except times and impactor_velocity. The
    reference is evaluated at the times of the file, so that nothing is interpolated. From the columns follow the errors
    of maximum_force, maximum_indentation, contact_duration (the last time with a force), rebound_velocity (the last
    impactor_velocity) and coefficient_of_restitution (the last relative_velocity). Columns of a chain have the number
    of a body or contact: `velocity_2 [m/s], contact_force_1 [N]`. An error is then the largest of all bodies or
    contacts, over the largest value of them; from the columns follow maximum_force and final_velocity (the last
    velocities). case: the name, of a file that is called otherwise.

    Raises SceneError for wrong columns, units or numbers, ValueError for an unknown case, OSError for a file that
    cannot be read.

    >>> fd.score("hertz-half-space-0.4.csv")[0].rows
    3
    """
    given = Path(path)
    files = sorted(given.glob("*.csv")) if given.is_dir() else [given]
    if not files:
        raise ValueError(f"{given}: has no files CASE.csv")
    if case is not None and given.is_dir():
        raise ValueError(f"case: names the case of one file, and {given} is a folder")
    return [_score(file, case or file.stem) for file in files]


def _score(file: Path, name: str) -> Score:
    case = chosen([name])[0]
    if case.group == "chain":
        return _score_of_chain(file, case)
    measured = from_csv(file)
    if measured.attrs["measured"] != "history":
        raise SceneError([Mistake(str(file), None, "", 'a column "time" is needed: these are impacts, not a history')])
    times = measured["t"].values
    first, exact, even, history = _reference(case)
    if times[0] < first:
        why = f"time {times[0]:g} s is before first touch, which is {first:g} s"
        raise SceneError([Mistake(str(file), None, "", why)])
    own, largest = exact(times), exact(even)
    errors = dict[str, float]()
    columns = {name: measured[name].values for name in MOTION if name in measured}
    for name, values in columns.items():
        size = float(np.abs(largest[name]).max())
        errors[name] = float(np.nanmax(np.abs(values - own[name]))) / size if size else float(np.nan)
    results = {} if history is None else _summary_errors(history, times, columns)
    return Score(case.name, times.size, errors | results)


def _reference(case: Case) -> tuple[float, Callable[[Any], Mapping[str, Any]], Any, History | None]:
    """The time of first touch [s], the motion at given times, times for its largest values, and the history, which a
    bouncing case does not have."""
    scene = scene_of(case)
    if case.group == "bouncing":
        bounces = bounce_quietly(scene, accuracy=case.accuracy)
        return bounces.bounces[0].time, partial(bouncing_motion, bounces, case.accuracy), bouncing_times(bounces), None
    history = simulate_quietly(scene)

    def exact(times: Any) -> Mapping[str, Any]:
        seen = history.sample_si(times)
        return {name: getattr(seen, name) for name in MOTION}

    return 0.0, exact, np.linspace(0.0, history.duration, 401), history


def _summary_errors(history: History, times: Any, columns: Mapping[str, Any]) -> dict[str, float]:
    """Errors of the values that follow from the columns."""
    found = dict[str, float]()
    if "contact_force" in columns:
        force = columns["contact_force"]
        found["maximum_force"] = float(np.nanmax(force))
        found["contact_duration"] = float(times[np.flatnonzero(force > 0.0)[-1]]) if (force > 0.0).any() else 0.0
    if "indentation" in columns:
        found["maximum_indentation"] = float(np.nanmax(columns["indentation"]))
    if "relative_velocity" in columns:
        found["coefficient_of_restitution"] = -float(columns["relative_velocity"][-1]) / history.scene.approach_velocity
    if "impactor_velocity" in columns:
        found["rebound_velocity"] = float(columns["impactor_velocity"][-1])
    pairs = ((name, value, history.summary[name]) for name, value in found.items())
    return {name: abs(value / own - 1.0) for name, value, own in pairs if own}


def _score_of_chain(file: Path, case: Case) -> Score:
    motion = simulate_chain_quietly(chain_of(case))
    sizes = {"body": len(motion.chain.row), "contact": len(motion.chain.links)}
    known = {"t": next(v for v in TABLE[CHAIN] if v.name == "t")} | {
        f"{v.name}_{number}": v for v in TABLE[CHAIN] if len(v.dims) == 2 for number in range(1, sizes[v.dims[0]] + 1)
    }
    values = values_of(csv_rows(file), known)
    times = values.pop("t")
    if times[0] < 0.0:
        raise SceneError([Mistake(str(file), None, "", f"time {times[0]:g} s is before the start, which is 0 s")])
    own, largest = (motion.sample_si(at) for at in (times, np.linspace(*motion.span, 401)))
    errors = dict[str, float]()
    for name, column in values.items():
        what, number = name.rsplit("_", 1)
        size = float(np.abs(largest[what]).max())
        error = float(np.nanmax(np.abs(column - own[what][int(number) - 1]))) / size
        errors[what] = max(error, errors.get(what, 0.0))
        ends = {"velocity": ("final_velocity", column[-1]), "contact_force": ("maximum_force", np.nanmax(column))}
        if what in ends:
            result, found = ends[what]
            exact = motion.values["largest_force" if what == "contact_force" else result]
            error = abs(float(found) - float(exact[int(number) - 1])) / float(np.abs(exact).max())
            errors[result] = max(error, errors.get(result, 0.0))
    return Score(case.name, times.size, errors)


def by_quantity(scores: list[Score]) -> dict[str, dict[str, Any]]:
    """Number of cases, median and largest error of each quantity, and the case of the largest."""
    found = dict[str, Any]()
    for name in dict.fromkeys(name for one in scores for name in one.errors):
        pairs = [(one.errors[name], one.case) for one in scores if name in one.errors]
        values, worst = [error for error, _ in pairs], max(pairs)
        found[name] = {"cases": len(pairs), "median": float(np.median(values)), "largest": worst[0], "case": worst[1]}
    return found


def text_of(scores: list[Score]) -> str:
    """The errors in a table: a row for each quantity, then one for each case."""
    lines = [f"{'quantity':24}{'cases':>6}{'median':>10}{'largest':>10}  in case"]
    for name, row in by_quantity(scores).items():
        lines.append(f"{name:24}{row['cases']:>6}{row['median']:>10.1e}{row['largest']:>10.1e}  {row['case']}")
    width = max(len(one.case) for one in scores) + 2
    lines += ["", f"{'case':{width}}{'rows':>7}{'largest error':>15}  of"]
    for one in scores:
        worst = max(one.errors, key=lambda name: one.errors[name])
        lines.append(f"{one.case:{width}}{one.rows:>7}{one.errors[worst]:>15.1e}  {worst}")
    return "\n".join(lines)
