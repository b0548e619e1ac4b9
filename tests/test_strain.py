"""Strain and bending stress at sensors: statics in closed form, differences of displacements, and refusals."""

import math

import numpy as np
import pytest

import film_datasets as fd
import film_model as fm
from film_model.base.errors import SceneError
from film_model.targets.ritz import panel_modes
from film_model.targets.surface_strain import bending_stress

STEEL = fm.Material("steel", "210 GPa", 0.3, "7850 kg/m^3")
QUIET = fm.Effects(gravity=False, boundary_reflections=True, target_inertia=True)
THICK = 0.004


def sensors(*places):
    return [{"name": f"s{k}", "position": place, "strain": True} for k, place in enumerate(places)]


def beam(theory, ends, *places, **options):
    return fm.Beam(STEEL, "100 mm", "10 mm", "4 mm", ends, theory=theory, sensors=sensors(*places), **options)


def static(target, highest):
    """strain_x, strain_y and bending stress under a steady force of 1 N, a column for each sensor."""
    modes = target.modes(highest)
    found = target.strains((modes.strain / modes.frequency**2).sum(axis=1)[:, None])[..., 0]
    return np.stack([*found[:2], bending_stress(*found[2:])])


@pytest.mark.parametrize("theory", ["euler-bernoulli", "timoshenko"])
def test_bending_stress_of_beams(theory):
    """6 |M|/(w h²): M = F (x − L) of a cantilever struck at its end, F x/2 between supports; the strain is negative
    where the face away from the impactor is pressed."""
    unit = 6.0 / (0.010 * THICK**2)
    held = static(beam(theory, "cantilever", "0 mm", "50 mm"), 3e6)
    assert held[2] == pytest.approx([0.1 * unit, 0.05 * unit], rel=2e-3)
    assert held[:2] == pytest.approx(np.outer([-1.0, 0.3], held[2] / 210e9), rel=1e-12)
    between = static(beam(theory, "simply supported", "25 mm", "40 mm"), 3e6)
    assert between[2] == pytest.approx([0.0125 * unit, 0.020 * unit], rel=5e-3)


def test_wide_beam_bends_as_a_plate():
    """Far from both ends, the mean over the width is F x/2: within 1 % in the middle of the width."""
    wide = fm.Beam(STEEL, "200 mm", "24 mm", "4 mm", sensors=sensors("40 mm"))
    assert wide.wide and static(wide, 4e5)[2] == pytest.approx(6.0 * 0.020 / (0.024 * THICK**2), rel=0.01)


def test_simply_supported_plate():
    """Moments by Lévy's single series of a point force (Timoshenko and Woinowsky-Krieger, eq. 149)."""
    places = sensors(["60 mm", "30 mm"])
    target = fm.Plate(STEEL, "4 mm", size=["200 mm", "150 mm"], sensors=places, theory="kirchhoff")
    (a, b), (x, y), struck = (0.2, 0.15), (0.06, 0.03), 0.1
    d, n = target.stiffness[0], np.arange(1.0, 200.0, 2.0)

    def w(x, y):
        """Of a force in the centre, at y < b/2."""
        beta = n * math.pi / a
        edge, middle = beta * b, beta * b / 2.0
        term = 1.0 + edge / np.tanh(edge) - beta * y / np.tanh(beta * y) - middle / np.tanh(middle)
        shape = np.sinh(middle) * np.sinh(beta * y) / (n**3 * np.sinh(edge)) * term
        return a**2 / (math.pi**3 * d) * float(np.sum(shape * np.sin(beta * struck) * np.sin(beta * x)))

    e = 2e-4
    xx = (w(x + e, y) - 2 * w(x, y) + w(x - e, y)) / e**2
    yy = (w(x, y + e) - 2 * w(x, y) + w(x, y - e)) / e**2
    xy = (w(x + e, y + e) - w(x + e, y - e) - w(x - e, y + e) + w(x - e, y - e)) / (4 * e**2)
    sx, sy = -d * (xx + 0.3 * yy) * 6 / THICK**2, -d * (yy + 0.3 * xx) * 6 / THICK**2
    txy = -d * 0.7 * xy * 6 / THICK**2
    found = static(target, 2e7)
    assert found[:2, 0] == pytest.approx([-THICK / 2 * xx, -THICK / 2 * yy], rel=3e-3)
    assert found[2, 0] == pytest.approx(abs(sx + sy) / 2 + math.hypot((sx - sy) / 2, txy), rel=3e-3)
    few = target.modes(3e6)  # 290 vibrations
    ritz = panel_modes(
        target._panel, (0.1, 0.075), 3e6, tuple((x, y, *o) for o in ((2.0, 0.0), (0.0, 2.0), (1.0, 1.0)))
    )
    by_two_ways = [float(np.sum(row / few.frequency**2)) for row in few.strain]
    assert (ritz.factor / ritz.frequency**2).sum(axis=1) == pytest.approx(by_two_ways, rel=1e-5)


def test_clamped_plate():
    """|M| = 0.1257 F in the middle of an edge of a square plate (Timoshenko and Woinowsky-Krieger, table 37)."""
    target = fm.Plate(STEEL, "4 mm", size=["0.2 m", "0.2 m"], edges="clamped", sensors=sensors(["0 mm", "100 mm"]))
    assert static(target, 3e5)[2, 0] == pytest.approx(0.1257 * 6 / THICK**2, rel=3e-3)


@pytest.mark.parametrize("kind", ["simply supported", "two edges free", "free", "timoshenko"])
def test_strain_is_that_of_the_motion(kind):
    """−h/2 times second differences of the displacements of sensors beside it, during an impact."""
    e, h = 4e-4, 2e-3
    if kind == "timoshenko":
        places = ["30 mm", f"{0.03 - e!r} m", f"{0.03 + e!r} m"]
        target = beam("euler-bernoulli", "free", *places)
    else:
        x, y = 0.012, 0.034
        places = [[f"{p!r} m" for p in q] for q in ((x, y), (x - e, y), (x + e, y), (x, y - e), (x, y + e))]
        edges = ["simply supported"] * 2 + ["free"] * 2 if kind == "two edges free" else kind
        more = {"edges": edges, "sensors": sensors(*places), "theory": "kirchhoff"}
        target = fm.Plate(STEEL, "4 mm", size=["60 mm", "50 mm"], **more)
    modes = target.modes(1.2e6)
    t = np.linspace(0.0, 3e-5, 7)[1:]
    moved = np.sin(np.outer(t, modes.frequency)) / np.maximum(modes.frequency, 1.0)
    w, found = modes.factor @ moved.T, target.strains(modes.strain @ moved.T)
    for k in range(len(places) // 2):
        differences = -h * (w[2 * k + 1] - 2.0 * w[0] + w[2 * k + 2]) / e**2
        assert found[k, 0] == pytest.approx(differences, rel=3e-3, abs=3e-3 * np.abs(differences).max())


@pytest.fixture(scope="module")
def struck():
    """A simply supported plate with a gauge and an accelerometer."""
    gauge = {"name": "gauge", "position": ["10 mm", "30 mm"], "strain": True}
    own = [gauge, {"name": "b", "position": ["9 mm", "9 mm"]}]
    target = fm.Plate(STEEL, "4 mm", size=["60 mm", "50 mm"], position=["24 mm", "20 mm"], sensors=own)
    ball = fm.Sphere("5 mm", "1 m/s", material=STEEL)
    return fm.simulate(fm.Scene(ball, target, fm.Contact("hertz"), QUIET), accuracy=3e-3)


@pytest.mark.slow
def test_histories_files_and_sweeps(struck, tmp_path):
    peaks = struck.sensor_peaks
    assert "maximum_strain_x" not in peaks["b"]
    motion = struck.sensed_si(np.linspace(0.0, struck.duration, 4001))
    assert np.isnan(motion.strain_x[1]).all()
    for what in ("strain_x", "strain_y", "bending_stress"):
        largest = np.abs(getattr(motion, what)[0]).max()
        assert peaks["gauge"][f"maximum_{what}"] == pytest.approx(largest, rel=1e-4)
    ds = fd.to_dataset(struck)
    assert fd.validate(ds) == [] and ds["sensor_bending_stress"].attrs["units"] == "Pa"
    fd.write(ds, tmp_path / "a.nc")
    assert fd.history_of(fd.open(tmp_path / "a.nc")).sensor_peaks == peaks
    assert "sensor_gauge_strain_x" in fd.to_frame(ds)
    swept = fd.sweep(struck.scene, {"impactor.velocity": ["0.5 m/s", "1 m/s"]})
    assert fd.validate(swept) == []
    assert float(swept["sensor_gauge_maximum_bending_stress"][1]) == pytest.approx(
        peaks["gauge"]["maximum_bending_stress"], rel=0.01
    )
    assert np.isnan(swept["sensor_b_maximum_strain_x"]).all()
    (tmp_path / "scene.toml").write_text(struck.scene.to_toml())
    assert fm.Scene.from_toml(tmp_path / "scene.toml").target == struck.scene.target


def test_strain_of_a_structure(tmp_path):
    """A column of the modes file, strain over the deflection of the shape, 1/m."""
    path = tmp_path / "modes.csv"
    columns = "frequency [Hz], mass_normalised_shape [1/sqrt(kg)], shape_1, strain_1 [1/m]"
    path.write_text(f"{columns}\n300, 2, 1, 4\n200, 1, 3, 5\n")
    target = fm.Structure(str(path), STEEL, sensors=[{"name": "a", "shape": "shape_1", "strain": "strain_1"}])
    assert target.modes(1e9).strain.tolist() == [[5.0, 8.0]] and target.modes(1e9).factor.tolist() == [[3.0, 2.0]]
    assert target.strains(np.ones((1, 2)))[0].tolist() == [[1.0, 1.0]]


def test_refusals(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("frequency [Hz], modal_mass [kg], shape, shape_1\n200, 1, 3, 5\n")

    def structure(strain):
        return fm.Structure(str(path), STEEL, sensors=[{"name": "a", "shape": "shape_1", "strain": strain}])

    def plate(place, strain):
        own = [{"name": "a", "position": place, "strain": strain}]
        return fm.Plate(STEEL, "4 mm", size=["0.2 m", "0.2 m"], sensors=own)

    for said, make in (
        ("needs the name of a column", lambda: structure(True)),
        ('no column "strain_1"', lambda: structure("strain_1")),
        ("plate or a beam of known thickness", lambda: fm.Rod(STEEL, "10 mm", length="1 m", sensors=sensors("5 mm"))),
        ("moment of plate theory is infinite", lambda: plate(["101 mm", "102 mm"], True)),
        ("strain = true is needed", lambda: plate(["1 mm", "2 mm"], "strain_1")),
    ):
        with pytest.raises(SceneError, match=said):
            make()
