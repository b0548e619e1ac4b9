"""Public objects come back equal from a pickle and from a copy."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import pytest

import film_datasets as fd
import film_model as fm

STEEL = fm.Sphere("10 mm", "1 m/s", material="bearing steel")
SOFT = fm.Material("soft", "3 GPa", 0.35, "1000 kg/m^3", prony=[[0.3, "10 us"]])
SCENES = {
    "half-space": fm.Scene(STEEL, fm.HalfSpace("mild steel")),
    "viscoelastic": fm.Scene(fm.Sphere("10 mm", "1 m/s", material=SOFT), fm.HalfSpace("mild steel")),
    "modes": fm.Scene(STEEL, fm.Plate("mild steel", thickness="5 mm", size=["300 mm", "200 mm"], edges="clamped")),
}
WAYS: dict[str, Callable[[Any], Any]] = {"pickle": lambda x: pickle.loads(pickle.dumps(x)), "deepcopy": copy.deepcopy}


@pytest.mark.filterwarnings("ignore::film_model.ImpactWarning")
@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_histories_and_components(scene: fm.Scene, way: Callable[[Any], Any]) -> None:
    history = fm.simulate(scene)
    for each in (scene, history, history.events, history.accuracy, history.sample("5 us")):
        assert way(each) == each
    component = fm.ImpactComponent(scene)
    component.step("20 us")
    again = way(component)
    assert component.step("30 us") == again.step("30 us")


@pytest.mark.filterwarnings("ignore::film_model.ImpactWarning")
@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_many_impacts(way: Callable[[Any], Any]) -> None:
    scene = SCENES["half-space"]
    bounces = fm.bounce(scene)
    assert way(bounces) == bounces
    batch = fm.simulate_batch(scene, velocity=["1 m/s", "2 m/s"])
    assert way(batch) == batch != fm.simulate_batch(scene, velocity=["1 m/s", "3 m/s"])
    tolerance = fd.tolerance(scene, {"impactor.velocity": {"normal": ["1 m/s", "0.01 m/s"]}}, samples=64)
    assert way(tolerance).to_dict() == tolerance.to_dict()
    derivatives = fm.simulate(scene, derivatives=["impactor.velocity"]).derivatives
    assert way(derivatives) == derivatives
    for each in (*fm.LAWS.values(), fm.material("mild steel"), fd.TABLE["impact_history"]):
        assert way(each) == each
