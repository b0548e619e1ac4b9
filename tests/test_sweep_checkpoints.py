"""Interrupted sweeps: a saved block is used only for its own rows, and each failure has its sentence."""

import shutil
import sys
import threading
import time

import numpy as np
import pytest
import xarray as xr
from sweep_cases import bytes_of

import film_datasets as fd
import film_model as fm
from film_datasets import files
from film_datasets.sweeps import Sweep, runner
from film_datasets.sweeps.block_columns import compute_block
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.checkpoint import Checkpoint

SCENE = fm.Scene(fm.Sphere("10 mm", velocity="0.25 m/s", material="mild steel"), fm.HalfSpace("mild steel"))
OVER = {"impactor.velocity": {"from": "0.1 m/s", "to": "1 m/s", "count": 40}}


@pytest.fixture
def interrupted(tmp_path, monkeypatch):
    """The checkpoint of a sweep in four blocks, of which all are saved; and the sweep's output."""
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 10)
    sweep = Sweep.of(SCENE.replace({"contact.law": "hertz"}), OVER)
    blocks, target = Blocks(sweep), tmp_path / "out.nc"
    checkpoint = Checkpoint(target, sweep, blocks)
    with checkpoint.locked(resume=False, overwrite=False):
        for number in range(len(blocks)):
            checkpoint.save(number, compute_block(sweep, blocks[number]))
    return checkpoint, sweep, target


def test_a_block_copied_over_another_is_computed_again(interrupted):
    checkpoint, sweep, target = interrupted
    shutil.copy(checkpoint.folder / "0.npz", checkpoint.folder / "2.npz")
    assert checkpoint.load(0) is not None and checkpoint.load(2) is None
    with runner.run_sweep(sweep, target, command="test", resume=True) as ds:
        assert fd.validate(ds) == []
        speeds, force = ds["impactor_velocity"].values, ds["maximum_force"].values
    assert force[25] == pytest.approx(force[0] * (speeds[25] / speeds[0]) ** 1.2, rel=1e-3)


def test_a_block_of_another_shape_is_computed_again(interrupted):
    checkpoint, _, _ = interrupted
    columns = checkpoint.load(1)
    checkpoint.save(1, {name: column[:5] for name, column in columns.items()})
    assert checkpoint.load(1) is None
    checkpoint.save(1, {name: column for name, column in columns.items() if name != "maximum_force"})
    assert checkpoint.load(1) is None
    checkpoint.save(1, columns)
    assert np.array_equal(checkpoint.load(1)["maximum_force"], columns["maximum_force"])


@pytest.mark.slow
def test_blocks_in_whole_files_are_not_saved_and_a_damaged_file_is_written_again(tmp_path, monkeypatch):
    """A Zarr folder that was interrupted keeps its whole files; what comes after them is in saved blocks."""
    pytest.importorskip("zarr")
    monkeypatch.setattr("film_datasets.sweeps.checkpoint.WORTH_SAVING", 0.0)
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 1)
    sweep, target = Sweep.of(SCENE, OVER, variables=["maximum_force"]), tmp_path / "out.zarr"
    computed = []

    def counted(sweep, block):
        computed.append(block.first)
        return compute_block(sweep, block)

    def stop(done, size):
        if done == 36:
            raise KeyboardInterrupt

    monkeypatch.setattr("film_datasets.sweeps.computed_blocks.compute_block", counted)
    with pytest.raises(KeyboardInterrupt, match="blocks in"):
        runner.run_sweep(sweep, target, command="test", workers=1, progress=stop)
    checkpoint = Checkpoint(target, sweep, Blocks(sweep))
    assert checkpoint.written().blocks == 32 and checkpoint.finished() >= set(range(36))
    assert min(int(path.stem) for path in checkpoint.folder.glob("*.npz")) == 32
    before, folder = tmp_path / "before", tmp_path / ".out.zarr.part"
    shutil.copytree(tmp_path, before)
    whole = fd.sweep(SCENE, OVER, variables=["maximum_force"])
    for damaged in (False, True):
        for name in (folder.name, checkpoint.folder.name):
            shutil.copytree(before / name, tmp_path / name, dirs_exist_ok=True)
        if damaged:
            file = folder / "maximum_force" / "c" / "2"
            file.write_bytes(file.read_bytes()[:-40] + bytes(40))
        computed.clear()
        with runner.run_sweep(sweep, target, command="test", resume=True) as ds:
            assert fd.validate(ds) == [] and ds.attrs["content_sha256"] == whole.attrs["content_sha256"]
        assert (0 in computed) is damaged and 39 in computed
        assert sorted(path.name for path in tmp_path.iterdir()) == ["before", "out.zarr"]
        shutil.rmtree(target)


def test_the_cost_of_a_block_is_that_of_all_its_threads(tmp_path, monkeypatch):
    """Blocks whose own threads compute, as those of impacts on vibrations do, are worth saving."""
    costs, block = [], compute_block

    def with_threads(sweep, of):
        def burn():
            while time.thread_time() < 0.02:
                pass

        thread = threading.Thread(target=burn)
        thread.start()
        thread.join()
        return block(sweep, of)

    monkeypatch.setattr("film_datasets.sweeps.computed_blocks.compute_block", with_threads)
    monkeypatch.setattr(Checkpoint, "save", lambda *given: costs.append(given[-1]))
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 10)
    fd.sweep(SCENE, OVER, output=tmp_path / "out.nc", workers=1).close()
    assert len(costs) == 4 and min(costs) >= 0.02


def test_a_link_as_output_is_refused(tmp_path):
    (tmp_path / "elsewhere.nc").write_bytes(b"")
    link = tmp_path / "out.nc"
    link.symlink_to(tmp_path / "elsewhere.nc")
    with pytest.raises(FileExistsError, match="is a link, which writing would replace"):
        fd.sweep(SCENE, OVER, output=link, overwrite=True)
    assert link.is_symlink()


@pytest.mark.slow
def test_a_finished_output_of_another_version_is_named(tmp_path, monkeypatch):
    target = tmp_path / "out.nc"
    with fd.sweep(SCENE, OVER, output=target):
        pass
    with fd.sweep(SCENE, OVER, output=target, resume=True) as ds:
        assert ds.sizes["impactor_velocity"] == 40
    monkeypatch.setattr(runner, "__version__", "99.0")
    with pytest.raises(FileExistsError, match=r"was made by film-model .*, this is 99\.0"):
        fd.sweep(SCENE, OVER, output=target, resume=True)


def test_a_full_disk_is_called_that(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")  # by the netCDF library, of a full disk

    ds, usage = fd.sweep(SCENE, OVER), shutil.disk_usage(tmp_path)
    monkeypatch.setattr(xr.Dataset, "to_netcdf", refuse)
    for free, says in ((10, "the disk is full"), (usage.free, "Permission denied")):
        monkeypatch.setattr(files.shutil, "disk_usage", lambda _, free=free: usage._replace(free=free))
        with pytest.raises(OSError, match=rf"out\.nc: cannot be written: {says}$"):
            fd.write(ds, tmp_path / "out.nc")


@pytest.mark.parametrize("name", ["out.nc", "out.zarr", "out.csv"])
def test_a_folder_that_cannot_be_written_to_is_refused_before_the_computation(tmp_path, monkeypatch, name):
    monkeypatch.setattr("film_datasets.sweeps.computed_blocks.compute_block", None)
    monkeypatch.setattr(files.os, "access", lambda *_: False)
    with pytest.raises(PermissionError, match=rf"{name}: the folder .* cannot be written to$"):
        fd.sweep(SCENE, OVER, output=tmp_path / name)


def test_a_run_that_was_killed_before_it_saved_anything_is_started_again(tmp_path):
    (tmp_path / ".out.nc.blocks").mkdir()
    (tmp_path / ".out.nc.blocks" / "lock").touch()
    with fd.sweep(SCENE, OVER, output=tmp_path / "out.nc") as ds:
        assert ds.sizes["impactor_velocity"] == 40


def test_a_sweep_that_is_interrupted_in_its_first_block_keeps_nothing_and_says_so(tmp_path, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("film_datasets.sweeps.computed_blocks.compute_block", stop)
    with pytest.raises(KeyboardInterrupt, match=r"^interrupted: nothing to resume: no block was finished"):
        fd.sweep(SCENE, OVER, output=tmp_path / "out.nc", workers=1)
    assert list(tmp_path.iterdir()) == []


# ------------------------------------------------------------------------------------------------ at every moment


class Interruption:
    """Raises KeyboardInterrupt at line `at` of film_datasets that the main thread runs: between bytecodes, where Python
    does so for the keyboard."""

    def __init__(self, at):
        self.at, self.lines = at, 0

    def __call__(self, frame, event, _):
        if "film_datasets" not in frame.f_code.co_filename:
            return None
        self.lines += event == "line"
        if event == "line" and self.lines == self.at:
            raise KeyboardInterrupt
        return self

    def during(self, *arguments, **options):
        """Run a sweep; whether it was interrupted."""
        before = sys.gettrace()
        sys.settrace(self)
        try:
            runner.run_sweep(*arguments, **options).close()
        except KeyboardInterrupt:
            return True
        finally:
            sys.settrace(before)
        return False


def interrupt_and_resume(tmp_path, monkeypatch, suffix, workers, moments):
    """Interrupt a sweep of 12 blocks at some fractions of its lines; each is resumed, from its saved blocks, and ends
    with the same bytes. The numbers of blocks that were saved."""
    if suffix == "zarr":
        pytest.importorskip("zarr")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    monkeypatch.setattr("film_datasets.sweeps.checkpoint.WORTH_SAVING", 0.0)
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 1)
    computed, saved = [], []

    def counted(sweep, block):
        computed.append(block.first)
        return compute_block(sweep, block)

    monkeypatch.setattr("film_datasets.sweeps.computed_blocks.compute_block", counted)
    over = {"impactor.velocity": {"from": "0.1 m/s", "to": "1 m/s", "count": 12}}
    sweep = Sweep.of(SCENE.replace({"contact.law": "hertz"}), over, variables=["maximum_force", "contact_duration"])
    given, whole, counter = {"command": "test", "workers": workers}, tmp_path / f"whole.{suffix}", Interruption(0)
    assert not counter.during(sweep, whole, **given)
    for moment in moments:
        folder = tmp_path / f"{moment}"
        folder.mkdir()
        output = folder / whole.name
        Interruption(1 + int(moment * counter.lines)).during(sweep, output, **given)  # lines of threads vary a little
        whole_already = output.exists()
        kept = set(range(12)) if whole_already else Checkpoint(output, sweep, Blocks(sweep)).finished()
        saved.append(len(kept))
        computed.clear()
        runner.run_sweep(sweep, output, **given, resume=bool(kept)).close()
        assert set(computed) == set(range(12)) - kept, moment
        assert bytes_of(output) == bytes_of(whole), moment
        assert list(folder.iterdir()) == [output], moment
    return saved


@pytest.mark.slow
def test_interrupted_while_the_output_is_created_and_resumed(tmp_path, monkeypatch):
    saved = interrupt_and_resume(tmp_path, monkeypatch, "nc", 2, (0.05, 0.2, 0.4, 0.6))
    assert saved[0] == 0 and saved[-1] > 0


@pytest.mark.slow
@pytest.mark.parametrize(("suffix", "workers"), [("nc", 1), ("nc", 2), ("zarr", 1), ("zarr", 2)])
def test_interrupted_at_any_moment_and_resumed(tmp_path, monkeypatch, suffix, workers):
    interrupt_and_resume(tmp_path, monkeypatch, suffix, workers, np.linspace(0.0, 0.9999, 20))
