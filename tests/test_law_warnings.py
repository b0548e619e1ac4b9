"""Laws say where their restitution rises with velocity or exceeds one, and where an impact leaves their range."""

import pickle
import warnings

import numpy as np
import pytest
from cases import scene

import film_datasets as fd
import film_model as fm
from film_model.effects.choose import choose
from film_model.problem.curve import curve_of

BALL = scene("hertz").replace({"contact.yield_strength": "1 GPa"})


def of_law(law, **contact):
    return BALL.replace({"contact.law": law} | {f"contact.{key}": value for key, value in contact.items()})


def speeds(low, high, count):
    return [f"{v!r} m/s" for v in np.geomspace(low, high, count).tolist()]


def rising(warnings):
    return [sentence for sentence in warnings if "its restitution rises with velocity" in sentence]


@pytest.mark.parametrize("law", ["big-alabo", "jackson-green"])
def test_a_copy_of_a_curve_warns_of_the_same_jump(law):
    curve = curve_of(base_law(of_law(law, constants="printed", poissons_ratio=0.3)))
    assert "the force jumps by" in curve.warnings[0]
    assert pickle.loads(pickle.dumps(curve)).warnings == curve.warnings


def test_big_alabo_rises_between_its_minimum_and_its_maximum():
    """0.8232 at 1.673 V_Y and 0.9299 at 8.49 V_Y: found by integrating the law."""
    base = of_law("big-alabo")
    limit = base.approach_velocity / next(e.value for e in choose(base).effects if e.name == "plasticity")
    (rise,) = curve_of(base_law(base)).rises
    assert rise.low == pytest.approx(0.8232, abs=5e-4) and rise.high == pytest.approx(0.9299, abs=5e-4)
    assert rise.slow / np.sqrt(0.8) == pytest.approx(1.673, rel=0.04)
    assert rise.fast / np.sqrt(0.8) == pytest.approx(8.49, rel=0.04)
    for ratio, said in ((1.2, False), (3.0, True), (20.0, False)):
        own = base.replace({"impactor.velocity": f"{ratio * limit!r} m/s"})
        assert bool(rising(fm.simulate(own).warnings)) is said, ratio


def base_law(base):
    return fm.simulate(base).problem.law


@pytest.mark.slow
def test_every_output_says_so(capsys, tmp_path):
    history = fm.simulate(of_law("big-alabo"))
    (sentence,) = rising(history.warnings)
    assert "0.823" in sentence and "0.930" in sentence and "m/s" in sentence
    assert sentence in history.to_dict()["warnings"] and sentence in fd.to_dataset(history).attrs["warnings"]
    batch = fm.simulate_batch(of_law("big-alabo"), velocity=speeds(0.06, 5.0, 40))
    (sentence,) = rising(batch.warnings)
    assert "of 40 impacts" in sentence
    swept = fd.sweep(of_law("big-alabo"), {"impactor.velocity": {"from": "0.1 m/s", "to": "2 m/s", "count": 40}})
    assert rising(swept.attrs["warnings"].splitlines())


def test_a_law_that_gains_energy_says_so_in_batches():
    batch = fm.simulate_batch(of_law("stronge"), velocity=speeds(0.05, 0.2, 30))
    assert any("returns more energy" in sentence for sentence in batch.warnings)
    assert any("rises with velocity" in sentence for sentence in batch.warnings)


@pytest.mark.parametrize("law", ["jackson-green", "yigit-christoforou", "hertz", "tsuji", "auto"])
def test_laws_whose_restitution_falls_say_nothing(law):
    contact = {"restitution": 0.8} if law == "tsuji" else {}
    batch = fm.simulate_batch(of_law(law, **contact), velocity=speeds(0.02, 1.0, 30))
    assert not [sentence for sentence in batch.warnings if sentence.startswith("law ")]


def test_impacts_outside_the_fit_of_a_law_are_named_with_the_number():
    soft = of_law("jackson-green").replace({"contact.yield_strength": "50 MPa"})
    (sentence,) = (s for s in fm.simulate(soft).warnings if "outside its range" in s)
    assert "S_y/E is 0.000293" in sentence and "0.001 to 0.009" in sentence
    fast = of_law("auto").replace({"impactor.velocity": "60 m/s"})
    (sentence,) = (s for s in fm.simulate(fast).warnings if "outside its range" in s)
    assert "the contact radius is 0." in sentence and "up to 0.4" in sentence
    deep = of_law("kogut-etsion", hardness="2.8 GPa").replace({"impactor.velocity": "50 m/s"})
    assert any("fitted were up to 110" in s for s in fm.simulate(deep).warnings)
    batch = fm.simulate_batch(fast, velocity=speeds(1.0, 60.0, 2))
    assert any("outside its range" in s for s in batch.warnings)


def test_a_law_that_gains_energy_is_told_on_targets_that_vibrate():
    plate = fm.Plate("mild steel", thickness="20 mm", size=["200 mm", "200 mm"])
    contact = fm.Contact("stronge", yield_strength="500 MPa")
    effects = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
    for velocity, gains in (("0.05 m/s", True), ("0.1 m/s", False)):
        ball = fm.Sphere("5 mm", velocity=velocity, material="bearing steel")
        with warnings.catch_warnings(record=True):
            history = fm.simulate(fm.Scene(ball, plate, contact, effects=effects))
        assert history.accuracy.modes > 0
        assert (history.summary["coefficient_of_restitution"] > 1.0) is gains
        assert any("its unloading returns" in text for text in history.warnings) is gains


def pressed(law, velocity, mass="100 g"):
    """A ball so slow and heavy that its weight does the work of yielding; 250 MPa."""
    ball = fm.Sphere("5 mm", velocity, mass=mass, material="bearing steel")
    return fm.Scene(ball, fm.HalfSpace("mild steel"), fm.Contact(law, yield_strength="250 MPa"))


@pytest.mark.parametrize(
    ("law", "velocity", "mass"),
    [("stronge", "1 um/s", "100 g"), ("yigit-christoforou", "1 um/s", "100 g"), ("big-alabo", "0.1 mm/s", "1 kg")],
)
def test_restitution_above_one_by_the_weight_says_so(law, velocity, mass):
    """The ball rises from the dent with what the weight did on the way into it, which no contact created."""
    base = pressed(law, velocity, mass)
    with warnings.catch_warnings(record=True):
        history = fm.simulate(base, accuracy=1e-8)
    restitution, dent = (history.summary[name] for name in ("coefficient_of_restitution", "permanent_indentation"))
    work, energy = base.mass * 9.80665 * dent, base.kinetic_energy
    assert restitution > 10.0 and history.summary["energy_absorbed"] > 0.0
    rise = restitution**2 * base.approach_velocity**2 / (2.0 * 9.80665)
    assert rise < dent + base.approach_velocity**2 / (2.0 * 9.80665)  # lower than it came from
    (said,) = (text for text in history.warnings if text.startswith("restitution is "))
    assert f"restitution is {restitution:.4g}" in said
    assert f"{work:.4g} J of work, {work / energy:.3g} times the impact energy" in said
    for quiet in (base.replace({"impactor.velocity": "1 m/s"}), base.replace({"effects.gravity": False})):
        with warnings.catch_warnings(record=True):
            assert not [text for text in fm.simulate(quiet).warnings if text.startswith("restitution is ")]


def test_restitution_above_one_by_the_weight_is_counted_in_batches_and_sweeps():
    base, values = pressed("stronge", "1 um/s"), [f"{v:g} um/s" for v in (1.0, 10.0, 1e5, 1e6)]
    batch = fm.simulate_batch(base, velocity=values)
    above = batch.summary["coefficient_of_restitution"] > 1.0
    swept = fd.sweep(base, {"impactor.velocity": values})
    for said in (batch.warnings, swept.attrs["warnings"].splitlines()):
        (sentence,) = (text for text in said if "restitution is above 1" in text)
        assert sentence.startswith(f"in {np.count_nonzero(above)} impacts")
    assert above.tolist() == [True, True, False, False]
