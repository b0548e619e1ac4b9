"""Histories of impacts as labelled datasets (xarray, CF 1.11) and netCDF files."""

from film_datasets.files import read, write
from film_datasets.history import lines_of, to_dataset
from film_datasets.schema import SCHEMA_NAME, SCHEMA_VERSION, VARIABLES, Variable, content_sha256, validate

__all__ = [
    "SCHEMA_NAME",
    "SCHEMA_VERSION",
    "VARIABLES",
    "Variable",
    "content_sha256",
    "lines_of",
    "read",
    "to_dataset",
    "validate",
    "write",
]
