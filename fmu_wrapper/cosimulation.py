"""Run an exported FMU under FMPy, as a dataset of the library's schema, and hold it against the library."""

from __future__ import annotations

import hashlib
import math
import os
import shutil
import tempfile
import tomllib
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr

from film_datasets.schema import ATTRIBUTES, SCHEMA_NAME, SCHEMA_VERSION, VARIABLES, content_sha256
from film_model import units
from film_model.component import ImpactComponent
from film_model.core import native
from film_model.errors import SimulationError
from film_model.history import MOTION, SUMMARY
from film_model.laws import LAWS
from film_model.scene import Scene
from film_model.version import __version__
from fmu_wrapper import resource
from fmu_wrapper.variables import KINDS, reference
from fmu_wrapper.variables import VARIABLES as FMU_VARIABLES

Mode = Literal["steps", "events", "exchange"]
"""Co-Simulation; Co-Simulation with event mode (FMI 3.0); Model Exchange with CVODE."""

Input = float | str | Callable[[float], float]
"""An input over time: a quantity, or a function of time that is held over each step (SI)."""

STEPS_TOLERANCE = 1e-12
"""How well Co-Simulation must agree with the library, relative to the largest value of a variable."""

EXCHANGE_TOLERANCE = 1e-7
"""How well Model Exchange must, with CVODE at a tolerance of `EXCHANGE_SOLVER`."""

EXCHANGE_SOLVER = 1e-10

_TIMED = {
    "time_contact_begins": "contact_begins",
    "time_of_maximum_indentation": "maximum_indentation",
    "time_impactor_stops": "impactor_stops",
    "time_contact_ends": "contact_ends",
}
"""Outputs that tell the time of an event, in the order in which events at one time happen."""

_TOLD = (*_TIMED, "event_count", "last_event", "time_of_last_event", "stage", "phase", "contact_count")
_RECORDED = (*MOTION, *_TOLD)


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
    negative before. Values of the summary that an FMU does not tell (energies) are NaN.

    Raises ValueError for an argument that does not fit the FMU, SimulationError when the FMU reports an error,
    ImportError without FMPy.
    """
    if mode not in get_args(Mode):
        raise ValueError(f"mode: {mode!r} is not allowed: {' or '.join(get_args(Mode))} is needed")
    with _opened(path) as fmu:
        if KINDS[fmu.data.kind] != "impact":
            raise ValueError(f"{path}: a contact has no motion of its own; only impact FMUs can be run alone")
        if mode == "events" and fmu.version == 2:
            raise ValueError(f"{path}: mode 'events' needs FMI 3.0, this is FMI 2.0")
        experiment = fmu.description.defaultExperiment
        stop = _positive("stop_time", float(experiment.stopTime) if stop_time is None else stop_time)
        step = _positive("step_size", float(experiment.stepSize) if step_size is None else step_size)
        starts = _start_values(fmu, start_values or {})
        given = {name: _input(name, value) for name, value in (inputs or {}).items()}
        for name, value in given.items():
            if not callable(value) or mode != "exchange":
                continue
            raise ValueError(f"inputs: {name} must be one value in mode 'exchange'")
        if mode == "exchange":
            rows, events = _exchanged(fmu, stop, step, starts, given, tolerance)
        else:
            rows, events = _stepped(fmu, mode == "events", stop, step, starts, given)
        return _dataset(fmu, rows, events, mode)


@dataclass(frozen=True)
class Finding:
    """One comparison: what, the largest difference found, what is allowed, and where."""

    what: str
    difference: float
    allowed: float
    where: str = ""

    @property
    def good(self) -> bool:
        """Whether the difference is allowed."""
        return self.difference <= self.allowed


@dataclass(frozen=True)
class Report:
    """What `check` found. problems: what validation says; findings: comparisons with the library."""

    path: str
    problems: tuple[str, ...]
    findings: tuple[Finding, ...]

    @property
    def good(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems and all(finding.good for finding in self.findings)

    def to_json(self) -> dict[str, Any]:
        """Plain values."""
        rows = [
            {"what": f.what, "difference": f.difference, "allowed": f.allowed, "where": f.where, "good": f.good}
            for f in self.findings
        ]
        return {"path": self.path, "good": self.good, "problems": list(self.problems), "findings": rows}


def check(path: str | os.PathLike[str], scene: Scene | None = None) -> Report:
    """Validate an FMU of this package (FMPy's rules and the FMI schemas) and compare its runs with the library's.

    scene: needed when the law is not one of film-model's, of which the FMU knows the curve only.
    """
    from fmpy.validation import validate_fmu

    with _opened(path) as fmu:
        problems = tuple(str(problem) for problem in validate_fmu(str(path)))
        if KINDS[fmu.data.kind] == "contact":
            return Report(str(path), problems, tuple(_compared_contact(fmu)))
        scene = fmu.scene() if scene is None else scene
        stop, version = float(fmu.description.defaultExperiment.stopTime), fmu.version
    findings: list[Finding] = []
    for step in (stop / 200.0, stop / 13.7, stop):
        findings += _compared(f"steps of {units.format_si(step, 'time', 3)}", path, scene, "steps", step)
    if version == 3:
        findings += _compared("event mode", path, scene, "events", stop / 20.0)
    findings += _compared("Model Exchange", path, scene, "exchange", stop / 200.0)
    return Report(str(path), problems, tuple(findings))


# ---------------------------------------------------------------- the FMU and what it says of itself


@dataclass
class _Fmu:
    path: Path
    folder: str
    description: Any
    data: resource.Data
    messages: list[str] = field(default_factory=list)

    @property
    def version(self) -> int:
        return int(self.description.fmiVersion[0])

    def scene(self) -> Scene:
        """The scene it was made from."""
        text = Path(self.folder, "resources", "scene.toml").read_text("utf-8")
        law = tomllib.loads(text).get("contact", {}).get("law", "auto")
        if law not in ("auto", *LAWS):
            raise ValueError(f"{self.path}: law {law!r} is none of film-model's: give the scene it was made from")
        with tempfile.NamedTemporaryFile("w", suffix=".toml", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            return Scene.from_toml(file.name)

    def log(self, *arguments: Any) -> None:
        """A message of the FMU's; its last text is the message itself."""
        texts = [a for a in arguments if isinstance(a, bytes)]
        self.messages.append(texts[-1].decode("utf-8", "replace") if texts else "")


@contextmanager
def _opened(path: str | os.PathLike[str]) -> Iterator[_Fmu]:
    """An extracted FMU; the folder is removed in the end."""
    try:
        from fmpy import extract, read_model_description
    except ImportError as error:
        raise ImportError('running FMUs needs FMPy: pip install "film-model[fmu]"') from error
    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"{source}: there is no such file")
    try:
        with zipfile.ZipFile(source) as archive:
            content = archive.read(f"resources/{resource.NAME}")
    except (KeyError, zipfile.BadZipFile):
        raise ValueError(f"{source}: this is no FMU of film-model's") from None
    data = resource.read(content)
    folder = extract(str(source))
    try:
        yield _Fmu(source, folder, read_model_description(folder, validate=False), data)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _positive(name: str, value: Any) -> float:
    number = units.to_si(value, "time", bare=True)
    if not 0.0 < number < math.inf:
        raise ValueError(f"{name}: {number:g} s must be > 0 s")
    return number


def _start_values(fmu: _Fmu, given: Mapping[str, Any]) -> dict[str, float]:
    known = {v.name: v for v in FMU_VARIABLES if v.causality.get("impact") == "parameter" and resource.has(fmu.data, v.name)}
    read: dict[str, float] = {}
    for name, value in given.items():
        if name not in known:
            raise ValueError(f"start_values: this FMU has no parameter {name!r}; it has {', '.join(known)}")
        dimension = known[name].dimension
        read[name] = float(value) if dimension is None else units.to_si(value, dimension, bare=True)
    return read


def _input(name: str, value: Input) -> Any:
    inputs = {v.name: v for v in FMU_VARIABLES if v.causality.get("impact") == "input"}
    if name not in inputs:
        raise ValueError(f"inputs: there is no input {name!r}; there are {', '.join(inputs)}")
    dimension = inputs[name].dimension
    assert dimension is not None
    return value if callable(value) else units.to_si(value, dimension, bare=True)


# ---------------------------------------------------------------- Co-Simulation

Row = dict[str, float]


class Slave:
    """A Co-Simulation instance of either FMI version, by the names of variables."""

    def __init__(self, fmu: _Fmu, event_mode: bool) -> None:
        from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
        from fmpy.fmi3 import FMU3Slave

        identity = {
            "guid": fmu.description.guid,
            "unzipDirectory": fmu.folder,
            "modelIdentifier": fmu.description.coSimulation.modelIdentifier,
            "instanceName": "impact",
        }
        self.fmu, self.event_mode, self.version = fmu, event_mode, fmu.version
        if self.version == 2:
            self.own: Any = FMU2Slave(**identity)
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda _e, _n, _s, _c, text: fmu.log(text))
            self._kept = callbacks
            self.own.instantiate(callbacks=callbacks)
        else:
            self.own = FMU3Slave(**identity)
            self.own.instantiate(
                eventModeUsed=event_mode, earlyReturnAllowed=event_mode, logMessage=lambda _e, _s, _c, text: fmu.log(text)
            )

    def initialize(self, values: Mapping[str, float]) -> None:
        """Set start values and leave Initialization Mode."""
        if self.version == 2:
            self.own.setupExperiment(startTime=0.0)
            self.own.enterInitializationMode()
        else:
            self.own.enterInitializationMode(startTime=0.0)
        for name, value in values.items():
            self.set(name, value)
        self.own.exitInitializationMode()
        if self.event_mode:
            self.handle()

    def handle(self) -> None:
        """Event mode, once."""
        self.own.updateDiscreteStates()
        self.own.enterStepMode()

    def set(self, name: str, value: float) -> None:
        """Set one variable."""
        k, v = reference(name), FMU_VARIABLES[reference(name)]
        if self.version == 2:
            (self.own.setReal if v.type == "Real" else self.own.setInteger)([k], [value if v.type == "Real" else int(value)])
        elif v.type == "Real":
            self.own.setFloat64([k], [value])
        else:
            self.own.setInt32([k], [int(value)])

    def get(self, names: tuple[str, ...] = _RECORDED) -> Row:
        """Values of variables."""
        read: Row = {}
        by_type: dict[str, list[str]] = {}
        for name in names:
            by_type.setdefault(FMU_VARIABLES[reference(name)].type, []).append(name)
        for kind, group in by_type.items():
            references = [reference(name) for name in group]
            if kind == "Real":
                values = self.own.getReal(references) if self.version == 2 else self.own.getFloat64(references)
            elif self.version == 2:
                values = self.own.getInteger(references)
            else:
                values = self.own.getInt32(references) if kind == "Whole" else self.own.getInt64(references)
            read.update(zip(group, map(float, values), strict=True))
        return {name: read[name] for name in names}

    def step(self, time: float, size: float) -> tuple[float, bool]:
        """One step; the time reached, and whether an event has to be handled there."""
        if self.version == 2:
            self.own.doStep(time, size)
            return time + size, False
        event, _, _, reached = self.own.doStep(time, size)
        return reached, event

    def save(self) -> Any:
        """The state."""
        return self.own.getFMUstate() if self.version == 2 else self.own.getFMUState()

    def restore(self, state: Any) -> None:
        """A saved state, which is used up."""
        if self.version == 2:
            self.own.setFMUstate(state)
            self.own.freeFMUstate(state)
        else:
            self.own.setFMUState(state)
            self.own.freeFMUState(state)

    def close(self) -> None:
        """Free the instance."""
        self.own.terminate()
        self.own.freeInstance()


@contextmanager
def started(fmu: _Fmu, event_mode: bool, values: Mapping[str, float]) -> Iterator[Slave]:
    """A running instance; an error the FMU reports becomes a SimulationError with its message."""
    slave: Slave | None = None
    try:
        slave = Slave(fmu, event_mode)
        slave.initialize(values)
        yield slave
    except Exception as error:
        if fmu.messages:
            raise SimulationError(f"{fmu.path}: {fmu.messages[-1]}") from error
        raise
    finally:
        if slave is not None and not fmu.messages:
            slave.close()


def _stepped(
    fmu: _Fmu, event_mode: bool, stop: float, step: float, starts: Mapping[str, float], inputs: Mapping[str, Any]
) -> tuple[list[Row], list[Row]]:
    """Rows at communication points and at events, and events."""
    first = {name: value(0.0) if callable(value) else value for name, value in inputs.items()}
    rows: list[Row] = []
    events: list[Row] = []
    with started(fmu, event_mode, {**starts, **first}) as slave:
        before = slave.get()
        rows.append({"time": 0.0, **before})
        events += [_event(0.0, name, before) for name in _passed(dict.fromkeys(_TOLD, 0.0), before, 0.0) or {}]
        count = max(1, math.ceil(stop / step * (1.0 - 1e-12)))
        for n in range(count):
            time, end = n * step, min((n + 1) * step, stop)
            for name, value in inputs.items():
                if callable(value):
                    slave.set(name, value(time))
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
        row = slave.get()
        rows.append({"time": time, **row})
        if event and row["event_count"] > rows[-2]["event_count"]:
            events.append(_event(time, native.EVENTS[int(row["last_event"])], row))
        if time >= end:
            return


def _step_and_look_back(slave: Slave, time: float, end: float, rows: list[Row], events: list[Row]) -> None:
    """A step; if it passed events, again from its beginning to each of them, at the times it has told."""
    saved, before = slave.save(), rows[-1]
    slave.step(time, end - time)
    after = slave.get()
    passed = _passed(before, after, time)
    if passed is None and end - time > 1e-12 * end:  # more than the outputs can tell
        slave.restore(saved)
        middle = 0.5 * (time + end)
        _step_and_look_back(slave, time, middle, rows, events)
        _step_and_look_back(slave, middle, end, rows, events)
        return
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
        row = slave.get()
        if at > rows[-1]["time"]:
            rows.append({"time": at, **row})
        events.append(_event(at, name, {**row, "stage": _stage_after(slave, now, end)}))
    if end > now:
        slave.step(now, end - now)
    rows.append({"time": end, **slave.get(), **told})


def _stage_after(slave: Slave, now: float, end: float) -> float:
    """The stage right after an event, which rounding may have put on the other side of the step."""
    if end <= now:
        return slave.get(("stage",))["stage"]
    saved = slave.save()
    slave.step(now, 1e-6 * (end - now))
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


def _event(time: float, name: str, row: Row) -> Row:
    return {"time": time, "kind": native.EVENTS.index(name), **{key: row[key] for key in (*MOTION, "stage")}}


# ---------------------------------------------------------------- Model Exchange


def _exchanged(
    fmu: _Fmu, stop: float, step: float, starts: Mapping[str, float], inputs: Mapping[str, float], tolerance: float
) -> tuple[list[Row], list[Row]]:
    from fmpy import simulate_fmu

    signals = None
    if inputs:
        kinds = np.dtype([("time", np.float64), *((name, np.float64) for name in inputs)])
        signals = np.array([(0.0, *inputs.values()), (stop, *inputs.values())], kinds)
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
            output=_RECORDED,
            model_description=fmu.description,
            logger=lambda *arguments: fmu.log(*arguments),
        )
    except Exception as error:
        if fmu.messages:
            raise SimulationError(f"{fmu.path}: {fmu.messages[-1]}") from error
        raise
    rows = [{name: float(row[name]) for name in ("time", *_RECORDED)} for row in result]
    events = [_event(0.0, name, rows[0]) for name in _passed(dict.fromkeys(_TOLD, 0.0), rows[0], 0.0) or {}]
    for before, after in zip(rows, rows[1:], strict=False):
        passed = _passed(before, after, before["time"])
        names = [native.EVENTS[int(after["last_event"])]] if passed is None else list(passed)
        events += [_event(after["time"], name, after) for name in names]
    kept = [row for row, following in zip(rows, [*rows[1:], None], strict=True) if not _repeated(row, following)]
    return kept, events


def _repeated(row: Row, following: Row | None) -> bool:
    """The first of two rows at one time: the values before an event."""
    return following is not None and following["time"] == row["time"]


# ---------------------------------------------------------------- datasets


def _dataset(fmu: _Fmu, rows: list[Row], events: list[Row], mode: Mode) -> xr.Dataset:
    distinct = [row for row, following in zip(rows, [*rows[1:], None], strict=True) if not _repeated(row, following)]
    touch = next((event["time"] for event in events if event["kind"] == native.EVENTS.index("contact_begins")), 0.0)
    columns: dict[str, Any] = {name: np.array([row[name] for row in distinct]) for name in ("time", *MOTION, "stage")}
    columns["t"] = columns.pop("time") - touch
    columns["event_time"] = np.array([event["time"] - touch for event in events])
    columns["event_kind"] = [event["kind"] for event in events]
    for name in (*MOTION, "stage"):
        columns[f"event_{name}"] = [event[name] for event in events]
    columns.update({name: math.nan if value is None else value for name, value in _summary(events, touch).items()})
    data = fmu.data
    mass = data.start[reference("mass")]
    tick = math.sqrt(mass * data.length_scale / data.force_scale)
    scales = {"length": data.length_scale, "force": data.force_scale, "time": tick, "velocity": data.length_scale / tick}
    columns.update({f"scale_{name}": value for name, value in scales.items()})
    columns.update(drift_velocity=0.0, impactor_share=1.0)
    stages = tuple(f"stage_{k}" for k in range(data.curve.stages))
    arrays: dict[str, Any] = {}
    for v in VARIABLES:
        values = np.zeros(0) if "segment" in v.dims else columns[v.name]
        arrays[v.name] = (v.dims, np.asarray(values, dtype=v.dtype), v.attributes(stages))
    ds = xr.Dataset({name: value for name, value in arrays.items() if name != "t"}, coords={"t": arrays["t"]})
    ds.attrs = _attributes(fmu, mode, ds)
    return ds


def _summary(events: list[Row], touch: float) -> dict[str, float | None]:
    """Summary of the first contact, from its events."""
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
        summary["maximum_force"] = max(event["contact_force"] for event in events[: end + 1])
    if "impactor_stops" in contact:
        summary["time_impactor_stops"] = contact["impactor_stops"]["time"] - touch
    if begins is not None and ends is not None:
        summary["contact_duration"] = ends["time"] - touch
        summary["permanent_indentation"] = ends["indentation"]
        summary["rebound_velocity"] = ends["impactor_velocity"]
        if begins["relative_velocity"] > 0.0:
            summary["coefficient_of_restitution"] = -ends["relative_velocity"] / begins["relative_velocity"]
    return summary


def _attributes(fmu: _Fmu, mode: Mode, ds: xr.Dataset) -> dict[str, Any]:
    text = Path(fmu.folder, "resources", "scene.toml").read_text("utf-8")
    how = {"steps": "Co-Simulation", "events": "Co-Simulation with event mode", "exchange": "Model Exchange with CVODE"}
    loading, unloading = (int(fmu.data.start[reference(f"{leg}_segments")]) for leg in ("loading", "unloading"))
    values: dict[str, Any] = {
        "Conventions": "CF-1.11",
        "title": fmu.description.description or "Impact",
        "summary": f"Impact simulated by an FMU (FMI {fmu.description.fmiVersion}), {how[mode]}: motion, contact force and events.",
        "source": f"film-model {__version__}, FMU under FMPy",
        "references": "FMI, https://fmi-standard.org",
        "history": f"film-model {__version__}: fmu_wrapper.run",
        "license": "film-model claims no rights in its results; the software is under the MIT license",
        "date_created": "unknown",
        "comment": "SI units; t counts in seconds from first touch and is no date. Directions are positive into the target. "
        "An FMU tells no segments and no energies.",
        "film_model_schema": SCHEMA_NAME,
        "film_model_schema_version": SCHEMA_VERSION,
        "film_model_version": __version__,
        "scene_toml": text,
        "scene_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "content_sha256": content_sha256(ds),
        "contact_law": tomllib.loads(text).get("contact", {}).get("law", "auto"),
        "outcome": "see events",
        "effects": "see the FMU's documentation",
        "warnings": "none",
        "estimated_accuracy": math.nan,
        "segments": np.int32(loading),
        "unloading_segments": np.int32(unloading),
    }
    return {name: values[name] for name in ATTRIBUTES}


# ---------------------------------------------------------------- comparison


def _compared(what: str, path: str | os.PathLike[str], scene: Scene, mode: Mode, step: float) -> list[Finding]:
    """An FMU's run beside the library's at the same times."""
    ds = run(path, mode=mode, step_size=step)
    with _opened(path) as fmu:
        gap = fmu.data.start[reference("initial_gap")]
        counts = tuple(int(fmu.data.start[reference(f"{leg}_segments")]) for leg in ("loading", "unloading"))
    allowed = EXCHANGE_TOLERANCE if mode == "exchange" else STEPS_TOLERANCE
    accuracy = {"accuracy": 1e-10} if mode == "exchange" else {}
    component = ImpactComponent(scene, initial_gap=gap, **accuracy)
    if mode != "exchange" and component.segments != counts:
        return [Finding(f"{what}: segments", abs(component.segments[0] - counts[0]), 0.0, f"the library takes {component.segments}")]
    touch = -float(ds["t"][0])
    results = []
    events: list[Any] = []
    for time in (ds["t"].values + touch).tolist():
        result = component.step(max(time - component.time, 0.0))
        results.append(result.outputs)
        events += result.events
    events += component.step(1e-6 * max(touch, step)).events  # those that rounding put behind the last point
    findings: list[Finding] = []
    for name in MOTION:
        ours = np.array([getattr(outputs, name) for outputs in results])
        theirs = ds[name].values
        size = float(np.abs(ours).max())
        off = np.abs(ours - theirs) / (size if size > 0.0 else 1.0)
        findings.append(Finding(f"{what}: {name}", float(off.max()), allowed, f"t = {ds['t'].values[off.argmax()]:.6g} s"))
    theirs = [native.EVENTS[kind] for kind in ds["event_kind"].values.tolist()]
    ours = [event.name for event in events[: len(theirs)]]
    if theirs != ours:
        return [*findings, Finding(f"{what}: events", math.inf, 0.0, f"{', '.join(theirs)}; the library has {', '.join(ours)}")]
    span = max(float(ds["t"][-1]), 1e-300)
    for at, name, event in zip(ds["event_time"].values.tolist(), theirs, events, strict=False):
        findings.append(Finding(f"{what}: time of {name}", abs(at + touch - event.time) / span, allowed, f"t = {at:.6g} s"))
    return findings


def _compared_contact(fmu: _Fmu) -> list[Finding]:
    """The force element on a path in and out, beside the law's curve."""
    data = fmu.data
    deepest, count = data.nominal[0], 200
    path = deepest * np.sin(np.linspace(0.0, 0.5 * np.pi, count))
    worst, where = 0.0, ""
    with started(fmu, False, {"indentation": 0.0, "relative_velocity": 1.0}) as slave:
        for n, depth in enumerate(path.tolist()):
            slave.set("indentation", depth)
            force = slave.get(("contact_force",))["contact_force"]
            law = _law_force(data.curve, depth / data.length_scale) * data.force_scale
            off = abs(force - law) / max(_law_force(data.curve, deepest / data.length_scale) * data.force_scale, 1e-300)
            if off > worst:
                worst, where = off, f"indentation = {depth:.6g} m"
            slave.step(float(n), 1.0)
    return [Finding("contact: force in loading", worst, STEPS_TOLERANCE, where)]


def _law_force(curve: native.Curve, xi: float) -> float:
    stage = sum(curve.stage[k].end < xi for k in range(curve.stages - 1))
    return native.stage_law(curve, stage, xi)[0] if xi > 0.0 else 0.0
