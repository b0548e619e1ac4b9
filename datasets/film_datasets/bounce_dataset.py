"""All bounces of a ball as a dataset, and back."""

from __future__ import annotations

import math

from film_datasets.provenance import PROGRAM, as_lines, choice_of, dataset_of, text_and_hash, warnings_of
from film_datasets.schema import BOUNCES, TABLE
from film_model.base.foreign import Dataset
from film_model.effects.choose import problem_of
from film_model.solve.bounce import Bounce, Bounces


def bounce_dataset(bounces: Bounces, command: str = "film-model bounce") -> Dataset:
    """The bounces of a ball as a dataset of kind impact_bounces, SI."""
    scene = bounces.scene
    about = {
        "title": f"{scene.title or 'Impact'}: bounces",
        "summary": f"{len(bounces.bounces)} bounces of a ball under gravity (target: {scene.target.kind}, contact "
        f"law: {bounces.law}): {bounces.outcome}.",
        **{"source": PROGRAM, "command": command},
        "comment": "rest_time: first touch of the last bounce, s; NaN if the ball does not come to rest.",
    }
    own = {
        **text_and_hash("scene", scene.archived_text()),
        "contact_law": str(problem_of(scene).law),
        "outcome": bounces.outcome,
        "rest_time": math.nan if bounces.rest_time is None else bounces.rest_time,
        "warnings": as_lines(bounces.warnings),
    }
    return dataset_of(BOUNCES, {v.name: bounces.column(v.name) for v in TABLE[BOUNCES]}, about, own)


def bounces_of(ds: Dataset) -> Bounces:
    """The bounces that a dataset was made from. Raises ValueError if the contact law was an object of Python."""
    rows = zip(*(ds[name].values.tolist() for name in Bounce._fields), strict=True)
    found = (Bounce(*values[:5], *(None if x != x else x for x in values[5:])) for values in rows)
    choice, outcome, rest = choice_of(ds), str(ds.attrs["outcome"]), float(ds.attrs["rest_time"])
    rests = None if math.isnan(rest) else rest
    return Bounces(choice.scene, choice.problem.law.name, tuple(found), outcome, rests, warnings_of(ds))
