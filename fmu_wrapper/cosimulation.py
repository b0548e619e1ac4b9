"""Run an exported FMU under FMPy, as a dataset of the library's schema."""

from __future__ import annotations

import itertools
import json
import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr

from film_datasets.provenance import PROGRAM, provenance, text_and_hash
from film_datasets.schema import HISTORY, TABLE, content_sha256
from film_model import units
from film_model.core import native
from film_model.errors import SimulationError
from film_model.fields import whole
from film_model.history import MOTION, SUMMARY
from fmu_wrapper import resource
from fmu_wrapper.instance import Fmu, Row, Slave, opened, started
from fmu_wrapper.variables import KINDS, Variable, reference
from fmu_wrapper.variables import VARIABLES as FMU_VARIABLES

Mode = Literal["steps", "events", "exchange"]
"""Co-Simulation; Co-Simulation with event mode (FMI 3.0); Model Exchange with CVODE."""

Input = float | str | Callable[[float], float]
"""An input over time: a quantity, or a function of time that is held over each step (SI)."""

MOST_STEPS = 2_000_000
"""Of a run, whose rows are all kept in memory."""

EXCHANGE_SOLVER = 1e-10
"""CVODE's tolerance in Model Exchange, unless told otherwise."""

_TIMED = {
    "time_contact_begins": "contact_begins",
    "time_of_maximum_indentation": "maximum_indentation",
    "time_impactor_stops": "impactor_stops",
    "time_contact_ends": "contact_ends",
}
"""Outputs that tell the time of an event, in the order in which events at one time happen."""

_TOLD = (*_TIMED, "event_count", "last_event", "time_of_last_event", "stage", "phase", "contact_count")
_BESIDES = ("maximum_force", "support_velocity")
RECORDED = (*MOTION, *_TOLD, *_BESIDES)


def run(
    path: str | os.PathLike[str],
    *,
    mode: Mode = "steps",
    step_size: Any = None,
    stop_time: Any = None,
    start_values: Mapping[str, Any] | None = None,
    inputs: Mapping[str, Input] | None = None,
    tolerance: float = EXCHANGE_SOLVER,
) -> xr.Dataset:
    """Simulate an impact FMU of this package under FMPy: motion and events in the library's schema.

    step_size, stop_time: communication step and end ("1 us" or s), by default those of the FMU. start_values: of
    parameters, as quantities or SI numbers. inputs: external_force and support_velocity; functions are held over each
    step and are for Co-Simulation only. tolerance: of CVODE. Time counts from first touch, as in a history; it is
    negative before. Values of the summary that an FMU does not tell (energies) are NaN, and so are those that have not
    happened when the run ends: an impact that is slower than the scene's, or begins later, needs a stop_time.

    Raises ValueError for an argument that does not fit the FMU, SimulationError when the FMU reports an error,
    ImportError without FMPy.
    """
    if mode not in get_args(Mode):
        raise ValueError(f"mode: {mode!r} is not allowed: {' or '.join(get_args(Mode))} is needed")
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance: {tolerance!r} is not allowed: a number above 0 and below 1 is needed")
    with opened(path) as fmu:
        if KINDS[fmu.data.kind] != "impact":
            raise ValueError(f"{path}: a contact has no motion of its own; only impact FMUs can be run alone")
        if mode == "events" and fmu.version == 2:
            raise ValueError(f"{path}: mode 'events' needs FMI 3.0, this is FMI 2.0")
        experiment = fmu.description.defaultExperiment
        stop = _positive("stop_time", float(experiment.stopTime) if stop_time is None else stop_time)
        step = _positive("step_size", float(experiment.stepSize) if step_size is None else step_size)
        if stop / step > MOST_STEPS:
            raise ValueError(
                f"step_size: {step:g} s is {stop / step:.3g} steps to {stop:g} s, {MOST_STEPS} are allowed"
            )
        starts = _start_values(fmu, start_values or {})
        given = {name: _input(name, value) for name, value in (inputs or {}).items()}
        if mode == "exchange":
            changing = [name for name, value in given.items() if callable(value)]
            if changing:
                raise ValueError(f"inputs: {changing[0]} must be one value in mode 'exchange'")
            rows, events = _exchanged(fmu, stop, step, starts, given, tolerance)
        else:
            rows, events = _stepped(fmu, mode == "events", stop, step, starts, given)
        ds = _dataset(fmu, rows, events, mode, starts)
        if starts or given:
            ds.attrs["start_values"] = "\n".join(_line(name, value) for name, value in {**starts, **given}.items())
        return ds


def _line(name: str, value: Any) -> str:
    """A parameter or input of a run as a line of TOML."""
    dimension = next(v.dimension for v in FMU_VARIABLES if v.name == name)
    unit = units.scene_unit(dimension) if dimension else ""
    if callable(value):
        return f'{name} = "a function of time"'
    return f'{name} = "{value!r} {unit}"' if unit else f"{name} = {value!r}"


def _read(name: str, read: Callable[[Any], float], value: Any) -> float:
    try:
        return float(read(value))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _si(name: str, value: Any, dimension: str) -> float:
    return _read(name, lambda given: units.to_si(given, dimension, bare=True), value)


def _positive(name: str, value: Any) -> float:
    number = _si(name, value, "time")
    if not 0.0 < number < math.inf:
        raise ValueError(f"{name}: {number:g} s must be > 0 s")
    return number


def _start_values(fmu: Fmu, given: Mapping[str, Any]) -> dict[str, float]:
    known = {
        v.name: v for v in FMU_VARIABLES if v.causality.get("impact") == "parameter" and resource.has(fmu.data, v.name)
    }
    read: dict[str, float] = {}
    for name, value in given.items():
        if name not in known:
            raise ValueError(f"start_values: this FMU has no parameter {name!r}; it has {', '.join(known)}")
        variable, where = known[name], f"start_values: {name}"
        if variable.dimension is None:
            assert variable.high is not None
            read[name] = _read(where, whole(1, int(variable.high)).read, value)
        else:
            read[name] = _si(where, value, variable.dimension)
    return read


def _inputs() -> dict[str, Variable]:
    return {v.name: v for v in FMU_VARIABLES if v.causality.get("impact") == "input"}


def _input(name: str, value: Input) -> Any:
    inputs = _inputs()
    if name not in inputs:
        raise ValueError(f"inputs: there is no input {name!r}; there are {', '.join(inputs)}")
    dimension = inputs[name].dimension
    assert dimension is not None
    return value if callable(value) else _si(f"inputs: {name}", value, dimension)


def _at(time: float, value: Any) -> float:
    number: Any = value(time) if callable(value) else value
    return float(number)


# ---------------------------------------------------------------- Co-Simulation


def _stepped(
    fmu: Fmu, event_mode: bool, stop: float, step: float, starts: Mapping[str, float], inputs: Mapping[str, Any]
) -> tuple[list[Row], list[Row]]:
    """Rows at communication points and at events, and events."""
    first = {name: _at(0.0, value) for name, value in inputs.items()}
    rows: list[Row] = []
    events: list[Row] = []
    with started(fmu, event_mode, {**starts, **first}) as slave:
        before = slave.get(RECORDED)
        rows.append({"time": 0.0, **before})
        events += [_event(0.0, name, before) for name in _passed(dict.fromkeys(_TOLD, 0.0), before, 0.0) or {}]
        count = max(1, math.ceil(stop / step * (1.0 - 1e-12)))
        for n in range(count):
            time, end = n * step, min((n + 1) * step, stop)
            for name, value in inputs.items():
                slave.set(name, _at(time, value))
            if event_mode:
                _step_with_events(slave, time, end, rows, events)
            else:
                _step_and_look_back(slave, time, end, rows, events)
    return rows, events


def _step_with_events(slave: Slave, time: float, end: float, rows: list[Row], events: list[Row]) -> None:
    while True:
        time, event = slave.step(time, end - time)
        if event:
            slave.own.enterEventMode()
            slave.handle()
        row = slave.get(RECORDED)
        rows.append({"time": time, **row})
        if event and row["event_count"] > rows[-2]["event_count"]:
            events.append(_event(time, native.EVENTS[int(row["last_event"])], row))
        if time >= end:
            return


def _step_and_look_back(slave: Slave, time: float, end: float, rows: list[Row], events: list[Row]) -> None:
    """A step; if it passed events, again from its beginning to each of them, at the times it has told."""
    saved, before = slave.save(), rows[-1]
    slave.step(time, end - time)
    after = slave.get(RECORDED)
    passed = _passed(before, after, time)
    if passed is None and end - time > 1e-12 * end:  # more than the outputs can tell
        slave.restore(saved)
        middle = 0.5 * (time + end)
        _step_and_look_back(slave, time, middle, rows, events)
        _step_and_look_back(slave, middle, end, rows, events)
        return
    if passed is None:
        passed = dict.fromkeys(_at_once(before, after), after["time_of_last_event"])
    if not passed:
        rows.append({"time": end, **after})
        slave.own.freeFMUstate(saved) if slave.version == 2 else slave.own.freeFMUState(saved)
        return
    slave.restore(saved)
    now, told = time, {name: after[name] for name in _TOLD}
    for name, at in passed.items():
        at = min(max(at, now), end)
        if at > now:
            slave.step(now, at - now)
        now = at
        row = slave.get(RECORDED)
        if at > rows[-1]["time"]:
            rows.append({"time": at, **row})
        events.append(_event(at, name, {**row, "stage": _stage_after(slave, now, end)}))
    if end > now:
        slave.step(now, end - now)
    rows.append({"time": end, **slave.get(RECORDED), **told})


def _stage_after(slave: Slave, now: float, end: float) -> float:
    """The stage right after an event, which rounding may have put on the other side of the step."""
    ahead = 1e-6 * (end - now)
    if not now + ahead > now:  # the step ends here, but for rounding
        return slave.get(("stage",))["stage"]
    saved = slave.save()
    slave.step(now, ahead)
    stage = slave.get(("stage",))["stage"]
    slave.restore(saved)
    return stage


def _passed(before: Mapping[str, float], after: Mapping[str, float], since: float) -> dict[str, float] | None:
    """Events between two readings, with their times, in order; None when the outputs do not tell them all."""
    count = round(after["event_count"] - before["event_count"])
    if count == 0:
        return {}
    new_contact = after["contact_count"] > before["contact_count"]
    found: dict[str, float] = {}
    for output, name in _TIMED.items():
        happened = after[output] != before[output] or (new_contact and name == "contact_begins")
        if happened and (after[output] >= since and (after[output] > 0.0 or new_contact)):
            found[name] = after[output]
    last = native.EVENTS[int(after["last_event"])]
    if last not in found:
        found[last] = after["time_of_last_event"]
    if len(found) != count:
        return None
    return dict(sorted(found.items(), key=lambda item: item[1]))


def _at_once(before: Mapping[str, float], after: Mapping[str, float]) -> list[str]:
    """Events at one time of which the outputs tell the last alone: where the target is fixed, a turn is a stop too."""
    last, turn = native.EVENTS[int(after["last_event"])], ["maximum_indentation", "impactor_stops"]
    return turn if after["event_count"] - before["event_count"] == 2 and last in turn else [last]


def _event(time: float, name: str, row: Row) -> Row:
    return {"time": time, "kind": native.EVENTS.index(name), **{key: row[key] for key in (*MOTION, *_BESIDES, "stage")}}


# ---------------------------------------------------------------- Model Exchange


def _exchanged(
    fmu: Fmu, stop: float, step: float, starts: Mapping[str, float], inputs: Mapping[str, float], tolerance: float
) -> tuple[list[Row], list[Row]]:
    from fmpy import simulate_fmu

    held = {**dict.fromkeys(_inputs(), 0.0), **inputs}
    kinds = np.dtype([("time", np.float64), *((name, np.float64) for name in held)])
    signals: Any = np.array([(0.0, *held.values()), (stop, *held.values())], kinds) if inputs else None
    try:
        result: Any = simulate_fmu(
            fmu.folder,
            fmi_type="ModelExchange",
            solver="CVode",
            validate=False,
            stop_time=stop,
            output_interval=step,
            relative_tolerance=tolerance,
            start_values={**starts, **inputs},
            input=signals,
            output=RECORDED,
            model_description=fmu.description,
            logger=lambda *arguments: fmu.log(*arguments),
        )
    except Exception as error:
        if fmu.messages:
            raise SimulationError(f"{fmu.path}: {fmu.messages[-1]}") from error
        raise
    rows = [{name: float(row[name]) for name in ("time", *RECORDED)} for row in result]
    events = [_event(0.0, name, rows[0]) for name in _passed(dict.fromkeys(_TOLD, 0.0), rows[0], 0.0) or {}]
    for before, after in itertools.pairwise(rows):
        passed = _passed(before, after, before["time"])
        names = _at_once(before, after) if passed is None else list(passed)
        events += [_event(after["time"], name, after) for name in names]
    return rows, events


def _repeated(row: Row, following: Row | None) -> bool:
    """The first of two rows at one time: the values before an event."""
    return following is not None and following["time"] == row["time"]


# ---------------------------------------------------------------- datasets


def _dataset(fmu: Fmu, rows: list[Row], events: list[Row], mode: Mode, starts: Mapping[str, float]) -> xr.Dataset:
    distinct = [row for row, following in zip(rows, [*rows[1:], None], strict=True) if not _repeated(row, following)]
    touch = next((event["time"] for event in events if event["kind"] == native.EVENTS.index("contact_begins")), 0.0)
    columns: dict[str, Any] = {name: np.array([row[name] for row in distinct]) for name in ("time", *MOTION, "stage")}
    columns["t"] = columns.pop("time") - touch
    columns["event_time"] = np.array([event["time"] - touch for event in events])
    columns["event_kind"] = [event["kind"] for event in events]
    for name in (*MOTION, "stage"):
        columns[f"event_{name}"] = [event[name] for event in events]
    data = fmu.data
    peak = max(row["maximum_force"] for row in rows if row["contact_count"] <= 1)
    summary = _summary(events, touch, peak, bool(data.curve.stage[0].damped))
    columns.update({name: math.nan if value is None else value for name, value in summary.items()})
    mass = data.start[reference("mass")]
    tick = math.sqrt(mass * data.length_scale / data.force_scale)
    scales = {
        "length": data.length_scale,
        "force": data.force_scale,
        "time": tick,
        "velocity": data.length_scale / tick,
    }
    columns.update({f"scale_{name}": value for name, value in scales.items()})
    columns.update(drift_velocity=0.0, impactor_share=1.0, target_compliance=0.0)
    meanings = {"stages": tuple(f"stage_{k}" for k in range(data.curve.stages))}
    arrays: dict[str, Any] = {}
    for v in TABLE[HISTORY]:
        values = np.zeros(0) if "segment" in v.dims else columns[v.name]
        arrays[v.name] = (v.dims, np.asarray(values, dtype=v.dtype), v.attributes(meanings))
    ds = xr.Dataset({name: value for name, value in arrays.items() if name != "t"}, coords={"t": arrays["t"]})
    ds.attrs = _attributes(fmu, mode, starts)
    ds.attrs["content_sha256"] = content_sha256(ds)
    return ds


def _summary(events: list[Row], touch: float, peak: float, damped: bool) -> dict[str, float | None]:
    """Summary of the first contact, from its events and the largest force that the FMU tells."""
    summary: dict[str, float | None] = dict.fromkeys(SUMMARY)
    names = [native.EVENTS[int(event["kind"])] for event in events]
    end = names.index("contact_ends") if "contact_ends" in names else len(names)
    contact = dict(zip(reversed(names[: end + 1]), reversed(events[: end + 1]), strict=True))
    turns = [e for e, name in zip(events[: end + 1], names, strict=False) if name == "maximum_indentation"]
    begins, ends = contact.get("contact_begins"), contact.get("contact_ends")
    if turns:
        deepest = max(turns, key=lambda event: event["indentation"])
        summary["maximum_indentation"] = deepest["indentation"]
        summary["time_of_maximum_indentation"] = deepest["time"] - touch
        summary["maximum_force"] = max(peak, *(event["contact_force"] for event in events[: end + 1]))
    if "impactor_stops" in contact:
        summary["time_impactor_stops"] = contact["impactor_stops"]["time"] - touch
    if begins is not None and ends is not None:
        summary["contact_duration"] = ends["time"] - touch
        summary["permanent_indentation"] = 0.0 if damped else ends["indentation"]  # its dent closes after the end
        summary["rebound_velocity"] = ends["impactor_velocity"]
        before, after = (event["impactor_velocity"] - event["support_velocity"] for event in (begins, ends))
        if before > 0.0:  # the contact force of first touch may have moved the struck point already
            summary["coefficient_of_restitution"] = -after / before
    return summary


def _attributes(fmu: Fmu, mode: Mode, starts: Mapping[str, float]) -> dict[str, Any]:
    resources = Path(fmu.folder, "resources")
    text = (resources / "scene.toml").read_text("utf-8")
    notes = json.loads((resources / resource.NOTES).read_text("utf-8"))
    how = {"steps": "Co-Simulation", "events": "Co-Simulation with event mode", "exchange": "Model Exchange with CVODE"}
    legs = ("loading_segments", "unloading_segments")
    loading, unloading = (int(starts.get(leg, fmu.data.start[reference(leg)])) for leg in legs)
    return {
        **provenance(
            HISTORY,
            title=fmu.description.description or "Impact",
            summary=f"Impact simulated by an FMU (FMI {fmu.description.fmiVersion}), {how[mode]}: motion and events.",
            source=f"{PROGRAM}, FMU under FMPy",
            command="fmu_wrapper.run",
            comment="t counts in seconds from first touch and is no date. An FMU tells no segments and no energies. "
            "Scene, effects and warnings are those of the export; attribute start_values has what the run was given.",
        ),
        **text_and_hash("scene", text),
        "contact_law": notes["contact_law"],
        "outcome": "see events",
        "effects": "\n".join(notes["effects"]),
        "warnings": "\n".join(notes["warnings"]) or "none",
        "estimated_accuracy": math.nan,
        "segments": np.int32(loading),
        "unloading_segments": np.int32(unloading),
    }
