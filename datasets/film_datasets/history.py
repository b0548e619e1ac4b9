"""A history as a dataset: motion over time, events, summary, and the closed-form segments of the motion."""

from __future__ import annotations

import hashlib
import os
import re
from dataclasses import asdict
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_datasets.schema import BRANCHES, SCHEMA_NAME, SCHEMA_VERSION, VARIABLES, content_sha256
from film_model.core.native import EVENTS, LINE_DTYPE
from film_model.effects import Effect
from film_model.history import MOTION, History, stage_names
from film_model.laws import AbstractLaw
from film_model.scene import Scene
from film_model.scene_file import text_from_table

NEAREST_SAMPLE = 1e-9
"""Even samples nearer to an event than this part of the contact are left out: differences would be mere rounding."""

REFERENCES = (
    "Big-Alabo, A., Cartmell, M. P. and Harrison, P. (2017): On the solution of asymptotic impact problems with "
    "significant localised indentation. Proc. IMechE Part C: J. Mechanical Engineering Science 231(5), 807-822, "
    "doi:10.1177/0954406216628556"
)

COMMENT = (
    "SI units; t counts in seconds from first touch and is no date. Displacements, velocities and forces are positive "
    "into the target. No featureType: the data have no place on Earth. The segments give the motion at any time in "
    "closed form. On segment k, with time, indentation and velocity in the units scale_*, f = phi + kappa (xi - xi_k), "
    "d nu/dt = load - f, d xi/dt = nu - gamma f, and the target's displacement grows at gamma f. The impactor's "
    "velocity is drift_velocity + impactor_share nu. contact_force is the contact law's at that indentation. Where "
    "target_compliance is not 0, xi is the indentation and target_compliance contact_force together. A target that "
    "vibrates has no segments. "
    "scene_toml is the scene file to run again."
)


def to_dataset(history: History, samples: int = 201) -> xr.Dataset:
    """A history as an xarray.Dataset with the variables of `schema.VARIABLES`, in SI, with CF 1.11 attributes.

    samples: number of evenly spaced times from first touch to the last event, both included; the times of all events
    come on top, exactly. Raises ValueError for fewer than 2 samples.
    """
    if isinstance(samples, bool) or not isinstance(samples, int | np.integer) or samples < 2:
        raise ValueError(f"samples: {samples!r} must be a whole number, 2 or more")
    stages = stage_meanings(history)
    columns = {
        **_motion(history, _times(history, int(samples))),
        **_events(history),
        **{name: np.nan if value is None else value for name, value in history.summary.items()},
        **_segments(history),
    }
    data: dict[str, Any] = {
        v.name: (v.dims, np.asarray(columns[v.name], dtype=v.dtype), v.attributes(stages)) for v in VARIABLES
    }
    ds = xr.Dataset({name: value for name, value in data.items() if name != "t"}, coords={"t": data["t"]})
    ds.attrs = _attributes(history, content_sha256(ds))
    return ds


def lines_of(ds: xr.Dataset) -> NDArray[Any]:
    """The segments of a dataset as the core's lines (`native.LINE_DTYPE`), for `native.sample`; none if it vibrates."""
    lines: NDArray[Any] = np.empty(ds.sizes["segment"], LINE_DTYPE)
    for name in LINE_DTYPE.names or ():
        lines[name] = ds[f"segment_{name}"].values
    return lines


def stage_meanings(history: History) -> tuple[str, ...]:
    """The law's stage names as CF flag meanings: one word each, all different."""
    words = list(BRANCHES.values())
    for name in history.problem.curve.stage_names:
        word = re.sub(r"[^A-Za-z0-9_.+@-]", "_", name) or "stage"
        words.append(word if word not in words else f"{word}_{len(words)}")
    return tuple(words[len(BRANCHES) :])


def scene_text(scene: Scene) -> str:
    """The scene file; a law that is not film-model's is there by its name only."""
    table = scene.to_table()
    if isinstance(scene.contact.law, AbstractLaw):
        table["contact"]["law"] = scene.contact.law.name
    return text_from_table(table)


def _times(history: History, samples: int) -> NDArray[np.float64]:
    """Even times and event times, ascending, each once."""
    events = np.array([event.time for event in history.events])
    even = np.linspace(0.0, history.duration, samples)
    near = np.abs(even[:, None] - events).min(axis=1, initial=np.inf) <= NEAREST_SAMPLE * history.duration
    return np.union1d(even[~near], events)


def _stage_numbers(history: History, names: Any) -> list[int]:
    count = len(history.problem.curve.stage_names)
    numbers = {name: k if k < count else k - count - 2 for k, name in enumerate(stage_names(history.problem))}
    return [numbers[name] for name in names]


def _motion(history: History, t: NDArray[np.float64]) -> dict[str, Any]:
    """Samples at t [s]; at an event they are the event's own values, which sampling meets to rounding only."""
    samples = history.sample_si(t)
    columns: dict[str, Any] = {name: np.array(getattr(samples, name)) for name in MOTION}
    columns["stage"] = np.array(_stage_numbers(history, samples.stage))
    for name, column in _events(history).items():
        if name not in ("event_kind", "event_time"):
            columns[name.removeprefix("event_")][np.searchsorted(t, [e.time for e in history.events])] = column
    return {"t": t, **columns}


def _events(history: History) -> dict[str, Any]:
    return {
        "event_kind": [EVENTS.index(event.name) for event in history.events],
        "event_time": [event.time for event in history.events],
        "event_stage": _stage_numbers(history, [event.stage for event in history.events]),
        **{f"event_{name}": [getattr(event, name) for event in history.events] for name in MOTION},
    }


def _segments(history: History) -> dict[str, Any]:
    problem, lines = history.problem, history.lines
    return {
        **{f"scale_{name}": value for name, value in asdict(problem.scales).items()},
        "drift_velocity": problem.drift,
        "impactor_share": problem.share,
        "target_compliance": problem.curve.native.compliance,
        **{f"segment_{name}": lines[name] for name in LINE_DTYPE.names or ()},
    }


def _attributes(history: History, content: str) -> dict[str, Any]:
    """Global attributes."""
    scene, law, accuracy = history.scene, history.problem.law, history.accuracy
    text, now, release = scene_text(scene), _now(), _version()
    kind, name = scene.target.kind, f"film-model {release}"
    requested = {} if accuracy.requested is None else {"requested_accuracy": accuracy.requested}
    return {
        "Conventions": "CF-1.11",
        "title": scene.title or f"Impact on a {kind}",
        "summary": f"Impact of a compact body (target: {kind}, contact law: {law.name}): motion, contact force and "
        f"events from first touch. Outcome: {history.outcome.value}.",
        "source": f"{name}, {_method(history)}",
        "references": REFERENCES,
        "history": f"{now} {name}: film_datasets.to_dataset",
        "license": "film-model claims no rights in its results; the software is under the MIT license",
        "date_created": now,
        "comment": COMMENT,
        "film_model_schema": SCHEMA_NAME,
        "film_model_schema_version": SCHEMA_VERSION,
        "film_model_version": release,
        "scene_toml": text,
        "scene_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "content_sha256": content,
        "contact_law": str(law),
        "outcome": history.outcome.value,
        "effects": "\n".join(_effect_line(effect) for effect in history.problem.effects),
        "warnings": "\n".join(history.warnings) or "none",
        **requested,
        "estimated_accuracy": accuracy.estimated,
        "segments": np.int32(accuracy.segments),
        "unloading_segments": np.int32(accuracy.unloading_segments),
    }


def _method(history: History) -> str:
    if history.vibration is None:
        return f"force-indentation linearisation method (FILM), {history.accuracy.lines} segments"
    return f"contact law on {history.accuracy.modes} modes of the target, integrated by DOP853"


def _effect_line(effect: Effect) -> str:
    """'plasticity: simulated, V/V_Y = 5.06 (threshold 1); the yield velocity is 0.0494 m/s: law big-alabo'."""
    value = "" if effect.value is None else f", {effect.indicator} = {effect.value:.4g}"
    limit = "" if effect.threshold is None else f" (threshold {effect.threshold:g})"
    return f"{effect.name}: {effect.state}{value}{limit}; {effect.reason}"


def _now() -> str:
    """This moment, or SOURCE_DATE_EPOCH, as ISO 8601 in UTC."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        moment = datetime.now(UTC) if given is None else datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError):
        raise ValueError(f"SOURCE_DATE_EPOCH: {given!r} must be a whole number of seconds since 1970") from None
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def _version() -> str:
    try:
        return version("film-model")
    except PackageNotFoundError:
        return "unknown"
