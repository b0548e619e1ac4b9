"""Law elastoplastic: against the finite elements that it is fitted to, over materials, in sweeps, far from yield."""

import math
from dataclasses import replace

import numpy as np
import pytest
from cases import SPHERE, scene

import film_model as fm
from film_model.core import families, native
from film_model.laws.elastoplastic import MOST_SHARE, Plastic, pressure_factor
from film_model.laws.yielding import limit_point
from film_model.problem.curve import curve_of
from film_model.problem.families import page_of
from film_model.problem.mixtures import mixed_numbers, mixture_of
from film_model.solve.batch import simulate_many

MASS, MATERIALS = 0.01, 200
EXPONENT, SHARE, CURVATURE = "strain_hardening_exponent", "elastic_share", "softer_curvature"


def law_of(strain, exponent=0.0, ratio=0.3, share=0.0):
    return fm.Elastoplastic(*SPHERE, strain * SPHERE[0], ratio, exponent, share)


@pytest.mark.slow
@pytest.mark.parametrize("harder", ["rigid", "elastic", "elastic flat"])
def test_restitution_falls_with_velocity_from_1_at_first_yield_for_any_material(harder):
    rng = np.random.default_rng(11)
    modulus, ratio = np.exp(rng.uniform(np.log(5e9), np.log(5e11), MATERIALS)), rng.uniform(0.1, 0.45, MATERIALS)
    strength = modulus * np.exp(rng.uniform(np.log(3e-4), np.log(2e-2), MATERIALS))
    exponent, speeds = rng.uniform(0.0, 0.6, MATERIALS), np.append([1.01, 1.02], np.geomspace(1.04, 150.0, 24))
    critical = np.sqrt(0.8 * math.prod(limit_point(modulus, 0.01, pressure_factor(ratio) * strength)) / MASS)
    one = fm.Material("one", "100 GPa", 0.3, "7850 kg/m^3", "1 GPa", strain_hardening_exponent=0.1)
    other = None if harder == "rigid" else fm.Material("other", "100 GPa", 0.3, "7850 kg/m^3")
    ball, flat, yields, stays = (
        (one, other, "impactor", "target") if harder == "elastic flat" else (other, one, "target", "impactor")
    )
    base = fm.Scene(
        fm.Sphere("10 mm", velocity="1 m/s", mass=f"{MASS} kg", material=ball),
        fm.HalfSpace(flat),
        fm.Contact("elastoplastic", effective_modulus="100 GPa", poissons_ratio=0.3),
        fm.Effects(gravity=False, target_motion=False),
    )
    columns = {
        "impactor.velocity": np.outer(speeds, critical).ravel(),
        "contact.effective_modulus": np.tile(modulus, speeds.size),
        "contact.poissons_ratio": np.tile(ratio, speeds.size),
        f"{yields}.material.yield_strength": np.tile(strength, speeds.size),
    }
    if harder == "rigid":
        columns["target.material.strain_hardening_exponent"] = np.tile(exponent, speeds.size)
    else:
        columns[f"{stays}.material.youngs_modulus"] = np.tile(1e10 * 100.0 ** (exponent / 0.6), speeds.size)
    result = simulate_many(base, columns)
    assert not (result.status < 0).any() and len(result.problems) <= 5
    restitution = result.summary["coefficient_of_restitution"].reshape(speeds.size, MATERIALS)
    first, twice = 1.0 - restitution[:2]
    assert (first < 2e-5).all()
    np.testing.assert_allclose(twice / first, 4.0, rtol=0.1)  # it leaves 1 without a kink
    assert (np.diff(restitution, axis=0) < 1e-9).all()


def test_the_part_of_the_harder_body_follows_from_both_materials():
    def share(ball, slab, **contact):
        sphere = fm.Sphere("5 mm", "1 m/s", mass="4 g", material=ball)
        return fm.Scene(sphere, fm.HalfSpace(slab), fm.Contact(**contact)).elastic_share

    def steel(strength, modulus="210 GPa", exponent=None):
        strength = strength and f"{strength} MPa"
        return fm.Material("one", modulus, 0.3, "7850 kg/m^3", strength, strain_hardening_exponent=exponent)

    soft = steel(500)
    assert share(soft, soft) == share(steel(None), steel(None)) == 0.0
    assert share(None, soft, effective_modulus="100 GPa") == 0.0
    assert share(steel(None), soft) == share(soft, steel(1400)) == 0.5  # as stiff, and elastic
    assert share(steel(1400, "630 GPa"), soft) == pytest.approx(0.25, rel=1e-15)
    assert share(steel(None, "90 TPa"), soft) < 3e-3 and share(steel(None, "1 GPa"), soft) == MOST_SHARE
    yields = share(steel(750), soft)
    assert yields == pytest.approx(0.5 * (1.0 - (1.192 / 1.692) ** 4.0), rel=1e-12)
    assert share(steel(750, exponent=0.2), soft) > yields > share(steel(750), steel(500, exponent=0.2))
    assert share(steel(750), steel(250), law="elastoplastic", yield_strength="500 MPa") == yields
    assert share(steel(501), soft) == pytest.approx(0.5 * 4.0 * 0.002 / 1.692, rel=0.01)  # from 0 without a jump


def test_with_a_rigid_body_the_law_is_that_of_one_sphere():
    w = np.geomspace(1.0, 1800.0, 50)
    for strain, exponent in ((2e-4, 0.0), (8e-3, 0.3)):
        one, near = Plastic(strain, exponent), Plastic(strain, exponent, 1e-9)
        z, c = (w - 1.0) / 1.762, one.constants
        alpha = np.sqrt(w * (1.0 + c.spread * math.exp(-1.505 * exponent) * np.log(1.0 + z * z)))
        most = c.pressure / (1.0 + (0.5506 * one.first_radius * alpha) ** 1.5)
        mean = 1.0 + most * (1.0 - (1.0 + (np.sqrt(w) - 1.0) / (0.5068 * most)) ** -0.5068)
        force = alpha**2 * mean * (1.0 + 0.5642 * (alpha - 1.0) ** 2 / alpha) ** (0.7185 * exponent)
        np.testing.assert_allclose(one.force(w), force, rtol=1e-13)
        np.testing.assert_allclose(one.contact_radius(w), alpha, rtol=1e-13)
        for name in ("force", "secant", "contact_radius"):
            np.testing.assert_allclose(getattr(near, name)(w), getattr(one, name)(w), rtol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("strain", "beside"),
    [
        *((strain, [EXPONENT]) for strain in (2.3e-6, 1.7e-4, 2.2e-3, 8.7e-3, 0.06)),
        *((strain, [SHARE]) for strain in (1.7e-4, 2.2e-3, 0.06)),
        (8.7e-3, [EXPONENT, SHARE]),
        (2.2e-3, [SHARE, CURVATURE]),
        (8.7e-3, [EXPONENT, SHARE, CURVATURE]),
    ],
)
def test_curves_of_a_family_and_of_a_mixture_are_the_law(strain, beside):
    """Force, unloading and end, between the nodes of every page."""
    close = 2e-9 if CURVATURE in beside else 5e-11
    for values in ((0.013, 0.77, 0.9), (0.31, 0.04, 0.02), (0.59, 0.43, 0.6)):
        given = dict(zip((EXPONENT, SHARE, CURVATURE), values, strict=True))
        law = replace(law_of(strain), **{name: given[name] for name in beside})
        *_, last = law.stages()
        page = mixture_of(law, beside)
        (row,) = mixed_numbers(page, lambda _, law=law: law, 1)
        for curve in (page.at(row), curve_of(law).native):
            stage = curve.stages - 1
            assert curve.stage[stage].end == pytest.approx(last.end, rel=1e-12)
            for xi in np.geomspace(1.001, last.end, 25).tolist():
                at = np.array([xi])
                assert native.stage_law(curve, stage, xi)[0] == pytest.approx(last.force(at).item(), rel=close)
                pieces = curve.piece[curve.stage[stage].first : curve.pieces]
                own = next((piece for piece in pieces if xi <= piece.end), pieces[-1]).recovery
                x = (xi - own.origin) * own.per_span
                value = np.polynomial.chebyshev.chebval(2.0 * x - 1.0, own.series[: own.terms])
                assert value == pytest.approx(last.unloading.secant(at).item(), rel=close)


@pytest.mark.parametrize("gamma", [0.0, 0.1])
def test_lanes_unload_each_by_its_own_law(gamma):
    """By every instruction set the same bytes; as `film_impact` on the curve of the shape."""
    page, rng = page_of(law_of(2e-3, 0.1)), np.random.default_rng(7)
    start = np.zeros(120, native.START_DTYPE)
    start["nu"], start["gamma"] = np.exp(rng.uniform(np.log(0.3), np.log(2000.0), start.size)), gamma
    start["time_limit"], shape = np.inf, np.exp(rng.uniform(np.log(1.001e-3), np.log(9.99e-3), start.size))
    mesh = native.mesh(native.WORK_PRESERVING, 16, 32)
    status, table = families.batch(families.Rows(page.whole, page.family, shape), mesh, start)
    assert native.EVENT in status
    for using in range(native.instructions()):
        other = families.batch(families.Rows(page.whole, page.family, shape), mesh, start, using)
        assert (other[0] == status).all() and other[1][status > 0].tobytes() == table[status > 0].tobytes()
    for row in range(start.size):
        alone, one = native.impact(page.at(float(shape[row])), mesh, native.Start(*start[row].tolist()))
        assert alone == status[row]
        for name in ("maximum_force", "final_velocity", "permanent_indentation") if alone > 0 else ():
            close = 1e-11 if gamma == 0.0 else 1e-5
            assert table[name][row] == pytest.approx(getattr(one, name), rel=close, abs=1e-12), (row, name)


@pytest.mark.slow
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


def two_balls(softer, other, soft="500 MPa"):
    """A ball that yields on a body of another radius (negative: a hollow) that does not, or the other way round."""
    bodies = [fm.Material("one", f"{e} GPa", 0.3, "7850 kg/m^3", y) for e, y in ((200, soft), (300, "5 GPa"))]
    ball, struck = bodies if softer == "ball" else bodies[::-1]
    return fm.Scene(fm.Sphere("5 mm", "3 m/s", mass="4 g", material=ball), fm.HalfSpace(struck, radius=other))


def test_the_softer_body_keeps_its_part_of_the_curvature():
    for softer, parts in (("ball", (0.75, 0.5, 1.0)), ("other", (0.25, 0.5, 0.0))):
        found = [two_balls(softer, radius).softer_curvature for radius in ("15 mm", "5 mm", "-20 mm")]
        assert found == pytest.approx(parts, rel=1e-12)
    flat = {softer: two_balls(softer, "5 mm").replace({"target.radius": None}) for softer in ("ball", "other")}
    assert flat["ball"].softer_curvature == 1.0 and flat["other"].softer_curvature == 0.0
    assert two_balls("ball", "5 mm", "6 GPa").softer_curvature == 0.5  # of the other, which is the softer one now
    one, x = Plastic(2e-3, 0.0, 0.4), 0.3
    assert Plastic(2e-3, 0.0, 0.4, curvature=x).flattening == pytest.approx(one.flattening * (1 - 0.4 * (1 - x)) / 0.6)
    with pytest.raises(ValueError, match="part of the curvature must be from 0 to 1"):
        replace(law_of(2e-3), softer_curvature=1.1)


@pytest.mark.parametrize("softer", ["ball", "other"])
def test_radii_of_two_balls_vary_together_as_each_alone(softer):
    base, radii = two_balls(softer, "5 mm"), np.geomspace(1e-3, 0.1, 30)
    result = simulate_many(base, {"target.radius": radii})
    assert len(result.problems) == 1 and not (result.status < 0).any()
    for row in (0, 11, 29):
        alone = fm.simulate(base.replace({"target.radius": f"{float(radii[row])!r} m"}), accuracy=1e-8).summary
        for name in ("coefficient_of_restitution", "maximum_force", "contact_radius", "permanent_indentation"):
            assert result.summary[name][row] == pytest.approx(alone[name], rel=2e-4), name


@pytest.mark.parametrize("material", ["mild steel", "aluminium", "copper"])
def test_shot_peening_is_simulated_and_warned_of(material):
    ball = fm.Sphere("0.25 mm", velocity="100 m/s", material="bearing steel")
    history = fm.simulate(fm.Scene(ball, fm.HalfSpace(material)))
    assert history.problem.law.name == "elastoplastic"
    assert 0.1 < history.summary["coefficient_of_restitution"] < 0.5
    assert any("law elastoplastic: outside its range" in warning for warning in history.warnings)
    interval = history.intervals["coefficient_of_restitution"]
    assert interval.low < history.summary["coefficient_of_restitution"] <= interval.high
    assert "extrapolated" in interval.evidence


@pytest.mark.parametrize("strain", [1e-6, 1e-4, 2e-3, 2e-2, 0.1])
def test_the_law_ends_where_the_contact_is_as_wide_as_the_ball(strain):
    for exponent, share in ((0.0, 0.0), (0.3, 0.0), (0.6, 0.0), (0.3, 0.5), (0.0, 0.8)):
        plastic = Plastic(strain, exponent, share)
        radius = plastic.first_radius * plastic.contact_radius(plastic.end)
        assert radius == pytest.approx(1.0, abs=1e-3 if share else 1e-4)


def test_a_wide_contact_and_values_that_were_not_computed_are_named():
    law = law_of(0.03, 0.5)
    assert law.outside(0.9) == ""
    said = law.outside(0.9 * law.stages()[-1].end)
    assert "S_y/E is 0.03" in said and "n is 0.5" in said and "the contact radius is 0.9" in said
    assert "the harder body has 0.7 of the compliance" in law_of(0.002, share=0.7).outside(2.0)
    with pytest.raises(ValueError, match=r"strain hardening exponent must be from 0 to 0\.6"):
        law_of(0.002, 0.7)
    with pytest.raises(ValueError, match=r"elastic share must be from 0 to 0\.8"):
        law_of(0.002, share=0.9)


@pytest.mark.parametrize(("speed", "off"), [(0.1, 0.002), (1.0, 0.006), (20.0, 0.05)])
def test_two_equal_balls_rebound_as_one_from_a_rigid_plane(speed, off):
    """By symmetry each is pressed against a plane; the law takes a/R of the effective radius, which is half."""
    steel = fm.Material("one", "210 GPa", 0.3, "7850 kg/m^3", "477 MPa")
    rigid = fm.Material("rigid", "90 TPa", 0.3, "7850 kg/m^3", "1 TPa")
    quiet = fm.Effects(gravity=False)

    def rebound(target, velocity):
        ball = fm.Sphere("5 mm", velocity=f"{velocity} m/s", material=steel)
        return fm.simulate(fm.Scene(ball, target, effects=quiet)).summary["coefficient_of_restitution"]

    one, two = rebound(fm.HalfSpace(rigid), speed), rebound(fm.Body(steel, radius="5 mm"), 2.0 * speed)
    assert 0.0 < 1.0 - two / one < off
