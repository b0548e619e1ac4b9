"""FMUs of kind contact in masters that exchange values at communication points; energies of FMUs of kind impact."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from cases import combinations, scene
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import film_model as fm
import fmu_wrapper
from film_model.laws.hertz import hertz_stiffness
from fmu_wrapper import comparisons
from fmu_wrapper.documentation import COUPLING_ERRORS, COUPLINGS
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import reference

WAYS = {
    COUPLINGS[0]: ("side by side", 1.5),
    COUPLINGS[1]: ("side by side", 1.0),
    COUPLINGS[2]: ("bodies first", 0.5),
    COUPLINGS[3]: ("read", 1.5),
    COUPLINGS[4]: ("extended", 1.5),
}


def gradient(slave, unknown, known):
    return slave.instance.getDirectionalDerivative([reference(unknown)], [reference(known)], [1.0])[0]


def coupled(slave, history, steps, way, ahead):
    """Restitution, largest force and end, s, of a mass coupled to the contact, `steps` steps a contact."""
    on = history.scene
    h, x, v, told, time, largest = history.duration / steps, 0.0, on.approach_velocity, 0.0, 0.0, 0.0
    mass, velocity = on.mass, on.approach_velocity
    slave.instance.reset()
    slave.initialize({"indentation": 0.0, "relative_velocity": velocity, "input_extrapolation": ahead})

    def contact_step(indentation, rate):
        slave.set("indentation", indentation)
        slave.set("relative_velocity", rate)
        before = slave.get(("contact_force",))["contact_force"]
        slope = gradient(slave, "contact_force", "indentation")
        slave.step(time, h)
        return before, slope, slave.get(("contact_force",))["contact_force"]

    for _ in range(3 * steps):
        if way == "bodies first":
            x, v = moved(x, v, -told / mass, h)
            _, _, told = contact_step(x, v)
        else:
            force, slope, after = contact_step(x, v)
            if way == "extended" and x > 0.0:
                omega, a = math.sqrt(slope / mass), -force / mass
                x += v / omega * math.sin(omega * h) + a / omega**2 * (1.0 - math.cos(omega * h))
                v = v * math.cos(omega * h) + a / omega * math.sin(omega * h)
            else:
                x, v = moved(x, v, -(told if way == "side by side" else force) / mass, h)
            told = after if way == "side by side" else force
        time, largest = time + h, max(largest, told)
        if x < 0.0 and v < 0.0:
            break
    return -v / velocity, largest, time


def moved(x, v, a, h):
    return x + v * h + 0.5 * a * h * h, v + a * h


def test_coupling_errors_are_those_of_the_documentation(made):
    history = fm.simulate(scene("hertz"), accuracy=1e-8)
    with opened(made(history.scene, 3, kind="contact")) as fmu, started(fmu, False, {}) as slave:
        for steps, told in COUPLING_ERRORS.items():
            for name, error in zip(COUPLINGS, told, strict=True):
                restitution, *_ = coupled(slave, history, steps, *WAYS[name])
                assert restitution - 1.0 == pytest.approx(error, rel=0.1), (steps, name)


@pytest.mark.parametrize(("steps", "validity"), [(7, 8), (10, 8), (30, 0)])
def test_a_contact_of_few_steps_says_so(made, steps, validity):
    history = fm.simulate(scene("hertz"), accuracy=1e-8)
    with opened(made(history.scene, 3, kind="contact")) as fmu, started(fmu, False, {}) as slave:
        restitution, _, time = coupled(slave, history, steps, "side by side", 1.5)
        apart = {"indentation": -1e-6, "relative_velocity": -restitution * history.scene.approach_velocity}
        for name, value in apart.items():
            slave.set(name, value)
        slave.step(time, 1e-6)
        assert int(slave.get(("validity",))["validity"]) & 8 == validity
    told = re.findall(r"a contact lasted (\d+) communication steps; with fewer than 20 ", "".join(fmu.notices))
    assert [abs(int(count) - steps) <= 2 for count in told] == [True] * (validity == 8)


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("way", ["side by side", "bodies first"])
def test_a_contact_of_too_few_steps_is_an_error(made, version, way):
    """Steps of 200 and 100 us, in a contact of 200 us, multiply the velocity by 33 and 5: the run ends so."""
    history = fm.simulate(scene("hertz"), accuracy=1e-8)

    def run(steps):
        with opened(made(history.scene, version, kind="contact")) as fmu, started(fmu, False, {}) as slave:
            restitution, _, time = coupled(slave, history, steps, way, 1.5 if way == "side by side" else 0.5)
            slave.set("indentation", -1e-6)
            slave.set("relative_velocity", -restitution * history.scene.approach_velocity)
            slave.step(time, 1e-6)

    for steps, gain in ((1, "33"), (2, "5.")):
        with pytest.raises(
            fm.SimulationError, match=f"left the bodies with {gain}.* with which they met; ask for steps below"
        ):
            run(steps)


def test_bodies_that_a_contact_pushes_apart_from_rest_are_no_error(made):
    with opened(made(scene("hertz"), 3, kind="contact")) as fmu, started(fmu, False, {"indentation": 1e-6}) as slave:
        for k, (indentation, rate) in enumerate([(1e-6, 0.0), (0.5e-6, -0.1), (-1e-6, -0.2)]):
            slave.set("indentation", indentation)
            slave.set("relative_velocity", rate)
            slave.step(k * 1e-5, 1e-5)
        assert slave.get(("validity",))["validity"] == 8


@combinations(law=["hertz", "big-alabo", "tsuji", "linear-dashpot"], fast=2)
def test_a_master_that_steps_side_by_side_has_errors_of_a_percent_at_50_steps(made, law):
    history = fm.simulate(scene(law), accuracy=1e-8)
    with opened(made(history.scene, 3, kind="contact")) as fmu, started(fmu, False, {}) as slave:
        default = slave.get(("input_extrapolation",))["input_extrapolation"]
        restitution, force, _ = coupled(slave, history, 50, "side by side", default)
    assert restitution == pytest.approx(history.summary["coefficient_of_restitution"], abs=0.01)
    assert force == pytest.approx(history.summary["maximum_force"], rel=0.017)


def test_a_ball_between_two_walls_under_an_ordinary_master(made):
    """91 steps a contact, bodies and contacts side by side: force and speed keep to 0.3 % over four contacts."""
    history = fm.simulate(scene("hertz"), accuracy=1e-8)
    on, h = history.scene, history.duration / 91
    width, force = 4.0 * history.summary["maximum_indentation"], history.summary["maximum_force"]
    with (
        opened(made(on, 3, kind="contact")) as fmu,
        started(fmu, False, {"indentation": -0.5 * width}) as left,
        started(fmu, False, {"indentation": -0.5 * width}) as right,
    ):
        x, v, largest, pushes = 0.5 * width, on.approach_velocity, 0.0, [0.0, 0.0]
        for n in range(1200):
            state, a = (x, v), (pushes[1] - pushes[0]) / on.mass
            x, v = moved(x, v, a, h)
            for k, (wall, sign, at) in enumerate(((right, 1.0, width), (left, -1.0, 0.0))):
                wall.set("indentation", sign * (state[0] - at))
                wall.set("relative_velocity", sign * state[1])
                wall.step(n * h, h)
                pushes[k] = wall.get(("contact_force",))["contact_force"]
            largest = max(largest, *pushes)
        contacts = [slave.get(("contact_count",))["contact_count"] for slave in (right, left)]
    assert sum(contacts) >= 4
    assert largest == pytest.approx(force, rel=3e-3)
    assert abs(v) == pytest.approx(on.approach_velocity, rel=3e-3) or max(pushes) > 0.0


CARRIAGE = np.array([[0.0, 1.0], [-2e5 / 0.5, -20.0 / 0.5]])  # 0.5 kg on 2e5 N/m and 20 N s/m


def drop_tower(on, step, count):
    """Largest force, and velocities of ball and carriage after `count` steps: the coupled equations."""
    stiffness = hertz_stiffness(on.effective_modulus, on.effective_radius)

    def rates(t, y):
        force = stiffness * max(y[0] - y[2], 0.0) ** 1.5
        return [y[1], -force / on.mass, *(CARRIAGE @ y[2:] + [0.0, force / 0.5])]

    start, end = [0.0, on.approach_velocity, 0.0, 0.0], count * step
    found = solve_ivp(rates, (0.0, end), start, "DOP853", rtol=1e-11, atol=1e-16, max_step=step / 4).y
    return stiffness * max(found[0] - found[2]) ** 1.5, found[1, -1], found[3, -1]


def carried(step):
    """One step of the carriage, in closed form: a function of its motion and a constant force."""
    forward = expm(CARRIAGE * step)
    pushed = np.linalg.solve(CARRIAGE, (forward - np.eye(2)) @ [0.0, 1.0 / 0.5])
    return lambda motion, force: forward @ motion + pushed * force


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "steps", "errors"),
    [("contact", 50, (0.0045, 0.001)), ("contact", 100, (0.0012, 0.0002)), ("impact", 50, (0.0075, 0.0115))],
)
def test_a_drop_tower_under_an_ordinary_master(made, kind, steps, errors):
    """A ball on a carriage with a spring and a damper, side by side: errors of force and velocities."""
    history = fm.simulate(replace(scene("hertz"), effects=fm.Effects(gravity=False)), accuracy=1e-8)
    on, h, count = history.scene, history.duration / steps, int(1.3 * steps)
    ball, carriage, advance, largest = (0.0, on.approach_velocity), np.zeros(2), carried(h), 0.0
    starts = {"relative_velocity": on.approach_velocity} if kind == "contact" else {}
    with opened(made(on, 2, kind=kind)) as fmu, started(fmu, False, starts) as slave:
        push = slave.get(("contact_force",))["contact_force"]
        for n in range(count):
            x, v = ball
            inputs = {"support_velocity": carriage[1]}
            if kind == "contact":
                inputs = {"indentation": x - carriage[0], "relative_velocity": v - carriage[1]}
            for name, value in inputs.items():
                slave.set(name, float(value))
            ball, carriage = moved(x, v, -push / on.mass, h), advance(carriage, push)
            slave.step(n * h, h)
            push = slave.get(("contact_force",))["contact_force"]
            largest = max(largest, push)
        if kind == "impact":
            found = slave.get(("maximum_force", "impactor_velocity"))
            largest, ball = found["maximum_force"], (0.0, found["impactor_velocity"])
    force, *velocities = drop_tower(on, h, count)
    assert largest == pytest.approx(force, rel=errors[0])
    assert [ball[1], carriage[1]] == pytest.approx(velocities, abs=errors[1] * on.approach_velocity)


@combinations(version=[2, 3], rate=[0.0, -0.1], depth=[0.0, -1e-6])
def test_a_contact_that_never_touches_counts_none(made, version, rate, depth):
    with (
        opened(made(scene("hertz"), version, kind="contact")) as fmu,
        started(fmu, False, {"indentation": depth, "relative_velocity": rate}) as slave,
    ):
        for n in range(5):
            slave.set("indentation", depth - 1e-6 * n)
            slave.set("relative_velocity", -1.0)
            slave.step(n * 1e-6, 1e-6)
        assert slave.get(("contact_count", "phase")) == {"contact_count": 0, "phase": 0}


@combinations(version=[2, 3], fast=2)
def test_a_contact_that_starts_by_moving_in_counts_one(made, version):
    with (
        opened(made(scene("hertz"), version, kind="contact")) as fmu,
        started(fmu, False, {"relative_velocity": 0.1}) as slave,
    ):
        assert slave.get(("contact_count",)) == {"contact_count": 1}


@combinations(law=["hertz", "big-alabo", "tsuji"], target=["half-space", "plate"], fast=3)
def test_energies_and_impulse_of_an_impact_balance(made, law, target):
    on = fmu_wrapper.served(scene(law, target))
    names = ("kinetic_energy", "contact_energy", "target_energy", "external_work", "contact_impulse")
    steps, h = 50, 1.5 * fm.simulate(on).duration / 50
    with opened(made(on)) as fmu, started(fmu, False, {}) as slave:
        first, impulse = slave.get(names), 0.0
        for n in range(steps):
            slave.set("external_force", 20.0 * (n % 3))
            slave.set("support_velocity", 0.01 * (n % 2))
            slave.step(n * h, h)
            impulse += slave.get(("mean_contact_force",))["mean_contact_force"] * h
            now = slave.get((*names, "impactor_velocity", "time_contact_ends"))
            total = now["kinetic_energy"] + now["contact_energy"] + now["target_energy"] - now["external_work"]
            assert total == pytest.approx(first["kinetic_energy"], rel=1e-13)
    assert now["time_contact_ends"] > 0.0 and now["contact_energy"] >= -1e-12 * first["kinetic_energy"]
    assert now["contact_impulse"] == pytest.approx(impulse, rel=1e-12)
    moving = on.mass * (on.approach_velocity - now["impactor_velocity"])
    pushed = sum(20.0 * (n % 3) for n in range(steps)) * h + on.mass * 9.80665 * steps * h
    assert now["contact_impulse"] == pytest.approx(moving + pushed, rel=1e-12)


def test_energies_are_those_of_the_history(made):
    on = fmu_wrapper.served(scene("big-alabo", "plate"))
    history = fm.simulate(on)
    with opened(made(on)) as fmu, started(fmu, True, {}) as slave:
        time = 0.0
        while slave.get(("time_contact_ends",))["time_contact_ends"] == 0.0:
            time, event = slave.step(time, 1e-3)
            if event:
                slave.instance.enterEventMode()
                slave.handle()
        found = slave.get(("contact_energy", "target_energy"))
    assert found["contact_energy"] == pytest.approx(history.summary["energy_absorbed"], rel=1e-10)
    assert found["target_energy"] == pytest.approx(history.summary["energy_radiated"], rel=1e-10)


@pytest.mark.slow
@combinations(law=["hertz", "big-alabo", "stronge", "tsuji"], version=[2, 3], fast=2)
def test_a_contact_follows_the_force_of_an_impact_and_the_check_covers_its_memory(made, law, version):
    """Loading and unloading as in the library's impact; the check adds a second contact in the dent."""
    history = fm.simulate(replace(scene(law), effects=fm.Effects(gravity=False, target_motion=False)), accuracy=1e-9)
    path = made(history.scene, version, kind="contact")
    times = np.linspace(0.0, history.duration, 201)
    motion = history.sample_si(times)
    force = []
    with opened(path) as fmu, started(fmu, False, {"relative_velocity": history.scene.approach_velocity}) as slave:
        for time, x, v in zip(
            times.tolist(), motion.indentation.tolist(), motion.relative_velocity.tolist(), strict=True
        ):
            slave.set("indentation", x)
            slave.set("relative_velocity", v)
            force.append(slave.get(("contact_force",))["contact_force"])
            slave.step(time, float(times[1]))
    off = np.abs(np.array(force) - motion.contact_force).max() / motion.contact_force.max()
    assert off < 1e-6
    report = fmu_wrapper.check(path, history.scene)
    names = [finding.what for finding in report.findings]
    assert report.good and len(names) == 10
    for interface in ("", "Model Exchange, "):
        assert f"contact: {interface}force in reloading in the dent" in names
        assert f"contact: {interface}number of contacts" in names


@combinations(law=["jkr", "dmt"], version=[2, 3], fast=1)
def test_a_contact_of_beads_ends_where_its_law_lets_go(made, law, version):
    """In Model Exchange too: the force of a law that pulls jumps, and events must not be late by what is long here."""
    bead, on = fm.Sphere(radius="50 um", velocity="0.5 m/s", material="alumina"), fm.HalfSpace("float glass")
    beads = fm.Scene(bead, on, fm.Contact(law, work_of_adhesion="0.1 J/m^2"))
    assert fmu_wrapper.check(made(beads, version, kind="contact")).good


def test_the_check_finds_events_that_come_late_in_model_exchange(made, monkeypatch):
    """Handled at the next communication point, the turn is taken for a smaller maximum indentation."""
    monkeypatch.setattr(comparisons, "_first", lambda due, before, after: after)
    report = fmu_wrapper.check(made(scene("big-alabo"), kind="contact"))
    assert {f.what for f in report.findings if not f.good} >= {"contact: Model Exchange, force in unloading"}
    assert all(f.good for f in report.findings if "Model Exchange" not in f.what)
