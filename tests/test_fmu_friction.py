"""FMUs with friction: their motion along the surface is the component's; parameters, inputs and saved states."""

import math
from ctypes import c_double

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from test_stepped_friction import scene

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import OF_FRICTION, SLIDINGS, STATES, reference

OUTPUTS, EVENTS = OF_FRICTION[7:13], OF_FRICTION[13:17]
TABLE = [["0 m/s", 0.3], ["20 mm/s", 0.25], ["0.1 m/s", 0.1]]
BEAM = fm.Beam("bearing steel", length="60 mm", width="20 mm", thickness="8 mm", position="25 mm")


def on(law="hertz", target=None, psi=0.7, **changes):
    given = {"restitution": 0.8} if law in ("tsuji", "hunt-crossley") else {}
    return fmu_wrapper.served(scene(law, psi, target=target, **given).replace({"impactor.spin": "2 rad/s", **changes}))


def component_for(path, served):
    with opened(path) as fmu:
        return fmu_wrapper.resource.component_of(served, fmu.data)


@pytest.mark.slow
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


# ---------------------------------------------------------------- Model Exchange


def errors(path, served, steps, solver="CVode", **inputs):
    """Of FMPy in so many steps a contact, over the largest value in the component: of the outputs, and the phases."""
    h = fm.simulate(served).duration / steps
    component, worst, largest, begun = component_for(path, served), dict.fromkeys(OUTPUTS, 0.0), {}, []
    kinds = np.dtype([("time", float), *((name, float) for name in inputs)])
    signals = np.array([(t, *inputs.values()) for t in (0.0, 1.0)], kinds) if inputs else None
    rows = simulate_fmu(
        str(path),
        fmi_type="ModelExchange",
        solver=solver,
        step_size=h if solver == "Euler" else None,
        output_interval=h,
        stop_time=1.2 * steps * h,
        relative_tolerance=1e-8,
        record_events=False,
        start_values=inputs,
        input=signals,
        output=(*OUTPUTS, *EVENTS),
    )
    for row in rows:
        begun += component.step(max(row["time"] - component.time, 0.0), **inputs).sliding
        for name, value in zip(OUTPUTS, component.sliding, strict=False):
            worst[name] = max(worst[name], abs(row[name] - value))
            largest[name] = max(largest.get(name, 0.0), abs(value))
    last = {name: rows[name][-1] for name in EVENTS}
    return max(worst[name] / largest[name] for name in OUTPUTS), last, begun


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("psi", [0.3, 2.0, 8.0])
@pytest.mark.parametrize("law", ["hertz", "elastoplastic", "thornton", "tsuji", "hunt-crossley"])
def test_model_exchange_slides_as_the_component_does(made, law, psi, version):
    """Impacts that stick first, slide first and slide throughout."""
    served = on(law, psi=psi)
    worst, last, begun = errors(made(served, version), served, 20)
    assert worst < 3e-5
    assert list(SLIDINGS)[int(last["last_sliding_event"])] == begun[-1][1] and last["sliding"] == 0
    if law == "hertz":
        assert last["sliding_event_count"] == len(begun)
        assert last["time_of_last_sliding_event"] == pytest.approx(begun[-1][0], rel=1e-2)


def test_model_exchange_follows_inputs(made):
    served = on(psi=2.0, **{"contact.friction": 0.35})
    inputs = {"tangential_force": 3.0, "torque": -0.05, "tangential_support_velocity": 0.02, "support_velocity": 0.05}
    worst, *_ = errors(made(served), served, 50, **inputs)
    assert worst < 3e-5


def test_a_table_of_friction_in_model_exchange(made):
    """Coefficients that change with the sliding velocity have errors of the order of the component's steps."""
    served = on(psi=2.0, **{"contact.friction": TABLE})
    assert errors(made(served), served, 50)[0] < 1e-3


def test_friction_can_change_in_event_mode(made):
    served = on(psi=8.0)
    h = fm.simulate(served).duration / 500
    with opened(made(served)) as fmu, started(fmu, False, {}, True) as slave:
        time, _ = follow(slave, h, 150)
        before = slave.get(("friction_force", "contact_force"))
        assert before["friction_force"] == pytest.approx(0.2 * before["contact_force"], rel=1e-12)
        slave.instance.enterEventMode()
        slave.set("friction", 0.1)
        slave.handle()
        assert slave.get(("friction_force",))["friction_force"] == pytest.approx(0.1 * before["contact_force"])
        follow(slave, h, 150, time)
        after = slave.get(("friction_force", "contact_force"))
        assert after["friction_force"] == pytest.approx(0.1 * after["contact_force"], rel=1e-12)


@pytest.mark.slow
def test_errors_of_model_exchange_fall_with_the_steps(made):
    """The numbers of docs/fmus.md: the largest error of all outputs and three regimes, over their largest values."""
    paths = {psi: (made(on(psi=psi)), on(psi=psi)) for psi in (0.3, 2.0, 8.0)}

    def worst(steps, solver="CVode"):
        return max(errors(path, served, steps, solver)[0] for path, served in paths.values())

    assert worst(5) < 5e-3
    assert worst(10) < 5e-4
    assert worst(20) < 3e-5
    assert worst(50) < 2e-5
    slow, fast = worst(1000, "Euler"), worst(4000, "Euler")
    assert fast < 0.01 and 3.0 < slow / fast < 5.0


def follow(slave, h, count, time=0.0):
    """So many steps of Heun's method; the time and the states after them."""
    instance, n = slave.instance, len(STATES)
    x, rates, ahead = (c_double * n)(), (c_double * n)(), (c_double * n)()
    derivatives = instance.getDerivatives if slave.fmu.version == 2 else instance.getContinuousStateDerivatives
    instance.getContinuousStates(x, n)
    for _ in range(count):
        derivatives(rates, n)
        instance.setTime(time + h)
        instance.setContinuousStates((c_double * n)(*(a + h * b for a, b in zip(x, rates, strict=True))), n)
        derivatives(ahead, n)
        x = (c_double * n)(*(a + 0.5 * h * (b + c) for a, b, c in zip(x, rates, ahead, strict=True)))
        time += h
        instance.setContinuousStates(x, n)
        asked, _ = instance.completedIntegratorStep()
        if asked or min(slave.indicators(5)) <= 0.0:
            before = slave.get(EVENTS)
            instance.enterEventMode()
            assert slave.get(EVENTS) == before  # discrete outputs change in Event Mode only
            slave.handle()
    return time, x


@pytest.mark.parametrize("version", [2, 3])
def test_a_step_that_is_not_accepted_leaves_the_springs(made, version):
    served = on(psi=2.0)
    h, n = fm.simulate(served).duration / 500, len(STATES)
    with opened(made(served, version)) as fmu, started(fmu, False, {}, True) as slave:
        time, x = follow(slave, h, 150)
        saved, now = slave.save(), slave.get(OUTPUTS)
        assert now["friction_force"] > 1.0
        for far in (1.1, 0.5):
            slave.instance.setTime(time + 9 * h)
            slave.instance.setContinuousStates((c_double * n)(*(far * value for value in x)), n)
            assert slave.get(OUTPUTS) != now
        slave.instance.setTime(time)
        slave.instance.setContinuousStates(x, n)
        assert slave.get(OUTPUTS) == now
        follow(slave, h, 200, time)
        later = slave.get(OUTPUTS)
        slave.restore(saved)
        follow(slave, h, 200, time)
        assert slave.get(OUTPUTS) == later != now


@pytest.mark.slow
@pytest.mark.parametrize("exchange", [True, False])
@pytest.mark.parametrize("part", [0.1, 0.3, 0.6, 0.9])
def test_derivatives_are_differences_where_what_slips_slips_on(made, exchange, part):
    """By the states, of the motion a moment ahead; rates of outputs in time are those of the next step."""
    served = on(psi=2.0)
    duration = fm.simulate(served).duration
    h = duration / 2000
    with opened(made(served)) as fmu, started(fmu, False, {}, exchange) as slave:

        def partial(of, by):
            return slave.instance.getDirectionalDerivative([reference(of)], [reference(by)], [1.0])[0]

        if exchange:
            time, _ = follow(slave, h, int(2000 * part))
            mass = fmu.data.start[reference("mass")]
            assert partial("rate_of_tangential_velocity", "tangential_force") == pytest.approx(1.0 / mass, rel=1e-12)
            assert partial("sliding_velocity", "spin") == pytest.approx(0.01, rel=1e-12)
            assert partial("spin", "spin") == 1.0
        else:
            slave.step(0.0, part * duration)
        rates = {
            "indentation": slave.get(("relative_velocity",))["relative_velocity"],
            "impactor_velocity": slave.get(("impactor_acceleration",))["impactor_acceleration"],
            "sliding_displacement": slave.get(("sliding_velocity",))["sliding_velocity"],
        }
        slope = sum(partial("friction_force", name) * rate for name, rate in rates.items())
        before = slave.get(("friction_force",))["friction_force"]
        if exchange:
            follow(slave, h / 10, 10, time)
        else:
            slave.step(part * duration, h)
        after = slave.get(("friction_force",))["friction_force"]
        assert slope == pytest.approx((after - before) / h, rel=2e-3)


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
