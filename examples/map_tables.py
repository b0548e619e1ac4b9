"""Tables of whole ways: `python -m examples.map_tables` writes `film_way_in.c`, `film_way_out.c`, `film_way_through.c`.

With a force of exponent 3/2 two ways on a target that moves are functions of one number: the way in from first touch
along a plain power, and the way out from rest. The way through an elastic stage, to where it ends at the depth Y, is a
function of two. In units of each way, with x = u² and dt = 2u ds,

    u' = w − Λ u³,  w' = −2 c u⁴,  t' = 2u.

The way in starts at u = 0, w = 1 with c = 5/4 and Λ = γ f(X)/ν, X the depth on a fixed target; it turns where u' = 0.
The way out starts at u = 1, w = Λ = γ √(F/recovery) with c = 1; it ends at u = 0. The way through starts at u = 0,
w = 1 with Λ = γ f(Y)/ν, the push, and c = 5/4 of the share of the energy that the stage stores, 2 W(Y)/ν²; it ends at
u = 1. A motion with the largest share, p, turns where the stage ends; √(1 − share/p) is the margin. Taylor series of
order 30 integrate them in extended precision (the 80 bits of the processor where NumPy has them): docs/method.md,
section 10.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

CORE = Path(__file__).resolve().parent.parent / "film_model" / "core" / "tables"
PER_OCTAVE, OCTAVES = 8, 4
"""Pieces of each doubling of 1 + Λ, and doublings: up to Λ = 15."""
PUSH_END, PUSH_PIECES, MARGINS, THROUGH_TERMS, LIMIT_TERMS = 0.7, 4, (0.0, 0.4375, 1.0), 14, 14
"""Of the way through: the largest push, its pieces, those of the margin, and terms of the polynomials."""

_ORDER, _LAST = 30, 1e-21  # the last term of a series, relative: it sets the step

Long = NDArray[np.longdouble]


def way_in(number: Long) -> Long:
    """(2, n): depth over X and its time over X/ν, for Λ = γ f(X)/ν."""
    number = np.asarray(number, np.longdouble)
    zero = np.zeros_like(number)
    u, _, t = _follow(number, zero + 1.25, (zero, zero + 1, zero), "turn")
    return np.array([u * u, t])


def way_out(number: Long) -> Long:
    """(3, n): duration over √(recovery/F), velocity −w at the end over √(F recovery), time at which w falls to 0."""
    number = np.asarray(number, np.longdouble)
    start = np.ones_like(number), number, np.zeros_like(number)
    stop = _follow(number, start[0], start, "stop")[2]
    _, w, t = _follow(number, start[0], start, "end")
    return np.array([t, -w, np.where(number > 0.0, stop, 0.0)])


def largest_share(push: Long) -> Long:
    """The share of the energy with which the motion turns where the stage ends.

    With D(Λ) the depth that way_in gives, it is D^(5/2), and the push Λ D^(3/2): Newton's method, with a difference for
    the slope.
    """
    push = np.asarray(push, np.longdouble)
    number, power, small = push.copy(), np.longdouble(1.5), np.longdouble(1e-8)
    for _ in range(7):
        here, there = (at * way_in(at)[0] ** power for at in (number, number + small))
        number -= (here - push) * small / (there - here)
    return way_in(number)[0] ** np.longdouble(2.5)


def way_through(push: Long, share: Long) -> Long:
    """(2, n): velocity over ν and time over Y/ν at the end of the stage."""
    push, share = np.asarray(push, np.longdouble), np.asarray(share, np.longdouble)
    zero = np.zeros_like(push)
    _, w, t = _follow(push, np.longdouble(1.25) * share, (zero, zero + 1, zero), "pass")
    return np.array([w, t])


def _series(number: Long, c: Long, u: Long, w: Long, t: Long) -> tuple[Long, Long, Long]:
    us, ws, ts, squares = [u], [w], [t], list[Long]()
    for n in range(_ORDER):
        squares.append(sum(us[j] * us[n - j] for j in range(n + 1)))
        cube = sum(squares[j] * us[n - j] for j in range(n + 1))
        fourth = sum(squares[j] * squares[n - j] for j in range(n + 1))
        us.append((ws[n] - number * cube) / (n + 1))
        ws.append(-2 * c * fourth / (n + 1))
        ts.append(2 * us[n] / (n + 1))
    return np.array(us), np.array(ws), np.array(ts)


def _value(series: Long, s: Long) -> Long:
    out = series[-1]
    for term in series[-2::-1]:
        out = out * s + term
    return out


def _follow(number: Long, c: Long, start: tuple[Long, Long, Long], until: str) -> tuple[Long, Long, Long]:
    """The motion where u' ("turn"), w ("stop") or u ("end") falls to 0, or where u rises to 1 ("pass")."""
    u, w, t = (values.copy() for values in start)
    left = np.ones(number.size, bool)
    for _ in range(3000):
        g = number[left]
        us, ws, ts = _series(g, c[left], u[left], w[left], t[left])
        k = np.arange(_ORDER - 1, _ORDER + 1)[:, None]
        sizes = np.maximum(abs(us[k[:, 0]]) / abs(us).max(axis=0), abs(ws[k[:, 0]]) / abs(ws[0]).clip(1e-9))
        step = ((_LAST / sizes.clip(1e-300)) ** (1 / k)).min(axis=0)
        slope = us[1:] * np.arange(1, _ORDER + 1)[:, None]
        ahead = np.vstack([1 - us[:1], -us[1:]])
        watched = {"turn": np.vstack([slope, 0 * slope[:1]]), "stop": ws, "end": us, "pass": ahead}[until]
        for _ in range(40 if until == "pass" else 0):  # not beyond the turn
            step = np.where(_value(slope, step) < 0, step / 2, step)
        over = _value(watched, step) <= 0
        at = np.where(over, step * watched[0] / np.where(over, watched[0] - _value(watched, step), 1), step)
        rates = watched[1:] * np.arange(1, _ORDER + 1)[:, None]
        for _ in range(12):
            at = np.where(over, (at - _value(watched, at) / np.where(over, _value(rates, at), 1)).clip(0, step), at)
        u[left], w[left], t[left] = _value(us, at), _value(ws, at), _value(ts, at)
        left[np.flatnonzero(left)[over]] = False
        if not left.any():
            return u, w, t
    raise RuntimeError(f"{until} is not reached")


def pieces(way: Callable[[Long], Long], terms: int) -> NDArray[np.float64]:
    """(pieces, terms, functions): coefficients of z^k, −1 ≤ z ≤ 1, through Chebyshev's points of each piece."""
    begins = 2.0 ** (np.arange(PER_OCTAVE * OCTAVES) // PER_OCTAVE)
    low = begins * (1.0 + np.arange(PER_OCTAVE * OCTAVES) % PER_OCTAVE / PER_OCTAVE)
    z = np.cos(np.pi * (np.arange(terms, dtype=np.longdouble) + 0.5) / terms)
    number = low[:, None] - 1 + begins[:, None] / PER_OCTAVE * (z + 1) / 2
    made = way(number.ravel()).reshape(-1, low.size, terms)
    for order in range(1, terms):  # Newton's divided differences, then powers of z
        made[..., order:] = (made[..., order:] - made[..., order - 1 : -1]) / (z[order:] - z[:-order])
    powers = np.zeros_like(made)
    for k in range(terms - 1, -1, -1):
        raised = np.roll(powers, 1, axis=-1)
        powers = raised - z[k] * powers
        powers[..., 0] += made[..., k]
    return powers.transpose(1, 2, 0).astype(np.float64)


def through() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Largest shares, (pieces of the push, terms), and the ways through, (pieces of the push and the margin, numbers).

    A way through is a polynomial of the push, on each piece from −1 to 1, whose coefficients are polynomials of the
    margin, so that all powers together are below `THROUGH_TERMS`: of four powers of the margin at a time, for each
    power of the push from the highest to 0, of each of the four both values.
    """
    count, most = 2 * THROUGH_TERMS, THROUGH_TERMS
    z = np.cos(np.pi * (np.arange(count, dtype=np.longdouble) + 0.5) / count)
    chebyshev = np.cos(np.arange(count)[:, None] * np.arccos(z)) * np.longdouble(2) / count
    chebyshev[0] /= 2
    powers = np.zeros((count, count), np.longdouble)  # of each of Chebyshev's polynomials
    powers[0, 0] = powers[1, 1] = 1
    for k in range(2, count):
        powers[k] = 2 * np.roll(powers[k - 1], 1) - powers[k - 2]
    limits, ways = [], []
    for piece in range(PUSH_PIECES):
        push = PUSH_END * (piece + (z + 1) / 2) / PUSH_PIECES
        limit = largest_share(push)
        limits.append((powers.T[:LIMIT_TERMS, :LIMIT_TERMS] @ (chebyshev @ limit)[:LIMIT_TERMS]).astype(np.float64))
        for low, high in pairwise(MARGINS):
            margin = low + (high - low) * (z + 1) / 2
            share = limit[:, None] * (1 - margin * margin)
            made = way_through(np.repeat(push, count), share.ravel()).reshape(2, count, count)
            made = chebyshev @ made @ chebyshev.T
            made[:, np.add.outer(np.arange(count), np.arange(count)) >= most] = 0
            made = powers.T @ made @ powers
            fours = [made[:, most - 1 - first :: -1, first : first + 4] for first in range(0, most, 4)]
            ways.append(np.concatenate([four.transpose(1, 2, 0).ravel() for four in fours]).astype(np.float64))
    return np.array(limits), np.array(ways)


TABLES = {
    "film_way_in": (way_in, 11, "depth and time", 4e-16),
    "film_way_out": (way_out, 14, "time, velocity, stop", 2e-15),
}
"""Function, terms, what it gives, and the largest relative error of the polynomials (stop: over the duration)."""


def text(name: str) -> str:
    """One of the files: pieces, terms, functions in one array, and zeros: rows are read four numbers at a time."""
    way, terms, gives, error = TABLES[name]
    head = (
        f"/* Table of a whole way: {gives}. Written by examples/map_tables.py, which has the equations.",
        f" * Relative error: at most {error:g}. film_lane_map.h evaluates it. docs/method.md, section 10. */",
        '#include "tables/film_job.h"',
        "",
        f"const double {name}[MAP_PIECES * {name.upper()}_TERMS * {name.upper()}_VALUES + 2] = {{",
    )
    return "\n".join([*head, *_rows([*pieces(way, terms).ravel().tolist(), 0.0, 0.0]), "};"]) + "\n"


def text_through() -> str:
    """film_way_through.c."""
    limits, ways = through()
    head = (
        "/* Table of the way through an elastic stage: velocity and time. Written by examples/map_tables.py, which has",
        " * the equations. Relative error: at most 2e-14. film_lane_map.h evaluates it. docs/method.md, section 10. */",
        '#include "tables/film_job.h"',
        "",
        "const double film_largest_share[PUSH_PIECES * LIMIT_TERMS] = {",
    )
    then = ("};", "", "const double film_way_through[2 * PUSH_PIECES * THROUGH_NUMBERS] = {")
    return "\n".join([*head, *_rows(limits.ravel().tolist(), 6), *then, *_rows(ways.ravel().tolist(), 6), "};"]) + "\n"


def _rows(numbers: list[float], wide: int = 4) -> list[str]:
    texts = [f"{number:.17g}" for number in numbers]
    return [f"    {', '.join(texts[k : k + wide])}," for k in range(0, len(texts), wide)]


if __name__ == "__main__":
    for file in TABLES:
        (CORE / f"{file}.c").write_text(text(file), encoding="utf-8")
    (CORE / "film_way_through.c").write_text(text_through(), encoding="utf-8")
