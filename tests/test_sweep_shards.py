"""Shards of a sweep: computed in any order and more than once, they give the bytes of a single run."""

from __future__ import annotations

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sweep_cases import BALL, SCENES, SPEEDS, STRENGTHS, cli

import film_datasets as fd
from film_datasets.sweeps import Interrupted, Sweep, finish_shards, run_shard, run_sweep, shards
from film_datasets.sweeps.block_columns import compute_block

pytest.importorskip("zarr")

SWEEP = Sweep.of(BALL.replace({"contact.law": "hertz"}), SPEEDS)


@pytest.fixture(autouse=True)
def small_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of eight impacts, two in a file: SWEEP fills three files. One moment for all runs."""
    monkeypatch.setattr("film_datasets.sweeps.blocks.BLOCK_IMPACTS", 8)
    monkeypatch.setattr("film_datasets.sweeps.block_writers.FILE_BLOCKS", 2)
    monkeypatch.setattr("film_datasets.sweeps.shards.FILE_BLOCKS", 2)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")


def tree(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def finished(sweep: Sweep, target: Path, count: int) -> Path:
    for number in range(count, 0, -1):
        run_shard(sweep, target, f"{number}/{count}")
    finish_shards(sweep, target, command="test").close()
    return target


@pytest.mark.parametrize(
    ("over", "options"),
    [
        pytest.param(SPEEDS, {"keep": "samples=5"}, marks=pytest.mark.slow),
        pytest.param(
            {"impactor.mass": ["30 g", "60 g"], **SPEEDS}, {"derivatives": ["impactor.mass"]}, marks=pytest.mark.slow
        ),
        (STRENGTHS | {"contact.law": ["hertz", "stronge"]}, {"design": "sobol", "samples": 24}),
    ],
    ids=["samples", "grid", "sobol"],
)
def test_shards_give_the_bytes_of_a_single_run(
    tmp_path: Path, over: dict[str, object], options: dict[str, object]
) -> None:
    made = Sweep.of(BALL, over, **options)
    run_sweep(made, tmp_path / "whole.zarr", command="test").close()
    target = finished(made, tmp_path / "shards.zarr", 2)
    assert tree(target) == tree(tmp_path / "whole.zarr")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["shards.zarr", "whole.zarr"]
    with fd.open(target) as ds:
        assert fd.validate(ds) == []
        assert ds.attrs["content_sha256"] == fd.content_sha256(ds)


def test_missing_shards_are_named(tmp_path: Path) -> None:
    target = tmp_path / "out.zarr"
    with pytest.raises(FileNotFoundError, match="no shard of it has been computed"):
        finish_shards(SWEEP, target, command="test")
    assert run_shard(SWEEP, target, "2/3") == [1, 3]
    with pytest.raises(FileNotFoundError, match=r"shards 1, 3 of 3 are missing$"):
        finish_shards(SWEEP, target, command="test")
    assert not target.exists()


@pytest.mark.slow
def test_what_a_shard_wrote_is_checked(tmp_path: Path) -> None:
    target = tmp_path / "out.zarr"
    for number in (1, 2):
        run_shard(SWEEP, target, f"{number}/2")
    lost = tmp_path / ".out.zarr.shards/store/maximum_force/c/1"
    content = lost.read_bytes()
    lost.unlink()  # a Zarr folder reads as zeros where a file is missing
    with pytest.raises(OSError, match="shard 2 of 2 is not what was written: to be computed again"):
        finish_shards(SWEEP, target, command="test")
    assert run_shard(SWEEP, target, "2/2") == []
    assert lost.read_bytes() == content
    finish_shards(SWEEP, target, command="test").close()


@pytest.mark.slow
def test_an_interrupted_shard_continues_and_a_finished_one_is_not_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("film_datasets.sweeps.checkpoint.WORTH_SAVING", 0.0)
    target, computed = tmp_path / "out.zarr", list[int]()
    shard = {"shard": "2/2", "workers": 1}

    def counted(sweep: Sweep, block: object) -> object:
        computed.append(block.first)
        return compute_block(sweep, block)

    def stop(done: int, size: int) -> None:
        assert size == 24
        if done >= 16:
            raise KeyboardInterrupt

    monkeypatch.setattr("film_datasets.sweeps.computed_blocks.compute_block", counted)
    with pytest.raises(Interrupted, match=r"interrupted: run shard 2/2 again to continue$"):
        run_shard(SWEEP, target, **shard, progress=stop)
    assert run_shard(SWEEP, target, **shard) == [1]
    assert sorted(computed) == [16, 24, 32]
    assert run_shard(SWEEP, target, **shard) == [1]
    assert len(computed) == 3
    run_shard(SWEEP, target, "1/2")
    finish_shards(SWEEP, target, command="test").close()
    run_sweep(SWEEP, tmp_path / "whole.zarr", command="test").close()
    assert tree(target) == tree(tmp_path / "whole.zarr")


@pytest.mark.slow
def test_the_first_of_many_shards_makes_the_folder(tmp_path: Path) -> None:
    target = tmp_path / "out.zarr"
    with ThreadPoolExecutor(3) as pool:
        list(pool.map(lambda number: run_shard(SWEEP, target, f"{number}/3", workers=1), range(1, 4)))
    assert [path.name for path in tmp_path.iterdir()] == [".out.zarr.shards"]
    with finish_shards(SWEEP, target, command="test") as ds:
        assert fd.validate(ds) == []


@pytest.mark.slow
def test_one_process_at_a_time_computes_a_shard(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")

    def again(done: int, size: int) -> None:
        with pytest.raises(FileExistsError, match="another process"):
            run_shard(SWEEP, tmp_path / "out.zarr", "1/2")

    run_shard(SWEEP, tmp_path / "out.zarr", "1/2", progress=again)


def test_mistakes_have_their_sentences(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "out.zarr"
    for text in ("0/4", "5/4", "1", "1/0", "a/b"):
        with pytest.raises(ValueError, match=f'shard "{text}": K/N is needed, with K from 1 to N'):
            run_shard(SWEEP, target, text)
    with pytest.raises(ValueError, match="6 shards: this sweep fills 3 files"):
        run_shard(SWEEP, target, "1/6")
    with pytest.raises(ValueError, match="shards are written into a Zarr folder"):
        run_shard(SWEEP, tmp_path / "out.nc", "1/2")
    with pytest.raises(ValueError, match="segments: their places depend on all impacts before"):
        run_shard(Sweep.of(BALL, SPEEDS, keep="segments"), target, "1/2")
    assert list(tmp_path.iterdir()) == []
    run_shard(SWEEP, target, "1/2")
    with pytest.raises(FileExistsError, match="is computed in 2 shards, not 3"):
        run_shard(SWEEP, target, "1/3")
    with pytest.raises(FileExistsError, match="there are shards of another sweep or scene; remove "):
        finish_shards(Sweep.of(BALL, SPEEDS), target, command="test")
    monkeypatch.setattr(shards, "PROGRAM", "film-model 99.0")
    with pytest.raises(FileExistsError, match=r"were begun by film-model .*, this is film-model 99\.0; remove "):
        run_shard(SWEEP, target, "2/2")
    monkeypatch.undo()
    monkeypatch.setattr(shards, "FILE_BLOCKS", 1)
    run_sweep(SWEEP, target, command="test").close()
    with pytest.raises(FileExistsError, match="exists; remove it to compute its shards again"):
        run_shard(SWEEP, target, "1/2")


PLAN = f"""scene = "{SCENES.as_posix()}/tungsten_carbide_on_steel.toml"
design = "sobol"
samples = 1000
[over]
"impactor.velocity" = {{ from = "0.1 m/s", to = "5 m/s" }}
"""


@pytest.mark.slow
def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan, target = tmp_path / "plan.toml", tmp_path / "out.zarr"
    plan.write_text(PLAN.replace("1000", "32"), encoding="utf-8")
    command = ("sweep", plan, "--output", target)
    assert cli(capsys, *command, "--shard", "2/2")[:2] == (0, "shard 2/2 is finished; 1 missing\n")
    assert cli(capsys, *command, "--finish")[2] == f"{target}: shard 1 of 2 is missing\n"
    assert json.loads(cli(capsys, *command, "--shard", "1/2", "--json")[1])["missing"] == []
    status, out, _ = cli(capsys, *command, "--finish")
    assert status == 0 and "32 impacts: 32 separated" in out
    assert cli(capsys, *command, "--shard", "1/2", "--force")[::2] == (
        3,
        "--force: a shard replaces nothing; use it with --finish\n",
    )
    assert "exists; use --force to replace it" in cli(capsys, *command, "--finish")[2]


@pytest.mark.slow
def test_shards_of_many_processes_that_are_killed(tmp_path: Path) -> None:
    plan, target = tmp_path / "plan.toml", tmp_path / "out.zarr"
    plan.write_text(PLAN.replace("1000", "400"), encoding="utf-8")
    code = (
        "import sys, film_datasets.sweeps.blocks as b\n"
        "from film_datasets.sweeps import block_writers, shards\n"
        "b.BLOCK_IMPACTS, block_writers.FILE_BLOCKS, shards.FILE_BLOCKS = 50, 2, 2\n"
        "from film_model.cli.main import main\nsys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "sweep", str(plan), "--output"]
    for kill in (True, False):
        runs = [subprocess.Popen([*command, str(target), "--shard", f"{k}/4"]) for k in range(1, 5)]
        for number, run in enumerate(runs):
            if kill:
                try:
                    run.wait(timeout=0.7 * (number + 1))
                except subprocess.TimeoutExpired:
                    run.kill()
        assert kill or [run.wait() for run in runs] == [0] * 4
        [run.wait() for run in runs]
    subprocess.run([*command, str(target), "--finish"], check=True)
    subprocess.run([*command, str(tmp_path / "whole.zarr")], check=True)
    one, other = tree(target), tree(tmp_path / "whole.zarr")
    attributes = [json.loads(files.pop("zarr.json"))["attributes"] for files in (one, other)]
    assert one == other
    seals = {each.pop("metadata_sha256") for each in attributes}  # of the commands too
    assert len(seals) == 2 and fd.open(target).sizes == fd.open(tmp_path / "whole.zarr").sizes
    assert attributes[0].pop("history").replace(str(target), "") == attributes[1].pop("history").replace(
        str(tmp_path / "whole.zarr"), ""
    )
    assert attributes[0] == attributes[1]
