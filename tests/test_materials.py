"""The catalogue of materials is complete and plausible; invalid materials are refused with all their mistakes."""

from __future__ import annotations

import math

import pytest

from film_model.base.errors import SceneError
from film_model.base.materials import Material, catalogue, material, search, synonyms


@pytest.mark.parametrize("name", catalogue())
def test_every_material_is_plausible_and_has_a_source(name: str) -> None:
    found = catalogue()[name]
    assert found.name == name
    assert found.source
    wave_speed = math.sqrt(found.youngs_modulus / found.density)
    slowest, fastest = (30, 150) if "Shore" in name else (1000, 12000)
    assert slowest < wave_speed < fastest
    if found.yield_strength is not None:
        assert 0.0003 < found.yield_strength / found.youngs_modulus < 0.05


def test_steel_alone_is_refused_with_grades() -> None:
    with pytest.raises(ValueError, match=r'"Steel" yields at 200 to 2500 MPa.*"structural steel S235", "mild steel"'):
        material("Steel")


def test_every_hardness_of_a_metal_has_a_source() -> None:
    hard = [found for found in catalogue().values() if found.hardness is not None]
    assert len(catalogue()) >= 60 and len(hard) >= 18
    for found in hard:
        assert "ardness" in found.source, found.name
        assert found.flow_strength is not None and found.initial_strength is not None
        assert found.initial_strength <= found.flow_strength


def test_every_material_has_a_hardness_or_says_why_not() -> None:
    found = [m for m in catalogue().values() if m.hardness is None]
    assert all("no hardness: " in m.source for m in found)
    assert [m.name for m in found if m.hardening_exponent] == ["Armco iron"]


def test_crushing_strengths_are_those_of_their_sources() -> None:
    assert material("concrete").crushing_strength == (30 + 8) * 1e6  # f_cm = f_ck + 8 MPa
    assert material("ice").crushing_strength == pytest.approx(8.9e6 * 10**0.15, rel=5e-3)
    assert [m.name for m in catalogue().values() if m.crushing_strength is not None] == ["ice", "concrete C30/37"]


def test_tungsten_carbide_of_the_paper() -> None:
    assert material("tungsten carbide").poissons_ratio == 0.22
    found = material("WC, Big-Alabo 2017")
    assert (found.youngs_modulus, found.poissons_ratio, found.density) == (600e9, 0.28, 14500)
    assert found.yield_strength is None


def test_names_ignore_case_and_misprints_get_a_suggestion() -> None:
    assert material("Mild Steel") is material("mild steel")
    with pytest.raises(ValueError, match='"midl steel"; did you mean "mild steel"\\?'):
        material("midl steel")


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ("aluminum", "aluminium"),
        ("Aluminum 6061-T6", "aluminium 6061-T6"),
        ("s235", "structural steel S235"),
        ("PA", "nylon 6/6"),
        ("plexiglas", "PMMA"),
        ("window  glass", "float glass, annealed"),
        ("beech", "beech, across the grain"),
    ],
)
def test_other_words_for_a_material(word: str, name: str) -> None:
    assert material(word).name == name


def test_no_word_means_two_materials() -> None:
    words = [word.lower() for name in catalogue() for word in (name, *synonyms(name))]
    assert len(words) == len(set(words))


def test_suggestions_fit() -> None:
    with pytest.raises(ValueError, match='"aluminium alloy"; did you mean "aluminium"\\?'):
        material("aluminium alloy")
    with pytest.raises(
        ValueError, match=r'"rubber"; there are "natural rubber 40 Shore A", .*"natural rubber 70 Shore A"'
    ):
        material("rubber")
    with pytest.raises(ValueError, match='"unobtainium"; "film-model materials" lists all'):
        material("unobtainium")


def test_the_modulus_of_rubber_follows_from_its_hardness() -> None:
    for name, found in catalogue().items():
        if "Shore A" in name:
            hardness = float(name.split()[-3])
            modulus = 0.0981 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))  # Gent 1958, MPa
            assert found.youngs_modulus == pytest.approx(1e6 * modulus, rel=3e-3)


def test_search_finds_names_and_other_words() -> None:
    assert [found.name for found in search("toughened")] == ["float glass, toughened"]
    assert len(search("shore rubber")) == 4
    assert search("") == []


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
