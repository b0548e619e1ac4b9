"""Scene files as text: TOML to nested tables and back, line numbers of keys, changes by path, and the target."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, cast

from film_model.base.errors import Mistake, SceneError, shown
from film_model.base.fields import key_text, table_of
from film_model.base.files import read_bytes
from film_model.base.hdf5 import AN_FMU

LARGEST_FILE = 1_000_000  # bytes; a typical scene file has 1000
NO_SCENES = {
    ".csv": "is a table",
    ".nc": 'is a dataset: "film-model plot" and "film-model check" read it',
    ".zarr": 'is a dataset: "film-model plot" and "film-model check" read it',
    ".fmu": AN_FMU,
}
"""Files that are given in place of a scene."""

OTHER_FILES = {
    "over": 'this is a sweep: give it to "film-model sweep" or "film-model tolerance"',
    "bodies": 'this is a chain: "film-model run" and Chain.from_toml read it',
}
"""Sections of other files that are given in place of a scene."""

NO_FILES = "a scene that is stored with results has its tables inside, and no other file is read"

WITH_FILES = ("contact", "target")
"""Sections that may name the file of a table with `file`."""

LARGEST_TABLE = 100_000_000  # bytes; a million rows of five numbers


def read_text(path: str | os.PathLike[str], most: int = LARGEST_FILE) -> tuple[str, str]:
    """The text of a file of at most `most` bytes, and its name as messages show it. Raises SceneError."""
    name = os.fspath(path)
    shown_name = name if name.isprintable() else ascii(name)
    what = NO_SCENES.get(os.path.splitext(name)[1].lower()) if most == LARGEST_FILE else None
    if what and (os.path.isfile(path) or os.path.isdir(path)):
        raise SceneError([Mistake(shown_name, None, "", f"{what}; a scene or a sweep (TOML) is needed")])
    try:
        text = read_bytes(path, most).decode("utf-8-sig")
    except OSError as error:
        raise SceneError([Mistake(shown_name, None, "", f"cannot be read: {error.strerror or error}")]) from None
    except UnicodeDecodeError as error:
        what = f"is not UTF-8 text: byte {error.object[error.start]:#04x} at offset {error.start}"
        line = error.object[: error.start].count(b"\n") + 1
        raise SceneError([Mistake(shown_name, line, "", what)]) from None
    except ValueError as error:
        raise SceneError([Mistake(shown_name, None, "", str(error))]) from None
    return text, shown_name


_KEY = re.compile(r"""^[ \t]*(?:\[{1,2}[^\]=,\n]*\]|(?:"[^"\n]*"|'[^'\n]*'|[^=\n"'\[\]{},#])+=)""", re.MULTILINE)
"""A section's heading, or a key up to its equal sign, at the beginning of a line."""


def toml_table(text: str, name: str) -> dict[str, Any]:
    """The table in the text of a TOML file called `name`. Raises SceneError with the line of a mistake."""
    most_levels = 20
    most_keys = 2000  # the time of tomllib grows with the square of keys and of their parts
    for count, key in enumerate(_KEY.finditer(text), 1):
        too_many = count > most_keys
        if too_many or key[0].count(".") >= most_levels:
            what = f"more than {most_keys} keys" if too_many else f"a key of more than {most_levels} parts"
            raise SceneError([Mistake(name, text.count("\n", 0, key.start()) + 1, "", what)])
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except (ValueError, OverflowError, RecursionError) as error:
        message = str(error) if str(error).isprintable() else ascii(str(error))
        found = re.search(r" \(at line ([0-9]+), column ([0-9]+)\)", message)
        line = int(found[1]) if found else text.count("\n") + 1 if "end of document" in message else None
        raise SceneError([Mistake(name, line, "", f"not TOML: {message}")]) from None


_IN_PLACE_OF = {
    "solver.segments": "solver.accuracy",
    "solver.accuracy": "solver.segments",
    "impactor.diameter": "impactor.radius",
    "target.diameter": "target.radius",
    "impactor.material.yield_strength": "impactor.material.hardness",
    "target.material.yield_strength": "target.material.hardness",
}
"""A number that is set → the one that it replaces."""


def in_place_of(path: str) -> str | None:
    """The number that no longer holds where the one at a path is set; None if there is none."""
    return _IN_PLACE_OF.get(path)


def change_table(table: dict[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The table, in which the entries at paths such as "impactor.velocity" are changed, or removed where None.

    A number replaces the other one that says the same (`_IN_PLACE_OF`), unless both are given. table: its parts may be
    objects, which become tables where an entry of theirs is changed.
    """
    given = {path for path, value in changes.items() if value is not None}
    ball = table.get("target", {}).get("kind") == "body"
    others = {in_place_of(path) for path in given if ball or path != "target.diameter"}
    replaced = dict.fromkeys(other for other in others if other is not None and other not in given)
    for path, value in {**changes, **replaced}.items():
        *sections, key = path.split(".")
        section = table
        for name in sections:
            if hasattr(section.get(name), "FIELDS"):
                section[name] = table_of(section[name])
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
    if isinstance(value, dict):
        entries = (f"{key} = {_toml(item)}" for key, item in cast("dict[str, object]", value).items())
        return "{ " + ", ".join(entries) + " }"
    raise ValueError(f"{shown(value)} cannot be written to a scene file")


_PART = r"""(?:"(?:[^"\\]|\\.)*"|'[^']*'|[A-Za-z0-9_-]+)"""
_PATH = re.compile(rf"{_PART}(?:\s*\.\s*{_PART})*")


def lines_of_keys(text: str) -> dict[str, int]:
    """The line of every key, by its path, which tomllib does not report. Keys of an inline table have its line; those
    of the second section [[bodies]] are bodies[2].radius, too."""
    lines: dict[str, int] = {}
    section, quotes, place = "", "", ""
    count = dict[str, int]()
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
                if header:
                    place = ".".join(keys)
                    count[place] = count.get(place, 0) + 1
                    place = f"{place}[{count[place]}]"
                    lines[place] = number
                for key in (keys[0], ".".join(keys)):
                    lines.setdefault(f"{section}.{key}".lstrip("."), number)
                    if not header:
                        lines.setdefault(f"{place}.{key}", number)
                section = ".".join(keys) if header else section
        quotes = next((q for q in ('"""', "'''") if line.count(q) % 2), "")
    return lines


def _unquoted(part: str) -> str:
    return part[1:-1] if part[0] in "\"'" else part


def line_of(lines: Mapping[str, int], key: str) -> int | None:
    """The line of the key, or of the innermost table that contains it."""
    while key and key not in lines:
        key = key.rpartition(".")[0]
    return lines.get(key)


def placed(mistakes: Iterable[Mistake], text: str, name: str) -> SceneError:
    """The mistakes in a text, each with the file `name` and its line, sorted by line."""
    lines = lines_of_keys(text)
    found = [replace(m, file=name, line=line_of(lines, m.key)) for m in mistakes]
    return SceneError(sorted(found, key=lambda m: m.line or 0))


def refuse_others(table: Mapping[str, Any], text: str, name: str) -> None:
    """Raise SceneError for the table of another file in place of a scene."""
    other = next((key for key in OTHER_FILES if key in table), None)
    if other is not None and "impactor" not in table:
        raise placed([Mistake(None, None, other, OTHER_FILES[other])], text, name)


def find_files(table: dict[str, Any], text: str, name: str, folder: str | None) -> None:
    """Put the folder before the relative paths in a table; None: refuse them."""
    for key in WITH_FILES:
        section = table.get(key)
        if isinstance(section, dict) and "file" in section:
            if folder is None:
                raise placed([Mistake(None, None, f"{key}.file", NO_FILES)], text, name)
            if isinstance(section["file"], str):
                section["file"] = os.path.join(folder, section["file"])
