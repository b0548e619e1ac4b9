"""Friction as a table over the sliding speed, in scenes: one impact, batches, components, files and refusals."""

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_model.core import springs
from film_model.scene.rolling import sliding_of
from film_model.solve.batch import simulate_many

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
TABLE = [["0 m/s", 0.5], ["1 m/s", 0.2], ["3 m/s", 0.1]]


def slanted(angle, friction=None, law="hertz", target=None):
    ball = fm.Sphere("5 mm", "3 m/s", material=STEEL, angle=angle)
    contact = fm.Contact(law, friction=TABLE if friction is None else friction)
    return fm.Scene(ball, target or fm.HalfSpace(STEEL), contact, fm.Effects(gravity=False))


@pytest.mark.parametrize("angle", ["10 deg", "40 deg", "75 deg"])
def test_one_impact_a_batch_and_a_component_agree(angle):
    history = fm.simulate(slanted(angle), accuracy=1e-7)
    found, given = history.oblique, sliding_of(history.scene)
    after, error = found.summary["contact_point_rebound_velocity"], found.estimated + 2e-4
    many = fm.simulate_batch(slanted(angle), velocity=["3 m/s", "1 m/s"]).oblique
    assert many["contact_point_rebound_velocity"][0] == pytest.approx(after, abs=error * given.velocity)
    assert many["sliding_regime"][0] == found.sliding_regime
    component = fm.ImpactComponent(slanted(angle), accuracy=1e-7)
    component.step(1.01 * history.duration)
    assert component.sliding.sliding_velocity == pytest.approx(after, abs=error * given.velocity)
    assert found.summary["impact_number"] == pytest.approx(
        given.velocity / (given.ratio * given.table.at(given.velocity) * history.scene.approach_velocity)
    )


@pytest.mark.parametrize("law", ["hertz", "elastoplastic"])
def test_sliding_throughout_is_closed(law):
    """v' = −µ(v) over the normal impulse (1 + e) m V_n; within the estimate of the springs beside it."""
    history = fm.simulate(slanted("75 deg", law=law, target=fm.HalfSpace("mild steel")), accuracy=1e-9)
    found, given, scene = history.oblique, sliding_of(history.scene), history.scene
    impulse = (1.0 + history.summary["coefficient_of_restitution"]) * scene.mass * scene.approach_velocity
    exact = springs.slid(given.pairs, given.velocity, impulse / given.mass)
    assert found.sliding_regime == "slides throughout"
    assert found.summary["contact_point_rebound_velocity"] == pytest.approx(exact, rel=1e-12)
    assert found.motion["sliding_velocity"][-1] == pytest.approx(exact, abs=2e-6 * given.velocity)


def test_friction_stays_within_the_limit_of_its_speed_and_alike_rows_are_a_coefficient():
    motion = fm.simulate(history_scene := slanted("30 deg"))
    speed = np.abs(motion.oblique.motion["sliding_velocity"])
    limit = sliding_of(history_scene).table.at(speed) * motion.sample_si(motion.oblique.motion["time"]).contact_force
    assert (np.abs(motion.oblique.motion["friction_force"]) <= limit * (1.0 + 1e-3) + 1e-9).all()
    alike, one = (
        fm.simulate(slanted("30 deg", friction)).oblique for friction in ([["0 m/s", 0.2], ["1 m/s", 0.2]], 0.2)
    )
    after = one.summary["contact_point_rebound_velocity"]
    before = one.motion["sliding_velocity"][0]
    assert alike.summary["contact_point_rebound_velocity"] == pytest.approx(after, abs=alike.estimated * before)


def test_what_a_sweep_varies():
    """Angles under the table, and coefficients in its place."""
    scene = slanted("30 deg")
    angles, coefficients = np.radians([30.0, 75.0]), np.array([0.1, 0.3])
    over, constant = (
        simulate_many(scene, {path: values}).oblique.summary["rebound_spin"]
        for path, values in (("impactor.angle", angles), ("contact.friction", coefficients))
    )
    assert over[0] == pytest.approx(fm.simulate(scene).oblique.summary["rebound_spin"], rel=1e-3)
    exact = fm.simulate(slanted("30 deg", 0.3)).oblique.summary["rebound_spin"]
    assert constant[1] == pytest.approx(exact, rel=1e-7)


def test_a_scene_file_keeps_it():
    scene = slanted("30 deg")
    assert fm.Scene.from_text(scene.to_toml(), "scene") == scene
    assert "friction=[['0.0 m/s', 0.5], ['1.0 m/s', 0.2], ['3.0 m/s', 0.1]]" in repr(scene.contact)
    assert any("coefficient of 0.1 to 0.5" in str(effect) for effect in fm.simulate(scene).effects)


@pytest.mark.parametrize(
    ("friction", "sentence"),
    [
        ([["0 m/s", 0.2]], "at least two pairs"),
        ([0.2, 0.3], "at least two pairs"),
        ([["1 m/s", 0.2], ["1 m/s", 0.3]], "pair 2: 1 m/s must be > 1 m/s, that of the pair before"),
        ([["0 m/s", 0.2], ["1 m", 0.3]], "velocity"),
        ([["0 m/s", 0.2], ["1 m/s", -0.3]], "must be >= 0"),
    ],
)
def test_a_wrong_table_is_refused_in_a_sentence(friction, sentence):
    with pytest.raises(fm.SceneError, match=sentence):
        fm.Contact("hertz", friction=friction)


@pytest.mark.filterwarnings("ignore::film_model.ImpactWarning")
def test_what_has_one_coefficient_only_refuses_a_table():
    scene = slanted("30 deg")
    with pytest.raises(fm.SceneError, match="the scene has no number to begin with: give one"):
        fd.identify(fd.load("oblique_impacts"), scene, ["contact.friction"])
    with pytest.raises(fm.SceneError, match="is a table: there is no derivative by it"):
        fm.simulate(scene, derivatives=["contact.friction"])
