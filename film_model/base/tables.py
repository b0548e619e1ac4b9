"""Reading of CSV tables: UTF-8, separated by commas, semicolons or tabs, with lines that begin with # as comments."""

from __future__ import annotations

import re
from collections.abc import Iterator

from film_model.base.errors import shown

HEADING = re.compile(r"\s*(\w+)\s*(?:[(\[]\s*(.*?)\s*[)\]])?\s*")
"""A column's name, and its unit in brackets."""


def rows_of(path: str, text: str) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of every row that is not empty or a comment."""
    import csv

    lines = text.splitlines()
    first = next((line for line in lines if line.strip() and not line.lstrip().startswith("#")), "")
    separator = next((mark for mark in "\t;," if mark in first), ",")
    for number, line in enumerate(lines, 1):
        if line.strip() and not line.lstrip().startswith("#"):
            try:
                yield number, next(csv.reader([line], delimiter=separator))
            except csv.Error as error:
                raise ValueError(f"{shown(path)}, line {number}: {error}") from None
