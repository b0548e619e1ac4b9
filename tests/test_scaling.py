"""A scene in other units is the same scene."""

import math

import pytest
from cases import LAWS, RADIUS, VELOCITY, YIELD

import film_model as fm
from film_model.solve.history import SUMMARY


def scaled_scene(law, target, length, mass):
    """The paper's ball with lengths × length and masses × mass at equal pressures; gravity does not scale."""
    speed = VELOCITY * length * math.sqrt(length / mass)

    def material(modulus, ratio, density, strength=None):
        return fm.Material("scaled", f"{modulus} GPa", ratio, f"{density * mass / length**3!r} kg/m^3", strength)

    ball = fm.Sphere(
        f"{RADIUS * length!r} m",
        velocity=f"{speed!r} m/s",
        mass=f"{0.06074 * mass!r} kg",
        material=material(600, 0.28, 14500),
    )
    steel = material(210, 0.30, 7850, f"{YIELD!r} Pa")
    against = {
        "half-space": lambda: fm.HalfSpace(steel),
        "plate": lambda: fm.Plate(steel, thickness=f"{0.014 * length!r} m"),
        "rod": lambda: fm.Rod(steel, diameter=f"{0.03 * length!r} m"),
        "body": lambda: fm.Body(steel, radius=f"{0.015 * length!r} m"),
    }[target]()
    return fm.Scene(ball, against, contact=fm.Contact(law=law), effects=fm.Effects(gravity=False))


@pytest.mark.parametrize("target", ["half-space", "plate", "rod", "body"])
@pytest.mark.parametrize("law", ["hertz", "big-alabo", "stronge"])
@pytest.mark.parametrize(("length", "mass"), [(1e-6, 1e-18), (1e2, 1e6), (1e-3, 1e-8)])
def test_scaling_changes_nothing_but_the_units(law, target, length, mass):
    """At the same pressures forces scale with length², energies with length³, times with √(mass/length)."""
    assert law in LAWS
    time = math.sqrt(mass / length)
    units = {"length": length, "time": time, "force": length**2, "velocity": length / time, "energy": length**3}
    units["impulse"] = length**2 * time
    plain = fm.simulate(scaled_scene(law, target, 1.0, 1.0), accuracy=1e-8)
    scaled = fm.simulate(scaled_scene(law, target, length, mass), accuracy=1e-8)
    assert scaled.accuracy.lines == plain.accuracy.lines
    energy = plain.scene.kinetic_energy
    for name, value in plain.summary.items():
        other, factor = scaled.summary[name], units.get(SUMMARY[name][0], 1.0)
        if value is None:
            assert other is None, name
        else:
            slack = 1e-13 * energy if "energy" in name else 1e-20
            assert other / factor == pytest.approx(value, rel=1e-11, abs=slack), name
