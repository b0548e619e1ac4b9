"""The contact: its law, the law's parameters, and values that override those of the materials."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any, Literal, cast

from film_model.base.errors import Mistake, SimulationError, did_you_mean, nearest, raise_all, shown
from film_model.base.fields import Field, InUnits, choice, entry, fill, key_text, measure, table_of, words, written
from film_model.base.units import Value, array_to_si, needed, power_stiffness_to_si, power_stiffness_unit, to_si
from film_model.laws import LAWS, AbstractLaw, Parameter
from film_model.laws.law import wrong_values
from film_model.scene.friction_table import FRICTION, FrictionTable

UNLOADINGS = ("brake", "retrace")
"""Names of the unloading rules that can replace a law's own: :mod:`film_model.laws.unloading`."""

UNLOADING = Field(choice(*UNLOADINGS).read, "the name of an unloading rule is needed")


def _read_law(value: object) -> str | AbstractLaw:
    if value == "auto":
        return "auto"
    if isinstance(value, AbstractLaw):
        for name, message in wrong_values(value).items():
            raise ValueError(f"{type(value).__name__}.{name}: {message}")
        return value
    if isinstance(value, str) and value in LAWS:
        return value
    if isinstance(value, str):
        names = ["auto", *LAWS]
        hint = did_you_mean(value, names) or "; there are " + ", ".join(names)
        raise ValueError(f"no contact law is called {shown(value)}{hint}")
    raise ValueError(f"{shown(value)} is not a contact law: its name or a law is needed")


@dataclass(frozen=True, init=False, repr=False)
class Contact(InUnits):
    """The contact law and its values.

    law: "auto", a name, or a law of your own. effective_modulus: E of Hertz's theory, Pa; default from both materials.
    yield_strength: of the body that yields, Pa; default from the materials. poissons_ratio: of the body that yields;
    default from the materials. unloading: "brake" (Brake's rule) or "retrace", instead of the law's own unloading.
    work_of_adhesion: J/m², of the laws that pull, and to estimate adhesion under others; default from the materials.
    friction: coefficient µ of Coulomb's friction, for an impact at an angle or with spin, or pairs [speed, µ] that give
    it over the sliding speed, with lines between; without it only the normal motion is simulated. roughness: combined
    rms height of both surfaces, √(σ₁² + σ₂²), m, to estimate what asperities
    change. fluid_viscosity: of what surrounds the contact, Pa·s, to estimate what its film takes from the rebound; of
    air at 20 °C 1.8e-5. parameters: the law's own, by name, in SI units.

    >>> fm.Contact("tsuji", restitution=0.8).parameters
    {'restitution': 0.8}
    """

    law: str | AbstractLaw = entry(Field(_read_law, "the name of a contact law is needed", required=True))
    effective_modulus: float | None = entry(measure("pressure", 1, 1e14))
    yield_strength: float | None = entry(measure("pressure", 1, 1e13))
    poissons_ratio: float | None = entry(measure("dimensionless", -1, 0.5, open_ends=True))
    unloading: Literal["brake", "retrace"] | None = entry(UNLOADING)
    work_of_adhesion: float | None = entry(measure("surface_energy", 0, 1e6))
    friction: float | FrictionTable | None = entry(FRICTION)
    roughness: float | None = entry(measure("length", 0, 1))
    fluid_viscosity: float | None = entry(measure("viscosity", 1e-9, 1e9))
    parameters: Mapping[str, Any] = field(hash=False)

    def __init__(
        self,
        /,
        law: str | AbstractLaw = "auto",
        effective_modulus: Value | None = None,
        yield_strength: Value | None = None,
        poissons_ratio: float | str | None = None,
        unloading: Literal["brake", "retrace"] | None = None,
        work_of_adhesion: Value | None = None,
        friction: float | str | Sequence[Sequence[Any]] | FrictionTable | None = None,
        roughness: Value | None = None,
        fluid_viscosity: Value | None = None,
        **parameters: object,
    ) -> None:
        mistakes = fill(self, locals())
        read: dict[str, Any] = {}
        if self.law:
            mistakes += _read_parameters(self.law, parameters, read)
            if self.unloading == "brake" and self.law != "auto" and self._law.damped:
                message = f'law "{self.law_name}" is damped: it takes no rule of unloading'
                mistakes.append(Mistake(None, None, "Contact.unloading", message))
        object.__setattr__(self, "parameters", read)
        raise_all(mistakes)

    def shown_entries(self) -> list[str]:
        table = contact_table(self)
        return super().shown_entries() + [f"{name}={shown(table[name])}" for name in self.parameters]

    def needs(self, name: str) -> bool:
        """Whether the contact needs the scene's effective_modulus, radius, yield_strength or poissons_ratio."""
        if name == "effective_modulus" and self.unloading_name == "brake":
            return True
        if self.law == "auto":
            return name in ("effective_modulus", "radius")
        return isinstance(self.law, str) and self.has(name)

    def has(self, name: str) -> bool:
        """Whether the law has a value of this name. Not defined for law "auto"."""
        return name in self._law.__dataclass_fields__

    def refuse_friction(self, what: str) -> None:
        """Raise SimulationError if friction is given to what simulates the normal motion only."""
        if self.friction is not None:
            raise SimulationError(
                f"{what} the normal motion only, but contact.friction is {self.friction:g}: leave it out, "
                "or use simulate, a batch or a sweep"
            )

    def one_friction(self, what: str) -> float | None:
        """The coefficient of friction. Raises SimulationError if it is a table."""
        if isinstance(self.friction, FrictionTable):
            raise SimulationError(
                f"{what} one coefficient of friction, but contact.friction is a table over the sliding speed"
            )
        return self.friction

    @property
    def from_strength(self) -> list[str]:
        """The law's parameters that are not given and follow from the strength of the body that yields."""
        known = {} if self.law == "auto" or not isinstance(self.law, str) else self._law.over_strength(1.0)
        return [name for name in known if name not in self.parameters]

    @cached_property
    def unloading_name(self) -> str | None:
        """The rule that replaces the law's own unloading, or None."""
        if self.unloading is not None or self.law == "auto":
            return self.unloading
        return self._law.default_unloading

    @property
    def _law(self) -> Any:
        """The law, or its class. Not defined for law "auto"."""
        return _law(self.law) if isinstance(self.law, str) else self.law

    @property
    def law_name(self) -> str:
        """The law's name, as messages show it."""
        return self.law if isinstance(self.law, str) else self.law.name


def parameter_fields(contact: Contact) -> dict[str, Field]:
    """The parameters of the contact's named law as fields, by name."""
    if not isinstance(contact.law, str) or contact.law == "auto":
        return {}
    return {
        name: _parameter_field(parameter, _exponent(contact.law, contact.parameters))
        for name, parameter in _law(contact.law).parameters.items()
    }


def _parameter_field(parameter: Parameter, exponent: float | None) -> Field:
    if parameter.choices:
        return choice(*parameter.choices)
    if parameter.several or parameter.dimension == "file":
        return Field(partial(_read_parameter, parameter), "a list or a file is needed", parameter.required)
    low = parameter.above if parameter.above is not None else parameter.minimum
    ends = (-math.inf if low is None else low, math.inf, parameter.above is not None)
    if parameter.dimension != "meyer_stiffness":
        dimension = parameter.dimension
        return Field(partial(_read_parameter, parameter), needed(dimension), parameter.required, dimension, *ends)

    def read(value: object) -> float:
        return _checked(parameter, value, power_stiffness_to_si(value, exponent or math.nan))

    return Field(read, "a stiffness is needed", parameter.required, parameter.dimension, *ends)


def contact_table(contact: Contact) -> dict[str, Any]:
    """The table from which :class:`Contact` makes the same object again; a law of your own stays an object."""
    table = table_of(contact)
    for name, value in contact.parameters.items():
        dimension = _law(contact.law_name).parameters[name].dimension
        if dimension == "meyer_stiffness":
            table[name] = f"{value!r} {stiffness_unit(contact)}"
        else:
            table[name] = written(value, dimension)
    return table


def stiffness_unit(contact: Contact) -> str:
    """The SI unit, N/m^q, of the stiffness of a law of power q: the contact's exponent, or the law's own."""
    exponent = _exponent(contact.law_name, contact.parameters)
    assert exponent is not None  # otherwise reading the stiffness would have failed
    return power_stiffness_unit(exponent)


def _law(name: str) -> Any:
    return LAWS[name]


def _read_parameters(law: str | AbstractLaw, given: Mapping[str, object], read: dict[str, Any]) -> list[Mistake]:
    """Read the law's parameters into `read`; return the mistakes."""
    known: Mapping[str, Parameter] = {} if law == "auto" or not isinstance(law, str) else _law(law).parameters
    mistakes = [Mistake(None, None, f"Contact.{key_text(k)}", _unknown(known, k)) for k in given if k not in known]
    meant = {nearest(k, [*Contact.FIELDS, *known]) for k in given if k not in known}
    for name in sorted(known, key=lambda name: name != "exponent"):  # the unit of a stiffness depends on it
        key, parameter = f"Contact.{name}", known[name]
        if given.get(name) is None:
            if parameter.required and name not in meant:
                mistakes.append(Mistake(None, None, key, f'missing: law "{law}" needs it ({parameter.help})'))
            continue
        try:
            exponent = _exponent(law, read)
            if parameter.dimension != "meyer_stiffness" or exponent is not None:
                read[name] = _parameter_field(parameter, exponent).read(given[name])
        except ValueError as error:
            mistakes.append(Mistake(None, None, key, str(error)))
    if known and not mistakes:
        wrong = _law(str(law)).settle(read)
        mistakes += [Mistake(None, None, f"Contact.{name}", message) for name, message in wrong.items()]
    return mistakes


def _read_parameter(parameter: Parameter, value: object) -> Any:
    if parameter.dimension == "file":
        return words("the path of a file").read(value)
    if parameter.several:
        return _read_several(parameter.dimension, value)
    return _checked(parameter, value, to_si(value, parameter.dimension))


def _read_several(dimension: str, value: object) -> tuple[float, ...]:
    """A list of values with units, or an array with one."""
    if not isinstance(value, list | tuple):
        if isinstance(value, str) or not hasattr(value, "__len__"):
            raise ValueError(f"{shown(value)} is not a list, {needed(dimension)} in each place")
        return tuple(array_to_si(value, dimension).ravel().tolist())
    read: list[float] = []
    for place, item in enumerate(cast("list[object]", value), 1):
        try:
            read.append(to_si(item, dimension))
        except ValueError as error:
            raise ValueError(f"value {place}: {error}") from None
    return tuple(read)


def _checked(parameter: Parameter, value: object, result: float) -> float:
    if parameter.above is not None and not result > parameter.above:
        raise ValueError(f"{shown(value)} must be > {parameter.above:g}")
    if parameter.minimum is not None and not result >= parameter.minimum:
        raise ValueError(f"{shown(value)} must be >= {parameter.minimum:g}")
    return result


def _exponent(law: str | AbstractLaw, read: Mapping[str, Any]) -> float | None:
    """The law's exponent as given or by default; None if it is missing or wrong."""
    return read.get("exponent", getattr(_law(str(law)), "exponent", None))


def _unknown(known: Mapping[str, Parameter], key: str) -> str:
    """The message for a key that is neither a field of a contact nor a parameter of its law."""
    entries = [*Contact.FIELDS, *known]
    hint = did_you_mean(key, entries)
    owners = [name for name, other in LAWS.items() if key in other.parameters]
    if not hint and owners:
        hint = "; it belongs to law " + " or ".join(f'"{name}"' for name in owners)
    return f"unknown key{hint or '; known are ' + ', '.join(entries)}"
