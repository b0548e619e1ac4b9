"""The tables of variables and attributes of our datasets; the variables are in `variables.csv`.

Kinds: the history of one impact, all bounces of a ball, a chain of bodies, a sweep over many impacts, a measurement to
compare with, and the cost of accuracy.
A new value in `film_model.solve.history.SUMMARY` gets its variables by itself; it needs a new version in `ADDED`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from film_datasets.schema.derivative_variables import derivatives_in
from film_datasets.schema.rows import OUT_OF_RANGE, PARTS
from film_datasets.schema.sensor_variables import FORCE_INTERVAL, peaks_in
from film_datasets.schema.variable import Variable, swept_name, swept_variables
from film_model.base.arrays import Mask
from film_model.base.foreign import Dataset
from film_model.oblique.result import BOUNDS, OBLIQUE

HISTORY, SWEEP, MEASUREMENT, COST = "impact_history", "impact_sweep", "impact_measurement", "impact_cost_study"
BOUNCES, CHAIN = "impact_bounces", "impact_chain"
_STRESSES = (
    *("impulse", "contact_radius", "dent_diameter", "mean_pressure", "peak_pressure", "maximum_shear_stress"),
    *("maximum_von_mises_stress", "depth_of_maximum_stress"),
)


def _of_one(*parts: str) -> tuple[Variable, ...]:
    """The variables of parts for one impact."""
    return tuple(variable.over(()) for part in parts for variable in PARTS[part])


_UNITS = tuple(replace(variable, optional=True) for variable in PARTS["segment units"])

TABLE: dict[str, tuple[Variable, ...]] = {
    HISTORY: _of_one("history", "summary", "segment units", "segments"),
    f"{HISTORY} steps": _of_one("steps", "mode energy"),
    f"{HISTORY} friction": _of_one("friction", "friction in histories"),
    **{f"{HISTORY} {part}": PARTS[part] for part in ("contacts", "sliding", "sensors", "strains")},
    SWEEP: (*PARTS["summary"], *PARTS["sweep"]),
    f"{SWEEP} segments": (*PARTS["segment places"], *_UNITS, *PARTS["segments"]),
    f"{SWEEP} steps": (*PARTS["step places"], *PARTS["steps"]),
    **{f"{SWEEP} {part}": PARTS[part] for part in ("friction", "samples")},
    **{f"{MEASUREMENT} {kind}": PARTS[f"measured {kind}"] for kind in ("history", "impacts", "values")},
    f"{MEASUREMENT} finite_elements": PARTS["finite elements"],
    f"{MEASUREMENT} finite_element_pairs": PARTS["finite element pairs"],
    **{BOUNCES: PARTS["bounces"], CHAIN: PARTS["chain"], COST: PARTS["cost"]},
}
"""Variables by the kind of dataset and what is kept in it, in the order in which `content_sha256` reads them."""

CONSTANTS = PARTS["constants"]
"""Values of the scene that a dataset has if they are known and, in a sweep, the same for all impacts."""

SCENE_KEY = next(variable for variable in PARTS["sweep"] if variable.name == "scene_key")

CHOOSABLE = tuple(v.name for key in (SWEEP, f"{SWEEP} friction") for v in TABLE[key] if v.optional)
"""The variables of which a sweep may keep some only; the others say how each impact ended and to what it belongs."""

MEASURED_CONDITIONS = ("impactor_velocity", "impactor_angle", "impactor_spin")
"""Variables of measured impacts that are given, not measured; the first is always there."""


def _names(*keys: str) -> tuple[str, ...]:
    """The names of the variables of `TABLE` at some keys."""
    return tuple(variable.name for key in keys for variable in TABLE[key])


ADDED: dict[str, dict[str, tuple[str, ...]]] = {
    HISTORY: {
        **{"1.1": (), "1.2": _STRESSES, "1.3": ()},
        "1.4": (*_names(f"{SWEEP} steps"), "mode_energy"),
        "1.5": _names(*(f"{HISTORY} {part}" for part in ("friction", "contacts", "sliding"))),
        "1.6": _names(f"{HISTORY} sensors"),
        "1.7": _names(f"{HISTORY} strains"),
    },
    SWEEP: {
        "1.0": (),
        "1.1": ("estimated_accuracy", *_STRESSES),
        "1.2": ("scene_key",),
        **{"1.3": (), "1.4": (), "1.5": _names(f"{SWEEP} steps")},
        "1.6": _names(f"{SWEEP} friction"),
        "1.7": (),
        "1.8": tuple(BOUNDS),
    },
    MEASUREMENT: {
        **{"1.0": (), "1.1": (), "1.2": ("row_number", "complete", "held_out", "matter", "input_uncertainty")},
        "1.3": ("impactor_angle", "impactor_spin", *OBLIQUE),
        "1.4": FORCE_INTERVAL,
    },
    BOUNCES: {"1.0": ()},
    CHAIN: {"1.0": (), "1.1": _names(f"{HISTORY} sensors", f"{HISTORY} strains")},
    COST: {"1.0": ()},
}
"""Kinds of datasets (attribute film_model_schema): the versions that can be read, oldest first, each with the names of
the variables that it added, so that files written before remain valid."""

VERSIONS = {kind: list(versions)[-1] for kind, versions in ADDED.items()}
"""The version of each kind that is written."""

_PROVENANCE = (
    *("Conventions", "title", "summary", "source", "references", "history", "license", "date_created", "comment"),
    *("film_model_schema", "film_model_schema_version", "film_model_version", "content_sha256"),
)

ATTRIBUTES: dict[str, tuple[str, ...]] = {
    HISTORY: (
        *_PROVENANCE,
        *("scene_toml", "scene_sha256", "contact_law", "outcome", "effects", "warnings"),
        *("estimated_accuracy", "segments", "unloading_segments"),
    ),
    SWEEP: (
        *_PROVENANCE,
        *("scene_toml", "scene_sha256", "sweep_toml", "sweep_sha256", "swept", "kept", "statuses", "warnings"),
        "estimated_accuracy",
    ),
    MEASUREMENT: (*_PROVENANCE, "measured"),
    BOUNCES: (*_PROVENANCE, "scene_toml", "scene_sha256", "contact_law", "outcome", "rest_time", "warnings"),
    CHAIN: (*_PROVENANCE, "scene_toml", "scene_sha256", "outcome", "end", "estimated_accuracy", "warnings"),
    COST: (
        *_PROVENANCE,
        *("scene_toml", "scene_sha256", "contact_law", "settings", "outcomes", "reference_method", "machine"),
    ),
}
"""Global attributes that every dataset of a kind has. `requested_accuracy`, the largest of those that were swept, is
set too unless the scene gives segments."""


def kind_of(ds: Dataset) -> str:
    """The kind of a dataset. Raises ValueError if film-model did not write it."""
    kind = str(ds.attrs.get("film_model_schema", ""))
    if kind not in VERSIONS:
        raise ValueError("not a dataset of film-model: the attribute film_model_schema does not name a kind")
    return kind


def variables_of(ds: Dataset) -> tuple[Variable, ...]:
    """The variables that a dataset must have, swept quantities first. Raises ValueError as `kind_of` does."""
    kind = kind_of(ds)
    if kind == MEASUREMENT:
        table = TABLE[f"{kind} {ds.attrs.get('measured', 'history')}"]
        return tuple(v for v in table if not v.optional or v.name in ds.variables)
    later = _added_later(kind, ds)
    constants = tuple(v for v in CONSTANTS if v.name in ds.variables)
    if kind == HISTORY:
        constants += tuple(v.over(()) for v in (SCENE_KEY,) if v.name in ds.variables)
    if kind in (HISTORY, BOUNCES, CHAIN, COST):
        own = ("steps", "friction", "contacts", "sliding") * (kind == HISTORY)
        own += ("sensors", "strains") * (kind in (HISTORY, CHAIN))
        more = [v for word in own if has(ds, word) for v in TABLE[f"{HISTORY} {word}"]]
        return (*(v for v in (*TABLE[kind], *more) if v.name not in later), *constants)
    swept = swept_variables(str(ds.attrs.get("swept", "")).split(), ds)
    dims = tuple(v.dims[0] for v in swept) if "impact" not in ds.sizes else ("impact",)
    kept, chosen = (str(ds.attrs.get(name, "")).split() for name in ("kept", "variables"))
    own = sweep_variables(kept, chosen, dims)
    found = (*(v for v in own if v.name not in later), *derivatives_in(ds, dims), *peaks_in(ds, dims))
    return (*swept, *found, *constants)


def has(ds: Dataset, part: str) -> bool:
    """Whether a history has any of the variables of a part, such as "steps" or "sensors".

    Some names are in two parts, with other dimensions.
    """
    return any(v.name in ds.variables and ds.variables[v.name].dims == v.dims for v in TABLE[f"{HISTORY} {part}"])


def require(ds: Dataset, names: Iterable[str]) -> None:
    """Raise ValueError if variables are missing in a dataset."""
    missing = [name for name in names if name not in ds.variables]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise ValueError(f"variable {missing[0]}{more} missing: dropped or renamed, or the file is damaged")


def require_impacts(ds: Dataset) -> None:
    """Raise ValueError if the variables that identify the impacts of a sweep are missing."""
    require(ds, ["status", *(swept_name(path) for path in str(ds.attrs.get("swept", "")).split())])


def _added_later(kind: str, ds: Dataset) -> set[str]:
    """Names of the variables that versions after that of the dataset have added."""
    versions = list(ADDED[kind])
    version = ds.attrs.get("film_model_schema_version")
    later = versions[versions.index(version) + 1 :] if version in versions else ()
    return {name for version in later for name in ADDED[kind][version]}


def has_failed(status: NDArray[Any]) -> Mask:
    """Which values of `status` mean that the impact has no result."""
    return (status < 0) | (status >= OUT_OF_RANGE)


def sweep_variables(kept: Iterable[str], chosen: Sequence[str], dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """The variables of a sweep with dimensions `dims`, except the swept quantities.

    kept: words of `Sweep.kept`. chosen: which of `CHOOSABLE` it has, all if empty.
    """
    left_out = set(CHOOSABLE).difference(chosen) if chosen else set[str]()
    keys = [SWEEP, *(f"{SWEEP} {word}" for word in kept if f"{SWEEP} {word}" in TABLE)]
    return tuple(variable.over(dims) for key in keys for variable in TABLE[key] if variable.name not in left_out)
