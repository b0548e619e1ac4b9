"""Structures, functions and numbers of C headers for ctypes, so that none is written twice."""

from __future__ import annotations

import ctypes as c
import os.path
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any, TypeVar

Kind = TypeVar("Kind", bound=type[c.Structure])

_PLAIN: dict[str, Any] = {
    **{"double": c.c_double, "int": c.c_int, "int8_t": c.c_int8, "int32_t": c.c_int32, "int64_t": c.c_int64},
    **{"uint64_t": c.c_uint64, "size_t": c.c_size_t, "char": c.c_char, "void": None},
}
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_STRUCTURE = re.compile(r"typedef struct \{([^{}]*)\} (\w+);")
_MEMBER = re.compile(r"(\*?)(\w+)((?:\[[^\]]*\])*)")
_FUNCTION = re.compile(r"FILM_API ([\w ]+?)(\w+)\(([^()]*)\);")


class Header:
    """A header of the core, by its path there, or another by its whole path. beside: those that it includes, whose
    structures are declared."""

    def __init__(self, path: str, *beside: Header) -> None:
        self._path, self._beside = os.path.join(os.path.dirname(__file__), path), beside
        self._kinds: dict[str, Any] = {**_PLAIN, **{name: kind for one in beside for name, kind in one._kinds.items()}}

    @cached_property
    def _text(self) -> str:
        with open(self._path, encoding="utf-8") as file:
            return " ".join(_COMMENT.sub(" ", file.read()).split())

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The numbers of the enumerations, of the headers beside it too."""
        found = {name: value for one in self._beside for name, value in one.numbers.items()}
        for body in re.findall(r"enum \{(.*?)\}", self._text):
            following = 0
            for entry in body.strip(" ,").split(","):
                name, _, value = (part.strip() for part in entry.partition("="))
                following = self._number(value, found) if value else following
                found[name] = following
                following += 1
        return found

    @cached_property
    def _structures(self) -> dict[str, str]:
        return {name: body for body, name in _STRUCTURE.findall(self._text)}

    @staticmethod
    def _number(text: str, known: dict[str, int]) -> int:
        """The value of a sum of numbers and names."""
        return sum(known[term] if term in known else int(term) for term in map(str.strip, text.split("+")))

    def film(self, *names: str) -> Iterator[int]:
        """Numbers by their names without FILM_."""
        return (self.numbers[f"FILM_{name}"] for name in names)

    def structure(self, name: str) -> Callable[[Kind], Kind]:
        """Class decorator: the fields of a structure. Structures inside it are declared before."""

        def declared(kind: Kind) -> Kind:
            lines = self._structures[name].strip(" ;").split(";")
            kind._fields_ = [field for line in lines for field in self._fields(line.strip())]
            self._kinds[name] = kind
            return kind

        return declared

    def _fields(self, line: str) -> Iterator[tuple[str, Any]]:
        """The members that one line of a structure declares."""
        kind, _, names = line.removeprefix("const ").partition(" ")
        for match in (_MEMBER.fullmatch(name.strip()) for name in names.split(",")):
            assert match is not None, line
            member: Any = c.c_void_p if match.group(1) else self._kinds[kind]
            for length in reversed(re.findall(r"\[(.*?)\]", match.group(3))):
                member = member * self._number(length, self.numbers)
            yield match.group(2), member

    def declare(self, library: Any) -> Any:
        """Declare the functions to a library, which is returned; pointers to anything take any address."""
        for result, name, arguments in _FUNCTION.findall(self._text):
            function = getattr(library, name)
            words = [] if arguments == "void" else arguments.split(",")
            function.argtypes = [
                c.c_void_p if "*" in word or "[" in word else self._kinds[word.split()[-2]] for word in words
            ]
            function.restype = self._kinds[result.strip()]
        return library


def check_sizes(library: Any, name: str, *kinds: type[c.Structure]) -> None:
    """Raise ImportError if the library's function of this name gives other sizes of structures."""
    sizes = (c.c_int64 * len(kinds))()
    getattr(library, name)(sizes)
    if list(sizes) != [c.sizeof(kind) for kind in kinds]:
        raise ImportError(f"{library._name} was built from other sources: install the package again (pip install .)")
