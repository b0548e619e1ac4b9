"""Vibrations from printed results and meshes: a chain of masses and springs in closed form, and every mistake."""

import math
import re
import sys

import numpy as np
import pytest

from film_model.cli.main import main
from film_model.targets.modes_of_programs import Told, check_kind, gives_vibrations, read_vibrations

LINKS, MASS, SPRING = 12, 0.04, 100.0  # masses, t, and springs, N/mm, in a row along x; held at node 1
NODES = np.arange(1, LINKS + 2)


def exact(number):
    """Frequency, Hz, and shape of mass 1, 1/√t, at nodes 1 to 13, of a vibration counted from 1."""
    theta = (2 * number - 1) * math.pi / (2 * LINKS + 1)
    shape = np.sin(theta * (NODES - 1)) * math.sqrt(4 / (MASS * (2 * LINKS + 1)))
    return 2.0 * math.sqrt(SPRING / MASS) * math.sin(theta / 2) / (2 * math.pi), shape


def read(path, node, *sensors, **told):
    assert gives_vibrations(path, check_kind(path))
    return read_vibrations(path, node, "x", sensors, Told("t", **told))


def check(found, nodes, count, accuracy):
    """Against the closed form; the sign of a shape is free."""
    for number in range(1, count + 1):
        frequency, shape = exact(number)
        assert found.frequency[number - 1] == pytest.approx(frequency, rel=accuracy)
        expected = shape[np.array(nodes) - 1] / math.sqrt(1e3)
        signed = found.shape[:, number - 1] * np.sign(found.shape[0, number - 1] * expected[0])
        assert signed == pytest.approx(expected, rel=accuracy, abs=accuracy * 0.1)


# what CalculiX 2.20 prints of the chain: a static step, *FREQUENCY, and *MODAL DYNAMIC, which has no heading
CALCULIX = """
 displacements (vx,vy,vz) for set SOME and time  0.1000000E+01

         1  0.000000E+00  0.000000E+00  0.000000E+00
         7  6.000000E-02  0.000000E+00  0.000000E+00
        13  1.200000E-01  0.000000E+00  0.000000E+00

     E I G E N V A L U E   O U T P U T

 MODE NO    EIGENVALUE                       FREQUENCY   
                                     REAL PART            IMAGINARY PART
                           (RAD/TIME)      (CYCLES/TIME     (RAD/TIME)

      1   0.3942649E+02   0.6279052E+01   0.9993422E+00   0.0000000E+00
      2   0.3511176E+03   0.1873813E+02   0.2982266E+01   0.0000000E+00

     P A R T I C I P A T I O N   F A C T O R S

MODE NO.   X-COMPONENT     Y-COMPONENT     Z-COMPONENT     X-ROTATION      Y-ROTATION      Z-ROTATION

      1  -0.6357818E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00
      2  -0.2096873E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00


                    E I G E N V A L U E    N U M B E R     1


 displacements (vx,vy,vz) for set SOME and time  0.2000000E+01

         1  0.000000E+00  0.000000E+00  0.000000E+00
         7 -1.369094E+00  0.000000E+00  0.000000E+00
        13 -1.996053E+00  0.000000E+00  0.000000E+00

 forces (fx,fy,fz) for set SOME and time  0.2000000E+01

         1  0.000000E+00  0.000000E+00  0.000000E+00
         7  0.000000E+00  0.000000E+00  0.000000E+00
        13  0.000000E+00  0.000000E+00  0.000000E+00

                    E I G E N V A L U E    N U M B E R     2


 displacements (vx,vy,vz) for set SOME and time  0.2000000E+01

         1  0.000000E+00  0.000000E+00  0.000000E+00
         7 -1.541026E+00  0.000000E+00  0.000000E+00
        13  1.964575E+00  0.000000E+00  0.000000E+00
"""  # noqa: W291
DYNAMIC = """
 displacements (vx,vy,vz) for set SOME and time  0.1100000E+01

         1  0.000000E+00  0.000000E+00  0.000000E+00
         7  4.051147E-03  0.000000E+00  0.000000E+00
        13  6.709490E-02  0.000000E+00  0.000000E+00
"""


def number(value):
    """As Abaqus prints it: five digits, with an exponent unless from 0.1 to 10⁴."""
    if value == 0.0 or 0.1 <= abs(value) < 1e4:
        return f"{value:.5g}".ljust(11)
    return f"{value:.4E}".ljust(11)


def abaqus(count=3, scale=1.0, step="FREQUENCIES", reported=(1, 7, 13), ended=True):
    """Printed results of Abaqus, shapes of largest displacement `scale`: nodes that rest are left out; the last mode is
    one in which node 7 does not move."""
    lines = ["1", "", "   Abaqus 2021.HF4            Date 17-Oct-2022   Time 17:26:01", ""]
    lines += ["                        S T E P       1     C A L C U L A T I O N   O F   E I G E N V A L U E S", ""]
    lines += ["                              E I G E N V A L U E    O U T P U T     ", ""]
    lines += [" MODE NO      EIGENVALUE              FREQUENCY         GENERALIZED MASS   COMPOSITE MODAL DAMPING"]
    lines += ["                             (RAD/TIME)   (CYCLES/TIME)", "", ""]
    shapes = []
    for k in range(1, count + 1):
        frequency, shape = exact(k)
        shapes.append(shape / np.abs(shape).max() * scale)
        mass, omega = MASS * float(shapes[-1] @ shapes[-1]), 2 * math.pi * frequency
        row = "   ".join(map(number, (omega**2, omega, frequency, mass, 0.01 * k)))
        lines.append(f"{k:8d}      {row}")
    lines += ["", "                   P A R T I C I P A T I O N   F A C T O R S", ""]
    lines += [" MODE NO    X-COMPONENT    Y-COMPONENT", "", "       1      3.8767E-27     120.00", ""]
    lines += ["                   M E M O R Y   E S T I M A T E", "", "     1          1.98E+07               18", ""]
    for k, shape in enumerate(shapes, 1):
        lines += [f"                    E I G E N V A L U E    N U M B E R {k:5d}", "", ""]
        lines += ["                                       N O D E   O U T P U T", "", ""]
        for nodes, columns in (((1, 7), ("U1", "U2", "UR3")), ((13,), ("U1", "U2", "UR3")), ((1,), ("RF1", "RF2"))):
            lines += ["   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET SOME", ""]
            lines += ["       NODE FOOT-   " + "".join(name.ljust(12) for name in columns), "            NOTE", ""]
            for node in nodes:
                moved = [shape[node - 1], 0.0, 0.25] if columns[0] == "U1" else [50.0, 0.0]
                if node in reported and (node > 1 or columns[0] == "RF1"):
                    note = "OR" if node == 13 else "  "
                    lines.append(f"{node:11d}  {note} " + " ".join(map(number, moved)))
            lines += [
                "",
                " MAXIMUM          1.000       0.000       0.000    ",
                " AT NODE                13           0",
                "",
            ]
    end = ["          THE ANALYSIS HAS BEEN COMPLETED", "", "     JOB TIME SUMMARY"] if ended else []
    return "\n".join([*lines, *end, ""])


@pytest.mark.parametrize("text", [CALCULIX, CALCULIX + DYNAMIC, CALCULIX + DYNAMIC.replace("0.11", "0.20")])
def test_printed_by_calculix(text, tmp_path):
    """Of a chain that CalculiX computed; what static and later steps print is left out."""
    (tmp_path / "chain.dat").write_text(text)
    found = read(tmp_path / "chain.dat", 13, 7)
    check(found, (13, 7), 2, 1e-6)
    assert found.damping_ratio is None


@pytest.mark.parametrize("scale", [1.0, 250.0])
def test_printed_by_abaqus(scale, tmp_path):
    """Shapes normalised by displacement, with their modal masses; 5 digits are printed."""
    (tmp_path / "chain.dat").write_text(abaqus(scale=scale))
    found = read(tmp_path / "chain.dat", 13, 7)
    check(found, (13, 7), 3, 1e-4)
    assert found.damping_ratio == pytest.approx([0.01, 0.02, 0.03])


def test_node_that_rests_in_some_vibrations(tmp_path):
    """Node 7 is not printed for the second vibration: it rests there. The third is not printed at all."""
    first, second, *_ = re.split(r"(?=                    E I G E N V A L U E    N U M B E R)", abaqus())[1:]
    head = abaqus().split("                    E I G E N V A L U E    N U M B E R")[0]
    second = re.sub(r"\n +7 .*", "", second)
    path = tmp_path / "chain.dat"
    path.write_text(head + first + second + "          THE ANALYSIS HAS BEEN COMPLETED\n")
    found = read(path, 13, 7)
    assert found.frequency.size == 2 and found.shape[1, 1] == 0.0 and found.shape[1, 0] != 0.0


RIGID = abaqus().replace("       1      39.426", "       1 *    39.426")


def test_rigid_motions_are_marked(tmp_path):
    assert " * " in RIGID
    (tmp_path / "chain.dat").write_text(RIGID)
    check(read(tmp_path / "chain.dat", 13), (13,), 3, 1e-4)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "has no real vibrations: a modal analysis"),
        ("  B U C K L I N G   F A C T O R   O U T P U T\n\n      1   0.4E+03\n", "has no real vibrations"),
        (CALCULIX.replace(" MODE NO  ", "  NODAL   MODE NO  "), "has no real vibrations"),
        (CALCULIX.replace("(vx,vy,vz)", "(other)"), "has the frequencies of 2 vibrations, but no displacements: print"),
        (abaqus().replace("U1 ", "A1 ").replace("U2 ", "A2 "), "has the frequencies of 3 vibrations, but no displ"),
        (CALCULIX[:-5], "chain.dat is cut, or its analysis did not end"),
        (CALCULIX[: CALCULIX.rindex("        13")], "chain.dat is cut, or its analysis did not end"),
        (CALCULIX[: CALCULIX.index("N U M B E R     2")], "chain.dat is cut, or its analysis did not end"),
        (abaqus(ended=False), "chain.dat is cut, or its analysis did not end"),
        (CALCULIX + CALCULIX, "vibration 1 is there twice: print those of one *FREQUENCY step"),
        (
            CALCULIX.replace("13 -1.996053E+00", "13 *************"),
            '"13 *************  0.000000E+00  0.000000E+00" is not',
        ),
        (CALCULIX.replace("13 -1.996053E+00", "13 "), "is not a row of 3 numbers"),
        (CALCULIX.replace("0.3942649E+02", "0.39x2649E+02"), "is not a row of 4 numbers"),
        (
            CALCULIX.replace("        13 ", "        14 "),
            "vibration 1 has no node 13; the nearest numbers are 7 and 14",
        ),
        (CALCULIX.replace("0.3942649E+02", "-.3942649E+04"), "an eigenvalue is -3942.65: the structure is unstable"),
    ],
)
def test_wrong_printed_results(text, said, tmp_path):
    path = tmp_path / "chain.dat"
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(said)):
        read(path, 13)


def vectors(number, columns=3):
    """The shape of a vibration at the points of a mesh."""
    moved = np.zeros((LINKS + 1, columns))
    moved[:, 0] = exact(number)[1]
    return moved


@pytest.fixture(scope="module")
def meshio():
    return pytest.importorskip("meshio", reason='needs pip install "film-model[modes]"')


@pytest.fixture
def mesh(meshio):
    """Makes a mesh of the chain with arrays at its points."""
    points = np.zeros((LINKS + 1, 3))
    points[:, 0] = np.arange(LINKS + 1)
    cells = [("line", np.column_stack([NODES[:-1] - 1, NODES[1:] - 1]))]
    return lambda **data: meshio.Mesh(points, cells, point_data=data)


FREQUENCIES = [exact(k)[0] for k in (1, 2, 3)]


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".xdmf", ".med"])
@pytest.mark.parametrize(("name", "first"), [("mode_{}", 1), ("u{:03d}", 0), ("displacement_EigenMode{}", 1)])
def test_meshes(name, first, suffix, mesh, tmp_path, capsys):
    """An array for each vibration, in any order; tensors and integers beside; without frequencies."""
    order = (2, 0, 1)
    data = {name.format(k + first): vectors(k + 1) for k in order}
    path = tmp_path / f"chain{suffix}"
    mesh(**data, stress=np.ones((LINKS + 1, 6)), ids=NODES).write(path)
    found = read(path, 13, 7, frequencies=FREQUENCIES, modal_masses=[1.0])
    check(found, (13, 7), 3, 1e-10)
    assert list(found.place) == [12.0, 0.0, 0.0]
    output = tmp_path / "modes.csv"
    (tmp_path / "f.txt").write_text("\n".join(map(str, FREQUENCIES)))
    told = ["--frequencies", str(tmp_path / "f.txt"), "--modal-masses", "1,1,1", "--output", str(output)]
    assert main(["modes", "read", str(path), "--node", "13", "--direction", "x", *told]) == 0
    assert "3 vibrations from 0.999342 to 4.91816 Hz\nnode 13 at 12, 0, 0\n" in capsys.readouterr().out


def test_modal_masses(mesh, tmp_path):
    """Shapes of largest displacement 1 need theirs; a mass of 1 is then refused."""
    path, scaled = tmp_path / "chain.vtu", [vectors(k) / np.abs(vectors(k)).max() for k in (1, 2, 3)]
    mesh(**{f"mode_{k}": shape for k, shape in enumerate(scaled, 1)}).write(path)
    masses = [MASS * float(np.sum(shape**2)) for shape in scaled]
    check(read(path, 13, frequencies=FREQUENCIES, modal_masses=masses), (13,), 3, 1e-10)
    with pytest.raises(ValueError, match="the largest displacement of every vibration is 1: its modal mass is needed"):
        read(path, 13, frequencies=FREQUENCIES, modal_masses=[1.0])


def series(folder, mesh, times):
    """As ccx2paraview writes them: a mesh for each vibration, and a .pvd file with their frequencies."""
    entries = ""
    for k, time in enumerate(times, 1):
        mesh(U=vectors(k), S=np.ones((LINKS + 1, 6))).write(folder / f"chain.{k}.vtu")
        entries += f'<DataSet file="chain.{k}.vtu" timestep="{time!r}"/>\n'
    text = f'<?xml version="1.0"?><VTKFile type="Collection"><Collection>{entries}</Collection></VTKFile>'
    (folder / "chain.pvd").write_text(text)
    return folder / "chain.pvd"


def test_series_of_meshes(mesh, tmp_path):
    """Times are the frequencies, unless they only count."""
    path = series(tmp_path, mesh, FREQUENCIES)
    check(read(path, 13, 7, modal_masses=[1.0], array="U"), (13, 7), 3, 1e-10)
    with pytest.raises(ValueError, match=re.escape('several vectors at its points: give --array, one of "U", "S"')):
        read(path, 13, modal_masses=[1.0])
    for times in ([0, 1, 2], [1.0, 2.0, 3.0]):
        path = series(tmp_path, mesh, times)
        with pytest.raises(ValueError, match="has no frequencies: give --frequencies, 3 in the order of the shapes"):
            read(path, 13, modal_masses=[1.0], array="U")
    (tmp_path / "chain.2.vtu").unlink()
    with pytest.raises(OSError, match=r"chain\.2\.vtu"):
        read(path, 13, modal_masses=[1.0], array="U")


def test_series_in_xdmf(meshio, mesh, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the writer's arrays go there
    path = tmp_path / "chain.xdmf"
    with meshio.xdmf.TimeSeriesWriter(str(path)) as writer:
        writer.write_points_cells(mesh().points, mesh().cells)
        for k, frequency in enumerate(FREQUENCIES, 1):
            writer.write_data(frequency, point_data={"u": vectors(k)})
    check(read(path, 13, 7, modal_masses=[1.0]), (13, 7), 3, 1e-10)


def test_steps_in_med(meshio, mesh, tmp_path):
    """As code_aster writes them: one field, its steps with the frequency as time; six components."""
    import h5py

    path = tmp_path / "chain.rmed"
    mesh(modes___DEPL=vectors(1, 6)).write(path, file_format="med")
    with h5py.File(path, "r+") as file:
        field = file["CHA/modes___DEPL"]
        (first,) = field
        for k, frequency in enumerate(FREQUENCIES, 1):
            step = field.create_group(f"{k + 1:020d}{k + 1:020d}")
            for name, value in field[first].attrs.items():
                step.attrs[name] = value
            step.attrs["PDT"] = frequency
            field.copy(field[first]["NOE"], step)
            (profile,) = step["NOE"]
            step["NOE"][profile]["CO"][...] = vectors(k, 6).ravel(order="F")
        del field[first]
    check(read(path, 13, 7, modal_masses=[1.0]), (13, 7), 3, 1e-5)  # meshio rounds the times to 6 digits


def test_wrong_meshes(mesh, tmp_path, capsys):
    good = tmp_path / "good.vtu"
    mesh(mode_1=vectors(1), mode_2=vectors(2)).write(good)
    (tmp_path / "cut.vtu").write_bytes(good.read_bytes()[:900])
    (tmp_path / "text.med").write_text("no MED")
    (tmp_path / "text.pvd").write_text("<no")
    (tmp_path / "other.pvd").write_text('<V><DataSet timestep="1" file="one.pvtu"/></V>')
    parts = "".join(f'<DataSet timestep="9" part="{part}" file="good.vtu"/>' for part in (0, 1))
    (tmp_path / "parts.pvd").write_text(f"<V>{parts}</V>")
    mesh(ids=NODES).write(tmp_path / "none.vtu")
    two = ["--frequencies", "1,2", "--modal-masses", "1"]
    for name, arguments, said in (
        ("good.vtu", [], "good.vtu has no frequencies: give --frequencies, 2 in the order of the shapes"),
        ("good.vtu", two[:2], "good.vtu does not say how its shapes are normalised: give --modal-masses, 1 if by mass"),
        ("good.vtu", ["--frequencies", "1,2,3"], "--frequencies: 3 values for 2 vibrations in"),
        ("good.vtu", ["--frequencies", "1"], "--frequencies: 1 values for 2 vibrations in"),
        ("good.vtu", [*two[:2], "--modal-masses", "1,2,3"], "--modal-masses: 3 values for 2 vibrations in"),
        ("good.vtu", [*two[:2], "--modal-masses", "0,1"], "a modal mass is 0, more than 0 is needed"),
        (
            "good.vtu",
            ["--frequencies", "1,b"],
            '--frequencies: "1,b" is not a list of numbers such as 708,2453, or a file',
        ),
        ("good.vtu", [*two, "--array", "DEPL"], 'has no vectors "DEPL" at its points; it has "mode_"'),
        ("good.vtu", [*two, "--sensors", "14"], "vibration 1 has no node 14; the nearest numbers are 12 and 13"),
        ("none.vtu", two, "none.vtu has no vectors at its points; it has none"),
        ("cut.vtu", two, "cut.vtu cannot be read as a mesh: it is damaged, or of another format"),
        ("text.med", two, "text.med cannot be read as a mesh: "),
        ("text.pvd", two, "text.pvd cannot be read as a mesh: "),
        ("other.pvd", two, "other.pvd cannot be read as a mesh: files .pvtu in it are not read"),
        ("parts.pvd", two, "parts.pvd cannot be read as a mesh: it lists meshes in parts, whole ones are needed"),
        ("gone.vtk", two, "gone.vtk: No such file or directory"),
        ("good.exo", two, "good.exo: files of Exodus are not read: a universal file"),
    ):
        given = ["--node", "13", "--direction", "x", "--output", str(tmp_path / "out.csv"), *arguments]
        assert main(["modes", "read", str(tmp_path / name), *given]) == 3, name
        error = capsys.readouterr().err
        assert said in error and error.count("\n") == 1 and not (tmp_path / "out.csv").exists(), error


def test_options_of_other_files(tmp_path, capsys):
    (tmp_path / "chain.dat").write_text(CALCULIX)
    np.savez(tmp_path / "chain.npz", K=np.eye(2), M=np.eye(2))
    for name, option, said in (
        ("chain.dat", "--mass", "--mass: {} has vibrations: not allowed"),
        ("chain.npz", "--frequencies", "--frequencies: {} has matrices: not allowed"),
        ("chain.npz", "--modal-masses", "--modal-masses: {} has matrices: not allowed"),
    ):
        given = ["--node", "1", "--direction", "x", "--output", str(tmp_path / "out.csv"), option, "1"]
        assert main(["modes", "read", str(tmp_path / name), *given]) == 3
        assert said.format(tmp_path / name) in capsys.readouterr().err


def test_without_meshio(monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(sys.modules, "meshio", None)
    (tmp_path / "chain.vtu").write_text("anything")
    given = ["--node", "1", "--direction", "x", "--output", str(tmp_path / "out.csv")]
    assert main(["modes", "read", str(tmp_path / "chain.vtu"), *given]) == 3
    assert "chain.vtu: mesh files need meshio: install film-model[modes]" in capsys.readouterr().err
