"""Tangential springs of discrete-element programs beside the theory and measurements."""

import math

import numpy as np
import pytest
from test_examples import example

import film_model as fm
from film_model.studies.tangential_models import MODELS, SPRINGS, STEPS, by_spring, theory

CHI = 7 * 0.7 / (2 * 1.7)  # alike bodies with a Poisson's ratio of 0.3


@pytest.fixture(scope="module")
def page():
    return example("oblique_page")


def test_a_linear_spring_is_one_spring_and_one_slider_in_sines():
    found = by_spring(SPRINGS["hooke"], CHI, np.array([0.5, 1.5, 3.0, 4.5]))
    assert found == pytest.approx([0.184567753, -0.339308323, -1.368026457, -1.217540206], abs=2e-6)


@pytest.mark.parametrize(
    ("name", "largest", "at"),
    [
        *(("mindlin", 0.58, 0.7), ("mindlin_rescale", 0.45, 0.9), ("mindlin/force", 0.48, 1.1)),
        *(("mindlin_rescale/force", 0.43, 1.2), ("hooke", 0.18, 1.0), ("rigid", 1.48, 3.6)),
    ],
)
def test_how_far_the_models_are_off(page, name, largest, at):
    """Values of independent implementations of the published formulas."""
    before = np.array([at])
    off = MODELS[name](CHI, before) - theory(page.alike(), before)
    assert abs(off[0]) == pytest.approx(largest, abs=0.011)


@pytest.mark.slow
def test_the_steps_of_the_models_are_small_enough():
    before = np.linspace(0.05, 6.0, 60)
    for spring in SPRINGS.values():
        off = by_spring(spring, CHI, before) - by_spring(spring, CHI, before, 2 * STEPS)
        assert np.abs(off).max() < 1e-3


def test_every_model_slides_throughout_as_the_theory_does(page):
    before = np.array([4.0 * CHI, 7.0])
    for model in MODELS.values():
        assert model(CHI, before) == pytest.approx(before - 4.0 * CHI, abs=1e-5)
    assert theory(page.alike(), before) == pytest.approx(before - 4.0 * CHI, abs=1e-7)


def test_the_theory_depends_on_the_groups_only(page):
    """A scene at another angle, with its own friction, gives the same ψ₂."""
    scene = page.alike().replace({"impactor.angle": "20 deg", "contact.friction": 0.1})
    found = fm.simulate(scene.replace({"contact.law": "hertz", "effects.gravity": False})).oblique.summary
    before = found["impact_number"]
    share = found["contact_point_rebound_velocity"] / (3.0 * math.sin(math.radians(20.0)))
    assert theory(page.alike(), np.array([before]))[0] == pytest.approx(before * share, abs=1e-7)


@pytest.mark.slow
def test_measured_restitution_and_the_models(page):
    """Alumina on glass: nothing is fitted; 8 of 10 within 0.01."""
    scene, of = fm.Scene.from_toml(page.SCENE), page.tables(page.measured())
    off = page.compared_rows(scene, *of["restitution"])[1]
    assert sum(abs(one) <= 0.01 for one in off["film-model"]) == 8
    for name, largest, rms in (
        *(("film-model", 0.036, 0.014), ("Mindlin's spring", 0.252, 0.103), ("rescaled", 0.121, 0.048)),
        *(("Hooke", 0.078, 0.035), ("rigid", 0.115, 0.048)),
    ):
        assert np.abs(off[name]).max() == pytest.approx(largest, abs=1e-3), name
        assert np.sqrt(np.mean(off[name] ** 2)) == pytest.approx(rms, abs=1e-3), name
    for name in ("spin", "angle"):
        squares = {model: np.mean(one**2) for model, one in page.compared_rows(scene, *of[name])[1].items()}
        assert min(squares, key=squares.get) == "film-model"


@pytest.mark.slow
def test_finite_elements(page):
    """Within 0.06 from tan θ/µ = 1.9 on; below, the elements are up to 0.15 lower."""
    points = np.array(page.FINITE_ELEMENTS)
    off = np.abs(1.7 / 1.4 * theory(page.alike(), points[:, 0] * 1.4 / 1.7) - points[:, 1])
    assert off[2:].max() < 0.06 and off.max() < 0.16
