"""Impacts of compact bodies by the force–indentation linearisation method (FILM).

The public names are those of `film_model.face`. They are loaded when the first of them is used, because most commands
of the command line need few of them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from film_model.version import __version__ as __version__

if TYPE_CHECKING:
    from film_model.face import *  # noqa: F403


def __getattr__(name: str) -> Any:
    """A public name, or a package of this one such as `film_model.laws`."""
    if not name.startswith("__") or name == "__all__":  # Python's own tools ask for many other names with underscores
        face = import_module("film_model.face")
        globals()["__all__"] = [*face.__all__, "__version__"]
        if name in face.__all__:
            globals()[name] = getattr(face, name)
    if name not in globals():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return globals()[name]


def __dir__() -> list[str]:
    """The public names, without the submodules that happen to be loaded."""
    return sorted(__getattr__("__all__"))
