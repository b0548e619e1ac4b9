"""The XML files of SSP 1.0: SystemStructure.ssd and parameter sets (SSV)."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from film_model.version import __version__
from fmu_wrapper.model_description import base_unit, fmi_unit, printable
from fmu_wrapper.resource import Data, has
from fmu_wrapper.variables import KINDS, VARIABLES, Real, Variable, Whole, reference

_SSP = "http://ssp-standard.org/SSP1/SystemStructure"
_SPACES = {"xmlns:ssc": f"{_SSP}Common", "xmlns:ssd": f"{_SSP}Description", "xmlns:ssv": f"{_SSP}ParameterValues"}
_OSP = "http://opensimulationplatform.com/SSP/OSPAnnotations"
_TYPES = {Real: "Real", Whole: "Integer"}
_WITHOUT_UNIT = (None, "dimensionless")


class Element(NamedTuple):
    """A component: its name, FMU, the FMU's data, and the values that its parameter set gives, SI."""

    name: str
    source: str
    data: Data
    values: dict[str, float]


class Connection(NamedTuple):
    """A signal from an output to an input, times a factor."""

    from_element: str
    from_variable: str
    to_element: str
    to_variable: str
    factor: float = 1.0


def system_structure(
    title: str, elements: Sequence[Element], connections: Sequence[Connection], stop_time: float, step: float
) -> bytes:
    """SystemStructure.ssd. step: proposed, s, for libcosim, which reads connections between components only."""
    root = ET.Element(
        "ssd:SystemStructureDescription",
        {
            **_SPACES,
            "xmlns:osp": _OSP,
            "version": "1.0",
            "name": printable(title),
            "generationTool": f"film-model {__version__}",
        },
    )
    system = ET.SubElement(root, "ssd:System", name="impact", description=printable(title))
    parts = ET.SubElement(system, "ssd:Elements")
    for element in elements:
        _component(parts, element)
    wires = ET.SubElement(system, "ssd:Connections") if connections else system  # the schema allows no empty list
    for one in connections:
        ends = {"startElement": one.from_element, "startConnector": one.from_variable}
        ends |= {"endElement": one.to_element, "endConnector": one.to_variable}
        scaled = one.factor != 1.0
        wire = ET.SubElement(
            wires, "ssd:Connection", {**ends, **({"suppressUnitConversion": "true"} if scaled else {})}
        )
        if scaled:
            ET.SubElement(wire, "ssc:LinearTransformation", factor=repr(one.factor))
    _units(root, "ssd", [v for element in elements for v in _interface(element.data)])
    experiment = ET.SubElement(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(stop_time))
    notes = ET.SubElement(experiment, "ssd:Annotations")
    note = ET.SubElement(notes, "ssc:Annotation", type="com.opensimulationplatform")
    algorithm = ET.SubElement(note, "osp:Algorithm")
    ET.SubElement(algorithm, "osp:FixedStepAlgorithm", baseStepSize=repr(step))
    return _written(root)


def parameter_set(name: str, values: Mapping[str, float]) -> bytes:
    """A parameter set (SSV), with the units of its values."""
    root = ET.Element(
        "ssv:ParameterSet", {k: v for k, v in _SPACES.items() if "ssd" not in k}, version="1.0", name=name
    )
    root.set("generationTool", f"film-model {__version__}")
    parameters = ET.SubElement(root, "ssv:Parameters")
    for one, value in values.items():
        v = VARIABLES[reference(one)]
        parameter = ET.SubElement(parameters, "ssv:Parameter", name=one)
        ET.SubElement(parameter, "ssv:Real", {"value": repr(float(value)), **_unit(v)})
    _units(root, "ssv", [VARIABLES[reference(one)] for one in values])
    return _written(root)


def _interface(data: Data) -> list[Variable]:
    """Parameters, inputs and outputs of an FMU; enumerations have twins that are whole numbers."""
    kind = KINDS[data.kind]
    roles = ("parameter", "input", "output")
    return [v for v in VARIABLES if has(data, v.name) and v.causality.get(kind) in roles and v.type in _TYPES]


def _component(parent: ET.Element, element: Element) -> None:
    name, source = element.name, element.source
    component = ET.SubElement(
        parent,
        "ssd:Component",
        {"name": name, "type": "application/x-fmu-sharedlibrary", "source": source, "implementation": "CoSimulation"},
    )
    connectors = ET.SubElement(component, "ssd:Connectors")
    for v in _interface(element.data):
        _connector(connectors, v, v.causality[KINDS[element.data.kind]])
    bindings = ET.SubElement(component, "ssd:ParameterBindings")
    ET.SubElement(bindings, "ssd:ParameterBinding", source=f"resources/{name}.ssv")


def _connector(parent: ET.Element, v: Variable, kind: str) -> None:
    connector = ET.SubElement(parent, "ssd:Connector", name=v.name, kind=kind, description=v.description)
    ET.SubElement(connector, f"ssc:{_TYPES[v.type]}", _unit(v))


def _unit(v: Variable) -> dict[str, str]:
    """The attribute for the unit of a variable that has one."""
    return {} if v.dimension in _WITHOUT_UNIT else {"unit": fmi_unit(v.dimension or "")}


def _units(root: ET.Element, prefix: str, variables: Iterable[Variable]) -> None:
    units = ET.SubElement(root, f"{prefix}:Units")
    for dimension in dict.fromkeys(v.dimension for v in variables if v.dimension not in _WITHOUT_UNIT):
        assert dimension is not None
        unit = ET.SubElement(units, "ssc:Unit", name=fmi_unit(dimension))
        ET.SubElement(unit, "ssc:BaseUnit", base_unit(dimension))


def _written(root: ET.Element) -> bytes:
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"
