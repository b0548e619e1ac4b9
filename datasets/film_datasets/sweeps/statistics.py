"""A sweep in a few numbers: how many impacts ended how, and the statistics of every summary quantity."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from film_datasets.provenance import warnings_of
from film_datasets.schema import RAGGED, flag_meanings, has_failed, pieces, require_impacts
from film_model.base.foreign import DataArray, Dataset
from film_model.base.units import si_unit
from film_model.oblique.result import RESULTS
from film_model.solve.history import SUMMARY


def sweep_report(ds: Dataset) -> dict[str, Any]:
    """Plain values for JSON, SI: numbers of impacts, failed and by status, the statistics of the summary, and the size
    of the segments before compression, if they are kept.

    Statistics, and the estimated accuracy, are None if no impact has a value. The dataset is read in pieces.
    """
    require_impacts(ds)
    status = ds["status"]
    words = dict(zip(np.atleast_1d(status.attrs["flag_values"]).tolist(), flag_meanings(status), strict=True))
    counts: dict[int, int] = {}
    for piece in pieces(status):
        for code, count in zip(*np.unique(piece, return_counts=True), strict=True):
            counts[int(code)] = counts.get(int(code), 0) + int(count)
    failed = sum(count for code, count in counts.items() if has_failed(np.array(code)))
    kept = [array for array in ds.variables.values() if array.dims[:1] and array.dims[0] in RAGGED]
    size = sum(array.nbytes for array in kept)
    segments = {"bytes": size, "bytes_per_impact": size / status.size} if kept else None
    return {
        "title": str(ds.attrs["title"]),
        "impacts": int(status.size),
        "failed": failed,
        "statuses": {words[code]: counts[code] for code in sorted(counts, key=lambda code: -counts[code])},
        "summary": {
            name: {**statistics(ds[name]), "units": si_unit(dimension)}
            for name, (dimension, _) in (SUMMARY | RESULTS).items()
            if name in ds
        },
        "accuracy": {
            "requested": float(ds.attrs["requested_accuracy"]) if "requested_accuracy" in ds.attrs else None,
            "estimated": float(ds.attrs["estimated_accuracy"]) if failed < status.size else None,
        },
        **({} if segments is None else {"segments": segments}),
        "warnings": list(warnings_of(ds)),
    }


def statistics(array: DataArray) -> dict[str, float | int | None]:
    """Count, least, mean, standard deviation (of the sample) and greatest of the finite values."""
    count, mean, square, least, greatest = 0, 0.0, 0.0, math.inf, -math.inf
    for piece in pieces(array):
        values = np.asarray(piece, np.float64)
        values = values[np.isfinite(values)]
        if values.size:
            # pieces are merged by the formula of Chan, Golub and LeVeque (1983), which avoids cancellation
            piece_mean, total = float(values.mean()), count + values.size
            square += float(((values - piece_mean) ** 2).sum()) + (piece_mean - mean) ** 2 * count * values.size / total
            mean += (piece_mean - mean) * values.size / total
            count, least, greatest = total, min(least, float(values.min())), max(greatest, float(values.max()))
    if not count:
        return {"count": 0, "least": None, "mean": None, "standard_deviation": None, "greatest": None}
    deviation = math.sqrt(square / (count - 1)) if count > 1 else None
    return {"count": count, "least": least, "mean": mean, "standard_deviation": deviation, "greatest": greatest}
