"""Laws whose curve depends on one more number: all curves from one fit, alone, in batches and in sweeps."""

import math

import numpy as np
import pytest
from cases import SPHERE, scene

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_model.core import families, native
from film_model.effects.many import problems_of
from film_model.laws.jackson_green import Plastic
from film_model.problem.curve import curve_of
from film_model.problem.families import EDGES, page_of
from film_model.problem.mixtures import mixed_numbers, mixture_of
from film_model.solve.batch import simulate_many

STRENGTHS = np.geomspace(60e6, 4e9, 40)  # Pa, over three pages


def law_of(strain, ratio=0.3):
    return fm.JacksonGreen(*SPHERE, strain * SPHERE[0], ratio)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.45])
def test_curves_of_a_family_are_the_law(ratio):
    """Force, work by the force's integral, and the end, between the nodes of every page."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for strain in (2.3e-6, 3.1e-5, 1.7e-4, 2.2e-3, 8.7e-3, 0.023, 0.06):
        law = law_of(strain, ratio)
        curve, plastic = curve_of(law), Plastic(law.shape, law.yield_factor, mended=True)
        assert curve.page is not None and curve.fit_error < 2e-11
        last = curve.native.stage[curve.native.stages - 1]
        assert last.end == pytest.approx(plastic.end, rel=1e-12)
        for xi in np.geomspace(2.0, last.end, 25).tolist():
            assert curve.force(xi) == pytest.approx(float(plastic(np.array([xi]))[0]), rel=2e-11)
        for a in np.geomspace(2.0, 0.5 * last.end, 8).tolist():
            x = a + 0.25 * a * (nodes + 1.0)
            integral = float((plastic(x) * weights).sum()) * 0.25 * a
            assert curve.work(1.5 * a) - curve.work(a) == pytest.approx(integral, rel=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("constants", ["continuous", "printed"])
def test_curves_of_a_mixture_are_the_law(constants):
    """Force and end for any Poisson's ratio and strength, between the nodes; the work of a family over one number."""
    rng = np.random.default_rng(3)
    for strain in (2.3e-6, 1.7e-4, 2.2e-3, 8.7e-3, 0.06):
        for ratio in rng.uniform(-0.99, 0.5, 3).tolist():
            law = fm.JacksonGreen(*SPHERE, strain * SPHERE[0], ratio, constants)
            page = mixture_of(law, law.shaped_beside)
            plastic = Plastic(law.shape, law.yield_factor, constants == "continuous")
            (row,) = mixed_numbers(page, lambda _, law=law: law, 1)
            curve, other = page.at(row), curve_of(law).native
            last, stage = curve.stage[curve.stages - 1], curve.stages - 1
            assert last.end == plastic.end and page.fit_error < 1e-12
            for xi in np.geomspace(2.0, last.end, 12).tolist():
                force, work = native.stage_law(curve, stage, xi)
                assert force == pytest.approx(float(plastic(np.array([xi]))[0]), rel=1e-11)
                assert work == pytest.approx(native.stage_law(other, stage, xi)[1], rel=1e-10, abs=1e-10)
    with pytest.raises(ValueError, match="outside of all pages"):
        mixture_of(law_of(0.15), ["poissons_ratio"])


@pytest.mark.parametrize("target", ["half-space", "plate"])
def test_poissons_ratio_and_strength_vary_together_as_each_alone(target):
    base = scene("hertz", target).replace({"contact.law": "jackson-green", "contact.yield_strength": "1 GPa"})
    ratios = np.linspace(0.1, 0.45, STRENGTHS.size)
    result = simulate_many(base, {"contact.yield_strength": STRENGTHS, "contact.poissons_ratio": ratios})
    assert len(result.problems) <= 6 and not (result.status < 0).any()
    for row in (0, 13, 39):
        own = {"contact.yield_strength": f"{float(STRENGTHS[row])!r} Pa", "contact.poissons_ratio": float(ratios[row])}
        alone = fm.simulate(base.replace(own), accuracy=1e-8).summary
        for name in ("coefficient_of_restitution", "maximum_force", "contact_duration"):
            assert result.summary[name][row] == pytest.approx(alone[name], rel=2e-4), name


def test_a_page_is_made_once_and_outside_of_all_pages_a_law_has_its_own_curve():
    assert page_of(law_of(2e-3)) is page_of(law_of(7e-3)) is not page_of(law_of(2e-2))
    assert curve_of(law_of(2e-3)) is curve_of(fm.JacksonGreen(100e9, 1.0, 100e9 * 2e-3, 0.3))
    for strain in (5e-7, 0.15):
        assert not EDGES[0] <= strain < EDGES[-1]
        assert page_of(law_of(strain)) is None and curve_of(law_of(strain)).fit_error < 1e-11


@pytest.mark.parametrize("target", ["half-space", "plate"])
def test_a_swept_strength_is_marched_together_and_as_each_alone(target):
    base = scene("hertz", target).replace({"contact.law": "jackson-green", "contact.yield_strength": "1 GPa"})
    result = simulate_many(base, {"contact.yield_strength": STRENGTHS, "impactor.velocity": np.full(40, 0.5)})
    assert len(result.problems) <= 6 and not (result.status < 0).any()
    for row in (0, 13, 39):
        own = base.replace({"contact.yield_strength": f"{float(STRENGTHS[row])!r} Pa", "impactor.velocity": "0.5 m/s"})
        alone = fm.simulate(own, accuracy=1e-8).summary
        for name in ("coefficient_of_restitution", "maximum_force", "permanent_indentation"):
            assert result.summary[name][row] == pytest.approx(alone[name], rel=2e-4), name
    restitution = result.summary["coefficient_of_restitution"]
    assert (np.diff(restitution[:34]) > 0.0).all() and np.ptp(restitution[36:]) < 1e-4


def test_strength_and_modulus_vary_with_one_curve_per_page():
    base = scene("hertz").replace({"contact.law": "jackson-green", "contact.yield_strength": "1 GPa"})
    moduli = np.geomspace(50e9, 400e9, 30)
    columns = {"contact.yield_strength": np.geomspace(2e8, 1e9, 30), "contact.effective_modulus": moduli}
    base = base.replace({"contact.effective_modulus": "100 GPa"})
    found = problems_of(base, columns, 30)
    assert sum(part.impacts.index.size for part in found) == 30 and len(found) <= 4


@pytest.mark.slow
def test_sweeps_of_strength_sample_each_impact_by_its_own_curve():
    base = scene("hertz").replace({"contact.law": "jackson-green", "contact.yield_strength": "1 GPa"})
    swept = {"contact.yield_strength": ["0.4 GPa", "0.9 GPa", "1.6 GPa"]}
    dense = fd.sweep(base, swept, keep="samples=21")
    for k, strength in enumerate(swept["contact.yield_strength"]):
        history = fm.simulate(base.replace({"contact.yield_strength": strength}), accuracy=1e-8)
        force = dense["sampled_contact_force"].isel(contact_yield_strength=k).values
        times = np.linspace(0.0, 1.0, 21) * history.summary["contact_duration"]
        expected = history.sample_si(times).contact_force
        np.testing.assert_allclose(force, expected, atol=1e-4 * history.summary["maximum_force"])


@pytest.mark.parametrize("gamma", [0.0, 0.1])
def test_lanes_with_a_shape_each_give_the_march_of_each_curve(gamma):
    """By every instruction set the same bytes, whatever the others are; as `film_impact` on the curve of the shape,
    on a half-space with finer lines, which lanes do not need there."""
    page = page_of(law_of(2e-3))
    rng = np.random.default_rng(7)
    start = np.zeros(150, native.START_DTYPE)
    start["nu"], start["gamma"] = np.exp(rng.uniform(np.log(0.3), np.log(5000.0), start.size)), gamma
    start["time_limit"], shape = np.inf, np.exp(rng.uniform(np.log(1.001e-3), np.log(9.99e-3), start.size))
    mesh = native.mesh(native.WORK_PRESERVING, 16, 32)
    status, table = families.batch(families.Rows(page.whole, page.family, shape), mesh, start)
    assert set(status.tolist()) == {native.EVENT, native.BEYOND_LAW}
    for using in range(native.instructions()):
        other = families.batch(families.Rows(page.whole, page.family, shape), mesh, start, using)
        assert (other[0] == status).all() and other[1][status > 0].tobytes() == table[status > 0].tobytes()
    some = families.batch(families.Rows(page.whole, page.family, shape[::3]), mesh, start[::3])
    assert some[1][status[::3] > 0].tobytes() == table[::3][status[::3] > 0].tobytes()
    fine = native.mesh(native.WORK_PRESERVING, 300, 300) if gamma == 0.0 else mesh
    for row in range(start.size):
        alone, one = native.impact(page.at(float(shape[row])), fine, native.Start(*start[row].tolist()))
        assert alone == status[row]
        names = ("maximum_force", "maximum_indentation", "contact_duration", "final_velocity") if alone > 0 else ()
        for name in names:
            close = 1e-11 if gamma == 0.0 else 1e-5
            if gamma == 0.0 and name == "contact_duration":
                close = 1e-6  # 16 lines, where the impact is left to the march
            assert table[name][row] == pytest.approx(getattr(one, name), rel=close), (row, name)


@pytest.mark.parametrize(
    ("contact", "path", "values"),
    [
        ({"law": "walton-braun", "loading_stiffness": "1 MN/m", "unloading_stiffness": "2 MN/m"},
         "contact.unloading_stiffness", np.linspace(1e6, 5e6, 9)),
        ({"law": "luding", "loading_stiffness": "1 MN/m", "plastic_stiffness": "4 MN/m", "plasticity_depth": 1e-3},
         "contact.plastic_stiffness", np.linspace(2e6, 8e6, 9)),
        ({"law": "kogut-etsion", "hardness": "2 GPa", "poissons_ratio": 0.3},
         "contact.poissons_ratio", np.linspace(0.2, 0.4, 9)),
        ({"law": "meyer", "stiffness": "2e10 N/m^2", "exponent": 2.0}, "contact.stiffness", np.linspace(1e10, 4e10, 9)),
    ],
    ids=["walton-braun", "luding", "kogut-etsion", "meyer"],
)  # fmt: skip
@pytest.mark.parametrize("target", ["half-space", "plate"])
def test_laws_that_differ_in_numbers_of_powers_are_one_problem(contact, path, values, target):
    base = scene("hertz", target).replace({"contact": contact, "impactor.velocity": "2 m/s", "effects.gravity": False})
    result = simulate_many(base, {path: values, "impactor.velocity": np.linspace(1.0, 3.0, values.size)})
    assert len(result.problems) == 1 and not (result.status < 0).any()
    unit = {"contact.poissons_ratio": "", "contact.stiffness": " N/m^2"}.get(path, " N/m")
    for row in (1, 8):
        number = f"{float(values[row])!r}{unit}"
        own = base.replace({path: number, "impactor.velocity": f"{1.0 + 0.25 * row!r} m/s"})
        alone = fm.simulate(own, accuracy=1e-8).summary
        for name in ("coefficient_of_restitution", "maximum_force", "contact_duration"):
            assert result.summary[name][row] == pytest.approx(alone[name], rel=2e-4), name


def test_the_core_refuses_a_shape_outside_its_page():
    page = page_of(law_of(2e-3))
    with pytest.raises(ValueError, match="not between"):
        page.at(2e-2)
    curve = page.at(2e-3)
    assert native.library().film_check_curve(native.c.byref(curve)) == native.OK
    assert math.isfinite(curve.stage[curve.stages - 1].end)


@pytest.mark.slow
def test_an_fmu_serves_other_strengths_and_refuses_those_beyond_its_family(tmp_path):
    base = scene("hertz", segments=40).replace({"contact.law": "jackson-green", "contact.yield_strength": "1 GPa"})
    base = base.replace({"effects.gravity": False})
    fmu = fmu_wrapper.export(base, tmp_path / "impact.fmu")
    for strength in ("1 GPa", "0.4 GPa", "2.1 GPa"):
        found = fmu_wrapper.run(fmu, start_values={"yield_strength": strength}, stop_time="1 ms", step_size="1 ms")
        expected = fm.simulate(base.replace({"contact.yield_strength": strength})).summary
        for name in ("maximum_force", "contact_duration", "rebound_velocity"):
            assert float(found[name]) == pytest.approx(expected[name], rel=1e-10), (strength, name)
    with pytest.raises(Exception, match="this FMU was exported for shapes from"):
        fmu_wrapper.run(fmu, start_values={"yield_strength": "8 GPa"}, stop_time="1 ms", step_size="1 ms")


def test_impacts_that_vary_in_modulus_and_radius_are_marched_together():
    scene = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    spread = np.linspace(0.99, 1.01, 64)
    columns = {"impactor.radius": 0.01 * spread, "target.material.youngs_modulus": 206e9 * spread[::-1]}
    columns["target.material.yield_strength"] = 250e6 * np.roll(spread, 7)
    assert len(problems_of(scene, columns, spread.size)) == 1


@pytest.mark.parametrize("target", ["half-space", "plate"])
def test_swept_poissons_ratios_and_strengths_are_fitted_together_and_are_those_of_each_alone(target):
    """Two numbers on which the curve depends: each impact has its own numbers of one curve."""
    base = scene("hertz", target).replace({"contact.law": "jackson-green", "contact.yield_strength": "1 GPa"})
    ratios, strengths = np.linspace(0.0, 0.49, 300), np.geomspace(0.2e9, 3e9, 300)
    columns = {"contact.poissons_ratio": ratios, "contact.yield_strength": strengths}
    result = simulate_many(base, columns)
    assert len(result.problems) <= 3 and not (result.status < 0).any()
    for row in (0, 77, 150, 299):
        texts = {"contact.poissons_ratio": ratios[row], "contact.yield_strength": f"{float(strengths[row])!r} Pa"}
        alone = fm.simulate(base.replace(texts), accuracy=1e-9).summary
        for name in ("maximum_force", "coefficient_of_restitution", "contact_duration"):
            allowed = 1.2 * float(result.estimated[row]) + 1e-9
            assert result.summary[name][row] == pytest.approx(alone[name], rel=allowed), (row, name)
    few = {path: values[::60].tolist() for path, values in columns.items()}
    few["contact.yield_strength"] = [f"{value!r} Pa" for value in few["contact.yield_strength"]]
    ds = fd.sweep(base, few, "zip", keep="segments")
    motion = ds.film.sample(["0 s"], impact=3)
    assert float(motion.relative_velocity[0]) == pytest.approx(base.approach_velocity, rel=1e-12)
