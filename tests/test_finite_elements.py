"""The finite-element impacts: the program against theory, the published runs, and the closed forms fitted to them."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import film_datasets as fd

FOLDER = Path(__file__).parent.parent / "examples" / "finite_elements"
sys.path.insert(0, str(FOLDER))

import fit  # noqa: E402
import forms  # noqa: E402
import publish  # noqa: E402
import run  # noqa: E402

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
COARSE = run.Mesh(elements=12)


@needs_gcc
def test_an_elastic_ball_rebounds_by_hertz():
    found = run.strike(run.Impact(1.0, 200.0, yields=False), COARSE)
    assert found["restitution"] == pytest.approx(1.0, abs=2e-3)
    assert found["force"] / found["depth"] ** 1.5 == pytest.approx(1.0, rel=5e-3)
    assert found["radius"] / found["depth"] ** 0.5 == pytest.approx(1.0, rel=2e-2)
    assert abs(found["energy"]["plastic"]) == 0.0


@needs_gcc
def test_a_ball_that_dents_agrees_with_the_published_run_on_a_finer_mesh():
    ds = fd.load("finite_element_impacts").isel(run=run.TABLE.index(100.0))
    found = run.strike(run.Impact(100.0, 200.0), COARSE)
    assert found["restitution"] == pytest.approx(float(ds["coefficient_of_restitution"]), rel=2e-2)
    assert found["depth"] == pytest.approx(float(ds["largest_depth"]), rel=1e-2)
    assert found["force"] == pytest.approx(float(ds["largest_force"]), rel=3e-2)
    assert abs(found["balance"]) < 5e-3
    assert found["energy"]["hourglass"] < 5e-3


def test_published_runs():
    ds = fd.load("finite_element_impacts")
    assert fd.validate(ds) == []
    every = publish.HELD_OUT_EVERY
    assert ds["held_out"].values.tolist() == [int(k % every == every - 1) for k in range(ds.sizes["run"])]
    assert np.abs(ds["energy_balance"].values).max() < 2e-3
    assert ds["mesh_error"].values.max() < 1e-2
    first = ds.isel(run=slice(0, len(run.TABLE)))
    assert first["velocity_ratio"].values.tolist() == list(run.TABLE)
    assert np.all(np.diff(first["coefficient_of_restitution"].values) < 0.0)
    pressure = first["largest_force"] / first["largest_radius"] ** 2 * 1.295 * np.exp(0.736 * 0.3) * 2.0 / 3.0
    assert 2.7 < float(pressure[-1]) < 3.0  # in Y: full plasticity


def test_the_design_is_that_of_the_published_runs():
    ds = fd.load("finite_element_impacts")
    designed = run.design()
    assert [impact.stiffness for impact in designed] == pytest.approx(ds["stiffness_ratio"].values, rel=1e-12)
    assert [impact.velocity for impact in designed] == pytest.approx(ds["velocity_ratio"].values, rel=1e-9)


def test_forms_hold_for_runs_that_the_fit_left_out():
    best, found = fit.main()
    ds = fd.load("finite_element_impacts")
    for name, values in forms.CONSTANTS.items():
        assert values == pytest.approx(best[name], rel=1e-2), name
    out = ds["held_out"].values == 1
    bounds = {"coefficient_of_restitution": 0.03, "largest_force": 0.025, "largest_depth": 0.02, "largest_radius": 0.03}
    for name, bound in bounds.items():
        assert np.abs(found[name][out]).max() < bound, name
    assert np.median(np.abs(found["coefficient_of_restitution"][out])) < 0.005
    dent = np.abs(found["residual_depth"] * ds["residual_depth"].values / ds["largest_depth"].values)
    assert dent[out].max() < 0.03  # of the largest depth: dents near first yield are small


@pytest.mark.parametrize("n", [0.0, 0.2, 0.4])
@pytest.mark.parametrize("e_y", [1e-3, 5e-3, 1.5e-2])
def test_forms_are_those_of_hertz_at_first_yield_and_restitution_falls(n, e_y):
    w = np.array([0.2, 1.0])
    assert forms.force(w, e_y, n) == pytest.approx(w**1.5)
    assert forms.secant(w, e_y, n) == pytest.approx(w**0.5)
    assert forms.exponent(w, e_y, n) == pytest.approx([1.5, 1.5])
    slope = (forms.force(1.0 + 1e-6, e_y, n) - 1.0) / 1e-6
    assert slope == pytest.approx(1.5, rel=1e-3)
    e = [float(fit.predicted(v, e_y, n, 1.615)["coefficient_of_restitution"]) for v in np.geomspace(1.0, 300.0, 40)]
    assert e[0] == pytest.approx(1.0, abs=1e-4)
    assert np.all(np.diff(e) < 0.0)
