"""The one table of variables of our datasets, and the check of a dataset against it.

Kinds: the history of one impact, a sweep over many, a measurement to compare with, and what accuracy costs.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import xarray as xr

from film_model.batch import STATUSES
from film_model.core.native import EVENTS, LINE_DTYPE, PHASES
from film_model.history import MOTION, SUMMARY
from film_model.scales import Scales
from film_model.study import COMPARED
from film_model.units import DIMENSIONS, si_unit

HISTORY, SWEEP, MEASUREMENT, COST = "impact_history", "impact_sweep", "impact_measurement", "impact_cost_study"
VERSIONS = {HISTORY: "1.1", SWEEP: "1.0", MEASUREMENT: "1.0", COST: "1.0"}
"""Kinds of datasets (attribute film_model_schema), and the version of each."""

BRANCHES = {-2: "no_contact", -1: "unloading"}
"""Stage numbers below the law's own, which count from 0."""

REFUSED = max(STATUSES) + 1
"""Status of a row whose value of the first swept quantity is out of range; the second has the next, and so on."""

ROWS = "rows"
"""Stands for the dimensions of a sweep: its swept quantities, or `impact`."""

FLOAT, BYTE, INTEGER, LONG = (np.dtype(kind) for kind in (np.float64, np.int8, np.int32, np.int64))


@dataclass(frozen=True)
class Variable:
    """One variable. unit: of SI, as UDUNITS writes it; None for flags. optional: NaN where it does not exist.

    flags: value → meaning; `more` names the list of further ones, which the dataset itself has ("stages" of the law,
    "laws" of a sweep, "refused" quantities of a sweep), from `more_from` up.
    """

    name: str
    dims: tuple[str, ...]
    dtype: np.dtype[Any]
    unit: str | None
    long_name: str
    comment: str = ""
    flags: tuple[tuple[int, str], ...] = ()
    more: str = ""
    more_from: int = 0
    optional: bool = False

    def attributes(self, meanings: Mapping[str, Sequence[str]] | None = None) -> dict[str, Any]:
        """Attributes as CF wants them; `meanings`: the lists that `more` may name."""
        own = (meanings or {}).get(self.more, ())
        flags = [*self.flags, *enumerate(own, self.more_from)]
        attributes: dict[str, Any] = {"long_name": self.long_name}
        if self.unit is not None:
            attributes["units"] = self.unit
        if self.comment:
            attributes["comment"] = self.comment
        if flags:
            attributes["flag_values"] = np.array([value for value, _ in flags], self.dtype)
            attributes["flag_meanings"] = " ".join(meaning for _, meaning in flags)
        return attributes

    def over(self, rows: tuple[str, ...]) -> Variable:
        """The variable with the dimensions of a sweep in the place of `ROWS`."""
        return replace(self, dims=tuple(d for dim in self.dims for d in (rows if dim == ROWS else (dim,))))


def _spaced(name: str) -> str:
    return name.replace("_", " ")


def _number(
    name: str, dims: tuple[str, ...], dimension: str, long_name: str, comment: str = "", optional: bool = False
) -> Variable:
    return Variable(name, dims, FLOAT, si_unit(dimension), long_name, comment, optional=optional)


def _stage(name: str, dims: tuple[str, ...], long_name: str, comment: str = "") -> Variable:
    return Variable(name, dims, BYTE, None, long_name, comment, tuple(BRANCHES.items()), more="stages")


_MISSING = "; NaN if there is none"
_ABSENT = "NaN if there is none"

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
    "per_recovery": "one over the indentation from xi_origin to the turning point",
    "f_max": "scale of the force on it, the force at the turning point where f_shift is 0",
    "exponent": "exponent of the unloading branch, f_shift + f_max ((xi - xi_origin) per_recovery)^exponent",
    "xi_origin": "indentation from which the unloading branch is counted",
    "f_shift": "constant part of the force on the unloading branch",
    "work_free": "work of the unloading branch at xi_free, counted from xi_origin",
    "damping": "damping held on the segment",
    "damper": "factor of the contact law's damping",
}

_LAW = "see attribute comment for the equations of motion on a segment"


def _summary(dims: tuple[str, ...]) -> tuple[Variable, ...]:
    return tuple(
        _number(name, dims, dimension, _spaced(name), what.partition(";")[0] + _MISSING, optional=True)
        for name, (dimension, what) in SUMMARY.items()
    )


def _units_of_segments(dims: tuple[str, ...], optional: bool = False) -> tuple[Variable, ...]:
    """The units of segments; scales are named after their dimensions."""
    rows = (
        *((f"scale_{s.name}", s.name, f"unit of {s.name} of the segments", "") for s in fields(Scales)),
        ("drift_velocity", "velocity", "velocity of the centre of mass", "0 unless the target is a free body"),
        ("impactor_share", "dimensionless", "share of the impactor in the motion", "1 unless the target is free"),
        (
            "target_compliance",
            "dimensionless",
            "static compliance of the target, scale_force/(static stiffness scale_length)",
            "0 unless the target follows the force statically",
        ),
    )
    return tuple(_number(name, dims, dimension, *what, optional=optional) for name, dimension, *what in rows)


_SEGMENTS = (
    *(_number(f"segment_{key}", ("segment",), "dimensionless", what, _LAW) for key, what in _SEGMENT.items()),
    _stage("segment_branch", ("segment",), "stage of the contact law on the segment"),
    Variable("segment_phase", ("segment",), BYTE, None, "phase of the contact", flags=tuple(enumerate(PHASES))),
)

assert {f"segment_{name}" for name in LINE_DTYPE.names or ()} == {v.name for v in _SEGMENTS}

TABLE: dict[str, tuple[Variable, ...]] = {
    HISTORY: (
        _number("t", ("t",), "time", "time since first touch", "even samples and the times of all events"),
        *(_number(name, ("t",), dimension, _spaced(name), what) for name, (dimension, what) in MOTION.items()),
        _stage("stage", ("t",), "stage of the contact law"),
        Variable("event_kind", ("event",), BYTE, None, "kind of event", flags=tuple(enumerate(EVENTS))[1:]),
        _number("event_time", ("event",), "time", "time of the event since first touch", "lies exactly on t"),
        *(
            _number(f"event_{name}", ("event",), dimension, f"{_spaced(name)} at the event", what)
            for name, (dimension, what) in MOTION.items()
        ),
        _stage("event_stage", ("event",), "stage of the contact law after the event"),
        *_summary(()),
        *_units_of_segments(()),
        *_SEGMENTS,
    ),
    SWEEP: (
        *_summary((ROWS,)),
        Variable(
            *("status", (ROWS,), BYTE, None, "how the impact ended"),
            comment="attribute statuses says each in a sentence; the summary of an impact that failed is NaN",
            flags=tuple((code, word) for code, (word, _) in sorted(STATUSES.items())),
            more="refused",
            more_from=REFUSED,
        ),
        Variable(
            *("zener_number", (ROWS,), FLOAT, "1", "inelasticity parameter of Zener"),
            comment="(4 E/3)^(2/5) R^(1/5) m^(3/5) V^(1/5)/Z: what target motion costs; NaN without elastic constants",
            optional=True,
        ),
        Variable("law", (ROWS,), BYTE, None, "contact law", flags=((-1, "none"),), more="laws"),
    ),
    f"{SWEEP} segments": (
        Variable(
            *("segment_count", (ROWS,), INTEGER, "1", "number of segments of the impact"),
            comment="segments of all impacts follow each other in the order of the rows, the last dimension fastest",
        ),
        Variable(
            *("segment_begin", (ROWS,), LONG, "1", "number of segments of the impacts before"),
            comment="place along segment where those of the impact begin, in a selection of impacts too",
        ),
        *_units_of_segments((ROWS,), optional=True),
        *_SEGMENTS,
    ),
    f"{SWEEP} samples": (
        _number("normalised_time", ("normalised_time",), "dimensionless", "time over contact duration"),
        *(
            _number(f"sampled_{name}", (ROWS, "normalised_time"), dimension, f"{_spaced(name)} over time", what, True)
            for name, (dimension, what) in MOTION.items()
        ),
    ),
    f"{MEASUREMENT} history": (
        _number("t", ("t",), "time", "time since first touch"),
        *(
            _number(name, ("t",), dimension, f"measured {_spaced(name)}", what + _MISSING, True)
            for name, (dimension, what) in MOTION.items()
        ),
    ),
    f"{MEASUREMENT} impacts": (
        _number("impactor_velocity", ("impact",), "velocity", "impactor velocity at first touch"),
        *(replace(variable, long_name=f"measured {variable.long_name}") for variable in _summary(("impact",))),
    ),
}
"""Variables by the kind of dataset and what is kept in it, in the order in which `content_sha256` reads them."""

TABLE[COST] = (
    Variable("method", ("run",), INTEGER, None, "method", "its setting: attribute settings", more="methods"),
    Variable("outcome", ("run",), BYTE, None, "outcome", "attribute outcomes", ((0, "done"), (1, "no_answer"))),
    *(
        _number(f"{what}_time_{way}", ("run",), "time", f"{long} of seconds an impact, {how}", _ABSENT, optional=True)
        for way, how in (("single", "one call from Python"), ("batch", "in a batch"))
        for what, long in (("median", "median"), ("spread", "half the distance between the quartiles"))
    ),
    Variable("force_evaluations", ("run",), INTEGER, "1", "evaluations of the contact law", "-1 if not counted"),
    *(
        _number(
            f"error_{name}", ("run",), "dimensionless", f"relative error of {_spaced(name)}", _ABSENT, optional=True
        )
        for name in COMPARED
    ),
    *(_number(f"reference_{name}", (), SUMMARY[name][0], f"exact {_spaced(name)}") for name in COMPARED),
    _number("reference_error", (), "dimensionless", "relative error of the reference values"),
)

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
    COST: (
        *_PROVENANCE,
        *("scene_toml", "scene_sha256", "contact_law", "settings", "outcomes", "reference_method", "machine"),
    ),
}
"""Global attributes that every dataset of a kind has. `requested_accuracy`, the largest of those
that were swept, is there unless segments were asked for."""


def variables_of(ds: xr.Dataset) -> tuple[Variable, ...]:
    """The rows of the table that a dataset is to have; swept quantities first. Raises ValueError for a foreign one."""
    kind = kind_of(ds)
    if kind in (HISTORY, COST):
        return TABLE[kind]
    if kind == MEASUREMENT:
        table = TABLE[f"{kind} {ds.attrs.get('measured', 'history')}"]
        return tuple(v for v in table if not v.optional or v.name in ds.variables)
    swept = swept_variables(str(ds.attrs.get("swept", "")).split(), ds)
    rows = tuple(v.dims[0] for v in swept) if "impact" not in ds.sizes else ("impact",)
    kept = [SWEEP, *(f"{SWEEP} {word}" for word in str(ds.attrs.get("kept", "")).split() if f"{SWEEP} {word}" in TABLE)]
    return (*swept, *(variable.over(rows) for key in kept for variable in TABLE[key]))


def kind_of(ds: xr.Dataset) -> str:
    """The kind of a dataset. Raises ValueError if it is none of ours."""
    kind = str(ds.attrs.get("film_model_schema", ""))
    if kind not in VERSIONS:
        raise ValueError("not a dataset of film-model: the attribute film_model_schema does not name a kind")
    return kind


def dimension_of(array: xr.DataArray) -> str:
    """The dimension of a variable's unit, as `dimension_of_unit` has it."""
    return dimension_of_unit(array.attrs.get("units", "1"))


def dimension_of_unit(unit: str | None) -> str:
    """The first of `units.DIMENSIONS` with this unit; "dimensionless" if it is none of theirs."""
    return next((name for name, dimension in DIMENSIONS.items() if dimension.unit == unit), "dimensionless")


def swept_name(path: str) -> str:
    """The variable of a swept quantity: impactor_velocity for impactor.velocity."""
    return path.replace(".", "_").replace("-", "_")


def swept_variable(path: str, dims: tuple[str, ...], unit: str | None, labels: Sequence[str] = ()) -> Variable:
    """The row of a swept quantity: a number with a unit, or flags for words."""
    long_name = path.replace(".", ", ").replace("_", " ")
    if labels:
        words = tuple(enumerate(flag_words(labels)))
        return Variable(swept_name(path), dims, INTEGER, None, long_name, "swept; see attribute sweep_toml", words)
    return Variable(swept_name(path), dims, FLOAT, unit, long_name, "swept; see attribute sweep_toml")


def swept_variables(paths: Sequence[str], ds: xr.Dataset) -> tuple[Variable, ...]:
    """The rows of a dataset's swept quantities. Units and words are the dataset's own: the scene says which."""
    found: list[Variable] = []
    for path in paths:
        name = swept_name(path)
        attrs = ds[name].attrs if name in ds.variables else {}
        dims = ("impact",) if "impact" in ds.sizes else (name,)
        found.append(swept_variable(path, dims, attrs.get("units"), str(attrs.get("flag_meanings", "")).split()))
    return tuple(found)


def flag_words(names: Sequence[str], taken: Sequence[str] = ()) -> tuple[str, ...]:
    """Names as CF flag meanings: one word each, all different, none of those `taken`."""
    words = list(taken)
    for name in names:
        word = "".join(c if c.isascii() and (c.isalnum() or c in "_.+@-") else "_" for c in name) or "none"
        words.append(word if word not in words else f"{word}_{len(words)}")
    return tuple(words[len(taken) :])


class ContentHash:
    """SHA-256 of a dataset's content, which may come in pieces: see `content_sha256`."""

    def __init__(self, variables: Sequence[Variable]) -> None:
        self._dtypes = {v.name: v.dtype.newbyteorder("<") for v in variables}
        self._digests = {v.name: hashlib.sha256() for v in variables}

    def update(self, name: str, values: Any) -> None:
        """The next values of a variable, in C order."""
        self._digests[name].update(np.ascontiguousarray(values, self._dtypes[name]).data)

    def hexdigest(self) -> str:
        """The hash of what has come."""
        whole = hashlib.sha256()
        for name, digest in self._digests.items():
            whole.update(name.encode() + digest.digest())
        return whole.hexdigest()


PIECE = 1 << 20


def pieces(array: xr.DataArray) -> Iterator[Any]:
    """The values of a variable in C order, some millions at a time."""
    if array.ndim == 0 or array.size <= PIECE:
        yield array.values
        return
    step = max(1, PIECE * array.shape[0] // array.size)
    for first in range(0, array.shape[0], step):
        part = array[first : first + step]
        if step == 1 and part.size > PIECE:
            yield from pieces(part[0])
        else:
            yield part.values


def content_sha256(ds: xr.Dataset) -> str:
    """SHA-256 over name and SHA-256 of every variable of the schema, in its order, values as little-endian bytes."""
    variables = variables_of(ds)
    content = ContentHash(variables)
    for variable in variables:
        for piece in pieces(ds[variable.name]):
            content.update(variable.name, piece)
    return content.hexdigest()


def validate(ds: xr.Dataset) -> list[str]:
    """Every difference between `ds` and the schema, one sentence each; an empty list if there is none."""
    try:
        kind = kind_of(ds)
    except ValueError as error:
        return [str(error)]
    if kind == MEASUREMENT and f"{kind} {ds.attrs.get('measured')}" not in TABLE:
        return [f"attribute measured is {ds.attrs.get('measured')!r}, not 'history' or 'impacts'"]
    variables = variables_of(ds)
    found = [f"attribute {name} is missing" for name in ATTRIBUTES[kind] if name not in ds.attrs]
    version = ds.attrs.get("film_model_schema_version", VERSIONS[kind])
    if version != VERSIONS[kind]:
        found.append(f"attribute film_model_schema_version is {version!r}, not {VERSIONS[kind]!r}")
    known = {variable.name for variable in variables}
    found += [f"variable {name} is not in the schema" for name in ds.variables if name not in known]
    for variable in variables:
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
    own = pairs[: len(variable.flags)] if variable.more else pairs
    if own != variable.flags or len(values) != len(meanings):
        found.append(f"flags {values} {meanings}, not {dict(variable.flags)}")
    elif values and not all(np.isin(piece, values).all() for piece in pieces(array)):
        found.append("values that are no flags")
    if array.dtype == FLOAT and not variable.optional and not all(np.isfinite(p).all() for p in pieces(array)):
        found.append("values that are not finite")
    return found


def _contradictions(ds: xr.Dataset) -> list[str]:
    """What does not fit together in a dataset that has everything."""
    checks = {"content_sha256 is not that of the variables": ds.attrs["content_sha256"] == content_sha256(ds)}
    for name in ("scene", "sweep"):
        if f"{name}_toml" in ds.attrs:
            text = str(ds.attrs[f"{name}_toml"]).encode()
            good = ds.attrs.get(f"{name}_sha256") == hashlib.sha256(text).hexdigest()
            checks[f"{name}_sha256 is not that of {name}_toml"] = good
    if "t" in ds.variables:
        checks["t does not increase"] = bool((np.diff(ds["t"].values) > 0).all())
    if "event_time" in ds.variables:
        checks["an event_time is not on t"] = bool(np.isin(ds["event_time"].values, ds["t"].values).all())
    if "segment_count" in ds.variables:
        end, good = 0, True
        for begins, counts in zip(pieces(ds["segment_begin"]), pieces(ds["segment_count"]), strict=True):
            ends = end + np.cumsum(counts, dtype=np.int64)
            good, end = good and np.array_equal(np.ravel(begins) + np.ravel(counts), ends), int(ends.max(initial=end))
        checks["segment_begin is not the sum of the segment_count before"] = good
        checks["segment_count does not add up to the segments"] = end == ds.sizes["segment"]
    return [message for message, good in checks.items() if not good]
