"""Natural vibrations from other programs, as a file of vibrations: from results, universal files, meshes, matrices."""

from __future__ import annotations

import importlib
import math
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from film_model.base.arrays import Array
from film_model.base.errors import shown
from film_model.base.files import check_regular, written_whole
from film_model.base.threads import one_thread
from film_model.targets.dmig import read_dmig
from film_model.targets.mesh_modes import FORMATS, SERIES, read_mesh
from film_model.targets.nastran_results import has_vibrations, read_op2, read_punch
from film_model.targets.printed_results import read_dat
from film_model.targets.result_modes import ResultModes
from film_model.targets.structure_file import ROOTS

DIRECTIONS = ("x", "y", "z")

UNIVERSAL, MATRICES, NASTRAN, BINARY = (".unv", ".uff", ".uf"), (".npz", ".mtx"), (".pch", ".bdf", ".nas"), ".op2"
ANSYS, PRINTED, MESHES = ".rst", ".dat", (*FORMATS, SERIES)
"""Suffixes of the files that are read."""

SHAPES = (*UNIVERSAL, BINARY, ANSYS, PRINTED, *MESHES)
"""Suffixes of files that have vibrations at nodes whatever is in them."""

UNREAD = {
    "of vibrations": (".csv", ".nc"),
    "of results of Nastran": (".op4", ".f06", ".xdb", ".h5"),
    "of results of Ansys": (".rth", ".full", ".sub"),
    "of Abaqus": (".odb", ".fil", ".sim", ".inp"),
    "of results of CalculiX": (".frd",),
    "of Exodus": (".e", ".ex2", ".exo"),
    "of MATLAB": (".mat",),
}
"""Kinds of files that are not read, as messages name them, and their suffixes."""

EXPORT = (
    "a universal file (.unv, data sets 55), vibrations of Nastran (.op2, .pch), Ansys (.rst), Abaqus or CalculiX "
    "(.dat), a mesh with shapes (.vtu, .vtk, .pvd, .xdmf, .med), or reduced matrices as .npz, Matrix Market (.mtx) or "
    "DMIG of Nastran (.pch, .bdf), is needed"
)

MOST_ROWS = 3000
"""Largest matrices: their vibrations take some ten seconds, and the matrices 70 MB each."""

SHIFT = 1e-8
"""Shift of the eigenvalues over the median of K_ii/M_ii. Where nothing holds the structure, those near the median then
have errors of ε/SHIFT = 2e-8, and smaller ones smaller errors."""

RIGID = 1e-4
"""Eigenvalues over the shift below which they are 0 with rounding: a motion that nothing holds."""

MODAL = 2
"""Kind of analysis of a modal one in results of Ansys (ANTYPE,2)."""

NEEDS = '{} files need {}: install film-model[{extra}] (pip install "film-model[{extra}]")'


@dataclass(frozen=True)
class FoundModes:
    """Vibrations by ascending frequency, Hz.

    shape: of mass 1 kg, 1/√kg, at the struck point in the first row and at the sensors in the others. damping_ratio:
    ζ; None if unknown. static_compliance: at the struck point, m/N; None if unknown. sensors: numbers of their nodes or
    rows. coupling: largest off-diagonal term of the damping over the root of the product of the two diagonal ones; it
    is neglected. place: of the struck node, in units of the model, where the user may not know its number; else empty.
    """

    frequency: Array
    shape: Array
    damping_ratio: Array | None
    static_compliance: float | None
    sensors: tuple[int, ...]
    coupling: float = 0.0
    place: Sequence[float] = ()

    def write(self, path: Path) -> None:
        """As the CSV file that `kind = "structure"` reads; the shapes at sensors are columns shape_17."""
        columns = {"frequency [Hz]": self.frequency, "mass_normalised_shape [1/sqrt(kg)]": self.shape[0]}
        if self.damping_ratio is not None:
            columns["damping_ratio"] = self.damping_ratio
        columns |= {f"shape_{number}": row for number, row in zip(self.sensors, self.shape[1:], strict=True)}
        static = [] if self.static_compliance is None else [f"# static_compliance = {self.static_compliance!r} m/N"]
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        lines = [*static, ", ".join(columns), *(", ".join(map(repr, row)) for row in rows)]
        with written_whole(path) as beside:
            beside.write_text("\n".join(lines) + "\n", encoding="utf-8")


def check_kind(path: Path) -> str:
    """The suffix of a file in small letters; a ValueError if such files are not read, an OSError if there is none."""
    suffix = path.suffix.lower()
    if suffix in UNREAD["of vibrations"]:
        raise ValueError(f'{path} is a file of vibrations itself, which kind = "structure" reads')
    if suffix not in (*SHAPES, *MATRICES, *NASTRAN):
        what = next((what for what, own in UNREAD.items() if suffix in own), f"with the suffix {shown(suffix)}")
        raise ValueError(f"{path}: files {what} are not read: {EXPORT}")
    try:
        check_regular(path)
    except ValueError as error:
        raise ValueError(f"{path} {error}") from None
    return suffix


def gives_vibrations(path: Path, suffix: str) -> bool:
    """Whether a file has vibrations at nodes, not matrices."""
    return suffix in SHAPES or (suffix in NASTRAN and has_vibrations(path))


@dataclass(frozen=True)
class Told:
    """What the user says of a file: the model's unit of mass; frequencies, Hz, and modal masses of all vibrations in
    their order, or one mass, which the file may lack; and the name of the arrays of a mesh."""

    mass_unit: str | None = None
    frequencies: list[float] = field(default_factory=list)
    modal_masses: list[float] = field(default_factory=list)
    array: str | None = None


def read_vibrations(path: Path, node: int, direction: str, sensors: Sequence[int], told: Told) -> FoundModes:
    """The real vibrations of a universal file (data set 55, analysis type 2), of results of a program, or of a mesh, at
    nodes along x, y or z; of results in the systems of the nodes.

    The default unit of mass is that of data set 164, else kg. Raises ImportError without the reader, and ValueError if
    the file has no such vibrations, not all nodes, or none that moves the node.
    """
    # Deflection over that along another direction, below which a vibration does not move a node: 0 with rounding
    still = 1e-10
    unit, suffix = ROOTS[told.mass_unit or "kg"], path.suffix.lower()
    if suffix in UNIVERSAL:
        found, unit = _universal(path, told.mass_unit)
    elif suffix in MESHES:
        found = _mesh(path, told.array)
    else:
        found = {BINARY: read_op2, ANSYS: read_ansys, PRINTED: read_dat}.get(suffix, read_punch)(path)
    found.complete(path, told.frequencies, told.modal_masses)
    frequency, masses, moved, damping = found.at(path, [node, *sensors])
    along, largest = DIRECTIONS.index(direction), np.abs(moved[:, 0]).max(axis=0)
    if largest[along] <= still * largest.max():
        others = [name for name, size in zip(DIRECTIONS, largest, strict=True) if size > still * largest.max()]
        said = f"they move it along {' and '.join(others)}" if others else "nor in another direction: it is held"
        raise ValueError(f"{path}: no vibration moves node {node} along {direction}; {said}")
    if not (masses > 0.0).all():
        raise ValueError(f"{path}: a modal mass is {masses.min():g}, more than 0 is needed")
    shape = moved[:, :, along].T / np.sqrt(masses) * unit
    place = found.places[node] if found.places else ()
    return FoundModes(frequency, shape, damping, None, tuple(sensors), place=place)


def _mesh(path: Path, array: str | None) -> ResultModes:
    try:
        return read_mesh(path, array)
    except ModuleNotFoundError as error:
        raise ImportError(f"{path}: {NEEDS.format('mesh', 'meshio', extra='modes')}") from error


def read_ansys(path: Path) -> ResultModes:
    """Of a modal analysis of Ansys; its shapes are taken as normalised by mass."""
    try:
        reader: Any = importlib.import_module("ansys.mapdl.reader")
    except ImportError as error:
        raise ImportError(f"{path}: {NEEDS.format('results', 'ansys-mapdl-reader', extra='ansys')}") from error
    found = ResultModes()
    try:
        results = reader.read_binary(str(path))
        if results._resultheader["kan"] != MODAL:
            return found
        for k, frequency in enumerate(results.time_values):
            shape = found.add(path, k + 1, float(frequency))
            numbers, moved = results.nodal_solution(k)
            shape |= dict(zip(numbers.tolist(), map(tuple, moved[:, :3].tolist()), strict=True))
    except Exception as error:  # what it raises for other files is not documented
        raise ValueError(f"{path} cannot be read as results of Ansys: {error}") from None
    return found


def _universal(path: Path, mass_unit: str | None) -> tuple[ResultModes, float]:
    """The vibrations of a universal file, and √kg over the root of its unit of mass."""
    try:
        pyuff: Any = importlib.import_module("pyuff")
    except ImportError as error:
        raise ImportError(f"{path}: {NEEDS.format('universal', 'pyuff', extra='modes')}") from error
    try:
        read = pyuff.UFF(str(path)).read_sets()
    except Exception as error:  # pyuff raises Exception itself
        raise ValueError(f"{path} cannot be read as a universal file: {error}") from None
    sets = [read] if isinstance(read, dict) else list(read)
    modes = [one for one in sets if one.get("type") == 55 and one.get("analysis_type") == 2 and "freq" in one]
    if not modes:
        raise ValueError(f"{path} has no real vibrations: data sets 55 of analysis type 2 are needed")
    found = ResultModes()
    for number, one in enumerate(modes, 1):
        nodes = np.asarray(one["node_nums"]).astype(int).tolist()
        moved = [np.real(np.asarray(one.get(f"r{k}", np.zeros(len(nodes))))).tolist() for k in (1, 2, 3)]
        found.add(path, number, float(one["freq"])).update(zip(nodes, zip(*moved, strict=True), strict=True))
        found.mass[number], found.damping[number] = float(one["modal_m"]), float(one.get("modal_damp_vis", 0.0))
    return found, _root_of_mass(mass_unit, sets)


def _root_of_mass(mass_unit: str | None, sets: Sequence[dict[str, Any]]) -> float:
    """√kg over the root of the model's unit of mass. Data set 164 has the lengths and forces that are 1 m and 1 N."""
    if mass_unit is not None:
        return ROOTS[mass_unit]
    units = next((one for one in sets if one.get("type") == 164), {"length": 1.0, "force": 1.0})
    return math.sqrt(units["force"] / units["length"])  # the unit of mass is length/force kg


def read_matrices(path: Path, mass: Path | None, damping: Path | None, number: int, sensors: Sequence[int],
                  mass_unit: str | None, direction: str | None = None) -> FoundModes:  # fmt: skip
    """The vibrations of K φ = ω² M φ, all of them, at rows of the matrices, from 1, or at nodes along x, y or z.

    path: of a .npz file with K, M and perhaps C, of K in Matrix Market format, with those of M and C beside it, or of
    matrices of Nastran, which have nodes (`read_dmig`). Of C the modal damping ratios φᵀCφ/(2ω) are taken. The static
    compliance is that of K, exactly; where nothing holds the structure, the sum over its vibrations. mass_unit: of the
    matrices' consistent units; default kg. Raises ValueError for matrices that are not symmetric, of different sizes,
    or not positive.
    """
    nastran = path.suffix.lower() in NASTRAN
    matrices, rows = read_dmig(path, MOST_ROWS) if nastran else (_matrices(path, mass, damping), [])
    _check_matrices(path, matrices)
    if nastran:
        places = {node: k for k, (node, part) in enumerate(rows) if part in (0, DIRECTIONS.index(direction or "x") + 1)}
        missing = f"no node {{}} along {direction}: export its displacement among those that are kept"
    else:
        places = {k + 1: k for k in range(len(matrices["K"]))}
        missing = f"{len(places)} rows: row {{}} is not one of them"
    for asked in (number, *sensors):
        if asked not in places:
            raise ValueError(f"{path} has {missing.format(asked)}")
    points = [places[asked] for asked in (number, *sensors)]
    stiffness, inertia = matrices["K"], matrices["M"]
    square, shapes = _vibrations(path, stiffness, inertia)
    omega, unit = np.sqrt(square), ROOTS[mass_unit or "kg"]
    ratio, coupling = None, 0.0
    if "C" in matrices:
        modal = shapes.T @ matrices["C"] @ shapes
        own = np.diag(modal)
        if own.min() < -1e-9 * own.max():
            raise ValueError(f"{path}: the damping is not positive")
        ratio = np.where(omega > 0.0, np.maximum(own, 0.0) / np.where(omega > 0.0, 2.0 * omega, 1.0), 0.0)
        damped = own > 1e-9 * own.max()
        modal, own = modal[np.ix_(damped, damped)], own[damped]
        coupling = float(np.max(np.abs(modal - np.diag(own)) / np.sqrt(np.outer(own, own)), initial=0.0))
    struck = points[0]
    bends = square > 0.0
    static = float(np.sum(shapes[struck, bends] ** 2 / square[bends]))
    if bends.all():
        static = float(np.linalg.solve(stiffness, np.eye(len(stiffness))[struck])[struck])
    shape = shapes[points] * unit
    return FoundModes(omega / (2.0 * math.pi), shape, ratio, static * unit**2, tuple(sensors), coupling)


@one_thread
def _vibrations(path: Path, stiffness: Array, inertia: Array) -> tuple[Array, Array]:
    """ω² by ascending size, and shapes of mass 1, one per column.

    Of the inverse problem M φ = μ (K + shift M) φ, whose largest eigenvalues are exact to rounding: those of (K, M)
    have errors of ε times the largest ω². Vibrations without mass are left out.
    """
    import scipy.linalg

    heavy = np.diag(inertia) > 0.0
    shift = SHIFT * float(np.median(np.diag(stiffness)[heavy] / np.diag(inertia)[heavy])) if heavy.any() else 0.0
    held = stiffness + shift * inertia
    scale = 1.0 / np.sqrt(np.maximum(np.diag(held), np.finfo(np.float64).tiny))
    try:
        values, shapes = scipy.linalg.eigh(inertia * np.outer(scale, scale), held * np.outer(scale, scale))
    except scipy.linalg.LinAlgError:
        raise ValueError(f"{path}: the stiffness is not positive: its deflections store no energy") from None
    values, shapes = values[::-1], scale[:, None] * shapes[:, ::-1]
    if not values[0] > 0.0 or values[-1] < -1e-9 * values[0]:
        raise ValueError(f"{path}: the mass is not positive")
    kept = values > 1e-14 * values[0]  # below, a vibration has no mass and follows statically
    values, shapes = values[kept], shapes[:, kept] / np.sqrt(values[kept])
    square = 1.0 / values - shift
    return np.where(square < RIGID * shift, 0.0, square), shapes


def _matrices(path: Path, mass: Path | None, damping: Path | None) -> dict[str, Array]:
    """K, M and, if given, C, as the files have them."""
    if path.suffix.lower() == ".npz":
        try:
            with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
                return {name: np.asarray(file[name]) for name in ("K", "M", "C") if name in file.files}
        except (ValueError, TypeError, zipfile.BadZipFile) as error:  # TypeError: a single array
            raise ValueError(f"{path} cannot be read as .npz: {error}") from None
    files = {"K": path, "M": mass, "C": damping}
    return {name: _market(file) for name, file in files.items() if file is not None}


NEEDED = {".npz": "arrays K and M are needed", ".mtx": "give the file of M by --mass"}
"""What is needed where a matrix is missing, by suffix."""


def _check_matrices(path: Path, found: dict[str, Array]) -> None:
    """Make K, M and, if given, C exactly symmetric; a ValueError unless they are symmetric and of one size."""
    for name in ("K", "M"):
        if name not in found:
            need = NEEDED.get(path.suffix.lower(), "square DMIG whose names begin with K and M are needed")
            raise ValueError(f"{path}: no matrix {name}: {need}")
    size = (*found["K"].shape, 0)[:1]
    for name, matrix in found.items():
        if matrix.dtype.kind not in "iuf" or matrix.shape != (*size, *size) or not np.isfinite(matrix).all():
            need = f"finite real numbers in {size[0]} rows and columns are needed"
            raise ValueError(f"{path}: {name} has the shape {matrix.shape}: {need}")
        if not 1 <= size[0] <= MOST_ROWS:
            raise ValueError(
                f"{path}: {size[0]} rows: 1 to {MOST_ROWS} are allowed; reduce the model, or export its shapes"
            )
        if np.abs(matrix - matrix.T).max() > 1e-6 * np.abs(matrix).max():
            raise ValueError(f"{path}: {name} is not symmetric")
        found[name] = (matrix + matrix.T) / 2.0


def _market(path: Path) -> Any:
    from scipy.io import mmread
    from scipy.sparse import issparse

    try:
        found: Any = mmread(path)
    except ValueError as error:
        raise ValueError(f"{shown(str(path))} cannot be read as a matrix: {error}") from None
    return np.asarray(found.todense() if issparse(found) else found)
