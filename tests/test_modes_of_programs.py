"""Vibrations from universal files and matrices: against closed forms, and one sentence for every mistake."""

import math

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
    for name, arguments, said in (
        ("m.npz", [], "no matrix K: arrays K and M are needed"),
        ("good.npz", ["--sensors", "4"], "has 3 rows: row 4 is not one of them"),
        ("good.npz", ["--sensors", "1,1"], "names a number twice"),
        ("good.unv", [], "--direction: missing"),
    ):
        given = [str(tmp_path / name), "--node", "1", "--output", str(tmp_path / "out.csv"), *arguments]
        assert main(["modes", "read", *given]) == 3 and said in capsys.readouterr().err
