"""How much of the disk a sweep takes, from a sample of its impacts, and whether it is there."""

from __future__ import annotations

import shutil
import zlib
from pathlib import Path

import numpy as np

from film_datasets.files import ZARR
from film_datasets.impacts import one_curve_per_impact
from film_datasets.sweeps.block_columns import ENERGY_GAINS, ESTIMATED, MISSED, compute_block
from film_datasets.sweeps.block_writers import FILE_BLOCKS
from film_datasets.sweeps.blocks import Block, Blocks
from film_datasets.sweeps.definition import Sweep

SAMPLE = 256
"""Impacts that are simulated to see how many bytes they take; of sweeps of fewer than 64 times as many none are."""

COMPRESSED = 0.6
"""Fraction that remains of an impact's bytes, where no sample is taken."""


def disk_space(sweep: Sweep) -> tuple[float, float]:
    """Bytes of the finished output, and of the blocks that are saved until then, about."""
    scenes = (sweep.combination(number) for number in sweep.combinations_used)
    if sweep.size < 64 * SAMPLE or any(map(one_curve_per_impact, scenes)):
        blocks = float(sweep.size * sweep.bytes_per_impact)
        return COMPRESSED * blocks, blocks
    columns = compute_block(sweep, Block((), sweep.size // 2, SAMPLE))
    arrays = [column for name, column in columns.items() if name not in (ESTIMATED, MISSED, ENERGY_GAINS)]
    packed = sum(
        len(zlib.compress(np.ascontiguousarray(array).view(np.uint8).reshape(array.size, -1).T.tobytes(), 1))
        for array in arrays
        if array.size
    )
    each = sweep.size / SAMPLE
    return packed * each, sum(array.nbytes for array in arrays) * each


def check_free_space(target: Path, sweep: Sweep, shards: int | None = None) -> None:
    """Raise OSError if the disk cannot hold the output, or one of its shards, and, until it is finished, the saved
    blocks: all, or for a Zarr folder those of an unfinished file and of the next."""
    output, blocks = (need / (shards or 1) for need in disk_space(sweep))
    if target.suffix == ZARR and shards is None and sweep.keep != "segments":
        blocks *= min(1.0, 2 * FILE_BLOCKS / len(Blocks(sweep)))
    free = shutil.disk_usage(target.absolute().parent).free
    if output + blocks > free:
        raise OSError(
            f"{target}: {sweep.size // (shards or 1)} impacts need about {bytes_text(output + blocks)} of disk while "
            f"they are computed, {bytes_text(output)} in the end; {bytes_text(free)} are free"
        )


def bytes_text(count: float) -> str:
    """Bytes as GB or MB."""
    return f"{count / 1e9:.3g} GB" if count >= 1e9 else f"{max(count / 1e6, 0.1):.3g} MB"
