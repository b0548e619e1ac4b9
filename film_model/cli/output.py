"""What the commands share: exit statuses, common options, checks of output files, and JSON."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from film_model.base.files import check_replaceable

if TYPE_CHECKING:
    from film_model.scene import Scene

DONE, WRONG, FAILED = 0, 2, 3
"""Exit statuses: done; the scene or the command line is wrong; the work failed."""


class Commands:
    """Collects commands. about: what each does, by name."""

    def __init__(self, whole: argparse.ArgumentParser) -> None:
        self.about: dict[str, str] = {}
        self._commands = whole.add_subparsers(
            required=True, prog="film-model", metavar="COMMAND", help=argparse.SUPPRESS
        )

    def add(self, name: str, about: str, run: Callable[[argparse.Namespace], int]) -> argparse.ArgumentParser:
        """The parser of one more command; `run` does its work and returns the exit status."""
        self.about[name] = about
        parser = self._commands.add_parser(name, description=f"{about[:1].upper()}{about[1:]}.")
        parser.set_defaults(command=run, parser=parser)
        return parser


def add_scene(parser: argparse.ArgumentParser) -> None:
    """The scene file, which `read_scene` reads."""
    parser.add_argument("scene", help="scene file (TOML)")


def add_common(
    parser: argparse.ArgumentParser,
    *,
    plot: str = "",
    style: bool = False,
    force: str = "overwrite existing files",
    json: bool = True,
) -> None:
    """The options --plot with --style, --force and --json. plot: what is drawn; force: what it does."""
    if plot:
        parser.add_argument("--plot", metavar="FILE", help=f"{plot} (.png, .svg or .pdf)")
    if plot or style:
        parser.add_argument("--style", choices=("screen", "paper", "dark"), help="of the picture (default: screen)")
    if force:
        parser.add_argument("--force", action="store_true", help=force)
    if json:
        parser.add_argument("--json", action="store_true", help="print one JSON object")


def read_scene(options: argparse.Namespace) -> Scene:
    """The scene of a file."""
    from film_model.scene import Scene

    return Scene.from_toml(options.scene)


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


def give(
    options: argparse.Namespace,
    text: Callable[[], str],
    table: Callable[[], dict[str, Any]],
    warnings: Iterable[str] = (),
    **files: Callable[[str], Any],
) -> int:
    """Write the files asked for, print a text or with --json a table, and the warnings; returns DONE.

    files: what writes the file of an option, by the option's name.
    """
    asked = {name: path for name in files if (path := getattr(options, name))}
    for name, path in asked.items():
        files[name](path)
    if options.json:
        print_json(table())
    else:
        print(text())
        print_written(*asked.values())
    print_warnings(warnings)
    return DONE


def give_result(
    options: argparse.Namespace, result: Any, text: Callable[[], str], **files: Callable[[str], Any]
) -> int:
    """The same of a result that has to_dataset, plot, to_dict and warnings."""

    def write(path: str) -> None:
        import film_datasets
        from film_model.solve.history import History

        whole = result if isinstance(result, History) else result.to_dataset()  # a history needs no xarray
        film_datasets.write(whole, path, overwrite=options.force)

    def draw(path: str) -> None:
        result.plot(path)

    return give(options, text, result.to_dict, result.warnings, output=write, plot=draw, **files)


def listed(text: str | None) -> list[str]:
    """The names of a comma-separated list."""
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def check_writable(path: str | None, force: bool) -> None:
    """Raise OSError before the work if a file cannot be written to `path`, if there is one, afterwards."""
    if path is None:
        return
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise FileNotFoundError(f"{path}: the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"{path}: the folder {folder} cannot be written to")
    if os.path.isdir(path) and not path.endswith(".zarr"):
        raise IsADirectoryError(f"{path} is a folder, the name of a file is needed")
    check_replaceable(path, force)


def check_pictures(options: argparse.Namespace) -> None:
    """Raise before the work if a picture cannot be written afterwards."""
    for path in filter(None, (getattr(options, name, None) for name in ("plot", "strobe"))):
        from film_model.plot import style

        style.check_picture(path)
        check_writable(path, options.force)


def check_dataset(options: argparse.Namespace) -> None:
    """Raise before the work if a dataset cannot be written to --output afterwards."""
    if options.output:
        from pathlib import Path

        from film_datasets.files import check_file

        check_writable(options.output, options.force)
        check_file(Path(options.output), options.force)
