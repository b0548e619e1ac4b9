"""What an interrupted sweep leaves behind: its finished blocks, a file each, to go on with."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.provenance import PROGRAM, scene_text
from film_datasets.stores import beside
from film_datasets.sweeps import Sweep


class Parts:
    """The finished blocks of a sweep, a file each, in a folder beside the output, until it is there as a whole."""

    def __init__(self, target: Path, made: Sweep) -> None:
        self._target, self._blocks = target, made.blocks
        self._fingerprint = _fingerprint(made)
        self.folder = target.absolute().with_name(f".{target.name}.blocks")

    @contextlib.contextmanager
    def locked(self, resume: bool, overwrite: bool) -> Iterator[None]:
        """The folder, made or found, for this process alone."""
        manifest = self.folder / "sweep.json"
        if self.folder.exists() and not resume and not overwrite:
            raise FileExistsError(
                f"{self._target}: an interrupted run left {self.said()}; or say overwrite=True to begin anew"
            )
        try:
            self.folder.mkdir(exist_ok=True)
            lock = open(self.folder / "lock", "w")  # noqa: SIM115  # held until the end
        except OSError as error:
            raise type(error)(f"{self._target}: cannot be written: {error.strerror or error}") from error
        with lock:
            _lock(lock, self._target)
            known = {"fingerprint": self._fingerprint, "blocks": self._blocks}
            if manifest.exists() and resume and not overwrite:
                try:
                    found = json.loads(manifest.read_text(encoding="utf-8"))
                except ValueError:
                    found = None
                if found != known:
                    raise FileExistsError(
                        f"{self._target}: what an interrupted run left in {self.folder} is of another sweep, scene or "
                        "version; say overwrite=True to begin anew"
                    )
            else:
                for path in self.folder.iterdir():
                    if path.name != "lock":
                        path.unlink()
                self._replace(manifest, json.dumps(known).encode())
            yield

    def said(self) -> str:
        """How much there is, and what to do with it."""
        count = len(self.done())
        if not count:
            return "no blocks"
        kept = f"{count} of {self._blocks} blocks in {self.folder}"
        return f"{kept}: say resume=True to go on"

    def done(self) -> set[int]:
        """Numbers of the blocks that are there."""
        with contextlib.suppress(OSError):
            return {int(path.stem) for path in self.folder.glob("*.npz") if path.stem.isdigit()}
        return set()

    def save(self, number: int, columns: Mapping[str, NDArray[Any]]) -> None:
        """Keep a block: written beside and renamed; its file has check sums, so half a file is never taken for one."""
        path = self.folder / f"{number}.npz"
        with open(path.with_suffix(".part"), "wb") as file:
            np.savez(file, allow_pickle=False, **columns)
        os.replace(path.with_suffix(".part"), path)

    def load(self, number: int) -> dict[str, NDArray[Any]] | None:
        """A block that was kept, or None if its file is damaged."""
        try:
            with open(self.folder / f"{number}.npz", "rb") as opened, np.load(opened, allow_pickle=False) as file:
                return {name: file[name] for name in file.files}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None

    def remove(self) -> None:
        """Leave nothing behind."""
        shutil.rmtree(self.folder, ignore_errors=True)
        made = beside(self._target)
        if made.is_dir():
            shutil.rmtree(made, ignore_errors=True)
        else:
            made.unlink(missing_ok=True)

    @staticmethod
    def _replace(path: Path, data: bytes) -> None:
        path.with_suffix(".part").write_bytes(data)
        os.replace(path.with_suffix(".part"), path)


def _lock(file: Any, target: Path) -> None:
    """Refuse a second process on the same output; the lock ends with the process."""
    try:
        import fcntl
    except ImportError:  # Windows: an open file cannot be removed there
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise FileExistsError(f"{target}: another process is computing it") from None


def _fingerprint(made: Sweep) -> str:
    """What a sweep is, in one word: runs with the same one make the same data."""
    texts = (PROGRAM, scene_text(made.scene), str(made.scene.contact.law), made.text())
    return hashlib.sha256("\0".join((*texts, made.keep, str(made.dense), str(made.chunks))).encode()).hexdigest()
