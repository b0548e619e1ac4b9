"""Sweep files: a sweep written in TOML beside the file of its scene."""

from __future__ import annotations

import difflib
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from film_datasets.sweeps.axis_reading import FORMS
from film_datasets.sweeps.definition import OPTIONS, Sweep
from film_datasets.sweeps.design_table import over_of_file
from film_datasets.sweeps.designs import GRID, ZIP, option_mistakes
from film_model.base.errors import Mistake, SceneError, did_you_mean, shown
from film_model.scene import Scene
from film_model.scene.toml import WITH_FILES, line_of, lines_of_keys, read_text, toml_table

KEYS = ("scene", "design", *OPTIONS, "over")


def read_sweep(
    path: str | os.PathLike[str], keep: str = "summary", derivatives: Sequence[str] = (), variables: Sequence[str] = ()
) -> Sweep:
    """Read a sweep file; the scene it names is in the same folder. All mistakes are raised in one SceneError.

    derivatives, variables: in place of those in the file, unless empty.
    """
    text, name = read_text(path)
    folder = Path(path).parent
    given = {key: names for key, names in (("derivatives", derivatives), ("variables", variables)) if names}
    return sweep_from_text(text, name, lambda scene: Scene.from_toml(folder / scene), keep, folder, given)


def sweep_from_text(
    text: str,
    name: str,
    read_scene: Callable[[str], Scene],
    keep: str = "summary",
    folder: Path = Path(),
    instead: Mapping[str, Any] = MappingProxyType({}),
) -> Sweep:
    """A sweep from the text of a sweep file called `name`.

    folder: of the files that it names. instead: values that replace those of the file, by key.
    """
    given = toml_table(text, name)
    table = {_closest_key(key): value for key, value in given.items()} | given
    if isinstance(table.get("design"), Mapping):
        table |= _own_table(table, folder)
    mistakes = _key_mistakes(given, table)
    has_over = isinstance(table.get("over"), Mapping)
    over = _flat(table["over"]) if has_over else {}
    sections = [section for key in WITH_FILES if isinstance(over.get(key), list) for section in over[key]]
    for section in sections:
        if isinstance(section, dict) and isinstance(section.get("file"), str):
            section["file"] = str(folder / section["file"])
    options = {key: table[key] for key in OPTIONS if key in table} | dict(instead)
    design, scene, sweep = table.get("design", GRID), None, None
    try:
        scene = read_scene(table["scene"]) if isinstance(table.get("scene"), str) else None
        sweep = Sweep.of(scene, over, design, **options, keep=keep) if scene is not None and has_over else None
    except SceneError as error:
        mistakes += error.mistakes
    if scene is None or not has_over:  # `Sweep.of` was not called and has not checked these
        mistakes += option_mistakes(design, options.get("samples"), options.get("seed"))
    if sweep is None or mistakes:
        lines = lines_of_keys(text)
        elsewhere = {*instead, *({"keep"} - given.keys())}
        own = [
            m if m.file or m.key in elsewhere else replace(m, file=name, line=_line(lines, m.key, over))
            for m in mistakes
        ]
        raise SceneError(sorted(own, key=lambda m: (m.file != name, m.line or 0)))
    return sweep


def _closest_key(key: str) -> str:
    """The key of a sweep file that a misspelt one is closest to, so that its value is checked too."""
    return next(iter(difflib.get_close_matches(key, KEYS, 1)), key)


def _key_mistakes(given: Mapping[str, Any], table: Mapping[str, Any]) -> list[Mistake]:
    """Unknown and missing keys of a sweep file; `table` has the misspelt ones under the correct keys too."""
    if "impactor" in given and "over" not in given:
        why = "this is a scene; a sweep names the file of its scene and has a section [over]"
        return [Mistake(None, None, "impactor", why)]
    mistakes = [Mistake(None, None, key, f"unknown key{did_you_mean(key, KEYS)}") for key in given if key not in KEYS]
    for key, kind, what in (("scene", str, "the name of a scene file"), ("over", Mapping, "a section [over]")):
        if key not in table:
            mistakes.append(Mistake(None, None, key, f"missing: {what} is needed"))
        elif not isinstance(table[key], kind):
            mistakes.append(Mistake(None, None, key, f"{shown(table[key])} is not allowed: {what} is needed"))
    return mistakes


def _own_table(table: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The keys `design` and `over` for `design = { file = "runs.csv" }`."""
    design = table["design"]
    if list(design) != ["file"] or not isinstance(design["file"], str):
        raise SceneError([Mistake(None, None, "design", 'a word or { file = "runs.csv" } is needed')])
    if "over" in table:
        raise SceneError(
            [Mistake(None, None, "over", "the table of the design has what is swept: give one of the two")]
        )
    return {"design": ZIP, "over": over_of_file(folder / design["file"])}


def _flat(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested tables, which unquoted keys with dots make, by their paths."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        plain = not isinstance(value, Mapping) or "." in key or any(k in FORMS for k in value)
        flat |= {prefix + key: value} if plain else _flat(value, f"{prefix}{key}.")
    return flat


def _line(lines: Mapping[str, int], key: str, over: Mapping[str, Any]) -> int | None:
    """The line of a key; the keys of `over` are quoted in the file."""
    for path in over:
        if key == f"over.{path}" or key.startswith(f"over.{path}."):
            return lines.get(f'over."{path}"') or line_of(lines, key)
    return line_of(lines, key)
