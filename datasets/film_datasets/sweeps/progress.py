"""The progress of a sweep on standard error, and messages for one that is interrupted or cannot be written."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

from film_datasets.files import reason_of
from film_model.base.errors import SimulationError

Progress = Callable[[int, int], None]
"""Called with the number of finished impacts and of all impacts."""


class ProgressBar:
    """Progress on standard error: a bar on a terminal, otherwise a line every ten seconds."""

    def __init__(self, stream: Any = None) -> None:
        self._stream = stream or sys.stderr
        self._is_terminal = self._stream.isatty()
        self._begin, self._printed = time.monotonic(), -1.0

    def __call__(self, done: int, size: int) -> None:
        now = time.monotonic() - self._begin
        if done < size and now - self._printed < (0.2 if self._is_terminal else 10.0):
            return
        if not self._is_terminal and self._printed < 0.0 and done < size and now < 10.0:
            return
        self._printed = now
        rate = done / max(now, 1e-9)
        rest = f"{(size - done) / rate:.0f} s left" if done < size else f"{now:.1f} s"
        text = f"{done} of {size} impacts, {100 * done / size:.0f} %, {rate:.3g} a second, {rest}"
        if self._is_terminal:
            filled = 20 * done // size
            end = "\n" if done == size else ""
            print(f"\r[{'#' * filled}{'.' * (20 - filled)}] {text}\x1b[K", end=end, file=self._stream, flush=True)
        else:
            print(text, file=self._stream, flush=True)


class Interrupted(KeyboardInterrupt):
    """A sweep was interrupted; the message says where its finished blocks are kept."""


@contextlib.contextmanager
def explained(target: Path, kept: Callable[[], str]) -> Generator[None]:
    """Raise Interrupted or an OSError that names `target` and what is kept for the next run."""
    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted(f"interrupted: {kept()}") from None
    except (SimulationError, FileExistsError):
        raise
    except (OSError, RuntimeError) as error:  # the netCDF library raises RuntimeError for a full disk
        raise OSError(f"{target}: cannot be written: {reason_of(error, target)}; {kept()}") from error
