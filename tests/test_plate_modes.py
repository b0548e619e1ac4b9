"""Vibrations and static deflection of plates with any edges, against tables, closed forms and convergence."""

import ctypes
import itertools
import math
import os
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import film_model as fm
from film_model.core import native, panels
from film_model.effects.choose import choose
from film_model.effects.edge_effects import ways_of
from film_model.solve.batch import simulate_many
from film_model.targets import Modes, plate_statics, ritz
from film_model.targets.line_functions import line, polynomials
from film_model.targets.modes import pulse_response
from film_model.targets.panel_statics import SEEN, compliance_and_error, panel_compliance, unit_compliance
from film_model.targets.plate_modes import plate_modes
from film_model.targets.ritz import Panel, panel_modes
from film_model.targets.ritz_errors import missed

WORDS = {"S": "simply supported", "C": "clamped", "F": "free"}
ISOTROPIC = (1.0, 0.3, 1.0, 0.35)
OLSSON = (154.9, 4.76, 91.4, 8.97)
OFF_CENTRE = (0.4137, 0.3721)


def panel(letters, size=(1.0, 1.0), stiffness=ISOTROPIC, **supports):
    """A plate of unit mass per area; letters: its edges at x = 0, x = a, y = 0, y = b."""
    return Panel(1.0, stiffness, size, tuple(WORDS[letter] for letter in letters), **supports)


LEISSA = {  # A. W. Leissa 1973, J. Sound Vib. 31:257, ω a² √(ρ/D) of square plates, ν = 0.3: exact where x is supported
    "SSCC": (28.9509, 54.7431, 69.3270),
    "SSCS": (23.6463, 51.6743, 58.6464),
    "SSCF": (12.6874, 33.0651, 41.7019),
    "SSSF": (11.6845, 27.7563, 41.1967),
    "SSFF": (9.6314, 16.1348, 36.7256),
}
RITZ = {  # the same, by a few beam functions: upper bounds
    "CCCC": (35.992, 73.413, 73.413),
    "CCCF": (24.020, 40.039, 63.493),
    "CSCS": (27.056, 60.544, 60.791),
    "CFCF": (6.942, 24.034, 26.681),
    "CFFF": (3.4917, 8.5246, 21.429),
    "SFSF": (3.3687, 17.407, 19.367),
    "FFFF": (0.0, 0.0, 0.0, 13.489, 19.789, 24.432),
}


@pytest.mark.parametrize("edges", LEISSA)
def test_frequencies_of_levys_plates(edges):
    got = panel_modes(panel(edges), OFF_CENTRE, 80.0).frequency
    assert got[:3] == pytest.approx(LEISSA[edges], abs=1e-4)


@pytest.mark.parametrize("edges", RITZ)
def test_frequencies_of_leissas_table(edges):
    table = np.array(RITZ[edges])
    got = panel_modes(panel(edges), OFF_CENTRE, 80.0).frequency[: table.size]
    assert (got <= table).all() and got == pytest.approx(table, rel=0.011, abs=1e-9)


def test_clamped_square_plate():
    """First frequency 35.985 (Leissa 35.992), deflection 0.00560 F a²/D at the centre (Timoshenko 1959, Table 37)."""
    clamped = panel("CCCC")
    assert panel_modes(clamped, (0.5, 0.5), 100.0).frequency[0] == pytest.approx(35.9852, abs=1e-4)
    assert panel_compliance(clamped, (0.5, 0.5)) == pytest.approx(0.005612, abs=1e-6)


@pytest.mark.parametrize("letters", ["FFFF", "CFCF"])
def test_vibrations_with_a_node_by_symmetry_are_left_out(letters):
    """Of a square plate struck on its diagonal. They are there beside the diagonal. Rounding, which depends on the
    machine, gives them shares of 1e-30 to 6e-11 of the largest."""
    number = {}
    for place in ((0.185, 0.185), (0.185, 0.21)):
        modes = panel_modes(panel(letters), place, 3000.0)
        assert modes.share.min() > 1e-9 * modes.share.max()
        number[place] = modes.frequency.size
    assert 0.4 < number[0.185, 0.185] / number[0.185, 0.21] < 0.8


def test_vibrations_with_a_node_in_the_middle_of_a_beam():
    for ends in ("clamped", "free"):
        modes = fm.Beam("mild steel", "300 mm", "10 mm", "10 mm", ends=ends).modes(1e6)
        assert modes.share.min() > 1e-9 * modes.share.max()


def test_products_that_hardly_matter_are_left_out():
    """Of many waves along one side and few along the other, if no edge is free: a tenth fewer with the same errors."""
    plate, highest = panel("CCCC", (1.0, 0.9)), 9000.0
    few = panel_modes(plate, OFF_CENTRE, highest).frequency
    error = np.abs(few / panel_modes(plate, OFF_CENTRE, 1.7 * highest).frequency[: few.size] - 1.0)
    assert error.max() < 1e-3 and error[few < 0.5 * highest].max() < 2e-4 and error[:10].max() < 1e-5
    numbers = dict[str, int]()
    for letters in ("CCCC", "CCCF"):
        own = panel(letters, (1.0, 0.9))
        lines = [ritz._line(plate, along, 1.6 * highest) for along in (0, 1)]
        blocks = ritz.split(own, lines, ritz.shapes_at(plate, lines, OFF_CENTRE), highest, 1.6)
        numbers[letters] = sum(p.size for p, _ in blocks)
    assert numbers["CCCC"] < 0.93 * numbers["CCCF"]


def test_plates_that_nothing_holds():
    """Three motions as a rigid body, and the next frequencies by Gorman and others: 13.468, 19.596, 24.270."""
    free = panel_modes(panel("FFFF"), OFF_CENTRE, 60.0)
    assert free.frequency[:3].tolist() == [0.0, 0.0, 0.0]
    assert free.frequency[3:6] == pytest.approx([13.468, 19.596, 24.270], abs=1e-3)
    x, y = OFF_CENTRE
    assert free.share[:3].sum() == pytest.approx(1 + 12 * (x - 0.5) ** 2 + 12 * (y - 0.5) ** 2, rel=1e-9)
    assert np.isfinite(free.compliance)
    hinged = panel_modes(panel("SFFF"), (0.7, 0.4), 60.0)
    assert hinged.frequency[0] == 0.0 and hinged.share[0] == pytest.approx(3 * 0.7**2, rel=1e-9)
    assert hinged.frequency[1] == pytest.approx(6.644, abs=1e-3)


def test_modes_with_a_node_at_the_struck_point_are_left_out():
    """At the centre those with an even number of half-waves along a side; of equal frequencies both count."""
    found = plate_modes(1.0, ISOTROPIC, (1.0, 1.0), (0.5, 0.5), 1e5)
    i = np.arange(1, 200, 2)
    square = i[:, None] ** 2 + i**2
    expected = np.sort(square[math.pi**2 * square <= 1e5])
    assert found.frequency == pytest.approx(math.pi**2 * expected, rel=1e-12)
    assert found.share == pytest.approx(4.0, rel=1e-12)


@pytest.mark.parametrize("stiffness", [ISOTROPIC, OLSSON])
def test_ritz_equals_the_closed_form_of_simple_supports(stiffness):
    """A bed of no stiffness changes nothing but the path; a bed adds k_f/ρ_A to every ω²."""
    size, place, highest = (1.0, 1.3), (0.31, 0.57), 40.0 * math.sqrt(stiffness[0])
    exact = plate_modes(1.0, stiffness, size, place, highest)
    got = panel_modes(panel("SSSS", size, stiffness), place, highest)
    assert got.frequency == pytest.approx(exact.frequency, rel=1e-9)
    assert got.share == pytest.approx(exact.share, rel=1e-6)
    bed = panel_modes(panel("SSSS", size, stiffness, foundation=3.0), place, highest)
    assert bed.frequency[:5] ** 2 == pytest.approx(exact.frequency[:5] ** 2 + 3.0, rel=1e-9)


def test_stiff_springs_hold_an_edge_and_soft_springs_carry_the_plate():
    stiff = panel_modes(panel("FFFF", springs=(1e7,) * 4), OFF_CENTRE, 60.0).frequency
    assert stiff[:3] == pytest.approx([19.739, 49.348, 49.348], rel=1e-4)
    soft = panel_modes(panel("FFFF", springs=(1e-4,) * 4), OFF_CENTRE, 60.0)
    assert soft.frequency[0] == pytest.approx(math.sqrt(4e-4), rel=1e-4)  # as a rigid body on four springs
    assert not ritz.loose(panel("FFFF", springs=(1e-4, 0.0, 1e-4, 0.0)))
    assert ritz.loose(panel("FFFF", springs=(1e-4, 0.0, 0.0, 0.0))) and ritz.loose(panel("SFFF"))
    assert not ritz.loose(panel("SFSF")) and not ritz.loose(panel("FFFF", foundation=1e-6))


@pytest.mark.parametrize("letters", ["CCCC", "FFFF", "CFFF"])
def test_frequencies_converge(letters):
    """The functions that Ritz's method takes for a low limit and for a high one agree."""
    few = panel_modes(panel(letters), OFF_CENTRE, 100.0).frequency
    many = panel_modes(panel(letters), OFF_CENTRE, 700.0).frequency[: few.size]
    assert few == pytest.approx(many, rel=3e-4, abs=1e-6)
    assert few[:4] == pytest.approx(many[:4], rel=1e-5 if letters != "CFFF" else 1e-4, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("letters", ["CCCC", "CSCC", "SFFF", "FFFF", "CFCF", "CCFF", "SCFF"])
def test_errors_of_frequencies_are_known(letters, monkeypatch):
    """Against B-splines half are below what `missed` says, and nine in ten below twice as much."""
    root = Path(__file__).parent.parent
    monkeypatch.syspath_prepend(root)
    of_plate = runpy.run_path(str(root / "benchmarks" / "other_plates.py"))["of_plate"]
    edges, highest = [WORDS[letter] for letter in letters], 3e5
    target = fm.Plate(
        "mild steel", "4 mm", size=["200 mm", "150 mm"], edges=edges, position=["71 mm", "53 mm"], theory="kirchhoff"
    )
    found, exact = (each[each > 0.0] for each in (target.modes(highest).frequency, of_plate(target, 1.2 * highest)[1]))
    errors = found / exact[np.abs(exact[:, None] - found).argmin(axis=0)] - 1.0
    half, most = np.quantile(errors / missed(found / highest, target.inexact.cornered), [0.5, 0.9])
    assert half < 1.0 and 0.5 < most < 2.0


@pytest.mark.parametrize("ends", list(itertools.product(WORDS.values(), repeat=2)))
def test_functions_on_a_line(ends):
    functions, unit = line(ends, 24), 2 / (2 * np.arange(61) + 1)
    gram = (functions.polynomials * unit) @ functions.polynomials.T
    assert np.abs(gram - np.eye(len(gram))).max() < 1e-9
    for s, end in zip((-1.0, 1.0), ends, strict=True):
        assert end == "free" or np.abs(functions.at(s)).max() < 1e-9
    rigid = {"free": 1, "simply supported": 0, "clamped": -9}
    assert np.count_nonzero(functions.bent == 0.0) == max(0, rigid[ends[0]] + rigid[ends[1]])


@pytest.mark.parametrize("ends", [("free", "free"), ("clamped", "free"), ("simply supported", "free")])
@pytest.mark.parametrize("count", [48, pytest.param(300, marks=pytest.mark.slow)])
def test_high_functions_keep_their_digits_beside_a_free_end(ends, count):
    """At a free end every shape of a beam is √2 times its root mean square; frequencies are those of the characteristic
    equations, whose roots are (n − 1/2) π/2, (n + 1/2) π/2 or (n + 1/4) π/2 from n = 12 on, to rounding."""
    functions = line(ends, count)
    bends = slice(int(np.count_nonzero(functions.bent == 0.0)), functions.shapes)
    assert np.abs(functions.at(1.0)[bends]) == pytest.approx(np.sqrt(2.0), rel=1e-9)
    n = np.arange(1.0, functions.shapes - bends.start + 1.0)
    half_waves = n + {"free": 0.5, "clamped": -0.5, "simply supported": 0.25}[ends[0]]
    assert functions.bent[bends][12:] ** 0.25 == pytest.approx((half_waves * math.pi / 2)[12:], rel=1e-12)
    unit = np.sqrt(2 / (2 * np.arange(functions.polynomials.shape[1]) + 1))
    gram = (functions.polynomials * unit) @ (functions.polynomials * unit).T
    assert np.abs(gram - np.eye(len(gram))).max() < 1e-10
    curve = np.polynomial.legendre.legder(functions.polynomials, 2, axis=1) * unit[:-2]
    bent = curve @ curve.T / np.sqrt(np.maximum(functions.bent, 1.0) * np.maximum(functions.bent, 1.0)[:, None])
    assert np.abs(bent - np.diag(np.diag(bent))).max() < 1e-10


def test_frequencies_of_a_long_plate_with_a_clamped_and_a_free_end():
    """74 shapes of a beam along it, against polynomials: within 1.4e-5 (5.7e-5 where high shapes lack digits)."""
    strip, place = panel("CFFF", (1.0, 0.03)), (0.9, 0.011)
    modes = panel_modes(strip, place, (70 * math.pi) ** 2).frequency[:30]
    lines = [polynomials(strip.ends[0], 60), polynomials(strip.ends[1], 14)]
    seen = ritz.shapes_at(strip, lines, place)
    found = [ritz._vibrations(strip, lines, (p, q), seen[None, p, q]) for p, q in ritz.split(strip, lines, seen)]
    exact = np.sort(np.concatenate([frequency for frequency, _ in found]))[:30]
    assert modes == pytest.approx(exact, rel=1.5e-5)


# ---------------------------------------------------------------- static deflection


@pytest.mark.parametrize("stiffness", [ISOTROPIC, OLSSON, (100.0, 50.0, 20.0, 300.0)])
@pytest.mark.parametrize("place", [(0.5, 0.5), (0.03, 0.1), (0.3, 0.37)])
def test_levys_solution_equals_naviers(stiffness, place):
    levy = plate_statics.levy_compliance(stiffness, (1.0, 1.0), (WORDS["S"],) * 2, place)
    assert levy == pytest.approx(plate_statics.plate_compliance(stiffness, (1.0, 1.0), place), rel=1e-8)


@pytest.mark.parametrize(
    ("letters", "place"),
    [("CCCC", (0.3, 0.37)), ("CFFF", (1.0, 0.5)), ("CFFF", (0.5, 0.5)), ("FFFF", (1.0, 0.9)), ("CFCS", (0.9, 0.2))],
)
def test_the_static_deflection_is_that_of_all_vibrations(letters, place):
    """The sum over the vibrations approaches it as the highest frequency grows, as 1/ω: two sums extrapolate it."""
    own = panel(letters, stiffness=(1.3, 0.3, 0.8, 0.4))
    low, high = (panel_modes(own, place, highest).compliance for highest in (500.0, 1000.0))
    static = panel_compliance(own, place)
    assert low < high < static
    assert static == pytest.approx(2 * high - low, rel=5e-3)


@pytest.mark.slow
def test_turned_plates_are_the_same():
    one = panel("CFSS", (1.0, 0.6), OLSSON, springs=(0.0, 40.0, 0.0, 0.0))
    other = panel("SSCF", (0.6, 1.0), (OLSSON[2], OLSSON[1], OLSSON[0], OLSSON[3]), springs=(0.0, 0.0, 0.0, 40.0))
    assert panel_compliance(one, (0.7, 0.2)) == pytest.approx(panel_compliance(other, (0.2, 0.7)), rel=1e-9)
    a, b = panel_modes(one, (0.7, 0.2), 900.0), panel_modes(other, (0.2, 0.7), 900.0)
    assert a.frequency == pytest.approx(b.frequency, rel=1e-8) and a.share == pytest.approx(b.share, rel=1e-5)


# ---------------------------------------------------------------- as a target


def plate(**options):
    return fm.Plate("mild steel", "4 mm", size=["200 mm", "150 mm"], **options)


def test_edges_of_a_scene():
    cantilever = plate(
        edges=["clamped", "free", "free", "free"], position=["200 mm", "75 mm"], damping_ratio=[0.1, 0.02]
    )
    assert cantilever.held and not plate(edges="free").held
    modes = cantilever.modes(1e5)
    assert modes.damping_ratio[:3].tolist() == [0.1, 0.02, 0.02]
    assert plate(edges=["free"] * 4).edges == "free"
    scene = fm.Scene(fm.Sphere("5 mm", "1 m/s", material="mild steel"), cantilever, fm.Contact("hertz"))
    assert fm.Scene.from_text(scene.to_toml()) == scene
    carried = plate(edges="free", edge_stiffness=["1 MN/m^2", "0 N/m^2", "1 MN/m^2", "0 N/m^2"], damping_ratio=0.01)
    scene = fm.Scene(scene.impactor, carried, scene.contact)
    assert fm.Scene.from_text(scene.to_toml()) == scene and carried.held


def test_free_edges_may_be_struck():
    scene = fm.Scene(
        fm.Sphere("5 mm", "1 m/s", material="mild steel"),
        plate(edges=["clamped", "free", "free", "free"], position=["200 mm", "75 mm"]),
        fm.Contact("hertz"),
    )
    found = {effect.name: effect for effect in choose(scene).effects}
    assert (
        found["boundary_reflections"].state == "simulated"
        and "struck on an edge" in found["boundary_reflections"].reason
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"edges": ["clamped", "free"]}, "Plate.edges: a list has 2 values: .* or a list of 4"),
        ({"edges": ["clamped", "free", "free", "hinged"]}, 'Plate.edges: "hinged" is not allowed'),
        ({"edges": "clampd"}, 'did you mean "clamped"'),
        ({"edges": "clamped", "position": ["0 mm", "75 mm"]}, "0 m must be > 0 m and < 0.2 m: a support"),
        (
            {"edges": ["free", "clamped", "free", "free"], "position": ["200 mm", "0 m"]},
            ">= 0 m and < 0.2 m: a support",
        ),
        ({"edge_stiffness": "1 MN/m^2"}, "the edge x = 0 is simply supported: an elastic support needs a free edge"),
        ({"edges": "free", "edge_stiffness": "1 MN/m"}, "is a stiffness, a stiffness per length is needed"),
        ({"foundation_stiffness": "-1 N/m^3"}, "must be >= 0"),
        ({"damping_ratio": 1.5}, "is out of range: from 0 to 0.999"),
        ({"damping_ratio": []}, "a list is not a number"),
        ({"damping_ratio": [0.1, -0.1]}, "must be >= 0"),
    ],
)
def test_mistakes_of_supports(options, message):
    with pytest.raises(fm.SceneError, match=message) as caught:
        plate(**options)
    assert len(str(caught.value).splitlines()) == 1


def test_too_many_functions_are_refused_with_a_sentence():
    with pytest.raises(fm.SimulationError, match="functions that interact, but at most 1200 are allowed"):
        panel_modes(panel("CCCC"), (0.4, 0.3), 2e5)
    with pytest.raises(fm.SimulationError, match="half-waves along one side, but at most 320 are allowed"):
        panel_modes(panel("CCCC"), (0.4, 0.3), 1e12)
    with pytest.raises(fm.SimulationError, match="half-waves along one side, each with up to"):
        panel_modes(panel("SSCF"), (0.4, 0.3), 1e7)


@pytest.mark.slow
def test_similar_plates_share_their_vibrations():
    """Plates of other thickness are the same plate in other units, and a result does not depend on those before."""
    held = Panel(11.0, (300.0, 90.0, 250.0, 105.0), (0.3, 0.2), (WORDS["F"],) * 4, (1e4, 0.0, 2e4, 0.0), 1e6)
    points = ((0.11, 0.07), (0.2, 0.15), (0.1, 0.1, 2.0, 0.0))
    found, own = panel_modes(held, points[0], 9e4, points[1:]), ritz.unit_modes(held, points, 9e4)
    np.testing.assert_allclose(found.frequency, own.frequency, rtol=1e-9)
    np.testing.assert_allclose(found.share, own.share, atol=1e-8 * own.share.max())
    largest = np.abs(own.factor).max(axis=1)[:, None]
    np.testing.assert_allclose(found.factor / largest, own.factor / largest, atol=1e-6)
    assert panel_compliance(held, points[0]) == pytest.approx(unit_compliance(held, points[0])[0], rel=1e-10)

    def modes(thickness):
        plate = fm.Plate("mild steel", f"{thickness} mm", size=["0.2 m", "0.17 m"], edges="clamped")
        return plate.modes(1e6 * thickness / 3.0)

    thicknesses = np.linspace(3.0, 6.0, 7)
    rows = [modes(thickness) for thickness in thicknesses]
    misses = ritz.unit_modes.cache_info().misses
    ritz.unit_modes.cache_clear()
    again = [modes(thickness) for thickness in thicknesses[::-1]][::-1]
    assert misses > ritz.unit_modes.cache_info().misses == 1
    for row, same in zip(rows, again, strict=True):
        assert row.frequency.tobytes() == same.frequency.tobytes() and row.share.tobytes() == same.share.tobytes()


def test_half_waves_between_simply_supported_edges_are_accurate(monkeypatch: pytest.MonkeyPatch):
    """More polynomials change no frequency; the vibrations add up to Lévy's static deflection."""
    strip = Panel(39.0, (64.1, 19.2, 64.1, 22.4), (0.5, 0.05), ("simply supported",) * 2 + ("free",) * 2)
    place = 0.21, 0.0333
    found = panel_modes(strip, place, 2e6)
    monkeypatch.setattr(ritz, "SPARE", ritz.SPARE + 24)
    ritz.unit_modes.cache_clear()
    more = panel_modes(strip, place, 2e6)
    assert found.frequency.size > 500
    np.testing.assert_allclose(found.frequency, more.frequency, rtol=1e-9)
    np.testing.assert_allclose(found.share, more.share, atol=1e-8 * more.share.max())
    assert found.compliance == pytest.approx(panel_compliance(strip, place), rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("letters", ["SSFF", "SSFC", "SSSF", "SSCC"])
def test_low_vibrations_between_simply_supported_edges_do_not_depend_on_the_highest(letters):
    """Polynomials of degree 60 and 180 across a half-wave. Without the highest of them errors are 1e-4."""
    low, high = (panel_modes(panel(letters), OFF_CENTRE, highest) for highest in (5e3, 9e4))
    count = low.frequency.size // 2
    assert high.frequency[:count] == pytest.approx(low.frequency[:count], rel=1e-7)
    assert high.share[:count] == pytest.approx(low.share[:count], rel=1e-6, abs=1e-9)


def test_a_wide_beam_takes_few_vibrations():
    """With Ritz's shapes of a beam the late contacts did not converge: 34,571 vibrations, minutes."""
    ball = fm.Sphere(radius="15 mm", velocity="1 m/s", material="mild steel")
    beam = fm.Beam("mild steel", length="500 mm", width="50 mm", thickness="5 mm")
    with pytest.warns(fm.ImpactWarning) as caught:
        history = fm.simulate(fm.Scene(ball, beam, fm.Contact("hertz")))
    assert not [warning for warning in caught if "not reached" in str(warning.message)]
    assert history.summary["maximum_force"] == pytest.approx(1507.86, rel=1e-4)


def test_plates_of_many_thicknesses_share_few_sets_of_modes():
    """One for each power of 2 of the frequency: twelve thicknesses from 8 to 16 mm need two more than the first."""
    effects, found = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True), list[int]()
    ball, contact = fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.Contact("hertz")
    ritz.unit_modes.cache_clear()
    for thickness in np.linspace(8.0, 16.0, 12):
        plate = fm.Plate("aluminium 6061-T6", f"{thickness:.6g} mm", size=["120 mm", "100 mm"], edges="clamped")
        fm.simulate(fm.Scene(ball, plate, contact, effects), accuracy=1e-3)
        found.append(ritz.unit_modes.cache_info().misses)
    assert found[0] > 8 and found[-1] <= found[0] + 2


@pytest.mark.slow
def test_a_sweep_chooses_the_effects_of_an_impact_once(monkeypatch: pytest.MonkeyPatch):
    plate = fm.Plate(
        "aluminium 6061-T6", "4 mm", size=["200 mm", "200 mm"], edges="clamped", position=["70 mm", "55 mm"]
    )
    scene = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), plate, fm.Contact("hertz"))
    times = 0

    def counted(impacts):
        nonlocal times
        times += 1
        return ways_of(impacts)

    monkeypatch.setattr("film_model.effects.choose.ways_of", counted)
    found = simulate_many(scene, {"target.thickness": np.linspace(0.003, 0.006, 5)})
    assert times == 5 and (found.estimated < 1e-3).all()


@pytest.mark.slow
@pytest.mark.parametrize("letters", ["CCCC", "SFSS", "FCFC", "CSCC"])
@pytest.mark.parametrize("foundation", [1e5, 1e6, 1e8])
def test_edges_that_are_far_on_the_bed_change_no_more_than_the_bound(letters, foundation):
    plate, place = panel(letters, (1.0, 0.6), foundation=foundation), (0.45, 0.3)
    exact, rest = compliance_and_error(plate, place, far=14.0)
    value, error = compliance_and_error(plate, place, far=SEEN)
    assert abs(value - exact) <= error + rest and error < 1e-3 * exact


def test_response_to_a_half_sine():
    """One mode, far slower and far faster than the half-sine: ∫∫F/M, and F/k."""
    for rate, expected in ((1e-3, (math.pi / 2 - 1) / (2.0 * math.pi**2)), (1e5, 1 / (2.0 * 1e10))):
        mode = Modes(np.array([rate]), np.array([0.5]))
        got = pulse_response(lambda _, mode=mode: mode, mode.compliance, 1.0)
        assert got == pytest.approx(expected, rel=2e-4)


def test_components_along_eigenvectors():
    """Without the eigenvectors, as with them."""
    random = np.random.default_rng(1)
    root, seen, other = random.normal(size=(60, 60)), random.normal(size=60), random.normal(size=60)
    values, vectors = np.linalg.eigh(root @ root.T + np.eye(60))
    found = ritz.spectrum(root @ root.T + np.eye(60), np.array([seen, other]), 1e-6)
    np.testing.assert_allclose(found[0], values, rtol=1e-11)
    np.testing.assert_allclose(found[1][0] ** 2, (seen @ vectors) ** 2, rtol=1e-8)
    np.testing.assert_allclose(found[1][0] * found[1][1], (seen @ vectors) * (other @ vectors), rtol=1e-8)


@pytest.mark.slow
def test_the_lowest_vibrations_are_as_exact_as_the_highest():
    """Against the largest eigenvalues of the inverse, which `eigh` finds to rounding; of the matrix it does not."""
    strip, highest = panel("CFFF", (30.0, 1.0)), 300.0
    lines = [ritz._line(strip, along, highest) for along in (0, 1)]
    block, *_ = ritz.split(strip, lines, ritz.shapes_at(strip, lines, (29.0, 0.5)), highest)
    energy = ritz.energy_of(strip, lines, *block)
    unit = 1.0 / np.sqrt(np.diag(energy))
    inverse = np.linalg.inv(energy * unit[:, None] * unit) * unit[:, None] * unit
    exact = 1.0 / np.linalg.eigvalsh(inverse)[::-1][:4]
    np.testing.assert_allclose(
        ritz.spectrum(energy.copy(), np.ones((1, len(energy))), 30.0**-4)[0][:4], exact, rtol=1e-10
    )
    assert abs(np.linalg.eigvalsh(energy)[:4] / exact - 1.0).max() > 1e-8


@pytest.mark.slow
def test_the_same_bits_on_any_number_of_processors():
    code = (
        "from film_model.targets.ritz import Panel, panel_modes\n"
        "panel = Panel(31.4, (1e3, 3e2, 1e3, 3.5e2), (0.2, 0.15), ('clamped',) * 4)\n"
        "found = panel_modes(panel, (0.06, 0.04), 1.3e6)\n"
        "print(found.frequency.size, (found.frequency.tobytes() + found.share.tobytes()).hex())"
    )
    found = [
        subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True).stdout
        for environment in (os.environ | {"OPENBLAS_NUM_THREADS": count} for count in ("1", "2"))
    ]
    assert found[0] == found[1] and int(found[0].split()[0]) > 400


# ---------------------------------------------------------------- the core's own linear algebra, for the page


@pytest.mark.parametrize("ends", list(itertools.product(WORDS.values(), repeat=2)))
def test_the_core_makes_the_same_functions_on_a_line(ends):
    """Up to signs, and of the polynomials that join the shapes up to their rounding."""
    for found, own in ((panels.made(ends, 32, 0), polynomials(ends, 32)), (panels.made(ends, 60, 24), line(ends, 24))):
        series, bent, sloped, crossed = found
        sign = np.sign(np.sum(series * own.polynomials, axis=1))
        known = own.bent < 1e10  # higher ones are rounding
        both, signs = np.ix_(known, known), np.outer(sign, sign)
        np.testing.assert_allclose(bent[known], own.bent[known], rtol=1e-8)
        np.testing.assert_allclose((sign[:, None] * series)[known], own.polynomials[known], atol=1e-7)
        for mine, other in ((sloped, own.sloped), (crossed, own.crossed)):
            np.testing.assert_allclose((signs * mine)[both], other[both], atol=1e-8 * np.abs(other[both]).max())
    with pytest.raises(ValueError, match="fewer than 40 shapes"):
        panels.made(ends, 32, 40)


def core_spectrum(energy, seen, least):
    """Eigenvalues and components by the core; None where it refuses the matrix."""
    n, found = len(seen), np.empty((2, len(seen)))
    arrays = energy.copy(), np.ascontiguousarray(seen), np.empty(5 * n), *found
    matrix, given, *others = (array.ctypes.data_as(ctypes.c_void_p) for array in arrays)
    count = native.library().film_spectrum(n, matrix, given, ctypes.c_double(least), *others)
    return None if count == native.BAD_NUMBER else found[:, :count]


def test_the_core_finds_the_same_spectrum():
    """Of plates and of random matrices."""
    cantilever, place, random = panel("CFFF"), (0.9, 0.31), np.random.default_rng(2)
    lines = [line(ends, 10) for ends in cantilever.ends]
    shapes = ritz.shapes_at(cantilever, lines, place)
    cases = [
        (ritz.energy_of(cantilever, lines, *block), shapes[block]) for block in ritz.split(cantilever, lines, shapes)
    ]
    root = random.normal(size=(41, 41))
    cases += [(root @ root.T + np.eye(41), random.normal(size=41)), (np.array([[4.0]]), np.array([-3.0]))]
    for energy, seen in cases:
        expected, (components,) = ritz.spectrum(energy.copy(), seen[None, :], 1e-3)
        values, found = core_spectrum(energy, seen, 1e-3)
        np.testing.assert_allclose(values, expected, rtol=1e-7)
        np.testing.assert_allclose(values[: 1 + len(seen) // 4], expected[: 1 + len(seen) // 4], rtol=1e-10)
        np.testing.assert_allclose(found**2, components**2, rtol=1e-6, atol=1e-9 * (seen @ seen))
    assert core_spectrum(-np.eye(3), np.ones(3), 1e-3) is None
