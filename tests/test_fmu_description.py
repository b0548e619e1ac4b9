"""Units, ranges and nominal values of every variable in modelDescription.xml; terminals and icons."""

import io
import math
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from cases import combinations, scene
from fmpy.validation import validate_fmu
from lxml import etree
from matplotlib.image import imread

import film_model as fm
import fmu_wrapper
from film_model.core.native import MAX_STAGES
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import EVENT_KINDS, PHASES, VARIABLES, settable

VERSIONS = pytest.mark.parametrize("version", [2, 3])
NUMBERS = ("Real", "Integer", "Float64", "Int32")
UNLIMITED = {
    *("external_force", "support_velocity", "indentation", "relative_velocity"),
    *("impactor_velocity", "impactor_displacement", "target_displacement", "target_velocity", "impactor_acceleration"),
    *(
        "contact_force",
        "permanent_indentation",
        "mean_contact_force",
        "contact_impulse",
        "contact_energy",
        "target_energy",
        "external_work",
    ),
    *("rebound_velocity", "rate_of_indentation", "rate_of_impactor_velocity", "rate_of_target_displacement"),
}
"""Of either sign (a contact may adhere), or sums whose rounding may pass zero. So are times."""


def described(path):
    """Name → attributes of each number."""
    with zipfile.ZipFile(path) as archive:
        root = ET.fromstring(archive.read("modelDescription.xml"))
    found = {}
    for element in root.find("ModelVariables"):
        inner = element[0] if element.tag == "ScalarVariable" else element
        if inner.tag in NUMBERS:
            found[element.get("name")] = inner.attrib
    return found


def test_whole_numbers_end_where_the_core_does():
    highest = {v.name: v.high for v in VARIABLES}
    numbers = {"stage": MAX_STAGES, "phase_code": len(PHASES), "last_event_code": len(EVENT_KINDS)}
    assert {name: highest[name] for name in numbers} == {name: count - 1 for name, count in numbers.items()}


@combinations(version=[2, 3], kind=["impact", "contact"], law=["hertz", "big-alabo", "tsuji"], fast=4)
def test_every_variable_has_its_range_and_nominal_value(made, version, kind, law):
    table = {v.name: v for v in VARIABLES}
    for name, given in described(made(scene(law), version, kind=kind)).items():
        if name.startswith("event_indicator"):
            continue
        if table[name].dimension is not None:
            assert 0.0 < float(given["nominal"]) < math.inf, name
            assert table[name].dimension == "dimensionless" or given["unit"], name
        if name not in UNLIMITED and table[name].dimension != "time":
            assert "min" in given, name
        if table[name] in VARIABLES[: settable()] and table[name].causality.get(kind) == "parameter":
            assert float(given["min"]) <= float(given["start"]) <= float(given["max"]), name


@combinations(law=["hertz", "big-alabo", "tsuji"], target=["half-space", "plate"], fast=2)
def test_outputs_keep_to_their_range_and_reach_their_nominal_value(made, law, target):
    on = fmu_wrapper.served(scene(law, target))
    path = made(on)
    given, h = described(path), 1.3 * fm.simulate(on).duration / 100
    reached = dict.fromkeys(given, 0.0)
    with opened(path) as fmu, started(fmu, False, {}) as slave:
        for n in range(100):
            slave.step(n * h, h)
            for name, value in slave.get(given).items():
                low, high = (
                    float(given[name].get(end, infinite)) for end, infinite in (("min", "-inf"), ("max", "inf"))
                )
                assert low <= value <= high, name
                reached[name] = max(reached[name], abs(value))
    for name in ("indentation", "contact_force", "impactor_velocity", "kinetic_energy", "impactor_acceleration"):
        assert reached[name] == pytest.approx(float(given[name]["nominal"]), rel=0.6), name


@pytest.mark.slow
@VERSIONS
@pytest.mark.parametrize("kind", ["impact", "contact"])
def test_terminals_and_icons_obey_the_standard(tmp_path, version, kind):
    """The files stand where FMI 3.0 and FMI 2.0.4 put them, obey the schema, and name inputs and outputs."""
    path = fmu_wrapper.export(scene("big-alabo"), tmp_path / "a.fmu", version, kind=kind)
    again = fmu_wrapper.export(scene("big-alabo"), tmp_path / "b.fmu", version, kind=kind)
    assert path.read_bytes() == again.read_bytes()
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    text = files["terminalsAndIcons/terminalsAndIcons.xml"]
    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
    etree.XMLSchema(etree.parse(str(schema))).assertValid(etree.fromstring(text))
    root = ET.fromstring(text)
    of_terminals = {
        one.get("name"): [member.attrib for member in one.iter("TerminalMemberVariable")] for one in root[1]
    }
    assert set(of_terminals) == ({"impactor", "support"} if kind == "impact" else {"flange"})
    table = {v.name: v for v in VARIABLES}
    for members in of_terminals.values():
        assert {"v", "f"} <= {member["memberName"] for member in members}
        assert all(table[member["variableName"]].causality[kind] in ("input", "output") for member in members)
    icon = files["terminalsAndIcons/icon.png"]
    picture = imread(io.BytesIO(icon))
    assert picture.shape[:2] == (200, 200) and np.ptp(picture[..., 0]) > 0.5
    assert files["terminalsAndIcons/flange.png"].startswith(b"\x89PNG")
    assert files.get("model.png") == (icon if version == 2 else None)
    assert validate_fmu(str(path)) == []
