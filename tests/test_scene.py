"""Scenes: derived values, and a file format that round-trips to the last bit."""

from __future__ import annotations

import copy
import dataclasses
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from film_model.base.errors import SceneError
from film_model.base.materials import material
from film_model.base.units import DIMENSIONS
from film_model.laws import LAWS, Hertz
from film_model.scene import Contact, Effects, Scene, Solver, Sphere
from film_model.scene.columns import scene_of_columns
from film_model.targets import Body, HalfSpace, Plate, Rod

SCENES = sorted((Path(__file__).parent.parent / "examples" / "scenes").glob("*.toml"))
QUANTITY = pint.get_application_registry().Quantity

STEEL = SCENES[0].with_name("tungsten_carbide_on_steel.toml")


def test_derived_values() -> None:
    scene = Scene.from_toml(STEEL)
    assert scene.title == "Tungsten-carbide ball on a mild-steel slab"
    assert scene.mass == scene.effective_mass == 0.06074
    assert scene.effective_radius == 0.01
    assert scene.effective_modulus == pytest.approx(1 / ((1 - 0.28**2) / 600e9 + (1 - 0.3**2) / 210e9), rel=1e-15)
    assert scene.yield_strength == 1e9
    assert scene.approach_velocity == 0.25
    assert scene.target_impedance == math.inf
    assert scene.kinetic_energy == pytest.approx(0.5 * 0.06074 * 0.0625, rel=1e-15)
    assert scene.solver == Solver(accuracy=1e-4)


def test_two_free_bodies() -> None:
    ball = Sphere("10 mm", "0.5 m/s", material="bearing steel")
    scene = Scene(ball, Body("bearing steel", "20 mm", velocity="0.1 m/s"))
    assert scene.mass == pytest.approx(7810 * 4 / 3 * math.pi * 1e-6, rel=1e-15)
    assert scene.effective_mass == pytest.approx(scene.mass * 8 / 9, rel=1e-15)
    assert scene.effective_radius == pytest.approx(0.02 / 3, rel=1e-15)
    assert scene.approach_velocity == pytest.approx(0.4, rel=1e-15)
    assert scene.target_impedance == math.inf


def test_other_targets() -> None:
    ball = Sphere(QUANTITY(5, "mm"), drop_height="50 mm", material="bearing steel")
    assert ball.speed == pytest.approx(math.sqrt(2 * 9.80665 * 0.05), rel=1e-15)
    rod = Scene(ball, Rod("mild steel", diameter="20 mm"))
    assert rod.target_impedance == pytest.approx(math.sqrt(210e9 * 7850) * math.pi * 1e-4, rel=1e-14)
    assert rod.target_impedance == Scene(ball, Rod("mild steel", area=f"{math.pi * 1e-4!r} m^2")).target_impedance
    plate = Plate("mild steel", "5 mm")
    assert plate.surface_density == 39.25
    assert plate.impedance == pytest.approx(8 * math.sqrt(39.25 * plate.stiffness[0]), rel=1e-15)
    exact = Scene.from_toml(SCENES[0])
    assert "olsson" in SCENES[0].name
    assert exact.target_impedance == pytest.approx(156.47, abs=0.005)
    assert exact.replace({"target.impedance_formula": "paper"}).target_impedance == pytest.approx(136.87, abs=0.005)
    assert exact.effective_modulus == 9.72e9
    assert exact.yield_strength is None


def test_contact_overrides_the_materials() -> None:
    scene = Scene.from_toml(STEEL).replace({"contact.effective_modulus": "1 GPa", "contact.yield_strength": "2 GPa"})
    assert (scene.effective_modulus, scene.yield_strength) == (1e9, 2e9)


def test_the_lower_yield_strength_is_used() -> None:
    soft = material("mild steel").initial_strength
    assert material("mild steel").flow_strength == pytest.approx(120 / 0.95 * 9.80665e6 / 0.927 / 2.8)  # of 120 HB
    assert Scene(Sphere("1 mm", "1 m/s", material="bearing steel"), HalfSpace("mild steel")).yield_strength == soft
    assert Scene(Sphere("1 mm", "1 m/s", material="mild steel"), HalfSpace("alumina")).yield_strength == soft


def _variants() -> dict[str, Scene]:
    ball = Sphere("3.3333333333333335e-3 m", "0.1 m/s", mass="1 g", material="bearing steel")
    meyer = Contact("meyer", stiffness="3e5 N/mm^1.3", exponent=1.3, initial_force="1 N", effective_modulus="7 psi")
    return {
        **{path.stem: Scene.from_toml(path) for path in SCENES},
        "meyer": Scene(
            ball, HalfSpace("PMMA", radius="20 mm"), meyer, Effects(True, False, "auto"), Solver(segments=5)
        ),
        "bare": Scene(
            Sphere("1 mm", "0 m/s", mass="1 g"), HalfSpace(), Contact("meyer", stiffness="1 N/m", exponent=1)
        ),
        "plate": Scene(ball, Plate("nylon 6/6", "1 mm", size=["1 m", "2 m"], impedance_formula="paper", radius="1 m")),
        "title": Scene(ball, Body("PMMA", "1 in"), title='"\\\n\t\x00\x7fµ ]\n[impactor]'),
        "solver": Scene(ball, Rod("PMMA", area="1 mm^2"), solver=Solver(1e-14, linearisation="chord")),
    }


@pytest.mark.parametrize("name", _variants())
def test_round_trip(name: str) -> None:
    scene = _variants()[name]
    assert Scene.from_text(scene.to_toml()) == scene
    assert Scene.from_table(scene.to_table()) == scene
    assert pickle.loads(pickle.dumps(scene)) == copy.deepcopy(scene) == dataclasses.replace(scene) == scene
    assert hash(scene) == hash(Scene.from_text(scene.to_toml()))


@pytest.mark.slow
@pytest.mark.random
@given(st.floats(1e-9, 1e2), st.just(0.0) | st.floats(1e-100, 1e4), st.floats(1, 1e14), st.text())
def test_round_trip_of_any_numbers(radius: float, velocity: float, modulus: float, title: str) -> None:
    ball = Sphere(f"{radius!r} m", f"{velocity!r} m/s", material="copper")
    title = title.encode("utf-8", "replace").decode()
    scene = Scene(ball, HalfSpace("copper"), Contact(effective_modulus=f"{modulus!r} Pa"), title=title)
    assert scene.impactor.radius == radius
    assert Scene.from_text(scene.to_toml()) == scene


def test_replace() -> None:
    scene = Scene.from_toml(STEEL)
    faster = scene.replace({"impactor.velocity": "1 m/s", "solver.accuracy": None, "solver.segments": 3})
    assert (faster.impactor.velocity, faster.solver.segments, faster.impactor.radius) == (1.0, 3, 0.01)
    assert scene.impactor.velocity == 0.25
    assert faster.target is scene.target and faster.impactor.material is scene.impactor.material  # are not read again
    assert scene.replace({"solver.segments": 3}).solver == faster.solver != scene.solver
    assert faster.replace({"solver.accuracy": 1e-4}).solver == scene.solver
    with pytest.raises(SceneError, match="not both"):
        scene.replace({"solver.segments": 3, "solver.accuracy": 1e-4})
    assert scene.replace({"impactor.material.density": "1 g/cm^3"}).impactor.material is not None
    with pytest.raises(SceneError, match=r"^impactor.velocity: 1 has no unit"):
        scene.replace({"impactor.velocity": 1})
    with pytest.raises(SceneError, match=r"^impactor.radius.x: radius has no entries"):
        scene.replace({"impactor.radius.x": 1})


def test_a_custom_law_needs_no_material_and_cannot_be_written() -> None:
    ball = Sphere("1 mm", "1 m/s", mass="1 g")
    law = Hertz(1e9, 1e-3)
    scene = Scene(ball, HalfSpace(), Contact(law))
    assert scene.replace({"impactor.mass": "2 g"}).contact.law == law
    with pytest.raises(ValueError, match="cannot be written to a scene file"):
        scene.to_toml()
    with pytest.raises(SceneError, match=r"Contact.exponent: unknown key"):
        Contact(law, exponent=2)


@pytest.mark.parametrize("law", LAWS.values())
def test_every_law_has_parameters_that_a_scene_can_read(law: Any) -> None:
    known = {*DIMENSIONS, "meyer_stiffness", "file"}
    assert {parameter.dimension for parameter in law.parameters.values()} <= known
    assert not {*Contact.FIELDS, "self"} & set(law.parameters)


def test_a_yield_strength_that_is_set_replaces_the_hardness_of_the_catalogue() -> None:
    """Alone and as a column it decides, however it is set; given beside a hardness, the hardness does."""
    scene = Scene(Sphere("1 mm", "1 m/s", material="bearing steel"), HalfSpace("mild steel"))
    path, hardness = "target.material.yield_strength", "target.material.hardness"
    assert scene.flow_strength != pytest.approx(300e6)
    assert scene.replace({path: "300 MPa"}).yield_strength == pytest.approx(300e6)
    assert scene_of_columns(scene, {path: np.array([3e8, 4e8])}).yield_strength.tolist() == [3e8, 4e8]
    both = {path: "300 MPa", hardness: "1 GPa"}
    assert scene.replace(both).flow_strength == pytest.approx(1e9 / 2.8)
    arrays = {path: np.array([3e8]), hardness: np.array([1e9])}
    assert scene_of_columns(scene, arrays).flow_strength == pytest.approx(1e9 / 2.8)
