"""The contact radius, dent, pressures and stresses that FMUs report are those of the library's summary."""

from dataclasses import replace

import pytest
from cases import LAWS, combinations
from cases import scene as scene_as_given

import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import STRESSES


def scene(*arguments, **options):
    return fmu_wrapper.served(scene_as_given(*arguments, segments=40, **options))


def reported(path, history, starts=None):
    """The outputs after one step over the whole impact."""
    with opened(path) as fmu, started(fmu, False, starts or {}) as slave:
        slave.step(0.0, 1.1 * history.duration)
        return slave.get(STRESSES)


def same(found, summary):
    expected = {name: summary[name] or 0.0 for name in STRESSES}
    assert found == pytest.approx(expected, rel=1e-9)
    return expected


@pytest.mark.slow
@combinations(
    law=["hertz", "big-alabo", "stronge", "meyer", "tsuji", "saturating", "thornton", "rigid-plastic"],
    velocity=[0.003, 0.25, 3.0],
    version=[2, 3],
    fast=6,
)
def test_stresses_are_those_of_the_summary(made, law, velocity, version):
    on = scene(law, velocity=velocity)
    history = fm.simulate(on)
    expected = same(reported(made(on, version), history), history.summary)
    if law == "hertz":
        assert all(value > 0.0 for name, value in expected.items() if name != "dent_diameter")
    if law == "big-alabo" and velocity == 3.0:
        assert expected["dent_diameter"] == 2.0 * expected["contact_radius"] and expected["peak_pressure"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("softer", ["ball", "target"])
def test_stresses_of_two_materials(made, softer):
    bodies = [
        fm.Material("soft", "100 GPa", 0.3, "7850 kg/m^3", "100 MPa"),
        fm.Material("hard", "70 GPa", 0.3, "7850 kg/m^3", "2 GPa"),
    ]
    ball, struck = bodies if softer == "ball" else bodies[::-1]
    impactor = fm.Sphere("5 mm", velocity="5 m/s", material=ball)
    on = fmu_wrapper.served(fm.Scene(impactor, fm.HalfSpace(struck), fm.Contact("elastoplastic")))
    history = fm.simulate(on)
    assert on.elastic_share > 0.5 and on.softer_curvature == (softer == "ball")
    assert same(reported(made(on, 3), history), history.summary)["dent_diameter"] > 0.0


@pytest.mark.slow
@combinations(
    law=["jackson-green", "big-alabo", "hertz"],
    changed=[{"radius": 0.006}, {"effective_modulus": 9e10}, {"yield_strength": 6e8}],
    fast=3,
)
def test_stresses_after_a_change_of_parameters(made, law, changed):
    if law == "hertz" and "yield_strength" in changed:
        changed = {"radius": 0.02, "effective_modulus": 2e11}
    names = {"radius": "impactor.radius", "yield_strength": "target.material.yield_strength"}
    names["effective_modulus"] = "contact.effective_modulus"
    units = {"radius": "m", "yield_strength": "Pa", "effective_modulus": "Pa"}
    on = fmu_wrapper.served(replace(scene(law), contact=fm.Contact(LAWS[law].name)))
    new = on.replace({names[name]: f"{value!r} {units[name]}" for name, value in changed.items()})
    history = fm.simulate(new)
    same(reported(made(on), history, changed), history.summary)


@pytest.mark.slow
def test_a_contact_reports_them_too(made):
    on = scene("big-alabo", velocity=1.0)
    history = fm.simulate(replace(on, effects=fm.Effects(gravity=False, target_motion=False)))
    times = [history.duration * n / 2000 for n in range(2001)]
    motion = history.sample_si(times)
    with opened(made(on, kind="contact")) as fmu, started(fmu, False, {"relative_velocity": 1.0}) as slave:
        assert not any(slave.get(STRESSES).values())
        for time, x, v in zip(times, motion.indentation.tolist(), motion.relative_velocity.tolist(), strict=True):
            slave.set("indentation", x)
            slave.set("relative_velocity", v)
            slave.step(time, times[1])
        slave.set("indentation", history.summary["permanent_indentation"] - 1e-9)
        slave.step(times[-1] + times[1], times[1])
        found = slave.get(STRESSES)
    assert found == pytest.approx({name: history.summary[name] or 0.0 for name in STRESSES}, rel=1e-6)
    assert found["contact_radius"] > 0.0 and found["dent_diameter"] > 0.0 and found["mean_pressure"] > 1e9


@pytest.mark.slow
def test_a_run_has_them_in_its_dataset(made):
    for law, velocity, mode in (("hertz", 0.25, "steps"), ("big-alabo", 3.0, "events")):
        on = scene(law, velocity=velocity)
        summary, ds = fm.simulate(on).summary, fmu_wrapper.run(made(on), mode=mode, step_size="20 us")
        expected = [float("nan") if summary[name] is None else summary[name] for name in STRESSES]
        assert [float(ds[name]) for name in STRESSES] == pytest.approx(expected, rel=1e-9, nan_ok=True)
