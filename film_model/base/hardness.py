"""Hardness numbers: HV, HB (HBW) and HRC, read as the mean contact pressure over the projected area, Pa.

Vickers: load over the area of the facets, 1 HV = 9.80665 MPa; the projected area is 0.927 (sin 68°) of it. Brinell and
Rockwell C by tables of ISO 18265 (annex A, unalloyed and low-alloy steels), ±5 %: ±2 HRC or ±20 HV are common between
steels of one number. For other metals give HV: Brinell numbers of aluminium with 500 kgf, for instance, are about 13 %
below HV instead of 5 %.
"""

from __future__ import annotations

import re

import numpy as np

from film_model.base.errors import shown
from film_model.base.fields import Field, measure
from film_model.base.units import to_si

VICKERS = 9.80665e6 / 0.927
"""Mean pressure over the projected area of 1 HV, Pa."""

_ROCKWELL_C = (
    *(20.0, 22.2, 24.0, 25.6, 27.1, 28.5, 29.8, 31.0, 32.2, 33.3, 34.4, 35.5, 36.6, 37.7, 38.8, 39.8, 40.8, 41.8),
    *(42.7, 43.6, 44.5, 45.3, 46.1, 46.9, 47.7, 48.4, 49.1, 49.8, 50.5, 51.1, 51.7, 52.3, 53.0, 53.6, 54.1, 54.7),
    *(55.2, 55.7, 56.3, 56.8, 57.3, 57.8, 58.3, 58.8, 59.2, 59.7, 60.1, 61.0, 61.8, 62.5, 63.3, 64.0, 64.7, 65.3),
    *(65.9, 66.4, 67.0, 67.5, 68.0),
)
_VICKERS = (238, *range(250, 300, 10), *range(300, 700, 10), *range(700, 941, 20))
"""HRC and HV of the same steels, ISO 18265, table A.1; the first pair from ASTM E140, table 1."""

_NEEDED = 'a hardness is needed (e.g. "600 HV", "200 HB", "60 HRC", or a pressure such as "6 GPa")'
_NUMBER = re.compile(r"\s*([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)\s*(H[A-Za-z]*)\s*(?:[0-9./]*)\s*")
_RANGE = measure("pressure", 1e6, 1e12)
_SCALES = {"HV": (1.0, 1e4), "HB": (1.0, 700.0), "HRC": (20.0, 68.0)}


def vickers_of_rockwell(rockwell: float) -> float:
    """HV of a steel of 20 to 68 HRC, linear between the rows of the table."""
    return float(np.interp(rockwell, _ROCKWELL_C, _VICKERS))


def _read(value: object) -> float:
    found = _NUMBER.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        try:
            return _RANGE.read(value)
        except ValueError as error:
            raise ValueError(str(error).replace(_RANGE.need, _NEEDED)) from None
    number, scale = _scaled(found, shown(value))
    low, high = _SCALES[scale]
    if not low <= number <= high:
        raise ValueError(f"{shown(value)} is out of range: from {low:g} to {high:g} {scale}")
    return VICKERS * (vickers_of_rockwell(number) if scale == "HRC" else _vickers(number, scale))


def _read_width(value: object) -> float:
    """A difference of two hardnesses, such as a standard deviation, Pa."""
    found = _NUMBER.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        return to_si(value, "pressure")
    number, scale = _scaled(found, shown(value))
    if scale == "HRC":
        raise ValueError(f"{shown(value)} is a difference on a scale that is not linear: give it in HV")
    return VICKERS * _vickers(number, scale)


def _scaled(found: re.Match[str], text: str) -> tuple[float, str]:
    """The number and the scale of a hardness."""
    scale = "HB" if found[2] == "HBW" else found[2]
    if scale not in _SCALES:
        raise ValueError(f"{text} has an unknown hardness scale, {_NEEDED}")
    try:
        return float(found[1]), scale
    except ValueError:
        raise ValueError(f"{text} is not a number with a hardness scale, {_NEEDED}") from None


def _vickers(number: float, scale: str) -> float:
    # HB/HV = 0.95 in ISO 18265, table A.1, from 76 to 618 HB; rounding aside, constant
    return number if scale == "HV" else number / 0.95


HARDNESS = Field(_read, _NEEDED, False, "pressure", _RANGE.low, _RANGE.high, width=_read_width)
