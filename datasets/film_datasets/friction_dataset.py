"""The friction of one impact as variables of a dataset, and back."""

from __future__ import annotations

import math
from typing import Any

from film_datasets.schema import HISTORY, TABLE, has, require
from film_model.base.foreign import Dataset
from film_model.oblique.result import BOUNDS, KINDS, MOTION, OBLIQUE, REGIMES, RESULTS, Oblique

REGIME, ERROR = "sliding_regime", "estimated_friction_error"


def friction_columns(oblique: Oblique | None) -> dict[str, Any]:
    """The columns of friction; none without it."""
    if oblique is None:
        return {}
    known = {**oblique.summary, **oblique.bounds}
    return {
        **{name: known.get(name, math.nan) for name in RESULTS},
        REGIME: REGIMES.index(oblique.sliding_regime),
        ERROR: oblique.estimated,
        **{_own(name): values for name, values in oblique.motion.items()},
        "friction_event_time": [time for time, _ in oblique.events],
        "friction_event_kind": [KINDS.index(kind) for _, kind in oblique.events],
    }


def read_friction(ds: Dataset) -> Oblique | None:
    """The tangential part of the impact of a dataset; None without it. Raises ValueError if a variable is missing."""
    if not has(ds, "friction"):
        return None
    require(ds, (variable.name for variable in TABLE[f"{HISTORY} friction"]))
    values = {name: float(ds[name]) for name in OBLIQUE}
    summary = {name: value for name, value in values.items() if not (name.startswith("target_") and math.isnan(value))}
    times, kinds = (ds[f"friction_event_{name}"].values.tolist() for name in ("time", "kind"))
    events = tuple((time, KINDS[kind]) for time, kind in zip(times, kinds, strict=True))
    motion = {name: ds[_own(name)].values for name in MOTION}
    low, high = (None if math.isnan(value := float(ds[name])) else value for name in BOUNDS)
    return Oblique(summary, REGIMES[int(ds[REGIME])], events, motion, float(ds[ERROR]), low, high)


def _own(name: str) -> str:
    return "friction_time" if name == "time" else name
