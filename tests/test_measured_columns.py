"""Measurements under headings of their own, as oscilloscopes write them."""

import json
from pathlib import Path

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.csv_measurement import doubts_of
from film_datasets.identification import comparison_table
from film_model.cli.main import main

SCENE = Path(__file__).parent.parent / "examples" / "scenes" / "tungsten_carbide_on_steel_stronge.toml"
SCOPE = """Model,DPO2024B
Horizontal Units,s
Sample Interval,1e-06

TIME,CH1,CH2 [V]
s,V,V
{rows}
"""
FIT = ["contact.yield_strength"]
COLUMNS = {"time": "TIME [us]", "force": "CH1 [kN]"}


def rows(separator: str = ",") -> str:
    history = fm.simulate(fm.Scene.from_toml(SCENE))
    times = np.linspace(0.0, history.duration, 41)
    force = history.sample_si(times).contact_force
    return "\n".join(
        separator.join(map(repr, row))
        for row in zip((times * 1e6).tolist(), (force / 1e3).tolist(), [0.0] * 41, strict=True)
    )


@pytest.mark.slow
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_columns_are_found_below_the_lines_of_an_oscilloscope(tmp_path: Path, separator: str) -> None:
    path = tmp_path / "scope.csv"
    path.write_text(SCOPE.replace(",", separator).format(rows=rows(separator)), "utf-8")
    plain = tmp_path / "plain.csv"
    plain.write_text("time [us],force [kN],other\n".replace(",other", "") + "\n".join(
        ",".join(line.split(",")[:2]) for line in rows().splitlines()), "utf-8")  # fmt: skip
    found, expected = fd.from_csv(path, columns=COLUMNS), fd.from_csv(plain)
    assert fd.validate(found) == []
    for name in ("t", "contact_force"):
        assert found[name].values.tolist() == expected[name].values.tolist()


def test_mistakes_of_chosen_columns_have_their_lines(tmp_path: Path) -> None:
    path = tmp_path / "scope.csv"
    path.write_text(SCOPE.format(rows="0,1,0\n1,x,0\n2,3,0"), "utf-8")
    with pytest.raises(fm.SceneError, match=r'scope\.csv:8: contact_force: "x" is not a number'):
        fd.from_csv(path, columns=COLUMNS)
    with pytest.raises(fm.SceneError, match=r'no line has the columns "TIME \[us\]", "CH9 \[kN\]"'):
        fd.from_csv(path, columns={**COLUMNS, "force": "CH9 [kN]"})
    with pytest.raises(fm.SceneError, match=r'scope\.csv:5: column .*"fource'):
        fd.from_csv(path, columns={"time": "TIME [us]", "fource": "CH1 [kN]"})


@pytest.mark.slow
def test_per_cent_and_the_way_to_name_other_headings(tmp_path: Path) -> None:
    path = tmp_path / "rebound.csv"
    path.write_text("v_in (mm/s);COR [%]\n200;61\n500;50.5\n", "utf-8")
    with pytest.raises(fm.SceneError, match="headings of another program by --columns"):
        fd.from_csv(path)
    ds = fd.from_csv(path, columns={"velocity": "v_in", "restitution": "COR"})
    assert ds.impactor_velocity.values == pytest.approx([0.2, 0.5])
    assert ds.coefficient_of_restitution.values == pytest.approx([0.61, 0.505])


def test_identify_takes_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scope.csv"
    path.write_text(SCOPE.format(rows=rows()), "utf-8")
    start = tmp_path / "start.toml"
    scene = fm.Scene.from_toml(SCENE)
    start.write_text(scene.replace({"contact.yield_strength": "1.3 GPa"}).to_toml(), "utf-8")
    given = ["--fit", "contact.yield_strength", "--columns", *(f"{k}={v}" for k, v in COLUMNS.items()), "--json"]
    assert main(["identify", str(path), str(start), *given]) == 0
    found = json.loads(capsys.readouterr().out)["parameters"]["contact.yield_strength"]["value"]
    assert found == pytest.approx(scene.yield_strength, rel=1e-4)


@pytest.mark.slow
def test_the_law_of_a_measurement_is_the_best_of_several(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scope.csv"
    path.write_text(SCOPE.format(rows=rows()), "utf-8")
    given = ["--fit", "contact.yield_strength", "--law", "hertz,meyer,stronge,big-alabo", "--columns"]
    columns = [f"{k}={v}" for k, v in COLUMNS.items()]
    assert main(["identify", str(path), str(SCENE), *given, *columns, "--json"]) == 0
    best, second, third, last = json.loads(capsys.readouterr().out)["laws"]
    assert best["law"] == "stronge" and best["residual"] < 1e-5 < second["residual"]
    assert best["criterion"] < second["criterion"] - 10 and third["fit"] is not None
    assert last["law"] == "meyer" and last["fit"] is None and "stiffness" in last["reason"]
    # by hand, of the second: n ln(S/n) + 2 k + 2 k (k + 1)/(n - k - 1), k = 2
    n, k = 41, 2
    expected = n * np.log(second["residual"] ** 2) + 2 * k + 2 * k * (k + 1) / (n - k - 1)
    assert second["criterion"] == pytest.approx(expected, rel=1e-12)
    table = comparison_table([fd.identification.LawFit("x", None, reason="why")])
    assert "why" in table


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("velocity [m/s], restitution\n1, 0.5\n2, -0.3\n", r"csv:3: coefficient_of_restitution: -0\.3 is not allowed"),
        (
            "velocity [m/s], maximum_force [kN]\n1, -2\n2, -3\n",
            r'csv:2: .*-2000 N is not allowed.*; "-1 N" as the unit',
        ),
        ("velocity [m/s], force [N]\n1, 2\n2, 3\n", r'column "force \[N\]" is of a history over time'),
        ("time [us], restitution\n1, 2\n2, 3\n", r'column "restitution" is of impacts at several velocities'),
        ("time, force [N]\n1, 2\n2, 3\n", r'column "time": has no unit, a time is needed'),
    ],
)
def test_values_and_columns_that_no_impact_has_are_refused(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "measured.csv"
    path.write_text(text, "utf-8")
    with pytest.raises(fm.SceneError, match=expected):
        fd.from_csv(path)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("velocity [m/s], restitution\n0.2, 1.2\n0.5, 0.5\n", ["the measured restitution is up to 1.2"]),
        ("drop_height [m], rebound_height [m]\n1, 4\n2, 1\n", ["the measured rebound is up to 2 times as fast"]),
        ("velocity [m/s], rebound_velocity [m/s]\n1, 0.5\n2, 0.9\n", ["no measured rebound_velocity is negative"]),
        ("velocity [m/s], rebound_velocity [m/s]\n1, -0.5\n2, 0.1\n3,\n", []),
    ],
)
def test_impacts_that_gain_energy_are_doubted(tmp_path: Path, text: str, expected: list[str]) -> None:
    path = tmp_path / "measured.csv"
    path.write_text(text, "utf-8")
    doubts = doubts_of(fd.from_csv(path))
    assert [doubt.startswith(one) for doubt, one in zip(doubts, expected, strict=True)] == [True] * len(expected)


@pytest.mark.slow
def test_a_fit_to_doubtful_impacts_warns(tmp_path: Path) -> None:
    path = tmp_path / "measured.csv"
    path.write_text("velocity [m/s], restitution\n0.2, 1.2\n0.5, 0.5\n1, 0.4\n", "utf-8")
    found = fd.identify(fd.from_csv(path), fm.Scene.from_toml(SCENE), FIT)
    assert found.warnings[-1].startswith("the measured restitution is up to 1.2")


def test_a_column_without_its_heading_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", "any.csv", str(SCENE), "--fit", FIT[0], "--columns", "time"]) == 3
    assert '--columns: "time": QUANTITY=HEADING is needed' in capsys.readouterr().err
    path = tmp_path / "measured.csv"
    path.write_text("time [us], load [N]\n1, 2\n2, 3\n", "utf-8")
    with pytest.raises(fm.SceneError, match=r'no line has the columns "t"; line 1 has "time \[us\], load \[N\]"'):
        fd.from_csv(path, columns={"time": "t"})
