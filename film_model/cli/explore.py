"""film-model explore, export-page: the page that simulates in a browser."""

from __future__ import annotations

import argparse
from typing import Any

from film_model.cli.output import DONE, add_force, check_writable, print_written


def add_commands(named: Any) -> None:
    """The commands and their options."""
    parser: argparse.ArgumentParser = named.add_parser("explore", help="simulate in a browser, with sliders")
    parser.add_argument("scene", nargs="?", help="scene file (TOML); default: an example")
    parser.add_argument("--no-browser", action="store_true", help="only write the page and print where it is")
    parser.set_defaults(command=explore)

    parser = named.add_parser("export-page", help="write a scene as one self-contained page with sliders")
    parser.add_argument("scene", help="scene file (TOML)")
    parser.add_argument("--output", metavar="FILE.html", default="impact.html", help="the page (impact.html)")
    add_force(parser)
    parser.set_defaults(command=export_page)


def explore(options: argparse.Namespace) -> int:
    import tempfile
    import webbrowser
    from pathlib import Path

    from film_model.explorer.page import write_page
    from film_model.scene import Scene

    scene = None if options.scene is None else Scene.from_toml(options.scene)
    path = Path(tempfile.mkdtemp(prefix="film-model-"), "explorer.html")
    write_page(path, scene)
    print(path)
    if not options.no_browser and not webbrowser.open(path.as_uri()):
        raise OSError(f"no browser could be started: open {path} in one")
    return DONE


def export_page(options: argparse.Namespace) -> int:
    from pathlib import Path

    from film_model.explorer.page import write_page
    from film_model.scene import Scene

    if Path(options.output).suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"--output: {options.output} must end in .html")
    check_writable(options.output, options.force)
    write_page(Path(options.output), Scene.from_toml(options.scene))
    print_written(options.output)
    return DONE
