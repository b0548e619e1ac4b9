"""What is imported when it is first used: names of a package, classes of a list, methods of packages above a class."""

from __future__ import annotations

import sys
from collections import UserDict
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.util import find_spec
from types import MethodType
from typing import Any, TypeVar

T = TypeVar("T")


def late_names(package: str, homes: Mapping[str, tuple[str, ...]]) -> Callable[[str], Any]:
    """The `__getattr__` of a package: its public names, `__all__` and its modules.

    homes: the names by the modules of the package that have them, "name as public_name" where it has another there.
    """
    places = {name.rpartition(" ")[2]: (module, name.partition(" ")[0]) for module in homes for name in homes[module]}

    def found(name: str) -> Any:
        if name == "__all__":
            return sorted(places)
        if name in places:
            module, own = places[name]
            value = getattr(import_module(f"{package}.{module}"), own)
            setattr(sys.modules[package], name, value)
            return value
        if name.startswith("_") or find_spec(f"{package}.{name}") is None:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return import_module(f"{package}.{name}")

    return found


class LateClasses(UserDict[str, type[T]]):
    """Classes by their names in scene files, each in a file of its own in `package`.

    The file and the class are named alike: "half-space" is `HalfSpace` in `half_space.py`. An import takes as long as a
    simulation, and a scene needs few of them.
    """

    def __init__(self, package: str, names: tuple[str, ...]) -> None:
        super().__init__()
        self._package = package
        self.data: dict[str, Any] = dict.fromkeys(names)

    def __getitem__(self, name: str) -> type[T]:
        if self.data[name] is None:
            module = import_module(f"{self._package}.{name.replace('-', '_')}")
            self.data[name] = getattr(module, _class_name(name))
        return self.data[name]

    def __repr__(self) -> str:
        return f"<{self._package}: {', '.join(self)}>"

    @property
    def class_names(self) -> list[str]:
        """The names of the classes, none of which is imported."""
        return [_class_name(name) for name in self]

    def called(self, class_name: str) -> type[T]:
        """The class of this name, for a package's `__getattr__`; AttributeError if there is none."""
        for name in self:
            if _class_name(name) == class_name:
                return self[name]
        raise AttributeError(f"module {self._package!r} has no attribute {class_name!r}")


def _class_name(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("-"))


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
