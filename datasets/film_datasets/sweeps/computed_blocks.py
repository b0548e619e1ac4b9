"""The blocks of a sweep as they are computed, by many workers ahead of the one that is written, or read back."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass

from film_datasets.sweeps.block_columns import Columns, compute_block
from film_datasets.sweeps.blocks import Block, Blocks
from film_datasets.sweeps.checkpoint import Checkpoint
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.executor import Workers
from film_datasets.sweeps.progress_bar import Progress


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
    only one."""
    sweep, blocks = run.sweep, run.blocks
    wanted = range(len(blocks)) if numbers is None else numbers
    if workers.local and len(wanted) == 1:  # computed in this thread: there is nothing to do meanwhile
        yield blocks[wanted[0]], compute_block(sweep, blocks[wanted[0]])
        return
    if len(wanted) == 1:
        checkpoint = None
    saved = checkpoint.finished() if checkpoint is not None else set[int]()

    def compute_and_save(number: int) -> Columns:
        begin = time.thread_time()
        columns = compute_block(sweep, blocks[number])
        if checkpoint is not None:
            checkpoint.save(number, columns, time.thread_time() - begin)
        return columns

    def submit(number: int) -> Future[Columns]:
        if workers.local:
            return workers.executor.submit(compute_and_save, number)
        return workers.executor.submit(compute_block, sweep, blocks[number])

    under_way: dict[int, Future[Columns]] = {}
    upcoming = iter(number for number in wanted if number not in saved)
    for number in wanted:
        while len(under_way) < workers.ahead and (following := next(upcoming, None)) is not None:
            under_way[following] = submit(following)
        if number in under_way:
            columns = under_way.pop(number).result()
            if checkpoint is not None and not workers.local:
                checkpoint.save(number, columns)
        else:
            assert checkpoint is not None
            columns = checkpoint.load(number) or compute_and_save(number)
        yield blocks[number], columns
