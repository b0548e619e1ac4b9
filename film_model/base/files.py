"""Files: read whole if regular, written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import stat
from collections.abc import Generator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def check_regular(path: str | os.PathLike[str]) -> None:
    """Raise ValueError for a pipe, a device or a folder, reading from which may never end; OSError if there is none."""
    mode = os.stat(path).st_mode
    if not stat.S_ISREG(mode):
        raise ValueError(f"is a {'folder' if stat.S_ISDIR(mode) else 'pipe or a device'}, a regular file is needed")


def check_folder(path: str | os.PathLike[str]) -> None:
    """Raise ValueError for a folder in which anything is a link, a pipe or a device."""
    with os.scandir(path) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                check_folder(entry.path)
            elif not entry.is_file(follow_symlinks=False):
                raise ValueError(f'"{entry.name}" in it is a link, a pipe or a device, a regular file is needed')


def read_bytes(path: str | os.PathLike[str], most: int) -> bytes:
    """The content of a regular file of at most `most` bytes. Raises ValueError for another one, or OSError."""
    check_regular(path)
    with open(path, "rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise ValueError(f"is larger than {most // 1_000_000} MB, which are read at most")
    return data


def check_replaceable(target: str | Path, overwrite: bool = True) -> None:
    """Raise FileExistsError for a file if `overwrite` is not set, and for a link, a pipe or a device: renaming a
    finished file would replace it, not what it points to."""
    if os.path.islink(target):
        raise FileExistsError(f"{target}: is a link, which writing would replace; give the file it points to")
    if not os.path.exists(target):
        return
    if not overwrite:
        raise FileExistsError(f"{target}: exists; use overwrite=True to replace it")
    if not os.path.isfile(target) and not os.path.isdir(target):
        raise FileExistsError(f"{target}: is a device or a pipe, which writing would replace; give the name of a file")


@contextlib.contextmanager
def written_whole(target: Path) -> Generator[Path, None, None]:
    """A new, empty file next to `target` to write to; flushed and renamed to `target` if the block raises no exception.

    In every case `target` is never a partial file, and no temporary file remains. Raises FileExistsError for a link
    or a device; FileNotFoundError, PermissionError or another OSError that names `target` if it cannot be written.
    """
    check_replaceable(target)
    beside = target.absolute().with_name(f".{target.name[:100]}.{os.urandom(4).hex()}.part")
    try:
        # Created here, not by the library that fills it, so that the message has the reason if this fails.
        os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield beside
        flush(beside, os.O_RDWR)
        os.replace(beside, target)
    except OSError as error:
        raise type(error)(f"{target}: cannot be written: {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()
    with contextlib.suppress(OSError):  # some systems cannot open a folder
        flush(target.absolute().parent, os.O_RDONLY)


def write_text(target: str | Path, text: str) -> None:
    """Write a text in UTF-8 as `written_whole` does."""
    from pathlib import Path

    with written_whole(Path(target)) as beside:
        beside.write_text(text, "utf-8")


def flush(path: Path, flags: int) -> None:
    """Flush a file, or the entries of a folder, to the disk. flags: for opening it."""
    descriptor = os.open(path, flags)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
