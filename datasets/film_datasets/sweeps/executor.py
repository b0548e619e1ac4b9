"""Where blocks are computed: threads of this process, or the workers of a Dask scheduler."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Generator
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any, NamedTuple

from film_model.base.errors import SimulationError

AHEAD = 2
"""Finished blocks that may wait for an earlier one to be written, besides the blocks that are being computed."""

NEEDS_DASK = 'a scheduler needs Dask: install film-model[dask] (pip install "film-model[dask]")'


class Workers(NamedTuple):
    """An executor, how many blocks to submit ahead of the one that is awaited, and whether it runs in this process."""

    executor: Executor
    ahead: int
    local: bool


@contextlib.contextmanager
def workers_of(threads: int | None, scheduler: Any) -> Generator[Workers]:
    """Threads, as many as there are cores unless given, or the workers of a Dask scheduler (address or Client)."""
    if scheduler is not None:
        with _dask_client(scheduler) as client:
            threads_in_all = sum(client.nthreads().values())
            yield Workers(client.get_executor(pure=False), 2 * max(1, threads_in_all) + AHEAD, local=False)
        return
    count = threads or available_cores()
    pool = ThreadPoolExecutor(count, thread_name_prefix="sweep")
    try:
        yield Workers(pool, count + AHEAD, local=True)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


@contextlib.contextmanager
def _dask_client(scheduler: Any) -> Generator[Any]:
    try:
        from distributed import Client  # lazy: an optional dependency
    except ImportError as error:
        raise ImportError(NEEDS_DASK) from error
    if isinstance(scheduler, Client):
        yield scheduler
        return
    try:
        client: Any = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise SimulationError(f"no Dask scheduler answers at {scheduler}: {error}") from error
    try:
        yield client
    finally:
        client.close()


def available_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
