"""From a finite-element model to an impact: the vibrations of an L-shaped bracket, files, an impact, a picture.

The bracket is bent from 5 mm of aluminium, 40 mm wide, with legs of 60 mm. The upper half of one leg is screwed to a
wall; a steel ball hits the other leg near its tip, and three sensors follow. scikit-fem computes the vibrations, and
pyuff writes them as a universal file, as programs of finite elements do: `pip install "film-model[fem,modes]"`.

The shapes are taken in the middle of the thickness below the ball: the contact law describes the deformation around it.
"""

import math
import sys
from pathlib import Path

import numpy as np
import pyuff
from scipy.sparse.linalg import eigsh, splu
from skfem import Basis, BilinearForm, ElementHex2, ElementVector, MeshHex, asm, condense
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

import film_model as fm
from film_model.plot import plot_history
from film_model.targets.modes_of_programs import Told, read_vibrations

LEG, WIDTH, THICKNESS, WALL = 0.060, 0.040, 0.005, 0.030  # m
STRUCK = (0.055, 0.020, THICKNESS / 2)  # m
SENSORS = {
    "corner": (0.060, 0.040, THICKNESS / 2),
    "half way": (0.030, 0.020, THICKNESS / 2),
    "wall": (THICKNESS / 2, 0.020, 0.025),
}
METAL = fm.material("aluminium 6061-T6")
COUNT = 40


@BilinearForm
def mass(u, v, _):
    """∫ u·v dV."""
    return dot(u, v)


def bracket() -> tuple[Basis, list[int]]:
    """The mesh of quadratic hexahedra, and the first freedoms of the nodes below the ball and at the sensors."""
    along = np.concatenate([[0.0], np.linspace(THICKNESS, LEG, 12)])
    mesh = MeshHex.init_tensor(along, np.linspace(0.0, WIDTH, 5), along)
    middle = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.remove_elements(np.flatnonzero((middle[0] > THICKNESS) & (middle[2] > THICKNESS)))
    basis = Basis(mesh, ElementVector(ElementHex2()), intorder=4)
    near = (np.linalg.norm(basis.doflocs.T - point, axis=1) for point in (STRUCK, *SENSORS.values()))
    return basis, [int(np.argmin(distance)) for distance in near]  # the three displacements of a node follow each other


def vibrations() -> tuple[np.ndarray, np.ndarray, float]:
    """Frequencies [Hz], mass-normalised shapes [1/√kg] at the nodes in x, y and z, and the static compliance [m/N]."""
    basis, nodes = bracket()
    point = nodes[0] + 2
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
    moved = np.zeros((stiffness.shape[0], COUNT))
    moved[inner] = shapes
    at = np.array(nodes)[:, None] + np.arange(3)
    return np.sqrt(square) / (2 * math.pi), moved[at], compliance


def write(path: Path, frequency: np.ndarray, shapes: np.ndarray) -> None:
    """A universal file: data sets 55 with nodes 1 (struck), 2, 3 and 4."""
    file, none = pyuff.UFF(str(path)), np.zeros(len(shapes))
    kind = {"model_type": 1, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "data_type": 2, "load_case": 1}
    texts = {f"id{line}": "bracket" for line in range(1, 6)}
    modal = {"modal_m": 1.0, "modal_damp_vis": 0.002, "modal_damp_his": 0.0}
    for number, own in enumerate(frequency.tolist()):
        moved = {f"r{k + 1}": shapes[:, k, number] if k < 3 else none for k in range(6)}
        whole = texts | kind | modal | moved | {"freq": own, "mode_n": number + 1}
        made = pyuff.prepare_55(**whole, node_nums=np.arange(1, len(shapes) + 1))
        file.write_sets(made, mode="add" if number else "overwrite")


def scene(path: Path, compliance: float) -> fm.Scene:
    """A steel ball of 10 mm radius at 1 m/s."""
    sensors = [{"name": name, "shape": f"shape_{node}"} for node, name in enumerate(SENSORS, 2)]
    target = fm.Structure(str(path), METAL, static_compliance=f"{compliance!r} m/N", sensors=sensors)
    ball = fm.Sphere("10 mm", "1 m/s", material="bearing steel")
    return fm.Scene(ball, target, fm.Contact("hertz"), title="Steel ball on an aluminium bracket")


def main(folder: Path) -> fm.History:
    """Write bracket.unv, modes.csv, scene.toml and impact.png to a folder."""
    frequency, shapes, compliance = vibrations()
    write(folder / "bracket.unv", frequency, shapes)
    read_vibrations(folder / "bracket.unv", 1, "z", [2, 3, 4], Told()).write(folder / "modes.csv")
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
