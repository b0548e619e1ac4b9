"""The finite-element impacts: the program against theory, the published runs, and law elastoplastic fitted to them."""

import math
import shutil
import sys
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import film_datasets as fd
import film_model as fm
from film_model.laws.elastoplastic import FITTED
from film_model.laws.yielding import limit_point
from film_model.solve.batch import simulate_many

FOLDER = Path(__file__).parent.parent / "examples" / "finite_elements"
sys.path.insert(0, str(FOLDER))

import again  # noqa: E402
import against_laws as finite_elements  # noqa: E402
import fit  # noqa: E402
import fit_pairs  # noqa: E402
import pair  # noqa: E402
import publish  # noqa: E402
import run  # noqa: E402

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
COARSE = run.Mesh(elements=12)


@pytest.mark.slow
@needs_gcc
def test_an_elastic_ball_rebounds_by_hertz():
    found = run.strike(run.Impact(1.0, 200.0, yields=False), COARSE)
    assert found["restitution"] == pytest.approx(1.0, abs=2e-3)
    assert found["force"] / found["depth"] ** 1.5 == pytest.approx(1.0, rel=5e-3)
    assert found["radius"] / found["depth"] ** 0.5 == pytest.approx(1.0, rel=2e-2)
    assert abs(found["energy"]["plastic"]) == 0.0


@pytest.mark.slow
@needs_gcc
def test_a_ball_that_dents_agrees_with_the_published_run_on_a_finer_mesh():
    ds = fd.load("finite_element_impacts").isel(run=run.TABLE.index(100.0))
    found = run.strike(run.Impact(100.0, 200.0), COARSE)
    assert found["restitution"] == pytest.approx(float(ds["coefficient_of_restitution"]), rel=2e-2)
    assert found["depth"] == pytest.approx(float(ds["largest_depth"]), rel=1e-2)
    assert found["force"] == pytest.approx(float(ds["largest_force"]), rel=3e-2)
    assert abs(found["balance"]) < 5e-3
    assert found["energy"]["hourglass"] < 5e-3


def by_law(impact, later):
    """Restitution, largest depth and force of three impacts under the law, the later ones on the dent of the first.

    later: velocity of these over that of the first; 0: that of the rebound before. An impulse turns the ball round.
    """
    strength, radius = 1e9, 0.01
    modulus = strength / impact.yield_strain
    first = math.sqrt(2.0 * impact.energy * strength * radius**3)  # of 1 kg
    scene = fm.Scene(
        fm.Sphere("10 mm", f"{first!r} m/s", mass="1 kg"),
        fm.HalfSpace(),
        fm.Contact(fm.Elastoplastic(modulus, radius, strength, impact.poisson, impact.hardening)),
        effects=fm.Effects(gravity=False),
    )
    component, before, found = fm.ImpactComponent(scene, accuracy=1e-8), first, []
    for _ in range(3):
        deepest, event = None, None
        while event is None or event.name != "contact_ends":
            (event,) = component.step("1 s", stop_at_events=True).events
            deepest = event if event.name == "maximum_indentation" else deepest
        found.append((-event.impactor_velocity / before, deepest.indentation, deepest.contact_force))
        before = later * first or -event.impactor_velocity
        component.step(1e-9, external_force=(before - event.impactor_velocity) / 1e-9)
    return np.array(found)


def second_impacts():
    """The rows of the table of second impacts in docs/finite_elements.md."""
    page = (FOLDER.parents[1] / "docs" / "finite_elements.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.splitlines() if " | of the " in line]
    return [(run.Impact(*map(float, row[:3])), row[3] == "of the rebound", *map(float, row[4:])) for row in rows]


def test_law_and_finite_elements_agree_on_second_impacts():
    rows = second_impacts()
    assert [row[0] for row in rows[::2]] == list(again.FIRST) and [row[1] for row in rows] == 9 * [True, False]
    for impact, rebounds, *measured, depth, force, yielding in rows:
        law, fast = by_law(impact, 0.0 if rebounds else 1.0), impact.velocity > 200.0
        assert measured[0] == pytest.approx(law[0, 0], rel=0.02)
        assert depth == pytest.approx(law[1, 1] / law[0, 1], rel=0.004)
        assert force == pytest.approx(law[1, 2] / law[0, 2], rel=0.016 if fast else 0.01)
        if rebounds:
            assert law[1:, 0] == pytest.approx(1.0, abs=1e-6)
            assert measured[1:] == pytest.approx([1.0, 1.0], abs=0.0072 if fast else 0.0033)
            assert yielding < (0.016 if fast else 0.007)
        else:
            assert measured[1:] == pytest.approx(law[1:, 0], rel=0.05 if fast else 0.012)


@needs_gcc
@pytest.mark.slow
def test_a_second_impact_is_elastic_in_the_dent():
    """On a coarse mesh, at the velocity of the rebound: the row of the table for 50 V_Y."""
    one, two = again.impacts(run.Impact(50.0, 200.0), (0.0,), run.Mesh(elements=10, slowness=90.0))
    assert one[0] == pytest.approx(0.6625, rel=0.02)
    assert two[0] == pytest.approx(1.0, abs=5e-3) and two[1] == pytest.approx(one[1], rel=5e-3)
    assert two[3] < 5e-3 < one[3]


def test_published_runs():
    ds = fd.load("finite_element_impacts")
    assert fd.validate(ds) == []
    every = publish.HELD_OUT_EVERY
    assert ds["held_out"].values.tolist() == [int(k % every == every - 1) for k in range(ds.sizes["run"])]
    assert np.abs(ds["energy_balance"].values).max() < 2e-3
    assert ds["mesh_error"].values.max() < 1.5e-2
    first = ds.isel(run=slice(0, len(run.TABLE)))
    assert first["velocity_ratio"].values.tolist() == list(run.TABLE)
    assert np.all(np.diff(first["coefficient_of_restitution"].values) < 0.0)
    pressure = first["largest_force"] / first["largest_radius"] ** 2 * 1.295 * np.exp(0.736 * 0.3) * 2.0 / 3.0
    assert 2.7 < float(pressure[-1]) < 3.0  # in Y: full plasticity


@pytest.mark.slow
def test_the_design_is_that_of_the_published_runs():
    ds = fd.load("finite_element_impacts")
    designed = run.design()
    assert [impact.stiffness for impact in designed] == pytest.approx(ds["stiffness_ratio"].values, rel=1e-12)
    assert [impact.velocity for impact in designed] == pytest.approx(ds["velocity_ratio"].values, rel=1e-9)


BOUNDS = {  # median and largest error up to 1000 V_Y, fitted and held out; beyond
    "coefficient_of_restitution": (0.006, 0.02, 0.016, 0.06),
    "largest_force": (0.007, 0.02, 0.008, 0.05),
    "largest_depth": (0.005, 0.011, 0.006, 0.016),
    "largest_radius": (0.006, 0.022, 0.013, 0.03),
    "residual_depth": (0.008, 0.025, 0.009, 0.015),  # of the largest depth: dents near first yield are small
}


def assert_within_bounds(name, errors, ds):
    out, fast = ds["held_out"].values == 1, ds["velocity_ratio"].values > finite_elements.FASTEST
    median, most, median_fast, most_fast = BOUNDS[name]
    for rows, middle, largest in (
        (~fast & out, median, most),
        (~fast & ~out, median, most),
        (fast, median_fast, most_fast),
    ):
        assert np.median(np.abs(errors[rows])) < middle, name
        assert np.abs(errors[rows]).max() < largest, name


@pytest.mark.slow
def test_the_constants_of_the_law_are_those_of_the_fit():
    best, found = fit.main()
    assert astuple(best) == pytest.approx(astuple(FITTED), rel=2e-3)
    for name, values in found.items():
        assert_within_bounds(name, values, fd.load("finite_element_impacts"))


def test_simulated_impacts_are_those_of_the_finite_elements():
    """Every run, simulated: restitution, force, depth, contact radius and dents."""
    ds = fd.load("finite_element_impacts")
    runs = finite_elements.runs_of(ds)
    for name, errors in finite_elements.errors(runs, "elastoplastic").items():
        assert_within_bounds(finite_elements.COMPARED[name], errors, ds)
    found = finite_elements.simulated(runs, "elastoplastic")
    left = found["permanent_indentation"] / ds["residual_depth"].values - 1.0
    assert np.abs(left[ds["residual_depth"].values > 0.4 * ds["largest_depth"].values]).max() < 0.05
    by_default = finite_elements.simulated(runs, "auto")
    for name, values in found.items():
        np.testing.assert_allclose(by_default[name], values, rtol=5e-4)


def test_a_dent_is_as_wide_as_the_contact_was():
    scene = fm.Scene(fm.Sphere("10 mm", velocity="1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
    summary = fm.simulate(scene).summary
    assert summary["dent_diameter"] == 2.0 * summary["contact_radius"]
    assert summary["mean_pressure"] == pytest.approx(
        summary["maximum_force"] / (np.pi * summary["contact_radius"] ** 2), rel=1e-12
    )


@needs_gcc
@pytest.mark.slow
def test_a_ball_that_cannot_yield_or_bend_dents_as_the_rigid_one():
    """The program of two bodies against that of one."""
    mesh = run.Mesh(elements=12, slowness=40.0)
    alone, found = run.strike(run.Impact(100.0, 200.0), mesh), pair.strike(pair.Pair(100.0, 200.0, 0.0, 1e3, 1e3), mesh)
    for name in ("restitution", "force", "depth", "radius", "residual"):
        assert found[name] == pytest.approx(alone[name], rel=2e-3), name
    assert abs(found["balance"]) < 5e-3 and found["harder"] < 1e-6


@needs_gcc
@pytest.mark.slow
def test_a_softer_ball_keeps_its_slope_on_a_body_that_flattens():
    """Harder ball on a flat, two balls, softer ball on a flat, on a coarse mesh: without x the law is too elastic."""
    hit, parts = pair.Pair(400.0, 200.0, 0.0, 4.0, 1.0, soft_ball=True), np.array([0.0, 0.5, 1.0])
    mesh = run.Mesh(elements=16, slowness=80.0)
    pairs = [replace(hit, soft_ball=bool(x), curvature=1.0 - x if x else 0.0) for x in parts.tolist()]
    found = np.array([pair.strike(one, mesh)["restitution"] for one in pairs])
    numbers = (hit.velocity, hit.stiffness, hit.hardening, hit.poisson, hit.strengths, hit.moduli)
    names = ("velocity_ratio", "stiffness_ratio", "hardening_exponent", "poissons_ratio", "strength_ratio")
    columns = zip((*names, "modulus_ratio"), numbers, strict=True)
    ds = xr.Dataset({name: ("run", np.full(3, value)) for name, value in columns} | {"softer": ("run", parts)})
    law, without = (fit.predicted(one)["coefficient_of_restitution"] for one in (ds, ds.drop_vars("softer")))
    assert (np.diff(found) < 0.0).all() and (np.diff(law) < 0.0).all()
    assert (np.abs(law / found - 1.0) < (0.015, 0.025, 0.055)).all()
    assert without[2] > 1.02 * law[2]


@pytest.mark.slow
def test_published_pairs():
    ds = fd.load("finite_element_pairs")
    assert fd.validate(ds) == []
    assert np.abs(ds["energy_balance"].values).max() < 1e-3
    assert ds["mesh_error"].values.max() < 5.5e-3
    designed = {(one.velocity, one.strengths, one.moduli): k for k, one in enumerate(pair.design())}
    columns = (ds[name].values for name in ("velocity_ratio", "strength_ratio", "modulus_ratio"))
    index = np.array([designed[tuple(row)] for row in np.column_stack([*columns]).tolist()])
    assert (np.diff(index) > 0).all() and index.size == pair.DESIGNED
    every = publish.HELD_OUT_EVERY
    assert ds["held_out"].values.tolist() == (index % every == every - 1).tolist()


PAIRS = {  # median and 90th percentile of the errors of pairs that the law is not fitted to, and largest of all
    "coefficient_of_restitution": (0.0045, 0.013, 0.019),
    "largest_force": (0.007, 0.014, 0.018),
    "largest_depth": (0.004, 0.01, 0.014),
    "largest_radius": (0.005, 0.014, 0.026),
    "residual_depth": (0.006, 0.014, 0.028),
}


def test_two_bodies_that_yield_against_the_law():
    ds = fd.load("finite_element_pairs")
    held, found = ds["held_out"].values == 1, fit.errors(ds)
    for name, (median, most, largest) in PAIRS.items():
        size = np.abs(found[name])
        assert np.median(size[held]) < median and np.quantile(size[held], 0.9) < most and size.max() < largest, name
    rigid = fit.errors(ds.drop_vars("strength_ratio"))["coefficient_of_restitution"]
    assert np.median(np.abs(rigid)) > 0.018  # if the harder body were rigid


@pytest.mark.slow
def test_the_constant_of_two_bodies_is_as_good_as_the_fitted_one():
    """It was fitted to the same impacts on a coarser mesh."""
    best, _, found = fit_pairs.main()
    refitted = fit.errors(fd.load("finite_element_pairs"), best)
    for name, values in found.items():
        assert np.abs(refitted[name] - values).max() < 6e-3, name
        assert np.abs(values).max() < np.abs(refitted[name]).max() + 3e-3, name


@pytest.mark.slow
def test_pairs_without_hardening_are_simulated_by_the_law():
    """Together, from the materials of both bodies: within the errors of `fit.predicted`; and as each alone."""
    ds = fd.load("finite_element_pairs")
    ds = ds.isel(run=ds["hardening_exponent"].values == 0.0)
    modulus, radius, mass = finite_elements.MODULUS, finite_elements.RADIUS, finite_elements.MASS
    moduli, strengths, ball_softer = (ds[name].values for name in ("modulus_ratio", "strength_ratio", "softer"))
    strength = modulus * (1.0 - 0.3**2) / ds["stiffness_ratio"].values
    soft = modulus * (1.0 - 0.3**2) * (1.0 + 1.0 / moduli)
    length, force = limit_point(modulus, radius, finite_elements.first_pressure(0.3) * strength)
    columns = {"impactor.velocity": ds["velocity_ratio"].values * np.sqrt(0.8 * length * force / mass)}
    for path, own in (("impactor", ball_softer == 1), ("target", ball_softer == 0)):
        columns[f"{path}.material.youngs_modulus"] = np.where(own, soft, moduli * soft)
        columns[f"{path}.material.yield_strength"] = np.where(own, strength, strengths * strength)
    one = fm.Material("one", "100 GPa", 0.3, "7850 kg/m^3", "1 GPa")
    base = fm.Scene(
        fm.Sphere(f"{radius} m", "1 m/s", mass=f"{mass} kg", material=one),
        fm.HalfSpace(one),
        fm.Contact("elastoplastic"),
        fm.Effects(gravity=False, wave_losses=False),
    )
    found, said = simulate_many(base, columns), fit.predicted(ds)
    assert ds.sizes["run"] > 20 and not (found.status < 0).any()
    for name, entry, unit in (
        ("coefficient_of_restitution", "coefficient_of_restitution", 1.0),
        ("maximum_force", "largest_force", force),
        ("contact_radius", "largest_radius", np.sqrt(radius * length)),
    ):
        np.testing.assert_allclose(found.summary[name] / unit, said[entry], rtol=5e-4, err_msg=name)
    for row in (0, 7):
        own = {
            path: f"{float(values[row])!r} {'m/s' if 'velocity' in path else 'Pa'}" for path, values in columns.items()
        }
        alone = fm.simulate(base.replace(own), accuracy=1e-8).summary
        for name in ("coefficient_of_restitution", "maximum_force", "permanent_indentation"):
            assert found.summary[name][row] == pytest.approx(alone[name], rel=2e-4), name
