"""Markdown for the reference pages."""

from collections.abc import Iterable

from film_model.base.units import scene_unit

MADE = "<!-- written by examples/reference_pages.py -->\n\n"


def table(headings: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table."""
    lines = [list(headings), *map(list, rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines) + "\n"


def words(choices: Iterable[object]) -> str:
    """Words as TOML has them: `"a"` or `"b"`."""
    return " or ".join(f'`"{word}"`' for word in choices)


def unit(dimension: str) -> str:
    """The SI unit of a dimension; empty if it has none."""
    return f"`{scene_unit(dimension)}`" if scene_unit(dimension) else ""
