"""What can go wrong: mistakes in a scene, simulations that cannot be done, and the ways a run can end."""

from __future__ import annotations

import difflib
import enum
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Mistake:
    """One thing that is wrong with a scene, and where. `key` is a path such as "impactor.radius" or "Sphere.radius"."""

    file: str | None
    line: int | None
    key: str
    message: str

    def __str__(self) -> str:
        place = "" if self.file is None else self.file + ("" if self.line is None else f":{self.line}")
        return ": ".join(part for part in (place, self.key, self.message) if part)

    def moved(self, owner: str) -> Mistake:
        """The same mistake with the first word of its key, the name of a class, replaced by `owner`."""
        rest = self.key.partition(".")[2]
        return replace(self, key=".".join(part for part in (owner, rest) if part))


class SceneError(ValueError):
    """All the mistakes of a scene, or of one of its parts; one line each."""

    def __init__(self, mistakes: Iterable[Mistake]) -> None:
        self.mistakes = tuple(mistakes)
        super().__init__(self.mistakes)

    def __str__(self) -> str:
        return "\n".join(map(str, self.mistakes))


def raise_all(mistakes: list[Mistake]) -> None:
    """Raise one SceneError if there is any mistake."""
    if mistakes:
        raise SceneError(mistakes)


class SimulationError(RuntimeError):
    """The scene is right but cannot be simulated."""


class Outcome(enum.Enum):
    """How a run ended."""

    SEPARATED = "contact ended"
    RESTING = "the impactor came to rest in contact"
    TIME_LIMIT = "the time limit was reached during contact"
    BEYOND_LAW = "the indentation passed the end of the law's last stage"
    TOO_MANY_SEGMENTS = "the motion needed more segments than are allowed"
    NO_CONTACT = "the impactor never reached the target"


def did_you_mean(word: str, words: Iterable[str]) -> str:
    """'; did you mean "velocity"?' for the nearest of `words`, or nothing when none is near."""
    near = difflib.get_close_matches(word[:100], list(words), n=1, cutoff=0.6)
    return f'; did you mean "{near[0]}"?' if near else ""


def shown(value: object) -> str:
    """A value as a message shows it: on one line and short."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        text = f'"{value}"' if value.isprintable() else ascii(value)
    elif isinstance(value, Mapping):
        text = "a table"
    elif isinstance(value, list | tuple):
        text = "a list"
    else:
        text = f"{value:~}" if hasattr(value, "magnitude") else repr(value)
        text = text if text.isprintable() else ascii(text)
    return text if len(text) <= 80 else text[:77] + "..."
