"""Oblique impact through `simulate`: moments of inertia, and hard cases."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.core import friction, native
from film_model.core.springs import radii
from film_model.oblique.friction import oblique_of
from film_model.solve.simulate import simulate_quietly

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}


def slanted(angle="30 deg", mu=0.2, material=STEEL, **ball):
    sphere = fm.Sphere("5 mm", "3 m/s", material=material, angle=angle, **ball)
    return fm.Scene(sphere, fm.HalfSpace(material), fm.Contact("hertz", friction=mu), fm.Effects(gravity=False))


def test_a_moment_of_inertia_of_another_body():
    """Equal to that of a ball or a shell it gives their results; a smaller one makes the impactor turn faster."""
    ball = slanted()
    size = ball.mass * ball.impactor.radius**2
    for shape, number in (("solid", 0.4), ("shell", 2.0 / 3.0)):
        given = fm.simulate(slanted(inertia=f"{number * size!r} kg m^2")).oblique.summary
        assert given == pytest.approx(fm.simulate(slanted(shape=shape)).oblique.summary, rel=1e-9)
    dice = slanted(inertia=f"{0.1 * size * 1e3!r} g m^2")
    assert dice.impactor.inertia_number == pytest.approx(0.1)
    spins = [abs(fm.simulate(one).oblique.summary["rebound_spin"]) for one in (dice, ball)]
    assert spins[0] > spins[1]
    assert fm.Scene.from_text(dice.to_toml()) == dice
    with pytest.raises(fm.SceneError, match=r'Sphere\.inertia: 1e-06 kg m\^2 contradicts shape = "shell", which has 6'):
        slanted(inertia="1e-6 kg*m^2", shape="shell")
    with pytest.raises(fm.SceneError, match=r"Sphere\.inertia: 0\.1 has no unit, a moment of inertia is needed"):
        slanted(inertia=0.1)
    assert slanted(inertia=f"{0.4004 * size!r} kg m^2", shape="solid").impactor.shape == "solid"


def groups(history):
    """ψ₁, ψ₂ and χ of an impact."""
    found, scene = history.oblique.summary, history.scene
    ball = scene.impactor
    before = ball.path_speed * math.sin(ball.angle or 0.0) + (ball.spin or 0.0) * ball.radius
    after = found["contact_point_rebound_velocity"] * found["impact_number"] / before
    return found["impact_number"], after, found["tangential_parameter"]


def at(number, ratio=0.3, mu=0.2, **ball):
    """The impact with ψ₁ = number: tan α = ψ₁ κ µ, κ = (2 − ν)/(2 (1 − ν))."""
    kappa = (2.0 - ratio) / (2.0 * (1.0 - ratio))
    material = {**STEEL, "poissons_ratio": ratio}
    return fm.simulate(slanted(f"{math.atan(number * kappa * mu)!r} rad", mu, material, **ball))


def chi_of(ratio):
    return 7.0 * (1.0 - ratio) / (2.0 * (2.0 - ratio))


@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.499])
def test_the_groups_follow_from_the_scene(ratio):
    before, _, chi = groups(at(2.0, ratio))
    assert (before, chi) == pytest.approx((2.0, chi_of(ratio)), rel=1e-9)


@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.499])
def test_where_sliding_throughout_begins(ratio):
    """ψ₁ = 4χ − 1: ψ₂ = −1, without a jump."""
    corner = 4.0 * chi_of(ratio) - 1.0
    for step in (-1e-4, 0.0, 1e-4):
        history = at(corner + step, ratio)
        assert groups(history)[1] == pytest.approx(-1.0 + step, abs=2e-4)
        assert step <= 0.0 or history.oblique.sliding_regime == "slides throughout"


@pytest.mark.parametrize(("ratio", "expected"), [(0.0, 0.3869), (0.3, 0.2314)])
def test_hardly_any_angle(ratio, expected):
    """ψ₁ → 0: ψ₂/ψ₁ tends to a limit."""
    before, after, _ = groups(at(2e-3, ratio))
    assert after / before == pytest.approx(expected, abs=5e-3)


def test_the_first_touch_sticks_below_one_and_slides_above():
    below, above = at(1.0 - 1e-4), at(1.0 + 1e-4)
    assert (below.oblique.sliding_regime, above.oblique.sliding_regime) == ("sticks first", "slides first")
    assert groups(below)[1] == pytest.approx(groups(above)[1], abs=1e-3)


def test_friction_that_vanishes_and_friction_that_is_large():
    """µ → 0: the impulse is that of sliding, 2 µ m V_n; µ → ∞: as ψ₁ → 0, and the result no longer depends on µ."""
    weak = fm.simulate(slanted(mu=1e-6))
    normal = 2.0 * weak.scene.mass * weak.scene.approach_velocity
    assert weak.oblique.summary["tangential_impulse"] == pytest.approx(1e-6 * normal, rel=1e-5)
    strong = [fm.simulate(slanted("20 deg", mu)).oblique.summary["rebound_spin"] for mu in (50.0, 100.0)]
    assert strong[0] == pytest.approx(strong[1], rel=2e-3)


def test_spin_that_cancels_the_velocity_and_spin_near_it():
    """Nothing slides: no friction. Close to it the impulse is small and keeps its sign."""
    ball = slanted()
    spin = -ball.impactor.path_speed * math.sin(ball.impactor.angle) / ball.impactor.radius
    assert fm.simulate(slanted(spin=f"{spin!r} rad/s")).oblique is None
    for share in (1.0 + 1e-3, 1.0 - 1e-3):
        found = fm.simulate(slanted(spin=f"{share * spin!r} rad/s")).oblique.summary
        assert found["tangential_impulse"] * (1.0 - share) > 0.0
        assert found["friction_work"] >= 0.0


def test_mirror_images_of_the_sliding_velocity():
    """ψ₂(−ψ₁) = −ψ₂(ψ₁): back spin that turns the sliding round."""
    ball = slanted()
    speed = ball.impactor.path_speed * math.sin(ball.impactor.angle)
    forward = fm.simulate(ball).oblique.summary
    back = fm.simulate(slanted(spin=f"{-2.0 * speed / ball.impactor.radius!r} rad/s")).oblique.summary
    for name in ("contact_point_rebound_velocity", "tangential_impulse", "impact_number"):
        assert back[name] == pytest.approx(-forward[name], rel=1e-7)
    assert back["friction_work"] == pytest.approx(forward["friction_work"], rel=1e-7)


def test_grazing():
    """At 89.9° friction takes 2 µ/tan α of the tangential velocity."""
    history = fm.simulate(slanted("89.9 deg", material=STEEL))
    share = 1.0 - 0.4 / math.tan(math.radians(89.9))
    assert history.oblique.sliding_regime == "slides throughout"
    assert history.oblique.summary["tangential_restitution"] == pytest.approx(share, rel=1e-7)


def test_the_shape_of_the_rebound():
    """ν = 0.3: the maximum, the zero and the minimum of ψ₂."""
    for before, after in ((0.4168, 0.050018), (0.809919, 0.0), (3.6166, -1.481162)):
        assert groups(at(before))[1] == pytest.approx(after, abs=1e-6)
        if after != 0.0:
            sides = [groups(at(before * factor))[1] for factor in (0.97, 1.03)]
            assert all(abs(side) < abs(after) for side in sides)


def test_radii_of_a_contact_that_yields():
    """The law's in loading and a ball's in its dent, however the last force is rounded; and F' = 2 E* a."""
    depth = np.concatenate([np.linspace(0.0, 1.0, 201) ** 2, np.linspace(1.0, 0.4, 100)[1:]])
    force, law = depth**1.5, np.where(depth > 0.0, 0.9 * np.sqrt(depth), np.nan)
    force[201:] = np.linspace(1.0, 0.0, 100)[1:]
    first, second = radii(force, depth, law, 0.75)
    assert np.array_equal(first[:201], 0.9 * np.sqrt(depth[:201]))
    assert second[:200] == pytest.approx(np.sqrt(depth[:200]), abs=3e-3)
    assert second[201:-1] == pytest.approx(1.0 / (0.6 * 1.5), rel=1e-12) and second[199] < second[200] < second[201]
    assert first[201:] == pytest.approx(0.9 * np.sqrt((depth[201:] - 0.4) / 0.6), abs=1e-15)
    force[-1] = 1e-21
    assert np.array_equal(radii(force, depth, law, 0.75)[0], first)


def test_radii_of_contacts_that_follow_each_other():
    """A later contact changes nothing before it; it is in the dent as far as that is deep, beyond it the law's."""
    way = np.linspace(0.0, 1.0, 101)
    rows = []
    for begin, top, end in ((0.0, 1.0, 0.4), (0.4, 0.8, 0.4), (0.4, 1.5, 0.6)):
        depth = np.concatenate([begin + (top - begin) * way, end + (top - end) * way[-2::-1]])
        force = np.concatenate([depth[:101] - begin, np.maximum(2.0 * (depth[101:] - end), 0.0)])
        rows.append((force, depth, 0.9 * np.sqrt(depth)))
    force, depth, law = (np.concatenate(column) for column in zip(*rows, strict=True))
    found = [radius.reshape(3, -1) for radius in radii(force, depth, law, 0.75, contacts=3)]
    for several, alone in zip(found, radii(*rows[0], 0.75), strict=True):
        assert np.array_equal(several[0], alone)
    in_dent = 0.9 * np.sqrt(np.maximum(depth.reshape(3, -1) - 0.4, 0.0) / 0.6)
    assert found[0][1, 1:-1] == pytest.approx(in_dent[1, 1:-1], abs=1e-14)
    beyond = rows[2][1] > 1.0
    assert found[0][2, 1:101] == pytest.approx(np.where(beyond, rows[2][2], in_dent[2])[1:101], abs=1e-14)


def test_the_motion_in_a_contact_does_not_depend_on_later_ones():
    ball = fm.Sphere("10 mm", "2 m/s", material="bearing steel", angle="25 deg")
    law = fm.Contact("thornton", yield_pressure="1 GPa", friction=0.2)
    history = simulate_quietly(fm.Scene(ball, fm.Beam("mild steel", "200 mm", "40 mm", "4 mm"), law))
    times = [[e.time for e in history.events if e.name == f"contact_{what}"] for what in ("begins", "ends")]
    first = [column[:1] for column in times]
    alone = oblique_of(history.scene, history.problem, history.rebound_velocity.m, history.sample_si, first, 1e-6)
    assert len(times[0]) == 2
    peaks = [history.sample_si(np.linspace(*ends, 200)).indentation.max() for ends in zip(*times, strict=True)]
    assert peaks[1] > peaks[0]
    count = alone.motion["time"].size
    for name in ("sliding_velocity", "friction_force"):
        assert np.array_equal(history.oblique.motion[name][:count], alone.motion[name])


def test_the_bodies_are_apart_before_the_deepest_contact():
    """The indentation is negative there: on a bracket that vibrates, the second contact is the deepest."""
    ball = {"radius": "5 mm", "velocity": "1 m/s", "mass": "20 g", "material": "bearing steel", "angle": "0.5 rad"}
    target = {"kind": "structure", "frequency": ["1.8 kHz", "4.1 kHz"], "modal_mass": ["20 g", "30 g"]}
    contact = {"law": "elastoplastic", "friction": 0.2}
    table = {"impactor": ball, "target": target | {"material": "mild steel"}, "contact": contact}
    history = simulate_quietly(fm.Scene.from_table(table), accuracy=0.01)
    times = np.linspace(0.0, history.duration, 500)
    depth = history.sample_si(times).indentation
    assert depth[: depth.argmax()].min() < 0.0
    assert history.oblique.summary["friction_work"] > 0.0


@pytest.mark.parametrize("exponent", [1.0, 1.2, 2.0, 3.0])
@pytest.mark.parametrize("psi", [0.5, 1.5, 3.0])
def test_springs_of_any_power_law_follow_its_exact_motion(exponent, psi):
    """In records, under a table with one coefficient, and in steps; under a linear law all springs are as one."""
    stiffness = f"{40e6 * 20e-6 ** (1.0 - exponent)!r} N/m^{exponent}"
    contact = fm.Contact("meyer", stiffness=stiffness, exponent=exponent, friction=0.2)
    on = slanted(f"{math.atan(1.2143 * 0.2 * psi)!r} rad")
    on = fm.Scene(on.impactor, on.target, contact, on.effects)
    history, table = fm.simulate(on), fm.simulate(on.replace({"contact.friction": [["0 m/s", 0.2], ["1 m/s", 0.2]]}))
    component = fm.ImpactComponent(on, accuracy=1e-7)
    component.step(1.01 * history.duration)
    exact, before = history.oblique, history.oblique.motion["sliding_velocity"][0]
    after = exact.summary["contact_point_rebound_velocity"]
    found = table.oblique
    assert found.summary["contact_point_rebound_velocity"] == pytest.approx(after, abs=found.estimated * before)
    assert found.estimated < 1e-3 and found.sliding_regime == exact.sliding_regime
    assert component.sliding.sliding_velocity == pytest.approx(after, abs=3e-4 * before)


@pytest.mark.parametrize(("psi", "expected"), [(0.5, 0.184567753), (1.5, -0.339308323), (3.0, -1.368026457)])
def test_a_linear_dashpot_that_hardly_damps_is_a_flat_punch(psi, expected):
    """Its springs along the surface are one spring and one slider."""
    angle = math.atan(psi * 1.7 / 1.4 * 0.2)
    ball = fm.Sphere("5 mm", f"{0.5 / math.cos(angle)!r} m/s", material=STEEL, angle=f"{angle!r} rad")
    contact = fm.Contact("linear-dashpot", stiffness="40 MN/m", restitution=0.99999, friction=0.2)
    on = fm.Scene(ball, fm.HalfSpace(STEEL), contact, fm.Effects(gravity=False))
    found = fm.simulate(on).oblique.summary
    after = found["contact_point_rebound_velocity"] / (1.7 / 1.4 * 0.2 * 0.5)
    assert found["impact_number"] == pytest.approx(psi, rel=1e-9)
    assert after == pytest.approx(expected, abs=1e-4)


def test_slow_impacts_under_a_load_end():
    """Where slip comes back to the end of the first slip its steps shrink without limit: that piece is over then."""
    slow = friction.Normal(0.0, 1.0, 1.8, 7.48696425877965e-4, 0.0, 0.016062736278909136)
    _, result, _ = friction.impact(slow, 2.9302325581395343, 8.516636559239409e-4)
    assert [kind for _, kind in result.events][-1] == friction.SLIDES and result.steps < 200
    many = np.array([tuple(getattr(slow, name) for name in friction.NORMAL_DTYPE.names)], friction.NORMAL_DTYPE)
    for level in (friction.EXACT, friction.COARSE, friction.QUICK):
        found = friction.many(many, np.array([2.9302325581395343]), np.array([8.516636559239409e-4]), level)
        assert found["status"][0] == native.OK
        assert found["velocity"][0] == pytest.approx(result.velocity, abs=max(friction.ERRORS[level], 1e-8) * 8.5e-4)
