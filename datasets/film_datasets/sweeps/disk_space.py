"""How much of the disk a sweep takes, from a sample of its impacts, and whether it is there."""

from __future__ import annotations

import shutil
from pathlib import Path

from film_datasets.files import ZARR
from film_datasets.sweeps.block_columns import TOTALS, compute_block
from film_datasets.sweeps.block_writers import FILE_BLOCKS
from film_datasets.sweeps.blocks import Blocks
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.designs import Block
from film_datasets.sweeps.sizes import packed
from film_model.effects.edge_effects import may_differ

SAMPLE = 256
"""Impacts that are simulated to see how many bytes they take; of sweeps of fewer than 64 times as many none are."""


def disk_space(sweep: Sweep, blocks: Blocks, suffix: str) -> tuple[float, float]:
    """Bytes of the finished output, by its suffix, and of the blocks that are saved until then, about."""
    scenes, size = (sweep.combination(number) for number in sweep.combinations_used), blocks.size
    if sweep.size < 64 * SAMPLE or any(map(may_differ, scenes)) or size.sample:
        saved = sweep.size * size.each
        output = size.compressed(suffix) * (saved + size.once) + 2000.0 * len(
            sweep.variables
        )  # of each, its description
        return output, saved + len(blocks) * size.once
    columns = compute_block(sweep, Block((), sweep.size // 2, SAMPLE))
    arrays = {name: column for name, column in columns.items() if name not in TOTALS}
    each = sweep.size / SAMPLE
    return packed(arrays, suffix) * each, sum(array.nbytes for array in arrays.values()) * each


def check_free_space(target: Path, sweep: Sweep, blocks: Blocks, shards: int | None = None) -> float:
    """Raise OSError if the disk cannot hold the output, or one of its shards, and, until it is finished, the saved
    blocks: all, or for a Zarr folder those of an unfinished file and of the next. Returns the bytes of the output."""
    output, saved = (need / (shards or 1) for need in disk_space(sweep, blocks, target.suffix))
    if target.suffix == ZARR and shards is None and sweep.keep != "segments":
        saved *= min(1.0, 2 * FILE_BLOCKS / len(blocks))
    free = shutil.disk_usage(target.absolute().parent).free
    if output + saved > free:
        raise OSError(
            f"{target}: {sweep.size // (shards or 1)} impacts need about {bytes_text(output + saved)} of disk while "
            f"they are computed, {bytes_text(output)} in the end; {bytes_text(free)} are free"
        )
    return output


def sizes_text(history: float, impacts: int, target: str, output: float) -> str:
    """How large the segments of a sweep and its output are. history: bytes of all segments before compression."""
    segments = f"{bytes_text(history / impacts)} of segments per impact, {bytes_text(history)} in all"
    return f"{segments}; {target}: {bytes_text(output)}, {bytes_text(output / impacts)} per impact"


def bytes_text(count: float) -> str:
    """Bytes as GB, MB or kB."""
    size, unit = next((pair for pair in ((1e9, "GB"), (1e6, "MB")) if count >= pair[0]), (1e3, "kB"))
    return f"{count / size:.3g} {unit}"
