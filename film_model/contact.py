"""Contact: which law, its own parameters, and what overrides the materials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from film_model.errors import Mistake, did_you_mean, raise_all, shown
from film_model.fields import Field, choice, fill, key_text, measure, table_of, written
from film_model.units import Value, power_stiffness_to_si, to_si

if TYPE_CHECKING:
    from film_model.laws import AbstractLaw, Parameter


def _read_law(value: object) -> str | AbstractLaw:
    if value == "auto":
        return "auto"
    from film_model.laws import LAWS, AbstractLaw

    if isinstance(value, AbstractLaw) or (isinstance(value, str) and value in LAWS):
        return value
    if isinstance(value, str):
        names = ["auto", *LAWS]
        hint = did_you_mean(value, names) or "; there are " + ", ".join(names)
        raise ValueError(f"no contact law is called {shown(value)}{hint}")
    raise ValueError(f"{shown(value)} is not a contact law: its name or a law is needed")


@dataclass(frozen=True, init=False)
class Contact:
    """The contact law and what it needs.

    law: "auto", a name, or a law of your own. effective_modulus: Pa, overrides the materials' own. yield_strength:
    Pa, likewise. work_of_adhesion: J/m², by which adhesion is judged. parameters: the law's own, by their names, in SI
    units.
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "law": Field(_read_law, "the name of a contact law is needed", required=True),
        "effective_modulus": measure("pressure", 1, 1e14),
        "yield_strength": measure("pressure", 1, 1e13),
        "work_of_adhesion": measure("surface_energy", 0, 1e6),
    }

    law: str | AbstractLaw
    effective_modulus: float | None
    yield_strength: float | None
    work_of_adhesion: float | None
    parameters: Mapping[str, Any] = field(hash=False)

    def __init__(
        self,
        /,
        law: str | AbstractLaw = "auto",
        effective_modulus: Value | None = None,
        yield_strength: Value | None = None,
        work_of_adhesion: Value | None = None,
        **parameters: object,
    ) -> None:
        mistakes = fill(self, locals())
        read: dict[str, Any] = {}
        if self.law:
            mistakes += _read_parameters(self.law, parameters, read)
        object.__setattr__(self, "parameters", read)
        raise_all(mistakes)

    def needs(self, name: str) -> bool:
        """Whether the law is filled with the scene's `name`: effective_modulus, radius or yield_strength."""
        if self.law == "auto":
            return name != "yield_strength"
        return isinstance(self.law, str) and name in _law(self.law).__dataclass_fields__

    @property
    def law_name(self) -> str:
        """The law's name in sentences."""
        return self.law if isinstance(self.law, str) else self.law.name


def contact_table(contact: Contact) -> dict[str, Any]:
    """The table from which :class:`Contact` makes the same object again; a law of your own stays an object."""
    table = table_of(contact)
    for name, value in contact.parameters.items():
        dimension = _law(contact.law_name).parameters[name].dimension
        if dimension == "meyer_stiffness":
            table[name] = f"{value!r} N/m^" + f"{_exponent(contact.law_name, contact.parameters):.9f}".rstrip(
                "0"
            ).rstrip(".")
        else:
            table[name] = written(value, dimension)
    return table


def _law(name: str) -> Any:
    from film_model.laws import LAWS

    return LAWS[name]


def _read_parameters(law: str | AbstractLaw, given: Mapping[str, object], read: dict[str, Any]) -> list[Mistake]:
    """Put the law's parameters into `read`, and return what is wrong with them."""
    known: Mapping[str, Parameter] = {} if law == "auto" or not isinstance(law, str) else _law(law).parameters
    mistakes = [Mistake(None, None, f"Contact.{key_text(k)}", _unknown(law, known, k)) for k in given if k not in known]
    for name in sorted(known, key=lambda name: name != "exponent"):  # which a stiffness's unit depends on
        key, parameter = f"Contact.{name}", known[name]
        if given.get(name) is None:
            if parameter.required:
                mistakes.append(Mistake(None, None, key, f'missing: law "{law}" needs it ({parameter.help})'))
            continue
        try:
            if parameter.dimension != "meyer_stiffness":
                read[name] = _read_parameter(parameter, given[name])
            elif (exponent := _exponent(law, read)) is not None:
                read[name] = _checked(parameter, given[name], power_stiffness_to_si(given[name], exponent))
        except ValueError as error:
            mistakes.append(Mistake(None, None, key, str(error)))
    return mistakes


def _read_parameter(parameter: Parameter, value: object) -> Any:
    if parameter.choices:
        return choice(*parameter.choices).read(value)
    return _checked(parameter, value, to_si(value, parameter.dimension))


def _checked(parameter: Parameter, value: object, result: float) -> float:
    if parameter.above is not None and not result > parameter.above:
        raise ValueError(f"{shown(value)} must be > {parameter.above:g}")
    if parameter.minimum is not None and not result >= parameter.minimum:
        raise ValueError(f"{shown(value)} must be >= {parameter.minimum:g}")
    return result


def _exponent(law: str | AbstractLaw, read: Mapping[str, Any]) -> float | None:
    """The law's exponent as given or by default; None if it is missing or wrong."""
    return read.get("exponent", getattr(_law(str(law)), "exponent", None))


def _unknown(law: str | AbstractLaw, known: Mapping[str, Parameter], key: str) -> str:
    """What to say of a key that is neither a field of a contact nor a parameter of its law."""
    from film_model.laws import LAWS

    hint = did_you_mean(key, [*Contact.FIELDS, *known])
    owners = [name for name, other in LAWS.items() if key in other.parameters]
    if not hint and owners:
        hint = "; it belongs to law " + " or ".join(f'"{name}"' for name in owners)
    return "unknown key" + hint
