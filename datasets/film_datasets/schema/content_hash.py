"""The attribute content_sha256: one hash of all values of a dataset, computed in pieces."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from film_datasets.schema.tables import require, variables_of
from film_datasets.schema.variable import Variable
from film_model.base.foreign import DataArray, Dataset

PIECE = 1 << 20
"""Values that are read from a file at a time."""


class ContentHash:
    """SHA-256 of a dataset's content, updated piece by piece: see `content_sha256`."""

    def __init__(self, variables: Sequence[Variable]) -> None:
        self._dtypes = {v.name: v.dtype.newbyteorder("<") for v in variables}
        self._digests = {v.name: hashlib.sha256() for v in variables}

    def update(self, name: str, values: Any) -> None:
        """Add the next values of a variable, in C order."""
        if self._dtypes[name].kind == "U":
            self._digests[name].update("".join(f"{word}\n" for word in np.ravel(values)).encode())
        else:
            self._digests[name].update(np.ascontiguousarray(values, self._dtypes[name]).data)

    def hexdigest(self) -> str:
        """The hash of the values added so far."""
        total = hashlib.sha256()
        for name, digest in self._digests.items():
            total.update(name.encode() + digest.digest())
        return total.hexdigest()


def pieces(array: DataArray) -> Iterator[Any]:
    """The values of a variable in C order, about `PIECE` at a time."""
    if array.ndim == 0 or array.size <= PIECE:
        yield array.values
        return
    step = max(1, PIECE * array.shape[0] // array.size)
    for first in range(0, array.shape[0], step):
        piece = array[first : first + step]
        if step == 1 and piece.size > PIECE:
            yield from pieces(piece[0])
        else:
            yield piece.values


def content_sha256(ds: Dataset) -> str:
    """SHA-256 over name and SHA-256 of every variable of the schema, in its order; numbers as little-endian bytes,
    texts as lines in UTF-8. Raises ValueError if one is missing.

    >>> ds = fd.load("zener")
    >>> fd.content_sha256(ds) == ds.attrs["content_sha256"]
    True
    """
    variables = variables_of(ds)
    require(ds, (variable.name for variable in variables))
    content = ContentHash(variables)
    for variable in variables:
        for piece in pieces(ds[variable.name]):
            content.update(variable.name, piece)
    return content.hexdigest()
