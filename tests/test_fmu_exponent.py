"""The exponent of a law whose force is a power of the indentation, changed after export."""

from dataclasses import replace

import pytest
from cases import combinations, scene

import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started
from fmu_wrapper.resource import start_values

CONTACTS = {
    "meyer": {"law": "meyer", "stiffness": "1.2e10 N/m^1.5", "exponent": 1.5},
    "meyer with a clearance": {
        **{"law": "meyer", "stiffness": "1.2e10 N/m^1.5", "exponent": 1.5},
        "initial_indentation": "2 um",
    },
    "tan-sun": {"law": "tan-sun", "stiffness": "1.2e10 N/m^1.5", "critical_indentation": "4 um"},
}
SUMMARY = ("maximum_force", "maximum_indentation", "rebound_velocity", "permanent_indentation", "contact_duration")


def ball(contact, target="half-space"):
    impactor, struck = scene("hertz").impactor, scene("hertz", target).target
    return fm.Scene(impactor, struck, fm.Contact(**contact), fm.Effects(gravity=False), fm.Solver(segments=40))


def with_exponent(contact, exponent, stiffness):
    return {**contact, "exponent": exponent, "stiffness": f"{stiffness!r} N/m^{exponent!r}"}


@pytest.mark.slow
@combinations(name=CONTACTS, exponent=[1.2, 1.9], target=["half-space", "plate"], version=[2, 3], fast=4)
def test_an_exponent_after_export_is_a_new_scene(made, name, exponent, target, version):
    stiffness = 1.2e10 * 1e-5 ** (1.5 - exponent)  # about the same force at 10 micrometres
    history = fm.simulate(ball(with_exponent(CONTACTS[name], exponent, stiffness), target))
    values = {"exponent": exponent, "power_stiffness": stiffness}
    ds = fmu_wrapper.run(made(ball(CONTACTS[name], target), version), start_values=values, stop_time="1 ms")
    for key in SUMMARY:
        assert float(ds[key]) == pytest.approx(history.summary[key], rel=1e-10), key


@pytest.mark.slow
@combinations(name=CONTACTS, version=[2, 3], fast=2)
def test_an_exponent_of_a_contact(made, name, version):
    forces = []
    for exported in (CONTACTS[name], with_exponent(CONTACTS[name], 1.9, 1.2e12)):
        path = made(ball(exported), version, kind="contact")
        with opened(path) as fmu, started(fmu, False, {"exponent": 1.9, "power_stiffness": 1.2e12}) as slave:
            slave.set("indentation", 9e-6)
            forces.append(slave.get(("contact_force",))["contact_force"])
    assert forces[0] > 0.0 and forces[0] == pytest.approx(forces[1], rel=1e-12)


def test_what_cannot_have_another_exponent(made):
    with pytest.raises(fm.SimulationError, match=r"exponent: 2\.6 must be at most 2\.5, that of unloading"):
        fmu_wrapper.run(made(ball(CONTACTS["tan-sun"])), start_values={"exponent": 2.6})
    jumps = fm.Contact(fm.Meyer(stiffness=1e9, exponent=1.2, initial_force=5.0))
    for other in (scene("hertz"), replace(scene("hertz"), contact=jumps)):
        with opened(made(other)) as fmu:
            assert "exponent" not in start_values(fmu.data)
