"""The checkpoint of a sweep: its finished blocks, a file each, from which an interrupted run is resumed."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import shutil
import zipfile
from collections.abc import Generator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_datasets.files import ZARR, temporary_path
from film_datasets.provenance import PROGRAM
from film_datasets.sweeps.block_writers import FILE_BLOCKS
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.definition import Sweep
from film_model.base.files import written_whole

OWNER = "owner"
"""Entry of a block's file: the sweep's fingerprint, its first row and number of rows."""


WRITTEN = "written.json"

WORTH_SAVING = 30.0
"""CPU seconds: a sweep loses less to an interruption unless its blocks are saved."""


class Written(NamedTuple):
    """The first blocks of a sweep, in whole files of the unfinished output. content: their hash. totals: as
    `Totals.to_plain` gives them."""

    blocks: int
    content: str
    totals: dict[str, Any]


class Checkpoint:
    """The finished blocks of a sweep, a file each, in a hidden folder beside the output until that is complete, or has
    them in whole files. in_files: whether it will, before it is complete."""

    def __init__(self, target: Path, sweep: Sweep, blocks: Blocks) -> None:
        self._target, self._sweep, self._blocks = target, sweep, blocks
        self._fingerprint = fingerprint(sweep, blocks)
        self.folder = target.absolute().with_name(f".{target.name}.blocks")
        self.in_files = target.suffix == ZARR and sweep.keep != "segments"

    @contextlib.contextmanager
    def locked(self, resume: bool, overwrite: bool) -> Generator[None]:
        """Create or reuse the folder and lock it against other processes."""
        manifest = self.folder / "sweep.json"
        if self.folder.exists() and not resume and not overwrite:
            if (self.folder / "lock").is_file():
                with open(self.folder / "lock") as lock:
                    lock_file(lock, self._target)
            if self.finished():
                raise FileExistsError(
                    f"{self._target}: an interrupted run left {self.summary()}; or use overwrite=True to start again"
                )
        with contextlib.ExitStack() as held:
            try:
                self.folder.mkdir(exist_ok=True)
                lock = held.enter_context(open(self.folder / "lock", "w"))
            except OSError as error:
                raise type(error)(f"{self._target}: cannot be written: {error.strerror or error}") from error
            lock_file(lock, self._target)
            known = {"fingerprint": self._fingerprint, "blocks": len(self._blocks)}
            if manifest.exists() and resume and not overwrite:
                try:
                    found = json.loads(manifest.read_text(encoding="utf-8"))
                except ValueError:
                    found = None
                if found != known:
                    raise FileExistsError(
                        f"{self._target}: {self.folder} was left by an interrupted run of another sweep, scene or "
                        "version; use overwrite=True to start again"
                    )
            else:
                for path in self.folder.iterdir():
                    if path.name != "lock":
                        path.unlink()
                manifest.with_suffix(".part").write_bytes(json.dumps(known).encode())
                os.replace(manifest.with_suffix(".part"), manifest)
            yield

    def summary(self) -> str:
        """How many blocks are finished, and how to resume."""
        count = len(self.finished())
        if count:
            return f"{count} of {len(self._blocks)} blocks in {self.folder}: use resume=True to continue"
        return f"nothing to resume: no block was finished, or all can be computed again within {WORTH_SAVING:g} s"

    def finished(self) -> set[int]:
        """Numbers of the finished blocks."""
        begun = self.written()
        found = set(range(begun.blocks)) if begun else set[int]()
        with contextlib.suppress(OSError):
            found |= {int(path.stem) for path in self.folder.glob("*.npz") if path.stem.isdecimal()}
        return {number for number in found if number < len(self._blocks)}

    def written(self) -> Written | None:
        """The blocks that are in whole files of the unfinished output, and need not be saved."""
        try:
            found = json.loads((self.folder / WRITTEN).read_text(encoding="utf-8"))
            return Written(found["blocks"], found["content_sha256"], found["totals"])
        except (OSError, ValueError, KeyError):
            return None

    def set_written(self, written: Written | None) -> None:
        """Say which blocks the unfinished output holds, and delete them here; None: it is to be written again."""
        if written is None:
            (self.folder / WRITTEN).unlink(missing_ok=True)
            return
        before = self.written()
        with written_whole(self.folder / WRITTEN) as beside:
            found = {"blocks": written.blocks, "content_sha256": written.content, "totals": written.totals}
            beside.write_text(json.dumps(found), encoding="utf-8")
        for number in range(before.blocks if before else 0, written.blocks):
            (self.folder / f"{number}.npz").unlink(missing_ok=True)

    def save(self, number: int, columns: Mapping[str, NDArray[Any]], seconds: float = math.inf) -> None:
        """Save a block that took so many CPU seconds, unless computing the blocks that are not yet in the output again
        is quickly done: written under another name and renamed. The file has checksums, so `load` detects damage, and
        says which rows of which sweep it holds."""
        waiting = 2 * FILE_BLOCKS if self.in_files else len(self._blocks)
        if seconds * waiting < WORTH_SAVING:
            return
        path = self.folder / f"{number}.npz"
        with open(path.with_suffix(".part"), "wb") as file:
            np.savez(file, allow_pickle=False, **columns, **{OWNER: self._owner(number)})
        os.replace(path.with_suffix(".part"), path)

    def load(self, number: int) -> dict[str, NDArray[Any]] | None:
        """The columns of a saved block, or None if its file is damaged or holds other rows."""
        try:
            with open(self.folder / f"{number}.npz", "rb") as opened, np.load(opened, allow_pickle=False) as file:
                columns = {name: file[name] for name in file.files}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        owner = columns.pop(OWNER, None)
        if owner is None or owner.shape != () or str(owner) != str(self._owner(number)):
            return None
        return columns if self._fits(columns, self._blocks[number].count) else None

    def _owner(self, number: int) -> NDArray[np.str_]:
        block = self._blocks[number]
        return np.array(f"{self._fingerprint} {block.first} {block.count}")

    def _fits(self, columns: Mapping[str, NDArray[Any]], count: int) -> bool:
        """Whether there is a column, of one value per impact, for every variable of the impacts."""
        dims = self._sweep.dims
        along = {"normalised_time": self._sweep.dense}
        for variable in self._sweep.variables[len(self._sweep.axes) :]:
            if variable.dims[: len(dims)] == dims:
                shape = (count, *(along[dim] for dim in variable.dims[len(dims) :]))
                if variable.name not in columns or columns[variable.name].shape != shape:
                    return False
        return True

    def remove(self) -> None:
        """Delete the folder and the unfinished output."""
        shutil.rmtree(self.folder, ignore_errors=True)
        unfinished = temporary_path(self._target)
        if unfinished.is_dir():
            shutil.rmtree(unfinished, ignore_errors=True)
        else:
            unfinished.unlink(missing_ok=True)


def lock_file(file: Any, target: Path) -> None:
    """Raise FileExistsError if another process has the lock; it is released when the process ends."""
    try:
        import fcntl  # lazy: only on Unix
    except ImportError:  # on Windows a file that another process has open cannot be removed
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise FileExistsError(f"{target}: another process is computing it") from None


def fingerprint(sweep: Sweep, blocks: Blocks) -> str:
    """A hash of the sweep, its division into blocks and the program: runs with the same hash make the same data."""
    texts = (PROGRAM, sweep.scene.archived_text(), str(sweep.scene.contact.law), sweep.text())
    return hashlib.sha256("\0".join((*texts, sweep.keep, str(sweep.dense), str(blocks.shape))).encode()).hexdigest()
