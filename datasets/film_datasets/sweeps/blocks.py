"""Blocks: the parts of a sweep that are computed, saved and written one at a time."""

from __future__ import annotations

import math

import numpy as np

from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import Block
from film_datasets.sweeps.sizes import size_of
from film_model.effects.edge_effects import may_differ

BLOCK_BYTES, BLOCK_IMPACTS = 6_000_000, 65_536
"""A block has about so many bytes of data and at most so many impacts; both depend on the sweep alone, so that the
results do not depend on the workers."""

OWN_CURVES = 1024
"""Impacts of a block if each may need a curve of its own (91 kB): on beams and static stiffnesses."""


class Blocks:
    """The blocks of a sweep, in C order: one axis is divided, later ones are complete, earlier ones have length 1.

    size: of its impacts, about.
    """

    def __init__(self, sweep: Sweep) -> None:
        scenes = (sweep.combination(number) for number in sweep.combinations_used)
        limit = OWN_CURVES if any(map(may_differ, scenes)) else BLOCK_IMPACTS
        if any(axis.path.endswith("poissons_ratio") for axis in sweep.axes):
            # the curves of many impacts may differ in all numbers of a fit, some kB each
            limit = min(limit, 8192)
        self.size = size_of(sweep)
        most = max(1, min(limit, int(BLOCK_BYTES / self.size.each)))
        shape = self._shape = sweep.shape
        fits = (k for k in range(len(shape)) if math.prod(shape[k + 1 :]) <= most)
        cut = self._cut = next(fits, len(shape) - 1)
        parts = -(-shape[cut] // max(1, most // math.prod(shape[cut + 1 :])))
        self._length = -(-shape[cut] // parts)
        self._parts = -(-shape[cut] // self._length)

    def __len__(self) -> int:
        return math.prod(self._shape[: self._cut]) * self._parts

    @property
    def shape(self) -> tuple[int, ...]:
        """Of a block; the last one along the divided axis may be shorter."""
        return (*(1,) * self._cut, self._length, *self._shape[self._cut + 1 :])

    @property
    def growing_chunks(self) -> dict[str, int]:
        """Rows of a chunk of the file, by ragged dimension: as many as are expected, within limits."""
        expected = ((dim, int(math.prod(self._shape) * rows)) for dim, rows in self.size.rows.items())
        return {dim: min(max(256, rows), 65536) for dim, rows in expected}

    def groups(self, size: int) -> list[range]:
        """The numbers of the blocks, in groups of up to `size` that follow one another along the divided axis."""
        parts, outers = self._parts, len(self) // self._parts
        begins = (outer * parts + part for outer in range(outers) for part in range(0, parts, size))
        return [range(begin, min(begin + size, (begin // parts + 1) * parts)) for begin in begins]

    def region(self, group: range) -> tuple[slice, ...]:
        """The region of a group of blocks."""
        first, last = self[group[0]].region, self[group[-1]].region
        return tuple(slice(one.start, other.stop) for one, other in zip(first, last, strict=True))

    def __getitem__(self, number: int) -> Block:
        cut, shape = self._cut, self._shape
        outer, part = divmod(number, self._parts)
        leading = np.unravel_index(outer, shape[:cut]) if cut else ()
        begin, end = part * self._length, min((part + 1) * self._length, shape[cut])
        inner = math.prod(shape[cut + 1 :])
        region = (
            *(slice(int(k), int(k) + 1) for k in leading),
            slice(begin, end),
            *(slice(0, size) for size in shape[cut + 1 :]),
        )
        return Block(region, (outer * shape[cut] + begin) * inner, (end - begin) * inner)
