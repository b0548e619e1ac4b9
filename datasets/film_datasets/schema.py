"""The one table of variables of a history dataset, and the check of a dataset against it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import xarray as xr

from film_model.core.native import EVENTS, LINE_DTYPE, PHASES
from film_model.history import MOTION, SUMMARY
from film_model.problem import Scales
from film_model.units import si_unit

SCHEMA_NAME = "impact_history"
SCHEMA_VERSION = "1.0"

BRANCHES = {-2: "no_contact", -1: "unloading"}
"""Stage numbers below the law's own, which count from 0."""

FLOAT, BYTE = np.dtype(np.float64), np.dtype(np.int8)


@dataclass(frozen=True)
class Variable:
    """One variable. unit: of SI, as UDUNITS writes it; None for flags. optional: NaN where it does not exist.

    flags: value → meaning; those of the law's stages come on top when `stages` is set.
    """

    name: str
    dims: tuple[str, ...]
    dtype: np.dtype[Any]
    unit: str | None
    long_name: str
    comment: str = ""
    flags: tuple[tuple[int, str], ...] = ()
    stages: bool = False
    optional: bool = False

    def attributes(self, stages: tuple[str, ...] = ()) -> dict[str, Any]:
        """Attributes as CF wants them; `stages`: meanings of the law's stages 0, 1, …"""
        flags = [*self.flags, *enumerate(stages if self.stages else ())]
        attributes: dict[str, Any] = {"long_name": self.long_name}
        if self.unit is not None:
            attributes["units"] = self.unit
        if self.comment:
            attributes["comment"] = self.comment
        if flags:
            attributes["flag_values"] = np.array([value for value, _ in flags], BYTE)
            attributes["flag_meanings"] = " ".join(meaning for _, meaning in flags)
        return attributes


def _spaced(name: str) -> str:
    return name.replace("_", " ")


def _number(name: str, dims: tuple[str, ...], dimension: str, long_name: str, comment: str = "") -> Variable:
    return Variable(name, dims, FLOAT, si_unit(dimension), long_name, comment)


def _stage(name: str, dims: tuple[str, ...], long_name: str, comment: str = "") -> Variable:
    return Variable(name, dims, BYTE, None, long_name, comment, tuple(BRANCHES.items()), stages=True)


_MISSING = "; NaN if there is none"

_SEGMENT = {
    "time": "time at which the segment begins",
    "xi": "indentation there",
    "nu": "velocity of the impactor there, relative to the target if that is a free body",
    "shift": "target displacement there",
    "phi": "force of the straight line there",
    "kappa": "slope of the straight line",
    "work": "work of the contact law there since its stage began",
    "spent": "work done on the indentation since first touch",
    "load": "external force on the impactor",
    "gamma": "compliance of the target, scale_force/(impedance scale_velocity)",
    "xi_free": "indentation at which the unloading branch ends",
    "per_recovery": "one over the indentation from there to the turning point",
    "f_max": "contact force at the turning point",
    "exponent": "exponent of the unloading branch, f_max ((xi - xi_free) per_recovery)^exponent",
}

_LAW = "see attribute comment for the equations of motion on a segment"

VARIABLES: tuple[Variable, ...] = (
    _number("t", ("t",), "time", "time since first touch", "even samples and the times of all events"),
    *(_number(name, ("t",), dimension, _spaced(name), what) for name, (dimension, what) in MOTION.items()),
    _stage("stage", ("t",), "stage of the contact law"),
    Variable(
        "event_kind", ("event",), BYTE, None, "kind of event", flags=tuple((k, e) for k, e in enumerate(EVENTS) if k)
    ),
    _number("event_time", ("event",), "time", "time of the event since first touch", "lies exactly on t"),
    *(
        _number(f"event_{name}", ("event",), dimension, f"{_spaced(name)} at the event", what)
        for name, (dimension, what) in MOTION.items()
    ),
    _stage("event_stage", ("event",), "stage of the contact law after the event"),
    *(
        Variable(name, (), FLOAT, si_unit(dimension), _spaced(name), what.partition(";")[0] + _MISSING, optional=True)
        for name, (dimension, what) in SUMMARY.items()
    ),
    *(
        _number(f"scale_{scale.name}", (), scale.name, f"unit of {scale.name} of the segments")
        for scale in fields(Scales)  # named after their dimensions
    ),
    _number("drift_velocity", (), "velocity", "velocity of the centre of mass", "0 unless the target is a free body"),
    _number(
        "impactor_share", (), "dimensionless", "share of the impactor in the motion", "1 unless the target is free"
    ),
    _number(
        "target_compliance",
        (),
        "dimensionless",
        "static compliance of the target, scale_force/(static stiffness scale_length)",
        "0 unless the target follows the force statically",
    ),
    *(_number(f"segment_{key}", ("segment",), "dimensionless", what, _LAW) for key, what in _SEGMENT.items()),
    _stage("segment_branch", ("segment",), "stage of the contact law on the segment"),
    Variable("segment_phase", ("segment",), BYTE, None, "phase of the contact", flags=tuple(enumerate(PHASES))),
)
"""All variables, in the order in which `content_sha256` reads them."""

assert {f"segment_{name}" for name in LINE_DTYPE.names or ()} == {v.name for v in VARIABLES if v.dims == ("segment",)}

ATTRIBUTES = (
    *("Conventions", "title", "summary", "source", "references", "history", "license", "date_created", "comment"),
    *("film_model_schema", "film_model_schema_version", "film_model_version"),
    *("scene_toml", "scene_sha256", "content_sha256", "contact_law", "outcome", "effects", "warnings"),
    *("estimated_accuracy", "segments", "unloading_segments"),
)
"""Global attributes that every dataset has; `requested_accuracy` is there unless segments were asked for."""


def content_sha256(ds: xr.Dataset) -> str:
    """SHA-256 over the variables of `VARIABLES` in order: each name, then its values as little-endian bytes."""
    digest = hashlib.sha256()
    for variable in VARIABLES:
        values = np.ascontiguousarray(ds[variable.name].values, variable.dtype.newbyteorder("<"))
        digest.update(variable.name.encode() + values.tobytes())
    return digest.hexdigest()


def validate(ds: xr.Dataset) -> list[str]:
    """Every difference between `ds` and the schema, one sentence each; an empty list if there is none."""
    found = [f"attribute {name} is missing" for name in ATTRIBUTES if name not in ds.attrs]
    expected = {"film_model_schema": SCHEMA_NAME, "film_model_schema_version": SCHEMA_VERSION}
    found += [f"attribute {k} is {ds.attrs[k]!r}, not {v!r}" for k, v in expected.items() if ds.attrs.get(k, v) != v]
    known = {variable.name for variable in VARIABLES}
    found += [f"variable {name} is not in the schema" for name in ds.variables if name not in known]
    for variable in VARIABLES:
        if variable.name not in ds.variables:
            found.append(f"variable {variable.name} is missing")
        else:
            found += [f"variable {variable.name}: {what}" for what in _differences(variable, ds[variable.name])]
    return found or _contradictions(ds)


def _differences(variable: Variable, array: xr.DataArray) -> list[str]:
    """Differences of one variable from its row."""
    found = [
        f"{what} {got!r}, not {want!r}"
        for what, got, want in (
            ("dimensions", array.dims, variable.dims),
            ("type", array.dtype.name, variable.dtype.name),
            *((key, array.attrs.get(key), variable.attributes().get(key)) for key in ("units", "long_name", "comment")),
        )
        if got != want
    ]
    values = np.atleast_1d(array.attrs.get("flag_values", [])).tolist()
    meanings = str(array.attrs.get("flag_meanings", "")).split()
    pairs = tuple(zip(values, meanings, strict=False))
    own = pairs[: len(variable.flags)] if variable.stages else pairs
    if own != variable.flags or len(values) != len(meanings):
        found.append(f"flags {values} {meanings}, not {dict(variable.flags)}")
    elif variable.flags and not np.isin(array.values, values).all():
        found.append("values that are no flags")
    if array.dtype == FLOAT and not variable.optional and not np.isfinite(array.values).all():
        found.append("values that are not finite")
    return found


def _contradictions(ds: xr.Dataset) -> list[str]:
    """What does not fit together in a dataset that has everything."""
    text = str(ds.attrs["scene_toml"]).encode()
    checks = {
        "t does not increase": bool((np.diff(ds["t"].values) > 0).all()),
        "an event_time is not on t": bool(np.isin(ds["event_time"].values, ds["t"].values).all()),
        "scene_sha256 is not that of scene_toml": ds.attrs["scene_sha256"] == hashlib.sha256(text).hexdigest(),
        "content_sha256 is not that of the variables": ds.attrs["content_sha256"] == content_sha256(ds),
    }
    return [message for message, good in checks.items() if not good]
