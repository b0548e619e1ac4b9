"""Terminals (mechanical flanges) and icon of an FMU, as in section 2.4.9 of FMI 3.0, which FMI 2.0.4 takes over."""

from __future__ import annotations

import io
import tomllib
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from film_model.solve.history import History
from fmu_wrapper.resource import Data
from fmu_wrapper.variables import KINDS, Kind

FOLDER = "terminalsAndIcons"

FLANGES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
"""Kind of FMU → terminal → description, and members: name, kind, variable."""

_PLACES = {"impactor": -100.0, "flange": -100.0, "support": 100.0}
"""Horizontal position of the middle of a terminal on the icon, which reaches from -100 to 100."""


def terminals_and_icons(data: Data, version: int, history: History | None) -> dict[str, bytes]:
    """Files by name. FMI 2.0 has its own place for the icon besides. No icon if there is no impact to draw."""
    files = {f"{FOLDER}/terminalsAndIcons.xml": _xml(KINDS[data.kind], history is not None)}
    if history is not None:
        icon = force_icon(history)
        files |= {f"{FOLDER}/icon.png": icon, f"{FOLDER}/flange.png": _square()}
        files |= {"model.png": icon} if version == 2 else {}
    return files


def _xml(kind: Kind, drawn: bool) -> bytes:
    root = ET.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    extent = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    if drawn:
        picture = ET.SubElement(root, "GraphicalRepresentation")
        ET.SubElement(picture, "CoordinateSystem", {**extent, "suggestedScalingFactorTo_mm": "0.1"})
        ET.SubElement(picture, "Icon", extent)
    terminals = ET.SubElement(root, "Terminals")
    for name, flange in FLANGES[kind].items():
        head = {"name": name, "matchingRule": "bus", "terminalKind": "_filmModel_translational_flange"}
        terminal = ET.SubElement(terminals, "Terminal", {**head, "description": flange["description"]})
        for member, of, variable in flange["members"]:
            names = {"variableName": variable, "memberName": member}
            ET.SubElement(terminal, "TerminalMemberVariable", {**names, "variableKind": of})
        if drawn:
            x = _PLACES[name]
            place = {"x1": f"{x - 10:g}", "y1": "-10", "x2": f"{x + 10:g}", "y2": "10", "iconBaseName": "flange"}
            colour = {"defaultConnectionColor": "0 127 0"}  # of mechanical flanges in the Modelica library
            ET.SubElement(terminal, "TerminalGraphicalRepresentation", {**colour, **place})
    ET.indent(root)
    return ET.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def force_icon(history: History) -> bytes:
    """PNG, 200 pixels wide and high: the contact force over time, in a frame."""
    from matplotlib.figure import Figure

    force = history.sample_si(np.linspace(0.0, history.duration, 201)).contact_force
    figure = Figure(figsize=(2.0, 2.0), dpi=100, facecolor="white", edgecolor="#717581", linewidth=4.0)
    panel = figure.add_axes((0.08, 0.12, 0.84, 0.76))
    panel.fill_between(np.linspace(0.0, 1.0, force.size), force / max(float(force.max()), 1e-300), color="#3f90da")
    panel.set(xlim=(0.0, 1.0), ylim=(0.0, 1.02))
    panel.axis("off")
    return _png(figure)


def _square() -> bytes:
    """PNG of a filled green square: a mechanical flange."""
    from matplotlib.figure import Figure

    return _png(Figure(figsize=(0.2, 0.2), dpi=100, facecolor="#007f00"))


def _png(figure: object) -> bytes:
    """The picture as a PNG file without the name of the program, so that every export has the same bytes."""
    content = io.BytesIO()
    figure.savefig(content, format="png", facecolor="auto", edgecolor="auto", metadata={"Software": None})  # type: ignore[attr-defined]
    return content.getvalue()
