"""Derivatives in sweeps: values, units, kinks, files."""

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import read_sweep

SCENE = fm.Scene(fm.Sphere("10 mm", "1 m/s", material="bearing steel"), fm.HalfSpace("mild steel"))
BY = ["impactor.velocity", "target.material.youngs_modulus"]


def test_every_impact_has_the_derivatives_of_its_simulation():
    over = {"impactor.velocity": ["0.1 m/s", "4 m/s"], "contact.law": ["auto", "stronge", "hertz"]}
    ds = fd.sweep(SCENE, over, derivatives=BY)
    assert fd.validate(ds) == []
    assert ds.attrs["derivatives"].split() == BY
    assert ds.d_maximum_force_d_impactor_velocity.attrs["units"] == "N s m-1"
    assert ds.d_contact_duration_d_target_material_youngs_modulus.attrs["units"] == "s Pa-1"
    assert float(ds.derivative_accuracy_impactor_velocity.max()) < 1e-4
    assert not ds.derivative_side_impactor_velocity.values.any()
    for velocity in ds.impactor_velocity.values.tolist():
        for law in ds.contact_law.values.tolist():
            changes = {"impactor.velocity": f"{velocity!r} m/s", "contact.law": law}
            history = fm.simulate(SCENE.replace(changes), derivatives=BY)
            row = ds.sel(impactor_velocity=velocity, contact_law=law)
            for name in ("maximum_force", "contact_duration", "rebound_velocity"):
                for path in BY:
                    found = float(row[f"d_{name}_d_{path.replace('.', '_')}"])
                    scale = abs(history.summary[name] / history.derivatives.entries[path].value)
                    exact = history.derivatives.values[name][path]
                    assert found == pytest.approx(exact, rel=1e-4, abs=1e-4 * scale), (velocity, law, name, path)


def test_impacts_without_derivatives_are_counted():
    velocities = ["0 m/s", "0.0493706 m/s", "1 m/s"]  # at rest; where the second stage is just reached
    contact = fm.Contact("stronge", effective_modulus="170377101317.58292 Pa", yield_strength="1 GPa")
    scene = fm.Scene(fm.Sphere("10 mm", "1 m/s", mass="60.74 g"), fm.HalfSpace(), contact, fm.Effects(gravity=False))
    ds = fd.sweep(scene, {"impactor.velocity": velocities}, derivatives=["impactor.velocity"])
    assert ds.derivative_side_impactor_velocity.values.tolist()[0] == 2
    assert abs(ds.derivative_side_impactor_velocity.values.tolist()[1]) == 1
    assert "derivatives by impactor.velocity are one-sided in 1 impacts" in ds.attrs["warnings"]
    slopes = ds.d_maximum_force_d_impactor_velocity.values
    assert np.isnan(slopes[0])
    assert slopes[2] > 0.0
    assert fd.validate(ds) == []


@pytest.mark.slow
def test_a_sweep_file_and_its_output_name_the_derivatives(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE.to_toml())
    text = 'scene = "scene.toml"\ndesign = "sobol"\nsamples = 16\nderivatives = ["impactor.radius"]\n\n[over]\n'
    text += '"impactor.velocity" = { uniform = ["1 m/s", "2 m/s"] }\n"impactor.mass" = { uniform = ["30 g", "40 g"] }\n'
    (tmp_path / "sweep.toml").write_text(text)
    path = tmp_path / "out.nc"
    given = read_sweep(tmp_path / "sweep.toml")
    fd.sweeps.run_sweep(given, path, command="test")
    with fd.open(path) as ds:
        assert fd.validate(ds) == []
        assert "d_impulse_d_impactor_radius" in ds
        assert fd.sweeps.Sweep.of_dataset(ds).derivatives == given.derivatives
        one = ds.isel(impact=3)
        history = fm.simulate(one.film.scene(), derivatives=["impactor.radius"])
        exact = history.derivatives.values["maximum_force"]["impactor.radius"]
        assert float(one.d_maximum_force_d_impactor_radius) == pytest.approx(exact, rel=1e-4)
    other = read_sweep(tmp_path / "sweep.toml", derivatives=["impactor.mass"])
    assert [entry.path for entry in other.derivatives] == ["impactor.mass"]


def test_wrong_numbers_are_refused_with_the_line(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE.to_toml())
    text = (
        'scene = "scene.toml"\nderivatives = ["impactor.velocty"]\n\n[over]\n"impactor.velocity" = ["1 m/s", "2 m/s"]\n'
    )
    (tmp_path / "sweep.toml").write_text(text)
    with pytest.raises(fm.SceneError, match=r"sweep.toml:2: derivatives.impactor.velocty: unknown key; did you mean"):
        read_sweep(tmp_path / "sweep.toml")
    with pytest.raises(fm.SceneError, match="derivatives: 3 is not a list of keys"):
        fd.sweep(SCENE, {"impactor.velocity": ["1 m/s"]}, derivatives=3)
