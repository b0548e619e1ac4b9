"""Scene files: TOML in and out, with the line of every mistake."""

from __future__ import annotations

import copy
import os
import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, cast

from film_model.bodies import Beam, Body, HalfSpace, Plate, Rod, Sphere, Target
from film_model.contact import Contact, contact_table
from film_model.errors import Mistake, SceneError, did_you_mean, raise_all, shown
from film_model.fields import build, key_text, table_of
from film_model.scene import Effects, Scene, Solver

LARGEST_FILE = 1_000_000  # bytes; a scene has a thousand

KINDS: dict[str, type[Target]] = {cls.kind: cls for cls in (HalfSpace, Plate, Beam, Rod, Body)}


def read_scene(path: str | os.PathLike[str]) -> Scene:
    """The scene in a file."""
    text, name = read_text(path)
    return scene_from_text(text, name, os.path.dirname(os.fspath(path)))


def read_text(path: str | os.PathLike[str]) -> tuple[str, str]:
    """The text of a scene file or another of its kind, and its name for messages. Raises SceneError."""
    name = os.fspath(path)
    shown_name = name if name.isprintable() else ascii(name)
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST_FILE + 1)
        if len(data) > LARGEST_FILE:
            raise ValueError(f"is larger than {LARGEST_FILE // 1_000_000} MB, and so no scene file")
        text = data.decode("utf-8-sig")
    except OSError as error:
        raise SceneError([Mistake(shown_name, None, "", f"cannot be read: {error.strerror or error}")]) from None
    except UnicodeDecodeError as error:
        what = f"is not UTF-8 text: byte {error.object[error.start]:#04x} at offset {error.start}"
        line = error.object[: error.start].count(b"\n") + 1
        raise SceneError([Mistake(shown_name, line, "", what)]) from None
    except ValueError as error:
        raise SceneError([Mistake(shown_name, None, "", str(error))]) from None
    return text, shown_name


def scene_from_text(text: str, name: str, folder: str = "") -> Scene:
    """The scene in the text of a scene file called `name`; files that it names are looked for in `folder`."""
    table = toml_table(text, name)
    contact = table.get("contact")
    if isinstance(contact, dict) and isinstance(contact.get("file"), str):
        contact["file"] = os.path.join(folder, contact["file"])
    try:
        return scene_from_table(table)
    except SceneError as error:
        lines = lines_of_keys(text)
        placed = [replace(m, file=name, line=line_of(lines, m.key)) for m in error.mistakes]
        raise SceneError(sorted(placed, key=lambda m: m.line or 0)) from None


def toml_table(text: str, name: str) -> dict[str, Any]:
    """The table in the text of a TOML file called `name`. Raises SceneError with the line of a mistake."""
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except (ValueError, OverflowError, RecursionError) as error:
        message = str(error) if str(error).isprintable() else ascii(str(error))
        found = re.search(r" \(at line ([0-9]+), column ([0-9]+)\)", message)
        line = int(found[1]) if found else text.count("\n") + 1 if "end of document" in message else None
        raise SceneError([Mistake(name, line, "", f"not TOML: {message}")]) from None


def scene_from_table(table: Mapping[str, Any]) -> Scene:
    """The scene in nested tables laid out as in a scene file."""
    makers: dict[str, Callable[[dict[str, Any]], Any]] = {
        "impactor": lambda section: build(Sphere, section),
        "target": _target,
        "contact": lambda section: Contact(**section),
        "effects": lambda section: build(Effects, section),
        "solver": lambda section: build(Solver, section),
    }
    mistakes: list[Mistake] = []
    parts: dict[str, Any] = {}
    for key, value in table.items():
        if key == "title":
            parts[key] = value
        elif key not in makers:
            hint = did_you_mean(key, ["title", *makers])
            mistakes.append(Mistake(None, None, key_text(key), f"unknown key{hint}"))
        elif not isinstance(value, Mapping):
            mistakes.append(Mistake(None, None, key, f"{shown(value)} is not allowed: a section [{key}] is needed"))
        else:
            try:
                parts[key] = makers[key](dict(cast("Mapping[str, Any]", value)))
            except SceneError as error:
                mistakes += [mistake.moved(key) for mistake in error.mistakes]
    missing = [key for key in ("impactor", "target") if key not in table]
    mistakes += [Mistake(None, None, key, f"missing: a section [{key}] is needed") for key in missing]
    if not isinstance(parts.get("title", ""), str):
        mistakes.append(Mistake(None, None, "title", f"{shown(parts['title'])} is not a text"))
    raise_all(mistakes)
    try:
        return Scene(**parts)
    except SceneError as error:
        raise SceneError(mistake.moved("") for mistake in error.mistakes) from None


def _target(section: dict[str, Any]) -> Target:
    kind = section.pop("kind", None)
    if isinstance(kind, str) and kind in KINDS:
        return build(KINDS[kind], section)
    need = ", ".join(f'"{known}"' for known in KINDS) + " is needed"
    if kind is None:
        raise SceneError([Mistake(None, None, "Target.kind", f"missing: {need}")])
    hint = did_you_mean(kind, KINDS) if isinstance(kind, str) else ""
    raise SceneError([Mistake(None, None, "Target.kind", f"{shown(kind)} is not allowed: {need}{hint}")])


def table_from_scene(scene: Scene) -> dict[str, Any]:
    """Nested tables from which :func:`scene_from_table` makes the same scene."""
    sections = {
        "impactor": table_of(scene.impactor),
        "target": {"kind": scene.target.kind, **table_of(scene.target)},
        "contact": contact_table(scene.contact),
        "effects": table_of(scene.effects),
        "solver": table_of(scene.solver),
    }
    return {"title": scene.title, **sections} if scene.title else sections


def change_table(table: dict[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The table with the entries at paths such as "impactor.velocity" changed, or taken out where None.

    Segments take the place of an accuracy, which may be the default that nobody gave, and the other way round.
    """
    table, given = copy.deepcopy(table), {path for path, value in changes.items() if value is not None}
    meshes = {"solver.segments": "solver.accuracy", "solver.accuracy": "solver.segments"}
    replaced = {other: None for path, other in meshes.items() if path in given and other not in given}
    for path, value in {**changes, **replaced}.items():
        *sections, key = path.split(".")
        section = table
        for name in sections:
            section = section.setdefault(name, {})
            if not isinstance(section, dict):
                raise SceneError([Mistake(None, None, path, f"{name} has no entries of its own")])
            section = cast("dict[str, Any]", section)
        if value is None:
            section.pop(key, None)
        else:
            section[key] = value
    return table


def text_from_table(table: Mapping[str, Any]) -> str:
    """The text of a scene file with these nested tables."""
    return "\n".join(_section_lines("", table)).lstrip("\n") + "\n"


def _section_lines(path: str, table: Mapping[str, Any]) -> list[str]:
    plain = {key: value for key, value in table.items() if not isinstance(value, dict)}
    lines = ["", f"[{path}]"] if path and plain else []
    lines += [f"{key} = {_toml(value)}" for key, value in plain.items()]
    for key, value in table.items():
        if isinstance(value, dict):
            lines += _section_lines(f"{path}.{key}".lstrip("."), cast("dict[str, Any]", value))
    return lines


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        import json

        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, cast("list[object]", value))) + "]"
    if isinstance(value, int | float):
        return repr(value)
    raise ValueError(f"{shown(value)} cannot be written to a scene file")


_PART = r"""(?:"(?:[^"\\]|\\.)*"|'[^']*'|[A-Za-z0-9_-]+)"""
_PATH = re.compile(rf"{_PART}(?:\s*\.\s*{_PART})*")


def lines_of_keys(text: str) -> dict[str, int]:
    """The line of every key, by its path. tomllib does not say; a key in an inline table has its table's line."""
    lines: dict[str, int] = {}
    section, quotes = "", ""
    for number, whole_line in enumerate(text.split("\n"), 1):
        line = whole_line.strip()
        if quotes:  # inside a text of several lines
            quotes = "" if quotes in line else quotes
            continue
        header = re.match(r"\[{1,2}\s*", line)
        path = _PATH.match(line, header.end() if header else 0)
        if path is not None:
            rest = line[path.end() :].lstrip()
            keys = [key_text(_unquoted(part)) for part in re.findall(_PART, path[0])]
            if rest.startswith("]" if header else "="):
                section = "" if header else section
                for key in (keys[0], ".".join(keys)):
                    lines.setdefault(f"{section}.{key}".lstrip("."), number)
                section = ".".join(keys) if header else section
        quotes = next((q for q in ('"""', "'''") if line.count(q) % 2), "")
    return lines


def _unquoted(part: str) -> str:
    return part[1:-1] if part[0] in "\"'" else part


def line_of(lines: Mapping[str, int], key: str) -> int | None:
    """The line of the key, or of the nearest table round it."""
    while key and key not in lines:
        key = key.rpartition(".")[0]
    return lines.get(key)
