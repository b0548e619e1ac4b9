"""The tables of variables and attributes of our datasets, generated from those of the summary and the motion.

Kinds: the history of one impact, all bounces of a ball, a chain of bodies, a sweep over many impacts, a measurement to
compare with, and the cost of accuracy.
A new value in `film_model.solve.history.SUMMARY` gets its variables by itself; it needs a new version in `ADDED`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.schema.chain_variables import CHAINS
from film_datasets.schema.contact_variables import CONTACTS
from film_datasets.schema.derivative_variables import derivatives_in
from film_datasets.schema.finite_element_variables import FINITE_ELEMENT_PAIRS, FINITE_ELEMENTS
from film_datasets.schema.friction_variables import IN_HISTORIES, IN_STEPS, IN_SWEEPS
from film_datasets.schema.motion_variables import (
    MODE_ENERGY,
    SEGMENT_PLACES,
    SEGMENTS,
    STEP_PLACES,
    STEPS,
    number,
    segment_units,
    spaced,
    stage,
)
from film_datasets.schema.sensor_variables import FORCE_INTERVAL, IDENTIFIED, SENSED, STRAINED, peaks_in
from film_datasets.schema.variable import (
    BYTE,
    FLOAT,
    IMPACTS,
    INTEGER,
    TEXT,
    Variable,
    swept_name,
    swept_variables,
)
from film_model.base.errors import STATUSES
from film_model.core.native import EVENTS
from film_model.oblique.result import OBLIQUE
from film_model.solve.bounce import COLUMNS
from film_model.solve.history import MOTION, SUMMARY
from film_model.studies.reference import COMPARED

if TYPE_CHECKING:
    import xarray as xr

HISTORY, SWEEP, MEASUREMENT, COST = "impact_history", "impact_sweep", "impact_measurement", "impact_cost_study"
BOUNCES, CHAIN = "impact_bounces", "impact_chain"
_STRESSES = (
    *("impulse", "contact_radius", "dent_diameter", "mean_pressure", "peak_pressure", "maximum_shear_stress"),
    *("maximum_von_mises_stress", "depth_of_maximum_stress"),
)

_STEPS = tuple(variable.name for variable in (*STEP_PLACES, *STEPS))
_IN_HISTORIES, _IN_SWEEPS, _IN_STEPS, _OF_CONTACTS, _SENSED, _STRAINED = (
    tuple(v.name for v in variables) for variables in (IN_HISTORIES, IN_SWEEPS, IN_STEPS, CONTACTS, SENSED, STRAINED)
)

ADDED: dict[str, dict[str, tuple[str, ...]]] = {
    HISTORY: {
        **{"1.1": (), "1.2": _STRESSES, "1.3": ()},
        "1.4": (*_STEPS, MODE_ENERGY.name),
        "1.5": (*_IN_HISTORIES, *_OF_CONTACTS, *_IN_STEPS),
        "1.6": _SENSED,
        "1.7": _STRAINED,
    },
    SWEEP: {
        "1.0": (),
        "1.1": ("estimated_accuracy", *_STRESSES),
        "1.2": ("scene_key",),
        **{"1.3": (), "1.4": (), "1.5": _STEPS},
        "1.6": _IN_SWEEPS,
        "1.7": (),
    },
    MEASUREMENT: {
        **{"1.0": (), "1.1": (), "1.2": ("row_number", "complete", "held_out", "matter", "input_uncertainty")},
        "1.3": ("impactor_angle", "impactor_spin", *OBLIQUE),
        "1.4": FORCE_INTERVAL,
    },
    BOUNCES: {"1.0": ()},
    CHAIN: {"1.0": ()},
    COST: {"1.0": ()},
}
"""Kinds of datasets (attribute film_model_schema): the versions that can be read, oldest first, each with the names of
the variables that it added, so that files written before remain valid."""

VERSIONS = {kind: list(versions)[-1] for kind, versions in ADDED.items()}
"""The version of each kind that is written."""

IMPACT_STATUSES = {code: status for code, status in sorted(STATUSES.items()) if status.of_row}
"""The statuses that an impact of a sweep can have, besides those of values that are out of range."""

OUT_OF_RANGE = max(IMPACT_STATUSES) + 1
"""Status of an impact whose value of the first swept quantity is out of range, +1 for the second, and so on."""


_ABSENT = "NaN if there is none"


def _summary_variables(dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """A variable for each value of film_model's summary."""
    return tuple(
        number(name, dims, dimension, spaced(name), f"{what.partition(';')[0]}; {_ABSENT}", optional=True)
        for name, (dimension, what) in SUMMARY.items()
    )


_HISTORY = (
    number("t", ("t",), "time", "time since first touch", "even samples and the times of all events"),
    *(number(name, ("t",), dimension, spaced(name), what) for name, (dimension, what) in MOTION.items()),
    stage("stage", ("t",), "stage of the contact law"),
    Variable("event_kind", ("event",), BYTE, None, "kind of event", flags=tuple(enumerate(EVENTS))[1:]),
    number("event_time", ("event",), "time", "time of the event since first touch", "lies exactly on t"),
    *(
        number(f"event_{name}", ("event",), dimension, f"{spaced(name)} at the event", what)
        for name, (dimension, what) in MOTION.items()
    ),
    stage("event_stage", ("event",), "stage of the contact law after the event"),
    *_summary_variables(()),
    *segment_units(()),
    *SEGMENTS,
)

CONSTANTS = (
    number("mass", (), "mass", "mass of the impactor"),
    number("radius", (), "length", "radius of the impactor"),
    number("approach_velocity", (), "velocity", "velocity towards the target when contact begins"),
    number("effective_modulus", (), "pressure", "effective contact modulus"),
    number("yield_strength", (), "pressure", "yield strength"),
    number("impact_energy", (), "energy", "kinetic energy of the approach"),
    Variable("contact_law_name", (), TEXT, None, "contact law"),
)
"""Values of the scene that a dataset has if they are known and, in a sweep, the same for all impacts."""

SCENE_KEY = Variable(
    *("scene_key", (IMPACTS,), INTEGER, None, "number of the scene, and of what is swept in words"),
    comment="31 bits of a hash: rows with another one belong to another scene than that in scene_toml",
)

_SWEEP = (
    *_summary_variables((IMPACTS,)),
    Variable(
        *("status", (IMPACTS,), BYTE, None, "how the impact ended"),
        comment="attribute statuses says each in a sentence; the summary of an impact that failed is NaN",
        flags=tuple((code, status.word) for code, status in IMPACT_STATUSES.items()),
        more="out_of_range",
        more_from=OUT_OF_RANGE,
    ),
    Variable(
        *("zener_number", (IMPACTS,), FLOAT, "1", "inelasticity parameter of Zener"),
        comment="(4 E/3)^(2/5) R^(1/5) m^(3/5) V^(1/5)/Z: what target motion costs; NaN without elastic constants",
        optional=True,
    ),
    Variable("law", (IMPACTS,), BYTE, None, "contact law", flags=((-1, "none"),), more="laws"),
    Variable(
        *("estimated_accuracy", (IMPACTS,), FLOAT, "1", "estimated relative error of the summary"),
        comment="bound on the relative error of every summary value of the impact; NaN if it failed",
        optional=True,
    ),
    SCENE_KEY,
)

CHOOSABLE = tuple(variable.name for variable in (*_SWEEP, *IN_SWEEPS) if variable.optional)
"""The variables of which a sweep may keep some only; the others say how each impact ended and to what it belongs."""

_SWEEP_SEGMENTS = (
    *SEGMENT_PLACES,
    *segment_units((IMPACTS,), optional=True),
    *SEGMENTS,
)

_SWEEP_SAMPLES = (
    number("normalised_time", ("normalised_time",), "dimensionless", "time over contact duration"),
    *(
        number(f"sampled_{name}", (IMPACTS, "normalised_time"), dimension, f"{spaced(name)} over time", what, True)
        for name, (dimension, what) in MOTION.items()
    ),
)

MEASURED_MOTION = {
    **MOTION,
    "impactor_acceleration": (
        "acceleration",
        "as an accelerometer on the impactor reads it, positive into the target: less contact force over mass",
    ),
}
"""Quantities of a measured history: dimension and description."""

_MEASURED_HISTORY = (
    number("t", ("t",), "time", "time since first touch"),
    *(
        number(name, ("t",), dimension, f"measured {spaced(name)}", f"{what}; {_ABSENT}", True)
        for name, (dimension, what) in MEASURED_MOTION.items()
    ),
    *IDENTIFIED,
)

_MEASURED_IMPACTS = (
    number("impactor_velocity", ("impact",), "velocity", "impactor velocity at first touch"),
    number("impactor_angle", ("impact",), "angle", "between the path and the normal at first touch", optional=True),
    number("impactor_spin", ("impact",), "angular_frequency", "spin at first touch", "adds to sliding", optional=True),
    *(replace(variable, long_name=f"measured {variable.long_name}") for variable in _summary_variables(("impact",))),
    *(
        number(name, ("impact",), dimension, f"measured {spaced(name)}", f"{what.partition(';')[0]}; {_ABSENT}", True)
        for name, (dimension, what) in OBLIQUE.items()
    ),
)
MEASURED_CONDITIONS = ("impactor_velocity", "impactor_angle", "impactor_spin")
"""Variables of measured impacts that are given, not measured; the first is always there."""

EVIDENCE_QUANTITIES = (
    *("coefficient_of_restitution", "maximum_force", "maximum_indentation"),
    *("time_of_maximum_indentation", "contact_duration", "dent_diameter", "permanent_indentation"),
)
EVIDENCE_KINDS = ("measured", "finite_element", "theory", "same_law", "own_fit")
EVIDENCE_SURENESS = ("table", "figure", "formula", "text", "conversion")
EVIDENCE_MATTER = ("metal", "brittle", "polymer")

_EVIDENCE = (
    Variable("quantity", ("row",), BYTE, None, "what the value is", flags=tuple(enumerate(EVIDENCE_QUANTITIES))),
    Variable(
        *("value", ("row",), FLOAT, None, "value of the quantity"),
        comment="SI: 1 for a coefficient of restitution, N, m and s for the others",
    ),
    number("uncertainty", ("row",), "dimensionless", "relative uncertainty of the value", "NaN: not given", True),
    number("input_uncertainty", ("row",), "dimensionless", "of the hardness or strength", "NaN: not known", True),
    Variable("source_of_value", ("row",), BYTE, None, "source", "attribute sources has the references", more="sources"),
    Variable("kind_of_value", ("row",), BYTE, None, "where it is from", flags=tuple(enumerate(EVIDENCE_KINDS))),
    Variable("sureness", ("row",), BYTE, None, "how it was read", flags=tuple(enumerate(EVIDENCE_SURENESS))),
    Variable("row_number", ("row",), INTEGER, "1", "number of the row among those of its source"),
    Variable("complete", ("row",), BYTE, None, "whether the conditions are known", flags=((0, "no"), (1, "yes"))),
    Variable("held_out", ("row",), BYTE, None, "whether it is never used to fit", flags=((0, "no"), (1, "yes"))),
    Variable(
        *("matter", ("row",), BYTE, None, "bodies of measured values"),
        flags=((-1, "none"), *enumerate(EVIDENCE_MATTER)),
    ),
    Variable("law", ("row",), BYTE, None, "law that it was computed with", flags=((-1, "none"),), more="laws"),
    number("radius", ("row",), "length", "effective radius", _ABSENT, True),
    number("mass", ("row",), "mass", "effective mass", _ABSENT, True),
    number("velocity", ("row",), "velocity", "approach velocity", _ABSENT, True),
    number("effective_modulus", ("row",), "pressure", "effective contact modulus", _ABSENT, True),
    number("yield_strength", ("row",), "pressure", "yield strength", "NaN: elastic, or from a material", True),
    number("poissons_ratio", ("row",), "dimensionless", "Poisson's ratio of the body that yields", _ABSENT, True),
    number("target_impedance", ("row",), "impedance", "wave impedance of the target", "NaN: a half-space", True),
)

_BOUNCES = tuple(
    number(name, ("bounce",), dimension, spaced(name), f"{what}; {_ABSENT}", optional=True)
    for name, (dimension, what) in COLUMNS.items()
)

_COST = (
    Variable("method", ("run",), INTEGER, None, "method", "its setting: attribute settings", more="methods"),
    Variable("outcome", ("run",), BYTE, None, "outcome", "attribute outcomes", ((0, "done"), (1, "no_answer"))),
    *(
        number(f"{what}_time_{way}", ("run",), "time", f"{long} of seconds an impact, {how}", _ABSENT, optional=True)
        for way, how in (("single", "one call from Python"), ("batch", "in a batch"))
        for what, long in (("median", "median"), ("spread", "half the distance between the quartiles"))
    ),
    Variable("force_evaluations", ("run",), INTEGER, "1", "evaluations of the contact law", "-1 if not counted"),
    *(
        number(f"error_{name}", ("run",), "dimensionless", f"relative error of {spaced(name)}", _ABSENT, optional=True)
        for name in COMPARED
    ),
    *(number(f"reference_{name}", (), SUMMARY[name][0], f"exact {spaced(name)}") for name in COMPARED),
    number("reference_error", (), "dimensionless", "relative error of the reference values"),
)

TABLE: dict[str, tuple[Variable, ...]] = {
    HISTORY: _HISTORY,
    f"{HISTORY} steps": (*STEPS, MODE_ENERGY),
    f"{HISTORY} friction": IN_HISTORIES,
    f"{HISTORY} contacts": CONTACTS,
    f"{HISTORY} sliding": IN_STEPS,
    f"{HISTORY} sensors": SENSED,
    f"{HISTORY} strains": STRAINED,
    SWEEP: _SWEEP,
    f"{SWEEP} segments": _SWEEP_SEGMENTS,
    f"{SWEEP} steps": (*STEP_PLACES, *STEPS),
    f"{SWEEP} friction": IN_SWEEPS,
    f"{SWEEP} samples": _SWEEP_SAMPLES,
    f"{MEASUREMENT} history": _MEASURED_HISTORY,
    f"{MEASUREMENT} impacts": _MEASURED_IMPACTS,
    f"{MEASUREMENT} values": _EVIDENCE,
    f"{MEASUREMENT} finite_elements": FINITE_ELEMENTS,
    f"{MEASUREMENT} finite_element_pairs": FINITE_ELEMENT_PAIRS,
    BOUNCES: _BOUNCES,
    CHAIN: CHAINS,
    COST: _COST,
}
"""Variables by the kind of dataset and what is kept in it, in the order in which `content_sha256` reads them."""

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


def kind_of(ds: xr.Dataset) -> str:
    """The kind of a dataset. Raises ValueError if film-model did not write it."""
    kind = str(ds.attrs.get("film_model_schema", ""))
    if kind not in VERSIONS:
        raise ValueError("not a dataset of film-model: the attribute film_model_schema does not name a kind")
    return kind


def variables_of(ds: xr.Dataset) -> tuple[Variable, ...]:
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
        own = ("steps", "friction", "contacts", "sliding", "sensors", "strains") if kind == HISTORY else ()
        more = [v for word in own if has(ds, word) for v in TABLE[f"{HISTORY} {word}"]]
        return (*(v for v in (*TABLE[kind], *more) if v.name not in later), *constants)
    swept = swept_variables(str(ds.attrs.get("swept", "")).split(), ds)
    dims = tuple(v.dims[0] for v in swept) if "impact" not in ds.sizes else ("impact",)
    kept, chosen = (str(ds.attrs.get(name, "")).split() for name in ("kept", "variables"))
    own = sweep_variables(kept, chosen, dims)
    found = (*(v for v in own if v.name not in later), *derivatives_in(ds, dims), *peaks_in(ds, dims))
    return (*swept, *found, *constants)


def has(ds: xr.Dataset, part: str) -> bool:
    """Whether a history has any of the variables of a part, such as "steps" or "sensors".

    Some names are in two parts, with other dimensions.
    """
    return any(v.name in ds.variables and ds.variables[v.name].dims == v.dims for v in TABLE[f"{HISTORY} {part}"])


def require(ds: xr.Dataset, names: Iterable[str]) -> None:
    """Raise ValueError if variables are missing in a dataset."""
    missing = [name for name in names if name not in ds.variables]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise ValueError(f"variable {missing[0]}{more} missing: dropped or renamed, or the file is damaged")


def require_impacts(ds: xr.Dataset) -> None:
    """Raise ValueError if the variables that identify the impacts of a sweep are missing."""
    require(ds, ["status", *(swept_name(path) for path in str(ds.attrs.get("swept", "")).split())])


def _added_later(kind: str, ds: xr.Dataset) -> set[str]:
    """Names of the variables that versions after that of the dataset have added."""
    versions = list(ADDED[kind])
    version = ds.attrs.get("film_model_schema_version")
    later = versions[versions.index(version) + 1 :] if version in versions else ()
    return {name for version in later for name in ADDED[kind][version]}


def has_failed(status: NDArray[Any]) -> NDArray[np.bool_]:
    """Which values of `status` mean that the impact has no result."""
    return (status < 0) | (status >= OUT_OF_RANGE)


def sweep_variables(kept: Iterable[str], chosen: Sequence[str], dims: tuple[str, ...]) -> tuple[Variable, ...]:
    """The variables of a sweep with dimensions `dims`, except the swept quantities.

    kept: words of `Sweep.kept`. chosen: which of `CHOOSABLE` it has, all if empty.
    """
    left_out = set(CHOOSABLE).difference(chosen) if chosen else set[str]()
    keys = [SWEEP, *(f"{SWEEP} {word}" for word in kept if f"{SWEEP} {word}" in TABLE)]
    return tuple(variable.over(dims) for key in keys for variable in TABLE[key] if variable.name not in left_out)
