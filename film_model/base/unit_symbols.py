"""Unit symbols such as "kN", "kg/m^3" or "N/mm^1.5", in terms of kilogram, metre and second."""

from __future__ import annotations

import re
from decimal import Decimal
from functools import lru_cache
from typing import Any, Protocol, TypeAlias, cast

from film_model.base.errors import shown

Powers: TypeAlias = tuple[float, float, float]
"""Powers of mass, length and time."""


class QuantityLike(Protocol):
    """The part of a pint quantity that this package uses."""

    @property
    def magnitude(self) -> Any: ...
    @property
    def units(self) -> Any: ...
    @property
    def dimensionality(self) -> Any: ...


_SYMBOLS: tuple[tuple[Powers, str], ...] = (
    ((0, 1, 0), "m 1, nm 1e-9, um 1e-6, mm 1e-3, cm 1e-2, km 1e3, in 0.0254, ft 0.3048"),
    ((1, 0, 0), "kg 1, ug 1e-9, mg 1e-6, g 1e-3, t 1e3, lb 0.45359237"),
    ((0, 0, 1), "s 1, ns 1e-9, us 1e-6, ms 1e-3, min 60, h 3600"),
    ((0, 0, -1), "Hz 1, kHz 1e3, MHz 1e6, rpm 0.10471975511965977462"),
    ((0, 1, -1), "mph 0.44704"),
    ((1, 1, -2), "N 1, pN 1e-12, nN 1e-9, uN 1e-6, mN 1e-3, kN 1e3, MN 1e6, GN 1e9, lbf 4.4482216152605"),
    ((1, -1, -2), "Pa 1, kPa 1e3, MPa 1e6, GPa 1e9, TPa 1e12, bar 1e5, psi 6894.757293168361, ksi 6894757.293168361"),
    ((1, 2, -2), "J 1, nJ 1e-9, uJ 1e-6, mJ 1e-3, kJ 1e3"),
    ((1, 2, -3), "W 1, mW 1e-3, kW 1e3"),
    ((0, 0, 0), "rad 1, deg 0.01745329251994329577"),
)
SYMBOLS: dict[str, tuple[Decimal, Powers]] = {
    symbol: (Decimal(factor), powers)
    for powers, row in _SYMBOLS
    for symbol, factor in (entry.split() for entry in row.split(", "))
}
"""Symbol → its size in SI units and its powers of mass, length and time. mPa is omitted: usually MPa is meant."""

_MILLIPASCAL_SECOND = re.compile(r"mPa\s*[* ]\s*s")
"""The usual unit of viscosities, in which mPa is meant."""

_WORDS = [
    f"{prefix}{unit}{plural}"
    for unit in ("meter", "metre", "gram", "second", "newton", "pascal", "joule")
    for prefix in ("", "milli", "micro", "nano", "centi", "kilo", "mega", "giga")
    for plural in ("", "s")
]
"""Names of units, for hints about misspelt ones."""

_FACTOR = re.compile(r"([A-Za-z_]+)(?:(?:\^|\*\*)?([+-]?[0-9]{1,3}(?:\.[0-9]{1,17})?))?")
_SEPARATOR = re.compile(r"\s*[*/]\s*|\s+")
_INVERSE = re.compile(r"1?\s*/\s*")
_BASE = {"[mass]": "kilogram", "[length]": "meter", "[time]": "second"}


@lru_cache(maxsize=256)
def parse_unit(unit: str) -> tuple[Decimal, Powers]:
    """Size in SI units, and powers, of a unit such as "kg/m^3", "N*s/m", "kg m-3" or "1/s"."""
    if _MILLIPASCAL_SECOND.fullmatch(unit):
        return Decimal("1e-3"), (1, -1, -1)
    size, powers, sign, end = Decimal(1), [0.0, 0.0, 0.0], 1, 0
    if inverse := _INVERSE.match(unit):
        sign, end = -1, inverse.end()
    while True:
        match = _FACTOR.match(unit, end)
        if match is None:
            raise ValueError(f"no unit reads {shown(unit)}")
        factor, of_word = SYMBOLS.get(match[1]) or _from_pint(match[1])
        power = sign * Decimal(match[2] or 1)
        size *= factor**power
        powers = [p + float(power) * w for p, w in zip(powers, of_word, strict=True)]
        end = match.end()
        if end == len(unit):
            mass, length, time = map(rounded, powers)
            return size, (mass, length, time)
        separator = _SEPARATOR.match(unit, end)
        if separator is None or (sign < 0 and not separator[0].strip()):  # "kg/m s" is ambiguous
            raise ValueError(f"no unit reads {shown(unit)}; write it with * and /")
        sign, end = (-1 if "/" in separator[0] else 1), separator.end()


def _from_pint(word: str) -> tuple[Decimal, Powers]:
    if len(word) < 4:  # pint reads shorter misspelt words as other units
        raise ValueError(f'no unit is called "{word}"' + _hint(word))
    import pint

    registry = pint.get_application_registry()
    try:
        unit: QuantityLike = registry.Quantity(1.0, word)
        powers = quantity_powers(unit)
        return unit_size(unit, powers), powers
    except Exception:  # pint's parser raises many kinds
        raise ValueError(f'no unit of mass, length and time is called "{word}"' + _hint(word)) from None


def _hint(word: str) -> str:
    import difflib

    cuts = [(word[:i], word[i:]) for i in range(1, len(word))]
    near = [f"{a}*{b}" for a, b in cuts if a in SYMBOLS and b in SYMBOLS and a != "m"]  # "mPa" is no m*Pa
    near += [symbol for symbol in SYMBOLS if symbol.lower() == word.lower()]
    near += difflib.get_close_matches(word.lower()[:40], _WORDS, n=1, cutoff=0.8)
    return f' (did you mean "{near[0]}"?)' if near else ""


def quantity_powers(quantity: QuantityLike) -> Powers:
    """The powers of mass, length and time of a pint quantity; ValueError for other dimensions."""
    found: dict[str, float] = dict(quantity.dimensionality)
    if set(found) - set(_BASE):
        raise ValueError("not a matter of mass, length and time")
    mass, length, time = (rounded(found.get(base, 0)) for base in _BASE)
    return mass, length, time


def unit_size(quantity: QuantityLike, powers: Powers) -> Decimal:
    """The quantity's unit in SI units; ValueError if it has an offset (degC) or is logarithmic (dB)."""
    target = "*".join(f"{word}**{power!r}" for word, power in zip(_BASE.values(), powers, strict=True))
    zero, one = (cast("Any", type(quantity))(x, quantity.units).to(target).magnitude for x in (0.0, 1.0))
    if zero != 0:
        raise ValueError("not a plain multiple of an SI unit")
    return Decimal(repr(float(one)))


def rounded(power: float) -> float:
    """A power without the rounding errors of sums such as 1 - 1.2."""
    return round(power, 9)
