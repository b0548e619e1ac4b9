"""The catalogue of materials is complete and plausible; invalid materials are refused with all their mistakes."""

from __future__ import annotations

import math
import re

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


VALUES = {
    "hardness": ("hardness",),
    "hardening": ("strain_hardening_exponent",),
    "rate law": ("strain_rate_coefficient", "rate_multiplier"),
}
"""What the catalogue calls these entries where it says why a material has none."""


def reasons(found: Material) -> list[str]:
    """What a material has no value of, of those for which it says why."""
    named = "|".join(VALUES)
    told = re.findall(rf"no ((?:{named})(?:(?:, | or )(?:{named}))*): \w", found.source)
    return [word for words in told for word in re.split(", | or ", words)]


@pytest.mark.parametrize("name", catalogue())
def test_every_value_of_the_strength_is_given_or_the_material_says_why_not(name: str) -> None:
    found = catalogue()[name]
    missing = [word for word, entries in VALUES.items() if all(getattr(found, entry) is None for entry in entries)]
    assert sorted(reasons(found)) == sorted(missing)
    if found.youngs_modulus < 5e9 and "ice" not in name:
        assert found.loss_factor is not None and "loss factor: " in found.source


def two_points(law: str, found: Material) -> float:
    """The exponent through the flow stresses at first yield and at 8 % plastic strain by a hardening law, MPa."""
    a, *others = map(float, re.findall(r"[0-9.]+", law))
    if "(1 + " in law:
        first, flow = a, a * (1.0 + others[1] * 0.08) ** others[2]
    elif " + " in law:
        first, flow = a, a + others[0] * 0.08 ** others[1]
    elif others:
        first, flow = (found.yield_strength or 0.0) / 1e6, a * 0.08 ** others[0]
    else:
        first = flow = a
    return math.log(flow / first) / math.log(1.0 + found.youngs_modulus / 1e6 * 0.08 / first)


def test_hardening_exponents_follow_from_the_laws_of_their_sources() -> None:
    seen = set[str]()
    for found in catalogue().values():
        if found.strain_hardening_exponent is None:
            continue
        (text,) = re.findall(r"hardening(?: of [^:]*)?: ([^;]*)", found.source)
        if text == "from the yield strength and the hardness":
            first, flow = found.yield_strength or 0.0, found.flow_strength or 0.0
            exponent = math.log(flow / first) / math.log(1.0 + found.youngs_modulus * 0.08 / first)
        else:
            law = text.rpartition(", ")[2] if text.endswith("MPa") else text.split(", ")[-2]
            assert law.endswith(" MPa"), found.name
            exponent = two_points(law, found)
        seen.add(re.sub("[0-9.]+", "0", text.rpartition(", ")[2]))
        assert found.strain_hardening_exponent == pytest.approx(exponent, rel=6e-3), found.name
    assert len(seen) == 5


PRESTON_TONKS_WALLACE = {
    "stainless steel 304": (0.02, 10.0, 0.05, 0.0075, 0.3, 0.001, 0.0069, 0.0015, 0.05, 0.46, 0.25, 55.0, 89.5e9, 1800),
    "tantalum": (0.02, 0.0, 0.012, 0.00325, 0.6, 4e-5, 0.01, 0.00125, 0.012, 0.4, 0.23, 180.948, 72.2e9, 3290),
}
"""Their constants: θ, p, s0, s∞, κ, γ, y0, y∞, y1, y2, β, atomic mass, G0 [Pa], and the melting temperature, K."""


@pytest.mark.parametrize("name", PRESTON_TONKS_WALLACE)
def test_rate_coefficients_follow_from_the_flow_stress_of_preston_tonks_and_wallace(name: str) -> None:
    theta, p, s0, s1, kappa, gamma, y0, y1, high, power, beta, mass, stiffness, melting = PRESTON_TONKS_WALLACE[name]
    shear, warmth, density = stiffness * (1 - 0.23 * 300 / melting), 300 / melting, catalogue()[name].density
    atom = mass * 1.66053907e-27
    lattice = 0.5 * (4 * math.pi * density / (3 * atom)) ** (1 / 3) * math.sqrt(shear / density)

    def flow(rate: float) -> float:
        fast, slow = rate / (gamma * lattice), kappa * warmth * math.log(gamma * lattice / rate)
        most = max(s0 - (s0 - s1) * math.erf(slow), s0 * fast**beta)
        first = max(y0 - (y0 - y1) * math.erf(slow), min(high * fast**power, s0 * fast**beta))
        if p == 0.0:
            return most - (most - first) * math.exp(-0.08 * theta / (most - first))
        scale = (s0 - first) / p
        rest = math.exp((most - first) / scale) - 1.0
        return most + scale * math.log(1 - rest / (rest + 1) * math.exp(-theta * 0.08 / (scale * rest)))

    coefficient = (flow(1000.0) / flow(1.0) - 1.0) / math.log(1000.0)
    assert catalogue()[name].strain_rate_coefficient == pytest.approx(coefficient, rel=0.02)


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
