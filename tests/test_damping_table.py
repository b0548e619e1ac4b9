"""Damping ratios as a table over the natural frequency: every target that vibrates, files and refusals."""

import math

import numpy as np
import pytest

import film_model as fm

TABLE = [["100 Hz", 0.05], ["10 kHz", 0.01], ["20 kHz", 0.02]]
STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
TARGETS = {
    "plate": lambda ratio: fm.Plate(STEEL, "4 mm", size=["60 mm", "50 mm"], edges="free", damping_ratio=ratio),
    "beam": lambda ratio: fm.Beam(STEEL, "300 mm", "10 mm", "8 mm", "free", damping_ratio=ratio),
    "rod": lambda ratio: fm.Rod(STEEL, "10 mm", length="300 mm", damping_ratio=ratio),
    "structure": lambda ratio: fm.Structure(
        material=STEEL,
        frequency=["0 Hz", "50 Hz", "1 kHz", "30 kHz"],
        modal_mass=["1 kg", "20 g", "30 g", "10 g"],
        damping_ratio=ratio,
    ),
}


@pytest.mark.parametrize("kind", TARGETS)
def test_every_vibration_has_the_ratio_of_its_frequency(kind):
    """Between the rows ζ = ζ₁ + (ζ₂ − ζ₁) ln(f/f₁)/ln(f₂/f₁), constant beyond; a motion as a whole has none."""
    modes = TARGETS[kind](TABLE).modes(6e5)
    bends = modes.frequency > 0.0
    assert bends.sum() >= 3 and not bends[0] and not modes.damping_ratio[~bends].any()
    for omega, ratio in zip(modes.frequency[bends].tolist(), modes.damping_ratio[bends].tolist(), strict=True):
        f = omega / (2.0 * math.pi)
        below, above = 0.05 - 0.04 * math.log(f / 1e2) / math.log(1e2), 0.01 + 0.01 * math.log2(f / 1e4)
        exact = min(below, 0.05) if f < 1e4 else min(above, 0.02)
        assert ratio == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("kind", TARGETS)
def test_an_impact_is_that_of_the_same_ratios_one_by_one(kind):
    ball = fm.Sphere("5 mm", "1 m/s", material=STEEL)
    options = fm.Contact("hertz"), fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
    target = TARGETS[kind](TABLE)
    modes = target.modes(6e5)  # above 20 kHz all ratios are the last
    listed = TARGETS[kind](modes.damping_ratio[modes.frequency > 0.0].tolist())
    scene = fm.Scene(ball, target, *options)
    found, same = (fm.simulate(one, accuracy=1e-3) for one in (scene, fm.Scene(ball, listed, *options)))
    assert found.summary == pytest.approx(same.summary, rel=1e-7)  # Ritz's frequencies move with their number
    free = fm.simulate(fm.Scene(ball, TARGETS[kind](None), *options), accuracy=1e-3)
    assert free.summary["maximum_force"] != found.summary["maximum_force"]
    assert fm.Scene.from_text(scene.to_toml()) == scene
    assert "damping_ratio=[['100.0 Hz', 0.05]," in repr(target)


def test_a_free_vibration_falls_at_the_rate_of_the_table():
    """In steps: after contact the only vibration is e^(−ζωt) sin ωt with the table's ζ."""
    target = fm.Structure(
        material=STEEL,
        frequency=["1 kHz"],
        modal_mass=["0.2 kg"],
        damping_ratio=TABLE,
        sensors=[{"name": "a", "shape": [1.0]}],
    )
    ball = fm.Sphere("5 mm", "1 m/s", material=STEEL)
    effects = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
    component = fm.ImpactComponent(fm.Scene(ball, target, fm.Contact("hertz"), effects), accuracy=1e-8)
    component.step(1e-3)
    zeta, omega, moved = 0.05 - 0.04 * math.log10(1e3 / 1e2) / 2.0, 2e3 * math.pi, []
    for _ in range(3):
        moved.append(float(component.sensed.displacement[0]))
        component.step(math.pi / (omega * math.sqrt(1.0 - zeta**2)))
    falls = -math.exp(-zeta * math.pi / math.sqrt(1.0 - zeta**2))
    assert np.divide(moved[1:], moved[:-1]) == pytest.approx([falls, falls], rel=1e-9)


@pytest.mark.parametrize(
    ("ratio", "sentence"),
    [
        ([["1 kHz", 0.01]], "at least two pairs"),
        ([["1 kHz", 0.01], 0.02], "at least two pairs"),
        ([["1 kHz", 0.01], ["1 kHz", 0.02]], "pair 2: 1000 Hz must be > 1000 Hz, that of the pair before"),
        ([["0 Hz", 0.01], ["1 kHz", 0.02]], 'pair 1: "0 Hz" must be > 0'),
        ([["1 kHz", 0.01], ["2 kHz", 1.2]], "pair 2: 1.2 is out of range: from 0 to 0.999"),
        ([["1 m", 0.01], ["2 kHz", 0.02]], "a frequency is needed"),
    ],
)
def test_a_wrong_table_is_refused_in_a_sentence(ratio, sentence):
    with pytest.raises(fm.SceneError, match=sentence) as caught:
        TARGETS["rod"](ratio)
    assert len(str(caught.value).splitlines()) == 1
