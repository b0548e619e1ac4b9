"""The bending stress of a struck plate, against sums over its vibrations and tables of static plates."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.effects.choose import choose
from film_model.targets.bending_strength import bending_stress, reach_of


def moment_by_modes(time: float, side: float, radius: float, stiffness: float, density: float) -> float:
    """Moment/((1 + ν) F) in the centre of a simply supported square plate, under a disc of a force that sets in at 0."""
    wave = np.arange(1.0, 2000.0, 2.0) * math.pi / side
    square = wave[:, None] ** 2 + wave**2
    x = np.sqrt(square) * radius
    spread = np.exp(-(x**2) / 8.0)  # a Gaussian of the same mean square radius as the disc, without its slow tail
    bent = spread * (1.0 - np.cos(math.sqrt(stiffness / density) * square * time)) / square
    return float(0.5 * 4.0 / side**2 * bent.sum())


def test_moment_of_a_sudden_force_is_the_sum_over_the_modes():
    side, radius, stiffness, density = 1.0, 2e-3, 400.0, 10.0
    for time in (1e-4, 4e-4):  # of the edge waves only the fastest have returned
        reach = reach_of(time, stiffness, density)
        # under a Gaussian ⟨ln r²⟩ = ln(radius²/2) - γ, under a disc ln(radius²) - 1
        expected = (math.log(reach / radius) + 0.5 * (math.log(2.0) + 0.5772156649)) / (4.0 * math.pi)
        assert moment_by_modes(time, side, radius, stiffness, density) == pytest.approx(expected, rel=1e-2)


def test_static_stress_is_that_of_tables_for_a_square_plate():
    """Roark: σ = 3 F/(2 π h²) ((1 + ν) ln(2 L/(π c)) + 0.435) for simply supported edges."""
    thickness, wide, ratio = 4e-3, 10e-3, 0.3
    table = 3.0 * 1000.0 / (2.0 * math.pi * thickness**2) * (1.3 * math.log(2.0 * 0.5 / (math.pi * wide)) + 0.435)
    found = bending_stress(1000.0, 2.0 / math.pi * 0.5, wide, thickness, ratio)
    assert found == pytest.approx(table, rel=0.05)


@pytest.mark.parametrize(
    ("velocity", "state", "words"),
    [("0.2 m/s", "not needed", "in an elastic plate"), ("20 m/s", "needed but not modelled", "keeps a dish")],
)
def test_a_sheet_that_yields_in_bending_is_a_warning(velocity: str, state: str, words: str):
    ball = fm.Sphere(diameter="20 mm", velocity=velocity, material="bearing steel")
    choice = choose(fm.Scene(ball, fm.Plate("aluminium 2024-T3", "2 mm")))
    effect = {e.name: e for e in choice.effects}["bending_strength"]
    assert (effect.state, words in effect.reason) == (state, True)
    assert any("bending strength" in warning for warning in choice.warnings) == (state != "not needed")


def test_glass_may_break_and_layers_are_not_judged():
    ball = fm.Sphere(mass="500 g", radius="24.8 mm", drop_height="0.3 m", material="bearing steel")
    pane = fm.Plate("soda-lime glass", "4 mm", size=["1 m", "1 m"])
    effect = {e.name: e for e in choose(fm.Scene(ball, pane)).effects}["bending_strength"]
    assert effect.value == pytest.approx(3.2, abs=0.3)
    assert "may break" in effect.reason
    layers = fm.Plate(layup=[["carbon/epoxy UD", "1 mm", 0]], material="carbon/epoxy UD")
    light = fm.Sphere(diameter="4 mm", velocity="1 m/s", material="bearing steel")
    effect = {e.name: e for e in choose(fm.Scene(light, layers)).effects}["bending_strength"]
    assert (effect.state, "layers" in effect.reason) == ("not judged", True)
