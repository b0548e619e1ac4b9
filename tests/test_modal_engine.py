"""The core's contact on modes: numbers of independent solutions, order, energy, memory, and what it refuses."""

import itertools
import math
import runpy
import threading
from pathlib import Path

import numpy as np
import pytest
from cases import LAWS, combinations

import film_model as fm
from film_model.base import units
from film_model.core import modal, native, refining
from film_model.effects.choose import problem_of
from film_model.problem.curve import curve_of
from film_model.problem.summary import differences
from film_model.solve import structures, vibration
from film_model.studies import modal_reference
from film_model.targets import Modes, ritz

SCENES = Path(__file__).parent.parent / "examples" / "scenes"
OLSSON = fm.Scene.from_toml(SCENES / "olsson_plate.toml")
BAR = fm.Material("Timoshenko's steel", "215.7 GPa", 0.3, "7960 kg/m^3")
STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
ALUMINIUM = fm.Material("aluminium", "70 GPa", 0.33, "2700 kg/m^3")
HINGED = "simply supported", "simply supported"
QUIET = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)


def bar(length):
    """One of Timoshenko's bars, by Euler and Bernoulli's theory."""
    return fm.Beam(BAR, length, "10 mm", "10 mm", theory="euler-bernoulli")


def struck(target, radius, velocity, law="hertz", mass=None, material=STEEL):
    ball = fm.Sphere(radius, velocity, material=material, mass=mass)
    return fm.Scene(ball, target, fm.Contact(law), QUIET)


# ---------------------------------------------------------------- numbers of an independent modal code

PUBLISHED = [  # scene, maximum force [N], rebound velocity [m/s], contacts
    (struck(bar("153.5 mm"), "10 mm", "0.01 m/s", material=BAR), 4.97714, -0.00302324, 1),
    (struck(bar("307 mm"), "20 mm", "0.01 m/s", material=BAR), 10.298, -0.00971258, 3),
    (
        struck(
            fm.Plate(STEEL, "4 mm", size=["150 mm", "200 mm"], position=["40 mm", "130 mm"], theory="kirchhoff"),
            "8 mm",
            "2 m/s",
        ),
        1468.22,
        -0.619125,
        1,
    ),
]


@pytest.mark.parametrize(("scene", "force", "velocity", "contacts"), PUBLISHED)
def test_numbers_of_an_independent_code(scene, force, velocity, contacts):
    """Timoshenko's beams by Euler and Bernoulli's theory, and a plate struck off its centre."""
    history = fm.simulate(scene, accuracy=1e-4)
    assert history.summary["maximum_force"] == pytest.approx(force, rel=2e-4)
    assert history.summary["rebound_velocity"] == pytest.approx(velocity, rel=2e-5)
    assert history.vibration.contacts == contacts


def test_the_papers_plate_to_six_digits():
    history = fm.simulate(OLSSON, accuracy=1e-5)
    summary, events = history.summary, {event.name: event.time for event in reversed(history.events)}
    assert summary["maximum_force"] == pytest.approx(331.764, abs=1e-3)
    assert summary["maximum_indentation"] == pytest.approx(46.906e-6, rel=1e-5)
    assert events["maximum_indentation"] == pytest.approx(34.833e-6, rel=2e-5)
    assert events["contact_ends"] == pytest.approx(195.265e-6, rel=1e-5)


@pytest.mark.slow
def test_the_flat_maximum_takes_no_more_modes(monkeypatch):
    """At 1e-6 the time of the maximum alone would take twice as many. It is within 1e-5, all else within 1e-6, of a run
    on 12,000 modes with short steps; the last run is recorded at once."""
    runs = []

    def counted(problem, structure, tolerance, limit, recorded=True, expected=0):
        runs.append(recorded)
        return run(problem, structure, tolerance, limit, recorded, expected)

    run = vibration.run
    monkeypatch.setattr(vibration, "run", counted)
    history = fm.simulate(OLSSON, accuracy=1e-6)
    assert history.vibration.modes < 6000 and history.accuracy.estimated <= 1e-6
    assert runs[-1] and sum(runs) <= 2
    highest = 2.0**0.5 * history.vibration.highest
    structure = structures.structure_of(OLSSON.target, highest, history.problem.scales.time)
    exact = run(history.problem, structure, 1e-12, 1.0).summary
    errors = differences(history.problem, history.vibration.summary, exact)
    assert max(errors.values()) < 1e-6
    late = replace_time(exact, 1.001)
    assert differences(history.problem, late, exact)["time_of_maximum_indentation"] == pytest.approx(1e-4, rel=1e-9)


def replace_time(summary, factor):
    """The summary with another time of the largest indentation."""
    found = native.Summary.from_buffer_copy(summary)
    found.time_of_maximum_indentation *= factor
    return found


def test_a_damped_impact_converges_where_there_are_no_more_vibrations(monkeypatch):
    """A thin glass plate: all vibrations of Mindlin's theory are there from the second run on. Without damping of the
    omitted mode errors of the rebound stay above 4e-3, however stiff it is."""
    target = fm.Plate(fm.Material("glass", "70 GPa", 0.23, "2500 kg/m^3"), "0.65 mm", size=["200 mm", "150 mm"])
    ball, law = fm.Sphere("3 mm", "0.5 m/s", material=STEEL), fm.Contact("tsuji", restitution=0.9)
    runs, run = [], vibration.run

    def counted(*given, **named):
        runs.append(run(*given, **named))
        return runs[-1]

    monkeypatch.setattr(vibration, "run", counted)
    history = fm.simulate(fm.Scene(ball, target, law, QUIET))
    assert [each.modes for each in runs] == [1455, 1856, 1856, 1856]
    assert history.accuracy.estimated <= 1e-4 and not any("is not reached" in said for said in history.warnings)
    stiffer = structures.structure_of(target, 4.0 * history.vibration.highest, history.problem.scales.time)
    exact = run(history.problem, stiffer, 1e-8, 1.0, False).summary
    assert max(differences(history.problem, history.vibration.summary, exact).values()) < history.accuracy.estimated


def test_the_largest_force_of_a_damped_contact_is_the_steps_own():
    """On a glass plate with a stiff mode for the omitted ones: by the law at the interpolated rate it was 2e-4 off."""
    ball, law = fm.Sphere("5 mm", "0.5 m/s", material=STEEL), fm.Contact("tsuji", restitution=0.9)
    target = fm.Plate(fm.Material("glass", "70 GPa", 0.23, "2500 kg/m^3"), "0.65 mm", size=["200 mm", "150 mm"])
    problem = problem_of(fm.Scene(ball, target, law, QUIET))
    structure = structures.structure_of(target, 3.7e7, problem.scales.time)
    forces = [vibration.run(problem, structure, step, 1.0, False).summary.maximum_force for step in (3.3e-7, 1e-8)]
    assert forces[0] == pytest.approx(forces[1], rel=5e-5)


def test_a_flat_maximum_is_timed_by_all_modes():
    """High modes move within a step otherwise than its interpolation: that alone put the time 1.4e-6 off."""
    problem = problem_of(OLSSON)
    structure = structures.structure_of(OLSSON.target, 3.1e7, problem.scales.time)
    times = [vibration.run(problem, structure, step, 1.0, False).summary for step in (3e-8, 1e-11)]
    assert differences(problem, *times)["time_of_maximum_indentation"] < 2e-8


def test_an_impact_on_many_modes_is_not_followed_again_for_its_record(monkeypatch):
    """The accuracy turns out to be out of reach after a run that was not expected to be the last."""
    target = fm.Plate(fm.Material("glass", "70 GPa", 0.23, "2500 kg/m^3"), "0.65 mm", size=["200 mm", "150 mm"])
    ball, effects = fm.Sphere("2 mm", "0.3 m/s", material="bearing steel"), fm.Effects(boundary_reflections=True)
    scene = fm.Scene(ball, target, fm.Contact("tsuji", restitution=0.8), effects)
    calls, run, impact = [], vibration.run, modal.impact
    monkeypatch.setattr(vibration, "run", lambda *given, **named: (calls.append("run"), run(*given, **named))[1])
    monkeypatch.setattr(modal, "impact", lambda *given: (calls.append("impact"), impact(*given))[1])
    history = fm.simulate(scene)
    assert history.accuracy.estimated > 1e-4 and history.vibration.met.size and history.vibration.modes > 400
    assert calls.count("impact") == calls.count("run")


def test_runs_end_where_frequencies_are_left_out_and_the_third_run_fails():
    """The run with a quarter of the highest frequency is then above the first."""
    plan = refining.Refinement(native.Start(nu=1.0), 1.0, 1.0, 1.0, 1e-3, math.inf, modal.MOST_WORK)
    plan.skips, asked = 1, []
    plan.begin(1.0)
    while plan.ask != refining.ENOUGH and len(asked) < 20:
        asked.append((plan.ask, plan.highest))
        fails = plan.ask == refining.RUN and plan.highest > 16.0
        taken = refining.Run(modes=int(10.0 * plan.highest), shares=1e3 if plan.highest < 10.0 else 0.0)
        taken.core.maximum_force = taken.core.maximum_indentation = 1.0
        plan.take(refining.Run(status=native.TOO_MANY) if fails else taken)
    shares = [(refining.SHARES, highest) for highest in (2.0, 4.0, 8.0, 16.0)]
    assert asked == [(refining.RUN, 1.0), *shares, *((refining.RUN, highest) for highest in (16.0, 32.0, 4.0))]
    assert plan.highest == 16.0 and plan.below == 1.0


# ---------------------------------------------------------------- one set of modes

FEW = fm.Plate(ALUMINIUM, "4 mm", size=["150 mm", "100 mm"], position=["60 mm", "40 mm"])


def on_few(law, tolerance, mass="0.2 kg", velocity="1 m/s", highest=1e5):
    """The impact on the modes below `highest`, and its problem."""
    problem = problem_of(struck(FEW, "12 mm", velocity, law, mass))
    structure = structures.structure_of(FEW, highest, problem.scales.time)
    return vibration.run(problem, structure, tolerance, 1.0), problem


@pytest.mark.parametrize("law", ["hertz", "tsuji"])
def test_a_time_limit_within_a_step_counts_the_work_and_the_force_up_to_it(law):
    problem = problem_of(struck(FEW, "12 mm", "1 m/s", LAWS[law], "0.2 kg"))
    structure = structures.structure_of(FEW, 1e5, problem.scales.time)
    for limit in np.linspace(0.05, 0.2, 7) * vibration.run(problem, structure, 1e-8, 1.0).summary.contact_duration:
        ends = [vibration.run(problem, structure, each, limit * problem.scales.time) for each in (1e-8, 1e-10)]
        assert all(end.outcome is fm.Outcome.TIME_LIMIT for end in ends)
        assert ends[0].summary.work == pytest.approx(ends[1].summary.work, rel=1e-6)
        assert ends[0].summary.maximum_force == pytest.approx(ends[1].summary.maximum_force, rel=1e-6)


def test_a_run_without_a_record_is_the_same():
    recorded, problem = on_few("hertz", 1e-7)
    structure = structures.structure_of(FEW, 1e5, problem.scales.time)
    bare = vibration.run(problem, structure, 1e-7, 1.0, recorded=False)
    assert bytes(bare.summary) == bytes(recorded.summary) and bare.contacts == recorded.contacts
    assert np.array_equal(bare.energies, recorded.energies)
    assert len(bare.segments) == len(bare.met) == 0 < len(recorded.segments)


@pytest.mark.slow
@combinations(law=[name for name, law in LAWS.items() if not law.damped and "printed" not in name], fast=2)
def test_against_dop853(law):
    found, problem = on_few(LAWS[law], 1e-8)
    structure = structures.structure_of(FEW, 1e5, problem.scales.time)
    tables, unit = structure.tables, problem.scales.time
    rest = structure.omitted * problem.scales.force / problem.scales.length
    frequency, share = tables.frequency * unit, tables.share * problem.mass
    other = modal_reference.integrate(problem, frequency, share, rest, 1.0, 1.0 / unit, 1e-11)
    assert found.event_names == [event.name for event in other.events]
    for name in ("maximum_force", "maximum_indentation", "contact_duration", "permanent_indentation", "final_velocity"):
        assert getattr(found.summary, name) == pytest.approx(getattr(other.summary, name), rel=2e-6, abs=1e-9), name
    assert found.energy == pytest.approx(other.energy, rel=1e-6)


@pytest.mark.parametrize(("mass", "velocity"), [("0.02 kg", "3 m/s"), ("2 kg", "0.3 m/s")])
def test_energy_of_a_reversible_law(mass, velocity):
    """Impactor and modes keep the energy, to 1e-9, over one contact or several."""
    found, problem = on_few("hertz", 1e-10, mass, velocity)
    before, after = 0.5 * problem.approach**2, 0.5 * found.summary.final_velocity**2
    assert after + found.energy == pytest.approx(before, rel=1e-9)
    assert abs(found.summary.work) < 1e-9 * before
    assert found.energies.shape == (found.modes,) and (found.energies >= 0.0).all()


@combinations(law=["hunt-crossley", "kuwabara-kono", "tsuji", "linear-dashpot"], fast=1)
def test_damped_laws(law):
    """What the impactor loses is absorbed by the damping or in the modes; a history has each mode's energy; that of
    the omitted ones dies away."""
    history = fm.simulate(struck(FEW, "12 mm", "1 m/s", LAWS[law], "0.2 kg"), accuracy=5e-3)
    summary, ahead = history.summary, 0.5 * 0.2
    left = 0.5 * 0.2 * summary["rebound_velocity"] ** 2
    assert summary["energy_absorbed"] > 1e-3 * ahead
    assert left + summary["energy_absorbed"] + summary["energy_radiated"] == pytest.approx(ahead, rel=1e-5)
    in_modes = history.vibration_energy_by_mode.sum() / summary["energy_radiated"]
    assert 1.0 - 5e-3 < in_modes < 1.0  # the accuracy asked for
    samples = history.sample_si(np.linspace(0.0, history.duration, 201))
    assert (samples.contact_force >= 0.0).all()
    assert samples.contact_force.max() <= summary["maximum_force"] * (1.0 + 5e-3)  # the accuracy asked for


@pytest.mark.parametrize("law", ["hunt-crossley", "kuwabara-kono", "tsuji", "linear-dashpot"])
def test_the_end_of_a_damped_contact_follows_the_law(law):
    """The force of Hunt and Crossley's law vanishes like that of Hertz's, where the cubic force of a long step pulls:
    by that, this contact ended up to 3e-4 of its duration early."""
    rod = fm.Rod(STEEL, "26.1 mm", length="258.8 mm", far_end="fixed")
    problem = problem_of(struck(rod, "10 mm", "0.1783 m/s", LAWS[law], "59.68 g"))
    structure = structures.structure_of(rod, 2e6, problem.scales.time)
    ends = [vibration.run(problem, structure, 10.0**-k, 1.0, False).summary for k in (5.5, 6, 6.5, 7, 7.5, 8, 12)]
    durations = [end.contact_duration for end in ends]
    assert durations == pytest.approx([durations[-1]] * len(ends), rel=1e-7)


def linear_on_one_mode(tolerance):
    """A linear contact of stiffness 1 on one undamped mode: the impact, its tables and its curve."""
    tables = modal.Tables(np.array([2.0]), np.array([0.5]), np.zeros(1), 4.0)
    curve = native.Curve()
    curve.stages = curve.pieces = 1
    curve.stage[0].end = curve.piece[0].end = math.inf
    curve.stage[0].count = 1
    force = curve.piece[0].force
    force.per_span = force.exponent = force.slope = 1.0
    return modal.impact(tables, curve, modal.Start(1.0, 0.0, 0.0, 1.0, 1.0, 0.0, tolerance, 100.0)), tables, curve


def two_oscillators(t):
    """Displacements and velocities of impactor and mode in that contact: x'' = -(x - w), w'' = -4 w + (x - w)/2."""
    root, shape = np.linalg.eig(np.array([[1.0, -1.0], [-0.5, 4.5]]))
    turn = np.sqrt(root)
    weight = np.linalg.solve(shape, np.array([1.0, 0.0]))
    return shape @ (weight / turn * np.sin(turn * t)), shape @ (weight * np.cos(turn * t))


def test_a_linear_law_on_one_mode():
    found, tables, curve = linear_on_one_mode(1e-12)
    end = found.summary.core.contact_duration
    for t in (0.3 * end, end):
        (x, w), (v, _) = two_oscillators(t)
        values, _ = modal.sample(tables, curve, found.segments, found.flights, np.array([t]))
        assert values[0, [0, 3, 4]] == pytest.approx([x - w, v, w], abs=1e-11)


def test_order_of_the_steps():
    """On a law that is smooth from touch to end, the final velocity converges with the fourth order or faster."""
    errors, steps = [], []
    for tolerance in (1e-2, 1e-3, 1e-4, 1e-5):
        found, _, _ = linear_on_one_mode(tolerance)
        core, last = found.summary.core, found.segments[found.segments["flight"] < 0][-1]
        _, (exact, _) = two_oscillators(core.contact_duration)
        steps.append(core.contact_duration / found.segments["h"][:-1].max())
        errors.append(abs(core.final_velocity - exact) + 1e-15)
        assert last["h"] > 0.0
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope < -4.0 and errors[-1] < 1e-9


def test_damping_of_modes():
    """A damped mode: the response to an impulse decays as e^(-ζωt) cos; a rigid mode moves on evenly."""
    history = fm.simulate(struck(FEW, "12 mm", "1 m/s"), accuracy=1e-2)
    tables = history.vibration.tables
    damped = modal.Tables(tables.frequency, tables.share, np.full(tables.count, 0.1), tables.longest)
    scales, problem = history.problem.scales, history.problem
    curve = curve_of(problem.law).native
    start = modal.Start(problem.approach, 0.0, 0.0, problem.mass, scales.time, 0.0, 1e-8, 1.0)
    quiet, loud = (modal.impact(each, curve, start) for each in (damped, tables))
    assert 0.0 < quiet.energies.sum() < 0.9 * loud.energies.sum()
    free = modal.Tables(np.array([0.0]), np.array([1.0]), np.zeros(1), 1.0)  # two equal masses change their velocities
    found = modal.impact(free, curve, modal.Start(1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1e-9, 100.0))
    assert found.summary.core.final_velocity == pytest.approx(0.0, abs=1e-9)
    assert found.energies[0] == pytest.approx(0.5, rel=1e-9) and not found.summary.waited


def test_events_and_segments():
    history = fm.simulate(OLSSON, accuracy=1e-3)
    run = history.vibration
    assert len(run.flights) == run.contacts == 2
    assert modal.SEGMENT_DTYPE.itemsize <= 320
    times = run.segments["time"]
    assert (np.diff(times) >= 0.0).all()
    ends = times + np.minimum(run.segments["h"], 1.0)
    inside = run.segments["flight"][:-1] < 0
    np.testing.assert_allclose(ends[:-1][inside], times[1:][inside], rtol=1e-12)
    values, _ = run.sample(np.nextafter(times[1:], 0.0) / run.unit)
    after, _ = run.sample(times[1:] / run.unit)
    assert np.abs(values - after).max() < 1e-6  # the polynomials of neighbouring steps meet


def test_a_record_in_many_parts(monkeypatch):
    """A record that is too short is gone on with, to the same bits; one that is too large ends with a status."""
    whole, problem = on_few(LAWS["walton-braun"], 1e-6, "2 kg")
    monkeypatch.setattr(modal, "_ROOM", 5)
    parts, _ = on_few(LAWS["walton-braun"], 1e-6, "2 kg")
    assert len(whole.segments) > 100 and parts.segments.tobytes() == whole.segments.tobytes()
    assert np.array_equal(parts.flights, whole.flights) and parts.summary.work == whole.summary.work
    monkeypatch.setattr(modal, "MOST_MEMORY", 10_000)
    with pytest.raises(fm.SimulationError, match=r"needs more steps than the \d+ allowed"):
        on_few(LAWS["walton-braun"], 1e-6, "2 kg")
    assert problem.vibrates


def test_a_record_that_is_full_where_a_contact_ends(monkeypatch):
    """The step that ends a contact needs two segments: that of the flight must not be written beyond the record."""
    whole, _ = on_few(LAWS["walton-braun"], 1e-3, "2 kg")
    assert whole.contacts > 1
    flight = int(np.argmax(whole.segments["flight"] >= 0))
    for room in (flight - 1, flight, flight + 1):
        monkeypatch.setattr(modal, "_ROOM", room)
        assert on_few(LAWS["walton-braun"], 1e-3, "2 kg")[0].segments.tobytes() == whole.segments.tobytes()


def test_threads_share_a_structure():
    """Kept tables are filled by one thread at a time."""
    expected = fm.simulate(OLSSON, accuracy=1e-3).summary
    structures.forget()
    found = []
    threads = [threading.Thread(target=lambda: found.append(fm.simulate(OLSSON, accuracy=1e-3))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [history.summary for history in found] == [expected] * 4


@pytest.mark.parametrize(
    ("frequency", "share", "ratio", "message"),
    [
        ([1.0, 2.0], [1.0, -1.0], [0.0, 0.0], "mode 2: share -1 must be finite and > 0 1/kg"),
        ([1.0, math.nan], [1.0, 1.0], [0.0, 0.0], "mode 2: frequency nan must be finite and >= 0 rad/s"),
        ([2.0, 1.0], [1.0, 1.0], [0.0, 0.0], "mode 2: frequency 1 rad/s must not be below that of mode 1"),
        ([1.0, 2.0], [1.0, 1.0], [0.0, 1.5], "mode 2: damping ratio 1.5 must be from 0 to 1"),
        ([1.0, 2.0], [1.0], [0.0, 0.0], "as many shares and damping ratios as frequencies"),
    ],
)
def test_modes_that_are_none_are_refused(frequency, share, ratio, message):
    with pytest.raises(ValueError, match=message):
        modal.Tables(np.array(frequency), np.array(share), np.array(ratio), 1.0)


# ---------------------------------------------------------------- the error estimate


def estimated_and_true(scene, accuracy):
    """The error estimate, and the largest error against a run of a hundredth of the accuracy."""
    rough, fine = (fm.simulate(scene, accuracy=value) for value in (accuracy, accuracy / 30.0))
    changes = differences(rough.problem, rough.vibration.summary, fine.vibration.summary)
    return rough.accuracy.estimated, max(changes.values()), fine.accuracy.estimated


def judged_structures(seed, numbers, accuracy, monkeypatch):
    """Of benchmarks/random_structures.py, against vibrations by other methods."""
    root = SCENES.parent.parent
    monkeypatch.syspath_prepend(root)
    study = runpy.run_path(str(root / "benchmarks" / "random_structures.py"))
    scenes = list(study["random_structures"](max(numbers) + 1, seed))
    return [study["judged"](scenes[number], accuracy) for number in numbers]


@pytest.mark.slow
def test_the_estimate_bounds_the_error_against_other_modes(monkeypatch):
    """Rods, beams of three theories, simply supported plates with shear and without."""
    found = judged_structures(1, (6, 7, 9, 14, 17, 26, 33, 54), 1e-4, monkeypatch)
    assert all(one.clear and one.error <= one.estimate for one in found)


@pytest.mark.slow
def test_the_estimate_bounds_the_error_of_plates_with_any_edges(monkeypatch):
    """Clamped and free edges, D11/D22 of 1/130 on a bed; 5296 vibrations between two simply supported edges."""
    found = judged_structures(1, (23, 28, 32, 36, 62), 1e-4, monkeypatch)
    # of one impact the reference is not converged far enough to judge by (`clear`), which says nothing of the estimate
    assert all(one.error <= one.estimate for one in found) and sum(one.clear for one in found) >= 4


@pytest.mark.slow
def test_the_estimate_bounds_the_error_of_frequencies(monkeypatch):
    """Of plates and wide beams without closed forms, where more of their vibrations change less than these errors."""
    found = judged_structures(2911, (41, 73, 198, 228), 1e-4, monkeypatch)
    found += judged_structures(5, (7, 119), 1e-4, monkeypatch)
    above = [one.error / one.estimate for one in found if one.error > one.estimate]
    assert all(one.clear for one in found) and len(above) <= 1 and max(above, default=0.0) < 1.2  # 1.12


def test_errors_of_frequencies():
    """Of vibrations with half a set's highest frequency; what they lack of the deflection nearby is omitted."""
    clamped, free = ("clamped", "clamped"), ("free", "free")
    for edges, low in ((clamped + free, 3.5e-5), (clamped + clamped, 2e-6), (free + free, 2e-6), (HINGED + free, 0.0)):
        plate = fm.Plate(STEEL, "4 mm", size=["200 mm", "150 mm"], edges=edges, position=["60 mm", "50 mm"])
        structure = structures.structure_of(plate, 1e5, 1e-5)
        own, soft = structure.tables, structure.softer.tables
        expected = (low + 1.5e-4 * (own.frequency / 1e5) ** 2) * (low > 0.0)
        assert np.allclose(soft.frequency, own.frequency * (1.0 + expected), rtol=1e-15)
        change = Modes(own.frequency, own.share).compliance - Modes(soft.frequency, soft.share).compliance
        lacking = structure.softer.omitted - structure.omitted - structure.error
        assert 0.2 * change - 1e-20 <= lacking <= change * (1.0 + 1e-6) + 1e-20


@pytest.mark.slow
def test_errors_by_the_mode_of_the_omitted_compliance(monkeypatch):
    """Of a plate all whose modes are followed they are halved with each doubling of the highest frequency, and by half
    the critical damping; four doublings are two runs."""
    plate = fm.Plate(STEEL, "2.4 mm", size=["100 mm", "80 mm"], position=["42 mm", "31 mm"])
    scene = struck(plate, "5 mm", "1.5 m/s").replace({"contact.law": "tsuji", "contact.restitution": 0.8})
    runs, follow = list[vibration.Vibration](), vibration.run
    monkeypatch.setattr(vibration, "run", lambda *given, **named: runs.append(follow(*given, **named)) or runs[-1])
    history = fm.simulate(scene)
    assert runs[-1].highest == 4.0 * runs[-2].highest and runs[-1].modes == runs[0].modes
    problem, limit, errors = history.problem, runs[0].start.limit, dict[float, list[float]]()
    for ratio in (structures.RATIO, 1.0):
        monkeypatch.setattr(structures, "RATIO", ratio)
        summaries = [
            follow(problem, structures.made(plate, more * runs[0].highest, problem.scales.time), 1e-8, limit).summary
            for more in (256.0, 2.0, 4.0, 8.0)
        ]
        errors[ratio] = [max(differences(problem, each, summaries[0]).values()) for each in summaries[1:]]
    for sharper, critical in zip(*errors.values(), strict=True):
        assert 0.35 < sharper / critical < 0.7
    for found in errors.values():
        assert all(1.5 < before / after < 3.0 for before, after in itertools.pairwise(found)), found


@pytest.mark.slow
def test_runs_that_agree_by_chance():
    """On this beam two sets of modes differ by less than a tenth of the error."""
    beam = fm.Beam(
        ALUMINIUM, "277.7 mm", "10 mm", "11.74 mm", ends="free", position="34.3 mm", theory="euler-bernoulli"
    )
    estimate, true, _ = estimated_and_true(struck(beam, "10 mm", "2.082 m/s", LAWS["walton-braun"], "2.508 kg"), 1e-4)
    assert true <= estimate <= 1e-4


# ---------------------------------------------------------------- more modes than can be computed

CLAMPED = fm.Plate(STEEL, "2 mm", size=["200 mm", "200 mm"], edges="clamped")


@pytest.mark.slow
def test_the_most_modes_that_can_be_computed(monkeypatch):
    """The result is that with the most modes; a warning names the values above the accuracy, and bounds them."""
    scene = struck(CLAMPED, "20 mm", "1 m/s")
    exact = fm.simulate(scene, accuracy=3e-3)
    monkeypatch.setattr(ritz, "MOST_FUNCTIONS", 150)
    monkeypatch.setattr(ritz, "SHARPNESS", ((2.0, 50), (1.3, 150)))
    ritz.unit_modes.cache_clear()
    structures.forget()
    with pytest.warns(fm.ImpactWarning, match=r"accuracy 0.0001 is not reached: with \d+ modes the estimated relative"):
        found = fm.simulate(scene, accuracy=1e-4)
    velocity = units.quantity(np.linspace(0.9, 1.1, 34), "velocity")
    many = fm.simulate_batch(scene, velocity=velocity, accuracy=1e-4)
    ritz.unit_modes.cache_clear()
    structures.forget()
    changes = differences(exact.problem, found.vibration.summary, exact.vibration.summary)
    assert 1e-4 < max(changes.values()) < found.accuracy.estimated
    assert found.vibration.modes < exact.vibration.modes
    assert not many.failed.any() and (many.estimated_accuracy > 1e-4).all()


def test_a_contact_that_is_not_resolved_is_refused():
    wide = fm.Plate(STEEL, "1 mm", size=["10 m", "10 m"], edges="clamped")
    with pytest.raises(fm.SimulationError, match="half-waves along one side, but at most 320 are allowed: take simply"):
        fm.simulate(struck(wide, "1 mm", "1 m/s"))


# ---------------------------------------------------------------- a clearance


def test_a_clearance_only_delays_the_impact():
    """Before the clearance is closed nothing moves but the ball; afterwards the motion is that without clearance."""
    clear, velocity = 20e-6, 0.5
    laws = (fm.Meyer(stiffness=1e10, exponent=1.5, initial_indentation=depth) for depth in (0.0, clear))
    close, wide = (fm.simulate(struck(FEW, "10 mm", f"{velocity} m/s", law, "2 kg"), accuracy=1e-5) for law in laws)
    for name, more in (("maximum_indentation", clear), ("time_of_maximum_indentation", clear / velocity)):
        assert wide.summary[name] == pytest.approx(close.summary[name] + more, rel=1e-5), name
    for name in ("maximum_force", "rebound_velocity", "energy_radiated"):
        assert wide.summary[name] == pytest.approx(close.summary[name], rel=2e-5), name
    changes = [event for event in wide.events if event.name == "stage_changes"]
    assert changes[0].time == pytest.approx(clear / velocity, rel=1e-12)
    assert wide.sample_si(0.5 * clear / velocity).contact_force == 0.0


@pytest.mark.parametrize(("third", "modes"), [("", 3), ("4000, 0.3, 0.9, 0.01\n", 4)])
def test_a_damped_law_on_a_structure_with_an_omitted_compliance(tmp_path, third, modes):
    """That compliance is a mode, at ever higher frequencies, up to a limit, or until it rattles too often to follow."""
    text = "frequency [Hz], modal_mass [kg], shape, damping_ratio\n300, 0.5, 1, 0.01\n1200, 0.4, 0.8, 0.01\n"
    (tmp_path / "modes.csv").write_text(text + third)
    target = fm.Structure(material=STEEL, file=str(tmp_path / "modes.csv"), static_compliance="1e-6 m/N")
    ball = fm.Sphere("10 mm", velocity="1 m/s", material="bearing steel")
    damped, elastic = (fm.Contact("kuwabara-kono", dissipation_time="1 us"), fm.Contact("hertz"))
    with pytest.warns(fm.ImpactWarning, match=f"is not reached: with {modes} modes the estimated relative errors are"):
        found = fm.simulate(fm.Scene(ball, target, damped))
    soft = fm.simulate(fm.Scene(ball, target, elastic)).summary["maximum_force"]
    assert found.summary["maximum_force"] == pytest.approx(soft, rel=5e-3)  # the spring is softer than the contact


@pytest.mark.slow
def test_the_estimate_sees_the_error_of_the_static_compliance(monkeypatch):
    """The summary with an omitted compliance that is off by its bound; a plate struck beside a clamped edge."""
    plate = fm.Plate(ALUMINIUM, "3 mm", size=["200 mm", "120 mm"], edges="clamped", position=["30 mm", "4 mm"])
    scene = struck(plate, "5 mm", "1 m/s")
    found = fm.simulate(scene, accuracy=1e-4)
    error = plate.compliance_error
    assert 1e-6 < error / plate.compliance < 1e-2
    assert 0.0 < found.vibration.target_error < found.accuracy.estimated
    batch = fm.simulate_batch(scene, velocity=["1 m/s", "2 m/s"], accuracy=1e-4)
    assert batch.estimated_accuracy[0] == found.accuracy.estimated
    omitted = fm.Plate.omitted
    monkeypatch.setattr(fm.Plate, "omitted", lambda self, modes, highest: (sum(omitted(self, modes, highest)), 0.0))
    structures.forget()
    other = fm.simulate(scene, accuracy=1e-4)
    structures.forget()
    assert other.maximum_force != found.maximum_force
    for name in ("maximum_force", "rebound_velocity", "contact_duration"):
        assert other.summary[name] == pytest.approx(found.summary[name], rel=found.accuracy.estimated)
