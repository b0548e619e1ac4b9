"""Membrane forces: the warning's number against von Kármán's equations, solved by Ritz's method."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.polynomial import legendre

import film_model as fm
from film_model.effects.choose import choose

POINTS, WEIGHTS = legendre.leggauss(20)
RATIO = 0.3


def functions(odd, conditions, count, at):
    """Even or odd polynomials on −1 … 1 with 0, 1 or 2 derivatives 0 at the ends, and two derivatives of them."""
    degrees = np.arange(odd, count, 2)
    held = np.stack([np.ones(degrees.size), degrees * (degrees + 1) / 2])[:conditions]
    rows = np.zeros((degrees.size - conditions, count))
    rows[:, degrees] = np.linalg.svd(held)[2][conditions:] if conditions else np.eye(degrees.size)
    return [legendre.legval(at, legendre.legder(rows, n, axis=1).T) for n in range(3)]


def products(one, other, n, m):
    """Of the n-th and the m-th derivatives, on the unit plate of 2 by 2."""
    return np.einsum("ai,bj->abij", one[n], other[m]).reshape(-1, POINTS.size**2)


class Plane(NamedTuple):
    """Ritz's method for a square plate with E = 1, h = 1 and half-sides 1: matrices of bending energy and mass, the
    functions at the centre, their slopes, the strains of displacements in the plane, the product of two strains, the
    matrix that takes the products of a strain with these to the displacements, and the weights of points."""

    stiff: Any
    mass: Any
    at: Any
    slopes: Any
    strains: Any
    product: Any
    plane: Any
    weights: Any


def ritz(edges, slides):
    """The plate, with edges that slide in the plane or do not move."""
    bending, stretch = 1 / 12 / (1 - RATIO**2), 1 / (1 - RATIO**2)
    weights, held = np.outer(WEIGHTS, WEIGHTS).ravel(), 2 if edges == "clamped" else 1
    shape = functions(0, held, 12, POINTS)
    centre = functions(0, held, 12, np.zeros(1))[0][:, 0]
    at = np.outer(centre, centre).ravel()
    along, across, twist = (products(shape, shape, *order) for order in ((2, 0), (0, 2), (1, 1)))
    slope_x, slope_y = (products(shape, shape, *order) for order in ((1, 0), (0, 1)))
    crossed = (along * weights) @ across.T
    stiff = ((along + across) * weights) @ (along + across).T - (1 - RATIO) * (crossed + crossed.T)
    stiff = bending * (stiff + 2 * (1 - RATIO) * (twist * weights) @ twist.T)
    moved = [functions(odd, 0 if slides else 1, 16, POINTS) for odd in (1, 0)]
    zero = np.zeros((len(moved[0][0]) * len(moved[1][0]), weights.size))
    strains = (
        np.vstack([products(moved[0], moved[1], 1, 0), zero]),
        np.vstack([zero, products(moved[1], moved[0], 0, 1)]),
        np.vstack([products(moved[0], moved[1], 0, 1), products(moved[1], moved[0], 1, 0)]),
    )

    def product(one, other):
        straight = (one[0] + RATIO * one[1], one[1] + RATIO * one[0], (1 - RATIO) / 2 * one[2])
        return stretch * sum((a * weights) @ b.T for a, b in zip(straight, other, strict=True))

    plane = np.linalg.pinv(product(strains, strains), rcond=1e-12)
    still = products(shape, shape, 0, 0)
    return Plane(stiff, (still * weights) @ still.T, at, (slope_x, slope_y), strains, product, plane, weights)


def energy_and_force(edges, slides, deflection):
    """Of the plate when it is pressed at the centre; and its linear stiffness."""
    stiff, _, at, (slope_x, slope_y), strains, product, plane, weights = ritz(edges, slides)
    stretch = 1 / (1 - RATIO**2)
    state = deflection * np.linalg.solve(stiff, at) / (at @ np.linalg.solve(stiff, at))
    force = 0.0
    for _ in range(40):
        dx, dy = state @ slope_x, state @ slope_y
        own = (dx[None] ** 2 / 2, dy[None] ** 2 / 2, (dx * dy)[None])
        shift = plane @ product(strains, own)[:, 0]
        strain = [bent[0] - shift @ flat for bent, flat in zip(own, strains, strict=True)]
        bent = (slope_x * dx, slope_y * dy, slope_x * dy + slope_y * dx)
        pulled = stretch * np.array([strain[0] + RATIO * strain[1], strain[1] + RATIO * strain[0]])
        sheared = stretch * (1 - RATIO) / 2 * strain[2]
        inner = stiff @ state + product(bent, [part[None] for part in strain])[:, 0]
        twisted = (slope_x * (sheared * weights)) @ slope_y.T
        tangent = stiff + (slope_x * (pulled[0] * weights)) @ slope_x.T + (slope_y * (pulled[1] * weights)) @ slope_y.T
        mixed = product(strains, bent)
        tangent += twisted + twisted.T + product(bent, bent) - mixed.T @ plane @ mixed
        # the force that keeps the deflection of the centre
        whole = np.block([[tangent, -at[:, None]], [at[None], np.zeros((1, 1))]])
        change = np.linalg.solve(whole, np.append(force * at - inner, deflection - state @ at))
        state, force = state + change[:-1], force + change[-1]
        if abs(change[-1]) < 1e-9 * abs(force):
            break
    membrane = product([part[None] for part in strain], [part[None] for part in strain])[0, 0] / 2
    return state @ stiff @ state / 2 + membrane, force, 1 / (at @ np.linalg.solve(stiff, at))


@pytest.mark.parametrize("edges", ["simply supported", "clamped"])
@pytest.mark.parametrize("deflection", [0.6, 1.5, 2.5])  # over the thickness
def test_the_force_of_a_bent_plate(edges, deflection):
    """A slow, heavy impactor: both forces and the change that is said."""
    side, thickness, young = 0.1, 0.0005, 70e9
    scale = (side / 2 / thickness) ** 2  # of forces E h⁴/L² and energies E h⁵/L², L half a side
    for slides in (False, True):
        energy, force, stiffness = energy_and_force(edges, slides, deflection)
        energy, force = energy * young * thickness**3 / scale, force * young * thickness**2 / scale
        plain = np.sqrt(2 * energy * stiffness * young * thickness / scale)
        material = fm.Material("aluminium", f"{young} Pa", RATIO, "1 kg/m^3")
        plate = fm.Plate(material, f"{thickness} m", size=[f"{side} m"] * 2, edges=edges)
        ball = fm.Sphere("20 mm", f"{np.sqrt(2 * energy)} m/s", mass="1 kg", material=material)
        effects = choose(fm.Scene(ball, plate, fm.Contact("hertz"), fm.Effects(gravity=False))).effects
        said = next(effect for effect in effects if effect.name == "stretching").reason
        linear, immovable, sliding = (
            float(said.split(before)[1].split(" N")[0]) for before in ("with ", "about ", "edges, ")
        )
        assert linear == pytest.approx(plain, rel=0.02)
        assert (sliding if slides else immovable) == pytest.approx(force, rel=0.3)
        ratio = ((sliding if slides else immovable) - linear) / (force - plain)
        assert 0.5 < ratio < 2.0
