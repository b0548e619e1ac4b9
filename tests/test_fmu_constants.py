"""Datasets of FMU runs have the same constants as those of the library, with what was set for the run."""

from pathlib import Path

import pytest

import film_datasets as fd
import film_model as fm
import fmu_wrapper
from film_datasets.schema import CONSTANTS

pytest.importorskip("fmpy")

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
CHANGES = {
    "mass": ("impactor.mass", "80 g"),
    "initial_velocity": ("impactor.velocity", "0.4 m/s"),
    "effective_modulus": ("contact.effective_modulus", "90 GPa"),
    "yield_strength": ("contact.yield_strength", "1.2 GPa"),
}


@pytest.mark.slow
@pytest.mark.parametrize("changes", [{}, CHANGES], ids=["as exported", "set"])
def test_runs_have_the_constants_of_their_scene(made, changes):
    scene = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel_stronge.toml")
    ds = fmu_wrapper.run(made(scene), start_values={key: value for key, (_, value) in changes.items()})
    expected = fd.to_dataset(fm.simulate(scene.replace(dict(changes.values()))))
    assert fd.validate(ds) == []
    for variable in CONSTANTS:
        assert (variable.name in ds) == (variable.name in expected), variable.name
        if variable.name == "contact_law_name":
            assert str(ds[variable.name].values) == str(expected[variable.name].values)
        elif variable.name in ds:
            assert float(ds[variable.name]) == pytest.approx(float(expected[variable.name]), rel=1e-12), variable.name
