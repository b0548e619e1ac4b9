"""Reading and writing of units; no other module does it.

Texts and quantities are turned into SI floats here, once, and results into quantities. Scenes are read without
pint, which takes half a second to import, because `unit_symbols` has the symbols that they use. Longer words
("inches", "kilonewton") are looked up in pint's application registry.

Reading is strict, because pint's own parser misreads without an error: it takes "10,5 mm" for 105 mm, "−3 m"
(with U+2212) for +3 m, "5 mm ± 1 mm" for 5 mm², and "5 k" for Boltzmann's constant.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Callable, Iterable, Mapping
from decimal import Decimal
from functools import cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeGuard, cast

from film_model.base.arrays import Array
from film_model.base.errors import shown
from film_model.base.unit_symbols import Powers, QuantityLike, parse_unit, quantity_powers, rounded, unit_size

if TYPE_CHECKING:
    from numpy.typing import NDArray

Value: TypeAlias = str | QuantityLike
"""A dimensional argument: a text such as "10 mm", or a pint quantity."""


class Dimension(NamedTuple):
    """A dimension: its SI unit as UDUNITS and CF write it, its name in a sentence, and an example."""

    unit: str
    phrase: str
    example: str


DIMENSIONS: dict[str, Dimension] = {
    "length": Dimension("m", "a length", "10 mm"),
    "area": Dimension("m2", "an area", "80 mm^2"),
    "mass": Dimension("kg", "a mass", "60 g"),
    "time": Dimension("s", "a time", "20 us"),
    "velocity": Dimension("m s-1", "a velocity", "0.25 m/s"),
    "inverse_velocity": Dimension("s m-1", "an inverse velocity", "0.3 s/m"),
    "acceleration": Dimension("m s-2", "an acceleration", "9.81 m/s^2"),
    "frequency": Dimension("Hz", "a frequency", "10 kHz"),
    "angular_frequency": Dimension("rad s-1", "an angular frequency", "100 rad/s"),
    "angular_acceleration": Dimension("rad s-2", "an angular acceleration", "100 rad/s^2"),
    "rate": Dimension("s-1", "a rate", "100 s^-1"),
    "force": Dimension("N", "a force", "500 N"),
    "pressure": Dimension("Pa", "a pressure", "210 GPa"),
    "inverse_mass": Dimension("kg-1", "an inverse mass", "2 kg^-1"),
    "moment_of_inertia": Dimension("kg m2", "a moment of inertia", "2e-6 kg*m^2"),
    "density": Dimension("kg m-3", "a density", "7850 kg/m^3"),
    "mass_per_area": Dimension("kg m-2", "a mass per area", "4.1 kg/m^2"),
    "energy": Dimension("J", "an energy", "2 mJ"),
    "torque": Dimension("N m", "a torque", "0.1 N*m"),
    "bending_stiffness": Dimension("N m", "a bending stiffness", "150 N*m"),
    "stiffness": Dimension("N m-1", "a stiffness", "1e6 N/m"),
    "stiffness_per_length": Dimension("N m-2", "a stiffness per length", "2e6 N/m^2"),
    "stiffness_per_area": Dimension("N m-3", "a stiffness per area", "5e7 N/m^3"),
    "compliance": Dimension("m N-1", "a compliance", "2e-6 m/N"),
    "viscosity": Dimension("Pa s", "a viscosity", "1 mPa*s"),
    "surface_energy": Dimension("J m-2", "a surface energy", "0.1 J/m^2"),
    "fracture_toughness": Dimension("Pa m0.5", "a fracture toughness", "0.7 MPa*m^0.5"),
    "impedance": Dimension("N s m-1", "an impedance", "150 N*s/m"),
    "impulse": Dimension("N s", "an impulse", "0.03 N*s"),
    "power": Dimension("W", "a power", "1 W"),
    "dimensionless": Dimension("1", "a plain number", "0.3"),
    "angle": Dimension("rad", "an angle", "30 deg"),
}

_SPELLINGS = str.maketrans({"µ": "u", "μ": "u", "·": "*", "⋅": "*", "²": "^2", "³": "^3"})
_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)\s*(.*)", re.DOTALL)


def to_si(value: object, dimension: str, *, bare: bool = False) -> float:
    """`value` as a finite SI float.

    A text or a pint quantity of the right dimension; with `bare`, or for a dimensionless value, also a number.
    Anything else raises a ValueError that says what is needed.
    """
    return _convert(value, _powers(dimension), needed(dimension), bare or dimension == "dimensionless")


def power_stiffness_to_si(value: object, exponent: float) -> float:
    """The stiffness k of F = kδ^q in N/m^q, from a text such as "3e5 N/mm^1.5" or a pint quantity."""
    unit = power_stiffness_unit(exponent)
    return _convert(value, (1, rounded(1 - exponent), -2), f'{unit} is needed (e.g. "1e9 {unit}")', bare=False)


def power_stiffness_unit(exponent: float) -> str:
    """The SI unit of that stiffness as scene files write it, e.g. "N/m^1.5"; exponents have nine decimals."""
    return f"N/m^{exponent:.9f}".rstrip("0").rstrip(".")


def array_to_si(values: object, dimension: str, *, bare: bool = False) -> Array:
    """An array, a quantity that holds one, or a sequence of values, as finite SI floats."""
    import numpy as np

    if _is_quantity(values):
        size = _quantity_size(values, _powers(dimension), needed(dimension))
        array = _filled(values.magnitude) * float(size)
    elif isinstance(values, np.ndarray) and cast("NDArray[Any]", values).dtype.kind in "iuf":
        array = _filled(values)
        if not bare and dimension != "dimensionless":
            raise ValueError(f"an array without a unit, {needed(dimension)}")
    elif isinstance(values, Iterable) and not isinstance(values, str):
        return np.asarray([array_to_si(v, dimension, bare=bare) for v in cast("Iterable[object]", values)])
    else:
        return np.asarray(to_si(values, dimension, bare=bare), dtype=np.float64)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"an array with values that are not finite, {needed(dimension)}")
    return array


def _filled(values: Any) -> Array:
    """As floats; masked values become nan."""
    import numpy as np

    if isinstance(values, np.ma.MaskedArray):
        values = cast("Any", values).astype(np.float64).filled(np.nan)
    return np.asarray(values, dtype=np.float64)


def quantity(value: Any, dimension: str) -> Any:
    """SI `value`, a float or an array, as a quantity of pint's application registry."""
    import pint

    return pint.get_application_registry().Quantity(value, scene_unit(dimension))


class _WithUnits:
    """An attribute with units: what `read` finds in the object, SI, or None."""

    def __init__(self, dimension: str, meaning: str, read: Callable[[Any], Any]) -> None:
        self.dimension, self.__doc__, self.read = dimension, meaning, read

    def __get__(self, instance: object | None, owner: type) -> Any:
        value = None if instance is None else self.read(instance)
        return self if instance is None else None if value is None else quantity(value, self.dimension)


def add_quantities(owner: type, table: Mapping[str, tuple[str, str]], read: Callable[..., Any]) -> None:
    """Give a class attributes with units: name → dimension and meaning. read(object, name=…): a value, SI or None."""
    for name, (dimension, meaning) in table.items():
        setattr(owner, name, _WithUnits(dimension, meaning, partial(read, name=name)))


def si_unit(dimension: str) -> str:
    """The SI unit as UDUNITS and CF write it, e.g. "kg m-3"."""
    return DIMENSIONS[dimension].unit


@cache
def scene_unit(dimension: str) -> str:
    """The SI unit as scene files write it, e.g. "kg/m^3" or "kg^-1"; empty if dimensionless."""
    above: list[str] = []
    below: list[str] = []
    found = re.findall(r"([A-Za-z]+)(-?[0-9.]+)?", si_unit(dimension))
    for word, power in found:
        (below if "-" in power else above).append(f"{word}^{power.strip('-')}" if power.strip("-1") else word)
    if below and not above:
        return "*".join(f"{word}^{power}" for word, power in found)
    return "/".join(["*".join(above), *below])


def quotient_unit(above: str, below: str) -> str:
    """The SI unit of a quantity of one dimension over one of another, as UDUNITS and CF write it, e.g. "N s m-1".

    Raises KeyError for the stiffness of a power law, whose unit they cannot write.
    """
    powers: dict[str, float] = {}
    for dimension, sign in ((above, 1), (below, -1)):
        for word, power in re.findall(r"([A-Za-z]+)(-?[0-9.]+)?", si_unit(dimension)):
            powers[word] = powers.get(word, 0) + sign * float(power or 1)
    ordered = sorted((item for item in powers.items() if item[1]), key=lambda item: item[1] < 0)
    return " ".join(word + (f"{power:g}" if power != 1 else "") for word, power in ordered) or "1"


def needed(dimension: str) -> str:
    """The end of an error message: 'a length is needed (e.g. "10 mm")'."""
    _, phrase, example = DIMENSIONS[dimension]
    example = example if dimension == "dimensionless" else f'"{example}"'
    return f"{phrase} is needed (e.g. {example})"


_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
PREFIXED = {"length", "time", "force", "pressure", "energy", "power"}


def format_si(value: float, dimension: str, digits: int = 4) -> str:
    """SI `value` for a table: "516.1 N", "9.484 µm", "60.74 g"."""
    unit, prefixed = scene_unit(dimension).replace("*", "·"), dimension in PREFIXED
    if dimension == "mass" and 0 < abs(value) < 1:
        value, unit, prefixed = value * 1000, "g", True
    if prefixed and value and math.isfinite(value):
        power = int(f"{value:.{digits - 1}e}".partition("e")[2]) // 3 * 3
        if power in _PREFIXES:
            value, unit = value / 10.0**power, _PREFIXES[power] + unit
    return f"{value:.{digits}g} {unit}".rstrip()


def _convert(value: object, powers: Powers, need: str, bare: bool) -> float:
    if isinstance(value, str):
        result = _read(value, powers, need, bare)
    elif _is_quantity(value):
        size = _quantity_size(value, powers, need)
        number = _scalar(value.magnitude, need)
        result = float(Decimal(repr(number)) * size) if math.isfinite(number) else number
    elif not isinstance(value, bool) and isinstance(value, numbers.Real):
        if not bare:
            raise ValueError(f"{shown(value)} has no unit, {need}")
        result = _scalar(value, need)
    else:
        raise ValueError(f"{shown(value)} is not a number{'' if bare else ' with a unit'}, {need}")
    if not math.isfinite(result):
        raise ValueError(f"{shown(value)} is not finite, {need}")
    return result


def _read(text: str, powers: Powers, need: str, bare: bool) -> float:
    match = _NUMBER.fullmatch(text)
    if match is None or len(text) > 200:
        raise ValueError(f"{shown(text)} {_misread(text, bare)}, {need}")
    number, unit = match[1], match[2].strip()
    if not unit:
        if not bare:
            raise ValueError(f"{shown(text)} has no unit, {need}")
        return float(number)
    try:
        factor, found = parse_unit(unit.translate(_SPELLINGS))
    except ValueError as error:
        reason = _misread(text, bare) if _MISREAD.search(text) else f"is not understood: {error}"
        raise ValueError(f"{shown(text)} {reason}, {need}") from None
    if found != powers:
        raise ValueError(f"{shown(text)} {_described(found, unit)}, {need}")
    # In decimal, so that "60.74 g" and "0.06074 kg" are the same float.
    return float(Decimal(number) * factor)


_MISREAD = re.compile(r"[,−±]|\+/-|\+-|\b(?:inf|nan)\b", re.IGNORECASE)


def _misread(text: str, bare: bool) -> str:
    """Why a text is not a number with a unit; bare: or without."""
    if not text.strip():
        return "is empty"
    found = _MISREAD.search(text)
    reasons = {
        ",": 'has a comma: write a decimal point, "10.5" not "10,5"',
        "−": 'has the sign U+2212: write "-"',
        "±": "has a tolerance: give one value",
        "inf": "is not finite",
        "nan": "is not a number",
    }
    neither = "is not a number" if bare else 'is not a number and a unit, like "10 mm"'
    default = reasons["±"] if found else neither
    return reasons.get(found[0].lower(), default) if found else default


def _is_quantity(value: object) -> TypeGuard[QuantityLike]:
    return hasattr(value, "magnitude") and hasattr(value, "dimensionality")


def _quantity_size(quantity: QuantityLike, powers: Powers, need: str) -> Decimal:
    try:
        found = quantity_powers(quantity)
        size = unit_size(quantity, found)
    except ValueError as error:
        raise ValueError(f"{shown(quantity)} is {error}, {need}") from None
    if found != powers:
        raise ValueError(f"{shown(quantity)} {_described(found, str(quantity.units))}, {need}")
    return size


def _scalar(value: Any, need: str) -> float:
    if isinstance(value, numbers.Real) or getattr(value, "ndim", None) == 0:
        try:
            return float(value)
        except OverflowError:
            return math.inf
    raise ValueError(f"{shown(value)} is not one number, {need}")


def _described(powers: Powers, unit: str) -> str:
    for name, dimension in DIMENSIONS.items():
        if _powers(name) == powers and "." not in dimension.unit:  # Hertz's stiffness has the unit of a toughness
            return f"is {dimension.phrase}"
    return f'has the unit "{unit}"'


@cache
def _powers(dimension: str) -> Powers:
    return (0, 0, 0) if dimension == "dimensionless" else parse_unit(si_unit(dimension))[1]
