"""Vibrations and static deflection of beams: characteristic equations, limits, and published impacts."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import film_model as fm
from film_model.effects.choose import choose
from film_model.targets.beam_theory import Line, beam_shear_coefficient, line_compliance, line_modes
from film_model.targets.ritz import panel_modes

S, C, F = "simply supported", "clamped", "free"
STEEL = fm.Material("steel", "215.7 GPa", 0.3, "7960 kg/m^3")
SHEAR = beam_shear_coefficient(0.3) * 215.7e9 / 2.6


def beam(ends, length, sheared=True):
    """A steel beam of 10 × 10 mm."""
    area, inertia = 1e-4, 1e-8 / 12
    extra = (SHEAR * area, 7960.0 * inertia) if sheared else ()
    return Line(7960.0 * area, 215.7e9 * inertia, length, ends, *extra)


ROOTS = {  # of the characteristic equations, k L (Blevins 1979, Table 8-1)
    (C, C): [4.730041, 7.853205, 10.995608],
    (C, F): [1.875104, 4.694091, 7.854757],
    (F, F): [0.0, 0.0, 4.730041, 7.853205],
    (C, S): [3.926602, 7.068583, 10.210176],
    (S, F): [0.0, 3.926602, 7.068583],
    (S, S): [math.pi, 2 * math.pi, 3 * math.pi],
}


@pytest.mark.parametrize("ends", ROOTS)
@pytest.mark.parametrize("sheared", [False, True])
def test_frequencies_of_slender_beams(ends, sheared):
    own = beam(ends, 30.0, sheared)
    clock = math.sqrt(own.bending / own.mass) / 900
    expected = np.array(ROOTS[ends]) ** 2 * clock
    for place in (12.3, 17.7):
        turned = Line(own.mass, own.bending, 30.0, ends[::-1], own.shear, own.turning)
        got, mirrored = line_modes(own, place, 200 * clock), line_modes(turned, 30.0 - place, 200 * clock)
        assert got.frequency[: expected.size] == pytest.approx(expected, rel=2e-5, abs=1e-9)
        assert mirrored.frequency == pytest.approx(got.frequency, rel=1e-7, abs=1e-9)
        rigid = np.count_nonzero(got.frequency == 0.0)
        assert mirrored.share[rigid:] == pytest.approx(got.share[rigid:], rel=1e-5)
        assert mirrored.share[:rigid].sum() == pytest.approx(got.share[:rigid].sum(), rel=1e-9)


def test_shares_of_a_free_beam():
    """Two motions as a rigid body: 1/m and 12 (x − L/2)²/(m L²); at the tip every vibration has 4/m."""
    modes = line_modes(beam((F, F), 1.0, sheared=False), 1.0, 3e4)
    whole = 7960.0 * 1e-4
    assert modes.frequency[:2].tolist() == [0.0, 0.0]
    assert modes.share[:2].sum() == pytest.approx(4 / whole, rel=1e-9)
    assert modes.share[2:8] == pytest.approx(np.full(6, 4 / whole), rel=1e-6)


def _timoshenko_cantilever(frequency, length):
    """The determinant of the four conditions of a cantilever on the four exponentials of Timoshenko's equations."""
    own = beam((C, F), length)
    q, r = own.mass / own.shear * frequency**2, own.turning / own.bending * frequency**2
    root = np.sqrt(((q - r) / 2) ** 2 + own.mass / own.bending * frequency**2)
    rates = np.emath.sqrt(np.array([-(q + r) / 2 + root, -(q + r) / 2 - root]).astype(complex))
    rates = np.concatenate([rates, -rates])
    turn = (rates**2 + q) / rates  # ψ = turn w of each exponential: κGA (w″ − ψ′) + ρA ω² w = 0
    tip = np.exp(rates * length)
    rows = [np.ones(4), turn, turn * rates * tip, (rates - turn) * tip]
    return np.linalg.det(np.array([row / np.abs(row).max() for row in rows]))


def test_timoshenkos_cantilever_against_its_characteristic_equation():
    modes = line_modes(beam((C, F), 0.1), 0.09, 1e6).frequency[:6]
    for frequency in modes:
        near = [_timoshenko_cantilever(frequency * factor, 0.1) for factor in (0.999, 1.001)]
        part = (lambda z: z.real) if abs(near[0].real) > abs(near[0].imag) else (lambda z: z.imag)
        root = brentq(lambda w, part=part: part(_timoshenko_cantilever(w, 0.1)), 0.999 * frequency, 1.001 * frequency)
        assert root == pytest.approx(frequency, rel=1e-7)


@pytest.mark.slow
def test_high_vibrations_of_slender_beams_keep_their_digits():
    """190 half-waves of a free beam with little shear: frequencies and tips tend to those of the plain theory,
    with a difference that grows with the square of the wave number. Where digits are lost, half the vibrations are."""
    slender = Line(1.0, 1.0, 1.0, (F, F), 1e9, 1e-9)
    found = line_modes(slender, 0.0, (190 * math.pi) ** 2)
    wave = (np.arange(3.0, found.frequency.size + 1.0 - 2.0) + 0.5) * math.pi
    frequency, share = found.frequency[4:], found.share[4:]
    assert found.frequency.size >= 190
    lower = (1.0 - frequency / wave**2) / wave**2  # 1e-9 (1 + 1)/2, to first order
    assert lower[20:100] == pytest.approx(1e-9, rel=3e-2)
    assert np.diff((share / 4.0 - 1.0) / wave**2)[60:] == pytest.approx(0.0, abs=3e-13)


@pytest.mark.parametrize("ends", [(C, C), (C, F), (F, F), (S, F), (C, S), (S, S)])
@pytest.mark.parametrize("sheared", [False, True])
def test_the_static_deflection_is_that_of_all_vibrations(ends, sheared):
    own = beam(ends, 0.2, sheared)
    static, sums = line_compliance(own, 0.13), [line_modes(own, 0.13, w).compliance for w in (5e5, 1.5e6)]
    assert sums[0] < sums[1] < static
    assert static == pytest.approx(sums[1], rel=2e-2 if sheared else 1e-3)


def test_shear_of_simply_supported_beams():
    """a b/(L κ G A) is added to a² b²/(3 EI L)."""
    own, plain = beam((S, S), 0.2), beam((S, S), 0.2, sheared=False)
    added = line_compliance(own, 0.05) - line_compliance(plain, 0.05)
    assert added == pytest.approx(0.05 * 0.15 / 0.2 / own.shear, rel=1e-9)


# ---------------------------------------------------------------- as a target


def on(theory, length, radius):
    ball, target = (
        fm.Sphere(radius, "0.01 m/s", material=STEEL),
        fm.Beam(STEEL, length, "10 mm", "10 mm", theory=theory),
    )
    return fm.Scene(ball, target, fm.Contact("hertz"), fm.Effects(gravity=False))


@pytest.mark.parametrize(
    ("theory", "length", "radius", "force", "rebound"),
    [
        ("euler-bernoulli", "153.5 mm", "10 mm", 4.97714, -0.00302324),  # Timoshenko 1913
        pytest.param("euler-bernoulli", "307 mm", "20 mm", 10.298, -0.00971258, marks=pytest.mark.slow),
        pytest.param("auto", "307 mm", "20 mm", 11.574, -0.0094589, marks=pytest.mark.slow),
    ],
)
def test_timoshenkos_impacts(theory, length, radius, force, rebound):
    summary = fm.simulate(on(theory, length, radius), accuracy=1e-3).summary
    assert summary["maximum_force"] == pytest.approx(force, rel=1e-3)
    assert summary["rebound_velocity"] == pytest.approx(rebound, rel=1e-3)


def test_effects_say_which_theory():
    shear = {effect.name: effect for effect in choose(on("auto", "153.5 mm", "10 mm")).effects}["thickness"]
    assert "includes shear" in shear.reason and shear.state == "not needed"
    plain = {effect.name: effect for effect in choose(on("euler-bernoulli", "153.5 mm", "10 mm")).effects}["thickness"]
    assert plain.change == pytest.approx(1 - 4.9332 / 4.9771, rel=1.0)  # the peak force with shear and without


@pytest.mark.parametrize(("width", "measured"), [("35 mm", 0.063), ("50 mm", 0.232)])
def test_bending_across_the_width(width, measured):
    """measured: 1 − F/F₀ of the first contact, by the modes of the plate and of the beam: 1507 and 1962 N at 50 mm."""
    steel = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
    ball, contact = fm.Sphere("15 mm", "1 m/s", material=steel), fm.Contact("hertz")
    narrow = fm.Beam(steel, "500 mm", width, "5 mm", theory="timoshenko")
    effect = {e.name: e for e in choose(fm.Scene(ball, narrow, contact)).effects}["cross_bending"]
    assert effect.state == "needed but not modelled" and 0.5 < effect.change / measured < 2.0
    wide = fm.Beam(steel, "500 mm", width, "5 mm")
    assert wide.wide and wide.compliance == fm.Beam(steel, "500 mm", width, "5 mm", theory="plate").compliance
    effect = {e.name: e for e in choose(fm.Scene(ball, wide, contact)).effects}["cross_bending"]
    assert effect.state == "not needed" and "taken for a plate" in effect.reason


@pytest.mark.slow
@pytest.mark.parametrize(("length", "width"), [("3 m", "100 mm"), ("3 m", "60 mm"), ("1.2 m", "60 mm")])
@pytest.mark.parametrize("share", [0.5, 0.3])
def test_long_wide_beams(length, width, share):
    """Contact ends before waves return from the ends: the impact is that on a shorter beam with other ends."""
    ball, hertz = fm.Sphere("5 mm", "1 m/s", material="bearing steel"), fm.Contact("hertz")
    size, short = {"width": width, "thickness": "4 mm", "theory": "plate"}, {"length": "600 mm"}
    exact = fm.simulate(fm.Scene(ball, fm.Beam("mild steel", **short, **size), hertz))
    place = f"{share * float(length.split()[0])} m"
    for ends in ("clamped", S):
        target = fm.Beam("mild steel", length=length, ends=ends, position=place, **size)
        found = fm.simulate(fm.Scene(ball, target, hertz))
        for name in ("maximum_force", "rebound_velocity", "contact_duration"):
            assert found.summary[name] == pytest.approx(exact.summary[name], rel=5e-4)
        assert found.accuracy.estimated < (1e-4 if ends == S else 0.1)


@pytest.mark.slow
def test_a_large_error_of_the_omitted_vibrations_is_told():
    target = fm.Beam("mild steel", length="600 mm", width="60 mm", thickness="4 mm", ends="clamped", position="60 mm")
    ball = fm.Sphere("10 mm", "1 m/s", material="bearing steel")
    with pytest.warns(fm.ImpactWarning, match=r"the beam is known within \d.\de-0\d, which changes at most maximum"):
        found = fm.simulate(fm.Scene(ball, target, fm.Contact("hertz")))
    assert 1e-4 < found.vibration.target_error < found.accuracy.estimated < 1e-2


@pytest.mark.slow
def test_a_strip_of_plate_has_the_beams_first_frequencies():
    steel = fm.Material("steel", "210 GPa", 0.0, "7850 kg/m^3")  # without Poisson's ratio the strip bends as the beam
    for ends in ("simply supported", "clamped", "cantilever", ["clamped", "simply supported"], "free"):
        strip = fm.Beam(steel, "1 m", "30 mm", "2 mm", ends=ends, position="600 mm", theory="plate")
        slender = fm.Beam(steel, "1 m", "30 mm", "2 mm", ends=ends, position="600 mm", theory="euler-bernoulli")
        a, b = strip.modes(800.0), slender.modes(800.0)
        assert a.frequency == pytest.approx(b.frequency, rel=1e-4, abs=1e-6)
        assert strip.compliance == pytest.approx(slender.compliance, rel=2e-3)
    assert panel_modes(strip._strip, (0.6, 0.015), 800.0).frequency[:2].tolist() == [0.0, 0.0]


def test_scene_files_and_mistakes():
    target = fm.Beam(
        STEEL, "1 m", "20 mm", "10 mm", ends=["clamped", "free"], theory="euler-bernoulli", damping_ratio=[0.1, 0.02]
    )
    scene = fm.Scene(fm.Sphere("5 mm", "1 m/s", material=STEEL), target, fm.Contact("hertz"))
    assert fm.Scene.from_text(scene.to_toml()) == scene
    assert target.modes(1e4).damping_ratio[:2].tolist() == [0.1, 0.02]
    assert (
        target.compliance
        == fm.Beam(STEEL, "1 m", "20 mm", "10 mm", ends="cantilever", theory="euler-bernoulli").compliance
    )
    assert fm.Beam(STEEL, "1 m", "20 mm", "10 mm", ends=["free", "clamped"], position="0 m").held
    assert not fm.Beam(STEEL, "1 m", "20 mm", "10 mm", ends="free").held
    for options, message in (
        ({"ends": ["clamped", "cantilever"]}, "names both ends: give it alone"),
        ({"ends": ["clamped"]}, "a list of 2"),
        ({"theory": "timoschenko"}, 'did you mean "timoshenko"'),
        ({"ends": ["clamped", "free"], "position": "0 m"}, "0 m must be > 0 m and <= 1 m: a support"),
    ):
        with pytest.raises(fm.SceneError, match=message):
            fm.Beam(STEEL, "1 m", "20 mm", "10 mm", **options)
