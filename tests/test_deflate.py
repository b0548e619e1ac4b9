"""Chunks that are deflated by the workers are what HDF5's filters undo."""

import zlib

import numpy as np
import pytest

from film_datasets.sweeps.block_writers import deflated

RNG = np.random.default_rng(3)
COLUMNS = {
    "smooth": np.geomspace(0.1, 5.0, 9000) ** 1.2,
    "noise": RNG.uniform(size=9000),
    "one": np.array([1.5]),
    "bytes": np.arange(100, dtype=np.int8),
    "constant": np.full(9000, np.nan),
    "two dimensions": RNG.uniform(size=(30, 201)),
}


@pytest.mark.parametrize("column", COLUMNS.values(), ids=COLUMNS)
def test_a_chunk_is_an_ordinary_zlib_stream_of_shuffled_bytes(column):
    undone = np.frombuffer(zlib.decompress(deflated(column)), np.uint8).reshape(column.itemsize, -1)
    assert np.ascontiguousarray(undone.T).view(column.dtype).tobytes() == column.tobytes()


def test_noise_is_stored_and_what_shrinks_is_deflated():
    """At most 10 % larger than with all bytes deflated; values that recur shrink to less than a tenth."""
    for name in ("smooth", "noise", "constant"):
        shuffled = np.ascontiguousarray(COLUMNS[name].view(np.uint8).reshape(-1, 8).T)
        assert len(deflated(COLUMNS[name])) < 1.1 * len(zlib.compress(shuffled, 1)) + 50
    recurring = np.tile(RNG.uniform(size=300), 100)
    assert len(deflated(recurring)) < 0.1 * recurring.nbytes
