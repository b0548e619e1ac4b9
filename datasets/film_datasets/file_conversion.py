"""convert: a dataset or a measurement in one file, written in another format."""

from __future__ import annotations

import os
import warnings
from pathlib import Path

from film_datasets.csv_measurement import from_csv
from film_datasets.files import NEEDS_ZARR, WRITTEN, ZARR, check_place, open_dataset, write
from film_datasets.sweeps.block_writers import put_in_place, temporary_path
from film_datasets.tables import left_out


def convert(source: str | os.PathLike[str], target: str | os.PathLike[str], overwrite: bool = False) -> list[str]:
    """Write the dataset in a netCDF file or Zarr folder, or the measurement in a CSV file, in the format of `target`.

    target: FILE.nc, .zarr, .csv, .parquet or .mat. Returns what the new file lacks. Raises what `write` raises.

    >>> ds = fd.sweep(scene, {"impactor.velocity": ["1 m/s", "2 m/s"]}, output="two.nc")
    >>> fd.convert("two.nc", "two.csv")
    []
    """
    given, wanted = Path(source), Path(target)
    if wanted.suffix not in (*WRITTEN, ZARR):
        raise ValueError(f"{wanted}: its name must end in {', '.join(WRITTEN)} or {ZARR}")
    check_place(wanted, overwrite)
    if given.suffix == ".csv":
        write(from_csv(given), wanted, overwrite)
        return []
    with open_dataset(given) as ds:
        if wanted.suffix != ZARR:
            write(ds, wanted, overwrite)
            return left_out(ds) if wanted.suffix != ".nc" else []
        beside = temporary_path(wanted)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # consolidated metadata and texts are not yet in the specification
                ds.drop_encoding().to_zarr(beside, mode="w", zarr_format=3, consolidated=True)
        except ImportError as error:
            raise ImportError(f"{wanted}: {NEEDS_ZARR}") from error
    put_in_place(beside, wanted)
    return []
