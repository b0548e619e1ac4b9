"""Tolerances of friction, angle and spin, and the spread of the oblique results, in closed form where all slides."""

import math

import pytest

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3"}
SCENE = fm.Scene(
    fm.Sphere("5 mm", "3 m/s", material=STEEL, angle="70 deg"),
    fm.HalfSpace(STEEL),
    fm.Contact("hertz", friction=0.1),
    fm.Effects(gravity=False),
    title="Slides throughout",
)


@pytest.mark.slow
def test_linear_spread_of_an_impact_that_slides():
    """R ω' = −5 µ V cos α and e_t = 1 − 2 µ/tan α for an elastic solid ball."""
    over = {"contact.friction": "0.1 ± 0.01", "impactor.angle": "70 deg ± 1 deg"}
    names = ("rebound_spin", "tangential_restitution", "maximum_force")
    found = fd.tolerance(SCENE, over, quantities=names, samples=8)
    friction, angle = found.numbers["contact.friction"][0], found.numbers["impactor.angle"][0]
    spin = found.spreads["rebound_spin"]
    assert spin.at_means == pytest.approx(-5.0 * friction * 3.0 * math.cos(angle) / 0.005, rel=1e-5)
    assert spin.slopes["contact.friction"] == pytest.approx(spin.at_means / friction, rel=1e-4)
    assert spin.slopes["impactor.angle"] == pytest.approx(-spin.at_means * math.tan(angle), rel=1e-3)
    share = found.spreads["tangential_restitution"]
    assert share.slopes["impactor.angle"] == pytest.approx(2.0 * friction / math.sin(angle) ** 2, rel=1e-3)
    assert sum(share.shares.values()) == pytest.approx(1.0)
    assert found.spreads["maximum_force"].slopes["contact.friction"] == 0.0
    assert found.of("rebound_spin")[0].check("1/[time]") and found.to_dict()["spreads"]["rebound_spin"]["points"] == 16


def test_results_along_the_surface_need_friction():
    smooth = SCENE.replace({"contact.friction": None})
    with pytest.raises(fm.SimulationError, match=r"rebound_spin: friction in \[contact\] is needed"):
        fd.tolerance(smooth, {"impactor.angle": "70 deg ± 1 deg"}, quantities=("rebound_spin",), samples=8)


@pytest.mark.slow
def test_the_command_prints_and_draws_it(tmp_path, capsys):
    (tmp_path / "scene.toml").write_text(SCENE.to_toml(), encoding="utf-8")
    sweep = 'scene = "scene.toml"\ndesign = "sobol"\nsamples = 8\n[over]\n"impactor.spin" = "0 rad/s ± 20 rad/s"\n'
    (tmp_path / "over.toml").write_text(sweep, encoding="utf-8")
    picture = tmp_path / "tornado.svg"
    command = ["tolerance", str(tmp_path / "over.toml"), "--quantity", "rebound_angle,contact_duration"]
    assert main([*command, "--plot", str(picture)]) == 0
    assert "rebound angle: " in capsys.readouterr().out and picture.exists()
