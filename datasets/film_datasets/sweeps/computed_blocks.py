"""The blocks of a sweep as they are computed, by many workers ahead of the one that is written, or read back."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

from film_datasets.sweeps.block_columns import compute_block
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.checkpoint import Checkpoint
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import Block
from film_datasets.sweeps.executor import Workers
from film_datasets.sweeps.progress import Progress
from film_datasets.sweeps.ragged import Columns
from film_model.base.threads import threads


@dataclass(frozen=True)
class Run:
    """A sweep with its blocks. command: for the attribute `history`. progress: called after each block."""

    sweep: Sweep
    blocks: Blocks
    command: str
    progress: Progress | None


def computed_blocks(
    run: Run, workers: Workers, checkpoint: Checkpoint | None = None, numbers: Sequence[int] | None = None
) -> Iterator[tuple[Block, Columns]]:
    """Blocks with their columns, in order: all, or those of `numbers`. Each is saved in the checkpoint, unless there is
    only one. The workers begin at once, before the first block is asked for."""
    wanted = range(len(run.blocks)) if numbers is None else numbers
    if workers.local and len(wanted) == 1:  # computed in this thread: there is nothing to do meanwhile
        return ((block, _computed(run.sweep, block, workers.number)) for block in (run.blocks[wanted[0]],))
    under_way = _UnderWay(run, workers, checkpoint if len(wanted) > 1 else None, wanted)
    under_way.submit()
    return map(under_way.finished, wanted)


def _computed(sweep: Sweep, block: Block, most: int = 1) -> Columns:
    """A block computed on up to `most` threads."""
    with threads(most):
        return compute_block(sweep, block)


class _UnderWay:
    """The blocks that the workers compute or have computed, until they are asked for."""

    def __init__(self, run: Run, workers: Workers, checkpoint: Checkpoint | None, wanted: Sequence[int]) -> None:
        self._run, self._workers, self._checkpoint = run, workers, checkpoint
        saved = checkpoint.finished() if checkpoint is not None else set[int]()
        self._upcoming = (number for number in wanted if number not in saved)
        self._futures: dict[int, Future[Columns]] = {}

    def submit(self) -> None:
        """Submit blocks until `Workers.ahead` are under way."""
        local, executor = self._workers.local, self._workers.executor
        while len(self._futures) < self._workers.ahead and (number := next(self._upcoming, None)) is not None:
            self._futures[number] = (
                executor.submit(self._compute_and_save, number)
                if local
                else executor.submit(_computed, self._run.sweep, self._run.blocks[number])
            )

    def finished(self, number: int) -> tuple[Block, Columns]:
        """The next block, computed or read back."""
        self.submit()
        checkpoint = self._checkpoint
        if number in self._futures:
            columns = self._futures.pop(number).result()
            if checkpoint is not None and not self._workers.local:
                checkpoint.save(number, columns)
        else:
            assert checkpoint is not None
            columns = checkpoint.load(number) or self._compute_and_save(number)
        return self._run.blocks[number], columns

    def _compute_and_save(self, number: int) -> Columns:
        begin = time.process_time()
        columns = _computed(self._run.sweep, self._run.blocks[number])
        if self._checkpoint is not None:
            # process_time is that of all threads, shared among the blocks under way
            self._checkpoint.save(number, columns, (time.process_time() - begin) / self._workers.number)
        return columns
