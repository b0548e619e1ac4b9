"""to_dataset: what film_model computed, as a dataset."""

from __future__ import annotations

from film_datasets.bounce_dataset import bounce_dataset
from film_datasets.chain_dataset import chain_dataset
from film_datasets.cost_dataset import cost_dataset
from film_datasets.history_dataset import SAMPLES, history_dataset
from film_model.base.foreign import Dataset
from film_model.solve.bounce import Bounces
from film_model.solve.chain_motion import ChainMotion
from film_model.solve.history import History
from film_model.studies.cost import Study


def to_dataset(
    result: History | Bounces | ChainMotion | Study, samples: int = SAMPLES, command: str = "film_datasets.to_dataset"
) -> Dataset:
    """What film_model computed as an xarray.Dataset with the variables of `TABLE`, in SI, with CF 1.11 attributes.

    result: a history, bounces, a chain or a cost study. samples: of a history, the number of evenly spaced times from
    first touch to the last event, both included; the exact times of all events are added to them; of a chain, the
    number of times while forces act. command: the function or command that made the dataset, for the
    attribute `history`. Raises ValueError for fewer than 2 samples.

    >>> ds = fd.to_dataset(fm.simulate(scene))
    >>> ds.maximum_force.units
    'N'
    """
    if isinstance(result, History):
        return history_dataset(result, samples, command)
    if isinstance(result, Bounces):
        return bounce_dataset(result)
    if isinstance(result, ChainMotion):
        return chain_dataset(result, samples, command)
    if isinstance(result, Study):  # pyright: ignore[reportUnnecessaryIsInstance]
        return cost_dataset(result)
    raise TypeError(f"a History, Bounces, a ChainMotion or a Study becomes a dataset, not a {type(result).__name__}")
