"""Where blocks are computed: threads of this process, or the workers of a Dask scheduler."""

from __future__ import annotations

import contextlib
from collections.abc import Generator
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from film_model.base.errors import SimulationError
from film_model.base.threads import available_cores

NEEDS_DASK = 'a scheduler needs Dask: install film-model[dask] (pip install "film-model[dask]")'


class Workers(NamedTuple):
    """An executor, the number of its workers, and whether they are threads of this process."""

    executor: Executor
    number: int
    local: bool

    @property
    def ahead(self) -> int:
        """How many blocks to submit, with the one that is awaited; two finished ones may wait to be written."""
        return (self.number if self.local else 2 * self.number) + 2


@contextlib.contextmanager
def workers_of(threads: int | None, scheduler: Any) -> Generator[Workers]:
    """Threads, as many as there are cores unless given, or the workers of a Dask scheduler (address or Client)."""
    if scheduler is not None:
        with _dask_client(scheduler) as client:
            threads_in_all = sum(client.nthreads().values())
            yield Workers(client.get_executor(pure=False), max(1, threads_in_all), local=False)
        return
    count = threads or available_cores()
    _keep_released_memory()
    pool = ThreadPoolExecutor(count, thread_name_prefix="sweep")
    try:
        yield Workers(pool, count, local=True)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _keep_released_memory() -> None:
    """Let the arrays of a block take the memory that those of the block before have released.

    By default glibc gives it back to the system, and the next block gets pages that are new: they took 40 % of the
    time of a block, more with two workers, whose page tables are one. An array of this size is the largest after whose
    release glibc raises the sizes from which it does so; see mallopt(3), M_MMAP_THRESHOLD. It is not touched; other
    C libraries do not care.
    """
    np.empty((32 << 20) - (1 << 13), np.uint8)


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
