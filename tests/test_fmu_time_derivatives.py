"""Time derivatives of inputs and outputs of FMUs under a master that steps its components side by side."""

import ctypes
from dataclasses import replace

import numpy as np
import pytest
from cases import scene
from scipy.integrate import solve_ivp

import film_model as fm
from film_model.laws.hertz import hertz_stiffness
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import VARIABLES, reference

OTHER_MASS, SPRING, DAMPER = 0.5, 2e6, 20.0  # kg, N/m, N s/m: a body that carries the target
FINE = {"loading_segments": 800.0, "unloading_segments": 800.0}


def rates_of(slave, *names):
    references = [reference(name) for name in names]
    if slave.version == 3:
        return dict(zip(names, slave.instance.getOutputDerivatives(references, [1] * len(names)), strict=True))
    values = (ctypes.c_double * len(names))()
    slave.instance.fmi2GetRealOutputDerivatives(
        slave.instance.component,
        (ctypes.c_uint32 * len(names))(*references),
        len(names),
        (ctypes.c_int * len(names))(*[1] * len(names)),
        values,
    )
    return dict(zip(names, values, strict=True))


def set_rate(slave, name, value, order=1):
    slave.instance.fmi2SetRealInputDerivatives(
        slave.instance.component,
        (ctypes.c_uint32 * 1)(reference(name)),
        1,
        (ctypes.c_int * 1)(order),
        (ctypes.c_double * 1)(value),
    )


def hertz():
    return replace(scene("hertz"), effects=fm.Effects(gravity=False))


def pushed(slave, frequency, size, steps, end, with_rates):
    """Velocity and indentation under external_force = size sin(frequency t) after `steps` steps."""
    h = end / steps
    for n in range(steps):
        slave.set("external_force", size * np.sin(frequency * n * h))
        if with_rates:
            set_rate(slave, "external_force", size * frequency * np.cos(frequency * n * h))
        slave.step(n * h, h)
    found = slave.get(("impactor_velocity", "indentation"))
    return np.array([found["impactor_velocity"], found["indentation"]])


def orders(errors):
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_a_force_that_changes_is_followed_to_second_order(made):
    on = hertz()
    history = fm.simulate(on, accuracy=1e-8)
    end, stiffness = 0.8 * history.duration, hertz_stiffness(on.effective_modulus, on.effective_radius)
    size, frequency = history.summary["maximum_force"], 5.0 / history.duration

    def rates(t, y):
        return [y[1], (size * np.sin(frequency * t) - stiffness * max(y[0], 0.0) ** 1.5) / on.mass]

    exact = solve_ivp(rates, (0.0, end), [0.0, on.approach_velocity], "DOP853", rtol=1e-12, atol=1e-18).y[::-1, -1]
    found = {}
    for with_rates in (False, True):
        errors = []
        for steps in (40, 80, 160, 320):
            with opened(made(on, 2)) as fmu, started(fmu, False, FINE) as slave:
                errors.append(abs(pushed(slave, frequency, size, steps, end, with_rates)[0] - exact[0]))
        found[with_rates] = errors
    assert orders(found[False]) == pytest.approx(1.0, abs=0.1)
    assert orders(found[True]) == pytest.approx(2.0, abs=0.15)
    assert found[True][-1] < 1e-4 * on.approach_velocity


def carried(slave, on, steps, end, with_rates):
    """Velocities of the ball and of the body that carries the target, side by side: that of the body is an input of the
    impact, whose force acts on the body. With rates both are extrapolated."""
    h, x, v = end / steps, 0.0, 0.0
    for n in range(steps):
        force = slave.get(("contact_force",))["contact_force"]
        growth = rates_of(slave, "contact_force")["contact_force"] if with_rates else 0.0
        pull = (force - SPRING * x - DAMPER * v) / OTHER_MASS
        slave.set("support_velocity", v)
        if with_rates:
            set_rate(slave, "support_velocity", pull)
        slave.step(n * h, h)

        def body(t, y, force=force, growth=growth):
            return [y[1], (force + growth * t - SPRING * y[0] - DAMPER * y[1]) / OTHER_MASS]

        x, v = solve_ivp(body, (0.0, h), [x, v], "DOP853", rtol=1e-11, atol=1e-16).y[:, -1]
    return np.array([slave.get(("impactor_velocity",))["impactor_velocity"], v])


@pytest.mark.slow
def test_two_bodies_under_a_plain_master_couple_to_second_order(made):
    on = hertz()
    end = 0.8 * fm.simulate(on).duration
    stiffness = hertz_stiffness(on.effective_modulus, on.effective_radius)

    def rates(t, y):
        force = stiffness * max(y[0] - y[2], 0.0) ** 1.5
        return [y[1], -force / on.mass, y[3], (force - SPRING * y[2] - DAMPER * y[3]) / OTHER_MASS]

    start = [0.0, on.approach_velocity, 0.0, 0.0]
    exact = solve_ivp(rates, (0.0, end), start, "DOP853", rtol=1e-12, atol=1e-18).y[[1, 3], -1]
    for with_rates, order in ((False, 1.0), (True, 2.0)):
        errors = []
        for steps in (25, 50, 100, 200):
            with opened(made(on, 2)) as fmu, started(fmu, False, FINE) as slave:
                errors.append(np.abs(carried(slave, on, steps, end, with_rates) - exact).max())
        assert orders(errors) == pytest.approx(order, abs=0.3), errors
    assert errors[-1] < 1e-4 * on.approach_velocity


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("law", ["hertz", "tsuji"])
def test_rates_of_outputs_are_their_differences(made, version, law):
    on = replace(scene(law, "plate"), effects=fm.Effects(gravity=False))
    outputs = [v for v in VARIABLES if v.variability == "continuous" and v.causality.get("impact") == "output"]
    names = [v.name for v in outputs if not v.group]
    duration = fm.simulate(on).duration
    with opened(made(on, version)) as fmu, started(fmu, False, FINE) as slave:
        h = 1e-4 * duration
        slave.step(0.0, 0.3 * duration)
        before, rates = slave.get(names), rates_of(slave, *names, "maximum_force")
        slave.step(0.3 * duration, h)
        after, later = slave.get(names), rates_of(slave, *names)
    for name in names:
        difference = (after[name] - before[name]) / h
        assert difference == pytest.approx(0.5 * (rates[name] + later[name]), rel=2e-5), name
    assert rates["maximum_force"] == 0.0


def test_a_rate_lasts_one_step_and_is_part_of_the_state(made):
    with opened(made(hertz(), 2)) as fmu, started(fmu, False, {}) as slave:
        slave.set("external_force", 1.0)
        set_rate(slave, "external_force", 1e6)
        saved = slave.save()
        slave.step(0.0, 1e-6)
        assert slave.get(("external_force",))["external_force"] == pytest.approx(2.0, rel=1e-12)
        once = slave.get(("impactor_velocity",))
        slave.step(1e-6, 1e-6)
        assert slave.get(("external_force",))["external_force"] == pytest.approx(2.0, rel=1e-12)
        slave.restore(saved)
        slave.step(0.0, 1e-6)
        assert slave.get(("impactor_velocity",)) == once


def test_rates_that_do_not_exist_are_refused_in_a_sentence(made):
    for name, order, sentence in (
        ("mass", 1, "only inputs of an impact have time derivatives"),
        ("external_force", 2, "inputs have time derivatives of order 1, not 2"),
    ):
        path = made(hertz(), 2)
        with opened(path) as fmu, pytest.raises(fm.SimulationError, match=sentence), started(fmu, False, {}) as slave:
            set_rate(slave, name, 1.0, order)
    with opened(made(hertz(), 2, kind="contact")) as fmu:
        assert not fmu.description.coSimulation.canInterpolateInputs
        sentence = "of impacts that have Model Exchange too"
        with pytest.raises(fm.SimulationError, match=sentence), started(fmu, False, {}) as slave:
            rates_of(slave, "contact_force")
