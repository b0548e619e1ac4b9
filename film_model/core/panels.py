"""The core's plates with any edges, seen from Python. Nothing else knows their structure (film_panel.h)."""

from __future__ import annotations

import ctypes as c
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from film_model.base.arrays import Array, Index
from film_model.core import native
from film_model.core.headers import Header

RITZ = Header("plate/film_ritz.h", native.CORE)
EDGES = "simply supported", "clamped", "free"
"""Kinds of edges, in the order of their numbers in the core."""


@RITZ.structure("film_ritz")
class Functions(c.Structure):
    """Functions on a line; without arrays sines."""


PANEL = Header("plate/film_panel.h", RITZ)


@PANEL.structure("film_panel")
class Panel(c.Structure):
    """A plate with any edges, in any units."""


SPECTRUM = Header("plate/film_spectrum.h", native.CORE)

_library = native.with_functions(RITZ, PANEL, SPECTRUM)


def functions(shapes: int, arrays: Sequence[NDArray[Any]], halves: int) -> Functions:
    """Functions from Legendre coefficients, ∫f″², ∫f′g′, ∫f″g and whether they are odd, in contiguous arrays that must
    outlive them."""
    count, width = arrays[0].shape
    return Functions(count, shapes, width - 1, halves, *(array.ctypes.data for array in arrays))


def made(ends: tuple[str, str], degree: int, count: int) -> tuple[Array, Array, Array, Array]:
    """The core's own Legendre coefficients, ∫f″², ∫f′g′ and ∫f″g, as of film_ritz_make."""
    lib, found = _library(), Functions()
    memory, kinds = np.zeros(lib.film_ritz_size(degree)), (c.c_int32 * 2)(*map(EDGES.index, ends))
    if lib.film_ritz_make(c.byref(found), kinds, degree, count, memory.ctypes.data):
        raise ValueError(f"polynomials up to degree {degree} have fewer than {count} shapes")
    n = found.functions
    sizes = np.cumsum([n * (degree + 1), n, n * n, n * n])
    series, bent, sloped, crossed = np.split(memory[: sizes[-1]], sizes[:-1])
    return series.reshape(n, -1), bent, sloped.reshape(n, n), crossed.reshape(n, n)


def waves(panel: Panel, along: int, highest: float) -> float:
    """Half-waves along x (0) or y (1) up to a frequency."""
    return _library().film_panel_waves(c.byref(panel), along, highest)


def degree(panel: Panel, wave: float, highest: float, spare: float) -> int:
    """Degree of the polynomials along y that resolve the vibrations of half-waves along x."""
    return _library().film_panel_degree(c.byref(panel), wave, highest, spare)


def groups(
    panel: Panel, x: Functions, y: Functions, highest: float, sharpness: float, least: int
) -> list[tuple[Index, Index]]:
    """The products p, q that vibrations up to a frequency need, in groups that do not interact."""
    lib, sides = _library(), (c.byref(panel), c.byref(x), c.byref(y))
    room = np.empty((2, x.functions * y.functions), np.int32)
    found: list[tuple[Index, Index]] = []
    for group in range(lib.film_panel_groups(*sides)):
        count = lib.film_panel_group(*sides, highest, sharpness, least, group, *(each.ctypes.data for each in room))
        p, q = room[:, :count].astype(np.intp)
        found.append((p, q))
    return [block for block in found if block[0].size]


def energy(panel: Panel, x: Functions, y: Functions, p: Index, q: Index) -> Array:
    """Matrix of the energy of the products f_p(x) g_q(y), orthonormal in ∫∫w²."""
    rows, columns = (np.ascontiguousarray(index, np.int32) for index in (p, q))
    found = np.empty((p.size, p.size))
    given = c.byref(panel), c.byref(x), c.byref(y), p.size, rows.ctypes.data, columns.ctypes.data, found.ctypes.data
    _library().film_panel_energy(*given)
    return found


def compliance(energy: Array, struck: Array) -> float:
    """struck · energy⁻¹ · struck, by Cholesky's factor; NaN if the matrix, which is overwritten, is not positive."""
    given = np.ascontiguousarray(struck), np.empty(struck.size)
    pointers = (array.ctypes.data for array in (energy, *given))
    return _library().film_compliance(struck.size, *pointers)


def levy(panel: Panel, x: float, y: float) -> float:
    """Static deflection over force of a plate whose edges at y = 0 and b are simply supported."""
    return _library().film_panel_levy(c.byref(panel), x, y)


def tridiagonal(diagonal: Array, beside: Array, rows: Array) -> tuple[Array, Array]:
    """Eigenvalues of a symmetric tridiagonal matrix, ascending, and the components of rows along the eigenvectors."""
    values, below, columns = diagonal.copy(), np.append(beside, 0.0), np.ascontiguousarray(rows.T)
    given = values.size, values.ctypes.data, below.ctypes.data, len(rows), columns.ctypes.data
    if _library().film_tridiagonal(*given):
        raise np.linalg.LinAlgError("the eigenvalues of a tridiagonal matrix are not found")
    order = np.argsort(values, kind="stable")
    return values[order], columns[order].T
