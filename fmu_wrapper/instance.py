"""An exported FMU after extraction, and an instance of it under FMPy."""

from __future__ import annotations

import os
import shutil
from collections.abc import Generator, Iterable, Mapping
from contextlib import contextmanager
from ctypes import c_double
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from film_model.base.errors import DamagedFile, SimulationError
from film_model.laws import LAWS
from film_model.scene import Scene
from film_model.scene.toml import toml_table
from fmu_wrapper import platforms, resource
from fmu_wrapper.damage import check_loads, described, sound
from fmu_wrapper.variables import VARIABLES, Variable, of_sensors

Row = dict[str, float]

_TYPES = {
    2: {"Real": "Real", "Whole": "Integer", "Enumeration": "Integer"},
    3: {"Real": "Float64", "Whole": "Int32", "Enumeration": "Int64"},
}
"""Types of variables in the names of FMPy's functions, by the version of FMI; and the word for a saved state."""
_STATES = {2: "FMUstate", 3: "FMUState"}


@dataclass
class Fmu:
    """An extracted FMU of this package, its model description and data, and the messages it has logged.

    messages: of errors. notices: assumptions of the export that did not hold.
    """

    path: Path
    folder: str
    description: Any
    data: resource.Data
    messages: list[str] = field(default_factory=list)
    notices: list[str] = field(default_factory=list)

    @property
    def version(self) -> int:
        """FMI version: 2 or 3."""
        return int(self.description.fmiVersion[0])

    def scene(self) -> Scene:
        """The scene that was exported."""
        text = Path(self.folder, "resources", "scene.toml").read_text("utf-8")
        contact = toml_table(text, f"{self.path}: scene.toml").get("contact")
        law = contact.get("law", "auto") if isinstance(contact, dict) else "auto"
        if law not in ("auto", *LAWS):
            raise ValueError(f"{self.path}: law {law!r} is not in film-model's list: pass the scene that was exported")
        return Scene.from_stored_text(text, f"{self.path}: scene.toml")

    @cached_property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors whose motion it has."""
        if not self.data.modes.sensors:
            return ()
        text = Path(self.folder, "resources", "scene.toml").read_text("utf-8")
        target: Any = toml_table(text, f"{self.path}: scene.toml")["target"]
        return tuple(sensor["name"] for sensor in target["sensors"])

    @cached_property
    def variables(self) -> dict[str, tuple[int, Variable]]:
        """Value references and variables by name."""
        return {v.name: (k, v) for k, v in enumerate((*VARIABLES, *of_sensors(self.sensors)))}

    def log(self, *arguments: Any) -> None:
        """Callback for messages; the last two texts among the arguments are category and message."""
        texts = [a.decode("utf-8", "replace") for a in arguments if isinstance(a, bytes)]
        notice = texts[-2:-1] == ["validity"]
        (self.notices if notice else self.messages).append(texts[-1].replace("%%", "%") if texts else "")


@contextmanager
def opened(path: str | os.PathLike[str]) -> Generator[Fmu]:
    """An extracted FMU; the folder is removed at the end. Raises DamagedFile if it is no export of film-model."""
    try:
        from fmpy import extract, read_model_description
    except ImportError as error:
        raise ImportError('running FMUs needs FMPy: pip install "film-model[fmu]"') from error
    source = Path(path)
    data, included = sound(source)
    folder = str(extract(str(source)))
    try:
        description: Any = described(source, folder, read_model_description)
        exchange = ("modelExchange",) if resource.has_exchange(data) else ()
        for name in ("coSimulation", *exchange, "defaultExperiment"):
            if getattr(description, name) is None:
                raise DamagedFile(f"{source}: modelDescription.xml has no {name[0].upper()}{name[1:]}")
        if description.guid.encode() != data.token:
            raise DamagedFile(f"{source}: modelDescription.xml and resources/{resource.NAME} belong to different FMUs")
        identifiers = {getattr(description, name).modelIdentifier for name in ("coSimulation", *exchange)}
        if len(identifiers) > 1:
            raise DamagedFile(f"{source}: modelDescription.xml has several model identifiers: {', '.join(identifiers)}")
        fmu = Fmu(source, folder, description, data)
        needed = platforms.folder(platforms.this_platform(), fmu.version)
        if needed not in included:
            others = ", ".join(included) or "none"
            raise ValueError(f"{source}: has no binary for this machine ({needed}); it has {others}")
        check_loads(source, Path(folder), description.coSimulation.modelIdentifier, needed)
        yield fmu
    finally:
        shutil.rmtree(folder, ignore_errors=True)


class Slave:
    """An instance of FMI 2.0 or 3.0, whose variables are set and read by name: for Co-Simulation, or for Model Exchange
    if `exchange` is true."""

    def __init__(self, fmu: Fmu, event_mode: bool, exchange: bool = False) -> None:
        from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
        from fmpy.fmi3 import FMU3Model, FMU3Slave

        identity = {
            "guid": fmu.description.guid,
            "unzipDirectory": fmu.folder,
            "modelIdentifier": fmu.description.coSimulation.modelIdentifier,
            "instanceName": "impact",
        }
        self.fmu, self.event_mode, self.exchange, self.version = fmu, event_mode, exchange, fmu.version
        if self.version == 2:
            self.instance: Any = FMU2Model(**identity) if exchange else FMU2Slave(**identity)
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda _e, _n, _s, category, text: fmu.log(category, text))
            self._kept = callbacks
            self.instance.instantiate(callbacks=callbacks)
        else:
            self.instance = FMU3Model(**identity) if exchange else FMU3Slave(**identity)
            modes = {} if exchange else {"eventModeUsed": event_mode, "earlyReturnAllowed": event_mode}
            self.instance.instantiate(logMessage=lambda _e, _s, category, text: fmu.log(category, text), **modes)

    def initialize(self, values: Mapping[str, float]) -> None:
        """Set start values and leave Initialization Mode."""
        if self.version == 2:
            self.instance.setupExperiment(startTime=0.0)
            self.instance.enterInitializationMode()
        else:
            self.instance.enterInitializationMode(startTime=0.0)
        for name, value in values.items():
            self.set(name, value)
        self.instance.exitInitializationMode()
        if self.event_mode or self.exchange:
            self.handle()

    def handle(self) -> None:
        """Handle the current event and return to step mode, or Continuous-Time Mode."""
        update = self.instance.newDiscreteStates if self.version == 2 else self.instance.updateDiscreteStates
        while update()[0]:
            pass
        (self.instance.enterContinuousTimeMode if self.exchange else self.instance.enterStepMode)()

    def indicators(self, count: int) -> list[float]:
        """The event indicators, in Model Exchange."""
        values = (c_double * count)()
        self.instance.getEventIndicators(values, count)
        return list(values)

    def _call(self, what: str, kind: str) -> Any:
        """The function of FMPy that gets or sets variables of a type."""
        types = _TYPES[self.version]
        return getattr(self.instance, what + types.get(kind, types["Enumeration"]))

    def set(self, name: str, value: float) -> None:
        """Set one variable."""
        k, v = self.fmu.variables[name]
        self._call("set", v.type)([k], [value if v.type == "Real" else int(value)])

    def get(self, names: Iterable[str]) -> Row:
        """Values of variables."""
        wanted, read = tuple(names), Row()
        by_type: dict[str, list[str]] = {}
        for name in wanted:
            by_type.setdefault(self.fmu.variables[name][1].type, []).append(name)
        for kind, group in by_type.items():
            values = self._call("get", kind)([self.fmu.variables[name][0] for name in group])
            read.update(zip(group, map(float, values), strict=True))
        return {name: read[name] for name in wanted}

    def step(self, time: float, size: float) -> tuple[float, bool]:
        """One step. Returns the time reached, and whether an event must be handled there."""
        if self.version == 2:
            self.instance.doStep(time, size)
            return time + size, False
        event, _, _, reached = self.instance.doStep(time, size)
        return reached, event

    def save(self) -> Any:
        """A copy of the state; `restore` or `discard` frees it."""
        return getattr(self.instance, f"get{_STATES[self.version]}")()

    def restore(self, state: Any) -> None:
        """Return to a saved state, and free it."""
        getattr(self.instance, f"set{_STATES[self.version]}")(state)
        self.discard(state)

    def discard(self, state: Any) -> None:
        """Free a saved state."""
        getattr(self.instance, f"free{_STATES[self.version]}")(state)


@contextmanager
def started(fmu: Fmu, event_mode: bool, values: Mapping[str, float], exchange: bool = False) -> Generator[Slave]:
    """A running instance, freed at the end; an error that the FMU reports is raised as SimulationError."""
    try:
        slave = Slave(fmu, event_mode, exchange)
        try:
            slave.initialize(values)
            yield slave
            slave.instance.terminate()
        finally:
            slave.instance.freeInstance()
    except Exception as error:
        if fmu.messages:
            raise SimulationError(f"{fmu.path}: {fmu.messages[-1]}") from error
        raise
