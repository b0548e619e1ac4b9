"""Mistakes in a scene, failed simulations, and the ways in which a run can end."""

from __future__ import annotations

import enum
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple


@dataclass(frozen=True)
class Mistake:
    """One mistake in a scene, and its place. `key` is a path such as "impactor.radius" or "Sphere.radius"."""

    file: str | None
    line: int | None
    key: str
    message: str

    def __str__(self) -> str:
        place = "" if self.file is None else self.file + ("" if self.line is None else f":{self.line}")
        return ": ".join(part for part in (place, _shortened(self.key, 160), self.message) if part)

    def moved(self, owner: str) -> Mistake:
        """The same mistake with the first word of its key, the name of a class, replaced by `owner`."""
        rest = self.key.partition(".")[2]
        return replace(self, key=".".join(part for part in (owner, rest) if part))


class SceneError(ValueError):
    """All the mistakes of a scene, or of one of its parts; one line each.

    >>> try:
    ...     fm.Sphere("10 kg", "1 m/s")
    ... except fm.SceneError as error:
    ...     print(error)
    Sphere.radius: "10 kg" is a mass, a length is needed (e.g. "10 mm")
    """

    def __init__(self, mistakes: Iterable[Mistake]) -> None:
        self.mistakes = tuple(mistakes)
        super().__init__(self.mistakes)

    def __str__(self) -> str:
        return "\n".join(map(str, self.mistakes))

    @property
    def needed(self) -> list[str]:
        """The entries of [contact] that a law needs and the scene does not give; none if there is another mistake."""
        wanted = all(m.key.startswith("contact.") and _WANTS.search(m.message) for m in self.mistakes)
        return [m.key.partition(".")[2] for m in self.mistakes] if wanted else []


_WANTS = re.compile(r"^(missing|give)\b|\bneeds a value\b")
"""In the sentence about an entry that a law needs."""


def not_compared(needing: Mapping[str, Sequence[str]]) -> str:
    """The laws that are not compared, and the entries that each needs."""
    said = ", ".join(f"{name} ({', '.join(entries)})" for name, entries in needing.items())
    return textwrap.fill(f"Not compared, because they need entries in [contact]: {said}.", 100, break_on_hyphens=False)


def raise_all(mistakes: list[Mistake]) -> None:
    """Raise one SceneError if there is any mistake."""
    if mistakes:
        raise SceneError(mistakes)


class DamagedFile(ValueError):
    """A file is not what it should be: it is cut, or its content is wrong."""


class ImpactWarning(UserWarning):
    """What a user must know about a result, as a Python warning; results keep the same sentences as `warnings`.

    Filter it with `warnings.filterwarnings("ignore", category=ImpactWarning)`; Python's option -W knows only built-in
    categories, of which this one is a UserWarning.
    """


class SimulationError(RuntimeError):
    """The scene is valid but cannot be simulated."""


class TooManyModes(SimulationError):
    """The natural vibrations of a target up to some frequency are too many to compute."""


class CoreError(SimulationError):
    """The core failed, with a status of `STATUSES`."""

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status


class Status(NamedTuple):
    """How an impact can end. of_row: a single impact of a batch can have this status; otherwise the call is invalid."""

    word: str
    sentence: str
    of_row: bool = True


NO_VELOCITY, VIBRATES = -100, -101
"""Status codes of impacts that are not passed to the core. All other codes are the core's (`film_core.h`)."""

STATUSES: dict[int, Status] = {
    0: Status("time_limit", "the time limit was reached during contact"),
    1: Status("separated", "contact ended"),
    2: Status("resting", "the impactor came to rest in contact"),
    -1: Status("bad_number", "a value of this impact is outside the solver's range"),
    -2: Status("bad_curve", "the law's curve is invalid: its stages must join without a gap", of_row=False),
    -3: Status("bad_mesh", "the number of segments is outside the solver's range", of_row=False),
    -4: Status(
        "beyond_law", "the indentation passed the end of the law's last stage: the law cannot stop this impactor"
    ),
    -5: Status(
        "too_many_segments",
        "the motion needs more segments than are allowed: ask for fewer segments or for a shorter step",
    ),
    -6: Status("bad_unloading", "the law's unloading from the maximum indentation has zero length"),
    -7: Status("full", "the motion has more segments or events than the caller's arrays can hold", of_row=False),
    -8: Status("too_stiff", "the law's force at first touch exceeds the target's impedance times the impact velocity"),
    -9: Status(
        "turns_again",
        "the indentation grows again before contact ends, for which viscoelastic contact is not solved: "
        "viscoelasticity = false in [effects] takes the instantaneous modulus",
    ),
    -10: Status(
        "remembers",
        "a contact begins before the viscoelastic material has forgotten the one before, which is not solved: "
        "viscoelasticity = false in [effects] takes the instantaneous modulus",
    ),
    NO_VELOCITY: Status("no_velocity", "the impactor does not approach the target"),
    VIBRATES: Status(
        "vibrates",
        "the target vibrates between its edges; use simulate(), or make a plate infinite by boundary_reflections = "
        "false in [effects]",
    ),
}
"""Status code → word and sentence. The impact failed if the code is negative. All messages about failures are made from
this table: of one impact, of the rows of a batch, of datasets and of FMUs."""


class Outcome(enum.Enum):
    """How a run ended, as a sentence."""

    SEPARATED = STATUSES[1].sentence
    RESTING = STATUSES[2].sentence
    TIME_LIMIT = STATUSES[0].sentence
    BEYOND_LAW = STATUSES[-4].sentence
    TOO_MANY_SEGMENTS = STATUSES[-5].sentence
    NO_CONTACT = STATUSES[NO_VELOCITY].sentence


def did_you_mean(word: str, words: Iterable[str]) -> str:
    """'; did you mean "velocity"?' for the `nearest` of `words`; an empty text if there is none."""
    near = nearest(word, words)
    return f'; did you mean "{near}"?' if near else ""


def nearest(word: str, words: Iterable[str]) -> str:
    """The most similar of `words`, or else the first that contains `word`, of four letters or more; an empty text if
    there is none."""
    import difflib

    known = list(words)
    near = difflib.get_close_matches(word[:100], known, n=1, cutoff=0.6)
    near = near or [other for other in known if len(word) >= 4 and word in other]
    return near[0] if near else ""


def shown(value: object) -> str:
    """A value as messages show it: on one line, at most 80 characters."""
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
    return _shortened(text, 80)


def _shortened(text: str, most: int) -> str:
    """A text of at most `most` characters, with dots in the middle of a longer one."""
    half = (most - 3) // 2
    return text if len(text) <= most else f"{text[:half]}...{text[len(text) - (most - 3 - half) :]}"
