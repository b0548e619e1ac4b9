"""Impacts as labelled datasets (xarray, CF 1.11) in netCDF and Zarr: histories, sweeps, measurements, cost studies.

xarray takes longer to import than all of this package: functions that make datasets import it when they are called.
"""

from film_datasets.accessor import Film
from film_datasets.conversion import to_dataset
from film_datasets.csv_measurement import from_csv
from film_datasets.dataset_plots import plot
from film_datasets.file_conversion import convert
from film_datasets.files import open_dataset as open
from film_datasets.files import read, write
from film_datasets.history_dataset import history_of, lines_of
from film_datasets.identification import Identification, compare_laws, identify
from film_datasets.published import load, published
from film_datasets.registration import register_accessor
from film_datasets.schema import TABLE, VERSIONS, Variable, content_sha256, validate
from film_datasets.sweeps import sweep
from film_datasets.tables import to_frame
from film_datasets.tolerance import Tolerance, tolerance
from film_datasets.tornado_plot import plot_tornado

register_accessor()

__all__ = [
    "TABLE",
    "VERSIONS",
    "Film",
    "Identification",
    "Tolerance",
    "Variable",
    "compare_laws",
    "content_sha256",
    "convert",
    "from_csv",
    "history_of",
    "identify",
    "lines_of",
    "load",
    "open",
    "plot",
    "plot_tornado",
    "published",
    "read",
    "sweep",
    "to_dataset",
    "to_frame",
    "tolerance",
    "validate",
    "write",
]
