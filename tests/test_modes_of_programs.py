"""Vibrations from universal files and matrices: against closed forms, and one sentence for every mistake."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import coo_array

import film_model as fm
from film_model.cli.main import main
from film_model.targets.modes_of_programs import Told, check_kind, gives_vibrations, read_matrices, read_vibrations
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
    assert main(read) == 3 and "vibration 2 has no node 4; the nearest numbers are 3 and 7" in capsys.readouterr().err
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
        ("plate.f06", "", "plate.f06: files of results of Nastran are not read: a universal file (.unv"),
        ("plate.F06", "", "files of results of Nastran are not read"),
        ("plate.full", "", "files of results of Ansys are not read"),
        ("plate.hdf", "", 'files with the suffix ".hdf" are not read'),
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


NODES, OMEGA, MASSES = (7, 3, 12), (500.0, 200.0, 0.0), (4.0, 1.0, 2.0)
TITLES = (*[0] * 40, *[0x20202020] * 96)  # of a record: title, subtitle and label, blank
MOVED = np.arange(1.0, 28.0).reshape(3, 3, 3)  # vibration, node, x y z


def binary(order="<", word=4, headed=True, masses=MASSES, code=7):
    """A results file of Nastran: markers, the tables of masses and of shapes, and one that is not read."""

    def record(data):
        return np.array([len(data)], f"{order}i4").tobytes() + data + np.array([len(data)], f"{order}i4").tobytes()

    def words(*numbers):
        kinds = (f"{order}f{word}" if isinstance(number, float) else f"{order}i{word}" for number in numbers)
        return b"".join(np.array([n], kind).tobytes() for n, kind in zip(numbers, kinds, strict=True))

    def text(name):
        parts = [name[k : k + 4].ljust(4) for k in range(0, 8, 4)]
        return "".join(part.ljust(word) for part in parts).encode()

    def marker(number):
        return record(words(number))

    def block(data):
        return marker(len(data) // word) + record(data)

    def table(name, *records):
        whole = block(text(name)) + marker(-1) + block(words(*range(7)))
        for number, data in enumerate((text(name), *records), 2):
            half = len(data) // (2 * word) * word
            parts = [data[:half], data[half:]] if half else [data]
            whole += marker(-number) + marker(1) + marker(0) + b"".join(map(block, parts))
        return whole + marker(-len(records) - 3) + marker(1) + marker(0) + marker(0)

    head = block(words(11, 28, 26)) + block(b"NASTRAN FORT TAPE ID CODE - ".ljust(7 * word)) + block(text("XXXXXXXX"))
    head += marker(-1) + marker(0)
    shapes, lama = [], b""
    for k, omega in enumerate(OMEGA):
        codes = [21, code, 0, 1, k + 1, omega**2, omega, 0, 1, 8]
        rows = [(10 * n + 1, 1, *xyz, 0.0, 0.0, 0.0) for n, xyz in zip(NODES, MOVED[k].tolist(), strict=True)]
        shapes += [words(*codes, *TITLES), words(*(number for row in rows for number in row))]
        if masses:
            lama += words(k + 1, k + 1, omega**2, omega, omega / (2 * math.pi), masses[k], masses[k] * omega**2)
    tables = table("GEOM1", words(1, 2, 3, 4)) + table("OUGV1", *shapes)
    tables += table("LAMA", words(21, 6, *[0] * 7, 7, *TITLES), lama) if masses else b""
    return (head if headed else b"") + tables + marker(0)


def punched(omegas=OMEGA, size=1.0):
    """A punch file of Nastran with matrices' names beside."""
    text = ""
    for k, omega in enumerate(omegas):
        for line in (
            "$TITLE   = PLATE", "$SUBTITLE=", "$LABEL   =", "$EIGENVECTOR", "$REAL OUTPUT", "$SUBCASE ID =           1",
            f"$EIGENVALUE ={omega**2:15.7E}  MODE ={k + 1:6d}",
            *(f"{node:10d}       G" + "".join(f"{x:18.6E}" for x in xyz)
              for node, xyz in zip(NODES, size * MOVED[k], strict=True)), f"-CONT-            {0.0:18.6E}",
        ):  # fmt: skip
            text += f"{line:72}{1:8d}\n"
    return text + "$TITLE\n$DISPLACEMENTS\n" + "         7       G      1.0  no shape\n"


def read(path, node, direction, *sensors, **told):
    kind = check_kind(path)
    assert gives_vibrations(path, kind)
    return read_vibrations(path, node, direction, sensors, Told("t", **told))


@pytest.mark.parametrize(
    "content", [binary(), binary(">"), binary("<", 8), binary(headed=False), binary(masses=()), punched()]
)
def test_vibrations_of_nastran(content, tmp_path):
    """By ascending frequency, of mass 1 kg; without a table of masses the shapes are those of mass 1 t."""
    path = tmp_path / ("plate.pch" if isinstance(content, str) else "plate.OP2")
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    found = read(path, 3, "z", 12, 7)
    masses = np.array(MASSES) if not isinstance(content, str) and b"LAMA" in content else np.ones(3)
    assert 2 * math.pi * found.frequency == pytest.approx(sorted(OMEGA), rel=1e-6)
    shapes = MOVED[::-1, [1, 2, 0], 2] / np.sqrt(1e3 * masses[::-1, None])
    assert pytest.approx(shapes, rel=1e-6) == found.shape.T
    assert found.damping_ratio is None and found.sensors == (12, 7)


@pytest.mark.parametrize(
    ("suffix", "content", "said"),
    [
        (".op2", binary(code=1), "has no real vibrations: a modal analysis"),
        (".op2", binary()[:-400], "is damaged, or not a results file of Nastran"),
        (".op2", b"", "is empty"),
        (".op2", b"\x04\x00", "is not a results file of Nastran"),
        (".op2", b"\x00" * 50, "is not a results file of Nastran"),
        (".op2", binary().replace(b"OUGV", b"OUXX"), "has no real vibrations"),
        (".pch", punched((1.0, 2.0)) + punched((1.0, 2.0)), "vibration 1 is there twice"),
        (
            ".pch",
            punched((1.0, 2.0)).replace("12       G", "13       G"),
            "vibration 1 has no node 12; the nearest numbers are 7 and 13",
        ),
        (".pch", punched((1.0, 2.0)).replace("12       G  ", "12       G X"), "is not the displacement of a node"),
        (".pch", punched((1.0,), 1.0 / 9.0), "largest displacement of every vibration is 1: its modal mass is needed"),
        (".pch", punched((1.0, 2.0)).replace("=  4.0", "= -4.0"), "an eigenvalue is -4: the structure is unstable"),
    ],
)
def test_wrong_vibrations_of_nastran(suffix, content, said, tmp_path):
    path = tmp_path / f"wrong{suffix}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(ValueError, match=re.escape(said)):
        read(path, 3, "z", 12)


def test_damaged_results_of_nastran(tmp_path):
    """A byte changed at every 11th place: read, or refused in a sentence that has the name of the file."""
    path, whole, said = tmp_path / "flipped.op2", binary(), []
    for at in range(0, len(whole), 11):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x41]) + whole[at + 1 :])
        try:
            read(path, 3, "z", 12)
        except ValueError as error:
            said.append(str(error))
    assert len(said) > 50 and all("flipped.op2" in one for one in said)


def test_results_of_ansys(tmp_path):
    """A cantilever: a pair of equal bending frequencies, whose shapes move a node beside its axis at right angles."""
    examples = pytest.importorskip("ansys.mapdl.reader.examples", reason='needs pip install "film-model[ansys]"')
    path = Path(examples.rstfile)
    along = [read(path, 321, direction) for direction in "xy"]
    assert along[0].frequency == pytest.approx([7366.495, 7366.495, 11504.895, 17285.705, 17285.705, 20137.193])
    first, second = (np.array([one.shape[0, k] for one in along]) for k in (0, 1))
    assert abs(first @ second) < 0.01 * (first @ first) and first @ first == pytest.approx(second @ second, rel=0.01)
    (tmp_path / "wrong.rst").write_bytes(b"x" * 1000)
    with pytest.raises(ValueError, match=r"wrong.rst cannot be read as results of Ansys"):
        read(tmp_path / "wrong.rst", 1, "x")
