"""The files of sweeps: compression, chunks, number of files, disk space, the same bytes from any number of workers."""

from pathlib import Path

import netCDF4
import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import Sweep, run_sweep
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.checkpoint import Checkpoint
from film_datasets.sweeps.disk_space import disk_space
from film_model.cli.main import main

SCENE = Path(__file__).parent.parent / "examples" / "scenes" / "tungsten_carbide_on_steel.toml"
BALL = fm.Scene.from_toml(SCENE).replace({"contact.law": "hertz"})
OVER = {"impactor.velocity": {"uniform": ["0.1 m/s", "5 m/s"]}, "impactor.mass": {"uniform": ["20 g", "80 g"]}}


@pytest.mark.slow
def test_a_netcdf_file_is_compressed_in_chunks_that_fit(tmp_path: Path) -> None:
    with fd.sweep(BALL, OVER, "sobol", samples=1024, keep="segments", output=tmp_path / "s.nc") as ds:
        assert fd.validate(ds) == []
        segments = ds.sizes["segment"]
    with netCDF4.Dataset(tmp_path / "s.nc") as file:
        filters = file["maximum_force"].filters()
        assert filters["zlib"] and filters["shuffle"] and filters["complevel"] == 1
        assert file["maximum_force"].chunking() == [1024] and file["radius"].chunking() == "contiguous"
        assert file["segment_xi"].chunking() == [32768] and segments < 2 * 32768
    fd.sweep(BALL, OVER, "sobol", samples=120, keep="segments", output=tmp_path / "small.nc").close()
    assert (tmp_path / "small.nc").stat().st_size < 0.6e6  # chunks of 65536 segments: 10 MB


@pytest.mark.slow
@pytest.mark.parametrize("keep", ["segments", "samples=7"])
def test_a_zarr_folder_has_few_files_and_the_data_in_memory(
    keep: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("zarr")
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 8)
    monkeypatch.setattr("film_datasets.sweeps.blocks.MOST_GROWING", 64)
    grid = {"contact.law": ["hertz", "stronge"], "impactor.velocity": {"from": "0.1 m/s", "to": "5 m/s", "count": 50}}
    for over, design in ((grid, {}), (OVER, {"design": "sobol", "samples": 100})):
        memory = fd.sweep(BALL, over, **design, keep=keep)
        with fd.sweep(BALL, over, **design, keep=keep, output=tmp_path / "s.zarr", overwrite=True) as ds:
            assert ds.attrs["content_sha256"] == memory.attrs["content_sha256"]
            assert fd.validate(ds) == []
        files = [path for path in (tmp_path / "s.zarr" / "maximum_force").rglob("*") if path.is_file()]
        assert len(files) <= 1 + 4  # the metadata, and a file for 8 of the 13 or 14 blocks


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", "zarr"])
def test_any_number_of_workers_writes_the_same_bytes(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if suffix == "zarr":
        pytest.importorskip("zarr")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 32)
    found: list[dict[str, bytes]] = []
    for workers in (1, 3):
        path = tmp_path / f"{workers}.{suffix}"
        over = {**OVER, "contact.law": ["hertz", "stronge"]}
        fd.sweep(BALL, over, "random", samples=500, keep="segments", output=path, workers=workers).close()
        files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file())
        found.append({str(file.relative_to(path)): file.read_bytes() for file in files})
    assert found[0] == found[1]


@pytest.mark.slow
@pytest.mark.parametrize("keep", ["summary", "segments"])
def test_the_disk_space_is_known_within_a_factor_of_1_3(
    keep: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 4096)
    sweep, saved = Sweep.of(BALL, OVER, "sobol", samples=2**14, keep=keep), list[int]()
    remove = Checkpoint.remove

    def measured(checkpoint: Checkpoint) -> None:
        saved.append(sum(path.stat().st_size for path in checkpoint.folder.glob("*.npz")))
        remove(checkpoint)

    monkeypatch.setattr(Checkpoint, "remove", measured)
    run_sweep(sweep, tmp_path / "s.nc", command="test").close()
    actual = (tmp_path / "s.nc").stat().st_size, max(saved)
    for expected, real in zip(disk_space(sweep), actual, strict=True):
        assert 1 / 1.3 < expected / real < 1.3


def test_a_second_process_is_told_of_the_first(tmp_path: Path) -> None:
    sweep = Sweep.of(BALL, OVER, "sobol", samples=4)
    first = Checkpoint(tmp_path / "s.nc", sweep, Blocks(sweep))
    with first.locked(resume=False, overwrite=False):
        for options in ({}, {"resume": True}, {"overwrite": True}):
            with pytest.raises(FileExistsError, match=r"s\.nc: another process is computing it$"):
                run_sweep(sweep, tmp_path / "s.nc", command="test", **options)


@pytest.mark.parametrize("lacking", ["status", "impactor_velocity", "segment_xi", "event_time"])
def test_a_file_that_lacks_a_variable_gets_one_sentence(
    lacking: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    swept = lacking in ("status", "impactor_velocity")
    whole = fd.sweep(BALL, {"impactor.velocity": ["1 m/s"]}) if swept else fd.to_dataset(fm.simulate(BALL))
    path = tmp_path / "part.nc"
    whole.drop_vars(lacking).to_netcdf(path)
    ds = fd.read(path)
    assert fd.validate(ds) == [f"variable {lacking} is missing"]
    calls = [ds.film.scene, ds.film.history] if swept else [ds.film.history, lambda: ds.film.sample([0.0])]
    if "segment" not in lacking:  # which a table does not hold
        calls.append(lambda: fd.to_frame(ds))
    for call in calls:
        with pytest.raises(ValueError, match=f"variable {lacking} missing: dropped or renamed"):
            call()
    for command in ("plot", "summarise") if swept else ("plot",):
        assert main([command, str(path)]) == 3
        said = capsys.readouterr().err
        assert f"variable {lacking} missing" in said and len(said.splitlines()) == 1
