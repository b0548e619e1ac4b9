"""to_dataset: what film_model computed, as a dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

from film_datasets.bounce_dataset import bounce_dataset
from film_datasets.cost_dataset import cost_dataset
from film_datasets.history_dataset import SAMPLES, history_dataset
from film_model.solve.bounce import Bounces
from film_model.solve.history import History
from film_model.studies.cost import Study

if TYPE_CHECKING:
    import xarray as xr


def to_dataset(
    result: History | Bounces | Study, samples: int = SAMPLES, command: str = "film_datasets.to_dataset"
) -> xr.Dataset:
    """A history, bounces or a cost study as an xarray.Dataset with the variables of `TABLE`, in SI, with CF 1.11
    attributes.

    samples: of a history, the number of evenly spaced times from first touch to the last event, both included; the
    exact times of all events are added to them. command: the function or command that made the dataset, for the
    attribute `history`. Raises ValueError for fewer than 2 samples.

    >>> ds = fd.to_dataset(fm.simulate(scene))
    >>> ds.maximum_force.units
    'N'
    """
    if isinstance(result, History):
        return history_dataset(result, samples, command)
    if isinstance(result, Bounces):
        return bounce_dataset(result)
    if isinstance(result, Study):  # pyright: ignore[reportUnnecessaryIsInstance]
        return cost_dataset(result)
    raise TypeError(f"a History, Bounces or a Study becomes a dataset, not a {type(result).__name__}")
