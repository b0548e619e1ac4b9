"""One impact as a dataset (motion over time, events, summary, closed-form segments), and back."""

from __future__ import annotations

import contextlib
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from film_datasets.contents import Contents, Values
from film_datasets.friction_dataset import friction_columns, read_friction
from film_datasets.provenance import PROGRAM, choice_of, provenance, text_and_hash, warnings_of
from film_datasets.scene_constants import constants_of, scene_key
from film_datasets.schema import (
    ADDED,
    BRANCHES,
    CONSTANTS,
    EQUATIONS_ON_MODES,
    HISTORY,
    MODE_ENERGY,
    SCENE_KEY,
    TABLE,
    branch_words,
    content_sha256,
    flag_meanings,
    flag_words,
    has,
    require,
)
from film_model.base.arrays import Array
from film_model.base.errors import Outcome
from film_model.base.foreign import Dataset
from film_model.core.native import BRANCH_NAMES, EVENTS
from film_model.plot.history import Trace
from film_model.solve.closed_form import TABLES, ClosedForm
from film_model.solve.history import MOTION, SUMMARY, Accuracy, Event, History, Samples, stage_names
from film_model.solve.modal_motion import ModalMotion
from film_model.solve.sensed import quantities_of
from film_model.solve.simulate import simulate_chosen

SAMPLES = 201
"""Evenly spaced times of a history, if no other number is asked for."""

NEAREST_SAMPLE = 1e-9
"""Even samples closer to an event than this fraction of the contact are omitted: over so short a time the difference
of two samples is rounding error."""

COMMENT = (
    "t counts in seconds from first touch and is no date. The segments give the motion at any time in closed form. On "
    "segment k, with time, indentation and velocity in the units scale_*, f = phi + kappa (xi - xi_k) + "
    "damping d xi/dt, d nu/dt = load - f, d xi/dt = nu - gamma f, and the target's displacement grows at gamma f. The "
    "impactor's velocity is drift_velocity + impactor_share nu. contact_force is the contact law's at that indentation "
    "and its rate. Where target_compliance is not 0, xi is the indentation and target_compliance contact_force "
    "together. A target that vibrates has no segments. scene_toml is the scene file to run again."
)

STEPS_COMMENT = (
    "t counts in seconds from first touch and is no date. The steps give the motion at any time in closed form; "
    f"{EQUATIONS_ON_MODES} scene_toml is the scene file to run again."
)


def history_dataset(
    history: History, samples: int = SAMPLES, command: str = "film_datasets.history_dataset"
) -> Dataset:
    """A history as a dataset of kind impact_history; see `film_datasets.to_dataset`."""
    return history_contents(history, samples, command).dataset()


def history_contents(history: History, samples: int, command: str) -> Contents:
    """Variables and attributes of that dataset."""
    if isinstance(samples, bool) or not isinstance(samples, (int, np.integer)) or samples < 2:  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"samples: {samples!r} must be a whole number, 2 or more")
    times = _times(history, int(samples))
    columns = {
        **_motion(history, times),
        **_events(history),
        **{name: np.nan if value is None else value for name, value in history.summary.items()},
        **_closed_form(history),
        **friction_columns(history.oblique),
        **_sensors(history, times),
        **constants_of(history.scene),
        "contact_law_name": history.problem.law.name,
        "scene_key": scene_key(history.scene.archived_text()),
    }
    curve = history.problem.curve
    stages = flag_words(curve.stage_names, tuple(BRANCHES.values()))
    meanings = {"stages": stages, "branches": branch_words(stages, curve.pulls and not curve.reversible)}
    data = {
        v.name: Values(v.dims, np.asarray(columns[v.name], dtype=v.dtype), v.attributes(meanings))
        for v in (
            *(v for part in ("", " steps", " friction", " sensors", " strains") for v in TABLE[HISTORY + part]),
            *CONSTANTS,
            SCENE_KEY.over(()),
        )
        if v.name in columns
    }
    for name, said in history.evidence.items():
        data[name].attrs["evidence"] = said
    for name, interval in history.intervals.items():
        data[name].attrs["model_interval"] = np.array([interval.low, interval.high])
    found = Contents(data, _attributes(history, command))
    found.attrs["content_sha256"] = content_sha256(cast("Any", found))
    return found


def tables_of(ds: Dataset) -> dict[str, NDArray[Any]]:
    """The tables of the closed form that a dataset has, by `film_model.solve.closed_form.TABLES`.

    Raises ValueError if a variable is missing or has another shape.
    """
    tables: dict[str, NDArray[Any]] = {}
    for dim, dtype in TABLES.items():
        names = {f"{dim}_{name}": name for name in dtype.names or ()}
        if not names.keys() & set(ds.variables):
            continue
        require(ds, names)
        tables[dim] = np.empty(ds.sizes.get(dim, 0), dtype)
        for own, name in names.items():
            shape = tables[dim][name].shape
            if ds[own].dims[:1] != (dim,) or ds[own].shape != shape:
                raise ValueError(
                    f"variable {own} has the shape {ds[own].shape}, not {shape} along {dim}: segments of several "
                    "datasets were joined, or the file is damaged; use the dataset that the impact came from"
                )
            tables[dim][name] = ds[own].values
    return tables


def lines_of(ds: Dataset) -> NDArray[Any]:
    """The segments of a dataset as the core's lines (`native.LINE_DTYPE`), for `native.sample`.

    Empty if the target vibrates or the dataset is the run of an FMU.
    """
    return tables_of(ds)["segment"]


def history_of(ds: Dataset) -> History:
    """The history that a dataset was made from, to be sampled and plotted without another march.

    Viscoelastic bodies have no segments, nor have targets that vibrate in files of schema 1.3 and older: such an impact
    is simulated again. Raises ValueError if the contact law was an object of Python, if segments are missing, and for
    the run of an FMU, which has no segments.

    >>> fd.history_of(fd.load("paper_stronge")).problem.law.name
    'stronge'
    """
    require(ds, (v.name for v in TABLE[HISTORY] if v.name not in SUMMARY))
    choice = choice_of(ds)
    scene, problem = choice.scene, choice.problem
    if problem.relaxation is not None or (problem.vibrates and not has(ds, "steps") and _is_older(ds)):
        return simulate_chosen(choice, scene.solver)
    form = ClosedForm(tables_of(ds), float(ds["target_compliance"]))
    lines, names, modes = form.tables["segment"], stage_names(problem), None
    if form.on_modes:
        require(ds, [MODE_ENERGY.name])
        modes = form.modal_motion(problem, problem.scales.time, ds[MODE_ENERGY.name].values / problem.scales.energy)
    _check_complete(ds, lines, modes, problem.scales.time)
    accuracy = Accuracy(
        ds.attrs.get("requested_accuracy"),
        float(ds.attrs["estimated_accuracy"]),
        int(ds.attrs["segments"]),
        int(ds.attrs["unloading_segments"]),
        max(lines.size - 1, 0),
        0 if modes is None else modes.modes,
    )
    return History(
        *(scene, choice, lines, _read_events(ds, names), Outcome(ds.attrs["outcome"]), _read_summary(ds), accuracy),
        *(warnings_of(ds), modes),
        oblique=read_friction(ds),
    )


def _is_older(ds: Dataset) -> bool:
    """Whether impacts on modes had no steps when the dataset was written."""
    versions = list(ADDED[HISTORY])
    return ds.attrs.get("film_model_schema_version") in versions[: versions.index("1.4")]


def _check_complete(ds: Dataset, lines: NDArray[Any], modes: ModalMotion | None, unit: float) -> None:
    """Raise ValueError unless the motion is stored from first touch to the last event. unit: of the lines' time, s."""
    last = float(ds["event_time"].values.max(initial=0.0)) * (1.0 - NEAREST_SAMPLE)
    if modes is not None:
        end = modes.segments[-1]
        if end["time"] + end["h"] < last:
            raise ValueError("steps of this history are missing: the dimension step must be complete")
        return
    if not lines.size:
        raise ValueError("the run of an FMU has no segments: its motion is known at the times t only")
    if lines["time"][0] != 0.0 or lines["time"][-1] < last / unit:
        raise ValueError("segments of this history are missing: the dimension segment must be complete")


def trace_of(ds: Dataset) -> Trace:
    """What is plotted of a history: its segments, or the samples at t if `history_of` raises ValueError.

    The samples are those from first touch to the last end of contact, or to the end of the run if contact goes on.
    Raises ValueError if there is no contact.
    """
    try:
        return Trace.of(history_of(ds))
    except ValueError:  # the run of an FMU, or a law that was an object of Python
        pass
    require(ds, (v.name for v in TABLE[HISTORY] if v.name not in SUMMARY))
    flags = flag_meanings(ds["stage"])[len(BRANCHES) :]
    law, stages = str(ds.attrs["contact_law"]).partition("(")[0], [word.replace("_", " ") for word in flags]
    with contextlib.suppress(ValueError):
        problem = choice_of(ds).problem
        law, stages = problem.law.name, problem.curve.stage_names
    names = [*stages, *(BRANCH_NAMES[number] for number in BRANCHES)]
    events = _read_events(ds, names)
    if not events:
        raise ValueError("there is no contact in this run: nothing to plot")
    end = events[-1].time if events[-1].name == "contact_ends" else float(ds["t"][-1])
    contact = ds.isel(t=(ds["t"].values >= 0.0) & (ds["t"].values <= end))
    motion = {name: contact[name].values for name in MOTION}
    samples = Samples(time=contact["t"].values, stage=np.array(names)[contact["stage"].values], **motion)
    return Trace(str(ds.attrs["title"]), law, tuple(stages), samples, end, events, _read_summary(ds), {})


def _read_summary(ds: Dataset) -> dict[str, float | None]:
    values = {name: float(ds[name]) for name in SUMMARY if name in ds}  # older files may lack some
    return {name: None if np.isnan(value := values.get(name, np.nan)) else value for name in SUMMARY}


def _read_events(ds: Dataset, names: list[str]) -> tuple[Event, ...]:
    """The events of a dataset; names: of the stages, by their numbers."""
    table = zip(*(ds[f"event_{name}"].values.tolist() for name in ("kind", "time", "stage", *MOTION)), strict=True)
    return tuple(Event(EVENTS[kind], time, names[stage], *motion) for kind, time, stage, *motion in table)


def _times(history: History, samples: int) -> Array:
    """Evenly spaced times and event times, increasing, each once."""
    events = np.array([event.time for event in history.events])
    even = np.linspace(0.0, history.duration, samples)
    near = np.abs(even[:, None] - events).min(axis=1, initial=np.inf) <= NEAREST_SAMPLE * history.duration
    return np.union1d(even[~near], events)


def _stage_numbers(history: History, names: Any) -> list[int]:
    count = len(history.problem.curve.stage_names)
    numbers = {name: k if k < count else k - count - 2 for k, name in enumerate(stage_names(history.problem))}
    return [numbers[name] for name in names]


def _motion(history: History, t: Array) -> dict[str, Any]:
    """Samples at t [s]; at an event the event's own values, from which samples differ by rounding."""
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


def _closed_form(history: History) -> dict[str, Any]:
    problem, form = history.problem, history.closed_form
    energies = history.vibration_energy_by_mode
    return {
        **{f"scale_{name}": value for name, value in problem.scales._asdict().items()},
        "drift_velocity": problem.drift,
        "impactor_share": problem.share,
        "target_compliance": form.compliance,
        **{f"{dim}_{name}": table[name] for dim, table in form.tables.items() for name in table.dtype.names or ()},
        **({} if energies is None else {MODE_ENERGY.name: energies}),
    }


def _sensors(history: History, times: Array) -> dict[str, Any]:
    """The columns of sensors; none without them, or if the target does not vibrate."""
    peaks = history.sensor_peaks
    if not peaks:
        return {}
    found, known = history.sensed_si(times), quantities_of(history.scene.target)
    largest = {name: [own.get(f"maximum_{name}", np.nan) for own in peaks.values()] for name in known}
    return {
        "sensor": list(found.names),
        **{f"sensor_{name}": getattr(found, name) for name in known},
        **{f"sensor_maximum_{name}": values for name, values in largest.items()},
    }


def _attributes(history: History, command: str) -> dict[str, Any]:
    """Global attributes except the hash of the content."""
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
            comment=COMMENT if history.vibration is None else STEPS_COMMENT,
        ),
        **text_and_hash("scene", scene.archived_text()),
        "contact_law": str(law),
        "outcome": history.outcome.value,
        "effects": "\n".join(effect.line for effect in history.effects),
        "warnings": "\n".join(history.warnings) or "none",
        **requested,
        "estimated_accuracy": accuracy.estimated,
        "segments": np.int32(accuracy.segments),
        "unloading_segments": np.int32(accuracy.unloading_segments),
    }


def _method(history: History) -> str:
    if history.relaxed is not None:
        return f"viscoelastic contact by Gauss collocation, {history.accuracy.lines} steps"
    if history.vibration is None:
        return f"force-indentation linearisation method (FILM), {history.accuracy.lines} segments"
    return f"contact law on {history.accuracy.modes} modes of the target, by Gauss collocation"
