"""The component: steps of any size give one motion, with the events of a whole run."""

import copy
import math
import pickle
import random

import numpy as np
import pytest
from cases import LAWS, combinations, scene
from scipy.integrate import solve_ivp

import film_model as fm
from film_model.core import native

EXACT = 1e-12


def drop(law="big-alabo", target="half-space", **options):
    return fm.ImpactComponent(scene(law, target, accuracy=1e-8), **options)


def values(outputs):
    return np.array([value for value in outputs if isinstance(value, float)])


@pytest.mark.parametrize("target", ["half-space", "plate", "rod"])
@pytest.mark.parametrize("law", list(LAWS))
def test_any_split_of_an_interval_gives_the_same_motion(law, target):
    rng = random.Random(law + target)
    whole, parts = drop(law, target, initial_gap="2 um"), drop(law, target, initial_gap="2 um")
    expected = whole.step(2e-4)
    cuts = sorted(rng.uniform(0, 2e-4) for _ in range(60))
    events = []
    for a, b in zip([0.0, *cuts], [*cuts, 2e-4], strict=True):
        result = parts.step(b - a)
        events += result.events
    scale = np.abs(values(expected.outputs)).max() + np.abs(values(expected.outputs))
    assert (np.abs(values(result.outputs) - values(expected.outputs)) < 3e-11 * scale).all()
    assert [event.name for event in events] == [event.name for event in expected.events]
    assert [event.time for event in events] == pytest.approx([event.time for event in expected.events], rel=EXACT)


@pytest.mark.parametrize("target", ["half-space", "plate"])
@pytest.mark.parametrize("law", ["hertz", "big-alabo", "stronge"])
def test_events_equal_those_of_simulate(law, target):
    component = drop(law, target)
    history = fm.simulate(component.scene, accuracy=1e-8)
    result = component.step("1 ms")
    assert component.phase == "separated"
    assert [event.name for event in result.events] == [event.name for event in history.events]
    for ours, theirs in zip(result.events, history.events, strict=True):
        assert ours.time == pytest.approx(theirs.time, rel=EXACT)
        assert ours.indentation == pytest.approx(theirs.indentation, rel=EXACT)
        assert ours.stage == theirs.stage


@pytest.mark.parametrize("velocity", [0.01, 0.25, 2.0])
@pytest.mark.parametrize("accuracy", [1e-4, 1e-9])
def test_segments_equal_those_of_simulate(velocity, accuracy):
    case = scene("big-alabo", "plate", velocity, accuracy=accuracy)
    found = fm.simulate(case).accuracy
    assert fm.ImpactComponent(case).segments == (found.segments, found.unloading_segments)
    assert fm.ImpactComponent(case, segments=7).segments == (7, 7)


@pytest.mark.slow
def test_a_loaded_impactor_at_rest_has_at_least_the_default_segments():
    laid = scene("big-alabo", "plate", velocity=0.0).replace({"contact.law": "big-alabo", "effects.gravity": True})
    bare = laid.replace({"effects.gravity": False})
    assert fm.ImpactComponent(bare).segments == (24, 48)
    coarse, fine = (fm.ImpactComponent(laid, accuracy=accuracy).segments for accuracy in (0.1, 1e-12))
    assert coarse == (24, 48) and fine[0] > 48 and fine[1] > 48


def test_a_restored_step_repeats_to_the_last_bit():
    component = drop(initial_gap="1 um")
    component.step(3e-5)
    saved = component.save()
    first = component.step(7e-5, external_force=3.0)
    component.restore(saved)
    assert component.step(7e-5, external_force=3.0) == first
    component.reset()
    again = drop(initial_gap="1 um")
    assert component.step(1e-4) == again.step(1e-4)


def test_stop_at_events_returns_at_each_event():
    component = drop()
    names = []
    while component.phase != "separated":
        result = component.step(1.0, stop_at_events=True)
        names += [event.name for event in result.events]
        assert len(result.events) == 1
        assert result.time == result.events[0].time
    assert names == ["contact_begins", "stage_changes", "maximum_indentation", "impactor_stops", "contact_ends"]


def test_second_contact_on_the_same_dent():
    """A small force returns the ball to its dent at the rebound velocity: the second contact is nearly elastic."""
    component = drop()
    first = component.step(2e-4)
    left = first.outputs.impactor_velocity
    dent = first.events[-1].indentation
    force = 2.0  # N, reverses the flight of the ball
    events = []
    for _ in range(2000):
        result = component.step(1e-5, external_force=force)
        events += result.events
        if any(event.name == "contact_ends" for event in events):
            break
    begins = next(event for event in events if event.name == "contact_begins")
    assert begins.indentation == pytest.approx(dent, rel=EXACT)
    flight = dent - first.outputs.indentation  # the force acted over this length on the way back only
    assert begins.impactor_velocity == pytest.approx(math.sqrt(left**2 + 2 * force * flight / 0.06074), rel=1e-12)
    assert component.outputs.contact_count == 2
    turn = next(event for event in events if event.name == "maximum_indentation")
    old = next(event for event in first.events if event.name == "maximum_indentation")
    work = force * (turn.indentation - dent)
    assert old.indentation < turn.indentation < 1.05 * old.indentation
    ends = next(event for event in events if event.name == "contact_ends")
    assert work < 0.02 * 0.5 * 0.06074 * left**2  # the force adds little energy, so little is dissipated
    assert abs(ends.impactor_velocity) == pytest.approx(begins.impactor_velocity, rel=2e-2)


def loading_force(d):
    """Big-Alabo's first two stages, in F_y."""
    return np.where(d <= 1.0, np.maximum(d, 0.0) ** 1.5, 1.0 + np.maximum(d - 1.0, 0.0) ** 1.5)


def test_reloading_by_a_force_before_separation():
    """A force during unloading reloads the contact along the unloading branch, past the old maximum and along the
    loading curve; compared with solve_ivp on the law itself."""
    component = drop()
    scales, mass = component.problem.scales, component.problem.mass
    turn = None
    while turn is None:
        result = component.step(1.0, stop_at_events=True)
        turn = next((event for event in result.events if event.name == "maximum_indentation"), None)
    component.step(2e-5)
    start = component.outputs
    push = 900.0
    deepest, force_max = turn.indentation / scales.length, turn.contact_force / scales.force
    radius = 1.0 + ((deepest - 1.0) / 12.93) ** 1.5
    free = deepest - (force_max / math.sqrt(radius)) ** (2 / 3)

    def force(d):
        branch = force_max * (max(d - free, 0.0) / (deepest - free)) ** 1.5
        return scales.force * (branch if d <= deepest else float(loading_force(np.array(d))))

    def rate(t, state):
        return [state[1], (push - force(state[0] / scales.length)) / mass]

    def passes(t, state):
        return state[0] / scales.length - deepest

    passes.terminal = True
    begin = [start.indentation, start.impactor_velocity]
    options = {"rtol": 1e-12, "atol": 1e-20, "method": "DOP853"}
    first = solve_ivp(rate, (0, 3e-4), begin, events=passes, **options)
    crossing, there = first.t_events[0][0], first.y_events[0][0]
    there[0] = deepest * scales.length * (1 + 1e-15)
    later = solve_ivp(rate, (crossing, crossing + 3e-5), there, **options)

    result = component.step(crossing + 3e-5, external_force=push)
    names = [event.name for event in result.events]
    assert names[:2] == ["reloading_begins", "stage_changes"]
    assert result.events[1].time - start.time == pytest.approx(crossing, rel=1e-9)
    assert result.outputs.indentation == pytest.approx(later.y[0, -1], rel=1e-9)
    assert result.outputs.impactor_velocity == pytest.approx(later.y[1, -1], rel=1e-7)
    assert result.outputs.indentation > turn.indentation
    assert result.outputs.contact_force > turn.contact_force


def test_force_held_over_the_contact_agrees_with_an_integrator():
    component = drop("hertz", "plate")
    problem, push = component.problem, 150.0
    gamma, load = problem.gamma, push / problem.scales.force

    def rate(t, state):
        force = max(state[0], 0.0) ** 1.5
        return [state[1] - gamma * force, load - force]

    end = 2.0
    exact = solve_ivp(rate, (0, end), [0, problem.approach], rtol=1e-12, atol=1e-14, method="DOP853").y[:, -1]
    outputs = component.step(end * problem.scales.time, external_force=push).outputs
    assert outputs.indentation == pytest.approx(exact[0] * problem.scales.length, rel=1e-8)
    assert outputs.impactor_velocity == pytest.approx(exact[1] * problem.scales.velocity, rel=1e-6)


def test_a_ball_comes_to_rest_on_a_plate():
    steel = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
    ball = fm.Sphere("5 mm", velocity="0.2 m/s", material=steel)
    rest = fm.Scene(
        ball,
        fm.Plate(steel, thickness="2 mm"),
        contact=fm.Contact(law="hertz"),
        effects=fm.Effects(gravity=True),
        solver=fm.Solver(accuracy=1e-4),
    )
    component = fm.ImpactComponent(rest, initial_gap="1 mm")
    result = component.step(20.0)
    assert component.phase == "resting"
    assert result.outputs.contact_force == pytest.approx(rest.mass * 9.80665, rel=1e-12)
    assert result.outputs.relative_velocity == pytest.approx(0, abs=1e-9)
    assert component.step("365 days").outputs.phase == "resting"


def test_a_moving_support_changes_the_frame_of_reference():
    still, moving = drop("big-alabo", "plate"), drop("big-alabo", "plate")
    still.step(1e-5)
    a = still.step(5e-5)
    moving.step(1e-5)
    b = moving.step(5e-5, support_velocity=0.0)
    assert a == b
    # A support that recedes at the velocity of the ball is not indented further.
    runaway = drop("hertz", initial_gap="1 um")
    result = runaway.step(1.0, support_velocity=0.25)
    assert result.outputs.phase == "approaching"
    assert result.outputs.target_displacement == pytest.approx(0.25)
    # A support that approaches at the velocity of the ball doubles the approach velocity.
    meeting = drop("hertz", initial_gap="1 um")
    result = meeting.step(1e-3, support_velocity=-0.25)
    double = fm.simulate(scene("hertz", velocity=0.5, accuracy=1e-8))
    turn = next(event for event in result.events if event.name == "maximum_indentation")
    assert turn.indentation == pytest.approx(double.summary["maximum_indentation"], rel=1e-12)


def test_tiny_huge_and_zero_steps():
    component = drop()
    before = component.outputs
    assert component.step(0.0).outputs.time == before.time
    for _ in range(10):
        component.step(1e-18)
    assert component.time == pytest.approx(1e-17, rel=1e-12)
    result = component.step("365 days")
    assert result.outputs.phase == "separated"
    assert result.outputs.time == pytest.approx(365 * 86400, rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"dt": -1e-6}, "must be >= 0 s"),
        ({"dt": math.nan}, "nan"),
        ({"dt": "5 kg"}, "a time is needed"),
        ({"dt": 1e-6, "external_force": "5 m"}, "a force is needed"),
        ({"dt": 1e-6, "support_velocity": math.inf}, "inf"),
    ],
)
def test_bad_steps_are_refused_and_change_nothing(arguments, says):
    component = drop()
    saved = component.save()
    with pytest.raises(ValueError, match=says):
        component.step(**arguments)
    assert component.save() == saved


def test_texts_quantities_and_floats_give_the_same_step():
    import pint

    ureg = pint.get_application_registry()
    results = [
        drop().step(dt, external_force=force)
        for dt, force in ((2e-5, 1.5), ("20 us", "1.5 N"), (20 * ureg.us, 1.5 * ureg.N))
    ]
    assert results[0] == results[1]
    assert values(results[2].outputs) == pytest.approx(values(results[0].outputs), rel=1e-14)


def test_a_free_body_cannot_be_stepped():
    with pytest.raises(fm.SimulationError, match="free body"):
        fm.ImpactComponent(scene("hertz", "body"))
    with pytest.raises(ValueError, match="initial_gap"):
        drop(initial_gap=-1e-6)


def test_phases_are_named_as_in_the_core():
    assert len(native.PHASES) == 6
    component = drop()
    assert component.phase == "approaching"
    component.step(1e-5)
    assert component.phase == "loading"
    component.step(6e-5)
    assert component.phase == "unloading"


@pytest.mark.slow
def test_a_million_steps_do_not_drift():
    whole, parts = drop("big-alabo", "plate"), drop("big-alabo", "plate")
    expected = whole.step(1e-4).outputs
    for _ in range(1_000_000):
        parts.step(1e-10)
    found = parts.outputs
    assert found.time == pytest.approx(expected.time, rel=EXACT)
    assert found.indentation == pytest.approx(expected.indentation, rel=EXACT)
    assert found.impactor_velocity == pytest.approx(expected.impactor_velocity, rel=1e-11)


def test_initialize_begins_at_another_time_and_velocity():
    component = drop(initial_gap="1 um")
    component.step(1e-4)
    component.initialize(time="2 s", velocity="0.5 m/s", initial_gap="0 m")
    assert component.time == 2.0 and component.outputs.indentation == 0.0
    events = component.step(2e-4).events
    history = fm.simulate(component.scene.replace({"impactor.velocity": "0.5 m/s"}), segments=component.segments[0])
    assert events[0].time == 2.0
    assert events[-1].time - 2.0 == pytest.approx(history.summary["contact_duration"], rel=1e-11)
    saved = component.save()
    component.reset()
    assert component.time == 0.0 and component.outputs.indentation == pytest.approx(-1e-6, rel=1e-12)
    component.restore(saved)
    assert component.time == pytest.approx(2.0 + 2e-4, rel=1e-15)
    with pytest.raises(ValueError, match="initial_gap"):
        component.initialize(initial_gap="-1 mm")
    component.reset()
    assert component.outputs.impactor_velocity == pytest.approx(0.25, rel=1e-15)  # again that of the scene


def test_a_ball_at_rest_on_a_thin_plate_creeps_in_until_the_time_limit():
    on = fm.Scene(
        fm.Sphere(radius="10 mm", velocity="0 m/s", material="WC, Big-Alabo 2017"),
        fm.Plate("mild steel", thickness="1 mm"),
        contact=fm.Contact(law="hertz"),
    )
    history = fm.simulate(on)
    assert history.outcome is fm.Outcome.TIME_LIMIT
    assert [event.name for event in history.events] == ["contact_begins"]
    assert history.summary["maximum_force"] == pytest.approx(on.mass * 9.80665, rel=1e-12)
    assert history.summary["maximum_indentation"] is None and history.summary["contact_duration"] is None
    last = history.sample_si(history.duration)  # the beginning of the last segment
    assert 0.99 * on.mass * 9.80665 < last.contact_force < on.mass * 9.80665


def test_a_ball_that_stops_and_moves_in_again_on_one_line_is_seen():
    """It turns back for 60 us of a contact that does not end: neither end of a coarse line tells."""
    ball = fm.Sphere("10 mm", velocity="83.697 mm/s", mass="182.28 g", material="WC, Big-Alabo 2017")
    law = fm.Contact("linear-dashpot", stiffness="1e8 N/m", restitution=0.6)
    plate = fm.Plate("mild steel", "5 mm")
    scene = fm.Scene(ball, plate, law, fm.Effects(gravity=True, boundary_reflections=False))
    exact = fm.simulate(scene, segments=96)
    stops = exact.summary["time_impactor_stops"]
    after = exact.sample_si([stops + 30e-6, stops + 90e-6]).impactor_velocity
    assert after[0] < 0.0 < after[1]
    for segments in (2, 6):
        found = fm.simulate(scene, segments=segments).summary["time_impactor_stops"]
        assert found == pytest.approx(stops, rel=1e-9)


@pytest.mark.parametrize("law", ["hertz", "tsuji"])
def test_a_ball_that_is_laid_down_is_followed_for_one_swing(law):
    given = {"restitution": 0.6} if law == "tsuji" else {}
    ball = fm.Sphere(radius="10 mm", velocity="0 m/s", material="mild steel")
    history = fm.simulate(fm.Scene(ball, fm.HalfSpace("mild steel"), fm.Contact(law, **given)))
    names = [event.name for event in history.events]
    assert names == ["contact_begins", "maximum_indentation", "impactor_stops", "reloading_begins"]
    assert history.outcome is fm.Outcome.RESTING and history.summary["contact_duration"] is None
    if law == "hertz":  # F/W = 5/2 at the deepest point, where the work of the weight equals that of the force
        weight = history.scene.mass * 9.80665
        assert history.summary["maximum_force"] == pytest.approx(2.5 * weight, rel=1e-4)


@pytest.mark.slow
@combinations(velocity=["0 m/s", "1 um/s", "0.1 mm/s"], accuracy=[1e-4, 1e-8], fast=2)
def test_a_creeping_contact_meets_the_requested_accuracy(velocity, accuracy):
    """The indentation on a thin plate has no maximum: the accuracy is that of the motion."""
    on = fm.Scene(
        fm.Sphere(radius="10 mm", velocity=velocity, material="WC, Big-Alabo 2017"),
        fm.Plate("mild steel", thickness="1 mm"),
        contact=fm.Contact(law="hertz"),
        effects=fm.Effects(gravity=True),
    )
    component = fm.ImpactComponent(on, accuracy=accuracy)
    problem, law = component.problem, component.problem.law
    stiffness = 4 / 3 * law.effective_modulus * math.sqrt(law.radius)
    force = lambda d: stiffness * max(d, 0.0) ** 1.5  # noqa: E731

    def rates(_, y):
        return [y[1] - force(y[0]) / problem.given.impedance, 9.80665 - force(y[0]) / problem.mass]

    times = np.geomspace(1e-7, 1e-2, 40)
    tight = {"method": "Radau", "rtol": 1e-11, "atol": [1e-22, 1e-16]}
    exact = solve_ivp(rates, (0.0, 1e-2), [0.0, on.impactor.velocity], t_eval=times, **tight)
    found = [component.step(t - component.time).outputs for t in times]
    for y, name in zip(exact.y, ("indentation", "impactor_velocity"), strict=True):
        off = np.array([getattr(outputs, name) for outputs in found]) - y
        assert np.abs(off).max() < accuracy * np.abs(y).max()


@pytest.mark.parametrize("law", ["hertz", "big-alabo", "stronge", "tan-sun"])
def test_a_reversal_by_the_support_is_an_event(law):
    """The support reverses the relative velocity twice: first reloading begins, then the indentation has a maximum."""
    on = scene(law)
    duration = fm.simulate(on).duration
    component = fm.ImpactComponent(on)
    component.step(0.8 * duration)
    inwards = component.step(1e-9, support_velocity=-0.5)
    assert [event.name for event in inwards.events] == ["reloading_begins"]
    assert inwards.events[0].time == pytest.approx(0.8 * duration) and inwards.outputs.relative_velocity > 0.0
    outwards = component.step(1e-9, support_velocity=0.5)
    assert [event.name for event in outwards.events] == ["maximum_indentation"]
    assert component.step(1e-9, support_velocity=0.4).events == ()


def test_a_component_is_copied_and_pickled_in_the_middle_of_a_contact():
    component = drop("stronge", "plate", initial_gap="1 um")
    component.step(30e-6)
    assert repr(component) == "ImpactComponent(law stronge, loading at 3e-05 s)"
    twins = copy.deepcopy(component), pickle.loads(pickle.dumps(component))
    expected = component.step(1e-3)
    assert [event.name for event in expected.events][-1] == "contact_ends"
    assert [twin.step(1e-3) for twin in twins] == [expected, expected]
