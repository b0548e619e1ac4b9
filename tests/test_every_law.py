"""Every registered law works on every target, alone, stepped, in a batch, and in FMUs of both versions: Co-Simulation,
events and Model Exchange. A new law is included automatically."""

import zipfile

import cases
import numpy as np
import pytest
from cases import combinations

import film_model as fm
import fmu_wrapper
from film_model.laws import LAWS
from film_model.laws.example_ball import STEEL_BALL
from film_model.laws.law import FAMILIES
from film_model.studies.law_gallery import gallery_scene

SUMMARY = ("maximum_force", "maximum_indentation", "contact_duration", "rebound_velocity", "coefficient_of_restitution")
TARGETS = {name: cases.TARGETS[name] for name in ("half-space", "plate", "rod")}
EVERY = pytest.mark.parametrize("name", list(LAWS))


def close(got, history, tolerance):
    for key in SUMMARY:
        assert float(got[key]) == pytest.approx(history.summary[key], rel=tolerance), key


def test_the_tests_list_of_laws_has_them_all():
    assert set(LAWS) <= {*cases.LAWS, *(law.name for law in cases.LAWS.values()), *cases.ADHESIVE}


@EVERY
def test_the_class_holds_what_pictures_and_pages_need(name):
    law = LAWS[name]
    assert all((law.name, law.summary, law.source, law.validity, law.__doc__))
    assert law.family in FAMILIES
    assert law.damped == (law.family == "damped")
    assert law.__name__ in fm.__all__ and getattr(fm, law.__name__) is law
    own = law.example(STEEL_BALL)
    assert set(own) <= {*law.parameters, "work_of_adhesion"}
    assert {key for key, parameter in law.parameters.items() if parameter.required} <= set(own)


@EVERY
@pytest.mark.parametrize("target", [*TARGETS, "body"])
def test_alone_and_in_a_batch(name, target):
    scene = gallery_scene(name, cases.TARGETS[target])
    history = fm.simulate(scene, accuracy=1e-7)
    assert history.outcome is fm.Outcome.SEPARATED
    assert 0.0 < history.summary["coefficient_of_restitution"] <= 1.0 + 1e-9
    speed = scene.impactor.velocity
    batch = fm.simulate_batch(scene, velocity=[f"{share * speed!r} m/s" for share in (0.5, 1.0)], accuracy=1e-6)
    assert not batch.failed.any()
    close({key: batch.summary[key][1] for key in SUMMARY}, history, 3e-6)


@EVERY
@pytest.mark.parametrize("target", list(TARGETS))
def test_in_a_component(name, target):
    """Small steps give the events of `simulate`; a force that pushes and pulls gives finite outputs."""
    scene = gallery_scene(name, TARGETS[target])
    history = fm.simulate(scene, accuracy=1e-7)
    component = fm.ImpactComponent(scene, accuracy=1e-7)
    events, largest = [], 0.0
    for _ in range(60):
        result = component.step(history.duration / 47)
        events += result.events
        largest = max(largest, result.outputs.contact_force)
    assert [event.name for event in events] == [event.name for event in history.events]
    for ours, theirs in zip(events, history.events, strict=True):
        assert ours.time == pytest.approx(theirs.time, rel=1e-12, abs=1e-20)
    assert events[-1].impactor_velocity == pytest.approx(history.summary["rebound_velocity"], rel=1e-12)
    assert 0.9 * history.summary["maximum_force"] < largest <= history.summary["maximum_force"] * (1 + 1e-12)
    push = history.summary["maximum_force"]
    pushed = fm.ImpactComponent(scene, initial_gap="1 um", accuracy=1e-4)
    for k in range(100):
        result = pushed.step(history.duration / 20, external_force=push * np.sin(0.7 * k) * (k < 80))
        assert np.isfinite([value for value in result.outputs if isinstance(value, float)]).all()
        assert result.outputs.contact_force >= 0.0 or LAWS[name].family == "adhesive"


@pytest.mark.slow
@combinations(on=["2-half-space", "2-plate", "3-half-space", "3-rod"], name=LAWS)
def test_in_an_fmu(name, on, made):
    """Force, duration and rebound of a whole contact; `fmu_wrapper.check` compares the motion too (test_fmu.py)."""
    version, _, target = on.partition("-")
    scene = gallery_scene(name, TARGETS[target])
    exact, same = fm.simulate(scene, accuracy=1e-9), fm.simulate(scene)
    path = made(scene, int(version))
    close(fmu_wrapper.run(path, step_size=exact.duration / 3), same, 1e-12)
    if version == "3":
        close(fmu_wrapper.run(path, mode="events", step_size=exact.duration), same, 1e-12)
    close(fmu_wrapper.run(path, mode="exchange", step_size=exact.duration / 20), exact, 1e-7)


@pytest.mark.slow
@EVERY
def test_in_the_documentation_of_an_fmu(name, tmp_path):
    with zipfile.ZipFile(fmu_wrapper.export(gallery_scene(name), tmp_path / "impact.fmu")) as archive:
        for picture in ("law.svg", "history.svg"):
            assert len(archive.read(f"documentation/{picture}")) > 5000
