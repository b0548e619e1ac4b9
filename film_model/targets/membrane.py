"""Membrane energy of the lowest vibrations of a plate or beam, by von Kármán's theory.

Bent, the middle surface stretches by e_ij = ½ w_,i w_,j. Displacements in its plane, whose inertia is neglected, take
away what they can: of e the part remains that is orthogonal, in the product ∫ e A e, to the strains of all such
displacements, polynomials here. For w = Σ w_n φ_n its energy is ½ Σ_k (Σ_ij H_kij w_i w_j)², k counting its principal
parts. In-plane displacements are 0 at edges that hold, or free at all edges.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import legendre

from film_model.base.arrays import Array
from film_model.base.threads import one_thread
from film_model.targets.modes import Modes, Points

GRID = 28
"""Gauss points along a side: with 36 the force at three thicknesses changes by 2e-7."""

IN_PLANE = 20
"""Polynomials along a side for each displacement in the plane: with 24 that force changes by 5e-5. On a beam `GRID`."""

SMALL = 1e-3
"""Principal parts over the largest that are left out, with modes in proportion to their deflections by a force at rest:
without them forces at half and three thicknesses change by 2e-5 to 2e-4. Of modes of equal size three times as many
parts would be needed, as the highest bend most."""

Seen = Callable[[Points], Modes]
"""The vibrations at points of a target."""


def plate_membrane(
    seen: Seen,
    sensed: Points,
    size: tuple[float, float],
    held: tuple[bool, ...],
    thickness: float,
    stiffness: tuple[float, float, float, float],
) -> tuple[Modes, Array]:
    """:func:`membrane_forms` of a plate whose membrane stiffness is 12/h² times the bending stiffness D11, D12, D22 and
    D66, N·m."""
    d11, d12, d22, d66 = (12.0 / thickness**2 * d for d in stiffness)
    membrane = np.array([[d11, d12, 0.0], [d12, d22, 0.0], [0.0, 0.0, d66]])
    return membrane_forms(seen, sensed, size, held, membrane)


@one_thread
def membrane_forms(
    seen: Seen, sensed: Points, size: tuple[float, ...], held: tuple[bool, ...], stiffness: Array
) -> tuple[Modes, Array]:
    """The vibrations at points of a plate or beam, `sensed`, and the forms H of their membrane energy, √J/m², as
    (parts, modes, modes), for displacements of the struck point.

    size: m. held: whether the ends of each side are held in the plane. stiffness: A of the strains xx, yy and 2 xy,
    N/m; of a beam E times its section, N, of the strain xx alone.
    """
    # Stiffness of displacements in the plane over that of the basic ones, so that those without strain stay small
    rigid = 1e-12
    at, weights = legendre.leggauss(GRID)
    grid = np.meshgrid(*((at + 1.0) * side / 2.0 for side in size), indexing="ij")
    points = tuple(map(tuple, np.stack(grid, -1).reshape(-1, len(size)).tolist()))
    modes = seen((*sensed, *points))
    weight = np.prod(np.meshgrid(*(weights * side / 2.0 for side in size), indexing="ij"), axis=0)
    shapes = (modes.factor[len(sensed) :] / modes.share).T.reshape(-1, *weight.shape)
    strains, lines = _stretched(shapes, at, size), _lines(at, size, held)
    forces = np.einsum("cd,pd...->pc...", stiffness, strains) * weight
    mixed = _work(forces, lines)
    plane = _energy(stiffness, lines, [weights * side / 2.0 for side in size])
    norms = np.sqrt(np.maximum(np.diagonal(plane), np.finfo(float).tiny))
    plane, mixed = plane / np.outer(norms, norms) + rigid * np.eye(len(norms)), mixed / norms[:, None]
    own = strains.reshape(len(strains), -1) @ forces.reshape(len(strains), -1).T
    left = own - mixed.T @ np.linalg.solve(plane, mixed)
    i, j = np.triu_indices(len(shapes))
    bent = modes.share / modes.frequency**2  # by a force at rest
    pairs = bent[i] * bent[j]
    sizes, parts = np.linalg.eigh(left * np.outer(pairs, pairs))
    kept = sizes > SMALL**2 * sizes[-1]
    forms = np.zeros((int(kept.sum()), len(shapes), len(shapes)))
    halves = np.where(i == j, 1.0, 0.5) / pairs
    forms[:, i, j] = forms[:, j, i] = (parts[:, kept] * np.sqrt(sizes[kept])).T * halves
    return Modes(modes.frequency, modes.share, factor=modes.factor[: len(sensed)]), forms


def _stretched(shapes: Array, at: Array, size: tuple[float, ...]) -> Array:
    """Strains of the middle surface for the products w_i w_j of modes, i <= j: (pairs, strains, points …)."""
    derive = np.linalg.solve(legendre.legvander(at, GRID - 1).T, _derivatives(at, GRID).T).T
    slopes = [
        np.moveaxis(np.tensordot(shapes, derive * 2.0 / side, (k + 1, 1)), -1, k + 1) for k, side in enumerate(size)
    ]
    i, j = np.triu_indices(len(shapes))
    twice = np.where(i == j, 0.5, 1.0).reshape(-1, *(1,) * len(size))
    strains = [slope[i] * slope[j] * twice for slope in slopes]
    if len(size) > 1:
        x, y = slopes
        strains.append((x[i] * y[j] + x[j] * y[i]) * twice)
    return np.stack(strains, axis=1)


def _derivatives(at: Array, count: int) -> Array:
    """Of Legendre's polynomials, (points, count)."""
    return np.stack(
        [np.asarray(legendre.legval(at, legendre.legder(row)), np.float64) for row in np.eye(count)], axis=1
    )


def _lines(at: Array, size: tuple[float, ...], held: tuple[bool, ...]) -> list[tuple[Array, Array]]:
    """Functions along each side, of whose products the displacements in the plane are made, and their derivatives, 1/m:
    (functions, points)."""
    count, lines = IN_PLANE if len(size) > 1 else GRID, list[tuple[Array, Array]]()
    for k, side in enumerate(size):
        values, slopes = np.asarray(legendre.legvander(at, count - 1), np.float64), _derivatives(at, count)
        for end, sign in zip(held[2 * k : 2 * k + 2], (1.0, -1.0), strict=True):
            if end:  # times the distance from the end
                near = (1.0 + sign * at)[:, None]
                values, slopes = values * near, slopes * near + sign * values
        lines.append((values.T, slopes.T * 2.0 / side))
    return lines


def _work(forces: Array, lines: list[tuple[Array, Array]]) -> Array:
    """Work of membrane forces on the strains of the displacements, along x and then along y: (displacements, pairs)."""
    (x, dx), *across = lines
    if not across:
        return dx @ forces[:, 0].T
    y, dy = across[0]
    xx, yy, xy = np.moveaxis(forces, 1, 0)
    both = np.stack([dx @ xx @ y.T + x @ xy @ dy.T, x @ yy @ dy.T + dx @ xy @ y.T])
    return np.moveaxis(both, 1, -1).reshape(-1, len(forces))


def _energy(stiffness: Array, lines: list[tuple[Array, Array]], weights: list[Array]) -> Array:
    """Twice the energy of the displacements: integrals along x times integrals along y."""
    ((x, dx), *across), (own, *other) = lines, weights
    if not across:
        return stiffness[0, 0] * (dx * own) @ dx.T
    y, dy = across[0]
    slopes, turns = np.kron(dx * own @ dx.T, y * other[0] @ y.T), np.kron(x * own @ x.T, dy * other[0] @ dy.T)
    mixed, twist = np.kron(dx * own @ x.T, y * other[0] @ dy.T), np.kron(x * own @ dx.T, dy * other[0] @ y.T)
    (xx, xy), (yy, shear) = stiffness[0, :2], np.diagonal(stiffness)[1:]
    mixed = xy * mixed + shear * twist
    return np.block([[xx * slopes + shear * turns, mixed], [mixed.T, yy * turns + shear * slopes]])
