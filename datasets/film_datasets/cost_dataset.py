"""A study of what accuracy costs in time as a dataset, and back: the runs of several methods on one scene."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from film_datasets.provenance import PROGRAM, choice_of, dataset_of, text_and_hash
from film_datasets.schema import COST, flag_words
from film_model.base.foreign import Dataset
from film_model.effects.choose import problem_of
from film_model.studies.cost import CostRun, Study
from film_model.studies.reference import COMPARED
from film_model.studies.timing import Timing


def cost_dataset(study: Study, command: str = "film-model cost") -> Dataset:
    """A study of a scene as a dataset of kind impact_cost_study, SI."""
    runs = study.runs
    methods = list(dict.fromkeys(run.method for run in runs))
    columns: dict[str, Any] = {
        "method": [methods.index(run.method) for run in runs],
        "outcome": [0 if run.errors else 1 for run in runs],
        "force_evaluations": [-1 if run.force_evaluations is None else run.force_evaluations for run in runs],
        "reference_error": study.reference["error"],
    }
    for way in ("single", "batch"):
        timings = [getattr(run, f"time_{way}") for run in runs]
        for what in ("median", "spread"):
            columns[f"{what}_time_{way}"] = [np.nan if t is None else getattr(t, what) for t in timings]
    for name in COMPARED:
        columns[f"error_{name}"] = [run.errors.get(name, np.nan) for run in runs]
        columns[f"reference_{name}"] = study.reference["values"][name]
    scene = study.scene
    about = {
        "title": f"{scene.title or 'Impact'}: what accuracy costs",
        "summary": f"Error against time of {len(methods)} methods for one impact (target: {scene.target.kind}, "
        f"contact law: {study.law}).",
        **{"source": f"{PROGRAM}, timings on one thread", "command": command},
        "comment": "Each run is one method at one setting; errors are relative to the reference values, which do not "
        "use the march. settings and outcomes have a line for each run.",
    }
    own = {
        **text_and_hash("scene", scene.archived_text()),
        "contact_law": str(problem_of(scene).law),
        "settings": "\n".join(f"{run.method}: {run.setting}" for run in runs),
        "outcomes": "\n".join(" ".join(run.outcome.split()) for run in runs),
        "reference_method": study.reference["method"],
        "machine": "\n".join(f"{key} {value}" for key, value in study.machine.items()),
    }
    return dataset_of(COST, columns, about, own, meanings={"methods": flag_words(methods)})


def study_of(ds: Dataset) -> Study:
    """The study that a dataset was made from. Raises ValueError if the contact law was an object of Python."""

    def value_or_none(name: str, run: int) -> float | None:
        value = float(ds[name][run])
        return None if math.isnan(value) else value

    def timing(way: str, run: int) -> Timing | None:
        found = [value_or_none(f"{what}_time_{way}", run) for what in Timing._fields]
        return None if found[0] is None else Timing(*(value or 0.0 for value in found))

    lines = zip(*(str(ds.attrs[name]).split("\n") for name in ("settings", "outcomes")), strict=True)
    runs: list[CostRun] = []
    for k, (line, outcome) in enumerate(lines):
        method, _, setting = line.partition(": ")
        errors = {name: value for name in COMPARED if (value := value_or_none(f"error_{name}", k)) is not None}
        count = int(ds["force_evaluations"][k])
        times = timing("single", k), timing("batch", k)
        runs.append(CostRun(method, setting, *times, None if count < 0 else count, errors, outcome))
    reference = {
        "method": str(ds.attrs["reference_method"]),
        "values": {name: float(ds[f"reference_{name}"]) for name in COMPARED},
        "error": float(ds["reference_error"]),
    }
    machine = dict(line.split(" ", 1) for line in str(ds.attrs["machine"]).split("\n"))
    choice = choice_of(ds)
    return Study(choice.scene, choice.problem.law.name, reference, tuple(runs), machine)
