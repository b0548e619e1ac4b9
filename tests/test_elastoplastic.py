"""Law elastoplastic: against the finite elements that it is fitted to, over materials, in sweeps, far from yield."""

import math

import numpy as np
import pytest
from cases import SPHERE, scene

import film_model as fm
from film_model.core import families, native
from film_model.laws.yielding import limit_point
from film_model.problem.curve import curve_of
from film_model.problem.families import page_of
from film_model.problem.mixtures import mixed_numbers, mixture_of
from film_model.solve.batch import simulate_many

FINITE_ELEMENTS = [  # V/V_Y, E/S_y, n, ν; restitution, δ/δ_Y, F/F_Y, residual δ/δ_Y, all over those at p_max = C S_y
    (2.0, 200.0, 0.0, 0.3, 0.9772, 1.740, 2.2749, 0.08798),
    (10.0, 200.0, 0.0, 0.3, 0.8319, 6.551, 14.49, 2.007),
    (100.0, 200.0, 0.0, 0.3, 0.5919, 48.02, 187.65, 30.37),
    (1000.0, 200.0, 0.0, 0.3, 0.3731, 391.9, 2178.1, 329.2),
    (103.0, 780.581, 0.0, 0.4331, 0.5786, 49.61, 190.41, 31.73),
    (199.301, 175.42, 0.2943, 0.2355, 0.6374, 81.81, 447.43, 47.74),
    (639.015, 263.206, 0.2443, 0.2129, 0.5320, 230.2, 1605.0, 162.3),
    (189.891, 72.9024, 0.0, 0.2967, 0.5079, 85.69, 367.1, 61.37),
    (9.7072, 62.4989, 0.2912, 0.4347, 0.8742, 6.316, 14.316, 1.478),
    (98.0787, 67.1483, 0.2137, 0.3812, 0.6521, 45.3, 194.49, 25.49),
    (929.242, 995.555, 0.2707, 0.3416, 0.5086, 320.5, 2416.6, 233.1),
    (376.826, 130.971, 0.01909, 0.4489, 0.4520, 160.5, 764.14, 122.4),
]
MASS, MATERIALS = 0.01, 200


def law_of(strain, exponent=0.0, ratio=0.3):
    return fm.Elastoplastic(*SPHERE, strain * SPHERE[0], ratio, exponent)


@pytest.mark.parametrize("run", FINITE_ELEMENTS)
def test_impacts_are_those_of_the_finite_elements(run):
    speed, stiffness, exponent, ratio, restitution, depth, force, residual = run
    law = law_of((1.0 - ratio**2) / stiffness, exponent, ratio)
    length, unit = law.scales(0.0)
    velocity = speed * math.sqrt(0.8 * length * unit / MASS)
    ball = fm.Sphere("10 mm", velocity=f"{velocity!r} m/s", mass=f"{MASS} kg")
    found = fm.simulate(fm.Scene(ball, fm.HalfSpace(), fm.Contact(law), fm.Effects(gravity=False))).summary
    assert found["coefficient_of_restitution"] == pytest.approx(restitution, rel=0.05)
    assert found["maximum_indentation"] == pytest.approx(depth * length, rel=0.023)
    assert found["maximum_force"] == pytest.approx(force * unit, rel=0.036)
    assert found["permanent_indentation"] == pytest.approx(residual * length, abs=0.046 * depth * length)


def test_restitution_falls_with_velocity_from_1_at_first_yield_for_any_material():
    rng = np.random.default_rng(11)
    modulus, ratio = np.exp(rng.uniform(np.log(5e9), np.log(5e11), MATERIALS)), rng.uniform(0.1, 0.45, MATERIALS)
    strength = modulus * np.exp(rng.uniform(np.log(3e-4), np.log(2e-2), MATERIALS))
    exponent, speeds = rng.uniform(0.0, 0.6, MATERIALS), np.geomspace(1.0001, 150.0, 24)
    pressure = 1.295 * np.exp(0.736 * ratio) * strength
    critical = np.sqrt(0.8 * math.prod(limit_point(modulus, 0.01, pressure)) / MASS)
    base = fm.Scene(
        fm.Sphere("10 mm", velocity="1 m/s", mass=f"{MASS} kg"),
        fm.HalfSpace(fm.Material("one", "100 GPa", 0.3, "7850 kg/m^3", "1 GPa", strain_hardening_exponent=0.1)),
        fm.Contact("elastoplastic", effective_modulus="100 GPa", poissons_ratio=0.3),
        fm.Effects(gravity=False, target_motion=False),
    )
    columns = {
        "impactor.velocity": np.outer(speeds, critical).ravel(),
        "contact.effective_modulus": np.tile(modulus, speeds.size),
        "contact.poissons_ratio": np.tile(ratio, speeds.size),
        "target.material.yield_strength": np.tile(strength, speeds.size),
        "target.material.strain_hardening_exponent": np.tile(exponent, speeds.size),
    }
    result = simulate_many(base, columns)
    assert not (result.status < 0).any() and len(result.problems) <= 5
    restitution = result.summary["coefficient_of_restitution"].reshape(speeds.size, MATERIALS)
    np.testing.assert_allclose(restitution[0], 1.0, rtol=1e-5)
    assert (np.diff(restitution, axis=0) < 1e-9).all()


@pytest.mark.parametrize("strain", [2.3e-6, 1.7e-4, 2.2e-3, 8.7e-3, 0.06])
def test_curves_of_a_family_and_of_a_mixture_are_the_law(strain):
    """Force, unloading and end, between the nodes of every page."""
    for exponent in (0.013, 0.31, 0.59):
        law = law_of(strain, exponent)
        *_, last = law.stages()
        page = mixture_of(law)
        (row,) = mixed_numbers(page, lambda _, law=law: law, 1)
        for curve in (page.at(row), curve_of(law).native):
            stage = curve.stages - 1
            assert curve.stage[stage].end == pytest.approx(last.end, rel=1e-12)
            for xi in np.geomspace(1.001, last.end, 25).tolist():
                at = np.array([xi])
                assert native.stage_law(curve, stage, xi)[0] == pytest.approx(last.force(at).item(), rel=5e-11)
                pieces = curve.piece[curve.stage[stage].first : curve.pieces]
                own = next((piece for piece in pieces if xi <= piece.end), pieces[-1]).recovery
                x = (xi - own.origin) * own.per_span
                value = np.polynomial.chebyshev.chebval(2.0 * x - 1.0, own.series[: own.terms])
                assert value == pytest.approx(last.unloading.secant(at).item(), rel=5e-11)


@pytest.mark.parametrize("gamma", [0.0, 0.1])
def test_lanes_unload_each_by_its_own_law(gamma):
    """By every instruction set the same bytes; as `film_impact` on the curve of the shape."""
    page, rng = page_of(law_of(2e-3, 0.1)), np.random.default_rng(7)
    start = np.zeros(120, native.START_DTYPE)
    start["nu"], start["gamma"] = np.exp(rng.uniform(np.log(0.3), np.log(2000.0), start.size)), gamma
    start["time_limit"], shape = np.inf, np.exp(rng.uniform(np.log(1.001e-3), np.log(9.99e-3), start.size))
    mesh = native.mesh(native.WORK_PRESERVING, 16, 32)
    status, table = families.batch(page.family, page.whole, mesh, start, shape)
    assert native.EVENT in status
    for using in range(native.instructions()):
        other = families.batch(page.family, page.whole, mesh, start, shape, using)
        assert (other[0] == status).all() and other[1][status > 0].tobytes() == table[status > 0].tobytes()
    for row in range(start.size):
        alone, one = native.impact(page.at(float(shape[row])), mesh, native.Start(*start[row].tolist()))
        assert alone == status[row]
        for name in ("maximum_force", "final_velocity", "permanent_indentation") if alone > 0 else ():
            close = 1e-11 if gamma == 0.0 else 1e-5
            assert table[name][row] == pytest.approx(getattr(one, name), rel=close, abs=1e-12), (row, name)


@pytest.mark.parametrize("target", ["half-space", "plate"])
def test_strength_and_hardening_vary_together_as_each_alone(target):
    base = scene("hertz", target).replace({"contact.law": "elastoplastic"})
    columns = {
        "target.material.yield_strength": np.geomspace(1e8, 9e8, 40),
        "target.material.strain_hardening_exponent": np.linspace(0.0, 0.5, 40),
    }
    result = simulate_many(base, columns)
    assert len(result.problems) <= 4 and not (result.status < 0).any()
    for row in (0, 13, 39):
        own = {path: float(values[row]) for path, values in columns.items()}
        own["target.material.yield_strength"] = f"{own['target.material.yield_strength']!r} Pa"
        alone = fm.simulate(base.replace(own), accuracy=1e-8).summary
        for name in ("coefficient_of_restitution", "maximum_force", "permanent_indentation"):
            assert result.summary[name][row] == pytest.approx(alone[name], rel=2e-4), name


@pytest.mark.parametrize(("material", "speed"), [("mild steel", 100), ("aluminium", 75), ("copper", 50)])
def test_shot_peening_is_simulated_and_warned_of(material, speed):
    ball = fm.Sphere("0.5 mm", velocity=f"{speed} m/s", material="bearing steel")
    history = fm.simulate(fm.Scene(ball, fm.HalfSpace(material)))
    assert history.problem.law.name == "elastoplastic"
    assert 0.1 < history.summary["coefficient_of_restitution"] < 0.5
    assert any("law elastoplastic: outside its range" in warning for warning in history.warnings)


def test_a_wide_contact_and_values_that_were_not_computed_are_named():
    law = law_of(0.03, 0.5)
    assert law.outside(0.9) == ""
    said = law.outside(0.9 * law.stages()[-1].end)
    assert "S_y/E is 0.03" in said and "n is 0.5" in said and "the contact radius is 0.9" in said
    with pytest.raises(ValueError, match=r"strain hardening exponent must be from 0 to 0\.6"):
        law_of(0.002, 0.7)
