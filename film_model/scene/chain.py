"""A chain: bodies in a row or a tree, and what they hit."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, cast

from film_model.base.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.base.fields import Field, InUnits, build, choice, entry, fill, key_text, measure, table_of
from film_model.base.units import Value
from film_model.scene.chain_body import MOST_BODIES, ChainBody
from film_model.scene.contact import Contact, contact_table
from film_model.scene.impactor import Sphere
from film_model.scene.options import Effects
from film_model.scene.scene import Scene
from film_model.scene.sections import target_of
from film_model.scene.toml import find_files, placed, read_text, text_from_table, toml_table
from film_model.targets import AbstractTarget, Body, HalfSpace

_SECTIONS = {"effects": ("gravity",), "solver": ("accuracy", "duration")}
"""Sections of a file, and the entries of a chain that are in them."""


TARGET = "target"
"""What a body that the target pushes is behind."""

VIBRATING = ("plate", "beam", "structure")
"""Kinds of targets whose vibrations are simulated."""

ACCURACY, ON_STRUCTURE = 1e-9, 1e-4
"""Default accuracy, and that of bodies on a target that vibrates."""


class Link(NamedTuple):
    """Two that touch, by their numbers from 0; None is the target. angle: between their lines, rad. gap: at the start,
    m. at: sensor of the target, "" its own position."""

    front: int | None
    behind: int | None
    angle: float
    gap: float
    at: str = ""

    @property
    def body(self) -> int:
        """The body in front, or the one that the target pushes."""
        return self.behind if self.front is None else self.front  # pyright: ignore[reportReturnType]

    @property
    def along(self) -> float:
        """Part of the front body's motion along the other line."""
        return math.cos(self.angle)


def _read_target(value: object) -> AbstractTarget:
    if isinstance(value, Mapping):
        return _target(cast("Mapping[str, Any]", value))
    if not isinstance(value, AbstractTarget):
        raise ValueError(f"{shown(value)} is not allowed: a target is needed")
    _target_kind(value.kind)
    return value


def _target(section: Mapping[str, Any]) -> AbstractTarget:
    """The target of a section, a half-space by default."""
    _target_kind(section.get("kind", HalfSpace.kind))
    return target_of({"kind": HalfSpace.kind, **section})


def _target_kind(kind: object) -> None:
    if kind not in (HalfSpace.kind, *VIBRATING):
        *others, last = (shown(known) for known in (HalfSpace.kind, *VIBRATING))
        what = f"{shown(kind)} is not supported behind a chain: {', '.join(others)} or {last} is needed"
        raise SceneError([Mistake(None, None, "Target.kind", what)])


@dataclass(frozen=True, init=False, repr=False)
class Chain(InUnits):
    """Bodies in a row or a tree, each of which may touch its neighbours; the last ones may hit a target.

    bodies: in the order in which they lie; positive directions point to the last. contact: the law of all contacts
    that have none of their own; "auto" is elastoplastic where a yield strength is known, else hertz. target: a
    HalfSpace behind each body that has none behind it, square to its line; or a Plate, Beam or Structure, which
    vibrates and may be touched at several points, from both sides; default none. gravity: whether weight acts, along
    the line of the first body. duration: s; default until contact is open everywhere and no neighbours approach;
    required with a target that vibrates. accuracy: of final velocities over that of approach, and relative, of
    the largest force of each contact; default 1e-9, with a target that vibrates 1e-4.

    >>> ball = {"radius": "10 mm", "material": "bearing steel"}
    >>> cradle = fm.Chain([{**ball, "velocity": "0.5 m/s"}, {**ball, "count": 2}], "hertz")
    >>> fm.simulate_chain(cradle).final_velocity.m.round(4).tolist()
    [-0.0355, 0.0382, 0.4973]
    """

    target: AbstractTarget | None = entry(Field(_read_target, "a target is needed"))
    gravity: bool = entry(choice(True, False))
    duration: float | None = entry(measure("time", 1e-15, 1e9))
    accuracy: float = entry(measure("dimensionless", 1e-12, 0.1, required=True))
    bodies: tuple[ChainBody, ...]
    contact: Contact
    title: str

    def __init__(
        self,
        bodies: Sequence[ChainBody | Mapping[str, Any]],
        contact: Contact | str = "auto",
        target: AbstractTarget | None = None,
        gravity: bool = False,
        duration: Value | None = None,
        accuracy: float | None = None,
        title: str = "",
    ) -> None:
        accuracy = accuracy or (ON_STRUCTURE if getattr(target, "kind", "") in VIBRATING else ACCURACY)
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
        row = self.row
        ends = len(row) - len({link.front for link in self.links if link.behind is not None} - {None})
        count = f"{len(row)} bodies" + (f" with {ends} ends" if ends > 1 and not self.vibrates else "")
        there = "" if self.target is None else f", {'on' if self.vibrates else 'before'} a {self.target.kind}"
        return f"Chain({count}{there}; law {self.contact.law_name})"

    @property
    def vibrates(self) -> bool:
        """Whether the target is a structure, whose vibrations are simulated."""
        return self.target is not None and self.target.kind in VIBRATING

    @cached_property
    def row(self) -> list[ChainBody]:
        """Every body, one by one."""
        return [body for body in self.bodies for _ in range(body.count)]

    @cached_property
    def links(self) -> list[Link]:
        """Which bodies touch: each of them but the first of a row with the one in front of it, then the last ones with
        the target, then those that it pushes."""
        row, found, pushed, last = self.row, list[Link](), list[Link](), dict[str, int]()
        number, ended, beyond = 0, True, set[int]()
        for body in self.bodies:
            before = self.vibrates and body.behind == TARGET
            for leads in (True, *[False] * (body.count - 1)):
                front = last[body.behind] if leads and body.behind and not before else number - 1
                if leads and before:
                    pushed.append(Link(None, number, 0.0, body.front_gap or 0.0, body.at))
                    beyond.add(number)
                elif not (leads and ended) or body.behind:
                    gap = body.front_gap if leads and body.front_gap is not None else row[front].gap
                    found.append(Link(front, number, (body.angle or 0.0) if leads else 0.0, gap))
                    beyond |= {number} if front in beyond else set()
                number += 1
            last[body.name], ended = number - 1, self.vibrates and bool(body.fixed or (body.at and not before))
        if self.target is not None:
            others = beyond | {link.front for link in found}
            found += [Link(k, None, 0.0, body.gap, body.at) for k, body in enumerate(row) if k not in others]
        return found + pushed

    @property
    def branches(self) -> bool:
        """Whether a body is behind another than the one before it."""
        return self.vibrates or any(x.behind is not None and x.body + 1 != x.behind for x in self.links)

    @property
    def link_names(self) -> list[str]:
        """What tables and messages call each of `links`: its number; in a tree those of its bodies."""
        links = self.links
        if not self.branches:
            return [str(number) for number in range(1, len(links) + 1)]
        return ["-".join(TARGET if end is None else str(end + 1) for end in link[:2]) for link in links]

    @cached_property
    def directions(self) -> list[float]:
        """Angle of each body's line to that of the first, rad."""
        found = [0.0] * len(self.row)
        for link in self.links:
            if link.front is not None and link.behind is not None:
                found[link.behind] = found[link.front] + link.angle
        return found

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
            if body.own_mass is None and not body.fixed
        ]
        if self.gravity and self.target is None:
            found.append(Mistake(None, None, "Chain.gravity", "is true: weight needs a target to fall onto"))
        if self.contact.friction not in (None, 0.0):
            found.append(
                Mistake(None, None, "contact.friction", "is given, but bodies of a chain touch without friction")
            )
        found += self._wrong_names()
        return found or self._wrong_contacts()

    def _wrong_names(self) -> list[Mistake]:
        """Mistakes in what says which body is in front of another."""
        found, known = list[Mistake](), dict[str, int]()
        for number, body in enumerate(self.bodies, 1):
            here = f"bodies[{number}]"
            given = [name for name in ("behind", "angle", "front_gap") if getattr(body, name) not in (None, "")]
            if self.vibrates and body.behind == TARGET:
                if body.angle is not None:
                    found.append(Mistake(None, None, f"{here}.angle", "is not for a body behind the target"))
            elif number == 1:
                what = "is not for the first body, which has none in front"
                found += [Mistake(None, None, f"{here}.{name}", what) for name in given]
            elif body.behind and body.behind not in known:
                what = f"{shown(body.behind)} is no name of a body before it{did_you_mean(body.behind, known)}"
                found.append(Mistake(None, None, f"{here}.behind", what))
            if body.name in known:
                what = f"{shown(body.name)} is the name of bodies[{known[body.name]}], too"
                found.append(Mistake(None, None, f"{here}.name", what))
            elif body.name:
                known[body.name] = number
        return found

    def _wrong_contacts(self) -> list[Mistake]:
        """Mistakes in what concerns a target that vibrates."""
        fronts, found, last = {link.front for link in self.links if link.behind is not None}, list[Mistake](), -1
        known = [sensor.name for sensor in (self.target.sensors if self.target else None) or ()]
        for number, body in enumerate(self.bodies, 1):
            here, last = f"bodies[{number}]", last + body.count
            touches = [name for name in ("at", "fixed") if getattr(body, name)]
            wrong = {
                name: "needs a target that vibrates: a plate, beam or structure"
                for name in touches
                if not self.vibrates
            }
            if body.at and self.vibrates and body.at not in known:
                wrong["at"] = f"{shown(body.at)} is no sensor of the target{did_you_mean(body.at, known)}"
            if last in fronts and (body.fixed or body.behind != TARGET):
                wrong |= dict.fromkeys(touches, "is not for a body with another one behind it")
            if body.fixed and (body.count > 1 or body.velocity):
                wrong["fixed"] = "is not for several bodies or one with a velocity"
            if body.name == TARGET and self.vibrates:
                wrong["name"] = f"{shown(TARGET)} is the structure: another name is needed"
            found += [Mistake(None, None, f"{here}.{name}", what) for name, what in wrong.items()]
        return found + (self._wrong_target() if self.vibrates and not found else [])

    def _wrong_target(self) -> list[Mistake]:
        """Mistakes of a target that vibrates, and of the points where it is touched."""
        from film_model.targets.several import struck_at

        target, wrong = self.target, dict[str, str]()
        assert target is not None
        if self.duration is None:
            wrong["Chain.duration"] = f"missing: how long to follow the bodies, as the {target.kind} goes on vibrating"
        if not target.finite:
            wrong["target.size"] = f"missing: the vibrations of an infinite {target.kind} are not simulated"
        elif target.modes_missing:
            wrong["target"] = target.modes_missing
        elif target.stretches:
            wrong["target.in_plane"] = "membrane forces are not simulated with bodies at several points: leave it out"
        else:
            for point in {link.at for link in self.links if None in link[:2]}:
                try:
                    struck_at(target, point)
                except SceneError as error:
                    wrong[f"sensor {shown(point)}"] = error.mistakes[0].message
        return [Mistake(None, None, key, what) for key, what in wrong.items()]

    def pairs(self, speed: float) -> list[Scene]:
        """Each of `links` as a scene of two bodies that approach with `speed` [m/s].

        Raises SceneError for what a law needs and its bodies do not say.
        """
        row, known, found = self.row, dict[tuple[int, int], Scene](), list[Scene]()
        places = [n for n, body in enumerate(self.bodies, 1) for _ in range(body.count)]
        for link in self.links:
            behind = None if link.front is None else link.behind
            key = places[link.body], 0 if behind is None else places[behind]
            if key not in known:
                try:
                    known[key] = self._pair(row[link.body], None if behind is None else row[behind], speed)
                except SceneError as error:
                    other = TARGET if behind is None else f"bodies[{key[1]}]"
                    raise SceneError(_renamed(m, f"bodies[{key[0]}]", other) for m in error.mistakes) from None
            found.append(known[key])
        return found

    def _pair(self, one: ChainBody, other: ChainBody | None, speed: float) -> Scene:
        mass = max(body.own_mass or 0.0 for body in self.bodies if not body.fixed) if one.fixed else one.own_mass
        ball = Sphere(f"{one.radius!r} m", f"{speed!r} m/s", mass=f"{mass!r} kg", material=one.material)
        if other is None:
            assert self.target is not None
            target = self.target
        else:
            target = Body(other.material, f"{other.radius!r} m", f"{other.own_mass!r} kg")
        return Scene(ball, target, one.contact or self.contact, Effects(gravity=False))

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str]) -> Chain:
        """Read a file with sections [[bodies]]; all its mistakes are raised in one SceneError."""
        return cls.from_text(*read_text(path), os.path.dirname(os.fspath(path)))

    @classmethod
    def from_text(cls, text: str, name: str = "chain", folder: str | None = "") -> Chain:
        """Read the text of such a file. name: of the file, in messages. folder: for relative paths; None: refuse
        them."""
        table = toml_table(text, name)
        find_files(table, text, name, folder)
        try:
            return cls.from_table(table)
        except SceneError as error:
            raise placed(error.mistakes, text, name) from None

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
                    entries[key] = Contact(**value) if key == "contact" else _target(value)
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
            sections["target"] = {"kind": self.target.kind, **table_of(self.target)}
        return sections | {
            key: {name: own[name] for name in inside if name in own} for key, inside in _SECTIONS.items()
        }

    def to_toml(self) -> str:
        """The text of a file from which :meth:`from_text` makes the same chain, to the last bit."""
        return text_from_table(self.to_table())


def _renamed(mistake: Mistake, one: str, other: str) -> Mistake:
    """A mistake of the scene of two bodies, with the names that they have in the chain."""
    key, message = (
        text.replace("impactor.", f"{one}.").replace("target.", f"{other}.")
        for text in (mistake.key.removeprefix("Scene."), mistake.message)
    )
    return replace(mistake, key=key, message=message)
