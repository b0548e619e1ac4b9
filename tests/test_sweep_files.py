"""Sweeps: files, damage to them, and commands."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr
from sweep_cases import BALL, FILE, SPEEDS, STRENGTHS, cli

import film_datasets as fd
from film_datasets.sweeps import read_sweep
from film_model.cli.main import main
from film_model.solve.history import SUMMARY


@pytest.mark.slow
def test_command_writes_and_reports(capsys: pytest.CaptureFixture[str], sweep_file: Path) -> None:
    output = sweep_file.with_name("out.nc")
    status, out, err = cli(capsys, "sweep", sweep_file, "--output", output, "--json")
    assert status == 0
    table = json.loads(out)
    assert table["impacts"] == 60
    assert table["statuses"] == {"separated": 60}
    assert list(table["summary"]) == list(SUMMARY)
    assert "60 of 60 impacts, 100 %" in err
    ds = fd.read(output)
    assert fd.validate(ds) == []
    force = table["summary"]["maximum_force"]
    assert force["greatest"] == ds["maximum_force"].values.max()
    assert force["mean"] == pytest.approx(ds["maximum_force"].values.mean())
    assert force["standard_deviation"] == pytest.approx(ds["maximum_force"].values.std(ddof=1))
    assert ds.film.summary()["maximum_force"] == {k: v for k, v in force.items() if k != "units"}
    assert f"film-model sweep {sweep_file}" in ds.attrs["history"]
    status, out, err = cli(capsys, "sweep", sweep_file, "--output", output)
    assert (status, out) == (3, "")
    assert "--force" in err
    assert cli(capsys, "sweep", sweep_file, "--output", output, "--resume")[0] == 0
    assert (
        cli(capsys, "sweep", sweep_file, "--output", output, "--force", "--keep", "samples=11", "--workers", 1)[0] == 0
    )
    assert fd.read(output)["sampled_contact_force"].shape == (30, 2, 11)


def test_dotted_keys_need_no_quotes(sweep_file: Path) -> None:
    quoted = read_sweep(sweep_file)
    sweep_file.write_text(FILE.replace('"impactor.velocity"', "impactor.velocity"), encoding="utf-8")
    assert read_sweep(sweep_file).text() == quoted.text()


def test_same_input_gives_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    contents = set()
    for workers in (1, 2):
        fd.sweep(BALL, SPEEDS, output=tmp_path / f"{workers}.nc", workers=workers).close()
        contents.add((tmp_path / f"{workers}.nc").read_bytes())
    assert len(contents) == 1


@pytest.mark.parametrize("spoil", ["status", "content", "segments", "unit"])
def test_validate_finds_defects_of_a_sweep(spoil: str) -> None:
    ds = fd.sweep(BALL, SPEEDS, keep="segments")
    if spoil == "status":
        ds["status"].values[3] = 99
    elif spoil == "content":
        ds["maximum_force"].values[3] *= 1.0 + 1e-15
    elif spoil == "segments":
        ds["segment_count"].values[3] += 1
    else:
        ds["impactor_velocity"].attrs["long_name"] = "speed"
    assert len(fd.validate(ds)) >= 1


@pytest.mark.parametrize("content", [b"", b"rubbish", b"\x89HDF\r\n\x1a\n" + bytes(200)])
def test_a_damaged_file_gives_one_message(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "x.nc"
    path.write_bytes(content)
    with pytest.raises(OSError, match=r"x\.nc: is (not a netCDF file, or is damaged|empty)"):
        fd.open(path)
    with pytest.raises(FileNotFoundError, match="there is no such file"):
        fd.open(tmp_path / "y.nc")


def test_a_table_is_no_dataset(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_text("t [s],contact_force [N]\n0,0\n", "utf-8")
    with pytest.raises(ValueError, match="does not hold the whole dataset"):
        fd.open(tmp_path / "x.csv")


def test_a_foreign_file_gives_one_message(tmp_path: Path) -> None:
    path = tmp_path / "x.nc"
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(path)
    with pytest.raises(ValueError, match=r"x\.nc: not a dataset of film-model"):
        fd.open(path)
    assert fd.validate(xr.open_dataset(path)) == [
        "not a dataset of film-model: the attribute film_model_schema does not name a kind"
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["grid", "samples", "segments", "dense"])
def test_cf_checker_finds_nothing_in_sweeps(name: str, tmp_path: Path) -> None:
    pytest.importorskip("compliance_checker")
    over = {**SPEEDS, "contact.law": ["hertz", "big-alabo"]}
    drawn = {
        **STRENGTHS,
        "impactor.material": ["mild steel", "WC, Big-Alabo 2017"],
        "impactor.radius": {"normal": ["10 mm", "8 mm"]},
    }
    options = {
        "grid": {"over": over},
        "samples": {"over": drawn, "design": "sobol", "samples": 32},
        "segments": {"over": over, "keep": "segments"},
        "dense": {"over": drawn, "design": "random", "samples": 32, "keep": "samples=9"},
    }[name]
    fd.sweep(BALL, output=tmp_path / "x.nc", **options).close()
    checker = Path(sys.executable).with_name("compliance-checker")
    found = subprocess.run(
        [checker, "--test=cf:1.11", "--criteria=strict", tmp_path / "x.nc"], capture_output=True, text=True, check=False
    )
    assert "All tests passed!" in found.stdout, found.stdout + found.stderr


def test_ncdump_reads_them(tmp_path: Path) -> None:
    if shutil.which("ncdump") is None:
        pytest.skip("ncdump is not there")
    fd.sweep(BALL, SPEEDS, output=tmp_path / "x.nc").close()
    found = subprocess.run(["ncdump", "-h", tmp_path / "x.nc"], capture_output=True, text=True, check=True)
    assert 'maximum_force:units = "N"' in found.stdout


@pytest.mark.slow
def test_a_zarr_folder_is_drawn_and_takes_the_place_of_a_file(tmp_path: Path, sweep_file: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("zarr")
    (tmp_path / "out.zarr").write_text("an old file", encoding="utf-8")
    assert main(["sweep", str(sweep_file), "--output", str(tmp_path / "out.zarr"), "--force"]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.zarr", "sweep.toml"]
    over = "impactor_velocity, target_material_yield_strength"
    assert main(["plot", f"{tmp_path / 'out.zarr'}/", "--over", over]) == 0
    assert (tmp_path / "out.png").is_file()
    assert main(["plot", str(tmp_path / "out.zarr"), "--force", "--over", "impactor_velocity,impactor_velocity"]) == 3


@pytest.mark.slow
def test_a_folder_that_is_no_store_is_not_replaced(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, sweep_file: Path
) -> None:
    pytest.importorskip("zarr")
    output = tmp_path / "out.zarr"
    output.mkdir()
    (output / "thesis.tex").write_text("precious", encoding="utf-8")
    for force in ([], ["--force"]):
        status, _, err = cli(capsys, "sweep", sweep_file, "--output", output, *force)
        assert status == 3 and "is a folder but not a Zarr store, and is not replaced" in err
    assert [path.name for path in output.iterdir()] == ["thesis.tex"]
    (output / "thesis.tex").unlink()
    output.rmdir()
    assert cli(capsys, "sweep", sweep_file, "--output", output)[0] == 0
    assert cli(capsys, "sweep", sweep_file, "--output", output)[2] == f"{output}: exists; use --force to replace it\n"
    assert cli(capsys, "sweep", sweep_file, "--output", output, "--force")[0] == 0
    with pytest.raises(FileExistsError, match=r"exists; use overwrite=True to replace it$"):
        fd.sweep(BALL, SPEEDS, output=output)


@pytest.mark.slow
def test_a_finished_output_of_another_sweep_is_not_reused(tmp_path: Path) -> None:
    target = tmp_path / "s.nc"
    fd.sweep(BALL, SPEEDS, keep="samples=11", output=target).close()
    with pytest.raises(FileExistsError, match="is not the finished output of this sweep"):
        fd.sweep(BALL, SPEEDS, keep="samples=21", output=target, resume=True)
    with fd.sweep(BALL, SPEEDS, keep="samples=11", output=target, resume=True) as ds:
        assert ds.sizes["normalised_time"] == 11
        for place in (1.5, -1, 40):
            with pytest.raises(KeyError, match="impactor_velocity is missing"):
                ds.film.scene(impact=place)
    drawn = fd.sweep(BALL, {"impactor.velocity": {"uniform": ["1 m/s", "2 m/s"]}}, "random", samples=4)
    for place in (1.5, -1, 4, "1"):
        with pytest.raises(KeyError, match="must be from 0 to 3"):
            drawn.film.scene(impact=place)
