"""Sweeps: workers, interruption and progress."""

from __future__ import annotations

import io
import os
import platform
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from sweep_cases import BALL, FILE, PLATE, SCENES, SPEEDS, STRENGTHS, bytes_of, same

import film_datasets as fd
import film_model as fm
from film_datasets.sweeps import Interrupted, ProgressBar, Sweep, run_sweep
from film_datasets.sweeps.block_columns import Columns, compute_block
from film_datasets.sweeps.blocks import Block
from film_model.base.foreign import Dataset
from film_model.core import modal

SMALL_BLOCKS = ("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 7)
SAVE_ALL = ("film_datasets.sweeps.checkpoint.WORTH_SAVING", 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("design", ["grid", "sobol"])
def test_any_number_of_workers_gives_the_same_data(
    monkeypatch: pytest.MonkeyPatch, design: str, tmp_path: Path
) -> None:
    monkeypatch.setattr(*SMALL_BLOCKS)
    over = {**SPEEDS, "impactor.mass": ["30 g", "60 g"]} if design == "grid" else {**STRENGTHS}
    options = {} if design == "grid" else {"design": design, "samples": 80}
    found = [fd.sweep(BALL, over, workers=n, keep="segments", **options) for n in (1, 2, 5)]
    for ds in found[1:]:
        same(ds, found[0])
    with fd.sweep(BALL, over, keep="segments", output=tmp_path / "x.nc", **options) as ds:
        same(ds, found[0])


def test_a_vibrating_target_takes_the_threads_of_the_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Impacts that share a structure are one block: it takes as many threads as there are workers, and none but the
    caller's with one."""
    used, batch = set[int](), modal.batch

    def noted(*given: Any) -> Any:
        used.add(threading.get_ident())
        return batch(*given)

    monkeypatch.setattr(modal, "batch", noted)
    vibrating = PLATE.replace({"effects.boundary_reflections": True, "effects.target_inertia": True})
    over, found = {"impactor.velocity": {"from": "0.5 m/s", "to": "0.6 m/s", "count": 64}}, list[Dataset]()
    for workers in (1, 3):
        used.clear()
        found.append(fd.sweep(vibrating, over, workers=workers))
        assert used and (used == {threading.get_ident()}) == (workers == 1)
    same(*found)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", "zarr"])
def test_any_number_of_workers_writes_the_same_bytes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, suffix: str
) -> None:
    """Chunks are packed in any order, and written in one. Only the times in the attributes differ."""
    monkeypatch.setattr(*SMALL_BLOCKS)
    monkeypatch.setattr("film_datasets.provenance.moment", lambda: "2026-01-01T00:00:00Z")
    over, options = {**STRENGTHS}, {"design": "sobol", "samples": 100, "keep": "segments"}
    found: list[dict[str, bytes]] = []
    for workers in (1, 3):
        path = tmp_path / f"{workers}" / f"x.{suffix}"
        path.parent.mkdir()
        fd.sweep(BALL, over, workers=workers, output=path, **options).close()
        files = [path] if suffix == "nc" else [file for file in path.rglob("*") if file.is_file()]
        found.append({str(file.relative_to(path.parent)): file.read_bytes() for file in files})
    assert found[0] == found[1]


FAULTS = """
import resource, sys
import film_datasets as fd
def faults(count):
    over = {"impactor.velocity": {"from": "0.1 m/s", "to": "5 m/s", "count": count}}
    begin = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    fd.sweep(sys.argv[1], over, variables=["maximum_force"], workers=1)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - begin
faults(70_000)
print(faults(int(sys.argv[2])))
"""


@pytest.mark.slow
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="how memory is released is glibc's matter")
@pytest.mark.parametrize("hardens", [False, True])
def test_blocks_reuse_the_memory_of_those_before(tmp_path: Path, hardens: bool) -> None:
    """Eleven blocks of up to 65,536 impacts touch 3500 new pages, 1400 of them for the result; 56,000 if each block
    gives its memory back to the system. Five blocks with the strength at each strain rate: 4500, or 200,000."""
    made = fm.Scene.from_toml(SCENES / "tungsten_carbide_on_steel.toml")
    if hardens:
        made = made.replace({"contact.law": "auto", "target.material.strain_rate_coefficient": 0.02})
    scene = tmp_path / "scene.toml"
    scene.write_text(made.to_toml(), encoding="utf-8")
    command = [sys.executable, "-c", FAULTS, str(scene), "300000" if hardens else "700000"]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    assert int(found.stdout) < 15_000


class _StopAfter:
    def __init__(self, rows: int, error: type[BaseException]) -> None:
        self.rows, self.error = rows, error

    def __call__(self, done: int, size: int) -> None:
        if done >= self.rows:
            raise self.error


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", "zarr"])
def test_an_interrupted_sweep_is_resumed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, suffix: str) -> None:
    monkeypatch.setattr(*SMALL_BLOCKS)
    monkeypatch.setattr(*SAVE_ALL)
    made, path = Sweep.of(BALL, SPEEDS), tmp_path / f"out.{suffix}"
    with pytest.raises(Interrupted, match=r"interrupted: \d+ of 6 blocks in .*use resume=True to continue$"):
        run_sweep(made, path, command="test", workers=1, progress=_StopAfter(20, KeyboardInterrupt))
    blocks = tmp_path / f".out.{suffix}.blocks"
    assert [p.name for p in tmp_path.iterdir()] == [blocks.name]
    kept = sorted(blocks.glob("*.npz"))
    assert len(kept) >= 3
    with pytest.raises(FileExistsError, match="an interrupted run left"):
        run_sweep(made, path, command="test")
    with pytest.raises(FileExistsError, match="of another sweep"):
        run_sweep(Sweep.of(PLATE, SPEEDS), path, command="test", resume=True)
    kept[0].write_bytes(kept[0].read_bytes()[:-100])  # a damaged block is computed again
    computed: list[int] = []

    def counted(sweep: Sweep, block: Block) -> Columns:
        computed.append(block.first)
        return compute_block(sweep, block)

    monkeypatch.setattr("film_datasets.sweeps.computed_blocks.compute_block", counted)
    with run_sweep(made, path, command="test", resume=True) as ds:
        same(ds, run_sweep(made, command="test"))
    assert len(computed) == 6 + (6 - len(kept)) + 1
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
    computed.clear()
    run_sweep(made, path, command="test", resume=True).close()  # the output is complete
    assert computed == []
    with pytest.raises(FileExistsError, match="exists"):
        run_sweep(made, path, command="test")


def test_one_process_at_a_time_writes_an_output(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    monkeypatch.setattr(*SMALL_BLOCKS)
    made, path = Sweep.of(BALL, SPEEDS), tmp_path / "out.nc"

    def again(done: int, size: int) -> None:
        with pytest.raises(FileExistsError, match="another process"):
            run_sweep(made, path, command="test", resume=True)

    run_sweep(made, path, command="test", progress=again).close()


SCRIPT = """
import sys, signal, resource, film_model as fm, film_datasets as fd
from film_datasets.sweeps import blocks, checkpoint
blocks.BLOCK_IMPACTS, checkpoint.WORTH_SAVING = 2000, 0.0
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
limit = int(sys.argv[3])
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
scene = fm.Scene.from_toml(sys.argv[1])
over = {"impactor.velocity": {"uniform": ["0.1 m/s", "5 m/s"]}, "impactor.mass": {"normal": ["60 g", "5 g"]}}
try:
    workers = int(sys.argv[5]) or None
    fd.sweep(scene, over, "sobol", samples=int(sys.argv[4]), output=sys.argv[2], resume=True, workers=workers)
except OSError as error:
    sys.exit(str(error))
"""


def script(output: Path, limit: int = 0, samples: int = 60_000, workers: int = 0) -> list[str]:
    scene = SCENES / "tungsten_carbide_on_steel.toml"
    return [sys.executable, "-c", SCRIPT, str(scene), str(output), *map(str, (limit, samples, workers))]


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGXFSZ"), reason="needs a limit on the size of files")
@pytest.mark.parametrize("limit", [50_000, 1_000_000])
def test_a_full_disk_gives_one_message_and_loses_no_block(tmp_path: Path, limit: int) -> None:
    """A small limit on the file size fails the blocks, a larger one the output."""
    path = tmp_path / "out.nc"
    stopped = subprocess.run(script(path, limit), capture_output=True, text=True, check=False)
    assert stopped.returncode == 1
    assert "out.nc: cannot be written: " in stopped.stderr
    assert len(stopped.stderr.strip().splitlines()) == 1
    blocks = list((tmp_path / ".out.nc.blocks").glob("*.npz"))
    assert not path.exists() and not (tmp_path / ".out.nc.part").exists()
    assert bool(blocks) == (limit > 100_000)
    subprocess.run(script(path), check=True)
    assert fd.validate(fd.read(path)) == []


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["nc", "zarr"])
def test_killed_at_any_moment_and_resumed(tmp_path: Path, suffix: str) -> None:
    begin = time.monotonic()
    subprocess.run(script(tmp_path / f"whole.{suffix}", samples=200_000), check=True)
    duration = time.monotonic() - begin
    whole = fd.read(tmp_path / f"whole.{suffix}")
    rng = random.Random(4)
    for number in range(4):
        path = tmp_path / f"out{number}.{suffix}"
        process = subprocess.Popen(script(path, samples=200_000))
        time.sleep(rng.uniform(0.3, 1.0) * duration)
        process.kill()
        process.wait()
        subprocess.run(script(path, samples=200_000), check=True)
        same(fd.read(path), whole)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(
        [f"whole.{suffix}", *(f"out{number}.{suffix}" for number in range(4))]
    )


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("suffix", ["nc", "zarr"])
def test_stopped_right_after_the_start_and_resumed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, suffix: str, workers: int
) -> None:
    """While the output is created, the workers save blocks: resumed, the sweep has the same bytes."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    given = {"samples": 30_000, "workers": workers}
    subprocess.run(script(tmp_path / f"whole.{suffix}", **given), check=True)
    rng = random.Random(workers)
    for number, sign in enumerate((signal.SIGINT, signal.SIGKILL)):
        path, folder = tmp_path / f"out.{suffix}", tmp_path / f".out.{suffix}.blocks"
        process = subprocess.Popen(
            script(path, **given), stderr=subprocess.DEVNULL,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )  # fmt: skip
        while process.poll() is None and not folder.exists():
            time.sleep(0.001)
        time.sleep(rng.uniform(0.0, 0.1))
        process.send_signal(sign)
        process.wait()
        subprocess.run(script(path, **given), check=True)
        assert bytes_of(path) == bytes_of(tmp_path / f"whole.{suffix}"), (number, sign)
        assert sorted(p.name for p in tmp_path.iterdir()) == [f"out.{suffix}", f"whole.{suffix}"]
        shutil.rmtree(path) if path.is_dir() else path.unlink()


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_data(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(*SMALL_BLOCKS)
    options = {"design": "sobol", "samples": 60, "keep": "segments"}
    whole = fd.sweep(BALL, STRENGTHS, **options)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        same(fd.sweep(BALL, STRENGTHS, scheduler=client, **options), whole)
        with fd.sweep(BALL, STRENGTHS, scheduler=cluster.scheduler_address, output=tmp_path / "x.nc", **options) as ds:
            same(ds, whole)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_an_interrupt_from_the_keyboard(tmp_path: Path) -> None:
    file, output = tmp_path / "sweep.toml", tmp_path / "out.nc"
    file.write_text(FILE.replace("count = 30", "count = 1000000"), encoding="utf-8")
    code = (
        "import sys; from film_datasets.sweeps import checkpoint; checkpoint.WORTH_SAVING = 0.0\n"
        "from film_model.cli.main import main; sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "sweep", str(file), "--output", str(output)]
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    )  # fmt: skip  # the tests themselves may run where the keyboard is ignored
    while process.poll() is None and not list(tmp_path.glob(".out.nc.blocks/*.npz")):
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert len(err.splitlines()) == 1
    assert "blocks in" in err and err.endswith("use --resume to continue\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == [".out.nc.blocks", "sweep.toml"]


def test_progress_is_shown() -> None:
    stream = io.StringIO()
    bar = ProgressBar(stream)
    bar(500, 1000)
    assert stream.getvalue() == ""  # not a terminal: no output for the first ten seconds
    bar(1000, 1000)
    assert stream.getvalue().startswith("1000 of 1000 impacts, 100 %, ")

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    stream = Terminal()
    bar = ProgressBar(stream)
    bar(500, 1000)
    assert "[##########..........] 500 of 1000 impacts, 50 %" in stream.getvalue()
    assert " s left" in stream.getvalue()
