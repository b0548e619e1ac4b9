"""Fits to several measurements, other columns and units, other starts, and intervals by profile likelihood."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import t as student

import film_datasets as fd
import film_model as fm
from film_datasets.identification.model import Case
from film_model.cli.main import main
from film_model.scene import STANDARD_GRAVITY

SCENES = Path(__file__).parents[1] / "examples" / "scenes"
BALL = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel_stronge.toml")
AWAY = BALL.replace({"contact.yield_strength": "1.3 GPa"})
STRENGTH = ["contact.yield_strength"]
SPEEDS = ["0.25 m/s", "0.5 m/s"]


def history_file(path: Path, scene: fm.Scene, noise: float = 0.0, begin: float = 0.0, end: float = 2e-4) -> Path:
    """A force history over 100 times, from 0 to `end`, with noise [N]. begin: time of first touch, s."""
    times = np.linspace(0.0, end, 100)
    history = fm.simulate(scene, accuracy=1e-8)
    force = np.where(times >= begin, history.sample_si(np.maximum(times - begin, 0.0)).contact_force, 0.0)
    force = force + np.random.default_rng(1).normal(0.0, noise, times.size)
    rows = "\n".join(f"{t!r},{f!r}" for t, f in zip(times.tolist(), force.tolist(), strict=True))
    path.write_text(f"time,force\ns,N\n{rows}\n", encoding="utf-8")
    return path


def test_heights_accelerations_and_a_row_of_units(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text("drop_height,rebound_height\n[mm],[cm]\n100,3.1\n500,\n", encoding="utf-8")
    ds = fd.from_csv(path)
    assert fd.validate(ds) == []
    np.testing.assert_allclose(
        ds["impactor_velocity"], np.sqrt(2 * STANDARD_GRAVITY * np.array([0.1, 0.5])), rtol=1e-15
    )
    np.testing.assert_allclose(ds["rebound_velocity"], [-np.sqrt(2 * STANDARD_GRAVITY * 0.031), np.nan], rtol=1e-15)
    path.write_text("time [ms],deceleration [g]\n0,0\n1,250\n", encoding="utf-8")
    ds = fd.from_csv(path)
    assert fd.validate(ds) == []
    np.testing.assert_allclose(ds["impactor_acceleration"], [0.0, -250 * 9.80665], rtol=1e-15)
    path.write_text("TIME,ACC\nms,g\n0,0\n1,-250\n", encoding="utf-8")
    chosen = fd.from_csv(path, columns={"time": "TIME", "acceleration": "ACC"})
    assert chosen["impactor_acceleration"].values.tolist() == pytest.approx(ds["impactor_acceleration"].values.tolist())
    path.write_text("drop_height [mm],restitution\n100,0.5\n200,0.4\n-1,0.5\n", encoding="utf-8")
    with pytest.raises(fm.SceneError, match=r"m\.csv:4: a height must not be negative"):
        fd.from_csv(path)


@pytest.mark.slow
def test_an_acceleration_is_fitted_with_the_mass(tmp_path: Path) -> None:
    history = fm.simulate(BALL, accuracy=1e-8)
    times = np.linspace(0.0, history.duration, 60)
    values = history.sample_si(times).contact_force / BALL.mass / 9.80665
    rows = "\n".join(f"{t!r};{a!r}" for t, a in zip(times.tolist(), values.tolist(), strict=True))
    (tmp_path / "m.csv").write_text(f"time;deceleration\ns;g\n{rows}\n", encoding="utf-8")
    measured = fd.from_csv(tmp_path / "m.csv")
    start = AWAY.replace({"impactor.mass": "55 g"})
    found = fd.identify(measured, start, [*STRENGTH, "impactor.mass"])
    assert [one.value for one in found.parameters] == pytest.approx([BALL.yield_strength, BALL.mass], rel=1e-4)


@pytest.mark.slow
def test_several_measurements_are_fitted_together(tmp_path: Path) -> None:
    measured = [
        fd.from_csv(history_file(tmp_path / f"{speed[:3]}.csv", BALL.replace({"impactor.velocity": speed}), 2.0))
        for speed in SPEEDS
    ]
    each = {"impactor.velocity": SPEEDS}
    found = fd.identify(measured, AWAY, STRENGTH, each=each)
    (one,) = found.parameters
    assert found.points == 200 and "200 points of 2 measurements" in found.table()
    assert one.low < BALL.yield_strength < one.high
    singles = [
        fd.identify(ds, AWAY.replace({"impactor.velocity": v}), STRENGTH).parameters[0]
        for ds, v in zip(measured, SPEEDS, strict=True)
    ]
    assert one.standard_error < min(single.standard_error for single in singles)
    assert found.residual["contact_force"] == pytest.approx(2.0, rel=0.15)
    with pytest.raises(ValueError, match=r"each: impactor\.velocity has 1 values for 2 measurements"):
        fd.identify(measured, AWAY, STRENGTH, each={"impactor.velocity": ["1 m/s"]})
    with pytest.raises(ValueError, match=r"each: contact\.yield_strength is fitted"):
        fd.identify(measured, AWAY, STRENGTH, each={STRENGTH[0]: ["1 GPa", "2 GPa"]})
    with pytest.raises(fm.SceneError, match="unknown key"):
        fd.identify(measured, AWAY, STRENGTH, each={"impactor.speeed": SPEEDS})


@pytest.mark.slow
def test_each_history_has_its_own_first_touch(tmp_path: Path) -> None:
    begins = [2e-5, 4.5e-5]
    measured = [fd.from_csv(history_file(tmp_path / f"{k}.csv", BALL, 0.5, begin)) for k, begin in enumerate(begins)]
    found = fd.identify(measured, AWAY, [*STRENGTH, "time_offset"])
    assert [one.path for one in found.parameters] == [*STRENGTH, "time_offset[1]", "time_offset[2]"]
    assert [one.value for one in found.parameters[1:]] == pytest.approx(begins, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fit", "begin", "end", "start"),
    [
        (["time_offset"], 6e-4, 1e-3, {}),
        (STRENGTH, 0.0, 2e-4, {STRENGTH[0]: "12 GPa"}),
        (["impactor.mass", "contact.effective_modulus"], 0.0, 2e-4, {"impactor.mass": "6 g"}),
    ],
    ids=["record begins early", "no yield at the start", "mass"],
)
def test_a_bad_start_does_not_end_beside_the_solution(
    tmp_path: Path, fit: list[str], begin: float, end: float, start: dict[str, str]
) -> None:
    """A time of first touch at which the pulses do not overlap, and a yield strength at which nothing yields, have no
    gradient."""
    measured = fd.from_csv(history_file(tmp_path / "m.csv", BALL, 0.0, begin, end))
    found = fd.identify(measured, BALL.replace(start), fit)
    assert found.residual["contact_force"] < 0.5


@pytest.mark.slow
def test_a_stiffness_and_its_exponent_are_fitted_together(tmp_path: Path) -> None:
    meyer = BALL.replace({"contact": {"law": "meyer", "stiffness": "5e9 N/m^1.4", "exponent": 1.4}})
    measured = fd.from_csv(history_file(tmp_path / "m.csv", meyer))
    start = meyer.replace({"contact": {"law": "meyer", "stiffness": "2e9 N/m^1.3", "exponent": 1.3}})
    found = fd.identify(measured, start, ["contact.stiffness", "contact.exponent"])
    stiffness, exponent = found.parameters
    assert exponent.value == pytest.approx(1.4, abs=1e-5)
    assert stiffness.value == pytest.approx(5e9, rel=1e-4)
    assert stiffness.to_dict()["units"].startswith(("N/m^1.4", "N/m^1.39999"))


def test_profile_intervals_end_where_the_sum_of_squares_has_risen(tmp_path: Path) -> None:
    measured = fd.from_csv(history_file(tmp_path / "m.csv", BALL, 20.0))
    curvature, profile = (fd.identify(measured, AWAY, STRENGTH, 0.95, intervals=i) for i in ("curvature", "profile"))
    (one,), (other,) = profile.parameters, curvature.parameters
    assert one.value == other.value
    assert "intervals at 95 % by profile likelihood" in profile.table()
    assert (one.low, one.high) == pytest.approx((other.low, other.high), rel=0.02)
    assert (one.low, one.high) != (other.low, other.high)

    def square(strength: float) -> float:
        scene = profile.scene.replace({STRENGTH[0]: f"{strength!r} Pa", "solver.accuracy": 1e-7})
        model = Case(measured, {}).predict(scene)["contact_force"]
        return float(np.sum((model - measured["contact_force"].values) ** 2))

    rise = 1.0 + student.ppf(0.975, 99) ** 2 / 99
    for end in (one.low, one.high):
        assert square(end) / square(one.value) == pytest.approx(rise, rel=1e-4)


@pytest.mark.slow
def test_profile_intervals_fit_the_other_parameters_again(tmp_path: Path) -> None:
    """Of two parameters that compensate each other the profile is much wider than the other's fixed value allows."""
    measured = fd.from_csv(history_file(tmp_path / "m.csv", BALL, 10.0))
    fit = ["contact.effective_modulus", "impactor.mass"]
    curvature, profile = (fd.identify(measured, BALL, fit, intervals=i) for i in ("curvature", "profile"))
    alone = fd.identify(measured, curvature.scene, fit[:1], intervals="profile").parameters[0]
    for one, other in zip(profile.parameters, curvature.parameters, strict=True):
        assert one.high - one.low == pytest.approx(other.high - other.low, rel=0.05)
    assert profile.parameters[0].high - profile.parameters[0].low > 1.3 * (alone.high - alone.low)
    with pytest.raises(ValueError, match='intervals: "both" is not allowed'):
        fd.identify(measured, AWAY, fit, intervals="both")


@pytest.mark.slow
def test_a_limit_that_the_measurement_does_not_give_is_open(tmp_path: Path) -> None:
    """Of an impact that hardly yields, the yield strength has a least value only."""
    soft = BALL.replace({"impactor.velocity": "0.035 m/s"})
    measured = fd.from_csv(history_file(tmp_path / "m.csv", soft, 6.0))
    found = fd.identify(measured, soft, STRENGTH, intervals="profile")
    (one,) = found.parameters
    assert not one.identified and 0.7e9 < one.low < one.value and one.high == np.inf
    assert "not identified, but at least 8" in found.table()


@pytest.mark.slow
def test_the_command_takes_several_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    files = [history_file(tmp_path / f"{v[:3]}.csv", BALL.replace({"impactor.velocity": v}), 2.0) for v in SPEEDS]
    scene, picture = tmp_path / "scene.toml", tmp_path / "fit.png"
    scene.write_text(AWAY.to_toml(), encoding="utf-8")
    each = ["--each", "impactor.velocity=0.25 m/s,0.5 m/s"]
    given = [*map(str, files), str(scene), "--fit", STRENGTH[0], *each, "--intervals", "profile"]
    assert main(["identify", *given, "--json", "--plot", str(picture)]) == 0
    found = json.loads(capsys.readouterr().out)
    strength = found["parameters"][STRENGTH[0]]
    assert strength["low"] < BALL.yield_strength < strength["high"] and found["intervals"] == "profile"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert main(["identify", *given, "--law", "hertz,stronge", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["laws"][0]["law"] == "stronge"


@pytest.mark.slow
def test_the_example_files(capsys: pytest.CaptureFixture[str]) -> None:
    measured = SCENES.parent / "measurements"
    fit = ["--fit", "contact.yield_strength,time_offset", "--intervals", "profile"]
    scope = [str(measured / "oscilloscope.csv"), str(SCENES / "tungsten_carbide_on_steel_stronge.toml")]
    assert main(["identify", *scope, *fit, "--columns", "time=TIME", "force=CH1 [2.2 kN]", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["parameters"]
    for path, truth in (("contact.yield_strength", 1e9), ("time_offset", 2e-5)):
        assert found[path]["low"] < truth < found[path]["high"]
    heights = [str(measured / "drop_heights.csv"), str(SCENES / "tungsten_carbide_on_steel.toml")]
    laws = ["--law", "stronge,jackson-green", "--json"]
    assert main(["identify", *heights, "--fit", "contact.yield_strength", *laws]) == 0
    best = json.loads(capsys.readouterr().out)["laws"][0]
    strength = best["fit"]["parameters"]["contact.yield_strength"]
    assert best["law"] == "jackson-green" and strength["low"] < 1e9 < strength["high"]
