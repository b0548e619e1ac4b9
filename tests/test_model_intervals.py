"""The intervals of the model: stored residuals, coverage of held-out rows, and where they are printed."""

import json
import math
from collections import Counter

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.evidence import evidence_rows
from film_model.cli.main import main
from film_model.problem.model_intervals import (
    ABOVE,
    BELOW,
    FEWEST,
    family_of,
    residuals_of,
    stored,
    yield_velocities,
)
from film_model.studies.residuals import central, coverage, coverage_of_new_sources, predictions
from film_model.studies.validation import scene_of

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "density": "7850 kg/m^3", "yield_strength": "1.2 GPa"}
E, DENT = "coefficient_of_restitution", "permanent_indentation"


def scene(velocity="2 m/s", law="auto", **target):
    ball = fm.Sphere("1.5 mm", velocity=velocity, mass="5.5 g", material="tungsten carbide")
    return fm.Scene(ball, fm.HalfSpace(STEEL | target), fm.Contact(law), effects=fm.Effects(gravity=False))


@pytest.fixture(scope="module")
def found():
    return predictions(evidence_rows(fd.load("measured_impacts")))


def test_held_out_rows_lie_in_their_interval(found):
    covered = coverage(found)
    assert covered.rows >= 20
    assert abs(covered.share - 0.9) <= max(0.05, 2.0 * covered.spread)
    assert coverage_of_new_sources(found).inside < covered.inside, "neighbours in a table help each other"


def test_a_central_interval_covers_nine_of_ten():
    """Of 99 values the 5th and the 95th; of 29 between the first two and the last two; of a few all."""
    assert central([float(k) for k in range(1, 100)]) == pytest.approx((5.0, 95.0))
    assert central([float(k) for k in range(1, 30)]) == pytest.approx((1.5, 28.5))
    assert central([0.0, 0.0, 0.0, 7.0]) == (0.0, 7.0) and central([2.0]) == (2.0, 2.0)
    draws = np.sort(np.random.default_rng(1).normal(size=(4000, 30)))
    new = np.random.default_rng(2).normal(size=4000)
    inside = [low <= value <= high for (low, high), value in zip(map(central, draws.tolist()), new, strict=True)]
    assert np.mean(inside) == pytest.approx(0.9, abs=0.015)


def test_a_family_with_too_few_rows_takes_the_wider_one():
    assert stored()[BELOW, E].rows < FEWEST <= stored()["yielding", E].rows
    assert residuals_of(BELOW, E) == stored()["yielding", E] != residuals_of(ABOVE, E)
    assert residuals_of("elastic", E) is None and residuals_of(ABOVE, "maximum_force") is None
    history = fm.simulate(scene("0.5 m/s"))
    assert family_of(history.scene) == BELOW
    assert "; fewer than 9 of them are like this one" in history.interval(E)[2]


def test_an_interval_is_the_value_times_the_residuals():
    history = fm.simulate(scene())
    low, high, evidence = history.interval(E)
    own = residuals_of(ABOVE, E)
    assert low.magnitude == pytest.approx(history.summary[E] * math.exp(own.low))
    assert high.magnitude == pytest.approx(history.summary[E] * math.exp(own.high))
    assert evidence == f"{own.rows} measurements of steel of known hardness beyond 50 yield velocities"
    assert history.interval(DENT)[0].check("[length]")
    assert "; so few cover 83 % of the next; fewer than 9 of them are like this one" in history.interval(DENT)[2]
    slow = f"{2.0 / yield_velocities(scene('1 m/s')):.6g} m/s"
    assert fm.simulate(scene(slow)).interval(E)[1].magnitude == 1.0
    assert "; extrapolated from " in fm.simulate(scene("6 m/s", yield_strength="600 MPa")).interval(E)[2]
    with pytest.raises(ValueError, match="is no summary value"):
        history.interval("restitution")


@pytest.mark.filterwarnings("ignore::film_model.ImpactWarning")
def test_without_evidence_there_is_no_interval():
    soft = {"youngs_modulus": "3 GPa", "yield_strength": "60 MPa"}
    for other in (scene("1 mm/s"), scene(**soft), scene(law="hertz")):
        history = fm.simulate(other)
        assert history.intervals == {} and history.interval(E) is None
    bodies = fm.Scene(
        fm.Sphere("5 mm", velocity="2 m/s", material="mild steel"), fm.Plate("mild steel", thickness="5 mm")
    )
    assert fm.simulate(bodies).intervals == {}


def test_json_text_html_and_dataset_have_it(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(scene().to_toml(), "utf-8")
    assert main(["run", str(path), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)["summary"]
    low, high = summary[E]["interval"]
    assert low < high and summary[E]["evidence"].startswith(f"{residuals_of(ABOVE, E).rows} measurements of ")
    assert "interval" not in summary["maximum_force"] and "evidence" not in summary["maximum_force"]
    assert main(["run", str(path)]) == 0
    printed = capsys.readouterr().out
    assert f", {low:.3g} to {high:.3g} (90 % of {summary[E]['evidence']})" in printed
    history = fm.simulate(scene())
    assert f", {low:.3g} to {high:.3g} (90 % of" in history._repr_html_()
    ds = history.to_dataset()
    assert fd.validate(ds) == []
    assert ds[E].attrs["model_interval"].tolist() == [low, high] and ds[E].attrs["evidence"] == summary[E]["evidence"]
    fd.write(ds, tmp_path / "history.nc")
    read = fd.read(tmp_path / "history.nc")
    assert read[E].attrs["model_interval"].tolist() == [low, high]
    assert "model_interval" not in read["maximum_force"].attrs


def test_families_part_at_fifty_yield_velocities(found):
    for one in found:
        ratio = yield_velocities(scene_of("auto", one.row))
        assert one.family == ("elastic" if ratio is None else BELOW if ratio <= 50.0 else ABOVE)
    assert Counter(one.family for one in found)[ABOVE] > 30


def test_rows_with_a_hardness_give_it_as_hardness(found):
    """Tabor: H = HV 9.80665 MPa/0.927 on the projected area, flow strength H/2.8."""
    hard = [one.row for one in found if "hardness" in one.row.target]
    assert len(hard) >= 80 and "yield_strength" not in "".join(row.target for row in hard)
    first = scene_of("auto", hard[0])
    assert hard[0].note.startswith("impact body D on 300 HV")
    assert first.target.material.hardness == pytest.approx(300.0 * 9.80665e6 / 0.927)
    assert first.yield_strength == pytest.approx(1.1334e9, rel=1e-4)
