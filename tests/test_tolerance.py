"""Tolerance analysis against closed forms: moments, linear variance, Sobol's indices, and the tornado picture."""

import json
import math

import numpy as np
import pytest
from scipy import stats

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import Sweep
from film_datasets.tolerances import one_at_a_time, shapley, tolerance_of
from film_datasets.tolerances.inputs import moments
from film_model.cli.main import main

SCENE = fm.Scene(
    fm.Sphere("10 mm", "1 m/s", mass="30 g"),
    fm.HalfSpace(),
    fm.Contact("hertz", effective_modulus="100 GPa"),
    fm.Effects(gravity=False),
    title="Hertz",
)
OVER = {"impactor.velocity": {"lognormal": ["1 m/s", "0.1 m/s"]}, "impactor.mass": {"lognormal": ["30 g", "6 g"]}}
POWERS = {"impactor.velocity": 1.2, "impactor.mass": 0.6}
"""Of the maximum force, F_m ∝ V^(6/5) m^(3/5)."""


@pytest.fixture(scope="module")
def found():
    return fd.tolerance(SCENE, OVER, samples=2048)


@pytest.mark.parametrize(
    ("given", "exact"),
    [
        ({"normal": ["2 m/s", "0.3 m/s"]}, stats.norm(2.0, 0.3)),
        ({"lognormal": ["2 m/s", "0.3 m/s"]}, None),
        ({"uniform": ["1 m/s", "3 m/s"]}, stats.uniform(1.0, 2.0)),
        ({"triangular": ["1 m/s", "2 m/s", "4 m/s"]}, stats.triang(1 / 3, 1.0, 3.0)),
        ({"weibull": [3.0, "2 m/s"]}, stats.weibull_min(3.0, scale=2.0)),
        ("2 m/s ± 10 %", stats.uniform(1.8, 0.4)),
    ],
)
def test_moments_of_distributions(given, exact):
    (axis,) = Sweep.of(SCENE, {"impactor.velocity": given}, "sobol", samples=8).axes
    wanted = (2.0, 0.3) if exact is None else (exact.mean(), exact.std())
    assert moments(axis) == pytest.approx(wanted, rel=2e-3)


def test_linear_variance_is_that_of_the_exponents(found):
    spread = found.spreads["maximum_force"]
    relative = {path: POWERS[path] * deviation / mean for path, (mean, deviation) in found.numbers.items()}
    assert spread.linear / spread.at_means == pytest.approx(math.hypot(*relative.values()), rel=1e-6)
    variance = sum(value**2 for value in relative.values())
    assert spread.shares == pytest.approx({path: value**2 / variance for path, value in relative.items()}, rel=1e-6)


def test_sobol_indices_are_those_of_a_product_of_lognormal_numbers(found):
    # y = Π x_i^{a_i}: Var_i = exp(a_i² s_i²) − 1 of the factor, Π(1 + Var_i) − 1 of y, all relative to the means
    logs = {path: math.log1p((deviation / mean) ** 2) for path, (mean, deviation) in found.numbers.items()}
    own = {path: math.expm1(POWERS[path] ** 2 * value) for path, value in logs.items()}
    whole = math.prod(1.0 + value for value in own.values()) - 1.0
    spread = found.spreads["maximum_force"]
    assert spread.deviation / spread.mean == pytest.approx(math.sqrt(whole), rel=0.02)
    for path, value in own.items():
        others = math.prod(1.0 + v for p, v in own.items() if p != path) - 1.0
        first, total = spread.indices[path]
        assert first.low <= value / whole <= first.high
        assert total.low <= 1.0 - others / whole <= total.high
        assert first.value == pytest.approx(value / whole, abs=0.02)
        assert first.high - first.low < 0.2
    restitution = found.spreads["coefficient_of_restitution"]
    assert restitution.deviation < 1e-12


def test_correlated_numbers_have_shapley_effects():
    found = fd.tolerance(SCENE, OVER, samples=1000, correlation=[[1, -0.9], [-0.9, 1]], quantities=["maximum_force"])
    spread = found.spreads["maximum_force"]
    a, b = (POWERS[path] * deviation / mean for path, (mean, deviation) in found.numbers.items())
    assert spread.linear / spread.at_means == pytest.approx(math.sqrt(a * a + b * b - 1.8 * a * b), rel=1e-6)
    assert spread.deviation / spread.mean == pytest.approx(spread.linear / spread.at_means, rel=0.05)
    assert spread.indices == {} and "Shapley's (95 %)" in str(found) and "1000 points, sobol, correlated" in str(found)
    # y = a x + b z of correlation r: a² (1 − r²/2) + a b r + b² r²/2 is the effect of x (Owen & Prieur 2017)
    whole, r = a * a + b * b - 1.8 * a * b, -0.9
    exact = [(p * p * (1 - r * r / 2) + p * q * r + q * q * r * r / 2) / whole for p, q in ((a, b), (b, a))]
    assert list(spread.shares.values()) == pytest.approx(exact, rel=1e-6)
    for share, effect in zip(exact, spread.effects.values(), strict=True):
        assert effect.value == pytest.approx(share, abs=0.02)
        assert effect.low < effect.value < effect.high < effect.low + 0.2
    assert sum(effect.value for effect in spread.effects.values()) == pytest.approx(1.0, rel=1e-12)


def test_shapley_effects_of_independent_numbers_lie_between_the_indices():
    u = np.random.default_rng(1).random((4096, 6))
    y = [np.prod(1.0 + probabilities, axis=1) for probabilities in shapley.designs(u, np.eye(3))]
    effects = shapley.effects(np.array(y), 0.95, 1)
    variance = (1.5**2 + 1 / 12) ** 3 - 1.5**6
    for effect in effects:
        assert effect.low < 1 / 3 < effect.high and effect.value == pytest.approx(1 / 3, abs=0.02)
    first, total = 1.5**4 / 12 / variance, 1 - ((1.5**2 + 1 / 12) ** 2 - 1.5**4) * 1.5**2 / variance
    assert first < effects[0].value < total


def test_the_design_and_the_number_of_points_are_those_asked_for(tmp_path):
    sweep = Sweep.of(SCENE, OVER, "random", samples=100, seed=2)
    found = tolerance_of(sweep, ["maximum_force"])
    assert found.spreads["maximum_force"].used == 200 and "100 points, random" in str(found)
    with pytest.raises(ValueError, match="samples: 5 must be >= 8"):
        fd.tolerance(SCENE, OVER, samples=5)


def test_correlated_numbers_move_together_in_the_picture():
    free, tied = (
        one_at_a_time(Sweep.of(SCENE, OVER, "sobol", samples=8, correlation=given), "maximum_force")
        for given in (None, [[1, -0.5], [-0.5, 1]])
    )
    assert all(one.size < other.size for one, other in zip(tied, free, strict=True))


def test_many_correlated_numbers_have_no_shares_and_it_is_said(monkeypatch):
    monkeypatch.setattr(shapley, "MOST_NUMBERS", 1)
    found = fd.tolerance(SCENE, OVER, samples=16, correlation=[[1, 0.5], [0.5, 1]], quantities=["maximum_force"])
    assert found.spreads["maximum_force"].effects == {} == found.spreads["maximum_force"].shares
    assert "no shares of the variance: 2 correlated numbers, at most 1 can be" in found.warnings


def test_the_same_analysis_has_the_same_numbers_and_says_them(found):
    again = fd.tolerance(SCENE, OVER, samples=2048)
    assert again.to_dict() == found.to_dict()
    assert "share of the variance" in str(found)
    mean, deviation = found.of("maximum_force")
    assert mean.to("N").magnitude > 5.0 * deviation.to("N").magnitude


def test_one_number_at_a_time():
    sweep = Sweep.of(SCENE, {**OVER, "impactor.radius": "10 mm ± 0.1 mm"}, "sobol", samples=8)
    first, second, third = one_at_a_time(sweep, "maximum_force")
    assert first.size > second.size > third.size > 0.0
    assert third.path == "impactor.radius"
    for swing in (first, second, third):
        power = {**POWERS, "impactor.radius": 0.2}[swing.path]
        assert swing.at_high / swing.at_low == pytest.approx((swing.high / swing.low) ** power, rel=1e-4)


def test_the_tornado_picture_of_a_sweep_and_of_an_analysis(tmp_path, found):
    ds = fd.sweep(SCENE, OVER, "sobol", samples=16)
    for figure in (fd.plot(ds, kind="tornado", quantity="maximum_force"), fd.plot_tornado(found, tmp_path / "t.svg")):
        (panel,) = figure.axes
        assert {text.get_text() for text in panel.get_yticklabels()} == {"impactor mass", "impactor velocity"}
        assert panel.get_xlabel() == "maximum force (kN)"
        assert len(panel.patches) == 4
    assert (tmp_path / "t.svg").stat().st_size > 1000
    with pytest.raises(ValueError, match='"maximum_farce" is not a summary value; did you mean "maximum_force"'):
        fd.plot(ds, kind="tornado", quantity="maximum_farce")


def test_what_does_not_scatter_is_refused():
    with pytest.raises(fm.SceneError, match=r"over\.contact\.law: has words, a tolerance needs a number"):
        fd.tolerance(SCENE, {"contact.law": ["hertz", "auto"]} | OVER)


def test_the_command_prints_one_object(tmp_path, capsys):
    (tmp_path / "scene.toml").write_text(SCENE.to_toml())
    lines = [
        'scene = "scene.toml"',
        'design = "sobol"',
        "samples = 32",
        "[over]",
        '"impactor.velocity" = "1 m/s ± 2 %"',
    ]
    (tmp_path / "sweep.toml").write_text("\n".join(lines))
    assert main(["tolerance", str(tmp_path / "sweep.toml"), "--json", "--quantity", "maximum_force"]) == 0
    table = json.loads(capsys.readouterr().out)["spreads"]["maximum_force"]
    assert table["units"] == "N"
    assert table["sobol_indices"]["impactor.velocity"]["first"][0] == pytest.approx(1.0, abs=0.2)
    assert np.isfinite(table["linear_standard_deviation"])
    assert main(["tolerance", str(tmp_path / "sweep.toml"), "--samples", "2"]) == 3
    assert "--samples: 2 is not allowed" in capsys.readouterr().err
