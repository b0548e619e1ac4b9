"""Interrupted sweeps: a saved block is used only for its own rows, and each failure has its sentence."""

import shutil

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import Sweep, interruptions, runner
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


def test_a_link_as_output_is_refused(tmp_path):
    (tmp_path / "elsewhere.nc").write_bytes(b"")
    link = tmp_path / "out.nc"
    link.symlink_to(tmp_path / "elsewhere.nc")
    with pytest.raises(FileExistsError, match="is a link, which writing would replace"):
        fd.sweep(SCENE, OVER, output=link, overwrite=True)
    assert link.is_symlink()


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
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(interruptions.shutil, "disk_usage", lambda _: usage._replace(free=10))
    assert interruptions.reason_of(PermissionError(13, "Permission denied"), tmp_path / "out.nc") == "the disk is full"
    monkeypatch.setattr(interruptions.shutil, "disk_usage", lambda _: usage)
    assert interruptions.reason_of(PermissionError(13, "Permission denied"), tmp_path / "out.nc") == "Permission denied"
