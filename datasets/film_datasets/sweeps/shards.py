"""Shards of a sweep: runs of their own, anywhere, that write whole files of one Zarr folder; no scheduler is needed."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from film_datasets.files import ZARR, check_place, open_dataset, put_in_place
from film_datasets.provenance import PROGRAM
from film_datasets.schema import ContentHash, Variable
from film_datasets.schema.content_hash import pieces
from film_datasets.sweeps.attributes import Totals, global_attributes
from film_datasets.sweeps.block_writers import FILE_BLOCKS, ZarrWriter
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.checkpoint import Checkpoint, fingerprint, lock_file
from film_datasets.sweeps.computed_blocks import Run, computed_blocks
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.disk_space import check_free_space
from film_datasets.sweeps.executor import workers_of
from film_datasets.sweeps.progress import Progress, explained
from film_datasets.sweeps.storage import Storage
from film_model.base.files import written_whole
from film_model.base.foreign import Dataset
from film_model.base.threads import available_cores

_SHARD = re.compile(r"(\d{1,9})/(\d{1,9})")


class Shards:
    """The shards of a sweep, in a hidden folder beside the output until all are there.

    The folder has `sweep.json`, which says whose shards these are; `store`, a Zarr folder with all variables; and for
    each finished shard a file `3.json` with its totals and the hash of what it wrote.
    """

    def __init__(self, target: Path, sweep: Sweep) -> None:
        if target.suffix != ZARR:
            raise ValueError(f"{target}: shards are written into a Zarr folder, FILE{ZARR}")
        if sweep.keep == "segments":
            raise ValueError("segments: their places depend on all impacts before; shards keep summary or samples")
        self.target, self.sweep, self.blocks = target, sweep, Blocks(sweep)
        self.folder = target.absolute().with_name(f".{target.name}.shards")
        self.store = self.folder / "store"

    def files_of(self, number: int, count: int) -> Sequence[range]:
        """The blocks of the files of shard `number` of `count`: as many files as of the others, or one more."""
        files = self.blocks.groups(FILE_BLOCKS)
        if count > len(files):
            raise ValueError(
                f"{count} shards: this sweep fills {len(files)} files, each by one shard: give at most that"
            )
        return files[(number - 1) * len(files) // count : number * len(files) // count]

    def begin(self, count: int) -> None:
        """Make the folder, unless another shard has; of several that try, one succeeds."""
        if not self.folder.exists():
            made = self.folder.with_name(f"{self.folder.name}.{os.urandom(4).hex()}")
            made.mkdir()
            try:
                with workers_of(1, None) as pool:
                    Storage(self.sweep, self.blocks, ZarrWriter(made / self.store.name), pool).create()
                known = {"program": PROGRAM, "sweep": fingerprint(self.sweep, self.blocks), "shards": count}
                (made / "sweep.json").write_text(json.dumps(known), encoding="utf-8")
                made.rename(self.folder)
            except OSError:
                if not self.folder.exists():
                    raise
            finally:
                shutil.rmtree(made, ignore_errors=True)
        if (found := self.count()) != count:
            raise FileExistsError(f"{self.target}: is computed in {found} shards, not {count}")

    def count(self) -> int:
        """The number of shards. Raises FileExistsError if they are those of another sweep."""
        known = json.loads((self.folder / "sweep.json").read_text(encoding="utf-8"))
        remedy = f"remove {self.folder} to start again"
        if known["program"] != PROGRAM:
            raise FileExistsError(
                f"{self.target}: its shards were begun by {known['program']}, this is {PROGRAM}; {remedy}"
            )
        if known["sweep"] != fingerprint(self.sweep, self.blocks):
            raise FileExistsError(f"{self.target}: there are shards of another sweep or scene; {remedy}")
        return known["shards"]

    def marker(self, number: int) -> Path:
        """The file that says that a shard is finished."""
        return self.folder / f"{number}.json"

    def missing(self) -> list[int]:
        """The shards that are not finished."""
        return [number for number in range(1, self.count() + 1) if not self.marker(number).exists()]

    def compute(self, number: int, count: int, workers: int | None, scheduler: Any, progress: Progress | None) -> None:
        """Compute a shard and write it into the store."""
        files, totals = self.files_of(number, count), Totals.of(self.sweep)
        numbers = range(files[0].start, files[-1].stop)
        run = Run(self.sweep, self.blocks, "", None)
        checkpoint = Checkpoint(self.folder / f"shard-{number}", self.sweep, self.blocks)
        size = sum(self.blocks[block].count for block in numbers)
        done = 0
        with (
            checkpoint.locked(resume=True, overwrite=False),
            explained(self.target, lambda: f"run shard {number}/{count} again to continue"),
            workers_of(workers, scheduler) as pool,
            Storage(self.sweep, self.blocks, ZarrWriter(self.store, existing=True), pool) as storage,
        ):
            for block, columns in computed_blocks(run, pool, checkpoint, numbers):
                storage.put(block, columns)
                totals.add(columns)
                done += block.count
                if progress is not None:
                    progress(done, size)
        with written_whole(self.marker(number)) as beside:
            content = {"content_sha256": storage.content.hexdigest(), "totals": totals.to_plain()}
            beside.write_text(json.dumps(content), encoding="utf-8")
        checkpoint.remove()

    def finish(self, command: str) -> None:
        """Check what the shards wrote, add the attributes, and rename the folder."""
        if missing := self.missing():
            raise FileNotFoundError(f"{self.target}: {_named(missing, self.count())} missing")
        totals, written = Totals.of(self.sweep), list[str]()
        for number in range(1, self.count() + 1):
            found = json.loads(self.marker(number).read_text(encoding="utf-8"))
            totals.merge(Totals.from_plain(found["totals"]))
            written.append(found["content_sha256"])
        content, parts = self._read()
        damaged = [k for k, (one, other) in enumerate(zip(parts, written, strict=True), 1) if one.hexdigest() != other]
        for number in damaged:
            self.marker(number).unlink()
        if damaged:
            named = _named(damaged, self.count())
            raise OSError(f"{self.target}: {named} not what was written: to be computed again")
        attributes = global_attributes(self.sweep, command, totals)
        ZarrWriter(self.store, existing=True).close({**attributes, "content_sha256": content.hexdigest()})
        put_in_place(self.store, self.target)
        shutil.rmtree(self.folder, ignore_errors=True)

    def _read(self) -> tuple[ContentHash, list[ContentHash]]:
        """The hash of the store's content, and of what each shard wrote of it."""
        import xarray as xr

        sweep, count = self.sweep, self.count()
        content, parts = ContentHash(sweep.variables), [ContentHash(sweep.variables) for _ in range(count)]

        def read(variable: Variable) -> None:
            array, name = stored[variable.name], variable.name
            if variable not in sweep.row_variables:
                for piece in pieces(array):
                    content.update(name, piece)
                return
            for number, part in enumerate(parts, 1):
                for group in self.files_of(number, count):
                    values = array[self.blocks.region(group)].values
                    content.update(name, values)
                    part.update(name, values)

        with (
            xr.open_dataset(self.store, engine="zarr", consolidated=False, create_default_indexes=False) as stored,
            ThreadPoolExecutor(available_cores()) as pool,
        ):
            list(pool.map(read, sweep.variables))
        return content, parts


def run_shard(
    sweep: Sweep,
    output: str | os.PathLike[str],
    shard: str,
    *,
    workers: int | None = None,
    scheduler: Any = None,
    progress: Progress | None = None,
) -> list[int]:
    """Compute one part of a sweep, such as "3/64", for the Zarr folder `output`; the shards that are not finished.

    Shards are computed in any order, at the same time, on any machines that share the output's folder and have the same
    version; one that is interrupted continues when it is run again, one that is finished is not computed again.

    Raises ValueError for a shard that the sweep does not have, for other outputs and for segments; FileExistsError if
    the output, shards of another sweep or another number of shards exist, or if another process computes this shard;
    Interrupted, or OSError if the shard cannot be written.
    """
    match = _SHARD.fullmatch(shard)
    number, count = (int(match[1]), int(match[2])) if match else (0, 0)
    if not 1 <= number <= count:
        raise ValueError(f'shard "{shard}": K/N is needed, with K from 1 to N')
    shards = Shards(Path(output), sweep)
    if shards.target.exists():
        raise FileExistsError(f"{shards.target}: exists; remove it to compute its shards again")
    check_place(shards.target, overwrite=False)
    shards.files_of(number, count)
    check_free_space(shards.target, sweep, shards.blocks, count)
    try:
        shards.begin(count)
    except PermissionError as error:
        raise PermissionError(f"{shards.target}: cannot be written: {error.strerror}") from error
    if not shards.marker(number).exists():
        shards.compute(number, count, workers, scheduler, progress)
    return shards.missing()


def finish_shards(sweep: Sweep, output: str | os.PathLike[str], *, command: str, overwrite: bool = False) -> Dataset:
    """Check that all shards of a sweep are there and as they were written, and put the Zarr folder in its place: with
    the same bytes as a single run's. command: for the attribute `history`.

    Raises FileNotFoundError that names the missing shards; OSError for damaged ones, which are computed again by
    `run_shard`; and what `run_shard` raises.
    """
    shards = Shards(Path(output), sweep)
    check_place(shards.target, overwrite)
    if not shards.folder.exists():
        raise FileNotFoundError(f"{shards.target}: no shard of it has been computed")
    with open(shards.folder / "lock", "w") as lock:
        lock_file(lock, shards.target)
        shards.finish(command)
    return open_dataset(shards.target)


def _named(numbers: Sequence[int], count: int) -> str:
    """Shards as the subject of a sentence, at most 20 of them by number."""
    words = ", ".join(map(str, numbers[:20])) + (f" and {len(numbers) - 20} more" if len(numbers) > 20 else "")
    return f"shard {words} of {count} is" if len(numbers) == 1 else f"shards {words} of {count} are"
