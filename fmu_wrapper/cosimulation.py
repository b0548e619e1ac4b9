"""Run an exported FMU under FMPy; the result is a dataset of the library's schema."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from typing import Any, Literal, get_args

import xarray as xr

from film_model.base import units
from film_model.base.fields import whole
from fmu_wrapper import resource
from fmu_wrapper.instance import Fmu, opened
from fmu_wrapper.results import dataset
from fmu_wrapper.stepping import exchanged, stepped
from fmu_wrapper.variables import KINDS, VARIABLES, Variable

Mode = Literal["steps", "events", "exchange"]

INTERFACES: dict[Mode, str] = {
    "steps": "Co-Simulation",
    "events": "Co-Simulation with event mode",
    "exchange": "Model Exchange with CVODE",
}
"""Modes, and what each one uses of FMI; event mode exists in FMI 3.0 only."""

Input = float | str | Callable[[float], float]
"""An input: a quantity, or a function of time (SI) whose value is constant during each step."""

EXCHANGE_SOLVER = 1e-10
"""Default tolerance of CVODE in Model Exchange."""


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

    step_size, stop_time: communication step and end of the simulation ("1 us", or s); defaults are the FMU's.
    start_values: of parameters, as quantities or SI numbers. inputs: external_force and support_velocity; functions of
    time are allowed in Co-Simulation only. tolerance: of CVODE. Time is counted from first touch, as in a history, and
    is negative before it. Summary values are NaN if the FMU does not report them (energies) or if they belong to an
    event after the end of the run: set stop_time if the impact is slower than the scene's or begins later.

    Raises ValueError for an argument that the FMU does not accept, SimulationError if the FMU reports an error,
    ImportError without FMPy.

    >>> path = fmu_wrapper.export(scene, "impact.fmu")
    >>> ds = fmu_wrapper.run(path, step_size="2 us", start_values={"initial_velocity": "2 m/s"})
    >>> round(float(ds.maximum_force))  # N
    3105
    """
    most_steps = 2_000_000  # limit of communication steps in a run: all rows are kept in memory
    if mode not in get_args(Mode):
        raise ValueError(f"mode: {mode!r} is not allowed: {' or '.join(get_args(Mode))} is needed")
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance: {tolerance!r} is not allowed: a number above 0 and below 1 is needed")
    with opened(path) as fmu:
        if KINDS[fmu.data.kind] != "impact":
            raise ValueError(f"{path}: kind contact contains no bodies; only impact FMUs can be run alone")
        if mode == "events" and fmu.version == 2:
            raise ValueError(f"{path}: mode 'events' needs FMI 3.0, this is FMI 2.0")
        if mode == "exchange" and not resource.has_exchange(fmu.data):
            why = _why_no_exchange(fmu.data)
            raise ValueError(f"{path}: {why}, so there is no mode 'exchange': mode 'steps' gives its exact motion")
        experiment = fmu.description.defaultExperiment
        stop = _positive("stop_time", float(experiment.stopTime) if stop_time is None else stop_time)
        step = _positive("step_size", float(experiment.stepSize) if step_size is None else step_size)
        if stop / step > most_steps:
            raise ValueError(
                f"step_size: {step:g} s is {stop / step:.3g} steps to {stop:g} s, {most_steps} are allowed"
            )
        starts = _start_values(fmu, start_values or {})
        given = {name: _input(name, value) for name, value in (inputs or {}).items()}
        if mode == "exchange":
            functions = [name for name, value in given.items() if callable(value)]
            if functions:
                raise ValueError(f"inputs: {functions[0]} must be constant in mode 'exchange'")
            constant = {**dict.fromkeys(_inputs(), 0.0), **given} if given else {}
            rows, events = exchanged(fmu, stop, step, starts, constant, tolerance)
        else:
            rows, events = stepped(fmu, mode == "events", stop, step, starts, given)
        ds = dataset(fmu, rows, events, INTERFACES[mode], starts)
        if starts or given:
            ds.attrs["start_values"] = "\n".join(_line(name, value) for name, value in {**starts, **given}.items())
        return ds


def _why_no_exchange(data: resource.Data) -> str:
    relaxes = data.relaxation.tolerance > 0.0
    return "its material is viscoelastic" if relaxes else "its target vibrates or has a static stiffness"


def _line(name: str, value: Any) -> str:
    """A parameter or input of a run as a line of TOML."""
    dimension = next(v.dimension for v in VARIABLES if v.name == name)
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
        v.name: v for v in VARIABLES if v.causality.get("impact") == "parameter" and resource.has(fmu.data, v.name)
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
    return {v.name: v for v in VARIABLES if v.causality.get("impact") == "input"}


def _input(name: str, value: Input) -> Any:
    inputs = _inputs()
    if name not in inputs:
        raise ValueError(f"inputs: there is no input {name!r}; there are {', '.join(inputs)}")
    dimension = inputs[name].dimension
    assert dimension is not None
    return value if callable(value) else _si(f"inputs: {name}", value, dimension)
