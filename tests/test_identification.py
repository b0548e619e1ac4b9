"""Measurements from CSV files, and parameters fitted to them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import film_datasets as fd
import film_model as fm
from film_model.base.units import power_stiffness_unit
from film_model.cli.main import main

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
MODULUS = ["contact.effective_modulus"]
BALL = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml").replace({"contact.law": "big-alabo"})
AWAY = BALL.replace({"target.material.yield_strength": "1.5 GPa", "impactor.velocity": "0.27 m/s"})
MEYER = BALL.replace({"contact": {"law": "meyer", "stiffness": "5e9 N/m^1.4", "exponent": 1.4}})
TIMES = np.linspace(0.0, 110e-6, 80)


def force_file(path: Path, scene: fm.Scene, noise: float, seed: int = 0, offset: float = 0.0) -> Path:
    """A force history with noise [N] as a CSV file."""
    history = fm.simulate(scene, accuracy=1e-8)
    force = np.where(offset <= TIMES, history.sample_si(np.maximum(TIMES - offset, 0.0)).contact_force, 0.0)
    force = force + np.random.default_rng(seed).normal(0.0, noise, TIMES.size)
    rows = (f"{t!r},{f!r}" for t, f in zip((TIMES * 1e6).tolist(), (force / 1e3).tolist(), strict=True))
    path.write_text("# measured\ntime [us],force [kN]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def restitution_file(path: Path, scene: fm.Scene, noise: float, seed: int = 0) -> Path:
    speeds = np.geomspace(0.05, 4.0, 25).tolist()
    ratios = fm.simulate_batch(scene, velocity=[f"{v!r} m/s" for v in speeds]).summary["coefficient_of_restitution"]
    ratios = ratios + np.random.default_rng(seed).normal(0.0, noise, 25)
    rows = (f"{1e3 * v!r};{e!r}" for v, e in zip(speeds, ratios.tolist(), strict=True))
    path.write_text("Velocity (mm/s);Restitution\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return path


def test_a_measured_history_is_a_dataset(tmp_path: Path) -> None:
    ds = fd.from_csv(force_file(tmp_path / "m.csv", BALL, 0.0), title="Drop 7")
    assert fd.validate(ds) == []
    np.testing.assert_allclose(ds["t"].values, TIMES, rtol=1e-14)
    np.testing.assert_allclose(ds["contact_force"].max(), 516.0, rtol=2e-3)
    assert ds["contact_force"].attrs["units"] == "N"
    back = fd.read(fd.write(ds, tmp_path / "m.nc"))
    assert back.identical(ds)
    assert fd.validate(back) == []


def test_empty_cells_are_missing(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text("t [ms]\tforce [N]\tindentation [um]\n0\t0\t\n1\t\t5\n2\t7\t\n", encoding="utf-8")
    ds = fd.from_csv(path)
    assert fd.validate(ds) == []
    assert np.isnan(ds["contact_force"].values).tolist() == [False, True, False]
    assert ds["indentation"].values[1] == pytest.approx(5e-6, rel=1e-15)


def test_a_separator_at_the_end_and_a_dash_for_no_unit(tmp_path: Path) -> None:
    path = tmp_path / "e.csv"
    path.write_text("velocity [m/s]; restitution [-];\n1; 0.5;\n2; 0.4;\n", encoding="utf-8")
    ds = fd.from_csv(path)
    assert fd.validate(ds) == []
    assert ds["coefficient_of_restitution"].values.tolist() == [0.5, 0.4]


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("", None, "at least two rows"),
        ("time [us],force [kN]\n0,1\n1,x\n", 3, 'contact_force: "x" is not a number'),
        ("time [us];force [kN]\n0;1\n1;1,5\n", 3, "write a decimal point"),
        ("time [us],force [kN]\n0,1\n1,nan\n", 3, "is not a number"),
        ("time [us],force [kN]\n0,1\n,2\n", 3, 't: "" is not a number'),
        ("time [us],force [kN]\n0,1\n1\n", 3, "1 cells, but 2 columns"),
        ("time [us],force [kN]\n1,1\n0,2\n", 3, "the time does not increase"),
        ("time [us],force [mm]\n0,1\n1,2\n", 1, 'column "force [mm]": unit "mm" is a length, a force is needed'),
        ("time [us],force\n0,1\n1,2\n", 1, "has no unit, a force is needed"),
        ("time [us],farce [N]\n0,1\n1,2\n", 1, 'did you mean "force"?'),
        ("time [us],force [N],force [N]\n0,1,1\n1,2,2\n", 1, "is given twice"),
        ("time [us]\n0\n1\n", 1, "a column beside t is needed"),
        ("restitution\n0.5\n0.4\n", 1, 'a column "time [us]", "velocity [m/s]" or'),
        ("velocity [m/s],restitution\n1,0.5\n0,0.4\n", 3, "the velocity must be > 0"),
    ],
)
def test_a_wrong_file_is_one_clear_message(tmp_path: Path, text: str, line: int | None, says: str) -> None:
    path = tmp_path / "m.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(fm.SceneError) as caught:
        fd.from_csv(path)
    assert says in str(caught.value)
    assert caught.value.mistakes[0].line == line


@pytest.mark.slow
def test_exact_data_give_the_parameters_back(tmp_path: Path) -> None:
    found = fd.identify(
        fd.from_csv(force_file(tmp_path / "m.csv", BALL, 0.0, offset=3e-6)),
        AWAY,
        ["contact.yield_strength", "impactor.velocity", "time_offset"],
    )
    assert [one.identified for one in found.parameters] == [True, True, True]
    assert [one.value for one in found.parameters] == pytest.approx([1e9, 0.25, 3e-6], rel=2e-4)
    assert found.residual["contact_force"] < 0.02
    assert found.scene.yield_strength == found.parameters[0].value
    assert found.scene.solver == AWAY.solver
    ratios = fd.from_csv(restitution_file(tmp_path / "e.csv", BALL, 0.0))
    (one,) = fd.identify(ratios, AWAY, ["contact.yield_strength"]).parameters
    assert one.value == pytest.approx(1e9, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("quantity", "heading"), [("coefficient_of_restitution", ""), ("dent_diameter", " [m]")])
def test_a_hardness_is_fitted_to_rebounds_or_dents(tmp_path: Path, quantity: str, heading: str) -> None:
    """Also one that contradicts the yield strength of the data sheet, which then goes."""
    ball = fm.Sphere("10 mm", velocity="1 m/s", material="bearing steel")
    start = fm.Scene(ball, fm.HalfSpace("mild steel"))
    truth = start.replace({"target.material.yield_strength": None, "target.material.hardness": "320 HV"})
    speeds = np.geomspace(0.5, 5.0, 4).tolist()
    values = fm.simulate_batch(truth, velocity=[f"{v!r} m/s" for v in speeds]).summary[quantity]
    rows = (f"{v!r},{value!r}" for v, value in zip(speeds, values.tolist(), strict=True))
    path = tmp_path / "m.csv"
    path.write_text(f"velocity [m/s],{quantity}{heading}\n" + "\n".join(rows) + "\n", encoding="utf-8")
    found = fd.identify(fd.from_csv(path), start, ["target.material.hardness"])
    (one,) = found.parameters
    assert one.identified and one.value == pytest.approx(320.0 * 9.80665e6 / 0.927, rel=2e-3)
    assert one.text(one.value) in ("319.9 HV", "320 HV", "320.1 HV")
    assert found.scene.target.material.yield_strength is None
    assert found.scene.target.material.strain_rate_coefficient == 0.022


def test_a_measurement_without_usable_data_is_refused(tmp_path: Path) -> None:
    (tmp_path / "m.csv").write_text("time [us],force [N]\n0,0\n1,0\n2,0\n", encoding="utf-8")
    with pytest.raises(ValueError, match="contact_force: zero throughout"):
        fd.identify(fd.from_csv(tmp_path / "m.csv"), BALL, ["contact.yield_strength"])


def test_material_parameters_and_plates(tmp_path: Path) -> None:
    plate = fm.Scene.from_toml(SCENES / "olsson_plate.toml").replace({"effects.boundary_reflections": False})
    history = fm.simulate(plate, accuracy=1e-8)
    t = np.linspace(0, 2e-4, 50)
    samples = history.sample_si(t)
    rows = zip((t * 1e6).tolist(), samples.contact_force.tolist(), samples.impactor_velocity.tolist(), strict=True)
    path = tmp_path / "m.csv"
    path.write_text(
        "t [us],force [N],velocity [m/s]\n" + "\n".join(f"{a!r},{b!r},{c!r}" for a, b, c in rows), encoding="utf-8"
    )
    away = plate.replace({"contact.effective_modulus": "7 GPa", "target.mass_per_area": "5 kg/m^2"})
    found = fd.identify(fd.from_csv(path), away, ["contact.effective_modulus", "target.mass_per_area"])
    assert [one.value for one in found.parameters] == pytest.approx([9.72e9, 4.132], rel=1e-3)
    assert set(found.residual) == {"contact_force", "impactor_velocity"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fit", "lost", "reason"),
    [
        (["contact.effective_modulus", "impactor.radius", "contact.yield_strength"], 3, "only together with"),
        (["target.material.density", "contact.yield_strength"], 1, "does not depend on it"),
    ],
)
def test_unidentifiable_parameters_are_named(tmp_path: Path, fit: list[str], lost: int, reason: str) -> None:
    measured = fd.from_csv(force_file(tmp_path / "m.csv", BALL, 3.0))
    found = fd.identify(measured, AWAY.replace({"impactor.velocity": "0.25 m/s"}), fit)
    assert len(found.warnings) == lost
    assert all(reason in warning for warning in found.warnings)
    assert all(one.identified == (one.path not in " ".join(found.warnings)) for one in found.parameters) or lost == 3


def test_a_yield_strength_that_is_never_reached(tmp_path: Path) -> None:
    """A yield strength cannot be identified from an elastic impact or from too much noise."""
    soft = BALL.replace({"impactor.velocity": "0.02 m/s"})
    start = soft.replace({"target.material.yield_strength": "1.5 GPa"})
    elastic = fd.from_csv(force_file(tmp_path / "m.csv", soft, 0.0))
    (one,) = fd.identify(elastic, start, ["contact.yield_strength"]).parameters
    assert not one.identified
    noisy = fd.from_csv(force_file(tmp_path / "n.csv", BALL, 4000.0))
    (one,) = fd.identify(noisy, AWAY, ["contact.yield_strength"]).parameters
    assert not one.identified


@pytest.mark.parametrize(
    ("fit", "says"),
    [
        ([], "at least one parameter"),
        (["contact.law"], "is not a number"),
        (["contact.yeld_strength"], 'did you mean "yield_strength"'),
        (["impactor.velocity", "impactor.velocity"], "given twice"),
        (["impactor.drop_height"], "the scene gives impactor.velocity"),
        (["impactor.angle"], "no value to begin with"),
        (["contact.exponent"], "is in the unit of the stiffness"),
    ],
)
def test_parameters_that_cannot_be_fitted(tmp_path: Path, fit: list[str], says: str) -> None:
    measured = fd.from_csv(force_file(tmp_path / "m.csv", BALL, 0.0))
    scene = MEYER if fit == ["contact.exponent"] else BALL
    with pytest.raises(fm.SceneError, match=says):
        fd.identify(measured, scene, fit)
    if scene is MEYER:  # the unit of the stiffness depends on the exponent, so the exponent cannot be fitted alone
        with pytest.raises(fm.SceneError, match=says):
            fd.sweep(scene, {"contact.exponent": [1.4, 1.5]})


def test_a_stiffness_with_a_unit_of_its_own_is_fitted(tmp_path: Path) -> None:
    measured = fd.from_csv(force_file(tmp_path / "m.csv", MEYER, 1.0))
    found = fd.identify(measured, MEYER.replace({"contact.stiffness": "1e10 N/m^1.4"}), ["contact.stiffness"])
    (one,) = found.parameters
    assert one.identified and one.low < 5e9 < one.high
    assert one.to_dict()["units"] == "N/m^1.4" and "e+09 N/m^1.4" in found.table()
    assert "of the largest" in found.table()


def test_other_mistakes(tmp_path: Path) -> None:
    ratios = fd.from_csv(restitution_file(tmp_path / "e.csv", BALL, 0.0))
    with pytest.raises(fm.SceneError, match="is measured"):
        fd.identify(ratios, BALL, ["impactor.velocity"])
    with pytest.raises(fm.SceneError, match="is for measured histories"):
        fd.identify(ratios, BALL, ["time_offset"])
    with pytest.raises(ValueError, match="confidence"):
        fd.identify(ratios, BALL, ["contact.yield_strength"], confidence=1.0)
    with pytest.raises(ValueError, match="a measurement is needed"):
        fd.identify(fd.to_dataset(fm.simulate(BALL)), BALL, ["contact.yield_strength"])
    with pytest.raises(ValueError, match="too few"):
        fd.identify(ratios.isel(impact=slice(0, 1)), BALL, ["contact.yield_strength"])


def covered(trials: int, tmp_path: Path) -> tuple[int, int]:
    """How often all intervals contain the true values, for noisy force histories and noisy restitutions."""
    truth = {"contact.yield_strength": 1e9, "impactor.velocity": 0.25, "time_offset": 2e-6}
    held = [0, 0]
    for seed in range(trials):
        force = fd.from_csv(force_file(tmp_path / "m.csv", BALL, 5.0, seed, offset=2e-6))
        parameters = fd.identify(force, AWAY, list(truth)).parameters
        held[0] += all(one.low <= truth[one.path] <= one.high for one in parameters)
        ratios = fd.from_csv(restitution_file(tmp_path / "e.csv", BALL, 0.01, seed))
        (one,) = fd.identify(ratios, AWAY, ["contact.yield_strength"]).parameters
        held[1] += one.low <= 1e9 <= one.high
    return held[0], held[1]


def bracket(law: str, **parameters: object) -> fm.Scene:
    """A ball on a bracket that is known by its vibrations, with several contacts."""
    modes = fm.Structure(
        frequency=["708 Hz", "2.45 kHz", "5.2 kHz", "9.1 kHz"],
        modal_mass=["13 g", "46.8 g", "30 g", "50 g"],
        damping_ratio=0.002,
        static_compliance="4.6e-6 m/N",
        material="aluminium 6061-T6",
    )
    effects = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
    contact = fm.Contact(law, **parameters)
    return fm.Scene(fm.Sphere("5 mm", "1 m/s", material="bearing steel"), modes, contact, effects)


@pytest.mark.parametrize(
    ("contact", "start"),
    [
        pytest.param(
            {"law": "meyer", "stiffness": "2e9 N/m^1.5", "exponent": 1.5},
            {"contact.stiffness": "1e10 N/m^1.5"},
            marks=pytest.mark.slow,
        ),
        (
            {"law": "meyer", "stiffness": "2e9 N/m^1.5", "exponent": 1.5},
            {"contact.stiffness": "4e9 N/m^1.4", "contact.exponent": 1.4},
        ),
        pytest.param(
            {"law": "stronge", "yield_strength": "300 MPa"},
            {"contact.yield_strength": "120 MPa"},
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_vibrating_structure_from_bad_starts(
    tmp_path: Path, contact: dict[str, object], start: dict[str, object]
) -> None:
    """Stiffness, stiffness with the exponent that is in its unit, and yield strength, with 0.5 % noise."""
    scene = bracket(**contact)
    measured = fd.from_csv(force_file(tmp_path / "m.csv", scene, 5e-3 * fm.simulate(scene).summary["maximum_force"]))
    found = fd.identify(measured, scene.replace(start), list(start))
    for one in found.parameters:
        name = one.path.partition(".")[2]
        true = scene.contact.parameters.get(name) or getattr(scene.contact, name)
        assert one.identified and one.low < true < one.high
        assert one.high - one.low < 0.25 * true or len(start) > 1
    if len(start) > 1:
        assert found.parameters[0].unit == power_stiffness_unit(found.parameters[1].value) != "N/m^1.4"


@pytest.mark.slow
def test_a_target_that_vibrates(tmp_path: Path) -> None:
    beam = fm.Beam("mild steel", "150 mm", "10 mm", "10 mm")
    ball = fm.Sphere("10 mm", "0.5 m/s", material="mild steel")
    scene = fm.Scene(ball, beam, fm.Contact("hertz", effective_modulus="115 GPa"), solver=fm.Solver(1e-3))
    history = fm.simulate(scene)
    assert history.vibration is not None and history.vibration.contacts > 1
    times = np.linspace(0.0, history.duration, 40)
    force = history.sample_si(times).contact_force
    rows = "\n".join(f"{t!r}, {f!r}" for t, f in zip(times.tolist(), force.tolist(), strict=True))
    (tmp_path / "force.csv").write_text(f"time [s], force [N]\n{rows}\n", encoding="utf-8")
    found = fd.identify(
        fd.from_csv(tmp_path / "force.csv"), scene.replace({"contact.effective_modulus": "100 GPa"}), MODULUS
    )
    assert found.parameters[0].value == pytest.approx(115e9, rel=1e-3)


@pytest.mark.slow
def test_intervals_contain_the_true_values(tmp_path: Path) -> None:
    assert min(covered(20, tmp_path)) >= 18


@pytest.mark.slow
def test_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    measured, scene = force_file(tmp_path / "m.csv", BALL, 3.0), tmp_path / "scene.toml"
    scene.write_text(AWAY.to_toml(), encoding="utf-8")
    fit = "contact.yield_strength,impactor.velocity"
    picture = tmp_path / "fit.png"
    assert main(["identify", str(measured), str(scene), "--fit", fit, "--json", "--plot", str(picture)]) == 0
    table = json.loads(capsys.readouterr().out)
    assert list(table["parameters"]) == fit.split(",")
    strength = table["parameters"]["contact.yield_strength"]
    assert strength["low"] < 1e9 < strength["high"] and strength["units"] == "Pa"
    assert picture.read_bytes().startswith(b"\x89PNG")
    fit = "contact.yield_strength,target.material.density"
    assert main(["identify", str(measured), str(scene), "--fit", fit]) == 0
    out, err = capsys.readouterr()
    assert "contact.yield_strength" in out and "not identified" in out
    assert "warning: target.material.density cannot be identified" in err
    assert main(["identify", str(measured), str(scene), "--fit", "contact.strength"]) == 2
    assert main(["identify", str(tmp_path / "no.csv"), str(scene), "--fit", fit]) == 2


def test_a_measurement_is_not_swept() -> None:
    foreign = xr.Dataset(attrs={"film_model_schema": "impact_measurement", "measured": "impacts"})
    with pytest.raises(ValueError, match="has no impacts to select"):
        foreign.film.scene(impact=3)


def test_before_first_touch_the_impactor_flies(tmp_path: Path) -> None:
    """The time of first touch alone is fitted to a displacement whose record begins before it."""
    times = np.linspace(-20e-6, 60e-6, 40)
    samples = fm.simulate(BALL, accuracy=1e-9).sample_si(np.maximum(times, 0.0))
    moved = np.where(times < 0.0, BALL.impactor.speed * times, samples.impactor_displacement)
    rows = (f"{1e6 * t!r},{1e6 * x!r}" for t, x in zip((times + 25e-6).tolist(), moved.tolist(), strict=True))
    path = tmp_path / "m.csv"
    path.write_text("time [us],displacement [um]\n" + "\n".join(rows) + "\n", encoding="utf-8")
    found = fd.identify(fd.from_csv(path), BALL, ["time_offset"])
    (offset,) = found.parameters
    assert offset.identified and offset.value == pytest.approx(25e-6, rel=1e-6)
    assert found.residual["impactor_displacement"] < 1e-6 * np.abs(moved).max()
    assert found.history().summary["maximum_force"] == pytest.approx(516.0877, rel=1e-6)


def test_an_unusable_initial_scene_is_refused(tmp_path: Path) -> None:
    measured = fd.from_csv(restitution_file(tmp_path / "e.csv", BALL, 0.0))
    short = {"law": "tabulated", "indentation": ["0 um", "5 um"], "force": ["0 N", "300 N"]}
    with pytest.raises(fm.SimulationError, match="an impact of the measurement fails: start from better values"):
        fd.identify(measured, BALL.replace({"contact": short}), ["impactor.radius"])
