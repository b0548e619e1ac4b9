"""FMUs with friction: their motion along the surface is the component's; parameters, inputs and saved states."""

import math

import pytest
from fmpy.fmi1 import FMICallException
from test_stepped_friction import scene

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import OF_FRICTION, SLIDINGS, reference

OUTPUTS, EVENTS = OF_FRICTION[7:13], OF_FRICTION[13:17]
TABLE = [["0 m/s", 0.3], ["20 mm/s", 0.25], ["0.1 m/s", 0.1]]
BEAM = fm.Beam("bearing steel", length="60 mm", width="20 mm", thickness="8 mm", position="25 mm")


def on(law="hertz", target=None, **changes):
    given = {"restitution": 0.8} if law == "tsuji" else {}
    return fmu_wrapper.served(scene(law, 0.7, target=target, **given).replace({"impactor.spin": "2 rad/s", **changes}))


def component_for(path, served):
    with opened(path) as fmu:
        return fmu_wrapper.resource.component_of(served, fmu.data)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("table", [False, True])
@pytest.mark.parametrize("law", ["hertz", "elastoplastic", "tsuji", "on a beam"])
def test_outputs_are_those_of_the_component_under_changing_inputs(made, version, law, table):
    changes = {"contact.friction": TABLE} if table else {}
    served = on(target=BEAM, **changes) if law == "on a beam" else on(law, **changes)
    path, h = made(served, version), fm.simulate(served).duration / 40.5
    component, begun = component_for(path, served), []
    with opened(path) as fmu, started(fmu, False, {}) as slave:
        names = {variable.name for variable in fmu.description.modelVariables}
        lacking = {"friction"} if table else set()
        lacking |= {"rate_of_tangential_velocity", "rate_of_spin"} if law == "on a beam" else set()
        assert set(OF_FRICTION) - names == lacking
        assert (fmu.description.modelExchange is None) == (law == "on a beam")
        for n in range(60):
            inputs = {"tangential_force": math.sin(n / 5.0), "torque": 0.01 * math.cos(n / 4.0)}
            inputs["tangential_support_velocity"] = 0.01 * (n % 3)
            for name, value in inputs.items():
                slave.set(name, value)
            slave.step(n * h, h)
            step = component.step(h, **inputs)
            found, events = slave.get(OUTPUTS), slave.get(EVENTS)
            begun += step.sliding
            assert list(SLIDINGS)[int(events["sliding"])] == component.sliding.phase
            assert events["sliding_event_count"] == len(begun)
            last, kind = begun[-1] if begun else (0.0, "free")
            assert list(SLIDINGS)[int(events["last_sliding_event"])] == kind
            assert events["time_of_last_sliding_event"] == pytest.approx(last, abs=1e-9 * h)
            for name, value in zip(OUTPUTS, component.sliding, strict=False):
                size = {"spin": 10.0, "friction_force": 1.0}.get(name, 0.1)
                assert found[name] == pytest.approx(value, rel=1e-11, abs=1e-11 * size), (n, name)
    assert len(begun) > 2


def test_a_dataset_has_the_motion_along_the_surface(made):
    served = on()
    duration = fm.simulate(served).duration
    ds = fmu_wrapper.run(made(served), stop_time=1.2 * duration, step_size=duration / 10, inputs={"torque": 0.01})
    component = component_for(made(served), served)
    for k, time in enumerate(ds.t.values.tolist()):
        component.step(max(time - component.time, 0.0), torque=0.01)
        for name in ("sliding_velocity", "tangential_velocity", "spin", "friction_force"):
            size = float(abs(ds[name]).max())
            assert float(ds[name][k]) == pytest.approx(getattr(component.sliding, name), abs=1e-9 * size), name
    assert ds.friction_force.attrs["units"] == "N" and float(ds.friction_force.max()) > 1.0
    assert fd.validate(ds) == []


def test_parameters_are_those_of_other_impacts(made):
    served = on()
    given = {"friction": 0.35, "initial_tangential_velocity": 0.4, "initial_spin": -3.0, "mass": 0.05}
    angle = math.atan2(0.4, served.approach_velocity)
    changes = {"contact.friction": 0.35, "impactor.spin": "-3 rad/s", "impactor.mass": "50 g"}
    speed = math.hypot(0.4, served.approach_velocity)
    other = served.replace({**changes, "impactor.angle": f"{angle} rad", "impactor.velocity": f"{speed} m/s"})
    history = fm.simulate(other, accuracy=1e-8)
    with (
        opened(made(served)) as fmu,
        started(fmu, False, {**given, "loading_segments": 200, "unloading_segments": 200}) as slave,
    ):
        slave.step(0.0, 1.01 * history.duration)
        found = slave.get(OUTPUTS)
    exact, before = history.oblique.summary, history.oblique.motion["sliding_velocity"][0]
    assert found["sliding_velocity"] == pytest.approx(exact["contact_point_rebound_velocity"], abs=2e-5 * before)
    assert found["tangential_velocity"] == pytest.approx(exact["tangential_rebound_velocity"], abs=1e-5 * before)
    assert found["spin"] == pytest.approx(exact["rebound_spin"], abs=2e-5 * before / 0.01)


def test_a_table_holds_for_other_masses(made):
    """The mass changes the unit of the velocity in which the core has the table."""
    served = on(**{"contact.friction": TABLE})
    history = fm.simulate(served.replace({"impactor.mass": "50 g"}), accuracy=1e-8)
    fine = {"loading_segments": 200, "unloading_segments": 200}
    with opened(made(served)) as fmu, started(fmu, False, {"mass": 0.05, **fine}) as slave:
        slave.step(0.0, 1.01 * history.duration)
        found = slave.get(OUTPUTS)
    exact, before = history.oblique.summary, history.oblique.motion["sliding_velocity"][0]
    assert found["sliding_velocity"] == pytest.approx(exact["contact_point_rebound_velocity"], abs=5e-5 * before)
    assert found["friction_work"] == pytest.approx(exact["friction_work"], rel=1e-3)


def test_a_saved_state_has_friction_too(made):
    served = on()
    h = fm.simulate(served).duration / 10
    with opened(made(served)) as fmu, started(fmu, False, {}) as slave:
        slave.set("torque", 0.01)
        slave.step(0.0, 4 * h)
        saved = slave.save()
        slave.step(4 * h, 8 * h)
        first = slave.get(OUTPUTS)
        slave.restore(saved)
        slave.step(4 * h, 8 * h)
        assert slave.get(OUTPUTS) == first


def test_derivatives_by_parameters_leave_friction_out(made):
    served = on()
    path, by = made(served, 2), ([reference("mass")], [1.0])
    with opened(path) as fmu, started(fmu, False, {}) as slave:
        slave.step(0.0, 1.2 * fm.simulate(served).duration)
        assert slave.instance.getDirectionalDerivative([reference("maximum_force")], *by)[0] > 0.0
        with pytest.raises(FMICallException):
            slave.instance.getDirectionalDerivative([reference("spin")], *by)
        assert "spin has no derivative by the parameter mass after Initialization Mode" in fmu.messages[-1]


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_check_fmu_finds_it_good(made, version):
    served = on("elastoplastic", **{"contact.friction": TABLE})
    report = fmu_wrapper.check(made(served, version), served)
    assert report.good, report.largest()
    assert any(finding.what.endswith(": spin") for finding in report.findings)


def test_what_has_no_friction_is_refused_or_lacks_its_variables(made, tmp_path):
    with pytest.raises(fm.SimulationError, match="a contact contains the normal motion only"):
        fmu_wrapper.export(on(), tmp_path / "contact.fmu", kind="contact")
    with opened(made(on(**{"contact.friction": None}))) as fmu:
        names = {variable.name for variable in fmu.description.modelVariables}
        assert not names & set(OF_FRICTION)
