"""What the commands share: exit statuses, common options, checks of output files, and JSON."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable
from typing import Any

from film_model.base.files import check_replaceable

DONE, WRONG, FAILED = 0, 2, 3
"""Exit statuses: done; the scene or the command line is wrong; the work failed."""


def add_json(parser: argparse.ArgumentParser) -> None:
    """The option --json."""
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def add_force(parser: argparse.ArgumentParser, what: str = "overwrite existing output files") -> None:
    """The option --force."""
    parser.add_argument("--force", action="store_true", help=what)


def add_plot(parser: argparse.ArgumentParser, what: str) -> None:
    """The option --plot."""
    parser.add_argument("--plot", metavar="FILE", help=f"{what} (.png, .svg or .pdf)")
    add_style(parser)


def add_style(parser: argparse.ArgumentParser) -> None:
    """The option --style, of pictures."""
    parser.add_argument("--style", choices=("screen", "paper", "dark"), help="of the picture (default: screen)")


def print_json(table: dict[str, Any]) -> int:
    """Print one JSON object, with escapes if the terminal's encoding is not Unicode; returns DONE."""
    import json

    escaped = not (sys.stdout.encoding or "").lower().startswith("utf")
    print(json.dumps(table, indent=2, ensure_ascii=escaped, allow_nan=False))
    return DONE


def print_written(*paths: str | None) -> None:
    """Say which files were written."""
    for path in filter(None, paths):
        print(f"wrote {path}", file=sys.stderr)


def print_note(sentence: str) -> None:
    """Print a sentence to standard error."""
    print(sentence, file=sys.stderr)


def print_warnings(warnings: Iterable[str]) -> None:
    """Print warnings to standard error."""
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)


def give(options: argparse.Namespace, result: Any, text: Callable[[], str]) -> int:
    """Write, draw and print a result as --output, --plot and --json ask, and its warnings; returns DONE.

    result: has to_dataset, plot, to_dict and warnings. text: of the result, without --json.
    """
    if options.output:
        import film_datasets

        film_datasets.write(result.to_dataset(), options.output, overwrite=options.force)
    if options.plot:
        result.plot(options.plot)
    if options.json:
        print_json(result.to_dict())
    else:
        print(text())
        print_written(options.output, options.plot)
    print_warnings(result.warnings)
    return DONE


def listed(text: str | None) -> list[str]:
    """The names of a comma-separated list."""
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def check_writable(path: str, force: bool) -> None:
    """Raise OSError before the work if a file cannot be written to `path` afterwards."""
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise FileNotFoundError(f"{path}: the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{path}: the folder {folder} cannot be written to")
    if os.path.isdir(path) and not path.endswith(".zarr"):
        raise IsADirectoryError(f"{path} is a folder, the name of a file is needed")
    check_replaceable(path, force)


def check_picture(path: str | None, force: bool) -> None:
    """Raise before the work if a picture cannot be written to `path`, where one is given."""
    if path:
        from film_model.plot import style

        style.check_picture(path)
        check_writable(path, force)


def check_outputs(options: argparse.Namespace) -> None:
    """Check --output, a dataset, and --plot."""
    if options.output:
        from pathlib import Path

        from film_datasets.files import check_file

        check_writable(options.output, options.force)
        check_file(Path(options.output), options.force)
    check_picture(options.plot, options.force)
