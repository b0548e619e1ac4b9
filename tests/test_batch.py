"""Batches give the results of single impacts."""

import math
import re
import runpy
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from cases import DAMPED, LAWS, combinations, loads_straight, scene, zener_scene
from scipy.integrate import solve_ivp
from scipy.special import hyp2f1

import film_model as fm
from film_model.core import native, records
from film_model.problem.curve import curve_of
from film_model.solve.history import SUMMARY


@pytest.mark.slow
@combinations(law=LAWS, target=["half-space", "plate", "thin plate", "body"], fast=8)
def test_batch_keeps_its_accuracy_for_every_impact(law, target):
    speeds = np.geomspace(0.12 if target == "body" else 0.02, 1.5, 37)
    batch = fm.simulate_batch(scene(law, target), velocity=[f"{v!r} m/s" for v in speeds.tolist()], accuracy=1e-5)
    assert batch.estimated <= 1e-5
    assert not batch.failed.any()
    for index, speed in enumerate(speeds.tolist()):
        case = scene(law, target, velocity=speed, accuracy=1e-10)
        exact = fm.simulate(case).summary
        for name in SUMMARY:
            if exact[name] is None:
                assert math.isnan(batch.summary[name][index])
                continue
            scale = abs(exact[name])
            if "energy" in name:
                scale = case.kinetic_energy
            if name in ("rebound_velocity", "coefficient_of_restitution"):
                scale = max(scale, 1e-3 * (speed if name == "rebound_velocity" else 1))
            if name == "permanent_indentation":
                scale = max(scale, 1e-3 * exact["maximum_indentation"])
            assert abs(batch.summary[name][index] - exact[name]) <= 1.01e-5 * scale, (name, speed)


def test_masses_and_velocities_broadcast():
    case = scene("big-alabo", "plate")
    speeds, masses = np.array([0.1, 0.2, 0.4]), np.array([[0.03], [0.12]])
    ureg = pytest.importorskip("pint").get_application_registry()
    batch = fm.simulate_batch(case, velocity=speeds * ureg("m/s"), mass=masses * ureg.kg, accuracy=1e-7)
    assert batch.summary["maximum_force"].shape == (2, 3)
    for row, mass in enumerate(masses[:, 0].tolist()):
        for column, speed in enumerate(speeds.tolist()):
            ball = fm.Sphere("10 mm", velocity=f"{speed} m/s", mass=f"{mass} kg", material="WC, Big-Alabo 2017")
            one = fm.simulate(fm.Scene(ball, case.target, contact=case.contact), accuracy=1e-9).summary
            for name in ("maximum_force", "contact_duration", "rebound_velocity", "time_impactor_stops"):
                assert batch.summary[name][row, column] == pytest.approx(one[name], rel=1e-7)


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"velocity": [0.1, 0.2]}, ValueError, "no unit"),
        ({"velocity": ["2 m/s", "0 m/s"]}, ValueError, "^velocity: 0 m/s must be > 0 m/s$"),
        ({"velocity": ["-1 m/s"]}, ValueError, "^velocity: -1 m/s must be > 0 m/s$"),
        ({"velocity": ["1 mm"]}, ValueError, '^velocity: "1 mm" is a length, a velocity is needed'),
        ({"velocity": ["1 m/s"], "mass": [3]}, ValueError, "^mass: 3 has no unit"),
        (
            {"velocity": ["1 m/s", "2 m/s"], "mass": ["1 g"] * 3},
            ValueError,
            r"^velocity has the shape \(2,\), mass \(3,\): shapes that broadcast together are needed$",
        ),
        ({"velocity": []}, ValueError, "^velocity: no values, at least one is needed$"),
        ({"velocity": ["1 m/s"], "mass": ["0 g"]}, ValueError, "^mass: 0 kg must be > 0 kg$"),
        ({"velocity": ["1 kg"]}, ValueError, "a velocity is needed"),
        ({"velocity": ["1 m/s"], "mass": ["1 m"]}, ValueError, "a mass is needed"),
        ({"velocity": ["1 m/s"], "accuracy": 7.0}, fm.SceneError, "accuracy"),
    ],
)
def test_invalid_batch_arguments_are_refused(arguments, error, says):
    with pytest.raises(error, match=says):
        fm.simulate_batch(scene("hertz"), **arguments)


def test_a_ball_slower_than_the_free_body_is_refused():
    with pytest.raises(ValueError, match=r"^velocity: 0\.1 m/s must be > 0\.1 m/s, the target's$"):
        fm.simulate_batch(scene("hertz", "body"), velocity=["1 m/s", "0.1 m/s"])


def starts(nu, gamma):
    start = np.zeros(nu.size, native.START_DTYPE)
    start["nu"], start["gamma"], start["time_limit"] = nu, gamma, math.inf
    return start


@pytest.mark.parametrize("law", list(LAWS))
def test_film_marched_equals_the_recorded_march_on_a_half_space(law):
    """film_marched sums times by arctangents and film_record marches: both on the same segments."""
    curve, mesh = curve_of(LAWS[law]).native, native.mesh(native.WORK_PRESERVING, 7, 9)
    for nu in np.geomspace(0.3, 60.0, 23).tolist():
        start = native.Start(nu, 0.0, 0.0, 0.0, math.inf)
        status, summary = native.marched(curve, mesh, start)
        marched, _, states, _ = native.record(curve, mesh, native.initial_state(curve, start), math.inf, 400)
        if status == native.BEYOND_LAW:
            assert marched == native.BEYOND_LAW
            continue
        assert status == marched == native.EVENT
        last = states[-1]
        assert summary.contact_duration == pytest.approx(last["time"], rel=1e-12)
        assert summary.final_velocity == pytest.approx(last["nu"], rel=1e-12)
        assert summary.maximum_indentation == pytest.approx(last["xi_max"], rel=1e-12)
        assert summary.maximum_force == pytest.approx(last["force_peak"], rel=1e-12)


@pytest.mark.parametrize("load", [0.0, 0.4])
@pytest.mark.parametrize("law", ["hertz", "big-alabo", "jkr", "dmt", "thornton-ning"])
def test_film_marched_equals_the_recorded_march_under_a_load_and_of_laws_that_pull(law, load):
    """The energy at nodes counts the load and the pull; what does not leave, or on its weight alone, is marched."""
    law = PULLING[law] if law in PULLING else LAWS[law]
    curve, mesh, ends = curve_of(law).native, native.mesh(native.WORK_PRESERVING, 7, 9), set()
    for nu in np.geomspace(0.3, 40.0, 23).tolist():
        start = native.Start(nu, 0.0, load, 0.0, 400.0)
        status, summary = native.marched(curve, mesh, start)
        marched, _, states, _ = native.record(curve, mesh, native.initial_state(curve, start), 400.0, 4000)
        assert status == marched
        ends.add(status)
        if status != native.EVENT:
            continue
        last = states[-1]
        assert summary.contact_duration == pytest.approx(last["time"], rel=1e-11)
        assert summary.final_velocity == pytest.approx(last["nu"], rel=1e-11)
        assert summary.maximum_indentation == pytest.approx(last["xi_max"], rel=1e-12)
        assert summary.maximum_force == pytest.approx(last["force_peak"], rel=1e-12)
        assert summary.work == pytest.approx(last["spent"], rel=1e-11, abs=1e-12 * nu**2)
        assert summary.permanent_indentation == pytest.approx(last["xi"], rel=1e-11, abs=1e-13 * last["xi_max"])
    assert ends == ({native.EVENT, native.OK} if law.name in ("jkr", "thornton-ning") else {native.EVENT})


PULLING = {
    "jkr": fm.Jkr(2e9, 50e-6, 0.05),
    "dmt": fm.Dmt(2e9, 50e-6, 0.05),
    "thornton-ning": fm.ThorntonNing(2e9, 50e-6, 0.05, 40e6),
}


STRAIGHT = tuple(name for name, law in LAWS.items() if loads_straight(law))  # exact with any segments
LEFT_TO_THE_MARCH = ("yigit-christoforou", "tabulated")  # unloading may never end; the table ends before most turns


VALUES = ("maximum_force", "maximum_indentation", "time_of_maximum_indentation", "time_impactor_stops")
VALUES += ("contact_duration", "final_velocity", "permanent_indentation", "work")
TIMES = ("time_of_maximum_indentation", "time_impactor_stops", "contact_duration")


def alone(curve, mesh, start, by=native.marched):
    """Status and summary of each start, by the march or by `native.impact`."""
    found = [by(curve, mesh, native.Start(*row.tolist())) for row in start]
    rows = [tuple(getattr(summary, name) for name in native.SUMMARY_DTYPE.names) for _, summary in found]
    return np.array([status for status, _ in found]), np.array(rows, native.SUMMARY_DTYPE)


def differences(a, b, start):
    """Largest relative difference of each of VALUES; final velocities are relative to at least 1 % of the first one."""
    scales = {name: np.abs(b[name]) for name in VALUES}
    scales["final_velocity"] = np.maximum(scales["final_velocity"], 0.01 * start["nu"])
    scales["permanent_indentation"], scales["work"] = b["maximum_indentation"], start["nu"] ** 2
    return np.array([np.max(np.abs(a[name] - b[name]) / scales[name]) for name in VALUES])


@pytest.mark.parametrize("law", [name for name in LAWS if name != "yigit-christoforou"])  # is left to the march
def test_quadrature_on_a_half_space_converges_to_the_march(law):
    """Error over segments, against 500 lines a leg: geometric until rounding, of rows and of one impact. All but times
    need no quadrature."""
    rng = np.random.default_rng(3)
    start = starts(np.exp(rng.uniform(-1.5, 3, 40)), 0.0)
    curve = curve_of(LAWS[law]).native
    expected, one = alone(curve, native.mesh(native.WORK_PRESERVING, 500, 500), start)
    done = expected == native.EVENT
    assert done.mean() > (0.2 if law == "tabulated" else 0.9)  # most turns are beyond the table
    for segments, error in ((1, 2e-3), (2, 4e-4), (4, 2e-5), (8, 4e-7), (16, 2e-9), (40, 1e-11), (400, 1e-11)):
        mesh = native.mesh(native.WORK_PRESERVING, segments, segments)
        for status, found in (native.batch(curve, mesh, start), alone(curve, mesh, start, native.impact)):
            off = differences(found[done], one[done], start[done])
            assert np.array_equal(status, expected)
            assert np.array_equal(found["stage"][done], one["stage"][done])
            assert off.max() <= error, segments
            assert off[[name not in TIMES for name in VALUES]].max() <= 1e-14


@dataclass(frozen=True)
class Own(fm.AbstractLaw):
    """One reversible stage."""

    force: fm.Power | Callable
    end: float
    name: ClassVar[str] = "own"

    def scales(self, energy):
        return 1.0, 1.0

    def stages(self):
        return (fm.Stage("own", 0.0, self.end, self.force, root=True),)


@pytest.mark.parametrize("terms", [(0.0, 1.0, 0.0), (0.3, 0.5, 0.0), (0.0, 1.0, 1.0), (0.4, 0.3, 0.2)])
@pytest.mark.parametrize("gamma", [0.0, 0.4])
def test_a_power_with_a_square_equals_its_series(terms, gamma):
    """Alone and in series with a spring, in rows and along lines."""
    slope, square, coefficient = terms
    power = fm.Power(slope=slope, coefficient=coefficient, square=square)
    start, mesh = starts(np.geomspace(0.01, 5.0, 40), gamma), native.mesh(native.WORK_PRESERVING, 80, 80)
    for compliance in (0.0, 0.7):
        exact, fitted = (curve_of(law, compliance).native for law in (Own(power, math.inf), Own(power.at, 20.0)))
        assert exact.piece[0].force.form == native.POWER != fitted.piece[0].force.form
        for function in (native.impact, native.marched):
            (status, found), (expected, truth) = (alone(curve, mesh, start, function) for curve in (exact, fitted))
            assert (status == native.EVENT).all() and (expected == native.EVENT).all()
            assert differences(found, truth, start).max() < 1e-8
        status, rows = native.batch(exact, mesh, start)
        assert differences(rows, alone(exact, mesh, start, native.impact)[1], start).max() < 1e-12


def test_an_elastic_stage_on_a_half_space_needs_no_quadrature():
    """Thornton's law: behind the elastic stage it is linear, and the time to the turn an arctangent. Rows
    and one impact have the same bits."""
    curve = curve_of(fm.Thornton(1e11, 0.01, 1e9)).native
    end = curve.stage[0].end
    force, work = native.stage_law(curve, 0, end)
    slope = (native.stage_law(curve, 1, 2.0 * end)[0] - force) / end
    margin = np.random.default_rng(2).uniform(0.01, 0.999, 40)
    nu = np.sqrt(2.0 * work / (1.0 - margin**2))
    expected = end / nu * hyp2f1(0.5, 0.4, 1.4, 1.0 - margin**2)
    expected += np.arctan(margin * nu * math.sqrt(slope) / force) / math.sqrt(slope)
    mesh, start = native.mesh(native.WORK_PRESERVING, 40, 40), starts(nu, 0.0)
    _, batch = native.batch(curve, mesh, start)
    assert batch["time_of_maximum_indentation"] == pytest.approx(expected, rel=3e-15)
    assert alone(curve, mesh, start, native.impact)[1].tobytes() == batch.tobytes()


def test_points_of_gauss_rule():
    """The numbers in film_gauss.c: one point of each pair, for 1 to 16 points."""
    text = (Path(native.__file__).parent / "tables/film_gauss.c").read_text(encoding="utf-8")
    pairs = re.findall(r"\{([\d.e-]+), ([\d.e-]+)\}", text)
    points = [np.polynomial.legendre.leggauss(count) for count in range(1, 17)]
    halves = [(0.5 * (1.0 + x), 0.5 * w) for at, weight in points for x, w in zip(at, weight, strict=True) if x < 1e-9]
    np.testing.assert_allclose(np.array(pairs, float), halves, rtol=2e-14)  # numpy errs by 1e-14


@pytest.mark.slow
@pytest.mark.parametrize("law", [name for name in LAWS if name not in (*STRAIGHT, *LEFT_TO_THE_MARCH)])
def test_batch_kernel_is_as_accurate_as_the_march_on_moving_targets(law):
    """The batch kernel aims its nodes at its own estimate of the turn, does not split the segment on which the impactor
    stops, and takes ways of exponent 3/2 from tables: it differs from the march, but by less than its error."""
    rng = np.random.default_rng(4)
    curve = curve_of(LAWS[law]).native
    start = starts(np.exp(rng.uniform(-1.5, 3, 150)), np.exp(rng.uniform(-4, 0.3, 150)))
    _, truth = alone(curve, native.mesh(native.WORK_PRESERVING, 320, 640), start)
    for n in (20, 40, 80):
        mesh = native.mesh(native.WORK_PRESERVING, n, n)
        status, batch = native.batch(curve, mesh, start)
        expected, one = alone(curve, mesh, start)
        assert np.array_equal(status, expected)
        done = status == native.EVENT
        in_lanes = batch["lines"] % n == 0  # the march splits the segment on which the impactor stops
        assert in_lanes[done].mean() > 0.98
        error = differences(one[done], truth[done], start[done]) + 1e-12
        assert (differences(batch[done], truth[done], start[done]) <= 1.5 * error).all()
        assert (differences(batch[done], one[done], start[done]) <= 1.1 * error).all()


@pytest.mark.slow
@combinations(law=["hertz", "meyer", "big-alabo", "stronge", "jackson-green"], load=[0.001, 0.02], fast=4)
def test_contacts_under_a_load_in_lanes_converge_to_the_march(law, load):
    """With the order of lines; the slowest, which the load nearly turns back, have up to 10 times the march's error."""
    rng = np.random.default_rng(4)
    curve = curve_of(LAWS[law]).native
    start = starts(np.exp(rng.uniform(-1.5, 3, 150)), np.exp(rng.uniform(-4, 0.3, 150)))
    start["load"], start["time_limit"] = load * start["nu"], 1e4
    _, truth = alone(curve, native.mesh(native.WORK_PRESERVING, 320, 640), start)
    for n in (20, 40, 80):
        mesh = native.mesh(native.WORK_PRESERVING, n, n)
        status, batch = native.batch(curve, mesh, start)
        expected, one = alone(curve, mesh, start)
        assert np.array_equal(status, expected)
        done = status == native.EVENT
        assert (batch["maximum_force"] != one["maximum_force"])[done].mean() > 0.9  # those of the march are equal
        error = differences(one[done], truth[done], start[done]) + 1e-12
        apart = differences(batch[done], truth[done], start[done])
        assert (apart <= 12.0 * error).all() and np.median(apart / error) < 2.0


@pytest.mark.slow
def test_ways_of_exponent_three_halves_come_from_exact_tables():
    """Against the Taylor series that the tables are made of, at random numbers; on both sides of the end of a table."""
    tables = runpy.run_path(str(Path(__file__).parents[1] / "examples" / "map_tables.py"))
    rng = np.random.default_rng(9)
    gamma = np.concatenate([np.exp(rng.uniform(math.log(1e-6), math.log(30), 60)), [12.2, 12.3, 24.0, 27.0]])
    curve, start = curve_of(LAWS["hertz"]).native, starts(np.ones(gamma.size), gamma)
    status, found = native.batch(curve, native.mesh(native.WORK_PRESERVING, 60, 120), start)
    assert (status == native.EVENT).all()
    deep = 1.25**0.4
    depth, turned = tables["way_in"](gamma * deep**1.5).astype(float) * deep
    slowness = gamma * np.sqrt(np.sqrt(depth))
    duration, speed, stops = tables["way_out"](slowness).astype(float)
    clock = depth**-0.25
    expected = {
        "maximum_indentation": depth,
        "maximum_force": depth**1.5,
        "time_of_maximum_indentation": turned,
        "contact_duration": turned + clock * duration,
        "time_impactor_stops": turned + clock * stops,
        "final_velocity": -(depth**1.25) * speed,
    }
    assert np.array_equal(found["lines"] > 0, (slowness >= 15.0) | (gamma * deep**1.5 >= 15.0))
    for name, values in expected.items():
        error = np.abs(found[name] / values - 1.0)
        assert error[found["lines"] == 0].max() < 2e-14, name
        assert error.max() < 1e-5, name
    assert np.array_equal(found["shift"], gamma * (1.0 - found["final_velocity"]))  # momentum


def test_a_power_law_beyond_yield_needs_lines_up_to_it_only():
    """Big-Alabo's law on plates against an integrator: the error is that of the lines across the elastic stage."""
    rng = np.random.default_rng(12)
    nu = np.append(np.exp(rng.uniform(math.log(1.8), math.log(30.0), 12)), 1.5)
    start = starts(nu, rng.uniform(0.02, 0.6, nu.size))
    law = fm.BigAlabo(1e11, 0.01, 1e9)
    exact = [turn_beyond_yield(*numbers) for numbers in zip(nu.tolist(), start["gamma"].tolist(), strict=True)]
    for segments, error in ((3, 8e-5), (4, 3e-5), (6, 6e-6), (13, 3e-7)):
        mesh = native.mesh(native.WORK_PRESERVING, segments, 40)
        status, found = native.batch(curve_of(law).native, mesh, start)
        assert (status == native.EVENT).all()
        assert (found["lines"] == segments).all()
        for name, values in zip(("maximum_indentation", "time_of_maximum_indentation"), np.array(exact).T, strict=True):
            assert np.abs(found[name] / values - 1.0).max() < error, name


def turn_beyond_yield(nu, gamma):
    """Depth and time of the turn under x^{3/2} up to 1 and 1 + (x − 1)^{3/2} beyond, by an integrator."""

    def rates(constant):
        def of(s, at):  # x = z², dt = z ds
            z, speed, _ = at
            force = constant + z**3
            return 0.5 * (speed - gamma * force), -force * z, z

        return of

    begin = [0.0, nu, 0.0]
    for constant, ends in ((0.0, lambda s, at: at[0] - 1.0), (1.0, lambda s, at: at[1] - gamma * (1.0 + at[0] ** 3))):
        ends.terminal = True
        way = solve_ivp(rates(constant), (0.0, 10.0), begin, "DOP853", events=ends, rtol=3e-14, atol=1e-15)
        z, speed, time = way.y_events[0][0]
        begin = [0.0, speed, time]
    return 1.0 + z * z, time


@pytest.mark.parametrize(("segments", "error"), [(7, 1e-4), (20, 1e-6)])
def test_slow_contacts_use_more_unloading_segments_for_the_same_error(segments, error):
    gamma = np.geomspace(0.05, 3, 60)
    curve, start = curve_of(fm.Meyer(stiffness=1e10, exponent=1.49)).native, starts(np.ones(60), gamma)
    _, truth = native.batch(curve, native.mesh(native.WORK_PRESERVING, 60, 500), start)
    _, batch = native.batch(curve, native.mesh(native.WORK_PRESERVING, 60, segments), start)
    _, one = alone(curve, native.mesh(native.WORK_PRESERVING, 60, segments), start)
    slow = gamma * np.sqrt(truth["maximum_force"] / truth["maximum_indentation"]) >= 1.1
    assert 0.2 < slow.mean() < 0.5
    assert np.array_equal(batch["lines"], 60 + np.where(slow, 2, 1) * segments)
    for found in (batch, one):
        assert differences(found, truth, start).max() < error
    start = starts(np.ones(9), np.array([6.0]))
    _, creeping = native.batch(curve, native.mesh(native.WORK_PRESERVING, 60, segments), start)
    assert (creeping["lines"] == 60 + 4 * segments).all()


@pytest.mark.parametrize("law", list(LAWS))
def test_every_instruction_set_gives_the_same_bytes(law):
    rng = np.random.default_rng(6)
    curve, mesh = curve_of(LAWS[law]).native, native.mesh(native.WORK_PRESERVING, 7, 19)
    start = starts(np.exp(rng.uniform(-1.5, 4, 500)), np.exp(rng.uniform(-4, 3, 500)))
    start["gamma"][::3] = 0.0
    status, expected = native.batch(curve, mesh, start, 0)
    for using in range(1, native.instructions() + 1):
        again, summary = native.batch(curve, mesh, start, using)
        assert np.array_equal(again, status)
        done = status == native.EVENT
        assert summary[done].tobytes() == expected[done].tobytes(), native.INSTRUCTIONS[using]


@pytest.mark.parametrize("law", list(LAWS))
def test_an_impact_is_independent_of_the_others_in_its_batch(law):
    rng = np.random.default_rng(5)
    curve, mesh = curve_of(LAWS[law]).native, native.mesh(native.WORK_PRESERVING, 9, 21)
    start = starts(np.exp(rng.uniform(-1.5, 3, 101)), np.exp(rng.uniform(-4, 1.2, 101)))
    start["gamma"][::3] = 0.0
    _, whole = native.batch(curve, mesh, start)
    order = rng.permutation(start.size)
    _, shuffled = native.batch(curve, mesh, start[order])
    single = np.concatenate([native.batch(curve, mesh, start[k : k + 1])[1] for k in range(start.size)])
    for name in native.SUMMARY:
        assert np.array_equal(whole[name][order], shuffled[name], equal_nan=True), name
        assert np.array_equal(whole[name], single[name], equal_nan=True), name


def test_threads_give_the_same_bytes():
    curve, mesh = curve_of(LAWS["hertz"]).native, native.mesh(native.WORK_PRESERVING, 12, 24)
    start = starts(np.geomspace(0.5, 2, 500), np.geomspace(0.01, 3, 500))
    expected = native.batch(curve, mesh, start)[1]
    found = []
    threads = [threading.Thread(target=lambda: found.append(native.batch(curve, mesh, start)[1])) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    for name in native.SUMMARY:
        assert all(np.array_equal(one[name], expected[name], equal_nan=True) for one in found)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"velocity": ["1 m/s", "30 km/s"]}, "velocity: 30000 m/s is out of range: from 1e-100 to 20000 m/s"),
        ({"velocity": ["1e-120 m/s", "1 m/s"]}, "velocity: 1e-120 m/s is out of range"),
        ({"velocity": "1 m/s", "mass": ["1 g", "1e-30 g"]}, "mass: 1e-33 kg is out of range: from 1e-28 to 1e.12 kg"),
    ],
)
def test_batches_check_the_ranges_of_scenes(given, said):
    with pytest.raises(ValueError, match=said):
        fm.simulate_batch(zener_scene(0.5), **given)


def test_segments_can_be_given():
    batch = fm.simulate_batch(scene("stronge", "plate"), velocity=["1 m/s", "2 m/s"], segments=10)
    assert batch.segments == (10, 10)
    assert 1e-7 < batch.estimated < 1e-3


@pytest.mark.parametrize("room", [40, 65, 1 << 14])
def test_contacts_recorded_together_have_the_lines_of_each_alone(monkeypatch, room):
    """Also where those of a contact, or its last, do not fit beside those before, or at all; a failed one has none."""
    monkeypatch.setattr(records, "LINES", room)
    curve, mesh = curve_of(fm.Stronge(100e9, 0.01, 1e9)).native, native.mesh(native.WORK_PRESERVING, 10, 20)
    start = np.zeros(7, native.START_DTYPE)
    start["nu"], start["gamma"], start["time_limit"] = [0.1, 0.4, math.nan, 1.0, 3.0, 10.0, 0.2], 0.1, math.inf
    columns, counts = records.record_many(curve, mesh, start)
    ends = np.cumsum(counts)
    assert counts[2] == 0 and counts[5] > 40 > counts[0]
    for row, end in enumerate(ends.tolist()):
        begin = native.Start(*start[row].tolist())
        alone = [] if row == 2 else native.record(curve, mesh, native.initial_state(curve, begin), math.inf, 500)[1]
        assert len(alone) == counts[row]
        for name, column in columns.items():
            assert column[end - counts[row] : end].tobytes() == np.asarray(alone, native.LINE_DTYPE)[name].tobytes()


@pytest.mark.parametrize("instructions", range(native.instructions() + 1))
def test_samples_of_many_contacts_are_those_of_each_to_the_last_bit(monkeypatch, instructions):
    """For every law, on targets that move and in series with a spring; none of one that failed or has no times."""
    monkeypatch.setattr(native, "instructions", lambda: instructions)
    start = np.zeros(6, native.START_DTYPE)
    start["nu"], start["gamma"] = [0.3, 1.3, math.nan, 0.3, 1.3, 1.3], [0.0, 0.0, 0.1, 0.5, 3.0, 0.1]
    start["load"], start["damping"], start["time_limit"] = [0.0, 0.01, 0.0, 0.0, 0.0, 0.0], 0.2, 40.0
    times = np.linspace(0.0, [7.0, 7.0, 7.0, 7.0, 30.0, math.nan], 45, axis=1)
    mesh = native.mesh(native.WORK_PRESERVING, 4, 6)
    for law, spring in [(LAWS["hertz"], 0.3), *((law, 0.0) for law in LAWS.values())]:
        curve = curve_of(law, spring).native
        for part, lines in records.recorded(curve, mesh, start):
            values, ends = records.sample_many(curve, lines, times[part]), np.cumsum(lines.counts)
            assert part == slice(0, 6)
            assert np.isnan(values[:, [2, 5]]).all()
            for row in (row for row in (0, 1, 3, 4) if lines.counts[row]):
                own = lines.table[ends[row] - lines.counts[row] : ends[row]]
                each = native.sample(curve, own, times[row])[0]
                assert values[:, row].tobytes() == each.T.tobytes(), (law.name, row)


@pytest.mark.slow
@pytest.mark.parametrize("load", [0.0, 0.01])
@pytest.mark.parametrize("law", DAMPED)
def test_damped_contacts_in_lanes_agree_with_the_march(law, load):
    """Over damping and target motion; errors fall fast with the segments."""
    damping, gamma = (axis.ravel() for axis in np.meshgrid(np.geomspace(0.01, 2.0, 6), [0.0, 0.05, 0.3, 1.0]))
    start = starts(np.full(damping.size, 1.4), gamma)
    start["damping"], start["load"], start["time_limit"] = damping, load, 1e3
    if law == "damped-large-slope":  # whose dashpot is the strongest so deep: the whole load keeps a contact closed
        start["load"] *= 0.1
    curve = curve_of(LAWS[law]).native
    _, truth = alone(curve, native.mesh(native.WORK_PRESERVING, 600, 600), start)
    meshes = [native.mesh(native.WORK_PRESERVING, n, n) for n in (5, 10, 20)]
    coarse, middle, fine = (native.batch(curve, mesh, start)[1] for mesh in meshes)
    assert (native.batch(curve, meshes[0], start)[0] == native.EVENT).all()
    assert differences(middle, truth, start).max() < 1e-5
    assert differences(fine, truth, start).max() < 5e-8
    assert (differences(middle, fine, start) <= 0.1 * differences(coarse, fine, start) + 1e-11).all()


def test_a_linear_dashpot_is_exact_in_a_batch():
    """Lines of the march are exact under a linear law; the lanes' polynomials leave rounding, on any mesh."""
    damping, gamma = (axis.ravel() for axis in np.meshgrid(np.geomspace(0.01, 5.0, 6), [0.0, 0.1, 0.9]))
    start = starts(np.full(damping.size, 0.7), gamma)
    start["damping"] = damping
    curve = curve_of(LAWS["linear-dashpot"]).native
    _, truth = alone(curve, native.mesh(native.WORK_PRESERVING, 30, 30), start)  # radiated energy by quadrature
    for n in (1, 4, 20):
        _, found = native.batch(curve, native.mesh(native.WORK_PRESERVING, n, n), start)
        assert (found["lines"] > 0).all() and differences(found, truth, start)[1:].max() < 1e-12
        assert differences(found, truth, start)[0] < 1e-10  # the march's largest force is sought to 1e-6 of the way
