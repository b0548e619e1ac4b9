"""Friction and Poisson's ratio from impacts at several angles."""

import math
from pathlib import Path

import pytest

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main

FOLDER = Path(__file__).parent.parent / "examples" / "measurements"
SCENE, MEASURED = FOLDER / "alumina_on_glass.toml", FOLDER / "kharaz_2001.csv"
LARGE = ((39.54, 0.7743), (49.60, 0.8476), (71.07, 0.9366), (79.23, 0.9695), (85.17, 0.9794))
"""Angle, °, and tangential restitution of Kharaz et al. from 35° on."""


@pytest.fixture
def scene():
    return fm.Scene.from_toml(SCENE)


def table(path, rows, heading="tangential_restitution"):
    lines = [f"velocity [m/s], angle [deg], {heading}", *(f"3.9, {angle}, {value!r}" for angle, value in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return fd.from_csv(path)


def test_measured_values_at_angles_are_read():
    ds = fd.from_csv(MEASURED)
    assert fd.validate(ds) == []
    assert set(ds.coords) == {"impactor_velocity", "impactor_angle"}
    assert set(ds.data_vars) == {"tangential_restitution", "rebound_spin", "rebound_angle"}
    assert math.degrees(ds.impactor_angle.values[0]) == pytest.approx(2.24)
    assert ds.rebound_spin.values[10] == -134.9 and ds.rebound_angle.attrs["units"] == "rad"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("velocity [m/s], angle [deg]\n1, 2\n2, 3\n", "a column beside impactor_velocity is needed"),
        ("velocity [m/s], angle [deg], rebound_spin [rpm]\n1, , 3\n2, 3, 4\n", 'impactor_angle: "" is not a number'),
        (
            "velocity [m/s], angle [mm], rebound_spin [rpm]\n1, 1, 3\n2, 3, 4\n",
            'unit "mm" is a length, an angle is needed',
        ),
        ("time [s], angle [deg], force [N]\n1, 1, 3\n2, 3, 4\n", "is of impacts at several velocities"),
    ],
)
def test_wrong_tables_of_angles_are_refused(tmp_path, text, says):
    path = tmp_path / "m.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        fd.from_csv(path)
    assert says in str(caught.value)


@pytest.mark.slow
def test_friction_of_the_large_angles(tmp_path, scene):
    """Published: 0.092."""
    found = fd.identify(
        table(tmp_path / "m.csv", LARGE), scene.replace({"contact.friction": 0.3}), ["contact.friction"]
    )
    (one,) = found.parameters
    assert one.identified and one.value == pytest.approx(0.0919, abs=5e-5)
    assert found.scene.contact.friction == one.value


@pytest.mark.slow
def test_exact_values_give_friction_back_from_spins_and_from_speeds(tmp_path, scene):
    truth = scene.replace({"contact.friction": 0.15})
    for name, unit in (("rebound_spin", " [rad/s]"), ("tangential_rebound_velocity", " [m/s]")):
        rows = []
        for angle in (50.0, 60.0, 75.0):
            rows.append((angle, fm.simulate(truth.replace({"impactor.angle": f"{angle} deg"})).oblique.summary[name]))
        measured = table(tmp_path / f"{name}.csv", rows, f"{name}{unit}")
        (one,) = fd.identify(measured, scene, ["contact.friction"]).parameters
        assert one.value == pytest.approx(0.15, rel=1e-4)


@pytest.mark.slow
def test_exact_values_give_friction_and_poissons_ratio_back(tmp_path, scene):
    truth = scene.replace({"contact.friction": 0.15, "target.material.poissons_ratio": 0.35})
    angles = (8.0, 15.0, 25.0, 35.0, 60.0)
    found = [fm.simulate(truth.replace({"impactor.angle": f"{one} deg"})).oblique.summary for one in angles]
    rows = [(angle, one["tangential_restitution"]) for angle, one in zip(angles, found, strict=True)]
    measured = table(tmp_path / "m.csv", rows)
    parameters = fd.identify(measured, scene, ["contact.friction", "target.material.poissons_ratio"]).parameters
    assert [one.value for one in parameters] == pytest.approx([0.15, 0.35], rel=1e-3)


def test_what_cannot_be_fitted_is_said(tmp_path, scene):
    measured = table(tmp_path / "m.csv", LARGE)
    with pytest.raises(fm.SceneError, match=r"fit: impactor\.angle: is measured"):
        fd.identify(measured, scene, ["impactor.angle"])
    with pytest.raises(fm.SimulationError, match=r"tangential_restitution: friction in \[contact\] is needed"):
        fd.identify(measured, scene.replace({"contact.friction": None}), ["target.material.poissons_ratio"])


@pytest.mark.slow
def test_the_command_fits_and_draws_over_the_angle(tmp_path, capsys):
    table(tmp_path / "m.csv", LARGE)
    wanted = ["identify", str(tmp_path / "m.csv"), str(SCENE), "--fit", "contact.friction"]
    assert main([*wanted, "--plot", str(tmp_path / "fit.svg")]) == 0
    assert "contact.friction" in capsys.readouterr().out
    assert "angle" in (tmp_path / "fit.svg").read_text("utf-8")
