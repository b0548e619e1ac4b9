"""Vibrations in results of Nastran: binary files (.op2, tables OUG and LAMA) and punch files ($EIGENVECTOR)."""

from __future__ import annotations

import mmap
import re
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path

import numpy as np

from film_model.targets.result_modes import ResultModes, frequency_of

SHAPES, MASSES = ("OUG", "BOUG", "OPHIG", "BOPHIG"), ("LAMA", "BLAMA")
"""How the names of tables of eigenvectors, and of eigenvalues with modal masses, begin."""

FIRST = {np.array([word], f"{order}i4").tobytes(): (order, word) for order in "<>" for word in (4, 8)}
"""How a file begins, with the length of its first record, by the order and length of its words."""

EIGENVALUES, EIGENVECTOR, NODE_ROW = 2, 7, 8
"""Of the record before a table: the approach of real vibrations, the kind of the table, and the words a node, of which
complex vibrations have 14."""

MASS_ROW = ("number", "order", "ω²", "ω", "frequency", "modal mass", "modal stiffness")
"""The words of a vibration in the table of masses."""

PUNCHED = "$EIGENVECTOR"
"""How the vibrations begin in a punch file."""

_MODE = re.compile(r"\$EIGENVALUE = *([-+.\dE]+) +MODE = *(\d+)")


def read_op2(path: Path) -> ResultModes:
    """Of words of 4 or 8 bytes, in either order. Raises ValueError for a file that is not whole."""
    found = ResultModes()
    if path.stat().st_size == 0:
        raise ValueError(f"{path} is empty")
    with path.open("rb") as file, closing(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)) as data:
        if data[:4] not in FIRST:
            raise ValueError(f"{path} is not a results file of Nastran")
        order, word = FIRST[data[:4]]
        whole, real = f"{order}i{word}", f"{order}f{word}"
        for name, records in _tables(path, data, whole):
            if found.shape and name.startswith(SHAPES):
                continue  # the same under another name
            masses = name.startswith(MASSES)
            for head, body in zip(records[3::2], records[4::2], strict=False):
                codes, numbers = np.frombuffer(head, whole), np.frombuffer(head, real)
                modal = len(codes) > 9 and (codes[0] // 10, codes[1], codes[9]) == (EIGENVALUES, EIGENVECTOR, NODE_ROW)
                if not (masses or modal):
                    continue
                count = len(MASS_ROW) if masses else NODE_ROW
                if len(body) % (count * word):
                    raise ValueError(f"{path}: the table {name} is damaged")
                first, rows = np.frombuffer(body, whole)[::count].tolist(), np.frombuffer(body, real).reshape(-1, count)
                if masses:
                    found.mass |= dict(zip(first, rows[:, MASS_ROW.index("modal mass")].tolist(), strict=True))
                else:
                    shape = found.add(path, int(codes[4]), frequency_of(float(numbers[5])))
                    shape |= {
                        node // 10: (x, y, z) for node, (x, y, z) in zip(first, rows[:, 2:5].tolist(), strict=True)
                    }
    return found


def _tables(path: Path, data: mmap.mmap, whole: str) -> Iterator[tuple[str, list[bytes]]]:
    """Names and records of the tables of eigenvectors and masses.

    A file is a row of Fortran's records. One of a word is a marker: n > 0 says that n words follow, −k that record k
    ends, 0 that the table ends. A record begins with one word, its type, and the first is the table's name.
    """
    word, at = np.dtype(whole).itemsize, 0
    name, records, parts, fresh = "", list[bytes](), list[bytes](), False
    damaged = f"{path} is damaged, or not a results file of Nastran"

    def block() -> bytes:
        nonlocal at
        size = int(np.frombuffer(data, f"{whole[0]}i4", 1, at)[0]) if at + 4 <= len(data) else -1
        first, at = at + 4, at + size + 8
        ends = data[first + size : at] if size >= 0 and at <= len(data) else b""
        if ends != data[first - 4 : first]:
            raise ValueError(f"{damaged}: a record at byte {first - 4}")
        return data[first : first + size]

    while at < len(data):
        marker = block()
        if len(marker) != word:
            raise ValueError(f"{damaged}: a marker before byte {at}")
        count = int(np.frombuffer(marker, whole)[0])
        if count > 0:
            part = block()
            if len(part) % word:
                raise ValueError(f"{damaged}: the block before byte {at}")
            if not (fresh and count == 1) and (not records or name):
                parts.append(part)
            fresh = False
            continue
        if not records and parts and len(parts[0]) == 2 * word:
            text = parts[0].decode("latin-1")
            text = (text if word == 4 else text[:4] + text[8:12]).strip()
            name = text if text.startswith((*SHAPES, *MASSES)) else ""
        records, parts, fresh = [*records, b"".join(parts)], [], True
        if count == 0:
            if name:
                yield name, records
            name, records, fresh = "", [], False


def has_vibrations(path: Path) -> bool:
    """Whether a text file of Nastran has vibrations."""
    with path.open(encoding="latin-1") as lines:
        return any(line.startswith(PUNCHED) for line in lines)


def read_punch(path: Path) -> ResultModes:
    """Of a punch file; its shapes are taken as normalised by mass. Raises ValueError for a line that is not as it
    should be."""
    found, shape, inside = ResultModes(), dict[int, Sequence[float]](), False
    for line in path.read_text("latin-1").splitlines():
        words = line[:72].split()
        if line.startswith("$"):
            inside = inside or line.startswith(PUNCHED)
            if line.startswith("$TITLE"):
                inside = False
            elif inside and (match := _MODE.match(line)):
                shape = found.add(path, int(match[2]), frequency_of(float(match[1])))
        elif inside and found.shape and words and words[0] != "-CONT-":
            try:
                shape[int(words[0])] = (float(words[2]), float(words[3]), float(words[4]))
            except (ValueError, IndexError):
                raise ValueError(f'{path}: "{line[:72].strip()[:60]}" is not the displacement of a node') from None
    return found
