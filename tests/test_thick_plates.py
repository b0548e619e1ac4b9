"""Shear in thick plates: the warning's number against Mindlin's theory."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.core import modal
from film_model.effects.choose import choose
from film_model.solve import structures, vibration

YOUNG, RATIO, DENSITY = 210e9, 0.3, 7850.0
STEEL = fm.Material("steel", f"{YOUNG} Pa", RATIO, f"{DENSITY} kg/m^3")
SIDE = 0.2  # m


def mindlin(thickness, wave_number):
    """Squares of both frequencies at a wave number, and rotation over deflection of each: Mindlin (1951), κ = 5/6.

    (κGh k² − ρh ω²)(D k² + κGh − ρI ω²) = (κGh k)², I = h³/12. Rotation ψ: κGh k ψ = (κGh k² − ρh ω²) w.
    """
    bending = YOUNG * thickness**3 / 12 / (1 - RATIO**2)
    shear = 5 / 6 * YOUNG / (2 * (1 + RATIO)) * thickness
    mass, turning = DENSITY * thickness, DENSITY * thickness**3 / 12
    product = mass * turning
    middle = mass * (bending * wave_number**2 + shear) + turning * shear * wave_number**2
    large = (middle + np.sqrt(middle**2 - 4 * product * shear * bending * wave_number**4)) / 2
    squares = np.stack([shear * bending * wave_number**4 / large, large / product])
    return squares, (shear * wave_number**2 - mass * squares) / (shear * wave_number)


@pytest.mark.parametrize(
    ("half_waves", "slenderness", "expected"),
    [((1, 1), 10, 3.2562), ((1, 1), 5, 3.0923), ((1, 2), 5, 3.9450), ((2, 1), 10, 11.497), ((2, 2), 10, 12.369)],
)
def test_mindlins_frequencies(half_waves, slenderness, expected):
    """Exact three-dimensional elasticity: S. Brischetto, Shock and Vibration 2014, 479738, table 7, plate of 1 by 3.

    ω a²/h √(ρ/E) of simply supported plates, a/h = slenderness.
    """
    i, j = half_waves
    squares, _ = mindlin(1 / slenderness, math.pi * math.hypot(i, j / 3))
    assert math.sqrt(squares[0] * DENSITY / YOUNG) * slenderness == pytest.approx(expected, rel=5e-3)


def mindlins_modes(thickness, shortest):
    """Modes of a simply supported square plate struck at the centre, with wave numbers up to `shortest`."""
    n = np.arange(1, int(shortest * SIDE / math.pi) + 2, 2.0)
    wave_number = np.unique(np.hypot(*np.meshgrid(n, n)).round(9)) * math.pi / SIDE
    pairs = np.array([np.sum(np.isclose(np.hypot(*np.meshgrid(n, n)) * math.pi / SIDE, k)) for k in wave_number])
    kept = wave_number <= shortest
    squares, turn = mindlin(thickness, wave_number[kept])
    mass = DENSITY * thickness * SIDE**2 / 4 * (1 + thickness**2 / 12 * turn**2)
    frequency, share = np.sqrt(squares).ravel(), (pairs[kept] / mass).ravel()
    order = np.argsort(frequency)
    return frequency[order], share[order]


def change_by_shear(thickness, mass, cut):
    """Largest change of the summary from thin to Mindlin's theory, and the effect's number.

    Below the contact Mindlin's deflection grows with the logarithm of the shortest wave length: waves end at cut/h.
    """
    plate = fm.Plate(STEEL, f"{thickness} m", size=[f"{SIDE} m"] * 2)
    effects = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
    ball = fm.Sphere("10 mm", "1 m/s", material=STEEL, mass=f"{mass} kg")
    scene = fm.Scene(ball, plate, fm.Contact("hertz"), effects)
    thin = fm.simulate(scene, accuracy=1e-3)
    frequency, share = mindlins_modes(thickness, cut / thickness)
    tables = modal.Tables(frequency, share, np.zeros(frequency.size), thin.vibration.tables.longest)
    limit = vibration.time_limit(thin.problem, plate)
    thick = vibration.run(thin.problem, structures.Structure(frequency[-1], tables, 0.0, tables), 1e-6, limit)
    assert thin.vibration.contacts == thick.contacts == 1
    changes = vibration.differences(thin.problem, thin.vibration.summary, thick.summary)
    return max(changes.values()), next(e for e in choose(scene).effects if e.name == "thickness").change


@pytest.mark.parametrize("thickness", [0.01, 0.02, 0.04])
@pytest.mark.parametrize("mass", [0.3, 3, 30])
def test_the_warning_of_shear(thickness, mass):
    """Right within a factor of about two, between waves that end at 1/h and at 2/h."""
    between = [change_by_shear(thickness, mass, cut) for cut in (1.0, 2.0)]
    ratio = between[0][1] / math.sqrt(between[0][0] * between[1][0])
    assert 0.5 < ratio < 2.2
