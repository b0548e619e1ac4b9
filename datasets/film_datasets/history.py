"""A history as a dataset: motion over time, events, summary, and the closed-form segments of the motion."""

from __future__ import annotations

import contextlib
from dataclasses import asdict
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from film_datasets.provenance import PROGRAM, provenance, scene_text, text_and_hash
from film_datasets.schema import BRANCHES, HISTORY, TABLE, content_sha256, flag_words, kind_of
from film_model.core.native import BRANCH_NAMES, EVENTS, LINE_DTYPE
from film_model.effects import Effect, choose, percent
from film_model.errors import Outcome, SceneError
from film_model.history import MOTION, SUMMARY, Accuracy, Event, History, Samples, stage_names
from film_model.plot import Trace
from film_model.problem import problem_of
from film_model.scene import Scene
from film_model.solve import simulate

NEAREST_SAMPLE = 1e-9
"""Even samples nearer to an event than this part of the contact are left out: differences would be mere rounding."""

COMMENT = (
    "t counts in seconds from first touch and is no date. The segments give the motion at any time in closed form. On "
    "segment k, with time, indentation and velocity in the units scale_*, f = phi + kappa (xi - xi_k) + "
    "damping d xi/dt, d nu/dt = load - f, d xi/dt = nu - gamma f, and the target's displacement grows at gamma f. The "
    "impactor's velocity is drift_velocity + impactor_share nu. contact_force is the contact law's at that indentation "
    "and its rate. Where target_compliance is not 0, xi is the indentation and target_compliance contact_force "
    "together. A target that vibrates has no segments. scene_toml is the scene file to run again."
)


def to_dataset(history: History | Any, samples: int = 201, command: str = "film_datasets.to_dataset") -> xr.Dataset:
    """A history as an xarray.Dataset with the variables of `schema.TABLE`, in SI, with CF 1.11 attributes.

    samples: number of evenly spaced times from first touch to the last event, both included; the times of all events
    come on top, exactly. command: what is running, for the attribute `history`. A study of what accuracy costs becomes
    a dataset of kind impact_cost_study. Raises ValueError for fewer than 2 samples.
    """
    if not isinstance(history, History):
        from film_datasets.cost import study_dataset

        return study_dataset(history)
    if isinstance(samples, bool) or not isinstance(samples, int | np.integer) or samples < 2:
        raise ValueError(f"samples: {samples!r} must be a whole number, 2 or more")
    columns = {
        **_motion(history, _times(history, int(samples))),
        **_events(history),
        **{name: np.nan if value is None else value for name, value in history.summary.items()},
        **_segments(history),
    }
    meanings = {"stages": flag_words(history.problem.curve.stage_names, tuple(BRANCHES.values()))}
    data: dict[str, Any] = {
        v.name: (v.dims, np.asarray(columns[v.name], dtype=v.dtype), v.attributes(meanings)) for v in TABLE[HISTORY]
    }
    ds = xr.Dataset({name: value for name, value in data.items() if name != "t"}, coords={"t": data["t"]})
    ds.attrs = _attributes(history, command)
    ds.attrs["content_sha256"] = content_sha256(ds)
    return ds


def lines_of(ds: xr.Dataset) -> NDArray[Any]:
    """The segments of a dataset as the core's lines (`native.LINE_DTYPE`), for `native.sample`; none if it vibrates."""
    lines: NDArray[Any] = np.empty(ds.sizes["segment"], LINE_DTYPE)
    for name in LINE_DTYPE.names or ():
        lines[name] = ds[f"segment_{name}"].values
    return lines


def history_of(ds: xr.Dataset) -> History:
    """The history that a dataset was made from, with which it can be sampled and drawn, from the dataset alone.

    On a target that vibrates there are no segments: the impact is simulated anew. Raises ValueError where the contact
    law is not one of film-model's own, where segments are missing, and for the run of an FMU, which tells none.
    """
    scene = scene_of(ds)
    problem = problem_of(scene)
    if problem.vibrates:
        return simulate(scene)
    lines, names = lines_of(ds), stage_names(problem)
    if not lines.size:
        raise ValueError("the run of an FMU tells no segments: its motion is in the dataset, at the times t only")
    last = float(ds["event_time"].values.max(initial=0.0)) / problem.scales.time
    if lines["time"][0] != 0.0 or lines["time"][-1] < last * (1.0 - NEAREST_SAMPLE):
        raise ValueError("segments of this history are missing: the dimension segment must be whole")
    summary = _summary_of(ds)
    accuracy = Accuracy(
        ds.attrs.get("requested_accuracy"),
        float(ds.attrs["estimated_accuracy"]),
        int(ds.attrs["segments"]),
        int(ds.attrs["unloading_segments"]),
        lines.size - 1,
    )
    warnings = str(ds.attrs["warnings"])
    said = () if warnings == "none" else tuple(warnings.split("\n"))
    return History(scene, problem, lines, _events_of(ds, names), Outcome(ds.attrs["outcome"]), summary, accuracy, said)


def trace_of(ds: xr.Dataset) -> Trace:
    """What is drawn of a history: of its segments, or where the history cannot be made again, of the samples at t.

    Those are from first touch to the last end of contact, or to the end of the run if contact goes on. Raises
    ValueError where there is no contact.
    """
    try:
        return Trace.of(history_of(ds))
    except ValueError:  # the run of an FMU, or a law of the user's own
        pass
    flags = str(ds["stage"].attrs["flag_meanings"]).split()[len(BRANCHES) :]
    law, stages = str(ds.attrs["contact_law"]).partition("(")[0], [word.replace("_", " ") for word in flags]
    with contextlib.suppress(ValueError):
        problem = problem_of(scene_of(ds))
        law, stages = problem.law.name, problem.curve.stage_names
    names = [*stages, *(BRANCH_NAMES[number] for number in BRANCHES)]
    events = _events_of(ds, names)
    if not events:
        raise ValueError("there is no contact in this run: nothing to draw")
    end = events[-1].time if events[-1].name == "contact_ends" else float(ds["t"][-1])
    part = ds.isel(t=(ds["t"].values >= 0.0) & (ds["t"].values <= end))
    motion = {name: part[name].values for name in MOTION}
    samples = Samples(time=part["t"].values, stage=np.array(names)[part["stage"].values], **motion)
    return Trace(str(ds.attrs["title"]), law, tuple(stages), samples, end, events, _summary_of(ds), {})


def _summary_of(ds: xr.Dataset) -> dict[str, float | None]:
    return {name: None if np.isnan(ds[name]) else float(ds[name]) for name in SUMMARY}


def _events_of(ds: xr.Dataset, names: list[str]) -> tuple[Event, ...]:
    """The events of a dataset, with the names of stages by their numbers."""
    rows = zip(*(ds[f"event_{name}"].values.tolist() for name in ("kind", "time", "stage", *MOTION)), strict=True)
    return tuple(Event(EVENTS[kind], time, names[stage], *motion) for kind, time, stage, *motion in rows)


def scene_of(ds: xr.Dataset) -> Scene:
    """The scene in the attribute scene_toml. Raises ValueError where there is none, or the law is the user's own."""
    if "scene_toml" not in ds.attrs:
        raise ValueError(f"a dataset of kind {kind_of(ds)} has no scene")
    law = str(ds.attrs.get("contact_law", ""))
    try:
        scene = Scene.from_text(str(ds.attrs["scene_toml"]), "scene_toml")
        same = not law or str(choose(scene).law) == law
    except SceneError:
        same, scene = False, None
    if scene is None or not same:
        raise ValueError(f"the contact law {law} was an object of Python: the scene cannot be made again without it")
    return scene


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


def _attributes(history: History, command: str) -> dict[str, Any]:
    """Global attributes but the hash of the content."""
    scene, law, accuracy = history.scene, history.problem.law, history.accuracy
    kind = scene.target.kind
    requested = {} if accuracy.requested is None else {"requested_accuracy": accuracy.requested}
    return {
        **provenance(
            HISTORY,
            title=scene.title or f"Impact on a {kind}",
            summary=f"Impact of a compact body (target: {kind}, contact law: {law.name}): motion, contact force and "
            f"events from first touch. Outcome: {history.outcome.value}.",
            source=f"{PROGRAM}, {_method(history)}",
            command=command,
            comment=COMMENT,
        ),
        **text_and_hash("scene", scene_text(scene)),
        "contact_law": str(law),
        "outcome": history.outcome.value,
        "effects": "\n".join(effect_line(effect) for effect in history.problem.effects),
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


def effect_line(effect: Effect) -> str:
    """'gravity: not needed, m g/F_m = 0.00115 (threshold 0.00667), left out 0.18 %; the weight is small …'."""
    value = "" if effect.value is None else f", {effect.indicator} = {effect.value:.4g}"
    limit = "" if effect.threshold is None else f" (threshold {effect.threshold:.4g})"
    change = "" if effect.change is None else f", left out it changes the summary by {percent(effect.change)}"
    return f"{effect.name}: {effect.state}{value}{limit}{change}; {effect.reason}"
