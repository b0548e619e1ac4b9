"""The attribute metadata_sha256: a hash of what describes the values, as `content_sha256` is one of the values."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from film_datasets.schema import holds_text
from film_model.base.foreign import Dataset

if TYPE_CHECKING:
    from film_datasets.contents import Contents

SEAL = "metadata_sha256"

ROOT = "zarr.json"

STORAGE = {"coordinates", "_FillValue"}
"""Attributes of variables that xarray takes out when it reads them."""


def sealed(contents: Dataset | Contents) -> dict[str, Any]:
    """The global attributes of a dataset that is written to netCDF, with its seal."""
    described = [(str(name), one.dims, one.shape, one, one.attrs) for name, one in contents.variables.items()]
    return netcdf_attributes(described, contents.attrs)


def netcdf_attributes(
    variables: Iterable[tuple[str, Iterable[Any], Iterable[int], Any, Mapping[Any, Any]]], attrs: Mapping[Any, Any]
) -> dict[str, Any]:
    """Global attributes with their seal: SHA-256 over them and over name, dimensions, shape, type and attributes of
    every variable. variables: these, the type by anything that has a `dtype`."""
    kept = {str(key): value for key, value in attrs.items() if key != SEAL}
    described = {
        name: [[*dims], [*shape], "text" if holds_text(one) else one.dtype.name, _plain(own)]
        for name, dims, shape, one, own in variables
    }
    text = json.dumps([_plain(kept), described], sort_keys=True)
    return {**kept, SEAL: hashlib.sha256(text.encode()).hexdigest()}


def seal_store(store: Path) -> None:
    """Add the seal to a finished Zarr folder: see `_store_sha256`."""
    root = _root(store)
    root["attributes"][SEAL] = _store_sha256(store)
    (store / ROOT).write_text(json.dumps(root, indent=2), "utf-8")


def check_seal(ds: Dataset, source: Path) -> None:
    """Raise OSError if what describes the values of `ds`, read from `source`, is not what was sealed; take the seal out
    of its attributes, because it is that of the file. Files of earlier versions have none."""
    seal = ds.attrs.pop(SEAL, None)
    if seal is None:
        return
    good = _store_sha256(source) if source.is_dir() else sealed(ds)[SEAL]
    if seal != good:
        what = "the metadata or the number of chunks" if source.is_dir() else "names, dimensions or attributes"
        raise OSError(f"{SEAL} does not match {what}; remove it if another program has changed them on purpose")


def _store_sha256(store: Path) -> str:
    """SHA-256 over every zarr.json of a Zarr folder, without the seal itself, and the number of chunks beside it."""
    root, digest = _root(store), hashlib.sha256()
    root["attributes"].pop(SEAL, None)
    digest.update(json.dumps(root, sort_keys=True).encode())
    for array in sorted(file.parent for file in store.glob(f"*/{ROOT}")):
        chunks = sum(file.is_file() for file in array.joinpath("c").rglob("*")) + array.joinpath("c").is_file()
        digest.update(f"{array.name} {chunks} ".encode() + (array / ROOT).read_bytes())
    return digest.hexdigest()


def _root(store: Path) -> dict[str, Any]:
    return json.loads((store / ROOT).read_text("utf-8"))


def _plain(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    """Attributes as they are after writing and reading: a list of one value is a number."""
    return {str(k): np.atleast_1d(value).tolist() for k, value in attributes.items() if k not in STORAGE}
