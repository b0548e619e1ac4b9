"""How many bytes the impacts of a sweep take, before it is computed."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from film_datasets.files import ZARR
from film_datasets.schema import SHARED
from film_datasets.sweeps.block_columns import compute_impacts
from film_datasets.sweeps.definition import Sweep
from film_datasets.sweeps.ragged import Columns, fields_of, ragged_dims
from film_model.base.errors import SimulationError
from film_model.core.native import LINE_DTYPE
from film_model.solve.history import MOTION


@dataclass(frozen=True)
class Size:
    """each: bytes of an impact. history: those of its closed form. rows: of the closed form, by ragged dimension. once:
    bytes of the modes that the impacts share. sample: columns of some impacts, empty if there is none."""

    each: float
    history: float = 0.0
    rows: Mapping[str, float] = field(default_factory=dict[str, float])
    once: float = 0.0
    sample: Columns = field(default_factory=Columns, repr=False)

    def compressed(self, suffix: str) -> float:
        """Fraction that remains of the bytes in a file, or in a folder, by its suffix."""
        size = sum(array.nbytes for array in self.sample.values())
        return packed(self.sample, suffix) / size if size else 0.6


def size_of(sweep: Sweep) -> Size:
    """The bytes of a sweep's impacts: on targets that may vibrate from a sample of them."""
    typical_segments = 32  # segments of an impact at the default accuracy, about
    own = sum(v.dtype.itemsize for v in sweep.variables if v.dims == sweep.dims)
    if "steps" in sweep.kept:
        return _of_sample(sweep, own)
    bytes_of = {"segments": typical_segments * LINE_DTYPE.itemsize, "samples": 8 * len(MOTION) * sweep.dense}
    history = bytes_of.get(sweep.keep, 0)
    return Size(own + history, history, {"segment": typical_segments} if sweep.keep == "segments" else {})


def _of_sample(sweep: Sweep, own: int) -> Size:
    """From evenly spaced impacts; their tables of modes count once, or for each impact if most are different."""
    # 36 impacts are enough to be followed together, like those of a block
    dims, count = ragged_dims(sweep.variables), min(36, max(sweep.size // 4, min(sweep.size, 8)))
    places = [(2 * k + 1) * sweep.size // (2 * count) for k in range(count)]
    values = [np.concatenate(axis) for axis in zip(*(sweep.values(place, 1) for place in places), strict=True)]
    try:
        columns = compute_impacts(sweep, values)
    except (SimulationError, ValueError):  # no impact has a result, so none has a motion
        return Size(own, rows=dict.fromkeys(dims, 0.0))
    sizes = {dim: sum(columns[name].nbytes for name in fields_of(dim)) for dim in dims}
    rows = {dim: len(columns[next(iter(fields_of(dim)))]) / count for dim in dims}
    once = 0.0
    for dim in SHARED:
        tables = np.unique(columns[f"{dim}_begin"][columns[f"{dim}_count"] > 0]).size
        # if most impacts of the sample have different modes, each is taken to have its own
        once += sizes.pop(dim) if tables < 0.5 * count else 0.0
    history = sum(sizes.values()) / count
    return Size(own + history, history, rows, once, {name: array[:100_000].copy() for name, array in columns.items()})


def packed(columns: Columns, suffix: str) -> int:
    """Bytes of the columns as netCDF files or Zarr folders compress them."""
    arrays = [np.ascontiguousarray(array) for array in columns.values() if array.size]
    if suffix == ZARR:
        from numcodecs import Blosc  # lazy: zarr has it, an optional dependency

        codec = Blosc(cname="lz4", clevel=5, shuffle=Blosc.SHUFFLE)
        return sum(len(codec.encode(array)) for array in arrays)
    return sum(len(zlib.compress(a.view(np.uint8).reshape(a.size, -1).T.tobytes(), 1)) for a in arrays)
