"""What a sweep tells of its progress."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

Progress = Callable[[int, int], None]
"""Told impacts done, and in all."""


class Bar:
    """Progress on standard error: a bar on a terminal, else a line every ten seconds."""

    def __init__(self, stream: Any = None) -> None:
        self._stream = stream or sys.stderr
        self._bar = self._stream.isatty()
        self._begin, self._said, self._first = time.monotonic(), -1.0, -1

    def __call__(self, done: int, size: int) -> None:
        now = time.monotonic() - self._begin
        self._first = done if self._first < 0 else self._first
        if done < size and now - self._said < (0.2 if self._bar else 10.0):
            return
        if not self._bar and self._said < 0.0 and done < size and now < 10.0:
            return
        self._said = now
        rate = done / max(now, 1e-9)
        rest = f"{(size - done) / rate:.0f} s left" if done < size else f"{now:.1f} s"
        text = f"{done} of {size} impacts, {100 * done / size:.0f} %, {rate:.3g} a second, {rest}"
        if self._bar:
            filled = 20 * done // size
            end = "\n" if done == size else ""
            print(f"\r[{'#' * filled}{'.' * (20 - filled)}] {text}\x1b[K", end=end, file=self._stream, flush=True)
        else:
            print(text, file=self._stream, flush=True)
