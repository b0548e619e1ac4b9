"""HDF5 files, as netCDF-4 files are: whether they can be given to the netCDF library."""

from __future__ import annotations

import os
from typing import Any

from film_model.base.errors import shown

FILTERS = {1, 2, 3}
"""HDF5's numbers of the filters that a file may need: deflate, shuffle and Fletcher-32. Others are plugins, which the
library would load from a folder."""

AN_FMU = 'is an FMU: "film-model check-fmu" reads it'

NO_DATASETS = {
    ".toml": 'is a scene or a sweep, no dataset: "film-model run" and "film-model sweep" read it',
    ".fmu": AN_FMU,
}
"""Files that are given in place of a dataset."""


def check_hdf5(source: str | os.PathLike[str]) -> None:
    """ValueError for an HDF5 file with groups or content in other files, that needs other filters, that another program
    writes, or whose attributes are damaged: the netCDF library follows links, also in groups, where they may lead round
    without end, and may end the process for damaged attributes."""
    import h5py  # lazy: only files need it

    other = NO_DATASETS.get(os.path.splitext(source)[1].lower())
    if other:
        raise ValueError(other)
    if os.path.getsize(source) == 0:
        raise ValueError("is empty")
    try:
        if not h5py.is_hdf5(source):
            return  # classic netCDF, or for the netCDF library to refuse
        with h5py.File(source, "r") as file:
            dict(file.attrs)
            wrong = [_foreign(file, str(name), h5py) for name in file]
    except BlockingIOError:
        raise ValueError("another program has it open for writing") from None
    except Exception as error:  # h5py has no common class
        raise ValueError(f"is not a netCDF file, or is damaged ({error})") from error
    for message in filter(None, wrong):
        raise ValueError(message)


def _foreign(file: Any, name: str, h5py: Any) -> str:
    """What is not the file's own in one of its entries."""
    if not isinstance(file.get(name, getlink=True), h5py.HardLink):
        return f"{shown(name)} is in another file, which is not read"
    entry = file[name]
    dict(entry.attrs)
    if isinstance(entry, h5py.Group):
        return f"{shown(name)} is a group: only variables at the top are read"
    if not isinstance(entry, h5py.Dataset):
        return ""
    if entry.is_virtual or entry.external:
        return f"{shown(name)} is in another file, which is not read"
    chain = entry.id.get_create_plist()
    unknown = {chain.get_filter(k)[0] for k in range(chain.get_nfilters())} - FILTERS
    return f"{shown(name)} needs filter {min(unknown)}, which is not allowed" if unknown else ""
