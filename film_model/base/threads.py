"""How many threads are used."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache, wraps
from importlib import import_module
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

_allowed: ContextVar[int | None] = ContextVar("threads", default=None)


@contextmanager
def threads(most: int) -> Generator[None]:
    """Within this context :func:`threads_allowed` is `most`."""
    before = _allowed.set(most)
    try:
        yield
    finally:
        _allowed.reset(before)


def threads_allowed() -> int:
    """Threads that a function may use: as many as there are cores, unless :func:`threads` says how many."""
    return _allowed.get() or available_cores()


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def one_thread(work: Callable[P, R]) -> Callable[P, R]:
    """The function with one thread for the linear algebra in it.

    The threads of BLAS wait for each other in a loop: where other processes use the processors, the vibrations of a
    clamped plate take twenty times as long, and on a quiet machine no less. Sums on one thread are the same on any
    number of processors.
    """

    @wraps(work)
    def alone(*given: P.args, **named: P.kwargs) -> R:
        with _libraries().limit(limits=1, user_api="blas"):
            return work(*given, **named)

    return alone


@lru_cache(maxsize=1)
def _libraries() -> Any:
    """The libraries with threads, which take milliseconds to find."""
    from threadpoolctl import ThreadpoolController

    import_module("scipy.linalg")  # only libraries that are loaded can be limited
    return ThreadpoolController()
