"""film-model explore, export-page: the page that simulates in a browser."""

from __future__ import annotations

import argparse

from film_model.cli.output import DONE, Commands, add_common, add_scene, check_writable, print_written, read_scene


def add_commands(commands: Commands) -> None:
    """The commands and their options."""
    parser = commands.add("explore", "simulate in a browser, with sliders", explore)
    parser.add_argument("scene", nargs="?", help="scene file (TOML); default: an example")
    parser.add_argument("--no-browser", action="store_true", help="only write the page and print where it is")

    parser = commands.add("export-page", "write a scene as one self-contained page with sliders", export_page)
    add_scene(parser)
    parser.add_argument("--output", metavar="FILE.html", default="impact.html", help="the page (impact.html)")
    add_common(parser, json=False)


def explore(options: argparse.Namespace) -> int:
    import tempfile
    import webbrowser
    from pathlib import Path

    from film_model.explorer.page import write_page

    scene = None if options.scene is None else read_scene(options)
    path = Path(tempfile.mkdtemp(prefix="film-model-"), "explorer.html")
    write_page(path, scene)
    print(path)
    if not options.no_browser and not webbrowser.open(path.as_uri()):
        raise OSError(f"no browser could be started: open {path} in one")
    return DONE


def export_page(options: argparse.Namespace) -> int:
    from pathlib import Path

    from film_model.explorer.page import write_page

    if Path(options.output).suffix.lower() not in (".html", ".htm"):
        raise ValueError(f"--output: {options.output} must end in .html")
    check_writable(options.output, options.force)
    write_page(Path(options.output), read_scene(options))
    print_written(options.output)
    return DONE
