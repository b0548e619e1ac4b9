"""Plates with shear and rotary inertia: against published frequencies, elasticity and an independent integration."""

import math

import numpy as np
import pytest
from test_thick_plates import RATIO, STEEL, YOUNG, lowest_wave, neglected_deflection, waves

import film_model as fm
from film_model.effects.choose import choose
from film_model.targets import thick_plate
from film_model.targets.beam_theory import sheared_waves
from film_model.targets.plate_modes import plate_modes
from film_model.targets.ritz import Panel
from film_model.targets.thick_plate import ThickPanel, shear_of, thick_compliance, thick_modes

S, C, F = "simply supported", "clamped", "free"
EDGES = {"SSSS": (S,) * 4, "CCCC": (C,) * 4, "CSFF": (C, S, F, F), "CFFF": (C, F, F, F), "FFFF": (F,) * 4}


def square(edges, slenderness, shear_coefficient=None, **more):
    """A square plate of unit side, density and bending stiffness."""
    thin = Panel(1.0, (1.0, RATIO, 1.0, (1 - RATIO) / 2), (1.0, 1.0), EDGES[edges], **more)
    thickness, softness, bulge = shear_of(1.0, slenderness, RATIO)
    if shear_coefficient is not None:
        softness = slenderness**2 / (6 * (1 - RATIO) * shear_coefficient)
    return ThickPanel(thin, (thickness, softness, bulge))


def every_frequency(plate, highest=1e9):
    """Of a point that is on no node line: those of pairs count once."""
    thin, place = plate.thin, (0.4137, 0.3719)
    if thin.edges == EDGES["SSSS"]:
        given = thin.mass_per_area, thin.stiffness, thin.size, place
        return plate_modes(*given, highest, thin.foundation, shear=plate.shear).merged().frequency
    return thick_modes(plate, place, highest).merged().frequency


PUBLISHED = [
    ("SSSS", 0.1, (1.9317, 4.6084, 7.0716, 8.6162)),
    ("SSSS", 0.2, (1.7679,)),
    ("CCCC", 0.1, (3.2954, 6.2858, 8.8098, 10.3788, 10.4778)),
    ("CCCC", 0.2, (2.6875,)),
]


@pytest.mark.parametrize(("edges", "slenderness", "expected"), PUBLISHED)
def test_published_frequencies(edges, slenderness, expected):
    """Liew, Xiang & Kitipornchai 1993, Comput. Struct. 49:1, tables of square plates with κ = 5/6: ω b²/π² √(ρ h/D)."""
    found = every_frequency(square(edges, slenderness, 5 / 6)) / math.pi**2
    assert found[: len(expected)] == pytest.approx(expected, rel=3e-5)


def test_ritz_has_the_frequencies_of_the_closed_form():
    """Also where each half-wave has a bed that is too soft to matter."""
    exact = every_frequency(square("SSSS", 0.1))
    found = every_frequency(square("SSSS", 0.1, foundation=1e-9))
    branch, _ = sheared_waves(square("SSSS", 0.1).strip, math.pi * np.sqrt([2.0, 5.0, 8.0, 10.0]))
    assert exact[:4] == pytest.approx(np.sqrt(branch[0]), rel=1e-12)
    (ritz,) = zip(
        *((rows[0],) for rows in thick_plate._ritz(square("SSSS", 0.1), ((0.41, 0.37),), [20, 20])), strict=True
    )
    assert np.sort(np.concatenate(ritz))[:3] == pytest.approx(exact[[0, 1, 1]], rel=1e-9)
    assert found == pytest.approx(exact, rel=1e-9)


def test_a_thin_plate_has_the_frequencies_of_kirchhoffs_theory():
    """Nothing locks: 36.0 of a clamped plate, Leissa's 3.492 of a cantilever, three rigid motions of a free one."""
    for edges, lowest in (("CCCC", 35.985), ("CFFF", 3.4711)):
        plate = square(edges, 1e-3)
        assert every_frequency(plate, 3 * lowest)[0] == pytest.approx(lowest, rel=3e-4)
    free = thick_modes(square("FFFF", 0.1), (0.2, 0.3), 100.0)
    rigid = free.frequency == 0.0
    assert np.count_nonzero(rigid) == 3
    assert free.share[rigid].sum() == pytest.approx(1 + 12 * (0.3**2 + 0.2**2) / (1 + 0.1**2), rel=1e-6)


@pytest.mark.parametrize("slender", [0.2, 0.6, 1.2])
def test_waves_are_those_of_an_elastic_layer(slender):
    """Frequency and displacement of a face, Rayleigh and Lamb's; the errors are of the fourth power of k h."""
    thickness = 0.01
    bending = YOUNG * thickness**3 / 12 / (1 - RATIO**2)
    thin = Panel(7850.0 * thickness, (bending, RATIO * bending, bending, 0.35 * bending), (1.0, 1.0), EDGES["SSSS"])
    plate, wave = ThickPanel(thin, shear_of(bending, thickness, RATIO)), slender / thickness
    branch, turn = (rows[0] for rows in sheared_waves(plate.strip, np.array([wave])))
    exact, share = lowest_wave(wave, thickness)
    inertia = plate.thin.mass_per_area + plate.strip.turning * turn**2
    own = (1 - plate.bulge * wave * turn) ** 2 / inertia
    assert np.sqrt(branch) == pytest.approx(exact, rel=5e-4 * slender**4)
    assert own == pytest.approx(share, rel=5e-3 * slender**4)


@pytest.mark.parametrize(("size", "position"), [((0.2, 0.2), (0.1, 0.1)), ((0.2, 0.4), (0.05, 0.2))])
@pytest.mark.parametrize("slenderness", [5, 10, 40])
def test_static_deflection_is_that_of_an_elastic_layer(size, position, slenderness):
    """Less the half-space, so that nothing of the contact is counted twice; and more than all vibrations together."""
    thickness = size[0] / slenderness
    sides, place = ([f"{x} m" for x in pair] for pair in (size, position))
    plate, thin = (
        fm.Plate(STEEL, f"{thickness} m", size=sides, position=place, theory=theory) for theory in ("auto", "kirchhoff")
    )
    exact = neglected_deflection(thickness, size, position)
    assert plate.compliance - thin.compliance == pytest.approx(exact, abs=2e-3 * thin.compliance / slenderness)
    lacking = plate.compliance - plate.modes(1e12).compliance
    assert lacking > (0.0 if slenderness > 5 else -0.04 * plate.compliance)  # one vibration, less the half-space


@pytest.mark.slow
@pytest.mark.parametrize("edges", ["CCCC", "CSFF", "CFFF"])
def test_static_deflection_converges(edges):
    """Its bound is small, and vibrations have less of it."""
    plate, position = square(edges, 0.1), (0.5, 0.45)
    found, error = thick_compliance(plate, position)
    assert error < 3e-4 * found
    below = thick_modes(plate, position, 1e9).compliance
    assert 0.8 * found < below < found


# ---------------------------------------------------------------- impacts


def ball_on(plate, mass, tolerance=1e-4):
    ball = fm.Sphere("10 mm", "1 m/s", material=STEEL, mass=f"{mass} kg")
    effects = fm.Effects(tolerance=tolerance, gravity=False, boundary_reflections=True)
    return fm.Scene(ball, plate, fm.Contact("hertz"), effects)


def steel_plate(slenderness, edges=S, **more):
    return fm.Plate(STEEL, f"{0.2 / slenderness} m", size=["0.2 m", "0.2 m"], edges=edges, **more)


@pytest.mark.parametrize(("slenderness", "mass"), [(10, 3.0), (20, 0.3)])
def test_impact_against_an_independent_integration(slenderness, mass):
    """The layer's lowest waves and its static deflection, integrated by SciPy."""
    from test_thick_plates import SIDE, largest_force_time_and_rebound

    plate = steel_plate(slenderness, theory="mindlin")
    thickness = SIDE / slenderness
    number, share = waves((0.1, 0.1), (SIDE, SIDE), 1.15 / thickness)
    exact, moved = np.array([lowest_wave(k, thickness) for k in number]).T
    rest = plate.compliance - float(np.sum(share * moved / exact**2))
    force, time, rebound = largest_force_time_and_rebound(mass, exact, share * moved, rest)
    history = fm.simulate(ball_on(plate, mass), accuracy=1e-4)
    assert history.summary["maximum_force"] == pytest.approx(force, rel=2e-3)
    assert history.summary["contact_duration"] == pytest.approx(time, rel=2e-3)
    assert abs(history.summary["rebound_velocity"]) == pytest.approx(abs(rebound), abs=2e-3)


def test_shear_lowers_the_force_and_is_warned_of_without_it():
    thin, thick = (fm.simulate(ball_on(steel_plate(10, theory=theory), 3.0)) for theory in ("kirchhoff", "mindlin"))
    assert thick.summary["maximum_force"] / thin.summary["maximum_force"] - 1 == pytest.approx(-0.022, abs=0.002)
    assert any('theory = "mindlin" has it' in warning for warning in thin.warnings)
    assert not any("thickness" in warning for warning in thick.warnings)


def test_auto_takes_the_closed_form_wherever_it_is_known():
    """Not in an infinite plate, between other edges, on a bed, near an edge, or if the plate is no plate."""
    auto, asked = (fm.simulate(ball_on(steel_plate(20, theory=theory), 0.3)) for theory in ("auto", "mindlin"))
    assert auto.summary["maximum_force"] == asked.summary["maximum_force"]
    for slenderness, more, sheared in (
        (20, {}, True),
        (20, {"in_plane": "fixed"}, True),
        (20, {"edges": C}, False),
        (20, {"foundation_stiffness": "1e6 N/m^3"}, False),
        (20, {"position": ["9 mm", "50 mm"]}, False),
        (4, {}, False),
    ):
        plate, thin = steel_plate(slenderness, **more), steel_plate(slenderness, **more, theory="kirchhoff")
        assert plate.sheared == sheared and (plate.compliance != thin.compliance) == sheared
        assert (plate.modes(2e5).frequency[0] < thin.modes(2e5).frequency[0]) == sheared


def test_an_infinite_plate_names_the_remedy():
    scene = ball_on(steel_plate(20), 9e-4).replace({"effects.boundary_reflections": "auto", "impactor.radius": "3 mm"})
    (warning,) = (text for text in fm.simulate(scene).warnings if "thickness" in text)
    assert 'theory = "mindlin" has it' in warning


def test_membrane_forces_on_few_vibrations():
    """A thick plate has fewer than those that carry membrane forces."""
    scene = ball_on(steel_plate(10, in_plane="fixed"), 3.0, 1e-2).replace({"effects.stretching": True})
    stiff, soft = (fm.simulate(scene.replace({"target.in_plane": kind}), accuracy=1e-2) for kind in ("fixed", "free"))
    assert stiff.summary["maximum_force"] == pytest.approx(soft.summary["maximum_force"], rel=1e-2)


def test_what_is_not_known_is_refused():
    layers = {"layup": [["carbon/epoxy UD", "5 mm", 0]], "material": "carbon/epoxy UD"}
    for plate, words in (
        ({**layers, "size": ["0.2 m", "0.2 m"]}, "plate of layers"),
        ({"material": STEEL, "thickness": "20 mm"}, "needs a plate with a size"),
        (
            {
                "material": STEEL,
                "thickness": "20 mm",
                "size": ["0.2 m", "0.2 m"],
                "edges": [C, F, F, F],
                "position": ["0.2 m", "0.1 m"],
            },
            "within its thickness of an edge",
        ),
        ({"material": STEEL, "thickness": "1 mm", "size": ["0.2 m", "0.2 m"], "edges": C}, "too many vibrations"),
    ):
        with pytest.raises(fm.SceneError, match=words):
            fm.Plate(**plate, theory="mindlin")
        assert not fm.Plate(**plate).sheared
    infinite = ball_on(steel_plate(10, theory="mindlin"), 0.3).replace({"effects.boundary_reflections": False})
    with pytest.raises(fm.SimulationError, match="has no impedance"):
        choose(infinite)


@pytest.mark.slow
def test_sweeps_components_and_derivatives_follow_the_same_plate():
    scene = ball_on(steel_plate(10, edges=C, theory="mindlin"), 0.3)
    velocities = np.linspace(0.5, 1.5, 40)
    batch = fm.simulate_batch(scene, velocity=[f"{v!r} m/s" for v in velocities.tolist()])
    for row in (0, 20, 39):
        one = fm.simulate(scene.replace({"impactor.velocity": f"{velocities[row]} m/s"}))
        assert batch.summary["maximum_force"][row] == pytest.approx(one.summary["maximum_force"], rel=2e-3)
    assert fm.ImpactComponent(scene).choice.scene.target.theory == "mindlin"
    history = fm.simulate(scene, derivatives=["impactor.velocity"])
    force = [
        fm.simulate(scene.replace({"impactor.velocity": f"{v} m/s"}), accuracy=1e-6).summary["maximum_force"]
        for v in (0.99, 1.01)
    ]
    found = history.derivatives.values["maximum_force"]["impactor.velocity"]
    assert found == pytest.approx((force[1] - force[0]) / 0.02, rel=0.02)


@pytest.mark.slow
def test_strain_is_that_of_the_thin_plate_far_from_the_force():
    """Curvatures are those of the rotations."""
    sensors = [{"name": "far", "position": ["50 mm", "60 mm"], "strain": True}]
    thin, thick = (
        fm.simulate(ball_on(steel_plate(40, edges, theory=theory, sensors=sensors), 30.0)).sensed_si(
            np.linspace(0, 2e-3, 400)
        )
        for edges, theory in ((C, "kirchhoff"), (C, "mindlin"))
    )
    assert np.abs(thick.strain_x).max() == pytest.approx(np.abs(thin.strain_x).max(), rel=0.05)
    assert np.abs(thick.displacement).max() == pytest.approx(np.abs(thin.displacement).max(), rel=0.05)
