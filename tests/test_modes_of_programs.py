"""Vibrations from universal files and matrices: against closed forms, and one sentence for every mistake."""

import math
import re

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import coo_array

import film_model as fm
from film_model.cli.main import main
from film_model.targets.modes_of_programs import read_matrices
from film_model.targets.structure_file import read_structure

LINKS, MASS, SPRING = 30, 0.2, 4e6  # a chain of masses, kg, and springs, N/m


def chain(held):
    """K, M and C of a chain that is free at the last mass and held at the first, or free: proportional damping."""
    stiffness = SPRING * (np.diag(np.full(LINKS, 2.0)) - np.eye(LINKS, k=1) - np.eye(LINKS, k=-1))
    stiffness[-1, -1] = SPRING
    stiffness[0, 0] = 2.0 * SPRING if held else SPRING
    return stiffness, MASS * np.eye(LINKS), 2e-6 * stiffness


def frequencies(held):
    """2 √(k/m) sin(θ/2): θ = (2n − 1)π/(2N + 1) if held, nπ/N if free."""
    n = np.arange(LINKS)
    theta = (2 * n + 1) * math.pi / (2 * LINKS + 1) if held else n * math.pi / LINKS
    return 2.0 * math.sqrt(SPRING / MASS) * np.sin(theta / 2) / (2 * math.pi)


@pytest.mark.parametrize("held", [True, False])
def test_matrices(held, tmp_path):
    """From .npz and from Matrix Market; the compliance of N springs in series, or the sum over vibrations."""
    stiffness, inertia, damping = chain(held)
    np.savez(tmp_path / "chain.npz", K=stiffness, M=inertia, C=damping)
    for name, matrix in (("K", stiffness), ("M", inertia)):
        mmwrite(tmp_path / f"{name}.mtx", coo_array(matrix), symmetry="symmetric")
    found = read_matrices(tmp_path / "chain.npz", None, None, LINKS, [1], None)
    again = read_matrices(tmp_path / "K.mtx", tmp_path / "M.mtx", None, LINKS, [1], None)
    exact = frequencies(held)
    assert found.frequency == pytest.approx(exact, rel=1e-10 if held else 1e-8, abs=0.0)
    assert again.frequency == pytest.approx(found.frequency, rel=1e-12)
    assert found.damping_ratio == pytest.approx(1e-6 * 2 * math.pi * exact, rel=1e-8) and found.coupling < 1e-9
    if held:
        assert found.static_compliance == pytest.approx(LINKS / SPRING, rel=1e-12)
    else:  # 1/k Σ (j/N)² over the springs j: the force less the inertia of what moves as a whole
        assert found.static_compliance == pytest.approx(sum((j / LINKS) ** 2 for j in range(LINKS)) / SPRING, rel=1e-9)
        assert found.shape[0, 0] ** 2 == pytest.approx(1 / (LINKS * MASS), rel=1e-9)


def test_massless_rows_follow_statically(tmp_path):
    """A spring without mass on a chain that is held: no vibration of its own, its compliance counts."""
    stiffness, inertia, _ = chain(True)
    stiffness[-1, -1] += 1e5
    k, m = np.zeros((2, LINKS + 1, LINKS + 1))
    k[:LINKS, :LINKS], m[:LINKS, :LINKS] = stiffness, inertia
    k[-1, -1], k[-1, -2], k[-2, -1] = 1e5, -1e5, -1e5
    np.savez(tmp_path / "tip.npz", K=k, M=m)
    found = read_matrices(tmp_path / "tip.npz", None, None, LINKS + 1, [], None)
    assert found.frequency == pytest.approx(frequencies(True), rel=1e-9)
    assert found.static_compliance == pytest.approx(LINKS / SPRING + 1e-5, rel=1e-9)


def test_from_the_command_line_to_the_impact(tmp_path, capsys):
    """In mm, N and t; the file has the compliance and the sensor."""
    stiffness, inertia, _ = chain(True)
    np.savez(tmp_path / "chain.npz", K=stiffness / 1e3, M=inertia / 1e3)
    output = tmp_path / "modes.csv"
    where = f"--node {LINKS} --sensors 15 --mass-unit t --output {output}".split()
    assert main(["modes", "read", str(tmp_path / "chain.npz"), *where]) == 0
    said = capsys.readouterr().out
    assert f"{LINKS} vibrations from" in said and "static compliance 7.5e-06 m/N" in said
    target = fm.Structure(str(output), "mild steel", sensors=[{"name": "half way", "shape": "shape_15"}])
    assert target.static_compliance == pytest.approx(LINKS / SPRING) and target.frequency == pytest.approx(
        frequencies(True)
    )
    modes = target.modes(1e9)
    assert float(np.sum(modes.factor / modes.frequency**2)) == pytest.approx(15 / SPRING, rel=1e-9)
    assert main(["modes", "read", str(tmp_path / "chain.npz"), *where]) == 3  # the file exists


def test_universal_files(tmp_path, capsys):
    """Data set 164 gives the unit of mass; nodes in any order."""
    pyuff = pytest.importorskip("pyuff")
    path, nodes, zero = tmp_path / "plate.unv", np.array([7, 3, 12]), np.zeros(3)
    file = pyuff.UFF(str(path))
    file.write_sets(
        pyuff.prepare_164(
            units_code=9, units_description="mm", temp_mode=1, length=1e3, force=1.0, temp=1.0, temp_offset=0.0
        ),
        mode="overwrite",
    )
    for number, (frequency, shape) in enumerate(((250.0, [0.5, 1.0, -2.0]), (100.0, [1.0, 2.0, 3.0])), 1):
        numbers = {f"r{k}": zero for k in (1, 2, 4, 5, 6)} | {
            "r3": np.array(shape),
            "node_nums": nodes,
            "mode_n": number,
        }
        kind = {"model_type": 1, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "data_type": 2, "load_case": 1}
        modal = {"freq": frequency, "modal_m": 4.0, "modal_damp_vis": 0.01, "modal_damp_his": 0.0}
        file.write_sets(pyuff.prepare_55(**{f"id{k}": "" for k in range(1, 6)}, **kind, **numbers, **modal), mode="add")
    output = tmp_path / "modes.csv"
    read = ["modes", "read", str(path), "--node", "3", "--direction", "z", "--sensors", "12,7", "--output", str(output)]
    assert main(read) == 0
    found = read_structure(str(output), ("shape_12", "shape_7"))
    assert found.frequency == (100.0, 250.0) and found.damping_ratio == (0.01, 0.01)
    assert found.modal_mass == pytest.approx((4e3 / 4.0, 4e3 / 1.0)) and found.shapes["shape_12"] == (1.5, -2.0)
    output.unlink()
    read[4] = "4"
    capsys.readouterr()
    assert main(read) == 3 and "at 100 Hz has no node 4" in capsys.readouterr().err
    read[4], read[6] = "3", "x"
    assert main(read) == 3 and not output.exists()
    assert "no vibration moves node 3 along x; they move it along z" in capsys.readouterr().err
    path.write_text("nothing\n")
    assert main(read) == 3 and "plate.unv" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"K": -np.eye(3)}, "the stiffness is not positive"),
        ({"M": np.diag([1.0, -1.0, 1.0])}, "the mass is not positive"),
        ({"K": np.array(1.0)}, "K has the shape \\(\\)"),
        ({"M": np.eye(2)}, "M has the shape \\(2, 2\\): finite real numbers in 3 rows"),
        ({"K": np.eye(3) + np.eye(3, k=1)}, "K is not symmetric"),
        ({"C": -np.eye(3)}, "the damping is not positive"),
        ({"K": np.eye(3) * np.nan}, "finite real numbers"),
    ],
)
def test_wrong_matrices(change, message, tmp_path):
    np.savez(tmp_path / "wrong.npz", **({"K": np.eye(3), "M": np.eye(3)} | change))
    with pytest.raises(ValueError, match=message):
        read_matrices(tmp_path / "wrong.npz", None, None, 1, [], None)


def test_wrong_arguments(tmp_path, capsys):
    np.savez(tmp_path / "m.npz", M=np.eye(3))
    np.savez(tmp_path / "good.npz", M=np.eye(3), K=np.eye(3))
    mmwrite(tmp_path / "K.mtx", coo_array(np.eye(3)))
    (tmp_path / "good.unv").touch()
    for name, arguments, said in (
        ("K.mtx", [], "K.mtx: no matrix M: give the file of M by --mass"),
        ("K.mtx", ["--mass", str(tmp_path / "gone.mtx")], "gone.mtx"),
        ("m.npz", [], "no matrix K: arrays K and M are needed"),
        ("good.npz", ["--sensors", "4"], "has 3 rows: row 4 is not one of them"),
        ("good.npz", ["--sensors", "1,1"], "names a number twice"),
        ("good.unv", [], "--direction: missing"),
    ):
        given = [str(tmp_path / name), "--node", "1", "--output", str(tmp_path / "out.csv"), *arguments]
        assert main(["modes", "read", *given]) == 3 and said in capsys.readouterr().err
        assert not (tmp_path / "out.csv").exists()


def test_files_that_are_not_read(tmp_path, capsys):
    """Each is named, and what is needed instead; an absent one is told before it is read."""
    (tmp_path / "folder.unv").mkdir()
    (tmp_path / "bad.npz").write_bytes(b"PK\x03\x04 cut")
    for name, arguments, said in (
        ("plate.op2", "", "plate.op2: files of results of Nastran are not read: a universal file (.unv"),
        ("plate.OP2", "", "files of results of Nastran are not read"),
        ("plate.rst", "", "files of results of Ansys are not read"),
        ("plate.h5", "", 'files with the suffix ".h5" are not read'),
        ("plate", "", 'files with the suffix "" are not read'),
        ("modes.csv", "", 'modes.csv is a file of vibrations itself, which kind = "structure" reads'),
        ("gone.npz", "", "gone.npz: No such file or directory"),
        ("gone.unv", "--direction z", "gone.unv: No such file or directory"),
        ("folder.unv", "--direction z", "folder.unv is a folder"),
        ("bad.npz", "", "bad.npz cannot be read as .npz: "),
    ):
        given = [str(tmp_path / name), "--node", "1", "--output", str(tmp_path / "out.csv"), *arguments.split()]
        assert main(["modes", "read", *given]) == 3
        error = capsys.readouterr().err
        assert said in error and "Errno" not in error and error.count("\n") == 1, error


def small(name, *fields):
    return name.ljust(8) + "".join(str(field).rjust(8) for field in fields) + "\n"


def large(name, *fields):
    """Two lines of fields of 16 characters, numbers as Fortran writes them."""
    texts = [f"{field:.9E}".replace("E", "D") if isinstance(field, float) else str(field) for field in fields]
    return "".join(
        word.ljust(8) + "".join(text.rjust(16) for text in part) + "\n"
        for word, part in ((f"{name}*", texts[:4]), ("*", texts[4:]))
        if part
    )


def dmig(written, commas=False):
    """The chain at nodes 101, 102 ... along z: K symmetric, its half; M and B square; others that are not read."""
    stiffness, inertia, damping = chain(True)
    text = "$TITLE = CHAIN\nGRID,7,,0.0,0.0,0.0\n" + written("DMIG", "KAAX", 0, 6, 2, 0, "", "", LINKS)
    for matrix, name, half in ((stiffness, "KAAX", 1), (inertia, "MAAX", 0), (damping, "BAAX", 0)):
        text += "" if half else written("DMIG", name, 0, 1, 2, 0, "", "", LINKS)
        for k, column in enumerate(matrix.T):
            rows = [i for i in np.flatnonzero(column).tolist() if i >= k or not half]
            terms = [field for i in rows for field in (101 + i, 3, float(column[i]), "")]
            text += written("DMIG", name, 101 + k, 3, "", *terms[:4])
            for at in range(4, len(terms), 4):
                text += written("", *terms[at : at + 4]) if written is small else large("", *terms[at : at + 4])
    text += written("DMIG", "MUG1", 0, 9, 2, 0, "", "", 1) + written("DMIG", "MUG1", 1, 1, "", 8, 1, 2.0)
    text += written("DMIG", "PAX", 0, 9, 2, 0, "", "", 1) + written("DMIG", "K4AAX", 7, 1, "", 8, 1, 2.0)
    return text + "ASET1   123     101     THRU    130\n"


@pytest.mark.parametrize("written", [small, large])
def test_matrices_of_nastran(written, tmp_path, capsys):
    path, output = tmp_path / "chain.pch", tmp_path / "modes.csv"
    path.write_text(dmig(written))
    found = read_matrices(path, None, None, 100 + LINKS, [101], None, "z")
    exact = frequencies(True)
    assert found.frequency == pytest.approx(exact, rel=1e-9) and found.sensors == (101,)
    assert found.damping_ratio == pytest.approx(1e-6 * 2 * math.pi * exact, rel=1e-8)
    assert found.static_compliance == pytest.approx(LINKS / SPRING, rel=1e-9)
    read = ["modes", "read", str(path), "--node", "130", "--output", str(output), "--force"]
    assert main(read) == 3 and "--direction: missing" in capsys.readouterr().err
    assert main([*read, "--direction", "z"]) == 0
    capsys.readouterr()
    assert main([*read, "--direction", "x"]) == 3 and "has no node 130 along x" in capsys.readouterr().err


def test_entries_of_nastran(tmp_path):
    """Numbers without E, two terms in a line, commas, scalar points, and what is refused."""
    path = tmp_path / "two.bdf"
    path.write_text(
        "DMIG,K2GG,0,6,1\nDMIG,K2GG,1,3,,1,3,3.+5\n,2,0,-1.+5\n+,\nDMIG    K2GG           2       0"
        "               2       0   1.+5\nDMIG    M2GG           0       6       1\n"
        "DMIG,m2gg,1,3,,1,3,2.-1\nDMIG,M2GG,2,,,2,,.1D0\n"
    )
    found = read_matrices(path, None, None, 1, [2], None, "z")
    square = np.linalg.eigvals(np.linalg.solve(np.diag([0.2, 0.1]), 1e5 * np.array([[3.0, -1.0], [-1.0, 1.0]])))
    assert 2 * math.pi * found.frequency == pytest.approx(np.sqrt(np.sort(square)), rel=1e-12)
    text = path.read_text()
    for old, new, said in (
        ("K2GG,0,6,1", "K2GG,0,9,1", "no matrix K: square DMIG"),
        ("K2GG,0,6,1", "K2GG,0,7,1", "DMIG K2GG: form 7, type 1: form 1 or 6"),
        ("K2GG,0,6,1", "K2GG,0,6,3", "form 6, type 3"),
        ("DMIG,K2GG,0,6,1\n", "", "DMIG K2GG: the entry with its form is missing"),
        ("DMIG,K2GG,1,3", "DMIG,KB,1,3", "matrices K2GG and KB: one with a name in K is needed"),
        ("3.+5", "3.x5", 'DMIG K2GG: "3.X5" is not a real number'),
        ("m2gg,1,3", "m2gg,a,3", '"A", "3": the numbers of a point and a component'),
        ("K2GG", "P2G", "no matrix K: square DMIG whose names begin with K and M are needed"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(ValueError, match=re.escape(said)):
            read_matrices(path, None, None, 1, [], None, "z")
