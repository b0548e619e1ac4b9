"""Friction and spin of a component in steps: against simulate, balances, several contacts, saved states, refusals."""

import math

import pytest
from scipy.integrate import trapezoid

import film_model as fm


def scene(law="hertz", psi=2.0, friction=0.2, target=None, spin=None, **entries):
    """A steel ball at the angle at which its impact number is about psi."""
    angle = math.atan(1.21 * friction * psi)
    ball = fm.Sphere(radius="10 mm", velocity="0.5 m/s", material="bearing steel", angle=f"{angle} rad", spin=spin)
    contact = fm.Contact(law=law, friction=friction, **entries)
    effects = fm.Effects(gravity=False, wave_losses=False)
    return fm.Scene(ball, target or fm.HalfSpace("bearing steel"), contact=contact, effects=effects)


def after(on, steps=1, **pushes):
    history = fm.simulate(on, accuracy=1e-8)
    component = fm.ImpactComponent(on, accuracy=1e-8)
    for _ in range(steps):
        component.step(1.01 * history.duration / steps, **pushes)
    return history, component


@pytest.mark.parametrize("psi", [0.3, 0.9, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("steps", [1, 37])
def test_a_component_slides_as_simulate_does(psi, steps):
    history, component = after(scene(psi=psi), steps)
    found, exact = component.sliding, history.oblique.summary
    before = history.oblique.motion["sliding_velocity"][0]
    assert found.sliding_velocity == pytest.approx(exact["contact_point_rebound_velocity"], abs=2e-5 * before)
    assert found.tangential_velocity == pytest.approx(exact["tangential_rebound_velocity"], abs=1e-5 * before)
    assert found.spin * 0.01 == pytest.approx(exact["rebound_spin"] * 0.01, abs=2e-5 * before)
    assert found.friction_work == pytest.approx(exact["friction_work"], rel=2e-4)
    assert found.friction_force == 0.0


@pytest.mark.parametrize(
    ("law", "entries"), [("elastoplastic", {}), ("big-alabo", {}), ("tsuji", {"restitution": 0.8})]
)
@pytest.mark.parametrize("psi", [1.0, 3.0])
def test_laws_that_lose_energy_are_near_simulate(law, entries, psi):
    """Its springs have the law's own contact radius, and ends of steps; 0.1 % of the sliding velocity before apart."""
    history, component = after(scene(law, psi, **entries))
    exact, before = history.oblique, history.oblique.motion["sliding_velocity"][0]
    low, high = (
        (exact.low, exact.high) if exact.low is not None else [exact.summary["contact_point_rebound_velocity"]] * 2
    )
    assert low - 1e-3 * before < component.sliding.sliding_velocity < high + 1e-3 * before


def test_the_normal_motion_is_that_without_friction_to_the_bit():
    on = scene("elastoplastic", target=fm.Plate("bearing steel", thickness="8 mm"))
    _, component = after(on)
    _, plain = after(on.replace({"contact.friction": None}))
    assert component.outputs == plain.outputs and plain.sliding is None


def test_friction_stays_within_its_limit_and_what_acts_is_balanced():
    history, _ = after(scene(psi=0.7))
    component = fm.ImpactComponent(scene(psi=0.7))
    mass, radius = history.scene.mass, 0.01
    inertia, h = 0.4 * mass * radius**2, history.duration / 200
    begun, gained = component.sliding, 0.0
    for n in range(240):
        force, torque = 3.0 * math.sin(n / 9.0), 0.02 * math.cos(n / 7.0)
        component.step(h, tangential_force=force, torque=f"{torque} N m", tangential_support_velocity=0.01 * (n % 3))
        now, gained = component.sliding, gained + force * h
        assert abs(now.friction_force) <= 0.2 * component.outputs.contact_force * (1.0 + 1e-12)
        moved = mass * (now.tangential_velocity - begun.tangential_velocity) + now.tangential_impulse
        assert moved == pytest.approx(gained, abs=1e-13 * mass)
        along = now.tangential_velocity + radius * now.spin - 0.01 * (n % 3)
        assert now.sliding_velocity == pytest.approx(along, abs=1e-12)
    assert inertia > 0.0 and component.phase == "separated"


def test_a_ball_bounces_on_with_its_spin_until_it_rolls():
    """Under weight it comes down again and again; without torque and at rest sliding ends at 5/7 of the velocity."""
    on = scene(psi=6.0).replace({"impactor.velocity": "0.3 m/s"})
    component = fm.ImpactComponent(on)
    begun, weight, works = component.sliding, 9.80665 * on.mass, [0.0]
    for _ in range(12):
        component.step("3 ms", external_force=20.0 * weight)
        works.append(component.sliding.friction_work)
    now = component.sliding
    assert component.outputs.contact_count > 5
    assert works == sorted(works)
    assert now.tangential_velocity == pytest.approx(begun.tangential_velocity * 5.0 / 7.0, rel=0.02)
    assert abs(now.sliding_velocity) < 0.02 * begun.sliding_velocity
    lost = 0.5 * on.mass * (begun.tangential_velocity**2 - now.tangential_velocity**2)
    assert now.friction_work == pytest.approx(lost - 0.2 * on.mass * (0.01 * now.spin) ** 2, rel=1e-6)


def assert_restored(component, time):
    """The same motion from a saved state."""
    saved = component.save()
    component.step(time)
    first = component.sliding
    component.restore(saved)
    component.step(time)
    assert component.sliding == first


def test_a_saved_state_leads_to_the_same_motion():
    history, _ = after(scene(psi=0.7))
    component = fm.ImpactComponent(scene(psi=0.7))
    component.step(0.4 * history.duration, tangential_force=2.0, tangential_support_velocity=0.01)
    assert_restored(component, history.duration)
    component.reset()
    assert component.sliding == fm.ImpactComponent(scene(psi=0.7)).sliding


def test_springs_that_are_too_few_are_doubled():
    """At 30 times the velocity of the scene the contact is much wider than its springs reach at first."""
    slow = scene(psi=0.7)
    fast = slow.replace({"impactor.velocity": "15 m/s"})
    component = fm.ImpactComponent(fast, accuracy=1e-6)
    history = fm.simulate(fast, accuracy=1e-6)
    component.step(1.01 * history.duration)
    before = history.oblique.motion["sliding_velocity"][0]
    exact = history.oblique.summary["contact_point_rebound_velocity"]
    assert component.sliding.sliding_velocity == pytest.approx(exact, abs=3e-5 * before)


@pytest.mark.parametrize(
    ("entries", "sentence"),
    [
        (
            {"contact.law": "jkr", "contact.work_of_adhesion": "0.1 J/m^2"},
            "friction under adhesion that pulls is not supported",
        ),
        ({"contact.effective_modulus": "100 GPa"}, "friction needs Young's modulus and Poisson's ratio of both bodies"),
    ],
)
def test_what_has_no_friction_in_steps_is_refused(entries, sentence):
    with pytest.raises(fm.SimulationError, match=sentence):
        fm.ImpactComponent(scene().replace(entries))


@pytest.mark.parametrize("law", ["hertz", "elastoplastic"])
@pytest.mark.parametrize("psi", [0.3, 1.5, 3.0, 4.7, 8.0])
def test_phases_are_those_of_the_exact_motion(law, psi):
    """Within 1 % of the duration; elastic in its dent, a ball sticks and slips as one on a half-space."""
    history, _ = after(scene(psi=psi))
    component, begun = fm.ImpactComponent(on := scene(law, psi)), []
    phases = [component.sliding.phase]
    duration = fm.simulate(on).duration
    for _ in range(9):
        begun += component.step(1.02 * duration / 9).sliding
        phases.append(component.sliding.phase)
    assert [name for _, name in begun] == [name for _, name in history.oblique.events]
    times = [time / history.duration for time, _ in history.oblique.events]
    assert [time / duration for time, _ in begun] == pytest.approx(times, abs=0.01)
    assert phases[0] == phases[-1] == "free" and set(phases[1:-1]) <= {"sticks", "slips", "slides"}


@pytest.mark.parametrize("psi", [0.7, 8.0])
def test_on_a_beam_that_vibrates(psi):
    """Within the estimate of simulate, whatever the steps; the normal motion is that without friction, to the bit."""
    beam = fm.Beam("bearing steel", length="200 mm", width="20 mm", thickness="5 mm", position="90 mm")
    on = scene(psi=psi, target=beam)
    history, component = fm.simulate(on, accuracy=1e-5), fm.ImpactComponent(on, accuracy=1e-5)
    component.step(1.01 * history.duration)
    found, before = history.oblique, history.oblique.motion["sliding_velocity"][0]
    error = found.estimated * before
    exact = found.summary["contact_point_rebound_velocity"]
    assert component.sliding.sliding_velocity == pytest.approx(exact, abs=error) and error < 3e-3 * before
    assert component.sliding.friction_work == pytest.approx(found.summary["friction_work"], rel=2e-3)
    assert component.outputs.contact_count > 1
    plain = fm.ImpactComponent(on.replace({"contact.friction": None}), accuracy=1e-5)
    plain.step(1.01 * history.duration)
    assert component.outputs == plain.outputs
    short = fm.ImpactComponent(on, accuracy=1e-5)
    for _ in range(7):
        short.step(1.01 * history.duration / 7)
    assert short.sliding.sliding_velocity == pytest.approx(component.sliding.sliding_velocity, abs=1e-5 * before)
    component.reset()
    assert_restored(component, history.duration)


@pytest.mark.parametrize(("law", "entries"), [("hertz", {}), ("elastoplastic", {}), ("tsuji", {"restitution": 0.8})])
def test_contacts_that_are_short_beside_the_flights_between_them(law, entries):
    """A light ball meets a slow structure three times, for a thousandth of the time: each contact has its own steps."""
    soft = {"frequency": ["120 Hz", "410 Hz"], "modal_mass": ["3e-7 kg", "3e-7 kg"]}
    on = scene(law, 3.0, target=fm.Structure(material="bearing steel", **soft), **entries)
    on = on.replace({"impactor.radius": "0.2 mm"})
    history, component = fm.simulate(on, accuracy=1e-5), fm.ImpactComponent(on, accuracy=1e-5)
    component.step(1.0001 * history.duration)
    found, motion = history.oblique, history.oblique.motion
    sign = {"contact_begins": -1.0, "contact_ends": 1.0}
    touching = [sign[event.name] * event.time for event in history.events if event.name in sign]
    assert len(touching) > 2 and sum(touching) < 2e-3 * history.duration
    before, exact = motion["sliding_velocity"][0], found.summary["contact_point_rebound_velocity"]
    yields = (found.high or exact) - (found.low or exact)
    error = found.estimated * before + yields + (1e-5 if law == "hertz" else 1e-3) * before
    assert component.sliding.sliding_velocity == pytest.approx(exact, abs=error) and found.estimated < 1e-3
    assert component.sliding.tangential_impulse == pytest.approx(found.summary["tangential_impulse"], rel=2e-3)
    assert found.summary["friction_work"] > 0.0 and found.summary["maximum_friction_force"] > 0.0
    assert found.summary["maximum_friction_force"] <= 0.2 * history.summary["maximum_force"]
    impulse = trapezoid(motion["friction_force"], motion["time"])
    assert impulse == pytest.approx(found.summary["tangential_impulse"], rel=1e-4)


def test_pushes_without_friction_are_refused():
    plain = fm.ImpactComponent(scene().replace({"contact.friction": None}))
    with pytest.raises(ValueError, match=r"need contact\.friction"):
        plain.step(1e-6, torque="1 N m")


def test_the_work_of_a_step_is_bounded():
    """A ball under its weight bounces for ever: after 400,000 steps of friction its step is refused."""
    given = scene("hertz").replace({"effects.gravity": True, "impactor.velocity": "1 mm/s"})
    component = fm.ImpactComponent(given)
    with pytest.raises(fm.SimulationError, match="shorter step"):
        component.step(1e3)
    component.step(1e-6)  # each step has its own work
