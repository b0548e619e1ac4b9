"""Impacts as labelled datasets (xarray, CF 1.11): histories and sweeps, in netCDF and Zarr."""

from film_datasets.accessor import Film
from film_datasets.files import open_dataset as open
from film_datasets.files import read, write
from film_datasets.history import history_of, lines_of, to_dataset
from film_datasets.identification import Identification, identify
from film_datasets.measured import from_csv
from film_datasets.pictures import plot
from film_datasets.published import load, published
from film_datasets.run import sweep
from film_datasets.schema import TABLE, VERSIONS, Variable, content_sha256, validate

__all__ = [
    "TABLE",
    "VERSIONS",
    "Film",
    "Identification",
    "Variable",
    "content_sha256",
    "from_csv",
    "history_of",
    "identify",
    "lines_of",
    "load",
    "open",
    "plot",
    "published",
    "read",
    "sweep",
    "to_dataset",
    "validate",
    "write",
]
