"""Run an FMU under FMPy: rows of outputs at communication points and events, and the events themselves."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from film_model.base.errors import SimulationError
from film_model.core import native
from film_model.solve.history import MOTION
from fmu_wrapper import resource
from fmu_wrapper.instance import Fmu, Row, Slave, started
from fmu_wrapper.variables import EVENT_TIMES, STRESSES, of_sensors

_EVENT_OUTPUTS = (*EVENT_TIMES, "event_count", "last_event", "time_of_last_event", "stage", "phase", "contact_count")
_OTHER_OUTPUTS = ("maximum_force", "maximum_indentation", "largest_force", "support_velocity", "validity", *STRESSES)
RECORDED = (*MOTION, *_EVENT_OUTPUTS, *_OTHER_OUTPUTS)
"""Outputs in each row."""

ALONG = ("sliding_velocity", "tangential_velocity", "spin", "friction_force")
"""Further outputs in each row of an FMU with friction."""


def value_at(time: float, value: Any) -> float:
    """Value of an input, a number or a function of time, at a time [s]."""
    number: Any = value(time) if callable(value) else value
    return float(number)


def _recorded(fmu: Fmu) -> tuple[str, ...]:
    along = ALONG if resource.slides(fmu.data) else ()
    return (*RECORDED, *along, *(v.name for v in of_sensors(fmu.sensors)))


# ---------------------------------------------------------------- Co-Simulation


def stepped(
    fmu: Fmu, event_mode: bool, stop: float, step: float, starts: Mapping[str, float], inputs: Mapping[str, Any]
) -> tuple[list[Row], list[Row]]:
    """Co-Simulation: rows at communication points and at events, and events."""
    first = {name: value_at(0.0, value) for name, value in inputs.items()}
    rows: list[Row] = []
    events: list[Row] = []
    with started(fmu, event_mode, {**starts, **first}) as slave:
        before = slave.get(_recorded(slave.fmu))
        rows.append({"time": 0.0, **before})
        events += _events_at_start(before)
        count = max(1, math.ceil(stop / step * (1.0 - 1e-12)))
        for n in range(count):
            time, end = n * step, min((n + 1) * step, stop)
            for name, value in inputs.items():
                slave.set(name, value_at(time, value))
            if event_mode:
                _step_in_event_mode(slave, time, end, rows, events)
            else:
                _step_and_repeat(slave, time, end, rows, events)
    return rows, events


def _step_in_event_mode(slave: Slave, time: float, end: float, rows: list[Row], events: list[Row]) -> None:
    """Steps that end at each event."""
    while True:
        time, event = slave.step(time, end - time)
        if event:
            slave.instance.enterEventMode()
            slave.handle()
        row = slave.get(_recorded(slave.fmu))
        rows.append({"time": time, **row})
        if event and row["event_count"] > rows[-2]["event_count"]:
            events.append(_event(time, native.EVENTS[int(row["last_event"])], row))
        if time >= end:
            return


def _step_and_repeat(slave: Slave, time: float, end: float, rows: list[Row], events: list[Row]) -> None:
    """A step without event mode. If it contains events, restore the state and step to the time of each event."""
    saved, before = slave.save(), rows[-1]
    slave.step(time, end - time)
    after = slave.get(_recorded(slave.fmu))
    times = _events_between(before, after, time)
    if times is None and end - time > 1e-12 * end:  # the outputs do not identify all events: halve the step
        slave.restore(saved)
        middle = 0.5 * (time + end)
        _step_and_repeat(slave, time, middle, rows, events)
        _step_and_repeat(slave, middle, end, rows, events)
        return
    if times is None:
        times = dict.fromkeys(_simultaneous_events(before, after), after["time_of_last_event"])
    if not times:
        rows.append({"time": end, **after})
        slave.discard(saved)
        return
    slave.restore(saved)
    now, reported = time, {name: after[name] for name in _EVENT_OUTPUTS}
    for name, at in times.items():
        at = min(max(at, now), end)
        if at > now:
            slave.step(now, at - now)
        now = at
        row = slave.get(_recorded(slave.fmu))
        if at > rows[-1]["time"]:
            rows.append({"time": at, **row})
        events.append(_event(at, name, {**row, "stage": _stage_after(slave, now, end)}))
    if end > now:
        slave.step(now, end - now)
    rows.append({"time": end, **slave.get(_recorded(slave.fmu)), **reported})


def _stage_after(slave: Slave, now: float, end: float) -> float:
    """The stage just after an event; by rounding, the step to the event may end just before it."""
    ahead = 1e-6 * (end - now)
    if not now + ahead > now:  # the step ends at the event, to rounding
        return slave.get(("stage",))["stage"]
    saved = slave.save()
    slave.step(now, ahead)
    stage = slave.get(("stage",))["stage"]
    slave.restore(saved)
    return stage


# ---------------------------------------------------------------- events


def _events_at_start(row: Row) -> list[Row]:
    times = _events_between(dict.fromkeys(_EVENT_OUTPUTS, 0.0), row, 0.0)
    return [_event(0.0, name, row) for name in times or {}]


def _events_between(before: Mapping[str, float], after: Mapping[str, float], since: float) -> dict[str, float] | None:
    """Events between two rows with their times, in order of time; None if the outputs do not identify all of them."""
    count = round(after["event_count"] - before["event_count"])
    if count == 0:
        return {}
    new_contact = after["contact_count"] > before["contact_count"]
    times: dict[str, float] = {}
    for output, name in EVENT_TIMES.items():
        happened = after[output] != before[output] or (new_contact and name == "contact_begins")
        if happened and (after[output] >= since and (after[output] > 0.0 or new_contact)):
            times[name] = after[output]
    last = native.EVENTS[int(after["last_event"])]
    if last not in times:
        times[last] = after["time_of_last_event"]
    if len(times) != count:
        return None
    return dict(sorted(times.items(), key=lambda item: item[1]))


def _simultaneous_events(before: Mapping[str, float], after: Mapping[str, float]) -> list[str]:
    """Events at one time, of which the outputs identify only the last.

    On a fixed target the impactor stops at maximum indentation.
    """
    last, turn = native.EVENTS[int(after["last_event"])], ["maximum_indentation", "impactor_stops"]
    return turn if after["event_count"] - before["event_count"] == 2 and last in turn else [last]


def _event(time: float, name: str, row: Row) -> Row:
    values = {key: row[key] for key in (*MOTION, *_OTHER_OUTPUTS, "stage")}
    return {"time": time, "kind": native.EVENTS.index(name), **values}


# ---------------------------------------------------------------- Model Exchange


def exchanged(
    fmu: Fmu, stop: float, step: float, starts: Mapping[str, float], inputs: Mapping[str, float], tolerance: float
) -> tuple[list[Row], list[Row]]:
    """Model Exchange with CVODE: rows and events. inputs: constant values of all inputs, or none."""
    from fmpy import simulate_fmu

    kinds = np.dtype([("time", np.float64), *((name, np.float64) for name in inputs)])
    signals: Any = np.array([(0.0, *inputs.values()), (stop, *inputs.values())], kinds) if inputs else None
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
            output=_recorded(fmu),
            model_description=fmu.description,
            logger=lambda *arguments: fmu.log(*arguments),
        )
    except Exception as error:
        if fmu.messages:
            raise SimulationError(f"{fmu.path}: {fmu.messages[-1]}") from error
        raise
    finally:
        _restore_logger()
    rows = [{name: float(row[name]) for name in ("time", *_recorded(fmu))} for row in result]
    events = _events_at_start(rows[0])
    for before, after in itertools.pairwise(rows):
        times = _events_between(before, after, before["time"])
        names = _simultaneous_events(before, after) if times is None else list(times)
        events += [_event(after["time"], name, after) for name in names]
    return rows, events


@cache
def _own_logger() -> Any:
    from fmpy.fmi2 import fmi2CallbackLoggerTYPE, printLogMessage

    return fmi2CallbackLoggerTYPE(printLogMessage)


def _restore_logger() -> None:
    """Give FMPy its own logger back: it keeps one for all FMUs of FMI 2, which is ours after a run, and gone by then.

    A message of the next FMU that FMPy runs by itself would go to memory that something else uses.
    """
    from ctypes import byref

    from fmpy.fmi2 import fmi2CallbackFunctions
    from fmpy.logging import addLoggerProxy

    callbacks = fmi2CallbackFunctions()
    callbacks.logger = _own_logger()
    addLoggerProxy(byref(callbacks))
