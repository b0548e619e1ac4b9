"""Rods of finite length: waves that return from the far end, by their vibrations."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.effects.choose import choose
from film_model.targets.rod_modes import rod_compliance, rod_modes

STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")


def velocity(modes, time):
    """Of the struck end under a force of 1 N that begins at 0, with Lanczos' factors against Gibbs' oscillations."""
    bends = modes.frequency > 0.0
    rate = np.where(bends, modes.frequency, 1.0)
    smooth = np.sinc(modes.frequency / modes.frequency[-1]) ** 2
    return float(np.sum(np.where(bends, np.sin(rate * time) / rate, time) * modes.share * smooth))


@pytest.mark.parametrize("behind", [0.0, 0.02, 0.7, 2.0, 6.0, math.inf])
def test_every_reflection_is_exact(behind):
    """Z v/F = 1 + 2 Σ rᵏ after k returns; r = (Z − Z_e)/(Z + Z_e) is the reflection at the far end."""
    modes = rod_modes(2.0, 0.5, behind, 400 * math.pi)
    reflected = -1.0 if math.isinf(behind) else (2.0 - behind) / (2.0 + behind)
    for returns in range(6):
        expected = (1 + 2 * sum(reflected**k for k in range(1, returns + 1))) / 2.0
        for time in (returns + 0.3, returns + 0.7):
            assert velocity(modes, time) == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("behind", [0.0, 0.7, 6.0, math.inf])
def test_the_static_deflection_is_that_of_all_vibrations(behind):
    """The rest beyond n multiples of π is 2/(π² n) L/(EA)."""
    modes = rod_modes(2.0, 0.5, behind, 300 * math.pi / 0.5)
    rest = 2 / (math.pi**2 * 300) * 0.5 / 2.0
    assert rod_compliance(2.0, 0.5, behind) - modes.compliance == pytest.approx(rest, rel=0.02)


def test_a_matched_end_is_an_infinite_rod():
    """No wave returns: the mass of the joined rods is 65 times that of the rod."""
    modes = rod_modes(2.0, 0.5, 2.0, 100.0)
    assert modes.frequency[0] == 0.0 and modes.share[0] == pytest.approx(1 / 65.0, rel=1e-9)


@pytest.mark.slow
def test_the_first_refinement_with_as_many_modes_as_are_allowed_has_an_estimate():
    """No wave returns in time: the rod without an end is the same, and its error is 1e-10."""
    rod = fm.Rod(STEEL, diameter="5.74 mm", length="3.47 m", far_end="18800 N*s/m")
    ball, effects = (
        fm.Sphere("3.75 mm", "1.15 m/s", material=STEEL),
        fm.Effects(boundary_reflections=True, gravity=False),
    )
    scene = fm.Scene(ball, rod, fm.Contact("hertz"), effects)
    with pytest.warns(fm.ImpactWarning, match="accuracy 1e-05 is not reached"):
        history = fm.simulate(scene, accuracy=1e-5)
    exact = fm.simulate(scene.replace({"effects.boundary_reflections": False, "solver.accuracy": 1e-9}))
    errors = [abs(value / exact.summary[name] - 1.0) for name, value in history.summary.items() if value]
    assert 1e-7 < max(errors) < history.accuracy.estimated < 1e-2


def on(**rod):
    ball = fm.Sphere("10 mm", "1 m/s", material=STEEL)
    return fm.Scene(ball, fm.Rod(STEEL, diameter="20 mm", **rod), fm.Contact("hertz"), fm.Effects(gravity=False))


def test_what_is_simulated():
    states = {}
    for length in ("80 mm", "2 m"):
        found = {effect.name: effect for effect in choose(on(length=length, far_end="fixed")).effects}
        states[length] = found["boundary_reflections"].state
    assert states == {"80 mm": "simulated", "2 m": "not needed"}
    assert choose(on(length="80 mm")).problem.vibrates and not choose(on(length="2 m")).problem.vibrates
    short = on(length="80 mm", far_end="fixed").target
    assert short.compliance == pytest.approx(0.08 / (210e9 * math.pi * 1e-4), rel=1e-12) and short.held
    assert not on(length="80 mm").target.held and on(length="80 mm").target.whole_mass == pytest.approx(
        0.1973, rel=1e-3
    )


def test_the_energy_of_a_fixed_rod():
    """The rebound and the vibrations hold the energy of the impact; with a long contact the rod is a spring."""
    summary = fm.simulate(on(length="80 mm", far_end="fixed"), accuracy=1e-2).summary
    energy = 0.5 * on().mass * (1 - summary["rebound_velocity"] ** 2)
    assert summary["energy_radiated"] == pytest.approx(energy, rel=1e-2) and energy > 0


def test_scene_files_and_mistakes():
    for far_end in ("fixed", "500 N*s/m"):
        scene = on(length="80 mm", far_end=far_end, damping_ratio=0.01)
        assert fm.Scene.from_text(scene.to_toml()) == scene
        assert scene.target.modes(1e6).damping_ratio[-1] == 0.01
    for options, message in (
        ({"far_end": "fixed"}, "Rod.far_end: needs a length"),
        ({"length": "1 m", "far_end": "loose"}, 'Rod.far_end: "loose" is not allowed: "free", "fixed" or an impedance'),
        ({"length": "1 m", "far_end": "1 kg"}, 'or an impedance .e.g. "150 N.s/m". is needed'),
        ({"damping_ratio": 0.1}, "Rod.damping_ratio: needs a length"),
    ):
        with pytest.raises(fm.SceneError, match=message):
            on(**options)
    with pytest.raises(fm.SimulationError, match="boundary_reflections is true, but the rod has no length"):
        fm.simulate(on().replace({"effects.boundary_reflections": True}))
