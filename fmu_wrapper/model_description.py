"""modelDescription.xml of FMI 2.0 and 3.0, from the table of variables."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from film_model.unit_symbols import parse_unit
from film_model.units import scene_unit
from film_model.version import __version__
from fmu_wrapper.resource import Data, has
from fmu_wrapper.variables import (
    EVENT_KINDS,
    KINDS,
    PHASES,
    STATES,
    VARIABLES,
    EventKind,
    Kind,
    Phase,
    Real,
    Variable,
    Whole,
    reference,
    settable,
)

FmiVersion = Literal[2, 3]
ITEMS = {Phase: PHASES, EventKind: EVENT_KINDS}
LOG_CATEGORY = ("logStatusError", "what went wrong, and what was expected")


@dataclass(frozen=True)
class Experiment:
    """The default experiment: s, and the relative tolerance of an importer's integrator."""

    stop_time: float
    step_size: float
    tolerance: float


def fmi_unit(dimension: str) -> str:
    """The unit's name in FMI, as in "N.s/m"; "1" for a plain number."""
    return scene_unit(dimension).replace("*", ".").replace("^", "") or "1"


def model_description(
    data: Data, version: FmiVersion, token: str, description: str, experiment: Experiment, sources: Iterable[str] = ()
) -> bytes:
    """The file. `sources`: names of the C files that are shipped (FMI 2.0 lists them here)."""
    kind = KINDS[data.kind]
    chosen = [v for v in VARIABLES if has(data, v.name) and (version == 3 or v.causality[kind] != "local")]
    root = ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0" if version == 2 else "3.0",
            "modelName": kind,
            "guid" if version == 2 else "instantiationToken": token,
            "description": description,
            "author": "film-model contributors",
            "version": __version__,
            "license": "MIT",
            "generationTool": f"film-model {__version__}",
            "variableNamingConvention": "flat",
        },
    )
    if version == 2:
        root.set("numberOfEventIndicators", str(_indicators()))
    _interfaces(root, data, version, list(sources))
    _units(root, chosen)
    _types(root, chosen, version)
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", name=LOG_CATEGORY[0], description=LOG_CATEGORY[1])
    ET.SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=repr(experiment.stop_time),
        tolerance=repr(experiment.tolerance),
        stepSize=repr(experiment.step_size),
    )
    variables = ET.SubElement(root, "ModelVariables")
    for v in chosen:
        (_variable_2 if version == 2 else _variable_3)(variables, v, data, chosen)
    _structure(root, data, chosen, version)
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def _indicators() -> int:
    return sum(v.name.startswith("event_indicator") for v in VARIABLES)


def _interfaces(root: ET.Element, data: Data, version: FmiVersion, sources: list[str]) -> None:
    kind = KINDS[data.kind]
    remembers = kind == "contact" and bool(data.curve.stage[0].damped)  # a peak that no event tells
    if version == 2:
        able = {
            "modelIdentifier": kind,
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
            "providesDirectionalDerivative": "true",
        }
        without = {} if remembers else {"completedIntegratorStepNotNeeded": "true"}
        exchange = ET.SubElement(root, "ModelExchange", {**able, **without})
        steps = ET.SubElement(root, "CoSimulation", {**able, "canHandleVariableCommunicationStepSize": "true"})
        for parent in (exchange, steps):
            if sources:
                files = ET.SubElement(parent, "SourceFiles")
                for name in sources:
                    ET.SubElement(files, "File", name=name)
        return
    able = {
        "modelIdentifier": kind,
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
        "providesAdjointDerivatives": "true",
    }
    ET.SubElement(root, "ModelExchange", {**able, "needsCompletedIntegratorStep": str(remembers).lower()})
    events = {"hasEventMode": "true", "mightReturnEarlyFromDoStep": "true"} if kind == "impact" else {}
    ET.SubElement(root, "CoSimulation", {**able, "canHandleVariableCommunicationStepSize": "true", **events})


def _units(root: ET.Element, chosen: list[Variable]) -> None:
    units = ET.SubElement(root, "UnitDefinitions")
    for dimension in dict.fromkeys(v.dimension for v in chosen if v.dimension not in (None, "dimensionless")):
        assert dimension is not None
        unit = ET.SubElement(units, "Unit", name=fmi_unit(dimension))
        size, powers = parse_unit(scene_unit(dimension))
        assert size == 1.0
        names = zip(("kg", "m", "s"), powers, strict=True)
        ET.SubElement(unit, "BaseUnit", {name: str(int(power)) for name, power in names if power})


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


def _number(v: Variable, data: Data, values: dict[str, str]) -> dict[str, str]:
    """Attributes of a variable's value: unit, limits, start, nominal."""
    k, kind = reference(v.name), KINDS[data.kind]
    text = (lambda x: str(int(x))) if v.type == Whole else repr
    if v.dimension is not None and v.dimension != "dimensionless":
        values["unit"] = fmi_unit(v.dimension)
    for name, limit in (("min", v.low), ("max", v.high)):
        if limit is not None:
            values[name] = text(limit)
    if v.name in STATES:
        values["nominal"] = repr(data.nominal[STATES.index(v.name)])
    if v.causality[kind] in ("parameter", "input"):
        assert k < settable()
        values["start"] = text(data.start[k])
    return values


def _head(v: Variable, kind: Kind) -> dict[str, str]:
    head = {
        "name": v.name,
        "valueReference": str(reference(v.name)),
        "description": v.description,
        "causality": v.causality[kind],
        "variability": v.variability,
    }
    if v.causality[kind] == "parameter":
        head["initial"] = "exact"
    if v.causality[kind] in ("output", "local"):
        head["initial"] = "calculated"
    return head


def _variable_2(parent: ET.Element, v: Variable, data: Data, chosen: list[Variable]) -> None:
    element = ET.SubElement(parent, "ScalarVariable", _head(v, KINDS[data.kind]))
    if v.type in ITEMS:
        ET.SubElement(element, "Enumeration", declaredType=v.type)
        return
    rate = {"derivative": str(_index(chosen, v.rate_of))} if v.rate_of in STATES and data.kind == 0 else {}
    ET.SubElement(element, "Real" if v.type == Real else "Integer", _number(v, data, rate))


def _variable_3(parent: ET.Element, v: Variable, data: Data, chosen: list[Variable]) -> None:
    head = _head(v, KINDS[data.kind])
    if v.type in ITEMS:
        ET.SubElement(parent, "Enumeration", {**head, "declaredType": v.type})
        return
    if v.rate_of is not None and data.kind == 0:
        head["derivative"] = str(reference(v.rate_of))
    ET.SubElement(parent, "Float64" if v.type == Real else "Int32", _number(v, data, head))


def _index(chosen: list[Variable], name: str | None) -> int:
    return 1 + next(k for k, v in enumerate(chosen) if v.name == name)


def _structure(root: ET.Element, data: Data, chosen: list[Variable], version: FmiVersion) -> None:
    kind = KINDS[data.kind]
    structure = ET.SubElement(root, "ModelStructure")
    outputs = [v for v in chosen if v.causality[kind] == "output"]
    rates = [next(v for v in chosen if v.rate_of == state) for state in STATES] if kind == "impact" else []
    initial = [v for v in chosen if v in outputs or v in rates]

    def place(v: Variable | str) -> str:
        name = v if isinstance(v, str) else v.name
        return str(_index(chosen, name) if version == 2 else reference(name))

    def unknown(v: Variable) -> dict[str, str]:
        row = {"index" if version == 2 else "valueReference": place(v)}
        if v.variability == "continuous" and kind in v.depends:
            names = (*v.depends[kind], *(v.depends_damped.get(kind, ()) if data.curve.stage[0].damped else ()))
            row["dependencies"] = " ".join(sorted((place(name) for name in names), key=int))
            row["dependenciesKind"] = " ".join("dependent" for _ in names)
        return row

    def only(v: Variable) -> dict[str, str]:
        return {"index" if version == 2 else "valueReference": place(v)}

    if version == 2:
        for name, rows, of in (
            ("Outputs", outputs, unknown),
            ("Derivatives", rates, unknown),
            ("InitialUnknowns", initial, only),
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
        ET.SubElement(structure, "InitialUnknown", only(v))
    for v in chosen:
        if v.causality[kind] == "local":
            ET.SubElement(structure, "EventIndicator", only(v))
