"""Linear algebra on one thread."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from importlib import import_module
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


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
