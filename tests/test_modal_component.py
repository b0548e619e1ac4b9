"""The component on vibrating targets: the events of `simulate`, steps of any size, and inputs against an integrator."""

import copy
import ctypes
import math
import pickle
import random

import numpy as np
import pytest
from cases import LAWS
from scipy.integrate import solve_ivp
from test_component import values
from test_modal_engine import BAR, FEW, OLSSON, QUIET, STEEL, bar, struck

import film_model as fm
from film_model.base.errors import Outcome
from film_model.core.modal import Modal
from film_model.effects.choose import problem_of
from film_model.solve import structures, vibration

EXACT = 1e-13
BALL = fm.Sphere("10 mm", "0.5 m/s", material=STEEL, mass="50 g")
LISTED = {"frequency": ["300 Hz", "1.7 kHz", "4 kHz"], "modal_mass": ["0.3 kg", "0.2 kg", "0.4 kg"], "material": STEEL}
RINGING = fm.Structure(**LISTED)
FADING = fm.Structure(**LISTED, damping_ratio=[0.02, 0.05, 0.1])
FLYING = fm.Structure(**{**LISTED, "frequency": ["0 Hz", "1.7 kHz", "4 kHz"]})


def on(target, law="hertz", **changes):
    return fm.Scene(BALL, target, fm.Contact(law), QUIET, fm.Solver(accuracy=1e-6)).replace(changes)


SCENES = {
    "the plate of the paper": OLSSON,
    "a beam, three contacts": struck(bar("307 mm"), "20 mm", "0.01 m/s", material=BAR),
    "a heavy ball": struck(FEW, "12 mm", "0.3 m/s", mass="2 kg"),
    "stages": struck(FEW, "12 mm", "1 m/s", LAWS["stronge"], mass="0.2 kg").replace({"solver.accuracy": 1e-2}),
    "a damped law": struck(FEW, "12 mm", "1 m/s", LAWS["hunt-crossley"], "0.2 kg").replace({"solver.accuracy": 1e-2}),
    "few vibrations": on(RINGING),
    "damped vibrations": on(FADING, LAWS["big-alabo"]),
    "nothing holds it": on(FLYING, LAWS["thornton"]),
}
for_each_scene = pytest.mark.parametrize("case", SCENES.values(), ids=SCENES)


@for_each_scene
def test_events_equal_those_of_simulate(case):
    history, component = fm.simulate(case), fm.ImpactComponent(case)
    assert component.modes == history.accuracy.modes > 0 and component.segments == (0, 0)
    events = component.step(history.events[-1].time * (1.0 + 1e-9)).events
    assert [event.name for event in events] == [event.name for event in history.events]
    for ours, theirs in zip(events, history.events, strict=True):
        assert ours.stage == theirs.stage
        assert ours.time == pytest.approx(theirs.time, rel=1e-15)
        assert ours.contact_force == pytest.approx(theirs.contact_force, rel=1e-13, abs=1e-12)
        assert ours.target_displacement == pytest.approx(theirs.target_displacement, rel=1e-13, abs=1e-20)


def test_new_inputs_between_contacts_leave_the_vibrations_alone():
    """A step out of the structure's reach takes as long as with few vibrations: they go on as they were."""
    component = fm.ImpactComponent(on(FADING))
    before = component.step(5e-3).outputs
    assert before.phase == "separated" and before.indentation < -5e-4
    vibrations, gained, moved = component.save().core[ctypes.sizeof(Modal) :], 0.0, 0.0
    for k in range(50):
        after = component.step(1e-5, external_force=k - 20.0).outputs
        moved += (before.impactor_velocity + gained) * 1e-5 + 0.5 * (k - 20.0) / 0.05 * 1e-10
        gained += (k - 20.0) / 0.05 * 1e-5
    assert component.save().core[ctypes.sizeof(Modal) :] == vibrations
    assert after.impactor_velocity == pytest.approx(before.impactor_velocity + gained, rel=1e-13)
    assert after.impactor_displacement == pytest.approx(before.impactor_displacement + moved, rel=1e-13)
    rings = fm.ImpactComponent(on(FADING)).step(component.time).outputs
    assert after.target_displacement == pytest.approx(rings.target_displacement, rel=1e-10)
    assert after.target_velocity == pytest.approx(rings.target_velocity, rel=1e-10)


@for_each_scene
def test_any_split_of_an_interval_gives_the_same_motion(case):
    rng, end = random.Random(1), 1.5 * fm.simulate(case).duration
    whole, parts = (fm.ImpactComponent(case, initial_gap="2 um") for _ in range(2))
    expected, events = whole.step(end), []
    cuts = sorted(rng.uniform(0, end) for _ in range(60))
    for a, b in zip([0.0, *cuts], [*cuts, end], strict=True):
        result = parts.step(b - a)
        events += result.events
    scale = np.abs(values(expected.outputs)).max() + np.abs(values(expected.outputs))
    assert (np.abs(values(result.outputs) - values(expected.outputs)) < 1e-11 * scale).all()
    assert [event.name for event in events] == [event.name for event in expected.events]
    assert [event.time for event in events] == pytest.approx([event.time for event in expected.events], rel=EXACT)


def test_a_restored_step_repeats_to_the_last_bit():
    component = fm.ImpactComponent(OLSSON, initial_gap="1 um")
    component.step(8e-5)
    saved, twins = component.save(), (copy.deepcopy(component), pickle.loads(pickle.dumps(component)))
    first = component.step(3e-4, external_force=20.0)
    assert [event.name for event in first.events].count("contact_begins") >= 1
    component.restore(saved)
    assert component.step(3e-4, external_force=20.0) == first
    assert [twin.step(3e-4, external_force=20.0) for twin in twins] == [first, first]
    component.reset()
    assert component.step(4e-4) == fm.ImpactComponent(OLSSON, initial_gap="1 um").step(4e-4)


# ---------------------------------------------------------------- inputs

INPUTS = [  # time [s], external force [N], support velocity [m/s]
    (2e-5, 0.0, 0.0),
    (5e-5, 120.0, 0.0),
    (3e-5, 120.0, -0.1),
    (9e-5, -40.0, 0.05),
    (8e-4, 300.0, 0.0),
    (1.1e-3, 60.0, 0.02),
]


def integrated(case, inputs):
    """Indentation, impactor velocity and target displacement after each part, by DOP853 on the equations of motion."""
    problem, target = fm.ImpactComponent(case).problem, case.target
    stiffness = 4 / 3 * problem.law.effective_modulus * math.sqrt(problem.law.radius)
    omega = 2.0 * math.pi * np.array(target.frequency)
    drag = 2.0 * omega * (0.0 if target.damping_ratio is None else np.array(target.damping_ratio))
    share, n, mass, load, support = 1.0 / np.array(target.modal_mass), len(omega), problem.mass, 0.0, 0.0

    def rate(_, y):
        force = stiffness * max(y[0] - y[2 : 2 + n].sum(), 0.0) ** 1.5
        w, u = y[2 : 2 + n], y[2 + n :]
        return np.concatenate([[y[1], (load - force) / mass], u, share * force - drag * u - omega**2 * w])

    y, carried = np.concatenate([[0.0, BALL.velocity], np.zeros(2 * n)]), 0.0
    for dt, load, velocity in inputs:  # noqa: B007
        y[1] += support - velocity
        support, carried = velocity, carried + velocity * dt
        y = solve_ivp(rate, (0.0, dt), y, rtol=1e-11, atol=1e-17, method="DOP853", max_step=2e-6).y[:, -1]
        bent = y[2 : 2 + n].sum()
        yield y[0] - bent, y[1] + support, bent + carried


@pytest.mark.slow
@pytest.mark.parametrize("target", [RINGING, FADING, FLYING], ids=["ringing", "fading", "flying"])
def test_forces_and_supports_on_a_structure_that_rings_agree_with_an_integrator(target):
    """The force pushes the ball back, again and again, to a structure that still rings from the contacts before."""
    case = on(target, **{"solver.accuracy": 1e-9})
    component = fm.ImpactComponent(case)
    for (dt, force, support), expected in zip(INPUTS, integrated(case, INPUTS), strict=True):
        found = component.step(dt, external_force=force, support_velocity=support).outputs
        got = found.indentation, found.impactor_velocity, found.target_displacement
        assert got == pytest.approx(expected, rel=2e-7, abs=1e-12)
    assert found.contact_count >= 3


@pytest.mark.parametrize("law", ["hertz", "big-alabo", "stronge", "hunt-crossley"])
def test_a_reversal_by_the_support_is_an_event(law):
    case = on(RINGING, LAWS[law])
    first = next(event.time for event in fm.simulate(case).events if event.name == "contact_ends")
    component = fm.ImpactComponent(case)
    component.step(0.9 * first)
    assert component.phase == "unloading"
    inwards = component.step(1e-9, support_velocity=-3.0)
    assert [event.name for event in inwards.events] == ["reloading_begins"]
    assert inwards.events[0].time == pytest.approx(0.9 * first) and inwards.outputs.relative_velocity > 0.0
    outwards = component.step(1e-9, support_velocity=3.0)
    assert "maximum_indentation" in [event.name for event in outwards.events]
    assert component.step(1e-9, support_velocity=2.9).events == ()


def test_a_support_that_flees_is_not_touched_and_one_that_comes_doubles_the_velocity():
    fleeing = fm.ImpactComponent(on(RINGING), initial_gap="1 um").step(1.0, support_velocity=0.5)
    assert fleeing.outputs.phase == "approaching" and fleeing.outputs.target_displacement == pytest.approx(0.5)
    meeting = fm.ImpactComponent(on(RINGING), initial_gap="1 um").step(2e-4, support_velocity=-0.5)
    double = fm.simulate(on(RINGING, **{"impactor.velocity": "1 m/s"}))
    turn = next(event for event in meeting.events if event.name == "maximum_indentation")
    assert turn.indentation == pytest.approx(double.summary["maximum_indentation"], rel=1e-6)
    stop = next(event for event in meeting.events if event.name == "impactor_stops")
    assert stop.impactor_velocity == pytest.approx(0.0, abs=1e-9)


# ---------------------------------------------------------------- starts and ends


def test_a_ball_comes_to_rest_on_a_damped_structure():
    case = on(FADING, **{"effects.gravity": True, "solver.accuracy": 1e-4, "impactor.velocity": "0.05 m/s"})
    component = fm.ImpactComponent(case, initial_gap="10 um")
    events, outputs = component.step(1.0).events, component.outputs
    assert outputs.phase == "resting" and outputs.contact_count > 3 and len(events) < 1000
    assert outputs.contact_force == pytest.approx(case.mass * 9.80665, rel=1e-12)
    assert outputs.relative_velocity == outputs.impactor_velocity == 0.0
    assert component.step(1e3).events == ()
    moved = component.step(1e-3, external_force=1.0).outputs
    assert moved.phase != "resting" and moved.impactor_displacement > outputs.impactor_displacement
    pressed = component.step(1.0, external_force=1.0).outputs
    assert pressed.phase == "resting" and pressed.contact_force == pytest.approx(case.mass * 9.80665 + 1.0, rel=1e-12)
    lifted = component.step(1e-2, external_force=-1.0)
    assert [event.name for event in lifted.events][-1] == "contact_ends" and lifted.outputs.phase == "separated"


def test_an_impact_that_ends_at_rest():
    """`vibration.run` with a limit that is not reached; its record can be sampled at any time."""
    case = on(FADING, **{"effects.gravity": True, "impactor.velocity": "1 mm/s"})
    problem = problem_of(case)
    structure = structures.structure_of(case.target, 1e5, problem.scales.time)
    found = vibration.run(problem, structure, 1e-6, 10.0)
    assert found.outcome is Outcome.RESTING and found.segments["h"][-1] == math.inf
    last = found.segments["time"][-1] / found.unit
    values, branch = found.sample(np.array([0.999999 * last, last, 1e6 * last]))
    assert values[1, 2] == values[2, 2] == pytest.approx(problem.load, rel=1e-12)
    assert values[0, :3:2] == pytest.approx(values[1, :3:2], rel=1e-5) and set(branch) == {0}
    assert found.energies == pytest.approx(
        0.5 * problem.load**2 * found.tables.share * problem.mass / (found.frequency * found.unit) ** 2
    )


def test_a_ball_that_only_touches_waits_until_it_is_pushed():
    case = on(RINGING, **{"impactor.velocity": "0 m/s"})
    component = fm.ImpactComponent(case)
    still = component.step(1.0)
    assert still.events == () and still.outputs.phase == "approaching" and still.outputs.contact_force == 0.0
    pushed = component.step(1e-4, external_force=10.0)
    assert pushed.events[0].name == "contact_begins" and pushed.events[0].time == 1.0
    assert pushed.outputs.contact_force > 0.0


def test_hundreds_of_contacts_in_one_step():
    """A steady force holds the ball at a beam; impactor and beam have the work of the force at every contact."""
    component = fm.ImpactComponent(SCENES["a beam, three contacts"])
    result = component.step(0.2, external_force=0.5)
    assert result.outputs.contact_count > 100
    assert all(event.contact_force >= 0.0 for event in result.events)
    times = [event.time for event in result.events]
    assert times == sorted(times)


@pytest.mark.slow
def test_a_hundred_thousand_steps_do_not_drift():
    whole, parts = (fm.ImpactComponent(SCENES["stages"]) for _ in range(2))
    expected = whole.step(5e-4).outputs
    for _ in range(100_000):
        parts.step(5e-9)
    scale = np.abs(values(expected)).max() + np.abs(values(expected))
    assert (np.abs(values(parts.outputs) - values(expected)) < 1e-10 * scale).all()


def test_options_without_meaning_are_said():
    with pytest.warns(fm.ImpactWarning, match="segments and linearisation are not used"):
        component = fm.ImpactComponent(on(RINGING), segments=20)
    assert component.modes == 3
