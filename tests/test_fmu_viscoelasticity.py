"""FMUs of viscoelastic bodies: the library's motion, exact events, saved states, parameters, and what they refuse."""

import ctypes
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from test_viscoelasticity import rubber, scene

import film_model as fm
import fmu_wrapper
from film_model.core import relaxing
from film_model.solve.history import MOTION
from fmu_wrapper import resource
from fmu_wrapper.instance import opened, started

VERSIONS = pytest.mark.parametrize("version", [2, 3])
CASES = {
    "dropped on granite": (scene(), "2 um"),
    "on a rod that moves": (
        replace(scene(), target=fm.Rod("PMMA", diameter="30 mm"), effects=fm.Effects(target_motion=True)),
        0.0,
    ),
    "with a yield strength": (scene(material=rubber(yield_strength="5 MPa")), 0.0),
}
VALUES = ("maximum_force", "maximum_indentation", "rebound_velocity", "contact_duration", "contact_radius")


@pytest.mark.parametrize(
    ("case", "version"),
    [
        ("on a rod that moves", 2),
        pytest.param("dropped on granite", 3, marks=pytest.mark.slow),
        pytest.param("with a yield strength", 3, marks=pytest.mark.slow),
    ],
)
def test_an_fmu_is_valid_and_has_the_motion_of_the_library(made, case, version):
    given, gap = CASES[case]
    report = fmu_wrapper.check(made(given, version, initial_gap=gap), given)
    assert report.good, [finding for finding in report.findings if not finding.good]
    assert report.problems == () and report.findings[0].what == "steps"


def light(on):
    """The impact without weight."""
    return fm.simulate(replace(on, effects=fm.Effects(gravity=False)))


def compared(path, changes, expected):
    """A run in one step against a history."""
    ds = fmu_wrapper.run(
        path, start_values=changes, stop_time=1.01 * expected.duration, step_size=1.01 * expected.duration
    )
    for name in VALUES:
        if name in ds:
            assert float(ds[name]) == pytest.approx(expected.summary[name], rel=2e-5), name
    times = dict(zip(ds.event_kind.values, ds.event_time.values, strict=True))
    for event in expected.events:
        kind = fm.core.native.EVENTS.index(event.name)
        assert times[kind] == pytest.approx(event.time, abs=1e-5 * expected.duration)


@pytest.mark.parametrize("version", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_parameters_change_the_impact_as_the_scene_does(made, version):
    """effective_modulus multiplies the modulus at all times; relaxation times stay."""
    path = made(scene(), version)
    compared(path, {"gravity": 0.0}, light(scene()))
    start = {"mass": 0.02, "radius": 0.02, "initial_velocity": 0.3, "gravity": 0.0}
    changed = scene().replace({"impactor.mass": "20 g", "impactor.radius": "20 mm", "impactor.velocity": "0.3 m/s"})
    compared(path, start, light(changed))
    stiff = fm.HalfSpace(fm.Material(youngs_modulus="1e14 Pa", poissons_ratio=0.0, density="2700 kg/m^3"))
    rigid, twice = (
        replace(scene(), target=stiff),
        replace(scene(material=rubber(youngs_modulus="100 MPa")), target=stiff),
    )
    assert twice.effective_modulus is not None
    compared(made(rigid, version), {"effective_modulus": twice.effective_modulus, "gravity": 0.0}, light(twice))
    with zipfile.ZipFile(path) as archive:
        names = resource.start_values(resource.read(archive.read("resources/model.film")))
    assert {"target_impedance", "initial_gap", "gravity"} <= set(names) and not {*resource.OF_LINES} & set(names)


def serialised(instance, version, saved):
    """The bytes of a saved state, and the state made from them."""
    if version == 3:
        content = instance.serializeFMUState(saved)
        return content, instance.deserializeFMUState(content)
    size = ctypes.c_size_t()
    instance.fmi2SerializedFMUstateSize(instance.component, saved, ctypes.byref(size))
    content = instance.serializeFMUstate(saved)
    return content, instance.deSerializeFMUstate(content)


@VERSIONS
def test_a_state_is_restored_and_serialised_on_the_way_in_and_out(made, version):
    sizes = list[int]()
    with opened(made(scene(), version)) as fmu, started(fmu, False, {}) as slave:
        for begin, end, phase in ((0.0, 1e-4, 1), (1e-4, 4e-4, 2)):
            slave.step(begin, end - begin)
            saved, middle = slave.save(), slave.get((*MOTION, "phase"))
            assert middle["phase"] == phase
            content, taken = serialised(slave.instance, version, saved)
            sizes.append(len(content))
            found = list[dict[str, float]]()
            again = slave.save()
            for state in (taken, saved):  # freed when restored
                slave.restore(state)
                assert slave.get((*MOTION, "phase")) == middle
                slave.set("external_force", 1.0)
                slave.step(end, 2e-3)
                found.append(slave.get((*MOTION, "time_of_last_event", "maximum_force", "event_count")))
                slave.set("external_force", 0.0)
            assert found[0] == found[1] and found[0]["event_count"] > 1
            slave.restore(again)
    step = ctypes.sizeof(relaxing.Step)
    assert sizes[0] < sizes[1] < 20_000 + relaxing.MOST_STEPS * step


def test_each_event_ends_a_step_in_event_mode(made):
    events = fm.ImpactComponent(fmu_wrapper.served(scene()), initial_gap=2e-6).step(5e-3).events
    with opened(made(scene(), initial_gap="2 um")) as fmu, started(fmu, True, {}) as slave:
        time, found = 0.0, list[tuple[float, str]]()
        while time < 5e-3:
            time, event = slave.step(time, 5e-3 - time)
            if event:
                slave.instance.enterEventMode()
                slave.handle()
                found.append((time, fm.core.native.EVENTS[int(slave.get(("last_event",))["last_event"])]))
    assert [name for _, name in found] == [event.name for event in events]
    assert [at for at, _ in found] == pytest.approx([event.time for event in events], rel=1e-11)


def test_energies_balance(made):
    names = ("kinetic_energy", "contact_energy", "target_energy", "external_work")
    with opened(made(CASES["on a rod that moves"][0], 2)) as fmu, started(fmu, False, {}) as slave:
        first = slave.get(names)["kinetic_energy"]
        for n in range(40):
            slave.set("external_force", 0.1 * (n % 3))
            slave.step(n * 1e-4, 1e-4)
            now = slave.get((*names, "contact_count"))
            total = now["kinetic_energy"] + now["contact_energy"] + now["target_energy"] - now["external_work"]
            assert total == pytest.approx(first, rel=1e-9)
        assert now["contact_energy"] > 0.2 * first and now["contact_count"] == 1


def test_validity_ends_where_the_material_yields(made):
    """With law "auto" a body that yields somewhere else keeps Hertz's law, and says where it would yield."""
    given = CASES["with a yield strength"][0]
    on = fmu_wrapper.served(given)
    assert (on.contact.law, on.effects.viscoelasticity) == ("hertz", True)
    path = made(given)
    with opened(path) as fmu:
        limit = fmu.data.limit[0]
        assert np.isfinite(limit)
        for speed, expected in ((1.0, 0), (15.0, 2)):
            with started(fmu, False, {"initial_velocity": speed}) as slave:
                slave.step(0.0, 1e-2)
                found = slave.get(("maximum_indentation", "validity"))
                assert (found["maximum_indentation"] > limit) == (expected == 2)
                assert int(found["validity"]) & 2 == expected


def test_what_cannot_be_served_is_refused(made, tmp_path):
    with pytest.raises(
        fm.SimulationError, match="kind contact is not supported for a viscoelastic material: its force"
    ):
        fmu_wrapper.export(scene(), tmp_path / "contact.fmu", kind="contact")
    path = made(scene())
    with zipfile.ZipFile(path) as archive:
        assert b"ModelExchange" not in archive.read("modelDescription.xml")
        page = archive.read("documentation/index.html").decode()
    assert "falls with time under load to 40 % of the instantaneous one" in page
    with pytest.raises(ValueError, match="its material is viscoelastic, so there is no mode 'exchange': mode 'steps'"):
        fmu_wrapper.run(path, mode="exchange")
    with pytest.raises(fm.SimulationError, match="the indentation grows again before contact ends"):
        fmu_wrapper.run(path, inputs={"external_force": "1 kN"}, stop_time="20 ms")


def test_a_damaged_relaxation_is_refused(made):
    with opened(made(scene())) as fmu:
        data = fmu.data
        data.relaxation.law.rest = 0.9  # and shares that add up to 0.6
        with open(f"{fmu.folder}/resources/model.film", "wb") as file:
            file.write(resource.finished(data, data.token.decode()))
        with pytest.raises(fm.SimulationError, match="its checksum or its numbers are wrong"), started(fmu, False, {}):
            pass
