"""From a finite-element model to an impact: the vibrations of an L-shaped bracket, a file, an impact, a picture.

The bracket is bent from 5 mm of aluminium, 40 mm wide, with legs of 60 mm. The upper half of one leg is screwed to a
wall; a steel ball hits the other leg near its tip. scikit-fem computes the vibrations (`pip install scikit-fem`); any
other program will do that writes their frequencies, modal masses and shapes at the struck point.

The shapes are taken in the middle of the thickness below the ball: the contact law describes the deformation around it.
"""

import math
import sys
from pathlib import Path

import numpy as np
from scipy.sparse.linalg import eigsh, splu
from skfem import Basis, BilinearForm, ElementHex2, ElementVector, MeshHex, asm, condense
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

import film_model as fm
from film_model.plot import plot_history

LEG, WIDTH, THICKNESS, WALL = 0.060, 0.040, 0.005, 0.030  # m
STRUCK = (0.055, 0.020, THICKNESS / 2)  # m
METAL = fm.material("aluminium 6061-T6")
COUNT = 40


@BilinearForm
def mass(u, v, _):
    """∫ u·v dV."""
    return dot(u, v)


def bracket() -> tuple[Basis, int]:
    """The mesh of quadratic hexahedra, and the number of the vertical displacement below the ball."""
    along = np.concatenate([[0.0], np.linspace(THICKNESS, LEG, 12)])
    mesh = MeshHex.init_tensor(along, np.linspace(0.0, WIDTH, 5), along)
    middle = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.remove_elements(np.flatnonzero((middle[0] > THICKNESS) & (middle[2] > THICKNESS)))
    basis = Basis(mesh, ElementVector(ElementHex2()), intorder=4)
    near = np.linalg.norm(basis.doflocs - np.array(STRUCK)[:, None], axis=0)
    point = np.flatnonzero(near < near.min() + 1e-9)
    return basis, int(point[2])  # the three displacements of a node follow each other


def vibrations() -> tuple[np.ndarray, np.ndarray, float]:
    """Frequencies [Hz], mass-normalised shapes at the struck point [1/√kg], and the static compliance [m/N]."""
    basis, point = bracket()
    stiffness = asm(linear_elasticity(*lame_parameters(METAL.youngs_modulus, METAL.poissons_ratio)), basis)
    inertia = METAL.density * asm(mass, basis)
    wall = basis.get_dofs(lambda x: (x[0] < 1e-9) & (x[2] > WALL - 1e-9))
    force = np.zeros(stiffness.shape[0])
    force[point] = 1.0
    small_stiffness, load, _, inner = condense(stiffness, force, D=wall)
    small_inertia = condense(inertia, D=wall, expand=False)
    square, shapes = eigsh(small_stiffness, COUNT, M=small_inertia, sigma=0.0)
    place = int(np.flatnonzero(inner == point)[0])
    compliance = float(splu(small_stiffness.tocsc()).solve(load)[place])
    return np.sqrt(square) / (2 * math.pi), shapes[place], compliance


def write(path: Path, frequency: np.ndarray, shape: np.ndarray) -> None:
    """The file that `kind = "structure"` reads."""
    rows = (f"{f:.9g}, {s:.9g}" for f, s in zip(frequency, shape, strict=True))
    heading = "frequency [Hz], mass_normalised_shape [1/sqrt(kg)]"
    path.write_text("\n".join((heading, *rows)) + "\n", encoding="utf-8")


def scene(path: Path, compliance: float) -> fm.Scene:
    """A steel ball of 10 mm radius at 1 m/s."""
    target = fm.Structure(str(path), METAL, static_compliance=f"{compliance!r} m/N")
    ball = fm.Sphere("10 mm", "1 m/s", material="bearing steel")
    return fm.Scene(ball, target, fm.Contact("hertz"), title="Steel ball on an aluminium bracket")


def main(folder: Path) -> fm.History:
    """Write modes.csv, scene.toml and impact.png to a folder."""
    frequency, shape, compliance = vibrations()
    write(folder / "modes.csv", frequency, shape)
    on_bracket = scene(folder / "modes.csv", compliance)
    (folder / "scene.toml").write_text(on_bracket.to_toml(), encoding="utf-8")
    history = fm.simulate(on_bracket, accuracy=1e-3)
    plot_history(history, folder / "impact.png")
    return history


if __name__ == "__main__":
    where = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    result = main(where)
    print(result.summary)
    print(*result.warnings, sep="\n")
