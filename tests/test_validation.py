"""The laws against measured and computed values: the dataset, the comparison, the command, and its page."""

import csv
import json
import math

import pytest
from test_examples import EXAMPLES

import film_datasets as fd
from film_datasets.evidence import evidence_from_csv, evidence_rows
from film_model.cli.main import main
from film_model.solve.simulate import simulate_quietly
from film_model.studies.validation import AUTO, GROUPS, TESTED, compare, elastic, median, own_numbers, predict, scene_of


@pytest.fixture(scope="module")
def rows():
    return evidence_rows(fd.load("measured_impacts"))


@pytest.fixture(scope="module")
def reports(rows):
    return {report.law: report for report in compare(rows, (AUTO, "big-alabo", "stronge", "kogut-etsion"))}


def test_the_dataset_is_complete_and_valid(rows):
    ds = fd.load("measured_impacts")
    assert fd.validate(ds) == []
    shown = [row for row in rows if row.kind == "measured"]
    usable = [row for row in shown if row.usable]
    assert len(shown) >= 160 and len({row.source for row in shown}) >= 25
    assert len(usable) >= 80 and len({row.source for row in usable}) >= 10
    assert {line.partition(": ")[0] for line in ds.attrs["sources"].split("\n")} == {row.source for row in rows}
    assert all(0.0 < row.uncertainty < 0.3 for row in usable)
    assert all(row.radius > 0.0 and row.mass > 0.0 and row.velocity > 0.0 and row.ball and row.target for row in usable)
    assert len({(row.source, row.number) for row in rows}) == len(rows)
    assert all((row.law in TESTED) == (row.kind in ("own_fit", "same_law")) for row in rows)


def test_a_third_of_the_measured_rows_is_held_out(rows):
    ds = fd.load("measured_impacts")
    assert [row.held_out for row in rows] == [bool(value) for value in ds["held_out"].values]
    usable = [row for row in rows if row.usable]
    assert 0.25 < sum(row.held_out for row in usable) / len(usable) < 0.45
    assert rows[0]._replace(value=1.0, note="").held_out == rows[0].held_out, "by source and number only"


def test_words_that_are_not_known_are_named(tmp_path):
    folder = EXAMPLES.parent / "datasets" / "published"
    path = folder / "measured_impacts.csv"
    wrong = tmp_path / "wrong.csv"
    wrong.write_text(path.read_text("utf-8").replace(",theory,formula", ",theory,guess"), "utf-8")
    with pytest.raises(ValueError, match="column sureness: 'guess' is not one of table, figure"):
        evidence_from_csv(wrong, folder / "measured_impacts_sources.csv")


def test_leeb_rebounds_are_those_of_the_laws(rows):
    """Impact body D on 955, 407 and 583 HV; S_y = HV 9.80665 MPa/0.927/2.8."""
    leeb = [row for row in rows if row.source.startswith("proceq") and row.mass == 5.5e-3]
    assert [row.value for row in leeb] == [0.890, 0.640, 0.770]
    quoted = {
        "auto": (0.846, 0.616, 0.712),
        "jackson-green": (0.840, 0.570, 0.690),
        "kogut-etsion": (0.852, 0.635, 0.713),
    }
    for law, expected in quoted.items():
        assert [predict(law, row).value for row in leeb] == pytest.approx(expected, rel=0.012)


def test_dents_are_the_printed_diameters(rows):
    row = next(row for row in rows if row.usable and row.quantity == "dent_diameter")
    found = simulate_quietly(scene_of(AUTO, row), accuracy=1e-5).summary["dent_diameter"]
    assert predict(AUTO, row).value == found


def test_the_default_comes_first_and_falls_with_velocity(reports):
    assert next(iter(reports)) == AUTO
    assert len(reports[AUTO].errors(GROUPS["measured"])) == len(reports[AUTO].errors(GROUPS["measured, used"])) + len(
        reports[AUTO].errors(GROUPS["measured, held out"])
    )
    assert reports[AUTO].monotone and reports["kogut-etsion"].monotone
    assert not reports["big-alabo"].monotone and not reports["stronge"].monotone
    assert reports["stronge"].rises == ("from 1.000 to 1.066",)
    assert median(reports[AUTO].errors(GROUPS["measured"])) < 0.18
    assert any(p.outside for p in reports[AUTO].predictions)


def test_elastic_theories_and_values_of_the_same_law(rows):
    for prediction in elastic(rows):
        assert abs(prediction.error) < (0.13 if prediction.row.source == "olsson_1992" else 0.01), prediction
    for prediction in own_numbers(rows):
        assert abs(prediction.error) < (0.03 if prediction.row.kind == "own_fit" else 0.006), prediction


@pytest.mark.slow
def test_the_command(capsys, tmp_path):
    output = tmp_path / "rows.csv"
    assert main(["validate", "--law", "big-alabo", "--output", str(output)]) == 0
    printed = capsys.readouterr().out
    assert "big-alabo" in printed and "not monotone" in printed and "from 0.823 to 0.930" in printed
    table = list(csv.DictReader(output.read_text("utf-8").splitlines()))
    assert len(table) >= 80 and sum(not math.isnan(float(line["big-alabo"])) for line in table) >= 80
    assert main(["validate", "--law", "auto", "--json"]) == 0
    (report,) = json.loads(capsys.readouterr().out)["laws"]
    assert report["monotone"] is True and report["groups"]["measured"]["count"] >= 80
    assert main(["validate", "--law", "hertz"]) == 3
    assert "is not compared; there are auto" in capsys.readouterr().err
