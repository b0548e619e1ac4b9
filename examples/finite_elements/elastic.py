"""Elastic contacts of large slope by finite elements: `python examples/finite_elements/elastic.py [FILE]`.

Statics, axisymmetric, without friction: an elastic ball on a rigid plane, and a rigid ball on an elastic half-space, at
prescribed approaches up to δ/R = 0.25. Strains are large. Elasticity is linear between Kirchhoff's stress and Hencky's
logarithmic strain, τ = λ tr(ln V) 1 + 2 µ ln V. The table takes a few minutes.

Elements have eight nodes and 2 × 2 points of integration. The rigid body is a penalty at two points of each edge, over
the undeformed surface. The ball decelerates as a whole: what is prescribed is the displacement of its centre of mass,
and its multiplier is the uniform body force that balances the contact. The ball's mesh is the half-space's under the
conformal map w → w/(1 + i w/2), without the far pole: 0.2 % of the volume. Lengths are in ball radii, stresses in
E* = E/(1 − ν²).
"""

import argparse
import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

Array = np.ndarray
Law = Callable[[Array, float, float], Array]

SLOPES = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5)
"""√(δ/R) of the table."""

TABLE = Path(__file__).parent / "elastic_contacts.csv"
"""The published table."""

EXTENT = {"ball": 20.0, "half-space": 300.0}
PENALTY = 300.0  # E* over the size of the finest elements: the surfaces overlap by 1e-4 δ
CONVERGED = 1e-5  # forces out of balance over that of the contact: rounding in the far elements is 1e-6
SOFT, RESTLESS, MOST_ITERATIONS = 3, 12, 60  # RESTLESS: a point enters and leaves contact by turns
LARGEST_STEP = 1.0  # of the displacements, over the size of the finest elements

COLUMNS = ("body", "poissons_ratio", "slope", "force_ratio", "mesh_error")
"""slope: √(δ/R). force_ratio: over Hertz's at that approach. mesh_error: of the force."""


class Mesh(NamedTuple):
    """Size of the finest elements, distance from the axis to which they reach, and growth of their size beyond."""

    size: float = 0.012
    fine: float = 0.06
    growth: float = 1.3


MESHES = (Mesh(0.008, 0.06, 1.2), Mesh(), Mesh(0.02, 0.06, 1.4))

CASES = (("ball", 0.3, 0, 10), ("half-space", 0.3, 1, 9))
"""Elastic body, Poisson's ratio and mesh, whose error the next one gives; and how many of `SLOPES`."""


class Row(NamedTuple):
    """One contact: √(δ/R), and the force over Hertz's at that approach."""

    slope: float
    force_ratio: float


def graded(mesh: Mesh, extent: float) -> Array:
    """Nodes along an edge: corners and middles, from the axis outwards."""
    ends, size = [0.0], mesh.size
    while ends[-1] < extent:
        ends.append(ends[-1] + size)
        size *= mesh.growth if ends[-1] > mesh.fine else 1.0
    ends = np.array(ends)
    return np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])]))


@dataclass(frozen=True)
class Body:
    """Nodes, elements (eight nodes each: corners, then middles) and the edges of the surface (three nodes each)."""

    r: Array
    z: Array
    elements: Array
    edges: Array
    fixed: Array  # degrees of freedom: 2 k along r, 2 k + 1 along z

    @classmethod
    def of(cls, kind: str, mesh: Mesh) -> "Body":
        line = graded(mesh, EXTENT[kind])
        n = line.size
        x, y = np.meshgrid(line, -line, indexing="ij")
        number = np.full((n, n), -1)
        used = ~((np.arange(n)[:, None] % 2 == 1) & (np.arange(n)[None, :] % 2 == 1))
        number[used] = np.arange(used.sum())
        i, j = np.meshgrid(np.arange(0, n - 1, 2), np.arange(0, n - 1, 2), indexing="ij")
        corners = ((0, 2), (2, 2), (2, 0), (0, 0), (1, 2), (2, 1), (1, 0), (0, 1))
        elements = np.stack([number[i + a, j + b].ravel() for a, b in corners], axis=-1)
        w = x[used] + 1j * y[used]
        if kind == "ball":
            w = w / (1.0 + 0.5j * w)
        r = np.where(x[used] == 0.0, 0.0, w.real)
        edges = np.stack([number[0 : n - 1 : 2, 0], number[1:n:2, 0], number[2:n:2, 0]], axis=-1)
        fixed = [2 * number[0][number[0] >= 0]]
        if kind == "half-space":
            outer = np.concatenate([number[-1][number[-1] >= 0], number[:, -1][number[:, -1] >= 0]])
            fixed += [2 * outer, 2 * outer + 1]
        return cls(r, w.imag, elements, edges, np.unique(np.concatenate(fixed)))


def shapes(x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Shape functions of eight nodes and their slopes: rows of points."""
    cx, cy = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    x, y = x[:, None], y[:, None]
    a, b = 1 + cx * x, 1 + cy * y
    corner = 0.25 * a * b * (cx * x + cy * y - 1)
    cornx, corny = 0.25 * cx * b * (2 * cx * x + cy * y), 0.25 * cy * a * (cx * x + 2 * cy * y)
    p, q = 1 - x * x, 1 - y * y
    middle = np.hstack([0.5 * p * (1 - y), 0.5 * q * (1 + x), 0.5 * p * (1 + y), 0.5 * q * (1 - x)])
    middx = np.hstack([-x * (1 - y), 0.5 * q, -x * (1 + y), -0.5 * q])
    middy = np.hstack([-0.5 * p, -y * (1 + x), 0.5 * p, -y * (1 - x)])
    return np.hstack([corner, middle]), np.hstack([cornx, middx]), np.hstack([corny, middy])


def hencky(gradient: Array, shear: float, lame: float) -> Array:
    """First Piola–Kirchhoff stress (rr, rz, zr, zz, θθ) of the deformation gradient, from ln of its stretches."""
    a, b, c, d, t = gradient
    rr, zz, rz = a * a + c * c, b * b + d * d, a * b + c * d
    middle, half = 0.5 * (rr + zz), np.sqrt((0.5 * (rr - zz)) ** 2 + rz * rz)
    most, least = middle + half, middle - half
    volume = 0.5 * np.log(most * least) + np.log(t)
    first, second = ((lame * volume + shear * np.log(square)) / square for square in (most, least))
    alike = half < 1e-5 * middle
    limit = (shear - lame * volume - shear * np.log(middle)) / middle**2
    slope = np.where(alike, limit, (first - second) / np.where(alike, 1.0, most - least))
    mean = 0.5 * (first + second)
    srr, szz, srz = mean + slope * (rr - middle), mean + slope * (zz - middle), slope * rz
    hoop = (lame * volume + 2.0 * shear * np.log(t)) / t
    return np.array([a * srr + b * srz, a * srz + b * szz, c * srr + d * srz, c * srz + d * szz, hoop])


class Contact:
    """One body of Poisson's ratio ν against a rigid one."""

    def __init__(self, kind: str, ratio: float, mesh: Mesh = MESHES[1], law: Law = hencky) -> None:
        self.kind, self.body = kind, Body.of(kind, mesh)
        modulus = 1.0 - ratio**2
        self.shear, self.lame = 0.5 * modulus / (1 + ratio), modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
        self.law, self.size = law, mesh.size
        body, point = self.body, 1.0 / np.sqrt(3.0)
        value, along, across = shapes(*(point * np.array(s) for s in ((-1, 1, 1, -1), (-1, -1, 1, 1))))
        r, z = body.r[body.elements], body.z[body.elements]
        jac = [[r @ along.T, z @ along.T], [r @ across.T, z @ across.T]]
        det = jac[0][0] * jac[1][1] - jac[0][1] * jac[1][0]
        radius = r @ value.T
        by_r = (jac[1][1][..., None] * along - jac[0][1][..., None] * across) / det[..., None]
        by_z = (jac[0][0][..., None] * across - jac[1][0][..., None] * along) / det[..., None]
        self.weight = det * radius
        self.b = np.zeros((*det.shape, 5, 16))
        self.b[..., 0, 0::2], self.b[..., 1, 0::2], self.b[..., 2, 1::2], self.b[..., 3, 1::2] = by_r, by_z, by_r, by_z
        self.b[..., 4, 0::2] = value / radius[..., None]
        self.dofs = np.stack([2 * body.elements, 2 * body.elements + 1], axis=-1).reshape(len(body.elements), 16)
        self.count = 2 * body.r.size
        self.mass = np.zeros(self.count)
        np.add.at(self.mass, 2 * body.elements + 1, np.einsum("eg,gk->ek", self.weight, value))
        s, self.edge_weight = np.polynomial.legendre.leggauss(2)
        self.edge = np.stack([0.5 * s * (s - 1), 1 - s * s, 0.5 * s * (s + 1)], axis=-1)
        slope = np.stack([s - 0.5, -2 * s, s + 0.5], axis=-1)
        er, ez = body.r[body.edges], body.z[body.edges]
        self.area = self.edge_weight * np.hypot(er @ slope.T, ez @ slope.T) * (er @ self.edge.T)
        self.edge_dofs = np.stack([2 * body.edges, 2 * body.edges + 1], axis=-1).reshape(len(body.edges), 6)
        self.free = np.setdiff1d(np.arange(self.count), body.fixed)

    def gap(self, u: Array, depth: float) -> tuple[Array, ...]:
        """Distance of the points of the surface from the rigid body, its normal, and the curvature of the distance."""
        nodes = self.body.edges
        r = (self.body.r + u[0::2])[nodes] @ self.edge.T
        z = (self.body.z + u[1::2])[nodes] @ self.edge.T
        if self.kind == "ball":  # a plane at z = 0
            return -z, np.zeros_like(z), -np.ones_like(z), np.zeros_like(z)
        above = z - (1.0 - depth)
        distance = np.hypot(r, above)
        return distance - 1.0, r / distance, above / distance, 1.0 / distance

    def residual(self, u: Array, depth: float) -> tuple[Array, csc_matrix, float]:
        """Forces of the nodes, stiffness, and contact force along z of one radian."""
        moved = u[self.dofs]
        gradient = np.einsum("egfk,ek->feg", self.b, moved) + np.array([1.0, 0, 0, 1, 1])[:, None, None]
        stress = self.law(gradient, self.shear, self.lame)
        tangent = np.empty((5, *stress.shape))
        for k in range(5):
            step = np.zeros((5, 1, 1))
            step[k] = 1e-6
            more, less = (self.law(gradient + sign * step, self.shear, self.lame) for sign in (1, -1))
            tangent[k] = (more - less) / 2e-6
        weighted = self.b * self.weight[..., None, None]
        inner = np.einsum("egfk,feg->ek", weighted, stress)
        part = np.einsum("hfeg,egfk->eghk", tangent, weighted)
        stiff = np.einsum("eghk,eghl->ekl", part, self.b, optimize=True)
        force = np.zeros(self.count)
        np.add.at(force, self.dofs, inner)
        gap, nr, nz, curvature = self.gap(u, depth)
        push = self.penalty * np.minimum(gap, 0.0) * self.area  # negative
        stiffness = self.penalty * (gap < 0.0) * self.area
        normal = np.stack([nr, nz], axis=-1)
        turn = (push * curvature)[..., None, None] * (np.eye(2) - normal[..., :, None] * normal[..., None, :])
        local = stiffness[..., None, None] * normal[..., :, None] * normal[..., None, :] + turn
        np.add.at(force, self.edge_dofs.reshape(-1, 3, 2), np.einsum("eg,gk,egi->eki", push, self.edge, normal))
        pressed = np.einsum("gk,gl,egij->ekilj", self.edge, self.edge, local).reshape(-1, 6, 6)
        rows = np.concatenate([np.repeat(self.dofs, 16, 1).ravel(), np.repeat(self.edge_dofs, 6, 1).ravel()])
        columns = np.concatenate([np.tile(self.dofs, 16).ravel(), np.tile(self.edge_dofs, 6).ravel()])
        values = np.concatenate([stiff.ravel(), pressed.ravel()])
        matrix = coo_matrix((values, (rows, columns)), shape=(self.count, self.count)).tocsc()
        return force, matrix, float(abs((push * nz).sum()))

    def moved(self, slope: float) -> Array:
        """A guess: the ball is moved as a whole, the half-space as the surface outside and inside Hertz's contact."""
        u = np.zeros(self.count)
        if self.kind == "ball":
            u[1::2] = slope**2
        elif slope > 0.0:
            distance = np.hypot(self.body.r, self.body.z) / slope
            far = np.maximum(distance, 1.0)
            outside = ((2.0 - far**2) * np.arcsin(1.0 / far) + np.sqrt(far**2 - 1.0)) / np.pi
            u[1::2] = -0.97 * slope**2 * np.where(distance < 1.0, 1.0 - 0.5 * distance**2, outside)
            u[self.body.fixed] = 0.0
        return u

    def solved(self, depth: float, u: Array, body_force: float) -> tuple[Array, float, Row]:
        """The displacements at an approach by Newton's method from a guess; with the body force of a ball."""
        free, whole = self.free, self.mass.sum()
        for count in range(MOST_ITERATIONS):
            self.penalty = (0.01 if count < SOFT else 1.0) * PENALTY / self.size  # guesses overlap
            force, matrix, push = self.residual(u, depth)
            off = (force + body_force * self.mass)[free]
            short = depth * whole - self.mass @ u if self.kind == "ball" else 0.0
            if count > SOFT and max(np.abs(off).max() / push, abs(short) / whole) < CONVERGED:
                break
            factor = splu(matrix[free][:, free], "MMD_AT_PLUS_A", options={"SymmetricMode": True})
            step, more = factor.solve(-off), 0.0
            if self.kind == "ball":
                lift = factor.solve(self.mass[free])
                more = (self.mass[free] @ step - short) / (self.mass[free] @ lift)
                step -= more * lift
            part = min(1.0 if count < RESTLESS else 0.5, LARGEST_STEP * self.size / np.abs(step).max())
            u = u.copy()
            u[free] += part * step
            body_force += part * more
        else:
            raise RuntimeError(f"no equilibrium at δ/R = {depth}")
        total, slope = 2.0 * np.pi * push, depth**0.5
        return u, body_force, Row(slope, total / (4 / 3 * slope**3))

    def rows(self, slopes: tuple[float, ...] = SLOPES) -> Iterator[Row]:
        """The contact at growing approaches, each from the one before."""
        u, body_force, before = np.zeros(self.count), 0.0, 0.0
        for slope in slopes:
            body_force = body_force * (slope / before) ** 3 if before else 0.0
            u, body_force, row = self.solved(slope**2, u + self.moved(slope) - self.moved(before), body_force)
            before = slope
            yield row


def fitted(slopes: Array, forces: Array, terms: int) -> Array:
    """c_k of F/F_Hertz = 1 + c_1 x + c_2 x² + …, x = √(δ/R), by least squares of relative differences."""
    powers = np.stack([slopes**k for k in range(1, terms + 1)], axis=-1)
    return np.linalg.lstsq(powers / forces[:, None], (forces - 1.0) / forces, rcond=None)[0]


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", nargs="?", type=Path, default=TABLE)
    with parser.parse_args().file.open("w") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for kind, ratio, number, count in CASES:
            fine, coarse = (Contact(kind, ratio, mesh).rows(SLOPES[:count]) for mesh in MESHES[number : number + 2])
            for row, other in zip(fine, coarse, strict=True):
                off = abs(other.force_ratio / row.force_ratio - 1.0)
                table.writerow([kind, ratio, row.slope, f"{row.force_ratio:.4f}", f"{off:.4f}"])


if __name__ == "__main__":
    main()
