"""The catalogue is complete and sane, and bad materials are refused with all their mistakes."""

from __future__ import annotations

import math

import pytest

from film_model.errors import SceneError
from film_model.materials import Material, catalogue, material


@pytest.mark.parametrize("name", catalogue())
def test_every_material_is_plausible_and_has_a_source(name: str) -> None:
    found = catalogue()[name]
    assert found.name == name
    assert found.source
    wave_speed = math.sqrt(found.youngs_modulus / found.density)
    assert 1000 < wave_speed < 12000
    if found.yield_strength is not None:
        assert 0.0003 < found.yield_strength / found.youngs_modulus < 0.05


def test_tungsten_carbide_is_the_papers() -> None:
    found = material("tungsten carbide")
    assert (found.youngs_modulus, found.poissons_ratio, found.density) == (600e9, 0.28, 14500)
    assert found.yield_strength is None


def test_names_are_found_whatever_their_case_and_misprints_are_answered() -> None:
    assert material("Mild Steel") is material("mild steel")
    with pytest.raises(ValueError, match='"midl steel"; did you mean "mild steel"\\?'):
        material("midl steel")


def test_all_mistakes_at_once() -> None:
    with pytest.raises(SceneError) as caught:
        Material("x", "-1 GPa", 0.5, "5 kg", "0 Pa")
    assert str(caught.value).splitlines() == [
        'Material.youngs_modulus: "-1 GPa" must be > 0',
        "Material.poissons_ratio: 0.5 is out of range: between -1 and 0.5",
        'Material.density: "5 kg" is a mass, a density is needed (e.g. "7850 kg/m^3")',
        'Material.yield_strength: "0 Pa" must be > 0',
    ]


def test_missing_values() -> None:
    with pytest.raises(SceneError) as caught:
        Material("x")
    assert [m.key for m in caught.value.mistakes] == [
        "Material.youngs_modulus",
        "Material.poissons_ratio",
        "Material.density",
    ]
