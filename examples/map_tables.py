"""Tables of whole ways: `python -m examples.map_tables` writes `film_way_in.c` and `film_way_out.c`.

With a force of exponent 3/2 two ways on a target that moves are functions of one number: the way in from first touch
along a plain power, and the way out from rest. In units of each way, with x = u² and dt = 2u ds,

    u' = w − Λ u³,  w' = −2 c u⁴,  t' = 2u.

The way in starts at u = 0, w = 1 with c = 5/4 and Λ = γ f(X)/ν, X the depth on a fixed target; it turns where u' = 0.
The way out starts at u = 1, w = Λ = γ √(F/recovery) with c = 1; it ends at u = 0. Taylor series of order 30 integrate
them in extended precision (the 80 bits of the processor where NumPy has them): docs/method.md, section 10.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

CORE = Path(__file__).resolve().parent.parent / "film_model" / "core" / "tables"
PER_OCTAVE, OCTAVES = 8, 4
"""Pieces of each doubling of 1 + Λ, and doublings: up to Λ = 15."""
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
    """The motion where u' ("turn"), w ("stop") or u ("end") falls to 0."""
    u, w, t = (values.copy() for values in start)
    left = np.ones(number.size, bool)
    for _ in range(3000):
        g = number[left]
        us, ws, ts = _series(g, c[left], u[left], w[left], t[left])
        k = np.arange(_ORDER - 1, _ORDER + 1)[:, None]
        sizes = np.maximum(abs(us[k[:, 0]]) / abs(us).max(axis=0), abs(ws[k[:, 0]]) / abs(ws[0]).clip(1e-9))
        step = ((_LAST / sizes.clip(1e-300)) ** (1 / k)).min(axis=0)
        slope = us[1:] * np.arange(1, _ORDER + 1)[:, None]
        watched = {"turn": np.vstack([slope, 0 * slope[:1]]), "stop": ws, "end": us}[until]
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
        f" * Relative error: at most {error:g}. film_lane_power.h evaluates it. docs/method.md, section 10. */",
        '#include "tables/film_job.h"',
        "",
        f"const double {name}[MAP_PIECES * {name.upper()}_TERMS * {name.upper()}_VALUES + 2] = {{",
    )
    made = pieces(way, terms)
    texts = [_digits(*pair) for pair in np.broadcast(made, 1e-18 * abs(made[:, :1]))]
    indent = {"initial_indent": "    ", "subsequent_indent": "    "}
    return "\n".join([*head, textwrap.fill(", ".join([*texts, "0", "0"]), 119, **indent) + ",", "};"]) + "\n"


def _digits(number: float, least: float) -> str:
    """A coefficient with the digits above `least`, beyond which it changes no sum: 17, or fewer."""
    return f"{number:.{np.clip(int(np.log10(abs(number) / least)) + 1, 1, 17)}g}" if abs(number) > least else "0"


if __name__ == "__main__":
    for file in TABLES:
        (CORE / f"{file}.c").write_text(text(file), encoding="utf-8")
