"""Oblique impact through `simulate`: moments of inertia, and hard cases."""

import pytest

import film_model as fm

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
