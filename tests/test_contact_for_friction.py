"""Tangential springs of other engines for a scene with friction, and how far each is off."""

import json
import re
from pathlib import Path

import pytest

import film_model as fm
from film_model.cli.main import main
from film_model.studies.tangential_models import groups
from film_model.translate import ENGINES, contact_for

SCENE = Path(__file__).parent.parent / "examples" / "measurements" / "alumina_on_glass.toml"
ALUMINA, GLASS = (380e9, 0.23), (70e9, 0.25)


def tangential_modulus():
    """G* from 1/G* = Σ (2 − ν)/G, Pa."""
    return 1.0 / sum((2.0 - nu) * 2.0 * (1.0 + nu) / modulus for modulus, nu in (ALUMINA, GLASS))


@pytest.fixture(scope="module")
def scene():
    return fm.Scene.from_toml(SCENE)


@pytest.fixture(scope="module")
def lammps(scene):
    return {one.law.name: one for one in contact_for(ENGINES["lammps"], scene)}


def test_the_groups_of_a_scene(scene):
    effective = 1.0 / sum((1.0 - nu**2) / modulus for modulus, nu in (ALUMINA, GLASS))
    found = groups(scene)
    assert found.ratio == pytest.approx(effective / (4.0 * tangential_modulus()), rel=1e-9)
    assert found.parameter == pytest.approx(3.5 / (2.0 * found.ratio), rel=1e-9)


@pytest.mark.slow
def test_the_springs_have_the_stiffness_of_the_scene(lammps, scene):
    """8 G* for Hertz's laws, k_n/κ for a linear one; alike bodies with the Poisson's ratio have the same κ."""
    pasted = re.search(r"tangential mindlin/force (\S+) 0\.0 0\.092 ", lammps["hertz"].paste())
    assert float(pasted[1]) == pytest.approx(8.0 * tangential_modulus(), rel=1e-3)
    hooke, ratio = lammps["hooke"], groups(scene).ratio
    assert f"tangential linear_history {hooke.values['k_n'] / ratio:.6g} 0.0 0.092" in hooke.paste()
    nu = hooke.pair.poissons_ratio
    assert (2.0 - nu) / (2.0 * (1.0 - nu)) == pytest.approx(ratio, rel=1e-12)
    (stiffness,) = contact_for(ENGINES["liggghts"], scene, law="hertz-stiffness")
    kt = re.search(r"kt peratomtypepair 1 (\S+)", stiffness.paste())
    assert float(kt[1]) == pytest.approx(8.0 * tangential_modulus(), rel=1e-3)
    assert "tangential history" in stiffness.paste() and "coefficientFriction" in stiffness.paste()
    (linear,) = contact_for(ENGINES["yade"], scene, law="viscoelastic")
    assert f"ks={2.0 * linear.values['kn'] / ratio:.6g}" in linear.paste() and "frictionAngle=0.09174" in linear.paste()


@pytest.mark.slow
def test_how_far_each_model_of_friction_is_off(lammps):
    """Largest and rms difference in ψ₂ up to 4χ; the order of the models is that of docs/oblique.md."""
    found = lammps["hertz"].tangential
    assert list(found) == ["mindlin/force", "mindlin_rescale/force", "mindlin", "mindlin_rescale"]
    assert abs(found["mindlin"].worst) == pytest.approx(0.6, abs=0.05) and 0.5 < found["mindlin"].before < 1.0
    assert all(0.2 < one.rms < 0.4 for one in found.values())
    (hooke,) = lammps["hooke"].tangential.values()
    assert 0.03 < hooke.rms < 0.1


def test_angle_and_spin_do_not_matter(lammps, scene):
    normal = scene.replace({"impactor.angle": None, "contact.friction": None})
    speeds = [f"{v!r} m/s" for v in lammps["hertz"].velocities[[0, -1]].tolist()]
    (found,) = contact_for(ENGINES["lammps"], normal, speeds, law="hertz")
    assert found.wanted["force"] == pytest.approx(lammps["hertz"].wanted["force"], rel=1e-12)
    assert "tangential linear_nohistory 0.0 0.0" in found.paste() and found.tangential == {}


@pytest.mark.slow
def test_it_is_printed(capsys):
    assert main(["contact-for", "yade", str(SCENE), "--law", "mindlin"]) == 0
    assert re.search(r"MindlinPhys +0\.\d+ +\+0\.\d+ at ψ₁ = \d", capsys.readouterr().out)
    assert main(["contact-for", "yade", str(SCENE), "--law", "mindlin", "--json"]) == 0
    (law,) = json.loads(capsys.readouterr().out)["laws"]
    assert set(law["tangential"]["MindlinPhys"]) == {"rms", "worst", "before"}
