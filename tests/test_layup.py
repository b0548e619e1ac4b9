"""Plates of layers: classical lamination theory against closed forms, and what is refused."""

import math

import numpy as np
import pytest

import film_model as fm
from film_model.effects.choose import choose
from film_model.targets.layup import coupling, laminate, plies

PLY = "carbon/epoxy UD"


def plate(angles, thickness="0.125 mm", **options):
    return fm.Plate(layup=[[PLY, thickness, angle] for angle in angles], **options)


def test_one_ply_along_and_across():
    """D11 = E1 h³/(12 (1 − ν12 ν21)), D12 = ν12 E2 h³/…, D66 = G12 h³/12; turned by 90° the axes change places."""
    own, h = plies()[PLY], 2e-3
    minor = 1 - own.nu12**2 * own.E2 / own.E1
    d11, d12, d22, d66, d16, d26 = laminate(fm.Plate(layup=[[PLY, "2 mm", 0]]).layup)
    assert d11 == pytest.approx(own.E1 * h**3 / 12 / minor, rel=1e-12)
    assert d12 == pytest.approx(own.nu12 * own.E2 * h**3 / 12 / minor, rel=1e-12)
    assert d22 == pytest.approx(own.E2 * h**3 / 12 / minor, rel=1e-12)
    assert d66 == pytest.approx(own.G12 * h**3 / 12, rel=1e-12) and d16 == d26 == 0.0
    turned = fm.Plate(layup=[[PLY, "2 mm", 90]]).stiffness
    assert turned == pytest.approx((d22, d12, d11, d66), rel=1e-9)


def test_t300_5208_at_45_degrees():
    """Q̄11 = 56.66 GPa, Q̄12 = 42.32 GPa, Q̄66 = 46.59 GPa, Q̄16 = 42.87 GPa (Tsai & Hahn 1980, section 3.3)."""
    d11, d12, _, d66, d16, _ = laminate(fm.Plate(layup=[[PLY, "1 m", 45]]).layup)
    assert np.array([d11, d12, d66, d16]) * 12 / 1e9 == pytest.approx([56.66, 42.32, 46.59, 42.87], abs=0.01)


def test_an_isotropic_ply_gives_an_isotropic_plate():
    metal = {"E1": "70 GPa", "E2": "70 GPa", "G12": f"{70 / 2.6!r} GPa", "nu12": 0.3, "density": "2700 kg/m^3"}
    layers = fm.Plate(layup=[[metal, "1 mm", angle] for angle in (10, 80, 80, 10)], size=["1 m", "1 m"])
    isotropic = fm.Material("metal", "70 GPa", 0.3, "2700 kg/m^3")
    sheet = fm.Plate(isotropic, "4 mm", size=["1 m", "1 m"], theory="kirchhoff")
    assert layers.stiffness == pytest.approx(sheet.stiffness, rel=1e-12)
    assert layers.surface_density == pytest.approx(sheet.surface_density) and layers.whole_thickness == 4e-3
    assert layers.impedance == pytest.approx(sheet.impedance, rel=1e-12)
    assert layers.modes(1e4).frequency == pytest.approx(sheet.modes(1e4).frequency, rel=1e-12)


def test_a_fibre_metal_laminate():
    """Two sheets of aluminium around a ply across, by hand: D = Q (h³ − c³)/12 of the sheets + Q c³/12 of the ply."""
    metal, ply = fm.material("aluminium 6061-T6"), plies()[PLY]
    layers = [["aluminium 6061-T6", "0.4 mm", 90], [PLY, "0.2 mm", 90], [metal, "0.4 mm", 0]]
    glare = fm.Plate("aluminium 6061-T6", layup=layers, size=["300 mm", "200 mm"])
    outer, inner = (1.0e-3**3 - 0.2e-3**3) / 12, 0.2e-3**3 / 12
    e, nu = metal.youngs_modulus, metal.poissons_ratio
    whole = e / (1 - nu**2)
    less = 1 - ply.nu12**2 * ply.E2 / ply.E1
    expected = (
        whole * outer + ply.E2 / less * inner,
        nu * whole * outer + ply.nu12 * ply.E2 / less * inner,
        whole * outer + ply.E1 / less * inner,
        e / (2 * (1 + nu)) * outer + ply.G12 * inner,
    )
    assert glare.stiffness == pytest.approx(expected, rel=1e-12)
    assert glare.surface_density == pytest.approx(metal.density * 0.8e-3 + ply.density * 0.2e-3, rel=1e-12)
    scene = fm.Scene(fm.Sphere(radius="5 mm", velocity="1 m/s", material="mild steel"), glare)
    assert fm.Scene.from_text(scene.to_toml()).target.stiffness == pytest.approx(expected, rel=1e-12)
    own = {"youngs_modulus": "70 GPa", "poissons_ratio": 0.3, "density": "2700 kg/m^3"}
    assert fm.Plate(layup=[[own, "1 mm", 0]]).stiffness[0] == pytest.approx(70e9 * 1e-9 / 12 / 0.91)


def test_a_plate_of_given_stiffness_is_not_asked_for_its_thickness():
    sheet = fm.Plate(
        "mild steel",
        mass_per_area="8 kg/m^2",
        bending_stiffness={"D11": "155 N*m", "D12": "45 N*m", "D22": "155 N*m", "D66": "55 N*m"},
        size=["300 mm", "200 mm"],
        edges="clamped",
    )
    scene = fm.Scene(fm.Sphere(radius="5 mm", velocity="1 m/s", material="mild steel"), sheet)
    reasons = [effect.reason for effect in choose(scene).effects]
    assert not [reason for reason in reasons if "target.thickness" in reason]
    assert len([reason for reason in reasons if "given bending_stiffness" in reason]) == 3


def test_twist_is_neglected_with_a_number():
    """For [45/−45]s: the impedance from a mean over directions with D16 and D26, and without."""
    layers = plate([45, -45, -45, 45], size=["100 mm", "100 mm"])
    d11, d12, d22, d66, d16, d26 = laminate(layers.layup)
    angles = (np.arange(5000) + 0.5) * math.pi / 5000
    c, s = np.cos(angles), np.sin(angles)
    own = d11 * c**4 + d22 * s**4 + 2 * (d12 + 2 * d66) * (c * s) ** 2
    exact = np.mean((own + 4 * d16 * c**3 * s + 4 * d26 * c * s**3) ** -0.5)
    assert coupling(layers.layup)[1] == pytest.approx(abs(np.mean(own**-0.5) / exact - 1), rel=1e-6)
    contact = fm.Contact("hertz", effective_modulus="10 GPa")
    scene = fm.Scene(fm.Sphere("5 mm", "1 m/s", mass="5 g"), layers, contact)
    effect = {e.name: e for e in choose(scene).effects}["cross_bending"]
    assert effect.state == "needed but not modelled" and "D16 and D26" in effect.warning
    assert coupling(plate([0, 90, 90, 0]).layup) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert fm.Scene.from_text(scene.to_toml()) == scene
    assert fm.Scene.from_text(scene.replace({"target.layup": [[PLY, "1 mm", 0]]}).to_toml()).target.stiffness[0] > 0


@pytest.mark.parametrize(
    ("layup", "message"),
    [
        (
            [[PLY, "1 mm", 0], [PLY, "1 mm", 90]],
            "layer 1, .* differs from layer 1 .* not symmetric, so bending would be",
        ),
        ([[PLY, "1 mm", 45], [PLY, "1 mm", -45]], "not symmetric"),
        (
            [["carbon epoxy UD", "1 mm", 0]],
            'layer 1: material: no ply and no material is called .*did you mean "carbon/epoxy UD"',
        ),
        ([[PLY, "1 kg", 0]], "layer 1: thickness: .* is a mass, a length is needed"),
        ([[PLY, "1 mm"]], "layer 1: a list is not a layer"),
        ([[PLY, "1 mm", "45 mm"]], "layer 1: angle"),
        ([], "a list of 1 to 1000 layers"),
        (PLY, "a list of 1 to 1000 layers"),
        ([[{"E1": "1 GPa", "E2": "1 GPa", "G12": "1 GPa", "nu12": 1.5, "density": "1 kg/m^3"}, "1 mm", 0]], "nu12"),
    ],
)
def test_mistakes_of_layups(layup, message):
    with pytest.raises(fm.SceneError, match=message) as caught:
        fm.Plate(layup=layup)
    assert len(str(caught.value).splitlines()) == 1


def test_a_plate_is_described_in_one_way():
    with pytest.raises(fm.SceneError, match=r"Plate.thickness: give .*, not two of them"):
        fm.Plate("mild steel", "1 mm", layup=[[PLY, "1 mm", 0]])
    assert fm.Plate("mild steel", layup=[[PLY, "1 mm", 0]]).material is not None  # for the contact
    assert fm.Plate(layup=[[PLY, "1 mm", 180], [PLY, "1 mm", 0]]).layup is not None  # the same direction


# ---------------------------------------------------------------- stretching


def _stretching(target, mass="1 kg", velocity="2 m/s"):
    contact = fm.Contact("hertz", effective_modulus="60 GPa")
    scene = fm.Scene(fm.Sphere("20 mm", velocity, mass=mass), target, contact, fm.Effects(gravity=False))
    return {effect.name: effect for effect in choose(scene).effects}["stretching"]


def test_membrane_stiffening_is_a_warning_with_numbers():
    """1 kg at 2 m/s on 100 × 100 × 1 mm of aluminium: about 2550 N by Berger's energy in one term, 501 N linear."""
    sheet = {"material": "aluminium 6061-T6", "thickness": "1 mm", "size": ["100 mm", "100 mm"]}
    effect = _stretching(fm.Plate(**sheet))
    assert effect.state == "needed but not modelled" and "about 2544 N" in effect.reason and effect.value > 5.0
    k, quartic = (
        68.9e9 * 1e-9 / 12 / (1 - 0.33**2) / 0.0116008 / 0.01,
        6 * math.pi**4 / 16 * 68.9e9 / 12 / (1 - 0.33**2) / 0.01 * 1e-3,
    )
    u = np.roots([quartic, 0.0, k / 2, 0.0, -2.0 / (1 + 0.25 * 0.027)])
    u = float(u[(u.imag == 0) & (u.real > 0)].real[0])
    assert k * u + 4 * quartic * u**3 == pytest.approx(2544, abs=1)
    assert _stretching(fm.Plate(**sheet), velocity="1 mm/s").state == "not needed"
    free = _stretching(fm.Plate(**sheet, edges=["clamped", "free", "free", "free"]))
    assert free.state == "not needed" and "no opposite edges are held" in free.reason
    strip = _stretching(fm.Plate(**sheet, edges=["clamped", "clamped", "free", "free"]))
    assert strip.state == "needed but not modelled"
    assert _stretching(fm.Plate("mild steel", "1 mm")).state == "not needed"


def test_stretching_of_beams():
    bar = {"material": "mild steel", "length": "200 mm", "width": "10 mm", "thickness": "2 mm"}
    assert _stretching(fm.Beam(**bar, ends="clamped")).state == "needed but not modelled"
    assert _stretching(fm.Beam(**bar, ends="cantilever")).state == "not needed"
