"""Write the table of friction under Hertz's law, from the exact solver: `python examples/friction_table.py [FILE]`.

Chebyshev series over χ and ψ, in the panels of film_model/core/oblique/film_friction_many.c, which takes impacts of
batches from them.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from film_model.core import friction as core

Map = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""From x and y, 0 to 1, to ψ and χ."""

LEAST, MOST, LAST, EARLIEST = 0.8, 1.751, 1.9, 0.15
"""χ of the table, where ABOVE ends, and (ψ − 1)/(2χ − 1) where EARLY ends, as in film_friction_many.c."""

CORNER_TERMS, TRIED = 8, 24
CORNER_BETWEEN, HALVINGS = (1.45, 1.88), 34
"""χ between which the corner lies, and bisections."""


def solved(psi: np.ndarray, chi: np.ndarray) -> np.ndarray:
    """Results of the exact solver, in its units."""
    normal: NDArray[Any] = np.zeros(psi.size, core.NORMAL_DTYPE)
    normal["coefficient"], normal["exponent"], normal["approach"] = 1.25, 1.5, 1.0
    return core.many(normal, 2.0 * chi.ravel(), psi.ravel()).reshape(psi.shape)


def nodes(count: int) -> np.ndarray:
    """Zeros of a Chebyshev polynomial, from 0 to 1."""
    return 0.5 + 0.5 * np.cos(np.pi * (np.arange(count) + 0.5) / count)


def reverses_twice(psi: float, chi: float) -> bool:
    """Whether slip changes its sign once more before the contact ends."""
    _, result, _ = core.impact(core.Normal(0.0, 1.25, 1.5, 1.0, 0.0, 0.0), 2.0 * chi, psi)
    return core.REVERSES in [kind for _, kind in result.events]


def corner(psi: float) -> float:
    """χ from which it does."""
    low, high = CORNER_BETWEEN
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reverses_twice(psi, middle) else (middle, high)
    return 0.5 * (low + high)


def corners() -> np.ndarray:
    """Coefficients of the corner over ψ."""
    x = nodes(TRIED)
    return chebyshev.chebfit(2.0 * x - 1.0, [corner(psi) for psi in x.tolist()], CORNER_TERMS - 1)


def across(y: np.ndarray) -> np.ndarray:
    """χ over the whole table."""
    return LEAST + y * (MOST - LEAST)


def fit(to: Map, value: Callable[[np.ndarray, np.ndarray], np.ndarray], terms: int, rows: int) -> np.ndarray:
    """Coefficients of a value of the results and ψ."""
    psi, chi = to(*np.meshgrid(nodes(terms), nodes(rows), indexing="ij"))
    in_x, in_y = (chebyshev.chebvander(2.0 * nodes(count) - 1.0, count - 1) for count in (terms, rows))
    return np.linalg.solve(in_x, value(solved(psi, chi), psi)) @ np.linalg.inv(in_y).T


def sticks(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Below ψ = 1 the force is largest while all sticks, and in proportion to ψ: one ψ does."""
    return np.full_like(y, 0.5), across(y)


def early(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From ψ = 1 on, in the fifth root."""
    return 1.0 + EARLIEST * x**5 * (2.0 * across(y) - 1.0), across(y)


def late(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """On to ψ = 2χ."""
    return 1.0 + (EARLIEST + (1.0 - EARLIEST) * x) * (2.0 * across(y) - 1.0), across(y)


def outward(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From ψ = 2χ, where sliding stops at the turn, to 4χ − 1."""
    return 2.0 * across(y) + x * (2.0 * across(y) - 1.0), across(y)


def per(name: str) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """A result over ψ."""
    return lambda found, psi: found[name] / psi


def of(name: str) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """A result."""
    return lambda found, _: found[name]


def panels() -> list[np.ndarray]:
    """In the order of film_friction_many.c."""
    edge = corners()

    def at(psi: np.ndarray) -> np.ndarray:
        return chebyshev.chebval(2.0 * psi - 1.0, edge)

    def below(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return x, LEAST + y * (at(x) - LEAST)

    def above(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return x, at(x) + y**2 * (LAST - at(x))

    return [
        edge.reshape(-1, 1),
        fit(below, per("velocity"), 20, 20),
        fit(above, per("velocity"), 16, 12),
        fit(sticks, per("force"), 1, 16),
        fit(sticks, of("time_of_force"), 1, 16),
        fit(early, of("velocity"), 22, 16),
        *(fit(early, of(name), 16, 12) for name in ("force", "time_of_force")),
        fit(late, of("velocity"), 16, 16),
        *(fit(late, of(name), 16, 12) for name in ("force", "time_of_force")),
        fit(outward, of("velocity"), 16, 12),
    ]


def table() -> np.ndarray:
    """For each panel where its coefficients begin and its terms in x and y, then all coefficients."""
    made = [np.pad(panel, ((0, 0), (0, -panel.shape[1] % 4))) for panel in panels()]
    begins = 3 * len(made) + np.cumsum([0, *(panel.size for panel in made)])
    heads = [(begin, *panel.shape) for begin, panel in zip(begins, made, strict=False)]
    return np.concatenate([np.ravel(heads), *(panel.ravel() for panel in made)])


def main(path: Path = core.TABLE) -> Path:
    """Write the table; returns its path."""
    np.save(path, table())
    return path


if __name__ == "__main__":
    print(main(*map(Path, sys.argv[1:2])))
