"""SSP packages: schemas of SSP 1.0, parameter sets, and runs in libcosim (pip install "film-model[interop]")."""

import io
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from cases import STEEL, TARGETS, scene

import film_model as fm
import fmu_wrapper
from film_model.base.materials import catalogue
from film_model.cli.main import main
from film_model.effects.choose import choose
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import reference

SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
SCENES = Path(__file__).parents[1] / "examples" / "scenes"
GIVEN = {
    "tsuji": {"restitution": 0.8},
    "thornton": {"yield_pressure": "1.6 GPa"},
    "luding": {"loading_stiffness": "2e7 N/m", "plastic_stiffness": "4e7 N/m", "plasticity_depth": 0.05},
}
WHOLE = {
    "plate": fm.Scene.from_toml(SCENES / "olsson_plate.toml").replace({"effects.gravity": False}),
    "beam": fm.Scene(
        scene("hertz").impactor,
        fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", static_stiffness="2e7 N/m"),
        effects=fm.Effects(gravity=False, target_inertia=False),
    ),
}
"""Targets that vibrate or follow by their static stiffness."""


def by_name(law, target="half-space"):
    """A scene whose law takes its numbers from the materials."""
    contact = fm.Contact(law=law, **GIVEN.get(law, {}))
    return fm.Scene(scene("hertz").impactor, TARGETS[target], contact=contact)


def read(package):
    with zipfile.ZipFile(package.path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def values(content):
    """Parameter → value of a parameter set."""
    found = ET.fromstring(content).iter(f"{SSV}Parameter")
    return {one.get("name"): float(one[0].get("value")) for one in found}


def running(package):
    """A package in libcosim, and an observer of its last values."""
    pytest.importorskip("libcosimpy")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution, observer = CosimExecution.from_ssp_file(str(package.path)), CosimObserver.create_last_value()
    execution.add_observer(observer)
    return execution, observer


def schema(ending):
    """The schema of SSP 1.0 for the files with an ending."""
    standard = pytest.importorskip("pyssp_standard")
    from xmlschema import XMLSchema

    name = {".ssd": "SystemStructureDescription", ".ssv": "SystemStructureParameterValues"}[ending]
    return XMLSchema(Path(standard.__file__).parent / "resources" / f"{name}.xsd")


@pytest.mark.slow
def test_a_package_has_components_connections_and_parameter_sets(packed):
    package = packed(by_name("hertz", "body"))
    files = read(package)
    root = ET.fromstring(files["SystemStructure.ssd"])
    components = {one.get("name"): one for one in root.iter(f"{SSD}Component")}
    assert tuple(components) == package.components == ("contact", "impactor", "target")
    kinds = {}
    for name, component in components.items():
        assert component.get("source") in files
        assert f"resources/{name}.ssv" in files
        kinds |= {(name, one.get("name")): one.get("kind") for one in component.iter(f"{SSD}Connector")}
        assert all((name, one) in kinds for one in values(files[f"resources/{name}.ssv"]))
    for wire in root.iter(f"{SSD}Connection"):
        assert kinds[wire.get("startElement"), wire.get("startConnector")] == "output"
        assert kinds[wire.get("endElement"), wire.get("endConnector")] == "input"
    assert len(package.materials) == len(catalogue()) and not package.left_out
    assert values(files["resources/impactor.ssv"])["initial_velocity"] == pytest.approx(
        scene("hertz").approach_velocity
    )
    assert values(files["resources/target.ssv"])["initial_velocity"] == 0.1


@pytest.mark.slow
@pytest.mark.parametrize("law", ["hertz", "big-alabo", "thornton", "tsuji"])
def test_the_parameter_set_of_a_material_gives_its_contact(packed, tmp_path, law):
    on = by_name(law)
    package = packed(on)
    files, contact = read(package), tmp_path / "contact.fmu"
    contact.write_bytes(files["resources/contact.fmu"])
    assert len(package.materials) + len(package.left_out) == len(catalogue()) and len(package.materials) >= 13
    with opened(contact) as fmu:
        for name in catalogue():
            if name in package.left_out:
                continue
            stem = "".join(c if c.isalnum() else "_" for c in name)
            problem = choose(fmu_wrapper.served(on.replace({"target.material": name}), "contact")).problem
            depth = 0.5 * problem.scales.length
            with started(
                fmu, False, {**values(files[f"resources/materials/{stem}.ssv"]), "indentation": depth}
            ) as slave:
                force = slave.get(("contact_force",))["contact_force"]
            assert force == pytest.approx(problem.curve.force(0.5) * problem.scales.force, rel=1e-12), name


@pytest.mark.slow
def test_a_law_with_given_stiffness_has_no_parameter_sets_of_materials(packed):
    package = packed(by_name("luding"))
    assert not package.materials and len(package.left_out) == len(catalogue())
    assert all("does not depend" in reason for reason in package.left_out.values())


@pytest.mark.slow
@pytest.mark.parametrize("target", ["half-space", "plate", "body"])
def test_files_obey_the_schemas_of_ssp_1(packed, target):
    by_ending = {ending: schema(ending) for ending in (".ssd", ".ssv")}
    checked = 0
    for name, content in read(packed(by_name("hertz", target))).items():
        if Path(name).suffix in by_ending:
            by_ending[Path(name).suffix].validate(io.BytesIO(content))
            checked += 1
    assert checked >= 3 + len(catalogue())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "target", "force", "speed"),
    [
        ("hertz", "half-space", 3e-4, 1e-4),
        ("big-alabo", "half-space", 3e-4, 1e-4),
        ("hertz", "plate", 3e-4, 1e-4),
        ("big-alabo", "rod", 3e-4, 1e-4),
        ("hertz", "body", 2.6e-3, 3e-3),
    ],
)
def test_libcosim_runs_a_package_as_simulate_does(packed, law, target, force, speed):
    """Largest force, and velocity of the impactor when contact has ended, without the fall that follows."""
    on = replace(scene(law, target), effects=fm.Effects(gravity=False))
    served = on if target == "body" else fmu_wrapper.served(on)
    summary = fm.simulate(served, accuracy=1e-6).summary
    execution, observer = running(packed(on))
    index = {info.name.decode(): info.index for info in execution.slave_infos()}
    execution.step(251)
    (largest,) = observer.last_real_values(index["contact"], [reference("maximum_force")])
    (after,) = observer.last_real_values(index["impactor"], [reference("impactor_velocity")])
    assert largest == pytest.approx(summary["maximum_force"], rel=force)
    assert after == pytest.approx(summary["rebound_velocity"], abs=speed * on.approach_velocity)


@pytest.mark.slow
def test_functions_are_not_hidden_by_modules_of_their_names():
    text = "import fmu_wrapper as f; f.export_ssp; assert all(callable(getattr(f, name)) for name in f.__all__)"
    subprocess.run([sys.executable, "-c", text], check=True)


def test_the_command_writes_a_package(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "fmu_wrapper.ssp.export_ssp", lambda *_, **__: fmu_wrapper.Package("x", ("contact",), (), {"ice": "why"})
        )
        patch.setattr("fmu_wrapper.export_ssp", fmu_wrapper.ssp.export_ssp, raising=False)
        assert main(["export-ssp", str(SCENES / "tungsten_carbide_on_steel.toml")]) == 0
    assert "no parameter set for ice: why" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("target", sorted(WHOLE))
def test_a_target_that_vibrates_or_bends_stays_with_its_impactor(packed, target):
    """One component, which the schemas allow, and which libcosim runs as `simulate` does."""
    on = WHOLE[target]
    package = packed(on)
    assert package.components == ("impact",)
    assert not package.materials and len(package.left_out) == len(catalogue())
    schema(".ssd").validate(io.BytesIO(read(package)["SystemStructure.ssd"]))
    execution, observer = running(package)
    summary = fm.simulate(fmu_wrapper.served(on)).summary
    given, deepest, rebound = [reference("maximum_indentation"), reference("rebound_velocity")], 0.0, 0.0
    for _ in range(250):
        execution.step(1)
        of_contact, rebound = observer.last_real_values(0, given)  # a plate is touched twice
        deepest = max(deepest, of_contact)
    assert deepest == pytest.approx(summary["maximum_indentation"], rel=1e-4)
    assert rebound == pytest.approx(summary["rebound_velocity"], abs=1e-4 * on.approach_velocity)


def test_a_wrong_name_is_refused(tmp_path):
    with pytest.raises(ValueError, match="SSP package"):
        fmu_wrapper.export_ssp(scene("hertz"), tmp_path / "a.fmu")
    assert not list(tmp_path.iterdir())
