"""What a sweep came to, in a few numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from film_datasets.schema import pieces
from film_model.history import SUMMARY
from film_model.units import si_unit


def sweep_report(ds: xr.Dataset) -> dict[str, Any]:
    """Plain values for JSON, SI: impacts by status, and least, mean, standard deviation and greatest of the summary.

    None where no impact has a value. The dataset is read in pieces.
    """
    status = ds["status"]
    words = dict(
        zip(np.atleast_1d(status.attrs["flag_values"]).tolist(), status.attrs["flag_meanings"].split(), strict=True)
    )
    counts: dict[int, int] = {}
    for piece in pieces(status):
        for code, count in zip(*np.unique(piece, return_counts=True), strict=True):
            counts[int(code)] = counts.get(int(code), 0) + int(count)
    warnings = str(ds.attrs["warnings"])
    return {
        "title": str(ds.attrs["title"]),
        "impacts": int(status.size),
        "statuses": {words[code]: counts[code] for code in sorted(counts, key=lambda code: -counts[code])},
        "summary": {name: {**statistics(ds[name]), "units": si_unit(SUMMARY[name][0])} for name in SUMMARY},
        "accuracy": {
            "requested": _float(ds.attrs.get("requested_accuracy")),
            "estimated": float(ds.attrs["estimated_accuracy"]),
        },
        "warnings": [] if warnings == "none" else warnings.split("\n"),
    }


def statistics(array: xr.DataArray) -> dict[str, float | int | None]:
    """Count, least, mean, standard deviation (of the sample) and greatest of the values that are there."""
    count, mean, square, least, greatest = 0, 0.0, 0.0, math.inf, -math.inf
    for piece in pieces(array):
        values = np.asarray(piece, np.float64)
        values = values[np.isfinite(values)]
        if values.size:
            # pieces are merged by the formula of Chan, Golub and LeVeque (1983), which does not cancel
            own, total = float(values.mean()), count + values.size
            square += float(((values - own) ** 2).sum()) + (own - mean) ** 2 * count * values.size / total
            mean += (own - mean) * values.size / total
            count, least, greatest = total, min(least, float(values.min())), max(greatest, float(values.max()))
    if not count:
        return {"count": 0, "least": None, "mean": None, "standard_deviation": None, "greatest": None}
    deviation = math.sqrt(square / (count - 1)) if count > 1 else None
    return {"count": count, "least": least, "mean": mean, "standard_deviation": deviation, "greatest": greatest}


def _float(value: Any) -> float | None:
    return None if value is None else float(value)
