"""convert: a dataset or a measurement in one file, written in another format."""

from __future__ import annotations

import os
from pathlib import Path

from film_datasets.csv_measurement import from_csv
from film_datasets.files import CHECKED_AT_ONCE, SUFFIX, ZARR, check_file, open_dataset, write
from film_datasets.schema.validation import damage
from film_datasets.tables import left_out


def convert(source: str | os.PathLike[str], target: str | os.PathLike[str], overwrite: bool = False) -> list[str]:
    """Write the dataset in a netCDF file or Zarr folder, or the measurement in a CSV file, in the format of `target`.

    target: FILE.nc, .zarr, .csv, .parquet or .mat. Returns what the new file lacks. Raises what `write` raises.

    >>> ds = fd.sweep(scene, {"impactor.velocity": ["1 m/s", "2 m/s"]}, output="two.nc")
    >>> fd.convert("two.nc", "two.csv")
    []
    """
    given, wanted = Path(source), Path(target)
    check_file(wanted, overwrite)
    if given.suffix == ".csv":
        write(from_csv(given), wanted, overwrite)
        return []
    with open_dataset(given) as ds:
        if ds.nbytes > CHECKED_AT_ONCE and (wrong := damage(ds)):
            raise OSError(f"{given}: is damaged ({'; '.join(wrong)})")
        write(ds, wanted, overwrite)
        return [] if wanted.suffix in (SUFFIX, ZARR) else left_out(ds)
