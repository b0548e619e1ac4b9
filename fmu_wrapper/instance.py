"""An exported FMU, extracted, and an instance of it under FMPy."""

from __future__ import annotations

import os
import shutil
import tomllib
import zipfile
from collections.abc import Generator, Iterable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from film_model.errors import SimulationError
from film_model.laws import LAWS
from film_model.scene import Scene
from fmu_wrapper import resource
from fmu_wrapper.variables import VARIABLES, reference

Row = dict[str, float]


@dataclass
class Fmu:
    """An extracted FMU of this package, what it says of itself, and the messages it has logged."""

    path: Path
    folder: str
    description: Any
    data: resource.Data
    messages: list[str] = field(default_factory=list)

    @property
    def version(self) -> int:
        """Of FMI: 2 or 3."""
        return int(self.description.fmiVersion[0])

    def scene(self) -> Scene:
        """The scene it was made from."""
        text = Path(self.folder, "resources", "scene.toml").read_text("utf-8")
        law = tomllib.loads(text).get("contact", {}).get("law", "auto")
        if law not in ("auto", *LAWS):
            raise ValueError(f"{self.path}: law {law!r} is none of film-model's: give the scene it was made from")
        return Scene.from_text(text, f"{self.path}, scene.toml")

    def log(self, *arguments: Any) -> None:
        """A message of the FMU's; its last text is the message itself."""
        texts = [a for a in arguments if isinstance(a, bytes)]
        self.messages.append(texts[-1].decode("utf-8", "replace") if texts else "")


@contextmanager
def opened(path: str | os.PathLike[str]) -> Generator[Fmu]:
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
    folder = str(extract(str(source)))
    try:
        yield Fmu(source, folder, read_model_description(folder, validate=False), data)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


class Slave:
    """A Co-Simulation instance of either FMI version, by the names of variables."""

    def __init__(self, fmu: Fmu, event_mode: bool) -> None:
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
                eventModeUsed=event_mode,
                earlyReturnAllowed=event_mode,
                logMessage=lambda _e, _s, _c, text: fmu.log(text),
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
        k, v = reference(name), VARIABLES[reference(name)]
        if self.version == 2:
            (self.own.setReal if v.type == "Real" else self.own.setInteger)(
                [k], [value if v.type == "Real" else int(value)]
            )
        elif v.type == "Real":
            self.own.setFloat64([k], [value])
        else:
            self.own.setInt32([k], [int(value)])

    def get(self, names: Iterable[str]) -> Row:
        """Values of variables."""
        wanted, read = tuple(names), Row()
        by_type: dict[str, list[str]] = {}
        for name in wanted:
            by_type.setdefault(VARIABLES[reference(name)].type, []).append(name)
        for kind, group in by_type.items():
            references = [reference(name) for name in group]
            if kind == "Real":
                values = self.own.getReal(references) if self.version == 2 else self.own.getFloat64(references)
            elif self.version == 2:
                values = self.own.getInteger(references)
            else:
                values = self.own.getInt32(references) if kind == "Whole" else self.own.getInt64(references)
            read.update(zip(group, map(float, values), strict=True))
        return {name: read[name] for name in wanted}

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
def started(fmu: Fmu, event_mode: bool, values: Mapping[str, float]) -> Generator[Slave]:
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
