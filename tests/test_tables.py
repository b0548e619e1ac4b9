"""Datasets as CSV, Parquet and MATLAB files, and sweeps in few numbers and pictures."""

import io
import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import loadmat

import film_datasets as fd
import film_model as fm
from film_model.cli.main import main

SCENE = Path(__file__).parent.parent / "examples" / "scenes" / "tungsten_carbide_on_steel.toml"
BALL = fm.Scene.from_toml(SCENE)
OVER = {"contact.law": ["stronge", "hertz"], "impactor.velocity": ["0.1 m/s", "0.2 m/s", "0.3 m/s"]}
HEADINGS = "contact_law", "impactor_velocity [m/s]", "maximum_force [N]", "law", "status", "mass [kg]"


@pytest.fixture(scope="module")
def swept() -> xr.Dataset:
    return fd.sweep(BALL, OVER)


def test_a_sweep_is_a_table_of_its_impacts(swept: xr.Dataset) -> None:
    frame = fd.to_frame(swept)
    assert set(HEADINGS) <= set(frame) and len(frame) == 6 and not any("segment" in name for name in frame)
    for row in frame.to_dict("records"):
        one = swept.sel(contact_law=row["contact_law"], impactor_velocity=row["impactor_velocity [m/s]"])
        assert row["maximum_force [N]"] == one["maximum_force"].item() and row["law"] == row["contact_law"]
        assert row["status"] == "separated" and row["mass [kg]"] == BALL.mass
    turned = fd.to_frame(swept.transpose("impactor_velocity", ...))
    assert sorted(turned["maximum_force [N]"]) == sorted(frame["maximum_force [N]"])


@pytest.mark.parametrize("suffix", ["csv", "parquet", "mat"])
def test_a_table_in_a_file_has_every_bit_and_the_same_bytes_each_time(
    swept: xr.Dataset, suffix: str, tmp_path: Path
) -> None:
    if suffix == "parquet":
        pytest.importorskip("pyarrow")
    first, second = (fd.write(swept, tmp_path / f"{name}.{suffix}") for name in "ab")
    frame = fd.to_frame(swept)
    if suffix == "mat":
        read = loadmat(first, squeeze_me=True)
        assert read["maximum_force"].tolist() == frame["maximum_force [N]"].tolist()
        assert read["units"]["maximum_force"].item() == "N" and read["contact_law"].tolist()[-1] == "hertz"
        assert str(read["scene_toml"]) == swept.attrs["scene_toml"]
    else:
        read = pd.read_csv(first) if suffix == "csv" else pd.read_parquet(first)
        assert list(read) == list(frame)
        assert read["maximum_force [N]"].tolist() == frame["maximum_force [N]"].tolist()
        assert read["contact_law"].tolist() == frame["contact_law"].tolist()
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.slow
def test_a_history_and_a_measurement_are_tables(tmp_path: Path) -> None:
    history = fd.to_dataset(fm.simulate(BALL), samples=11)
    frame = fd.to_frame(history)
    assert len(frame) == history.sizes["t"] and frame["contact_force [N]"].max() == history["maximum_force"]
    measured = tmp_path / "m.csv"
    frame[["t [s]", "contact_force [N]"]].to_csv(measured, index=False)
    assert fd.convert(measured, tmp_path / "m.nc") == []
    back = fd.to_frame(fd.read(tmp_path / "m.nc"))
    assert back["contact_force [N]"].tolist() == frame["contact_force [N]"].tolist()
    assert len(fd.to_frame(fd.load("measured_impacts"))) == 295


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", "csv", "zarr"])
def test_a_file_is_converted(
    swept: xr.Dataset, suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if suffix == "zarr":
        pytest.importorskip("zarr")
    kept = fd.sweep(BALL, {"impactor.velocity": ["0.1 m/s"]}, keep="segments")
    source, target = fd.write(kept, tmp_path / "s.nc"), tmp_path / f"t.{suffix}"
    assert main(["convert", str(source), str(target)]) == 0
    assert ("segments do not fit a table" in capsys.readouterr().err) == (suffix == "csv")
    if suffix == "csv":
        assert pd.read_csv(target)["maximum_force [N]"].item() == kept["maximum_force"].item()
    else:
        with fd.open(target) as ds:
            assert fd.validate(ds) == [] and ds.attrs["content_sha256"] == kept.attrs["content_sha256"]
    assert main(["convert", str(source), str(target)]) == 3
    assert "exists" in capsys.readouterr().err
    assert main(["convert", str(source), str(tmp_path / "t.xls")]) == 3
    assert sorted(p.name for p in tmp_path.iterdir()) == ["s.nc", target.name]


def test_a_sweep_writes_a_table(tmp_path: Path, swept: xr.Dataset) -> None:
    fd.sweep(BALL, OVER, output=tmp_path / "out.csv", workers=2)
    assert (
        pd.read_csv(tmp_path / "out.csv")["maximum_force [N]"].tolist()
        == swept["maximum_force"].values.ravel().tolist()
    )
    with pytest.raises(ValueError, match="segments do not fit a table"):
        fd.sweep(BALL, OVER, keep="segments", output=tmp_path / "other.csv")
    with pytest.raises(ValueError, match="resumed"):
        fd.sweep(BALL, OVER, output=tmp_path / "other.csv", resume=True)
    with pytest.raises(FileExistsError, match="exists"):
        fd.sweep(BALL, OVER, output=tmp_path / "out.csv")


def test_parquet_without_pyarrow_is_refused_before_the_work(
    swept: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError, match=r'pip install "film-model\[parquet\]"'):
        fd.sweep(BALL, OVER, output=tmp_path / "x.parquet")
    assert list(tmp_path.iterdir()) == []


def test_summarise_names_the_impacts_of_the_extremes(
    swept: xr.Dataset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(fd.write(swept, tmp_path / "s.nc"))
    assert main(["summarise", file, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    row, values = report["summary"]["maximum_force"], swept["maximum_force"].values
    assert report["statuses"] == {"separated": 6}
    assert (row["least"], row["greatest"]) == (values.min(), values.max())
    assert row["percentiles"]["50"] == np.median(values) and row["mean"] == pytest.approx(values.mean())
    at = row["greatest_at"]
    assert swept["maximum_force"].isel(at["at"]).item() == values.max()
    assert at["values"] == {
        "contact_law": str(swept["contact_law"].values[at["at"]["contact_law"]]), "impactor_velocity": 0.3,
    }  # fmt: skip
    assert main(["summarise", file, "--quantity", "maximum_force"]) == 0
    assert "greatest maximum force" in capsys.readouterr().out
    assert main(["summarise", file, "--quantity", "maximum_farce"]) == 3
    assert 'did you mean "maximum_force"' in capsys.readouterr().err


def test_a_table_for_a_dem_program(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["table", str(SCENE), "--law", "stronge", "--from", "0.1 m/s", "--to", "1 m/s", "--count", "3"]) == 0
    table = pd.read_csv(io.StringIO(capsys.readouterr().out))
    assert list(table)[:3] == ["impactor_velocity [m/s]", "coefficient_of_restitution", "contact_duration [s]"]
    for velocity, restitution, duration in table.iloc[:, :3].to_numpy().tolist():
        one = fm.simulate(BALL.replace({"impactor.velocity": f"{velocity} m/s", "contact.law": "stronge"})).summary
        expected = one["coefficient_of_restitution"], one["contact_duration"]
        assert (restitution, duration) == pytest.approx(expected, rel=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["histogram", "ecdf", "scatter"])
def test_pictures_of_a_distribution(kind: str) -> None:
    pytest.importorskip("matplotlib")
    velocity = {"uniform": ["0.1 m/s", "1 m/s"]}
    ds = fd.sweep(BALL.replace({"contact.law": "hertz"}), {"impactor.velocity": velocity}, "sobol", samples=256)
    over = {"over": "contact_duration"} if kind == "scatter" else {}
    (panel,) = ds.film.plot(kind=kind, quantity="maximum_force", **over).axes
    force = np.sort(ds["maximum_force"].values)
    if kind == "histogram":
        assert sum(bar.get_height() for bar in panel.patches) == 256
    elif kind == "ecdf":
        x, y = panel.lines[0].get_data()
        assert (
            np.interp(np.median(x[1:]), x, y) == pytest.approx(0.5, abs=0.01) and "quantiles 5 %" in panel.get_title()
        )
    else:
        x, y = panel.lines[0].get_data()
        assert len(x) == 256 and np.sort(y) * 1e3 == pytest.approx(force, rel=1e-12)
    for options, complaint in (({"kind": "pie"}, "histogram, ecdf, scatter"), ({"kind": kind, "quantity": "x"}, '"x"')):
        with pytest.raises(ValueError, match=complaint):
            ds.film.plot(**options)
