"""A sweep in numbers: percentiles, and which impact gave the least and the greatest value of each quantity."""

from __future__ import annotations

from typing import Any

import numpy as np

from film_datasets.schema import dimension_of, swept_name, words_of
from film_datasets.sweeps.statistics import sweep_report
from film_model.base.foreign import DataArray, Dataset
from film_model.base.units import format_si

PERCENTILES = (5, 25, 50, 75, 95)


def sweep_digest(ds: Dataset) -> dict[str, Any]:
    """As `sweep_report`; every quantity also has `percentiles`, and `least_at` and `greatest_at`: the impact's place
    along each dimension, and its swept values (SI, or words). One quantity at a time is in memory."""
    report = sweep_report(ds)
    swept = [swept_name(path) for path in str(ds.attrs["swept"]).split()]
    for name, row in report["summary"].items():
        array = ds[name]
        values = np.asarray(array.values, np.float64)
        known = values[np.isfinite(values)]
        found: list[Any] = [None] * len(PERCENTILES)
        row["least_at"] = row["greatest_at"] = None
        if known.size:
            found = np.quantile(known, np.array(PERCENTILES) / 100).tolist()
            row["least_at"] = _impact(ds, array, int(np.nanargmin(values)), swept)
            row["greatest_at"] = _impact(ds, array, int(np.nanargmax(values)), swept)
        row["percentiles"] = dict(zip(map(str, PERCENTILES), found, strict=True))
    return report


def _impact(ds: Dataset, array: DataArray, flat: int, swept: list[str]) -> dict[str, Any]:
    """Where an impact is, and its swept values."""
    places = np.unravel_index(flat, array.shape) if array.dims else ()
    at = {str(dim): int(place) for dim, place in zip(array.dims, places, strict=True)}
    one = ds[swept].isel(at)
    values = {name: (words_of(one[name]) or [float(one[name])])[0] for name in swept}
    return {"at": at, "values": values}


def digest_text(ds: Dataset, report: dict[str, Any], quantities: list[str]) -> str:
    """The report as text, for some of its quantities."""
    ended = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in report["statuses"].items())
    lines = [report["title"], f"{report['impacts']} impacts: {ended}; {len(report['warnings'])} warnings", ""]
    heads = ("mean", *(f"{p} %" for p in PERCENTILES))
    lines.append(f"  {'':30}" + "".join(f"{head:>13}" for head in heads))
    for name in quantities:
        row, dimension = report["summary"][name], dimension_of(ds[name])
        numbers = (row["mean"], *row["percentiles"].values())
        texts = ("-" if value is None else format_si(value, dimension, 4) for value in numbers)
        lines.append(f"  {name.replace('_', ' '):30}" + "".join(f"{text:>13}" for text in texts))
    lines.append("")
    for name in quantities:
        row, dimension = report["summary"][name], dimension_of(ds[name])
        for which in ("least", "greatest"):
            if row[which] is not None:
                where = ", ".join(
                    f"{key} {value if isinstance(value, str) else format_si(value, dimension_of(ds[key]), 5)}".strip()
                    for key, value in row[f"{which}_at"]["values"].items()
                )
                place = ", ".join(str(k) for k in row[f"{which}_at"]["at"].values())
                value = format_si(row[which], dimension, 4)
                lines.append(f"  {which} {name.replace('_', ' ')} {value}: impact {place} ({where})")
    return "\n".join(lines)
