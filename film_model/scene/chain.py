"""A chain: bodies in a row, and what they hit."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

from film_model.base.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.base.fields import (
    Field,
    InUnits,
    build,
    choice,
    fill,
    fill_ball,
    key_text,
    measure,
    part,
    table_of,
    whole,
)
from film_model.base.materials import MASS, MATERIAL, Material, MaterialLike, sphere_mass
from film_model.base.units import Value
from film_model.scene.contact import Contact, contact_table
from film_model.scene.impactor import Sphere
from film_model.scene.options import Effects
from film_model.scene.scene import Scene, scene_of
from film_model.scene.toml import placed, read_text, text_from_table, toml_table
from film_model.targets import Body, HalfSpace

CHAIN_ACCURACY = 1e-9
"""Of final velocities and largest forces, unless a chain asks for another."""

MOST_BODIES = 10_000

_SECTIONS = {"effects": ("gravity",), "solver": ("accuracy", "duration")}
"""Sections of a file, and the entries of a chain that are in them."""


def _contact_of(value: object) -> Contact:
    if isinstance(value, Contact):
        return value
    if isinstance(value, Mapping):
        return Contact(**cast("dict[str, Any]", value))
    raise ValueError(f"{shown(value)} is not allowed: a Contact is needed")


@dataclass(frozen=True, init=False, repr=False)
class ChainBody(InUnits):
    """A body of a chain, or several alike.

    radius: of the contacting surfaces, m; or, to the constructor, diameter. mass: kg; default density × sphere volume.
    material: name or table. velocity: at the start, m/s, positive towards the end of the chain; default 0. gap: to the
    next body, or of the last one to the half-space, m; default 0, touching. count: of such bodies, one after the other,
    with that gap behind each. contact: the law behind each of them, where it differs from the chain's.
    """

    is_ball: ClassVar[bool] = True
    FIELDS: ClassVar[Mapping[str, Field]] = {
        "radius": measure("length", 1e-10, 1e3, required=True),
        "mass": MASS,
        "material": MATERIAL,
        "velocity": measure("velocity", -2e4, 2e4, required=True),
        "gap": measure("length", 0, 1e5, required=True),
        "count": whole(1, MOST_BODIES),
        "contact": Field(_contact_of, "a Contact is needed", write=contact_table),
    }

    radius: float
    mass: float | None
    material: Material | None
    velocity: float
    gap: float
    count: int
    contact: Contact | None

    def __init__(
        self,
        radius: Value | None = None,
        mass: Value | None = None,
        material: MaterialLike | None = None,
        velocity: Value = "0 m/s",
        gap: Value = "0 m",
        count: int = 1,
        contact: Contact | Mapping[str, Any] | None = None,
        diameter: Value | None = None,
    ) -> None:
        raise_all(fill_ball(self, locals()))

    @property
    def own_mass(self) -> float | None:
        """The given mass, or density × sphere volume, kg; None if neither is known."""
        return sphere_mass(self.mass, self.radius, self.material)


@dataclass(frozen=True, init=False, repr=False)
class Chain(InUnits):
    """Bodies in a row, each of which may touch its neighbours; the last one may hit a half-space.

    bodies: in the order in which they lie; positive directions point to the last. contact: the law of all contacts
    that have none of their own; "auto" is elastoplastic where a yield strength is known, else hertz. target: a
    HalfSpace behind the last body; default none. gravity: whether weight acts, towards the last body. duration: s;
    default until contact is open everywhere and no neighbours approach. accuracy: of final velocities over that of
    approach, and relative, of the largest force of each contact; default 1e-9.

    >>> ball = {"radius": "10 mm", "material": "bearing steel"}
    >>> cradle = fm.Chain([{**ball, "velocity": "0.5 m/s"}, {**ball, "count": 2}], "hertz")
    >>> fm.simulate_chain(cradle).final_velocity.m.round(4).tolist()
    [-0.0355, 0.0382, 0.4973]
    """

    FIELDS: ClassVar[Mapping[str, Field]] = {
        "target": part(HalfSpace),
        "gravity": choice(True, False),
        "duration": measure("time", 1e-15, 1e9),
        "accuracy": measure("dimensionless", 1e-12, 0.1, required=True),
    }

    bodies: tuple[ChainBody, ...]
    contact: Contact
    target: HalfSpace | None
    gravity: bool
    duration: float | None
    accuracy: float
    title: str

    def __init__(
        self,
        bodies: Sequence[ChainBody | Mapping[str, Any]],
        contact: Contact | str = "auto",
        target: HalfSpace | None = None,
        gravity: bool = False,
        duration: Value | None = None,
        accuracy: float = CHAIN_ACCURACY,
        title: str = "",
    ) -> None:
        mistakes = fill(self, locals())
        made = list[ChainBody]()
        for number, body in enumerate(bodies, 1):
            try:
                made.append(body if isinstance(body, ChainBody) else build(ChainBody, body))
            except SceneError as error:
                mistakes += [replace(m, key=f"bodies[{number}].{m.key.partition('.')[2]}") for m in error.mistakes]
        object.__setattr__(self, "bodies", tuple(made))
        object.__setattr__(self, "contact", Contact(contact) if isinstance(contact, str) else contact)
        object.__setattr__(self, "title", title)
        raise_all(mistakes or self._mistakes())

    def __repr__(self) -> str:
        end = "" if self.target is None else ", before a half-space"
        return f"Chain({len(self.row)} bodies{end}; law {self.contact.law_name})"

    @property
    def row(self) -> list[ChainBody]:
        """Every body, one by one."""
        return [body for body in self.bodies for _ in range(body.count)]

    def _mistakes(self) -> list[Mistake]:
        row = self.row
        found = list[Mistake]()
        if len(row) + (self.target is not None) < 2 or len(row) > MOST_BODIES:
            found.append(
                Mistake(None, None, "bodies", f"there are {len(row)}: 2 to {MOST_BODIES} are needed, or a target")
            )
        found += [
            Mistake(None, None, f"bodies[{n}].mass", "missing: give mass, or a material")
            for n, body in enumerate(self.bodies, 1)
            if body.own_mass is None
        ]
        if self.gravity and self.target is None:
            found.append(Mistake(None, None, "Chain.gravity", "is true: weight needs a target to fall onto"))
        return found

    def pairs(self, speed: float) -> list[Scene]:
        """The contact behind each body as a scene of two bodies that approach with `speed` [m/s].

        Raises SceneError for what a law needs and its bodies do not say.
        """
        row, known, found = self.row, dict[tuple[int, int], Scene](), list[Scene]()
        places = [n for n, body in enumerate(self.bodies, 1) for _ in range(body.count)]
        for k, one in enumerate(row if self.target is not None else row[:-1]):
            last = k + 1 == len(row)
            key = places[k], 0 if last else places[k + 1]
            if key not in known:
                try:
                    known[key] = self._pair(one, None if last else row[k + 1], speed)
                except SceneError as error:
                    other = "target" if last else f"bodies[{key[1]}]"
                    raise SceneError(_renamed(m, f"bodies[{key[0]}]", other) for m in error.mistakes) from None
            found.append(known[key])
        return found

    def _pair(self, one: ChainBody, other: ChainBody | None, speed: float) -> Scene:
        ball = Sphere(f"{one.radius!r} m", f"{speed!r} m/s", mass=f"{one.own_mass!r} kg", material=one.material)
        if other is None:
            assert self.target is not None
            target = self.target
        else:
            target = Body(other.material, f"{other.radius!r} m", f"{other.own_mass!r} kg")
        return Scene(ball, target, one.contact or self.contact, Effects(gravity=False))

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str]) -> Chain:
        """Read a file with sections [[bodies]]; all its mistakes are raised in one SceneError."""
        return cls.from_text(*read_text(path))

    @classmethod
    def from_text(cls, text: str, name: str = "chain") -> Chain:
        """Read the text of such a file. name: of the file, in messages."""
        return _chain_of(toml_table(text, name), text, name)

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Chain:
        """Make a chain from nested tables laid out as in its file."""
        known: dict[str, type] = {
            "title": str,
            "bodies": list,
            **dict.fromkeys(("contact", "target", *_SECTIONS), dict),
        }
        entries, mistakes = dict[str, Any](bodies=()), list[Mistake]()
        value: Any
        for key, value in table.items():
            if key not in known:
                mistakes.append(Mistake(None, None, key_text(key), f"unknown key{did_you_mean(key, known)}"))
            elif not isinstance(value, known[key]):
                need = {"title": "a text is", "bodies": "sections [[bodies]] are"}.get(key, f"a section [{key}] is")
                mistakes.append(Mistake(None, None, key, f"{shown(value)} is not allowed: {need} needed"))
            elif key in _SECTIONS:
                entries |= {name: value[name] for name in value if name in _SECTIONS[key]}
                what = f"unknown key of a chain; known are {', '.join(_SECTIONS[key])}"
                others = (name for name in value if name not in _SECTIONS[key])
                mistakes += [Mistake(None, None, f"{key}.{key_text(name)}", what) for name in others]
            elif key in ("contact", "target"):
                try:
                    entries[key] = Contact(**value) if key == "contact" else _half_space(value)
                except SceneError as error:
                    mistakes += [found.moved(key) for found in error.mistakes]
            else:
                entries[key] = value
        raise_all(mistakes)
        try:
            return cls(**entries)
        except SceneError as error:
            names = {f"Chain.{name}": f"{key}.{name}" for key, inside in _SECTIONS.items() for name in inside}
            raise SceneError(replace(m, key=names.get(m.key, m.key)) for m in error.mistakes) from None

    def to_table(self) -> dict[str, Any]:
        """Nested tables, as in the file, from which :meth:`from_table` makes the same chain, to the last bit."""
        own = table_of(self)
        sections: dict[str, Any] = {"title": self.title} if self.title else {}
        sections |= {"bodies": [table_of(body) for body in self.bodies], "contact": contact_table(self.contact)}
        if self.target is not None:
            sections["target"] = {"kind": self.target.kind, **own["target"]}
        return sections | {
            key: {name: own[name] for name in inside if name in own} for key, inside in _SECTIONS.items()
        }

    def to_toml(self) -> str:
        """The text of a file from which :meth:`from_text` makes the same chain, to the last bit."""
        return text_from_table(self.to_table())


def read(path: str | os.PathLike[str]) -> Scene | Chain:
    """The chain in a file with sections [[bodies]], else the scene; all mistakes are raised in one SceneError."""
    text, name = read_text(path)
    table = toml_table(text, name)
    if "bodies" in table:
        return _chain_of(table, text, name)
    return scene_of(table, text, name, os.path.dirname(os.fspath(path)))


def _chain_of(table: Mapping[str, Any], text: str, name: str) -> Chain:
    """The chain in the table of a text. name: of its file, in messages."""
    try:
        return Chain.from_table(table)
    except SceneError as error:
        raise placed(error.mistakes, text, name) from None


def _renamed(mistake: Mistake, one: str, other: str) -> Mistake:
    """A mistake of the scene of two bodies, with the names that they have in the chain."""
    key, message = (
        text.replace("impactor.", f"{one}.").replace("target.", f"{other}.")
        for text in (mistake.key.removeprefix("Scene."), mistake.message)
    )
    return replace(mistake, key=key, message=message)


def _half_space(section: Mapping[str, Any]) -> HalfSpace:
    kind = section.get("kind", HalfSpace.kind)
    if kind != HalfSpace.kind:
        what = f'{shown(kind)} is not supported behind a chain: "{HalfSpace.kind}" is needed'
        raise SceneError([Mistake(None, None, "Target.kind", what)])
    return build(HalfSpace, {name: value for name, value in section.items() if name != "kind"})
