"""Vibrations in printed results of Abaqus and CalculiX (.dat): the table of eigenvalues of a *FREQUENCY step, and those
of the displacements, U, of each vibration, which *NODE PRINT asks for."""

from __future__ import annotations

import re
from pathlib import Path

from film_model.targets.dmig import fortran_real
from film_model.targets.result_modes import ResultModes, frequency_of

HEADING = re.compile(r"\s*[A-Z] (?:[A-Z] )+")
"""How a heading begins, in spaced letters: `E I G E N V A L U E    O U T P U T`."""

DIRECTIONS = ("U1", "U2", "U3")

OF_CALCULIX = 4
"""Numbers beside that of a vibration in the table of eigenvalues: ω², ω, frequency, imaginary part of ω; shapes are of
mass 1. Abaqus has five, of which the last are the modal mass and the damping ratio."""

NUMBER = re.compile(r"EIGENVALUENUMBER(\d+)")
"""The heading of what is printed of a vibration."""

REST = (0.0, 0.0, 0.0)

BESIDE = ("MODE", "REAL", "(RAD/TIME)", "NOTE")
"""First words of lines between a table's heading and its rows."""

WHOLE = "THE ANALYSIS HAS BEEN COMPLETED"
"""Near the end of a file of Abaqus."""


def read_dat(path: Path) -> ResultModes:
    """Of the one *FREQUENCY step in a file, at the nodes of all sets that it prints.

    Abaqus does not print nodes that do not move: a node that is printed for some vibrations rests in the others.
    Eigenvalues of cyclic structures, which have nodal diameters, are not read. Raises ValueError for a file that is cut
    or without displacements, and for a row that is not one of numbers.
    """
    eigenvalues, shapes = dict[int, list[float]](), dict[int, dict[int, tuple[float, ...]]]()
    text = path.read_text("latin-1")
    table, mode, columns, titles = "", 0, list[str](), list[str]()
    for line in text.splitlines():
        words = line.replace("*", " ").split()
        if HEADING.match(line):
            heading = line.replace(" ", "")
            table = "eigenvalues" if heading == "EIGENVALUEOUTPUT" else ""
            match = NUMBER.fullmatch(heading)
            mode = int(match[1]) if match else 0 if heading.startswith("STEP") else mode
            titles = [] if match else titles
        elif words[:2] in (["NODE", "FOOT-"], ["displacements", "(vx,vy,vz)"]):
            columns = words[2:] if words[0] == "NODE" else list(DIRECTIONS)
            if words[0] != "NODE":  # a later step, without heading in some versions: the same set, or another time
                mode = 0 if any(title == line or title.split()[-1] != words[-1] for title in titles) else mode
                titles.append(line)
            table = ""
            if mode in eigenvalues and not set(DIRECTIONS).isdisjoint(columns):
                table = "displacements"
                shapes.setdefault(mode, {})
        elif table and len(words) > 1 and words[0].isdecimal():
            number = int(words[0])
            if table == "displacements":
                values = dict(zip(columns, _row(path, line, len(columns)), strict=True))
                shapes[mode][number] = tuple(values.get(name, 0.0) for name in DIRECTIONS)
            elif len(words) > OF_CALCULIX:
                if number in eigenvalues:
                    raise ValueError(f"{path}: vibration {number} is there twice: print those of one *FREQUENCY step")
                eigenvalues[number] = _row(path, line, len(words) - 1)
        elif words and words[0] not in BESIDE:
            table = ""
    abaqus = any(len(values) > OF_CALCULIX for values in eigenvalues.values())
    equal = eigenvalues.keys() == shapes.keys() and len(set(map(len, shapes.values()))) == 1
    if eigenvalues and not (WHOLE in text if abaqus else not shapes or (equal and text.endswith("\n"))):
        raise ValueError(f"{path} is cut, or its analysis did not end")
    if eigenvalues and not shapes:
        need = "print them by *NODE PRINT with U"
        raise ValueError(f"{path} has the frequencies of {len(eigenvalues)} vibrations, but no displacements: {need}")
    return _found(path, eigenvalues, shapes)


def _found(
    path: Path, eigenvalues: dict[int, list[float]], shapes: dict[int, dict[int, tuple[float, ...]]]
) -> ResultModes:
    found, printed = ResultModes(), {node for shape in shapes.values() for node in shape}
    for number, shape in shapes.items():
        square, *_, mass, damping = eigenvalues[number]
        found.add(path, number, frequency_of(square)).update({node: shape.get(node, REST) for node in printed})
        if len(eigenvalues[number]) > OF_CALCULIX:
            found.mass[number], found.damping[number] = mass, damping
    return found


def _row(path: Path, line: str, count: int) -> list[float]:
    """The last numbers of a row, before which are its own number and perhaps a footnote."""
    words = line.replace("*", " ").split()
    try:
        if not count < len(words) <= count + 2:
            raise ValueError
        return [fortran_real(word) for word in words[-count:]]
    except ValueError:
        raise ValueError(f'{path}: "{line.strip()[:60]}" is not a row of {count} numbers') from None
