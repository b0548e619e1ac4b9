"""Names of FMUs; sources that link together; paths; what instantiation accepts; events that restart integrators."""

import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from cases import combinations, scene

import fmu_wrapper
from film_model.cli.main import main
from fmu_wrapper import platforms
from fmu_wrapper.instance import opened, started

VERSIONS = pytest.mark.parametrize("version", [2, 3])
BALL = Path(__file__).parents[1] / "examples" / "scenes" / "tungsten_carbide_on_steel.toml"


def names(path):
    with opened(path) as fmu:
        description = fmu.description
        identifiers = {description.coSimulation.modelIdentifier, description.modelExchange.modelIdentifier}
        return description.modelName, *identifiers


@pytest.mark.slow
@combinations(version=[2, 3], fast=2)
def test_the_name_comes_from_the_title(made, version):
    ball = replace(scene("hertz"), title="Kugel, 10 mm: Stoß")
    assert names(made(ball, version)) == ("impact: Kugel, 10 mm: Stoß", "impact_Kugel_10_mm_Sto")
    assert names(made(ball, version, kind="contact"))[1] == "contact_Kugel_10_mm_Sto"
    assert names(made(scene("hertz"), version)) == ("impact", "impact")
    assert names(made(ball, version, name="7 balls")) == ("7 balls", "impact_7_balls")
    assert names(made(ball, version, name="衝突")) == ("衝突", "impact")


@pytest.mark.slow
def test_the_command_line_takes_a_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["export-fmu", str(BALL), "--name", "Front ball"]) == 0
    assert names("impact.fmu") == ("Front ball", "Front_ball")
    assert main(["export-fmu", str(BALL), "--name", " ", "--force"]) == 3


@VERSIONS
def test_values_are_shown_in_handy_units(made, version):
    with opened(made(scene("hertz"), version)) as fmu:
        shown = {variable.name: variable.displayUnit for variable in fmu.description.modelVariables}
        factors = {one.name: one.factor for unit in fmu.description.unitDefinitions for one in unit.displayUnits}
    assert (shown["indentation"], shown["time_contact_ends"], shown["contact_force"]) == ("µm", "µs", "kN")
    assert shown["radius"] is None and factors == {"µm": 1e6, "µs": 1e6, "kN": 1e-3, "mJ": 1e3, "MPa": 1e-6}


@pytest.mark.slow
def test_two_fmus_link_into_one_program(made, tmp_path):
    if shutil.which("gcc") is None:
        pytest.skip("needs gcc")
    objects = []
    for k, kind in enumerate(("impact", "contact")):
        with zipfile.ZipFile(made(scene("hertz"), 3, kind=kind, with_sources=True)) as archive:
            archive.extractall(tmp_path / kind)
        sources = tmp_path / kind / "sources"
        for source in sorted(sources.glob("*.c")):
            objects.append(str(source.with_suffix(f".{k}.o")))
            command = ["gcc", "-std=c99", "-O0", "-DFILM_API=", f"-DFMI3_FUNCTION_PREFIX={kind}_", f"-I{sources}"]
            headers = ["-isystem", str(platforms.fmi_headers())]
            subprocess.run([*command, *headers, "-c", str(source), "-o", objects[-1]], check=True)
    linked = subprocess.run(
        ["gcc", "-r", "-nostdlib", "-o", str(tmp_path / "all.o"), *objects], capture_output=True, text=True
    )
    assert linked.returncode == 0, linked.stderr


def test_a_resource_location_that_is_not_escaped(made, tmp_path):
    """Some importers of FMI 2.0 do not escape the path: a folder may really be called a%20b."""
    from fmpy.fmi2 import FMU2Slave

    with opened(made(scene("hertz"), 2)) as fmu:
        folder = tmp_path / "a%20b"
        shutil.copytree(fmu.folder, folder)
        slave = FMU2Slave(
            guid=fmu.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=fmu.description.coSimulation.modelIdentifier,
            instanceName="impact",
        )
        for uri in (f"file://{folder}/resources", f"file://{folder}/resources".replace("%", "%25")):
            made_one = slave.fmi2Instantiate(
                b"x", 1, fmu.description.guid.encode(), uri.encode(), slave.callbacks, 0, 0
            )
            assert made_one
            slave.fmi2FreeInstance(made_one)


@VERSIONS
def test_events_restart_integrators(made, version):
    from fmpy.fmi2 import FMU2Model
    from fmpy.fmi3 import FMU3Model

    with opened(made(scene("big-alabo"), version)) as fmu:
        model = (FMU2Model if version == 2 else FMU3Model)(
            guid=fmu.description.guid,
            unzipDirectory=fmu.folder,
            modelIdentifier=fmu.description.modelExchange.modelIdentifier,
            instanceName="impact",
        )
        model.instantiate()
        if version == 2:
            model.setupExperiment(startTime=0.0)
        model.enterInitializationMode()
        model.exitInitializationMode()
        update = model.newDiscreteStates if version == 2 else model.updateDiscreteStates
        assert update()[3]  # contact begins
        assert not update()[3]
        model.terminate()
        model.freeInstance()


@VERSIONS
def test_phases_and_events_are_whole_numbers_too(made, version):
    with opened(made(scene("hertz"), version)) as fmu, started(fmu, False, {}) as slave:
        for n in range(20):
            slave.step(n * 1e-5, 1e-5)
            found = slave.get(("phase", "phase_code", "last_event", "last_event_code"))
            assert found["phase"] == found["phase_code"] and found["last_event"] == found["last_event_code"]
        assert found["phase_code"] == 5


@pytest.mark.slow
@VERSIONS
def test_a_contact_on_a_plate_that_vibrates(made, version):
    """The contact contains no target: it is exported for every one."""
    import film_model as fm

    vibrating = fm.Scene(
        fm.Sphere(radius="10 mm", velocity="1 m/s", material="mild steel"),
        fm.Plate("mild steel", thickness="5 mm", size=["100 mm", "100 mm"]),
        contact=fm.Contact("hertz"),
    )
    assert fm.simulate(vibrating).problem.vibrates
    assert fmu_wrapper.check(made(vibrating, version, kind="contact")).good


@combinations(law=["linear-dashpot", "meyer", "kogut-etsion", "thornton"], version=[2, 3], fast=2)
def test_parameters_of_a_law_are_parameters_of_the_fmu(made, law, version):
    field = {
        "linear-dashpot": "stiffness",
        "meyer": "stiffness",
        "kogut-etsion": "hardness",
        "thornton": "yield_pressure",
    }
    import film_model as fm

    own = fmu_wrapper.served(scene(law)).contact.law
    name = "power_stiffness" if law == "meyer" else field[law]
    on = fmu_wrapper.served(scene(law, segments=40))
    value = 1.3 * getattr(own, field[law])
    changed = replace(on, contact=fm.Contact(law=replace(own, **{field[law]: value})))
    with opened(made(on, version)) as fmu:
        if name not in {variable.name for variable in fmu.description.modelVariables}:
            pytest.fail(f"no parameter {name}")
    ds = fmu_wrapper.run(made(on, version), start_values={name: value}, stop_time="1 ms", step_size="1 ms")
    history = fm.simulate(changed)
    for key in ("maximum_force", "contact_duration", "rebound_velocity"):
        assert float(ds[key]) == pytest.approx(history.summary[key], rel=1e-12), key
