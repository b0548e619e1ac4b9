"""The columns of blocks put into a writer and into the hash of the content, variable by variable, by the workers."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_datasets.schema import RAGGED, WIDE, ContentHash, Variable
from film_datasets.sweeps.attributes import variable_attributes
from film_datasets.sweeps.block import Block
from film_datasets.sweeps.block_columns import Columns
from film_datasets.sweeps.block_writers import Writer, ZarrWriter
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.executor import Workers, available_cores
from film_datasets.sweeps.ragged import Places, ragged_dims

Column = tuple[Variable, NDArray[Any]]


class Storage:
    """A sweep on its way into a writer. content: the hash, complete when the context ends; when it begins, that of what
    an earlier run has written.

    The writing and hashing of a block are tasks of the workers; of remote workers, of threads here. A variable's blocks
    follow one another, because the tasks of a block are submitted when those of the block before have ended.
    """

    def __init__(
        self, sweep: Sweep, blocks: Blocks, writer: Writer, workers: Workers, content: ContentHash | None = None
    ) -> None:
        self.content = content or ContentHash(sweep.variables)
        self._sweep, self._blocks, self._writer = sweep, blocks, writer
        self._places = Places(ragged_dims(sweep.variables))
        self._tasks: list[Future[None]] = []
        self._own = contextlib.ExitStack()
        self._executor: Any = None
        if len(blocks) > 1:
            local = workers.executor if workers.local else ThreadPoolExecutor(available_cores())
            self._executor = local if workers.local else self._own.enter_context(local)

    def __enter__(self) -> Storage:
        return self

    def create(self) -> None:
        """Create all variables, and write those that are not columns of the blocks."""
        sweep, blocks = self._sweep, self._blocks
        own = {"normalised_time": sweep.dense} if sweep.dense else {}
        own |= {dim: size for variable in sweep.variables for dim, size in WIDE.items() if dim in variable.dims}
        chunks = dict(zip(sweep.dims, blocks.shape, strict=True)) | own | blocks.growing_chunks
        sizes = dict(zip(sweep.dims, sweep.shape, strict=True)) | own
        self._writer.create(sizes, chunks, variable_attributes(sweep))
        for name, region, values in _coordinates(sweep, blocks):
            self._writer.put(name, region, values)
            self.content.update(name, values)

    def __exit__(self, *error: object) -> None:
        with self._own:
            if error[0] is None:
                self.finish()

    def put(self, block: Block, columns: Columns) -> None:
        """The next block; also sets where the rows of its impacts begin, such as `segment_begin`."""
        self._places.put(columns)
        given = [(v, np.asarray(columns[v.name], v.dtype)) for v in self._sweep.variables if v.name in columns]
        if self._executor is None:
            self._write(block, given)
            self._hash(given)
            return
        self.finish()
        groups = [[one] for one in given] if self._writer.parallel else [given]
        self._tasks = [self._executor.submit(self._write, block, group) for group in groups]
        self._tasks += [self._executor.submit(self._hash, [one]) for one in given]

    def finish(self) -> None:
        """Wait until the blocks so far are written and hashed."""
        tasks, self._tasks = self._tasks, []
        for task in tasks:
            task.result()

    def _write(self, block: Block, columns: Sequence[Column]) -> None:
        for variable, values in columns:
            if variable.dims[0] in RAGGED:
                self._writer.grow(variable.name, values)
            else:
                self._writer.put(variable.name, block.region, values.reshape(block.shape + values.shape[1:]))

    def _hash(self, columns: Sequence[Column]) -> None:
        for variable, values in columns:
            self.content.update(variable.name, values)


def _coordinates(sweep: Sweep, blocks: Blocks) -> Iterator[tuple[str, tuple[slice, ...], Any]]:
    """The values that are not columns of the blocks: variable, region, values."""
    if sweep.dense:
        yield "normalised_time", (slice(None),), np.linspace(0.0, 1.0, sweep.dense)
    for name, value in sweep.constants.items():
        yield name, (), value
    if sweep.dims == ("impact",):
        return
    for axis, chunk in zip(sweep.axes, blocks.shape, strict=True):
        coordinate = axis.coordinate()
        step = chunk * max(1, (1 << 20) // chunk)  # whole chunks: part of a chunk would be read and written again
        for first in range(0, axis.count, step):
            values = coordinate[first : first + step]
            yield axis.name, (slice(first, first + len(values)),), values


def written_content(sweep: Sweep, blocks: Blocks, writer: ZarrWriter, count: int) -> ContentHash:
    """The hash of what an earlier run has written with a writer: of the first `count` blocks."""
    content = ContentHash(sweep.variables)
    for name, _, values in _coordinates(sweep, blocks):
        content.update(name, values)

    def read(variable: Variable) -> None:
        for number in range(count):
            content.update(variable.name, writer.read(variable.name, blocks[number].region))

    with ThreadPoolExecutor(available_cores()) as pool:
        list(pool.map(read, sweep.row_variables))
    return content
