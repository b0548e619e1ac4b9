"""Files are written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Generator
from pathlib import Path


@contextlib.contextmanager
def written_whole(target: Path) -> Generator[Path, None, None]:
    """A new, empty file beside `target` to write to; flushed and renamed to `target` when the block ends well.

    Whatever happens, `target` never holds half a file and nothing is left beside it. Raises FileNotFoundError,
    PermissionError or another OSError that names `target` where it cannot be written.
    """
    beside = target.absolute().with_name(f".{target.name[:100]}.{secrets.token_hex(4)}.part")
    try:
        # Made here, not by the library that fills it, to have the reason when it cannot be.
        os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield beside
        flush(beside, os.O_RDWR)
        os.replace(beside, target)
    except OSError as error:
        raise type(error)(f"{target}: cannot be written: {error.strerror or error}") from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()
    with contextlib.suppress(OSError):  # not every system can open a folder
        flush(target.absolute().parent, os.O_RDONLY)


def flush(path: Path, flags: int) -> None:
    """Have the system put a file, or the names in a folder, on the disk; flags: to open it with."""
    descriptor = os.open(path, flags)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
