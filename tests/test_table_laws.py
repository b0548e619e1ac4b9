"""Laws given by tables of indentation and force."""

import math

import numpy as np
import pytest
from cases import EFFECTIVE_MODULUS, RADIUS, SPHERE
from law_cases import scene_of, scene_text

import film_model as fm
from film_model.problem.curve import curve_of


def test_a_table_of_hertz_is_hertz():
    stiffness = 4 / 3 * EFFECTIVE_MODULUS * math.sqrt(RADIUS)
    indentation = 2e-5 * np.linspace(0, 1, 50) ** 1.5
    law = fm.Tabulated(indentation, stiffness * indentation**1.5)
    got, exact = (fm.simulate(scene_of(x, 0.25)).summary for x in (fm.Retrace(law), fm.Hertz(*SPHERE)))
    for name in ("maximum_force", "maximum_indentation", "contact_duration"):
        assert got[name] == pytest.approx(exact[name], rel=1e-5)


def test_the_curve_goes_through_the_points_of_a_table():
    law = fm.Tabulated([0, 1e-6, 3e-6, 4e-6], [0.0, 10.0, 10.0, 40.0])
    curve = curve_of(law)
    for indentation, force in zip(law.indentation, law.force, strict=True):
        assert 40.0 * curve.force(indentation / 4e-6) == pytest.approx(force, abs=1e-12)
    between = np.array([curve.force(x) for x in np.linspace(0.25, 0.75, 50)])
    assert between == pytest.approx(np.full(50, 0.25), abs=1e-14)  # no force outside the range of the points


@pytest.mark.parametrize("velocity", [1e-6, 1e-3, 0.1])
def test_an_impact_on_a_small_part_of_a_table_stays_accurate(velocity):
    """A straight table is a spring; near zero force its pieces are shorter, so rounding is relative to small forces."""
    indentation = np.linspace(0, 1e-4, 11)
    case = scene_of(fm.Retrace(fm.Tabulated(indentation, 1e7 * indentation)), velocity)
    found = fm.simulate(case, segments=16).summary
    period = math.sqrt(case.mass / 1e7)
    assert found["contact_duration"] == pytest.approx(math.pi * period, rel=1e-12)
    assert found["maximum_indentation"] == pytest.approx(velocity * period, rel=1e-12)
    assert found["maximum_force"] == pytest.approx(1e7 * velocity * period, rel=1e-12)
    assert found["coefficient_of_restitution"] == pytest.approx(1.0, rel=1e-12)


def test_a_long_table_is_thinned_with_a_warning():
    indentation = np.linspace(0, 4e-5, 3000)
    noise = np.cumsum(np.abs(np.random.default_rng(1).normal(size=3000))) * 1e-3
    law = fm.Tabulated(indentation, 1e10 * indentation**1.5 + noise)
    smooth = fm.Retrace(fm.Tabulated(indentation, 1e10 * indentation**1.5))
    assert len(law.stages()[0].knots) == 58
    assert "60 of the table's 3000 points" in law.remarks()[0]
    history = fm.simulate(scene_of(fm.Retrace(law), 0.25))
    assert history.warnings == law.remarks()
    loading, exact = (fm.simulate(scene_of(x, 0.25)).summary for x in (smooth, fm.Meyer(1e10, 1.5)))
    assert loading["contact_duration"] == pytest.approx(exact["contact_duration"], rel=1e-4)


def test_a_table_reads_from_a_file_beside_the_scene(tmp_path):
    rows = "# a press\ntime (s);Force [kN];Indentation (um)\n0;0;0\n1;0.4;10\n\n2;2.5;40\n"
    (tmp_path / "curve.csv").write_text(rows, encoding="utf-8")
    path = tmp_path / "scene.toml"
    path.write_text(scene_text("tabulated", contact='file = "curve.csv"'), encoding="utf-8")
    case = fm.Scene.from_toml(path)
    assert case == fm.Scene.from_text(scene_text("tabulated"))
    assert fm.Scene.from_text(case.to_toml()) == case
