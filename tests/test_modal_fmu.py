"""FMUs on vibrating targets: the library's motion, exact events, saved states, parameters, and what they refuse."""

import ctypes
import zipfile

import numpy as np
import pytest
from cases import combinations
from fmu_resources import on_structure
from test_component import values
from test_modal_component import LISTED, RINGING, SCENES, on
from test_modal_engine import OLSSON

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_model.cli.main import main
from film_model.core.modal import Tables
from film_model.solve.history import MOTION
from film_model.solve.sensed import MOTION as MOTION_OF_SENSORS
from fmu_wrapper import resource
from fmu_wrapper.assumptions import FEW
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import reference

VERSIONS = pytest.mark.parametrize("version", [2, 3])
FAST = on(RINGING, **{"effects.gravity": True, "solver.accuracy": 1e-4})
"""Gravity and the structure's motion bring the ball back again and again."""


def data_of(path):
    with zipfile.ZipFile(path) as archive:
        return resource.read(archive.read("resources/model.film"))


@pytest.mark.slow
@pytest.mark.parametrize(("place", "case"), list(enumerate(SCENES.values())), ids=SCENES)
def test_an_fmu_is_valid_and_has_the_motion_of_the_library(made, place, case):
    version = 3 - place % 2
    report = fmu_wrapper.check(made(case, version, initial_gap="2 um"), case)
    assert report.good, [finding for finding in report.findings if not finding.good]
    assert report.problems == () and report.findings[0].what == "vibrations"


@pytest.mark.slow
@combinations(law=["big-alabo", "stronge"], fast=1)
def test_where_a_stage_begins_the_rate_of_indentation_may_jump(made, law):
    """Omitted vibrations follow the force statically: `check` does not compare the two sides of the jump."""
    report = fmu_wrapper.check(made(on_structure(law, static_compliance="3e-6 m/N")))
    assert report.good, [finding for finding in report.findings if not finding.good]


@pytest.mark.slow
@VERSIONS
def test_dropped_again_and_again_in_steps_of_any_size(made, version):
    component = fm.ImpactComponent(fmu_wrapper.served(FAST), initial_gap=2e-6)
    expected = component.step(3e-3, external_force=100.0).outputs
    assert expected.contact_count >= 4
    with opened(made(FAST, version, initial_gap="2 um")) as fmu:
        for parts in (1, 7, 1000):
            with started(fmu, False, {"external_force": 100.0}) as slave:
                for k in range(parts):
                    slave.step(3e-3 * k / parts, 3e-3 / parts)
                found = slave.get((*MOTION, "contact_count", "kinetic_energy", "contact_energy", "target_energy"))
                work = slave.get(("external_work",))["external_work"]
            for name in MOTION:
                largest = float(np.abs(values(expected)).max()) if name == "contact_force" else 1.0
                assert found[name] == pytest.approx(getattr(expected, name), rel=1e-8, abs=1e-10 * largest)
            assert found["contact_count"] == expected.contact_count
            balance = found["kinetic_energy"] + found["contact_energy"] + found["target_energy"] - work
            assert balance == pytest.approx(0.5 * FAST.mass * FAST.approach_velocity**2, rel=1e-9)


@pytest.mark.slow
def test_each_event_ends_a_step_in_event_mode(made):
    events = fm.ImpactComponent(fmu_wrapper.served(FAST)).step(2e-3, external_force=100.0).events
    with opened(made(FAST)) as fmu, started(fmu, True, {"external_force": 100.0}) as slave:
        time, found = 0.0, [(0.0, 1.0)]  # first touch is handled at the start
        while time < 2e-3:
            time, event = slave.step(time, 2e-3 - time)
            if event:
                slave.instance.enterEventMode()
                slave.handle()
                found.append((time, slave.get(("last_event",))["last_event"]))
    names = [fm.core.native.EVENTS[int(kind)] for _, kind in found]
    assert names == [event.name for event in events]
    assert [at for at, _ in found] == pytest.approx([event.time for event in events], rel=1e-11)


@pytest.mark.slow
@VERSIONS
def test_a_state_is_restored_and_serialised(made, version):
    with opened(made(FAST, version)) as fmu, started(fmu, False, {}) as slave:
        slave.step(0.0, 1e-4)
        saved, middle = slave.save(), slave.get(tuple(MOTION))

        def go_on():
            slave.set("external_force", 30.0)
            slave.step(1e-4, 5e-4)
            return slave.get((*MOTION, "time_of_last_event", "maximum_force", "event_count"))

        first = go_on()
        instance = slave.instance
        if version == 2:
            size = ctypes.c_size_t()
            instance.fmi2SerializedFMUstateSize(instance.component, saved, ctypes.byref(size))
            content = instance.serializeFMUstate(saved)
            taken = instance.deSerializeFMUstate(content)
        else:
            content = instance.serializeFMUState(saved)
            taken = instance.deserializeFMUState(content)
        assert len(content) > 4 * 8 * fmu.data.modes.count
        for state in (taken, saved):  # freed when restored
            slave.restore(state)
            assert slave.get(tuple(MOTION)) == middle
            assert go_on() == first


@pytest.mark.slow
def test_validity_says_when_more_vibrations_are_needed(made):
    """A faster ball needs vibrations above those of the export, and its FMU says so."""
    fast = SCENES["the plate of the paper"].replace({"solver.accuracy": 0.05, "effects.tolerance": 0.01})
    found, k = data_of(made(fast)), reference("initial_velocity")
    assert found.reason[k][1].value == FEW.encode()
    for velocity, expected in ((found.start[k], 0.0), (2.0 * found.valid[k][1], 1.0)):
        with opened(made(fast)) as fmu, started(fmu, False, {"initial_velocity": velocity}) as slave:
            assert slave.get(("validity",))["validity"] == expected
            assert any(FEW in notice for notice in fmu.notices) == bool(expected)


@pytest.mark.slow
def test_parameters_change_the_impact_as_the_scene_does(made):
    """Mass, radius, modulus and velocity are parameters; the vibrations of the export serve the changed impact."""
    start = {"mass": 0.2, "radius": 0.02, "initial_velocity": 0.2}
    changed = FAST.replace({"impactor.mass": "0.2 kg", "impactor.radius": "20 mm", "impactor.velocity": "0.2 m/s"})
    expected = fm.simulate(fmu_wrapper.served(changed))
    ds = fmu_wrapper.run(made(FAST), start_values=start, stop_time=expected.duration)
    first = next(event for event in expected.events if event.name == "maximum_indentation")
    assert float(ds.contact_force.max()) >= first.contact_force * (1.0 - 1e-4)
    turns = ds.event_time.values[ds.event_kind.values == fm.core.native.EVENTS.index("maximum_indentation")]
    assert turns[0] == pytest.approx(first.time, rel=1e-3)
    names = resource.start_values(data_of(made(FAST)))
    assert {"mass", "initial_velocity", "initial_gap", "radius", "effective_modulus", "gravity"} <= set(names)
    assert not {"target_impedance", "loading_segments", "unloading_segments"} & set(names)


@VERSIONS
def test_there_is_no_model_exchange_and_the_documentation_says_why(made, version):
    path = made(FAST, version)
    with zipfile.ZipFile(path) as archive:
        assert b"ModelExchange" not in archive.read("modelDescription.xml")
        page = archive.read("documentation/index.html").decode()
    assert "followed by 3 natural vibrations, from 300 to 4000 Hz" in page
    assert "would be 6 states" in page
    with pytest.raises(
        ValueError, match="its target vibrates or has a static stiffness, so there is no mode 'exchange': mode 'steps'"
    ):
        fmu_wrapper.run(path, mode="exchange")
    from fmpy.fmi2 import FMU2Model, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
    from fmpy.fmi3 import FMU3Model

    callbacks = fmi2CallbackFunctions()  # FMPy's own may call a logger of another test, which Python has freed
    callbacks.logger = fmi2CallbackLoggerTYPE(lambda *_: None)

    with opened(path) as fmu:
        identifier = fmu.description.coSimulation.modelIdentifier
        kind = FMU2Model if version == 2 else FMU3Model
        model = kind(guid=fmu.description.guid, unzipDirectory=fmu.folder, modelIdentifier=identifier)
        with pytest.raises(Exception, match="nstantiate"):
            model.instantiate(**({"callbacks": callbacks} if version == 2 else {}))
        model.freeLibrary()


def test_a_resource_with_wrong_vibrations_is_refused(made):
    content = resource.finished(data := data_of(made(FAST)), data_of(made(FAST)).token.decode())
    assert resource.read(content).modes.count == 3
    tail = bytearray(data.tail)
    tail[0:8], tail[8:16] = data.tail[8:16], data.tail[0:8]  # frequencies that fall
    with opened(made(FAST)) as fmu:
        data.tail = bytes(tail)
        place = f"{fmu.folder}/resources/model.film"
        with open(place, "wb") as file:
            file.write(resource.finished(data, data.token.decode()))
        with pytest.raises(fm.SimulationError, match="its checksum or its numbers are wrong"), started(fmu, False, {}):
            pass


@pytest.mark.slow
def test_a_contact_alone_has_no_vibrations(made):
    assert data_of(made(OLSSON, kind="contact")).modes.count == 0


@pytest.mark.slow
def test_check_follows_the_vibrations_of_the_fmu(made, monkeypatch):
    """Rounding of natural frequencies depends on the threads of the linear algebra, and later contacts amplify it."""
    path = made(FAST)

    def with_frequencies_times(factor):
        def component(on, data):
            changed = resource.component_of(on, data)
            own = changed.vibrations
            tables = Tables(own.frequency * factor, own.share, own.ratio, own.longest)
            changed.follow(tables, data.modes.rest, data.modes.tolerance)
            return changed

        return component

    for factor, good in ((1.0 + 1e-9, True), (1.01, False)):
        monkeypatch.setattr("fmu_wrapper.checking.component_of", with_frequencies_times(factor))
        report = fmu_wrapper.check(path)
        assert report.findings[0].difference == pytest.approx(factor - 1.0, rel=0.02)
        assert [f for f in report.findings if not f.good] == ([] if good else [report.findings[0]])


def test_only_a_vibrating_target_follows_other_vibrations():
    component = fm.ImpactComponent(fm.Scene(FAST.impactor, fm.HalfSpace("mild steel")))
    assert component.vibrations is None
    with pytest.raises(fm.SimulationError, match="does not vibrate"):
        component.follow(Tables(*np.ones((3, 1)), 1.0), 0.0, 1e-6)


def test_too_many_vibrations_are_refused(made, monkeypatch):
    monkeypatch.setattr(resource, "MOST_MODES", 2)
    with pytest.raises(fm.SimulationError, match="the target has 3 natural vibrations at this accuracy, and an FMU at"):
        fmu_wrapper.export(FAST, "never.fmu")


@pytest.mark.slow
def test_check_fmu_on_the_command_line(made, capsys):
    assert main(["check-fmu", str(made(FAST)), "--json"]) == 0
    assert '"vibrations"' in capsys.readouterr().out


@pytest.mark.slow
def test_a_run_has_the_summary_of_all_contacts_on_the_vibrating_target(made):
    """As a history has: the largest force, the velocity after the last contact, the duration of the first."""
    plate = fm.Plate("structural steel S235", thickness="3 mm", size=["200 mm", "200 mm"])
    ball = fm.Sphere("20 mm", "1 m/s", material="bearing steel")
    on = fm.Scene(ball, plate, fm.Contact("hertz"), fm.Effects(gravity=False))
    history, ds = fm.simulate(on), fmu_wrapper.run(made(on))
    begins = [event.time for event in history.events if event.name == "contact_begins"]
    assert len(begins) > 1 and history.summary["time_of_maximum_indentation"] > begins[1]
    for name, value in history.summary.items():
        found = float(ds[name])
        assert np.isnan(found) or found == pytest.approx(value, rel=1e-9, abs=1e-15), name
    known = {name for name in history.summary if not np.isnan(float(ds[name]))}
    assert history.summary.keys() - known == {"energy_absorbed", "energy_radiated", "impulse"}


SENSORS = [{"name": "tip", "shape": [1.0, -0.5, 0.25]}, {"name": "far side", "shape": [0.0, 2.0, 1.0]}]
SENSING = on(fm.Structure(**LISTED, damping_ratio=0.02, sensors=SENSORS))


@pytest.mark.slow
@pytest.mark.parametrize(("version", "mode"), [(2, "steps"), (3, "events")])
def test_sensors_are_outputs(made, version, mode):
    """By the names of tables, with the motion of the history, also after the last contact; the support moves them."""
    history, path = fm.simulate(SENSING), made(SENSING, version)
    ds = fmu_wrapper.run(path, mode=mode, stop_time=2.0 * history.duration)
    assert fd.validate(ds) == [] and ds["sensor"].values.tolist() == ["tip", "far side"]
    expected = history.sensed_si(np.maximum(ds["t"].values, 0.0))
    for what in MOTION_OF_SENSORS:  # where contact begins and ends, the cubic of the force is not 0 but for its error
        ours, off = getattr(expected, what), 1e-5 if what == "acceleration" else 1e-11
        assert np.abs(ds[f"sensor_{what}"].values - ours).max() < off * np.abs(ours).max()
    names = tuple(f"sensor_far_side_{what}" for what in MOTION_OF_SENSORS)
    with opened(path) as fmu, started(fmu, False, {}) as slave:
        slave.step(0.0, 1e-4)
        before, saved = slave.get(names), slave.save()
        slave.set("support_velocity", 0.25)
        assert slave.get(names[1:2])[names[1]] == before[names[1]] + 0.25
        slave.step(1e-4, 1e-4)
        moved = slave.get(names)
        slave.restore(saved)
        assert slave.get(names) == before
        number = fmu.variables[names[1]][0]
        slope = slave.instance.getDirectionalDerivative([number], [reference("support_velocity")], [1.0])
        assert list(slope) == [1.0]
        with pytest.raises(Exception, match=r"FMI|fmi"):
            slave.set(names[0], 0.0)
        assert fmu.messages[-1].endswith("the motion of a sensor is an output and cannot be set")
    component = fm.ImpactComponent(fmu_wrapper.served(SENSING))
    component.step(1e-4)
    component.step(1e-4, support_velocity=0.25)
    assert list(moved.values()) == pytest.approx(
        [getattr(component.sensed, what)[1] for what in MOTION_OF_SENSORS], rel=1e-9
    )
