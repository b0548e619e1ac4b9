"""Reduced matrices of Nastran: entries DMIG of bulk data and punch files (Quick Reference Guide, "DMIG")."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import shown

SQUARE, SYMMETRIC, RECTANGULAR = "1", "6", ("2", "9")
"""Forms of matrices; of a symmetric one half is there."""

KINDS = {"K": "K", "M": "M", "B": "C"}
"""Matrices by the first letter of their names."""

_REAL = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[ED]?([+-]?\d+))?", re.IGNORECASE)
"""A real number: 1.5, 1.5E+3, 1.5D+3, or 1.5+3 for 1500."""

Point = tuple[int, int]
"""A grid point, and its component from 1 to 6; 0: a scalar point."""


def read_dmig(path: Path, most: int) -> tuple[dict[str, Array], list[Point]]:
    """K, M and C of matrices whose names begin with K (not K4, of structural damping), M and B, and their rows' points.

    Fields of 8 or 16 characters, or between commas. Rectangular matrices are left out. Raises ValueError for complex
    ones, two whose names begin alike, or more than `most` rows.
    """
    others = set[str]()
    names, forms, terms = dict[str, str](), dict[str, str](), dict[str, dict[tuple[Point, Point], float]]()
    for name, first, *rest in _entries(path.read_text("utf-8", errors="replace")):
        kind = KINDS.get(name[:1], "") if name[:2] != "K4" else ""
        if first == "0" and rest[0] in RECTANGULAR:
            others.add(name)
        if not kind or name in others:
            continue
        if names.setdefault(kind, name) != name:
            raise ValueError(f"{path}: matrices {names[kind]} and {name}: one with a name in {name[0]} is needed")
        try:
            if first == "0":
                forms[kind] = rest[0]
                if rest[0] not in (SQUARE, SYMMETRIC) or rest[1] not in ("1", "2"):
                    raise ValueError(f"form {rest[0]}, type {rest[1]}: form 1 or 6, real numbers (type 1 or 2), needed")
                continue
            column, own = _point(first, rest[0]), terms.setdefault(kind, {})
            for at in range(2, len(rest) - 2, 4):
                if rest[at]:
                    own[_point(rest[at], rest[at + 1]), column] = fortran_real(rest[at + 2])
        except ValueError as error:
            raise ValueError(f"{path}: DMIG {name}: {error}") from None
    for kind in terms:
        if kind not in forms:
            raise ValueError(f"{path}: DMIG {names[kind]}: the entry with its form is missing")
    points = sorted({point for own in terms.values() for pair in own for point in pair})
    if len(points) > most:
        raise ValueError(f"{path}: {len(points)} rows: 1 to {most} are allowed; reduce the model, or export its shapes")
    number = {point: k for k, point in enumerate(points)}
    matrices = {kind: np.zeros((len(points), len(points))) for kind in terms}
    for kind, own in terms.items():
        for (row, column), value in own.items():
            matrices[kind][number[row], number[column]] = value
            if forms[kind] == SYMMETRIC:
                matrices[kind][number[column], number[row]] = value
    return matrices, points


def _entries(text: str) -> list[list[str]]:
    """The fields of each entry DMIG with those of its continuations, without its first word."""
    found, inside = list[list[str]](), False
    for line in (line.partition("$")[0].expandtabs(8) for line in text.splitlines()):
        word = line.partition(",")[0] if "," in line else line[:8]
        count, width = (4, 16) if "*" in word else (8, 8)
        fields = line.split(",")[1:] if "," in line else [line[k : k + width] for k in range(8, 72, width)]
        fields = [field.strip().upper() for field in (*fields, *[""] * count)][:count]
        if word[:1].isalpha():
            inside = word.strip(" *").upper() == "DMIG"
            found += [fields] if inside else []
        elif inside and any(fields):
            found[-1] += fields
    return found


def _point(point: str, component: str) -> Point:
    if not (point.isdecimal() and (component or "0").isdecimal()):
        raise ValueError(f"{shown(point)}, {shown(component)}: the numbers of a point and a component are needed")
    return int(point), int(component or 0)


def fortran_real(text: str) -> float:
    match = _REAL.fullmatch(text)
    if match is None:
        raise ValueError(f"{shown(text)} is not a real number")
    return float(f"{match[1]}e{match[2] or 0}")
