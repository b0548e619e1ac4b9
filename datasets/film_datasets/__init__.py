"""Impacts as labelled datasets (xarray, CF 1.11) in netCDF and Zarr: histories, sweeps, measurements, cost studies.

A public name is imported when it is first used, with what it needs; so is xarray.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_datasets.registration import register_accessor
from film_model.base.late import late_names

if TYPE_CHECKING:
    from film_datasets.accessor import Film as Film
    from film_datasets.checking import check as check
    from film_datasets.conversion import to_dataset as to_dataset
    from film_datasets.csv_measurement import from_csv as from_csv
    from film_datasets.dataset_plots import plot as plot
    from film_datasets.files import convert as convert
    from film_datasets.files import open_dataset
    from film_datasets.files import read as read
    from film_datasets.files import write as write
    from film_datasets.history_dataset import history_of as history_of
    from film_datasets.history_dataset import lines_of as lines_of
    from film_datasets.identification import Identification as Identification
    from film_datasets.identification import IdentifiedForce as IdentifiedForce
    from film_datasets.identification import compare_laws as compare_laws
    from film_datasets.identification import identify as identify
    from film_datasets.identification import identify_force as identify_force
    from film_datasets.identification import log_likelihood as log_likelihood
    from film_datasets.published_data import load as load
    from film_datasets.published_data import published as published
    from film_datasets.reference_impacts.score import Score as Score
    from film_datasets.reference_impacts.score import score as score
    from film_datasets.reference_impacts.suite import write_suite as write_suite
    from film_datasets.schema import TABLE as TABLE
    from film_datasets.schema import VERSIONS as VERSIONS
    from film_datasets.schema import Variable as Variable
    from film_datasets.schema import content_sha256 as content_sha256
    from film_datasets.schema import validate as validate
    from film_datasets.score_plot import plot_scores as plot_scores
    from film_datasets.sweeps import sweep as sweep
    from film_datasets.tables import to_frame as to_frame
    from film_datasets.tolerances import Tolerance as Tolerance
    from film_datasets.tolerances import tolerance as tolerance
    from film_datasets.tornado_plot import plot_tornado as plot_tornado

    open = open_dataset

register_accessor()

__getattr__ = late_names(
    __name__,
    {
        "accessor": ("Film",),
        "checking": ("check",),
        "conversion": ("to_dataset",),
        "csv_measurement": ("from_csv",),
        "dataset_plots": ("plot",),
        "files": ("convert", "open_dataset as open", "read", "write"),
        "history_dataset": ("history_of", "lines_of"),
        "identification": ("Identification", "compare_laws", "identify", "log_likelihood"),
        "identification.contact_force": ("IdentifiedForce", "identify_force"),
        "published_data": ("load", "published"),
        "reference_impacts.score": ("Score", "score"),
        "reference_impacts.suite": ("write_suite",),
        "schema": ("TABLE", "VERSIONS", "Variable", "content_sha256", "validate"),
        "score_plot": ("plot_scores",),
        "sweeps": ("sweep",),
        "tables": ("to_frame",),
        "tolerances": ("Tolerance", "tolerance"),
        "tornado_plot": ("plot_tornado",),
    },
)


def __dir__() -> list[str]:
    return sorted(__getattr__("__all__"))
