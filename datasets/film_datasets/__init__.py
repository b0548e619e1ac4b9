"""Impacts as labelled datasets (xarray, CF 1.11) in netCDF and Zarr: histories, sweeps, measurements, cost studies.

A public name is imported when it is first used, with what it needs; so is xarray.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from film_datasets.registration import register_accessor

if TYPE_CHECKING:
    from film_datasets.accessor import Film
    from film_datasets.checking import check
    from film_datasets.conversion import to_dataset
    from film_datasets.csv_measurement import from_csv
    from film_datasets.dataset_plots import plot
    from film_datasets.files import convert, read, write
    from film_datasets.files import open_dataset as open
    from film_datasets.history_dataset import history_of, lines_of
    from film_datasets.identification import (
        Identification,
        IdentifiedForce,
        compare_laws,
        identify,
        identify_force,
        log_likelihood,
    )
    from film_datasets.published_data import load, published
    from film_datasets.reference_impacts.score import Score, score
    from film_datasets.reference_impacts.suite import write_suite
    from film_datasets.schema import TABLE, VERSIONS, Variable, content_sha256, validate
    from film_datasets.score_plot import plot_scores
    from film_datasets.sweeps import sweep
    from film_datasets.tables import to_frame
    from film_datasets.tolerances import Tolerance, tolerance
    from film_datasets.tornado_plot import plot_tornado

register_accessor()

__all__ = [
    "TABLE",
    "VERSIONS",
    "Film",
    "Identification",
    "IdentifiedForce",
    "Score",
    "Tolerance",
    "Variable",
    "check",
    "compare_laws",
    "content_sha256",
    "convert",
    "from_csv",
    "history_of",
    "identify",
    "identify_force",
    "lines_of",
    "load",
    "log_likelihood",
    "open",
    "plot",
    "plot_scores",
    "plot_tornado",
    "published",
    "read",
    "score",
    "sweep",
    "to_dataset",
    "to_frame",
    "tolerance",
    "validate",
    "write",
    "write_suite",
]

_MODULES = {
    "accessor": ("Film",),
    "checking": ("check",),
    "conversion": ("to_dataset",),
    "csv_measurement": ("from_csv",),
    "dataset_plots": ("plot",),
    "files": ("convert", "open_dataset", "read", "write"),
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
}
"""The public names by the modules that have them."""


def __getattr__(name: str) -> Any:
    """A public name, or a module of this package such as `film_datasets.sweeps`."""
    own = "open_dataset" if name == "open" else name
    module = next((module for module, names in _MODULES.items() if name in __all__ and own in names), None)
    if module is not None:
        globals()[name] = found = getattr(import_module(f"{__name__}.{module}"), own)
        return found
    if name.startswith("_") or find_spec(f"{__name__}.{name}") is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")


def __dir__() -> list[str]:
    without = {"Any", "TYPE_CHECKING", "annotations", "find_spec", "import_module"}
    return sorted({*__all__, *globals()} - without)
