"""film_datasets.log_likelihood against closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from test_identification import BALL, force_file, restitution_file

import film_datasets as fd
import film_model as fm


def test_the_likelihood_of_a_history_is_that_of_gaussian_errors(tmp_path: Path) -> None:
    ds = fd.from_csv(force_file(tmp_path / "m.csv", BALL, 3.0))
    model = fm.simulate(BALL, accuracy=1e-7).sample_si(ds["t"].values).contact_force
    residuals = ds["contact_force"].values - model
    expected = -0.5 * np.sum((residuals / 3.0) ** 2) - residuals.size * math.log(3.0 * math.sqrt(2 * math.pi))
    assert fd.log_likelihood(ds, BALL, {"contact_force": "3 N"}) == pytest.approx(expected, rel=1e-6)
    assert fd.log_likelihood(ds, BALL, {"contact_force": "0.003 kN"}, "40 us") < 2 * expected


def test_the_likelihood_is_largest_at_the_fit_and_falls_by_half_the_squared_error(tmp_path: Path) -> None:
    path = "contact.yield_strength"
    ds = fd.from_csv(restitution_file(tmp_path / "m.csv", BALL, 0.01))
    (one,) = fd.identify(ds, BALL, [path], confidence=0.99).parameters
    speeds = [f"{v!r} m/s" for v in ds["impactor_velocity"].values.tolist()]
    best = fm.simulate_batch(BALL.replace({path: f"{one.value!r} Pa"}), velocity=speeds)
    residuals = ds["coefficient_of_restitution"].values - best.summary["coefficient_of_restitution"]
    sigma = math.sqrt(np.sum(residuals**2) / (residuals.size - 1))

    def at(shift: float) -> float:
        scene = BALL.replace({path: f"{one.value + shift * one.standard_error!r} Pa"})
        return fd.log_likelihood(ds, scene, {"coefficient_of_restitution": sigma})

    assert at(0.0) - at(1.0) == pytest.approx(0.5, abs=0.05) and at(0.0) - at(-1.0) == pytest.approx(0.5, abs=0.05)


def test_empty_cells_and_scenes_without_an_impact(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text("t [us],force [N]\n0,0\n20,\n40,400\n", encoding="utf-8")
    ds = fd.from_csv(path)
    full = fm.simulate(BALL, accuracy=1e-7).sample_si(np.array([0.0, 40e-6])).contact_force - [0.0, 400.0]
    expected = -0.5 * np.sum((full / 5.0) ** 2) - 2 * math.log(5.0 * math.sqrt(2 * math.pi))
    assert fd.log_likelihood(ds, BALL, {"contact_force": "5 N"}) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(
    ("sigma", "message"),
    [
        ({}, "contact_force: one for each of contact_force"),
        ({"contact_force": "0 N"}, "contact_force is 0 N, which must be above 0"),
        ({"contact_force": "1 m"}, "a force is needed"),
    ],
)
def test_a_bad_standard_deviation_is_named(tmp_path: Path, sigma: dict[str, str], message: str) -> None:
    ds = fd.from_csv(force_file(tmp_path / "m.csv", BALL, 0.0))
    with pytest.raises(ValueError, match=message):
        fd.log_likelihood(ds, BALL, sigma)
    with pytest.raises(ValueError, match="a measured history or measured impacts"):
        fd.log_likelihood(fd.load("zener"), BALL, sigma)
