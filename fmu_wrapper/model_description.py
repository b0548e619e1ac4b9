"""modelDescription.xml of FMI 2.0 and 3.0, from the table of variables."""

from __future__ import annotations

import math
import re
import unicodedata
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

from film_model.base.unit_symbols import parse_unit
from film_model.base.units import scene_unit
from film_model.scene import Scene
from film_model.version import __version__
from fmu_wrapper.resource import Data, has, has_exchange, loading_force, slides, states_of
from fmu_wrapper.variables import (
    ITEMS,
    KINDS,
    LEFT,
    RIGID,
    STATES,
    VARIABLES,
    Kind,
    Real,
    Variable,
    Whole,
    of_sensors,
    reference,
    settable,
)

FmiVersion = Literal[2, 3]
Outputs = Literal["all", "real"]
_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
LOG_CATEGORIES = {
    "logStatusError": "the cause of an error, and what was expected",
    "validity": "an assumption of the export that does not hold for the parameters or the motion",
}


DISPLAY = {
    **{"length": ("µm", 1e6), "time": ("µs", 1e6), "force": ("kN", 1e-3), "energy": ("mJ", 1e3)},
    "pressure": ("MPa", 1e-6),
}
"""Dimension → unit in which tools show values, and its factor. Radii and gaps are shown in metres."""
_IN_SI = ("radius", "initial_gap")


@dataclass(frozen=True)
class Names:
    """Name of a model, and the C identifier of its binary and functions."""

    model: str
    identifier: str

    @classmethod
    def of(cls, scene: Scene, kind: Kind, name: str | None) -> Names:
        """From the given name, or from the scene's title with the kind. Raises ValueError for an empty name."""
        if name is not None and not name.strip():
            raise ValueError("name: must not be empty")
        model = name if name is not None else f"{kind}: {scene.title}" if scene.title else kind
        model = printable(model)
        plain = unicodedata.normalize("NFKD", model).encode("ascii", "ignore").decode()
        words = re.sub("[^A-Za-z0-9]+", "_", plain).strip("_") or kind
        identifier = words if words[0].isalpha() else f"{kind}_{words}"
        return cls(model, identifier[:60].rstrip("_"))


@dataclass(frozen=True)
class Experiment:
    """The default experiment: times in s, and the relative tolerance of an importer's integrator."""

    stop_time: float
    step_size: float
    tolerance: float


def printable(text: str) -> str:
    """A text without the characters that XML does not allow."""
    return _NOT_IN_XML.sub("\N{REPLACEMENT CHARACTER}", text)


def fmi_unit(dimension: str) -> str:
    """The name of a unit in FMI, as in "N.s/m"; "1" for a dimensionless number."""
    return scene_unit(dimension).replace("*", ".").replace("^", "") or "1"


def base_unit(dimension: str) -> dict[str, str]:
    """Exponents of the SI units that make up the unit of a dimension."""
    size, powers = parse_unit(scene_unit(dimension))
    assert size == 1.0
    return {name: str(int(power)) for name, power in zip(("kg", "m", "s"), powers, strict=True) if power}


def model_description(
    data: Data,
    version: FmiVersion,
    token: str,
    names: Names,
    description: str,
    experiment: Experiment,
    sources: Iterable[str] = (),
    sensors: Iterable[str] = (),
    outputs: Outputs = "all",
) -> bytes:
    """Content of the file. sources: names of the C files in the FMU (FMI 2.0 lists them here). sensors: names.
    outputs: "real" makes local variables of those that are whole numbers or enumerations."""
    sensed = of_sensors(sensors)
    chosen = [v for v in VARIABLES if has(data, v.name) and (version == 3 or not _is_indicator(v))]
    chosen += sensed
    if outputs == "real":
        chosen = [v if v.type == Real else _as_local(v) for v in chosen]
    numbers = {v.name: k for k, v in enumerate((*VARIABLES, *sensed))}
    root = ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0" if version == 2 else "3.0",
            "modelName": names.model,
            "guid" if version == 2 else "instantiationToken": token,
            "description": description,
            "author": "film-model contributors",
            "version": __version__,
            "license": "MIT",
            "generationTool": f"film-model {__version__}",
            "variableNamingConvention": "flat",
        },
    )
    if version == 2 and has_exchange(data):
        root.set("numberOfEventIndicators", str(sum(map(_is_indicator, VARIABLES))))
    _interfaces(root, data, version, names.identifier, list(sources))
    _units(root, chosen)
    _types(root, chosen, version)
    categories = ET.SubElement(root, "LogCategories")
    for name, what in LOG_CATEGORIES.items():
        ET.SubElement(categories, "Category", name=name, description=what)
    ET.SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=repr(experiment.stop_time),
        tolerance=repr(experiment.tolerance),
        stepSize=repr(experiment.step_size),
    )
    variables = ET.SubElement(root, "ModelVariables")
    sizes = nominals(data, experiment.stop_time, sensed)
    for v in chosen:
        head = _head(v, KINDS[data.kind], numbers[v.name])
        (_variable_2 if version == 2 else _variable_3)(variables, v, head, data, chosen, sizes)
    _structure(root, data, chosen, numbers, version)
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def _as_local(v: Variable) -> Variable:
    """The variable, local in kinds of FMU where it is an output."""
    return replace(v, causality={kind: "local" if cause == "output" else cause for kind, cause in v.causality.items()})


def _is_indicator(v: Variable) -> bool:
    return v.name.startswith("event_indicator")


def _true(*names: str) -> dict[str, str]:
    return dict.fromkeys(names, "true")


def _interfaces(root: ET.Element, data: Data, version: FmiVersion, identifier: str, sources: list[str]) -> None:
    kind = KINDS[data.kind]
    damped = bool(data.curve.stage[0].damped)
    # for the maximum force, which no event reports, and for the springs of friction
    needs_completed_step = (kind == "contact" and damped) or slides(data)
    variable = _true("canHandleVariableCommunicationStepSize")
    rates = {"maxOutputDerivativeOrder": "1"} if kind == "impact" and has_exchange(data) else {}
    if version == 2:
        names = ("canNotUseMemoryManagementFunctions", "canGetAndSetFMUstate", "canSerializeFMUstate")
        able = {"modelIdentifier": identifier, **_true(*names, "providesDirectionalDerivative")}
        without = {} if needs_completed_step else _true("completedIntegratorStepNotNeeded")
        parents = [ET.SubElement(root, "ModelExchange", {**able, **without})] if has_exchange(data) else []
        inputs = _true("canInterpolateInputs") if kind == "impact" else {}
        steps = ET.SubElement(root, "CoSimulation", {**able, **variable, **inputs, **rates})
        for parent in (*parents, steps):
            if sources:
                files = ET.SubElement(parent, "SourceFiles")
                for name in sources:
                    ET.SubElement(files, "File", name=name)
        return
    names = ("canGetAndSetFMUState", "canSerializeFMUState", "providesDirectionalDerivatives")
    able = {"modelIdentifier": identifier, **_true(*names, "providesAdjointDerivatives")}
    if has_exchange(data):
        needs = str(needs_completed_step).lower()
        ET.SubElement(root, "ModelExchange", {**able, "needsCompletedIntegratorStep": needs})
    updates = _true("providesIntermediateUpdate", "mightReturnEarlyFromDoStep", "canReturnEarlyAfterIntermediateUpdate")
    events = _true("hasEventMode") if kind == "impact" else {}
    ET.SubElement(root, "CoSimulation", {**able, **variable, **updates, **events, **rates})


def _units(root: ET.Element, chosen: list[Variable]) -> None:
    units = ET.SubElement(root, "UnitDefinitions")
    for dimension in dict.fromkeys(v.dimension for v in chosen if v.dimension not in (None, "dimensionless")):
        assert dimension is not None
        unit = ET.SubElement(units, "Unit", name=fmi_unit(dimension))
        ET.SubElement(unit, "BaseUnit", base_unit(dimension))
        if dimension in DISPLAY:
            shown, factor = DISPLAY[dimension]
            ET.SubElement(unit, "DisplayUnit", name=shown, factor=repr(factor))


def _types(root: ET.Element, chosen: list[Variable], version: FmiVersion) -> None:
    types = ET.SubElement(root, "TypeDefinitions")
    for name, items in ITEMS.items():
        if not any(v.type == name for v in chosen):
            continue
        if version == 2:
            parent = ET.SubElement(ET.SubElement(types, "SimpleType", name=name), "Enumeration")
        else:
            parent = ET.SubElement(types, "EnumerationType", name=name)
        for value, (item, what) in enumerate(items.items()):
            ET.SubElement(parent, "Item", name=item, value=str(value), description=what)


def _number(v: Variable, data: Data, values: dict[str, str], sizes: dict[str, float]) -> dict[str, str]:
    """Attributes of a variable's value: unit, range, start, nominal. sizes: nominal values."""
    kind = KINDS[data.kind]
    text = (lambda x: str(int(x))) if v.type == Whole else repr
    if v.dimension is not None and v.dimension != "dimensionless":
        values["unit"] = fmi_unit(v.dimension)
        if v.dimension in DISPLAY and v.name not in _IN_SI:
            values["displayUnit"] = DISPLAY[v.dimension][0]
    for name, limit in (("min", v.low), ("max", v.high)):
        if limit is not None:
            values[name] = text(limit)
    if v.name in sizes:
        values["nominal"] = repr(sizes[v.name])
    if v.causality[kind] in ("parameter", "input"):
        values["start"] = text(data.start[reference(v.name)])
    return values


def _head(v: Variable, kind: Kind, number: int) -> dict[str, str]:
    initial = {"parameter": "exact", "output": "calculated", "local": "calculated"}.get(v.causality[kind])
    return {
        **{"name": v.name, "valueReference": str(number), "description": v.description},
        **{"causality": v.causality[kind], "variability": v.variability},
        **({} if initial is None else {"initial": initial}),
    }


def _variable_2(
    parent: ET.Element, v: Variable, head: dict[str, str], data: Data, chosen: list[Variable], sizes: dict[str, float]
) -> None:
    element = ET.SubElement(parent, "ScalarVariable", head)
    if v.type in ITEMS:
        ET.SubElement(element, "Enumeration", declaredType=v.type)
        return
    rate = {"derivative": str(_index(chosen, v.rate_of))} if v.rate_of in states_of(data) else {}
    ET.SubElement(element, "Real" if v.type == Real else "Integer", _number(v, data, rate, sizes))


def _variable_3(
    parent: ET.Element, v: Variable, head: dict[str, str], data: Data, _: list[Variable], sizes: dict[str, float]
) -> None:
    if v.type in ITEMS:
        ET.SubElement(parent, "Enumeration", {**head, "declaredType": v.type})
        return
    if v.rate_of in states_of(data):
        assert v.rate_of is not None
        head["derivative"] = str(reference(v.rate_of))
    if v.variability == "continuous" and v.causality[KINDS[data.kind]] in ("input", "output"):
        head["intermediateUpdate"] = "true"
    ET.SubElement(parent, "Float64" if v.type == Real else "Int32", _number(v, data, head, sizes))


def _index(chosen: list[Variable], name: str | None) -> int:
    return 1 + next(k for k, v in enumerate(chosen) if v.name == name)


def _structure(
    root: ET.Element, data: Data, chosen: list[Variable], numbers: dict[str, int], version: FmiVersion
) -> None:
    kind, exchange = KINDS[data.kind], has_exchange(data)
    structure = ET.SubElement(root, "ModelStructure")
    outputs = [v for v in chosen if v.causality[kind] == "output"]
    states = states_of(data)
    rates = [next(v for v in chosen if v.rate_of == state) for state in states]
    initial = [v for v in chosen if v in outputs or v in rates]
    parameters = [v.name for v in chosen if v.causality[kind] == "parameter"]

    def place(v: Variable | str) -> str:
        name = v if isinstance(v, str) else v.name
        return str(_index(chosen, name) if version == 2 else numbers[name])

    def row(v: Variable, names: Iterable[str]) -> dict[str, str]:
        places = sorted((place(name) for name in names), key=int)
        return {
            "index" if version == 2 else "valueReference": place(v),
            "dependencies": " ".join(places),
            "dependenciesKind": " ".join("dependent" for _ in places),
        }

    def unknown(v: Variable) -> dict[str, str]:
        damped = v.depends_damped.get(kind, ()) if data.curve.stage[0].damped else ()
        moves = v.variability == "continuous" or (kind == "impact" and v.name in LEFT)
        by = parameters if version == 3 and moves and data.modes.count == 0 else ()  # FMI 2.0 has no parameters there
        names = (*v.depends.get(kind, ()), *damped, *by)
        return row(v, (name for name in names if exchange or name not in STATES))

    def initially(v: Variable) -> dict[str, str]:
        """All that is given at the start: the states at the start are functions of the parameters."""
        return row(v, (u.name for u in chosen if u.causality[kind] in ("parameter", "input")))

    def indicator(v: Variable) -> dict[str, str]:
        return row(v, (*states, *(u.name for u in chosen if u.causality[kind] == "input")))

    if version == 2:
        for name, rows, of in (
            ("Outputs", outputs, unknown),
            ("Derivatives", rates, unknown),
            ("InitialUnknowns", initial, initially),
        ):
            if rows:
                parent = ET.SubElement(structure, name)
                for v in rows:
                    ET.SubElement(parent, "Unknown", of(v))
        return
    for v in outputs:
        ET.SubElement(structure, "Output", unknown(v))
    for v in rates:
        ET.SubElement(structure, "ContinuousStateDerivative", unknown(v))
    for v in initial:
        ET.SubElement(structure, "InitialUnknown", initially(v))
    for v in filter(_is_indicator, chosen):
        ET.SubElement(structure, "EventIndicator", indicator(v))


def nominals(data: Data, stop_time: float, sensed: Iterable[Variable] = ()) -> dict[str, float]:
    """Nominal values > 0 by name, SI, of all real variables but event indicators, whose size has no meaning.

    A parameter's is the size of its start value. stop_time: of the default experiment, s. sensed: variables of sensors.
    """
    sizes, found = _sizes(data, stop_time), dict[str, float]()
    for k, v in enumerate((*VARIABLES, *sensed)):
        if v.type != Real or v.dimension is None:
            continue
        given = abs(data.start[k]) if k < settable() and v.causality.get(KINDS[data.kind]) == "parameter" else 0.0
        if v.name in STATES and data.nominal[STATES.index(v.name)] > 0.0:
            found[v.name] = data.nominal[STATES.index(v.name)]
        elif 0.0 < given < RIGID:
            found[v.name] = given
        elif v.dimension in sizes:
            found[v.name] = sizes[v.dimension]
    return {name: value for name, value in found.items() if value > 0.0}


def _sizes(data: Data, stop_time: float) -> dict[str, float]:
    """Dimension → size in the impact, SI."""
    depth, speed = data.nominal[:2]
    lever = data.friction.lever or math.inf
    mass, force = data.start[reference("mass")], loading_force(data, depth, speed)
    return {
        "time": stop_time,
        "length": depth,
        "velocity": speed,
        "force": force,
        "impedance": force / speed if speed > 0.0 else 0.0,
        "acceleration": force / mass,
        "pressure": force / (math.pi * data.stresses.radius * depth),
        "energy": 0.5 * mass * speed**2,
        "impulse": mass * speed,
        "angular_frequency": speed / lever,
        "angular_acceleration": force / (mass * lever),
        "torque": force * lever,
    }
