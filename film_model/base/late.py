"""Methods of a class whose functions are in a package above that of the class."""

from __future__ import annotations

from importlib import import_module
from types import MethodType
from typing import Any


class Late:
    """A method whose function, "module:name", is imported when it is first used.

    It is the only way in which a package names one above it: the module is not imported with the class.
    """

    def __init__(self, place: str) -> None:
        self.place = place

    def __get__(self, instance: object | None, owner: type) -> Any:
        module, _, name = self.place.partition(":")
        function = getattr(import_module(module), name)
        return function if instance is None else MethodType(function, instance)
