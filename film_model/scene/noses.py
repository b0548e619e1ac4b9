"""Elastic contacts that are not round: cones, flat punches, and surfaces with two radii of curvature."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from film_model.base.arrays import Number, either, endless, greater, lesser, ratio, root, tangent

Volume = Callable[[Any], Number]

VOLUMES: Mapping[str, Volume | None] = {
    "cone": lambda nose: math.pi / 3.0 * nose.radius**3 / tangent(nose.half_angle),
    "flat punch": None,
    "cylinder": lambda nose: math.pi * nose.radius**2 * nose.length,
    "ellipsoid": lambda nose: math.pi / 3.0 * nose.length**2 * root(nose.radius * nose.second_radius),
}
"""Shapes other than balls → volume, m³, from the radius and the entries of `OWN`; None: the mass is needed."""

NOSE, OVAL = "Sneddon 1965", "Johnson 1985, section 4.2"
"""Sources of the contacts of cones and flat ends, and of ellipses."""

OWN = {"cone": ("half_angle",), "cylinder": ("length",), "ellipsoid": ("second_radius", "length")}
"""Shapes → entries that only they have. A length is needed for the mass alone."""


class Nose(NamedTuple):
    """F = factor E δ^exponent with the effective modulus E, over a circle of a radius [m] that is a function of the
    indentation [m]."""

    factor: Number
    exponent: float
    contact_radius: Callable[[Number], Number]


def cone(half_angle: Number) -> Nose:
    """F = (2/π) E tan α δ², a = (2/π) tan α δ, with the half angle α between axis and side, rad.

    Sneddon 1965, Int. J. Eng. Sci. 3:47, for a rigid cone on a half-space; with the effective modulus if both are
    elastic. Exact for small slopes cot α and without friction.
    """
    width = 2.0 / math.pi * tangent(half_angle)
    return Nose(width, 2.0, lambda depth: width * depth)


def flat_punch(radius: Number) -> Nose:
    """F = 2 E a δ of a flat end of the radius a (Sneddon 1965): exact for a rigid punch on a half-space, without
    friction. A cylinder that is softer than the target is also pressed along its length, which is left out."""
    return Nose(2.0 * radius, 1.0, lambda depth: radius + 0.0 * depth)


class Oval(NamedTuple):
    """An elliptic contact. radius: of the ball on a flat with the same force at each indentation, m. spread: area of
    the contact over that of this ball."""

    radius: Number
    spread: Number


def oval(one: Number, other: Number) -> Oval:
    """Hertz's elliptic contact, from the relative radii of curvature in the two principal planes, m.

    Johnson 1985, (4.24) to (4.26), with κ = b/a of the ellipse and Carlson's integrals: R'/R'' = D₁/D₂, where D₁ =
    R_D(0, 1, κ²) and D₂ = R_D(0, κ², 1). With K = R_F(0, κ², 1), the force is Hertz's for the radius
    √(R' R'') π² √(D₁ D₂)/(6 K³), exactly, and the contact's area 4 κ K²/π² times that of this ball.
    """
    from scipy.optimize import elementwise
    from scipy.special import elliprd, elliprf

    def integrals(log_axes: Any) -> tuple[Any, Any, Any]:
        square = np.exp(2.0 * log_axes)
        return square, elliprd(0.0, 1.0, square), elliprd(0.0, square, 1.0)

    def excess(log_axes: Any, wanted: Any) -> Any:
        _, over, under = integrals(log_axes)
        return np.log(over / under) - wanted

    wanted = np.atleast_1d(np.log(np.asarray(ratio(greater(one, other), lesser(one, other)))))
    # (a/b)^{3/2} ≤ R'/R'' ≤ (a/b)²; a little wider, so that a circle is inside, too
    found: Any = elementwise.find_root(excess, (-0.67 * wanted - 1e-9, 1e-9 - 0.49 * wanted), args=(wanted,))
    square, over, under = integrals(found.x)
    first = elliprf(0.0, square, 1.0)
    factor, spread = math.pi**2 / 6.0 * np.sqrt(over * under) / first**3, 4.0 / math.pi**2 * np.sqrt(square) * first**2
    if not isinstance(one, np.ndarray) and not isinstance(other, np.ndarray):
        factor, spread = factor.item(), spread.item()
    return Oval(root(one * other) * factor, spread)


def relative_radius(own: Number, other: Number) -> Number:
    """1/(1/R + 1/R_t), m; nan if that is not positive."""
    total = own + other
    return own if endless(other) else own * other / either(other * total > 0.0, total, math.nan)


def nose_of(body: Any) -> Nose | None:
    """The contact of an impactor with a flat target; None if it is a ball or an ellipsoid."""
    if body.shape not in VOLUMES or body.shape == "ellipsoid":
        return None
    return flat_punch(body.radius) if body.half_angle is None else cone(body.half_angle)


def oval_of(body: Any, target: Any) -> Oval | None:
    """The contact of an impactor and a target of which one has a second radius of curvature; None if none has."""
    if body.second_radius is None and getattr(target, "second_radius", None) is None:
        return None
    return oval(
        relative_radius(body.radius, target.radius), relative_radius(second_radius(body), second_radius(target))
    )


def elastic_radius(scene: Any, indentation: Number) -> Number:
    """Radius of the elastic contact of a scene at an indentation [m], m; of an ellipse, that of the circle of the same
    area."""
    if scene.nose is not None:
        return scene.nose.contact_radius(indentation)
    square = scene.effective_radius * indentation
    return root(square if scene.oval is None else scene.oval.spread * square)


def second_radius(body: Any) -> Number:
    """The radius in the other principal plane, m."""
    own = getattr(body, "second_radius", None)
    return body.radius if own is None else own
