"""The command line of film-model.

Results go to standard output, progress and warnings to standard error. Exit status 0: done; 2: the scene, the FMU or
the command line is wrong; 3: the work failed, a file cannot be read or written, or a check failed; 130: interrupted.
"""

from __future__ import annotations

import argparse
import io
import os
import re
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from importlib import import_module

from film_model.base.errors import DamagedFile, SceneError, SimulationError, did_you_mean
from film_model.cli.output import DONE, FAILED, WRONG, Commands, check_pictures
from film_model.version import __version__

COMMANDS = {
    "run": ("run", "bounce", "spectrum"),
    "studies": ("cost", "hard-cases", "validate", "reference-impacts", "score"),
    "programs": ("export-fmu", "export-ssp", "check-fmu", "contact-for", "modes", "explore", "export-page"),
    "datasets": ("sweep", "plot", "identify", "tolerance"),
    "tables": ("check", "convert", "summarise", "table"),
    "catalogues": ("explain", "laws", "cite", "materials", "new"),
}
"""Modules of `film_model.cli`, and the commands that each adds."""

GROUPS = {
    "simulate": ("new", "run", "bounce", "spectrum", "explain", "cite", "explore", "laws", "materials"),
    "data": ("sweep", "tolerance", "identify", "plot", "summarise", "table", "convert", "check"),
    "other programs": ("export-fmu", "check-fmu", "export-ssp", "export-page", "contact-for", "modes"),
    "how good it is": ("validate", "cost", "hard-cases", "reference-impacts", "score"),
}
"""The commands in the order of `--help`."""

OPTIONS = {"overwrite=True": "--force", "resume=True": "--resume"}
"""Arguments that error messages name for Python, and the corresponding options."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit status."""
    # Sums are then the same on any number of processors, and NumPy starts no threads, a quarter of its time to import.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    given = sys.argv[1:] if arguments is None else arguments
    if not given:
        parser().print_help(sys.stderr)
        sys.exit(WRONG)
    options, unknown = parser(*given[:1]).parse_known_args(given)
    if unknown:
        hint = did_you_mean(unknown[0].partition("=")[0], re.findall(r"--[a-z-]+", options.parser.format_usage()))
        options.parser.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # "?" for characters that the encoding lacks

    try:
        check_pictures(options)
        with _pictures_in(getattr(options, "style", None)):
            return options.command(options)
    except (SceneError, DamagedFile) as error:
        return _complain(str(error), WRONG)
    except SimulationError as error:
        return _complain(str(error), FAILED)
    except BrokenPipeError:  # the reading process has ended
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except OSError as error:
        of_system = error.filename is not None and error.strerror is not None
        return _complain(f"{error.filename}: {error.strerror}" if of_system else str(error), FAILED)
    except (ValueError, ImportError) as error:
        return _complain(str(error), FAILED)
    except KeyboardInterrupt as stop:
        return _complain(str(stop) or "interrupted", 130)


def _pictures_in(style: str | None) -> AbstractContextManager[None]:
    """The style of the pictures that a command draws."""
    if style is None:
        return nullcontext()
    from film_model.plot.style import picture_style

    return picture_style(style)


def _complain(text: str, status: int) -> int:
    for argument, option in OPTIONS.items():
        text = text.replace(f"use {argument}", f"use {option}")
    print(text, file=sys.stderr)
    return status


def parser(command: str = "") -> argparse.ArgumentParser:
    """The commands and their options; if `command` is one of them, only those of its module, whose import is enough."""
    whole = argparse.ArgumentParser(
        prog="film-model",
        usage="film-model [--help] [--version] COMMAND ...",
        description="Simulate the impact of a ball: force, indentation, rebound.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    whole.add_argument("--version", action="version", version=f"film-model {__version__}")
    named = Commands(whole)
    own = [module for module, commands in COMMANDS.items() if command in commands]
    for module in own or COMMANDS:
        import_module(f"film_model.cli.{module}").add_commands(named)
    if not own:
        listed = (
            "\n".join([f"{heading}:", *(f"  {name:18}{named.about[name]}" for name in commands), ""])
            for heading, commands in GROUPS.items()
        )
        whole.epilog = "\n".join([*listed, "film-model COMMAND --help lists the options of a command."])
        if command and not command.startswith("-"):
            whole.error(f'"{command}" is no command{did_you_mean(command, named.about)}')
    return whole
