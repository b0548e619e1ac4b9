"""A ball in a hollow: a negative radius of the target, by Hertz's theory a larger ball on a flat."""

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm

BALL = fm.Sphere("10 mm", "0.05 m/s", mass="30 g", material="bearing steel")


def scene(radius):
    return fm.Scene(BALL, fm.HalfSpace("bearing steel", radius=radius), fm.Contact("hertz"), fm.Effects(gravity=False))


def test_a_hollow_is_a_larger_ball():
    found = fm.simulate(scene("-30 mm"))  # 1/(1/10 − 1/30) = 15 mm
    flat = fm.simulate(
        fm.Scene(
            fm.Sphere("15 mm", "0.05 m/s", mass="30 g"),
            fm.HalfSpace(),
            fm.Contact("hertz", effective_modulus=f"{found.scene.effective_modulus} Pa"),
            fm.Effects(gravity=False),
        )
    )
    assert found.summary["maximum_force"] == pytest.approx(flat.summary["maximum_force"], rel=1e-12)
    assert found.summary["contact_radius"] == pytest.approx(flat.summary["contact_radius"], rel=1e-12)
    assert fm.Scene.from_text(found.scene.to_toml()) == found.scene


@pytest.mark.parametrize(
    ("radius", "message"),
    [
        ("-9 mm", r"target\.radius: -9 mm is a hollow: it must be < -10 mm, the ball's"),
        ("0 mm", "must be > 0"),
        ("-2 km", "out of range"),
    ],
)
def test_a_hollow_is_wider_than_the_ball(radius, message):
    with pytest.raises(fm.SceneError, match=message):
        scene(radius)
    with pytest.raises(fm.SceneError, match="must be > 0"):
        fm.Plate("bearing steel", "10 mm", radius="-30 mm")


def test_a_sweep_over_hollows_fails_where_the_ball_does_not_fit():
    ds = fd.sweep(scene("-30 mm"), {"target.radius": ["-30 mm", "-20 mm", "-10 mm", "-5 mm"]}, "zip")
    assert ds.status.values.tolist() == [1, 1, -1, -1]
    assert np.isnan(ds.maximum_force.values[2:]).all()
    assert ds.maximum_force.values[0] == pytest.approx(fm.simulate(scene("-30 mm")).summary["maximum_force"], rel=1e-6)


def test_engines_refuse_a_hollow():
    from film_model.translate.fit import pair_of

    with pytest.raises(fm.SimulationError, match=r"target\.radius: -0\.03 m is a hollow"):
        pair_of(scene("-30 mm"), 0.05, 1e-6)
