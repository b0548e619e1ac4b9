"""The columns of blocks put into a writer and into the hash of the content, variable by variable, by the workers."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from film_datasets.schema import RAGGED, WIDE, ContentHash, Variable
from film_datasets.sweeps.attributes import variable_attributes
from film_datasets.sweeps.block_columns import Columns
from film_datasets.sweeps.block_writers import COORDINATE_CHUNK, FILE_BLOCKS, Writer, ZarrWriter
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import Block
from film_datasets.sweeps.executor import Workers
from film_datasets.sweeps.ragged import Places, ragged_dims
from film_model.base.threads import available_cores


class Storage:
    """A sweep on its way into a writer. content: the hash, complete when the context ends; when it begins, that of what
    an earlier run has written.

    The packing, writing and hashing of a block are tasks of the workers; of remote workers, of threads here. A
    variable's blocks follow one another, because the tasks of a block begin when those of the block before have ended.
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
        # two tasks of a worker for each block, among which its variables are divided: to start one takes 0.1 ms
        self._parts = 2 * (workers.number if workers.local else available_cores())
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
        pieces, together = list(_coordinates(sweep)), 8  # pieces of up to 2 MB that are written at a time
        for first in range(0, len(pieces), together):
            some = pieces[first : first + together]
            made = list((map if self._executor is None else self._executor.map)(lambda piece: piece.values(), some))
            self.finish()
            self._start(self._put, some, made)
            self._start(self._hash, [piece.name for piece in some], made)
        self.finish()

    def __exit__(self, *error: object) -> None:
        with self._own:
            if error[0] is None:
                self.finish()

    def put(self, block: Block, columns: Columns) -> None:
        """The next block; also sets where the rows of its impacts begin, such as `segment_begin`."""
        self._places.put(columns)
        given = [(v, np.asarray(columns[v.name], v.dtype)) for v in self._sweep.variables if v.name in columns]
        self.finish()
        for first in range(min(self._parts, len(given))):
            self._start(self._take, block, given[first :: self._parts])

    def finish(self) -> None:
        """Wait until the blocks so far are written and hashed."""
        tasks, self._tasks = self._tasks, []
        for task in tasks:
            task.result()
        self._writer.commit()

    def _start(self, function: Callable[..., None], *arguments: Any) -> None:
        """Call a function in the workers; here if there is only one block."""
        if self._executor is None:
            function(*arguments)
        else:
            self._tasks.append(self._executor.submit(function, *arguments))

    def _take(self, block: Block, given: Sequence[tuple[Variable, NDArray[Any]]]) -> None:
        """Hash and write the values of a block: some of its variables."""
        for variable, values in given:
            self.content.update(variable.name, values)
            if variable.dims[0] in RAGGED:
                self._writer.grow(variable.name, values)
            else:
                along = values.shape[1:]  # the normalised times of each impact
                region = (*block.region, *(slice(0, size) for size in along))
                self._writer.put(variable.name, region, values.reshape(block.shape + along))

    def _put(self, pieces: Sequence[_Piece], made: Sequence[Any]) -> None:
        for piece, values in zip(pieces, made, strict=True):
            self._writer.put(piece.name, piece.region, values)

    def _hash(self, names: Sequence[str], columns: Sequence[Any]) -> None:
        for name, values in zip(names, columns, strict=True):
            self.content.update(name, values)


class _Piece(NamedTuple):
    """Some of the values that are not columns of the blocks; they are made when they are written."""

    name: str
    region: tuple[slice, ...]
    values: Callable[[], Any]


def _coordinates(sweep: Sweep) -> Iterator[_Piece]:
    """The values that are not columns of the blocks."""
    if sweep.dense:
        yield _Piece("normalised_time", (slice(0, sweep.dense),), partial(np.linspace, 0.0, 1.0, sweep.dense))
    for name, value in sweep.constants.items():
        yield _Piece(name, (), partial(np.asarray, value))
    if sweep.dims == ("impact",):
        return
    for axis in sweep.axes:
        for first in range(0, axis.count, COORDINATE_CHUNK):
            stop = min(first + COORDINATE_CHUNK, axis.count)
            yield _Piece(axis.name, (slice(first, stop),), partial(axis.coordinate, first, stop))


def written_content(sweep: Sweep, blocks: Blocks, writer: ZarrWriter, count: int) -> ContentHash:
    """The hash of what an earlier run has written with a writer: of the first `count` blocks."""
    content = ContentHash(sweep.variables)
    for piece in _coordinates(sweep):
        content.update(piece.name, piece.values())

    def read(variable: Variable) -> None:
        for group in blocks.groups(FILE_BLOCKS):
            if group.start < count:
                content.update(variable.name, writer.read(variable.name, blocks.region(group)))

    with ThreadPoolExecutor(available_cores()) as pool:
        list(pool.map(read, sweep.row_variables))
    return content
