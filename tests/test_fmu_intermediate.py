"""Accuracy of intermediate updates of FMI 3.0: inputs that the importer sets within a step."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from fmu_resources import CASES
from intermediate import MOTION, PARTS, updated
from scipy.integrate import solve_ivp
from test_fmu_time_derivatives import DAMPER, FINE, OTHER_MASS, SPRING, hertz, orders, set_rate

import film_model as fm
from film_model.laws.hertz import hertz_stiffness
from fmu_wrapper.instance import opened, started

INPUTS = ("external_force", "support_velocity")


@dataclass(frozen=True)
class Driven:
    """A ball under a force and on a support that both swing."""

    on: fm.Scene
    end: float
    size: float
    frequency: float

    def inputs(self, time):
        swing = np.sin(self.frequency * time)
        return {"external_force": self.size * swing, "support_velocity": 0.5 * self.on.approach_velocity * swing}

    def set(self, slave, time):
        for name, value in self.inputs(time).items():
            slave.set(name, value)

    def importer(self, slave, time, may_set, *_):
        if may_set:
            self.set(slave, time)

    def velocity(self, fmu, steps, update):
        with updated(fmu, update, INPUTS, FINE) as slave:
            for n in range(steps):
                self.set(slave, n * self.end / steps)
                slave.do_step(n * self.end / steps, self.end / steps)
            return slave.get(("impactor_velocity",))["impactor_velocity"]

    def exact(self):
        stiffness = hertz_stiffness(self.on.effective_modulus, self.on.effective_radius)

        def rates(t, y):
            given = self.inputs(t)
            force = given["external_force"] - stiffness * max(y[0] - y[2], 0.0) ** 1.5
            return [y[1], force / self.on.mass, given["support_velocity"]]

        start = [0.0, self.on.approach_velocity, 0.0]
        return solve_ivp(rates, (0.0, self.end), start, "DOP853", rtol=1e-12, atol=1e-18).y[1, -1]


def driven():
    on = hertz()
    history = fm.simulate(on, accuracy=1e-8)
    return Driven(on, 0.8 * history.duration, history.summary["maximum_force"], 5.0 / history.duration)


def test_inputs_set_in_the_step_are_followed_to_second_order(made):
    case, found = driven(), {}
    exact = case.exact()
    with opened(made(case.on)) as fmu:
        for update in (None, case.importer):
            errors = [abs(case.velocity(fmu, steps, update) - exact) for steps in (5, 10, 20, 40)]
            found[update] = np.array(errors) / case.on.approach_velocity
    assert orders(found[None]) == pytest.approx(1.0, abs=0.1)
    assert np.log2(found[case.importer][0] / found[case.importer][-1]) / 3 == pytest.approx(2.0, abs=0.2)
    assert found[None][-1] > 0.05 and found[case.importer][-1] < 5e-5


@pytest.mark.slow
@pytest.mark.parametrize("slows_down", [True, False])
def test_a_moving_support_turns_the_motion_a_few_times(made, slows_down):
    """At maximum indentation its velocity must stay, or it would turn the motion again and again at the same time."""
    on, names = hertz(), ("event_count", "contact_count", "impactor_velocity")
    end, found = 1.3 * fm.simulate(on).duration, []

    def support(time):
        return 0.3 * on.approach_velocity * (1.0 - time / end if slows_down else time / end)

    def importer(slave, time, may_set, *_):
        if may_set:
            slave.set("support_velocity", support(time))

    with opened(made(on)) as fmu:
        for steps in range(1, 25):
            with updated(fmu, importer, ("support_velocity",), {"support_velocity": support(0.0)}) as slave:
                for n in range(steps):
                    slave.do_step(n * end / steps, end / steps)
                found.append(slave.get(names))
    last = found[-1]
    for values in found:
        assert 3.0 <= values["event_count"] <= 8.0 and values["contact_count"] == 1.0
        assert values["impactor_velocity"] == pytest.approx(last["impactor_velocity"], abs=2e-3 * on.approach_velocity)


class Carriage:
    """A body on a spring and a damper that carries the target; extrapolates the force by its rate."""

    def __init__(self):
        self.time = self.displacement = self.velocity = 0.0

    def read(self, slave):
        self.force, self.growth = slave.get(("contact_force",))["contact_force"], slave.rate("contact_force")

    def at(self, time):
        """Displacement and velocity at a later time, by one step of Runge-Kutta of fourth order."""

        def rates(t, y):
            push = self.force + self.growth * t
            return np.array([y[1], (push - SPRING * y[0] - DAMPER * y[1]) / OTHER_MASS])

        y, h = np.array([self.displacement, self.velocity]), time - self.time
        first = rates(0.0, y)
        second = rates(0.5 * h, y + 0.5 * h * first)
        third = rates(0.5 * h, y + 0.5 * h * second)
        return y + h / 6.0 * (first + 2.0 * (second + third) + rates(h, y + h * third))

    def move(self, time):
        self.displacement, self.velocity = self.at(time)
        self.time = time

    def importer(self, slave, time, may_set, may_get, *_):
        if may_get:
            self.move(time)
            self.read(slave)
        if may_set:
            slave.set("support_velocity", self.at(time)[1])

    def velocities(self, fmu, steps, end):
        with updated(fmu, self.importer, ("support_velocity", "contact_force"), FINE) as slave:
            for n in range(steps):
                self.read(slave)
                slave.do_step(n * end / steps, end / steps)
                self.move((n + 1) * end / steps)
            return np.array([slave.get(("impactor_velocity",))["impactor_velocity"], self.velocity])


@pytest.mark.slow
def test_two_bodies_couple_in_the_step_to_second_order(made):
    on = hertz()
    end, stiffness = 0.8 * fm.simulate(on).duration, hertz_stiffness(on.effective_modulus, on.effective_radius)

    def rates(t, y):
        force = stiffness * max(y[0] - y[2], 0.0) ** 1.5
        return [y[1], -force / on.mass, y[3], (force - SPRING * y[2] - DAMPER * y[3]) / OTHER_MASS]

    start = [0.0, on.approach_velocity, 0.0, 0.0]
    exact = solve_ivp(rates, (0.0, end), start, "DOP853", rtol=1e-12, atol=1e-18).y[[1, 3], -1]
    with opened(made(on)) as fmu:
        errors = [np.abs(Carriage().velocities(fmu, steps, end) - exact).max() for steps in (12, 24, 48, 96)]
    assert np.log2(errors[0] / errors[-1]) / 3 == pytest.approx(2.0, abs=0.3), errors
    assert errors[0] < 3e-5 * on.approach_velocity


class Ball:
    """A ball of the importer, whose contact is the FMU: the force is held between points."""

    def __init__(self, on):
        self.mass, self.depth, self.velocity, self.time, self.force = on.mass, -1e-9, on.approach_velocity, 0.0, 0.0

    def exchange(self, slave, time):
        size, pull = time - self.time, -self.force / self.mass
        self.depth += size * (self.velocity + 0.5 * size * pull)
        self.velocity += size * pull
        self.time = time
        self.force = slave.get(("contact_force",))["contact_force"]
        slave.set("indentation", self.depth)
        slave.set("relative_velocity", self.velocity)

    def importer(self, slave, time, may_set, may_get, finished, can_return):
        assert may_set and may_get and finished and not can_return
        self.exchange(slave, time)


@pytest.mark.parametrize(("steps", "error"), [(5, 2e-3), (20, 5e-5)])
def test_a_contact_exchanges_force_and_motion_in_the_step(made, steps, error):
    on = hertz()
    size, required = fm.simulate(on).duration / steps, ("indentation", "relative_velocity", "contact_force")
    with opened(made(on, kind="contact")) as fmu:
        gained = []
        for update in (True, False) if steps == 20 else (True,):
            ball = Ball(on)
            with updated(fmu, ball.importer if update else None, required, {"indentation": ball.depth}) as slave:
                for n in range(2 * steps):
                    ball.exchange(slave, n * size)
                    slave.do_step(n * size, size)
            gained.append(abs(ball.velocity) / on.approach_velocity - 1.0)
    assert gained[0] == pytest.approx(0.0, abs=error)
    assert steps == 5 or gained[1] > 100 * gained[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["friction", "vibrations", "viscoelastic, on a rod", "static stiffness, hertz", "tsuji on a plate"]
)
def test_updates_are_small_steps_with_rates_of_fmi_2(made, name):
    """Inputs that change linearly in each part of a step, as in steps of that part with time derivatives."""
    _, on, _ = CASES[name]
    size = fm.simulate(replace(on, effects=fm.Effects())).duration / 10
    force, along = 0.1 * on.mass * on.approach_velocity / size, name == "friction"

    def inputs(time):
        swing = np.sin(0.4 * time / size)
        values = {"external_force": force * swing, "support_velocity": 0.02 * on.approach_velocity * swing}
        return values | ({"tangential_force": 3.0 * swing, "torque": 0.01 * swing} if along else {})

    def importer(slave, time, may_set, *_):
        for key, value in inputs(time).items() if may_set else ():
            slave.set(key, value)

    names = (*MOTION, "contact_count", "contact_impulse", *(("spin", "friction_force") if along else ()))
    with opened(made(on, 3)) as fmu, updated(fmu, importer, tuple(inputs(0.0))) as slave:
        for n in range(4):  # before an event, at which the rest of a part begins anew
            slave.do_step(n * size, size)
        found = slave.get(names)
    part = size / PARTS
    with opened(made(on, 2)) as fmu, started(fmu, False, {}) as slave:
        for n in range(4 * PARTS):
            later = inputs((n + 1) * part)
            for key, value in inputs(n * part).items():
                slave.set(key, value)
                set_rate(slave, key, (later[key] - value) / part)
            slave.step(n * part, part)
        expected = slave.get(names)
    assert expected["contact_count"] == 1
    for key, value in expected.items():
        assert found[key] == pytest.approx(value, rel=1e-6 if along else 1e-9, abs=1e-15), key
