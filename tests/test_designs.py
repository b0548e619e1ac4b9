"""Designs from tables of the user, distributions, tolerances and correlations."""

import tracemalloc
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import Sweep, read_sweep, run_sweep
from film_datasets.sweeps.designs import points
from film_datasets.sweeps.distributions import DISTRIBUTIONS, quantiles

SCENE = Path(__file__).parent.parent / "examples" / "scenes" / "tungsten_carbide_on_steel.toml"
BALL = fm.Scene.from_toml(SCENE)
RUNS = """# measured on Tuesday
impactor.velocity [m/s]; impactor.mass [g]; contact.law; target.material.yield_strength
0.1; 30; hertz; 1 GPa
0.25; 60.5; stronge; 1.1 GPa
0.2; 45; stronge; 900 MPa
"""


@pytest.fixture
def sweep_file(tmp_path: Path) -> Path:
    (tmp_path / "runs.csv").write_text(RUNS, "utf-8")
    path = tmp_path / "sweep.toml"
    path.write_text(f'scene = "{SCENE}"\ndesign = {{ file = "runs.csv" }}\n', "utf-8")
    return path


def frame() -> pd.DataFrame:
    return pd.DataFrame(
        {
            "impactor.velocity [m/s]": [0.1, 0.25, 0.2],
            "impactor.mass [g]": [30, 60.5, 45],
            "contact.law": ["hertz", "stronge", "stronge"],
            "target.material.yield_strength": ["1 GPa", "1.1 GPa", "900 MPa"],
        }
    )


def test_a_table_is_a_design_from_a_file_a_frame_or_a_dataset(sweep_file: Path) -> None:
    ds = run_sweep(read_sweep(sweep_file), command="test")
    assert fd.validate(ds) == [] and ds.attrs["design"] == "zip"
    for k, row in enumerate(frame().itertuples(index=False)):
        velocity, mass, law, strength = row
        one = BALL.replace(
            {
                "impactor.velocity": f"{velocity} m/s", "impactor.mass": f"{mass} g", "contact.law": law,
                "target.material.yield_strength": strength,
            }
        )  # fmt: skip
        assert ds.film.scene(impact=k) == one
        assert ds["maximum_force"].values[k] == pytest.approx(fm.simulate(one).summary["maximum_force"], rel=1e-4)
    assert fd.sweep(BALL, frame()).attrs["content_sha256"] == ds.attrs["content_sha256"]
    numbers = frame()[["impactor.velocity [m/s]"]].to_numpy()[:, 0]
    table = xr.Dataset({"impactor.velocity": ("run", numbers * 1e3, {"units": "mm/s"})}, {"run": [7, 8, 9]})
    assert fd.sweep(BALL, table)["impactor_velocity"].values == pytest.approx(numbers, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("impactor.velocity\n1\n", "has no unit, a velocity is needed"),
        ("impactor.velocity [kg]\n1\n", "a velocity is needed"),
        ("impactor.velocty [m/s]\n1\n", "unknown key"),
        ("impactor.velocity [m/s],impactor.mass [g]\n1,\n", "the cell in row 1 is empty"),
        ("impactor.velocity [m/s],impactor.velocity [m/s]\n1,2\n", "is given by two columns"),
        ("impactor.velocity [m/s]\n", "a heading and at least one row"),
        ("impactor.velocity [m/s]\nfast\n", "fast"),
    ],
)
def test_mistakes_of_a_table(sweep_file: Path, text: str, complaint: str) -> None:
    sweep_file.with_name("runs.csv").write_text(text, "utf-8")
    with pytest.raises(fm.SceneError, match=complaint):
        read_sweep(sweep_file)


def test_a_table_and_over_exclude_each_other(sweep_file: Path) -> None:
    text = sweep_file.read_text("utf-8")
    sweep_file.write_text(text + '[over]\n"impactor.mass" = ["1 g"]\n', "utf-8")
    with pytest.raises(fm.SceneError, match="give one of the two"):
        read_sweep(sweep_file)
    for design in ("{ files = 1 }", '{ file = "runs.txt" }'):
        sweep_file.write_text(f'scene = "{SCENE}"\ndesign = {design}\n', "utf-8")
        with pytest.raises(fm.SceneError, match=r"design"):
            read_sweep(sweep_file)


DRAWN = {  # parameters (velocities), mean and standard deviation from the formulas of the distributions
    "truncated-normal": (["2 m/s", "1 m/s", "1 m/s", "3 m/s"], 2.0, 0.5397 / 1.0),  # Johnson & Kotz, ±1 σ
    "triangular": (["1 m/s", "2 m/s", "6 m/s"], 3.0, np.sqrt(14 / 12)),
    "weibull": ([2, "3 m/s"], 3 * 0.886227, 3 * np.sqrt(1 - 0.886227**2)),  # Rayleigh: Γ(3/2), Γ(2)
    "empirical": (["1 m/s", "5 m/s", "3 m/s"], 3.0, np.sqrt(16 / 12)),  # uniform, by interpolation
}


@pytest.mark.parametrize("kind", DRAWN)
def test_a_distribution_has_its_mean_and_deviation(kind: str) -> None:
    given, mean, deviation = DRAWN[kind]
    sweep = Sweep.of(BALL, {"impactor.velocity": {kind: given}}, "sobol", samples=2**14)
    (values,) = sweep.values(0, sweep.size)
    assert values.mean() == pytest.approx(mean, rel=1e-3)
    assert values.std() == pytest.approx(deviation, rel=2e-3)
    assert sweep.axes[0].text().startswith(f"{{ {kind} = [")
    (part,) = sweep.values(1000, 3)
    assert part.tolist() == values[1000:1003].tolist()


def test_every_distribution_is_finite_at_the_ends() -> None:
    numbers = {"truncated-normal": (2.0, 1.0, 1.0, 3.0), "triangular": (1.0, 2.0, 3.0), "weibull": (2.0, 3.0)}
    for kind in DISTRIBUTIONS:
        ends = quantiles(kind, np.array([0.0, 1.0 - 2.0**-53]), numbers.get(kind, (1.0, 2.0)))
        assert np.isfinite(ends).all() and ends[0] < ends[1], kind


def test_a_tolerance_is_uniform_between_its_limits() -> None:
    for text in ("10 mm ± 0.05 mm", "10 mm ± 0.5 %"):
        sweep = Sweep.of(BALL, {"impactor.radius": text}, "random", samples=10)
        assert sweep.axes[0].kind == "uniform"
        assert sweep.axes[0].numbers == pytest.approx((9.95e-3, 10.05e-3), rel=1e-12)
    for text, complaint in (("10 mm ± 0 mm", "must be > 0"), ("10 mm ± 1 kg", "tolerance.*a length is needed")):
        with pytest.raises(fm.SceneError, match=complaint):
            Sweep.of(BALL, {"impactor.radius": text}, "random", samples=10)
    with pytest.raises(fm.SceneError, match="a tolerance needs design"):
        Sweep.of(BALL, {"impactor.radius": "10 mm ± 1 mm"})


def test_correlated_quantities_keep_their_distributions() -> None:
    over = {"impactor.velocity": {"normal": ["2 m/s", "0.1 m/s"]}, "impactor.mass": {"uniform": ["1 g", "3 g"]}}
    given = {"samples": 2**14, "correlation": [[1, 0.8], [0.8, 1]]}
    sweep = Sweep.of(BALL, over, "sobol", **given)
    velocity, mass = sweep.values(0, sweep.size)
    assert (velocity.mean(), velocity.std()) == pytest.approx((2.0, 0.1), rel=2e-3)
    assert (mass.mean(), mass.std()) == pytest.approx((2e-3, 2e-3 / np.sqrt(12)), rel=5e-3)
    # ranks under a Gaussian copula: Pearson's 6/π asin(r/2)
    rank = np.corrcoef(velocity.argsort().argsort(), mass.argsort().argsort())[0, 1]
    assert rank == pytest.approx(6 / np.pi * np.arcsin(0.4), abs=2e-3)
    part = sweep.values(4321, 5)
    assert [p.tolist() for p in part] == [v[4321:4326].tolist() for v in (velocity, mass)]
    ds = fd.sweep(BALL, over, "sobol", samples=8, correlation=given["correlation"])
    assert Sweep.of_dataset(ds).correlation == sweep.correlation
    for wrong, complaint in (
        ([[1, 2], [2, 1]], "least eigenvalue is -1"), ([[1, 0.1], [0.2, 1]], "symmetric"), ([[1]], "2 rows"),
        ("x", "matrix"),
    ):  # fmt: skip
        with pytest.raises(fm.SceneError, match=complaint):
            Sweep.of(BALL, over, "sobol", samples=8, correlation=wrong)


@pytest.mark.slow
def test_a_latin_hypercube_is_scipys_in_a_fraction_of_the_memory() -> None:
    from scipy.stats import qmc

    for dimensions, samples, seed in ((1, 7, 1), (3, 1001, 7)):
        expected = qmc.LatinHypercube(dimensions, rng=seed).random(samples)
        drawn = points("latin-hypercube", dimensions, samples, seed)
        assert (drawn(0, samples) == expected).all()
        assert (drawn(3, 4) == expected[3:7]).all()
    points.cache_clear()
    tracemalloc.start()
    points("latin-hypercube", 3, 10**6, 1)(999_000, 1000)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20e6  # 12 MB for three permutations and 4 MB for a step of them: 200 MB for 10^7 impacts
