"""Tunable parameters: after a change between steps an FMU moves as one that starts there with the new value."""

import pytest
from cases import LAWS
from fmpy.fmi1 import FMICallException
from test_stepped_friction import scene

import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import VARIABLES

VERSIONS = pytest.mark.parametrize("version", [2, 3])
BOUNCING = fmu_wrapper.served(scene("tsuji", restitution=0.8))
LATER, END = 400e-6, 1200e-6
START = {"gravity": 2e3, "initial_gap": 1e-6}
MOTION = ("impactor_velocity", "indentation", "contact_force", "tangential_velocity", "spin", "friction_force")
NORMAL, ALONG = 1e-9, 1e-4
"""Allowed relative differences; the motion along the surface is followed in steps, which begin elsewhere."""


def changed_and_started(fmu, changes, later, end, names, start):
    """Outputs at `end`, of a run with changes at the time `later`, and of one that starts there with them."""
    with started(fmu, False, start) as slave:
        slave.step(0.0, later)
        there = slave.get((*MOTION[:2], "phase", "contact_count", *(MOTION[3:5] if "spin" in names else ())))
        for name, value in changes.items():
            slave.set(name, value)
        slave.step(later, end - later)
        found = slave.get(names)
    assert there["phase"] == fm.core.native.PHASES.index("separated") and there["contact_count"] == 1
    of_start = {"initial_velocity": there["impactor_velocity"], "initial_gap": -there["indentation"]}
    of_start |= {f"initial_{along}": there[along] for along in MOTION[3:5] if along in there}
    with started(fmu, False, {**start, **of_start, **changes}) as slave:
        slave.step(0.0, end - later)
        assert slave.get(("contact_count",))["contact_count"] >= 1
        return found, slave.get(names)


@pytest.mark.slow
@VERSIONS
@pytest.mark.parametrize(("name", "value"), [("gravity", 3e3), ("friction", 0.05), ("restitution", 0.5)])
def test_a_change_acts_as_the_same_scene_started_there(made, version, name, value):
    with opened(made(BOUNCING, version)) as fmu:
        tunable = {v.name for v in fmu.description.modelVariables if v.variability == "tunable"}
        every = {v.name for v in VARIABLES if v.variability == "tunable"}
        assert tunable == {"gravity", "friction", "restitution"} < every
        found, expected = changed_and_started(fmu, {name: value}, LATER, END, (*MOTION, "maximum_force"), START)
    for k, (what, own) in enumerate(expected.items()):
        assert found[what] == pytest.approx(own, rel=ALONG if 2 < k < 6 else NORMAL, abs=1e-12), what


def test_a_contact_ends_with_the_damping_that_it_began_with(made):
    ends = []
    for when in (20e-6, LATER):
        with opened(made(BOUNCING, 3)) as fmu, started(fmu, False, START) as slave:
            slave.step(0.0, when)
            assert (slave.get(("contact_force",))["contact_force"] > 0.0) == (when < LATER)
            slave.set("restitution", 0.5)
            slave.step(when, END - when)
            ends.append(tuple(slave.get((*MOTION, "maximum_force", "largest_force")).values()))
    assert ends[0] == pytest.approx(ends[1], rel=ALONG, abs=1e-12)
    assert ends[0][:3] + ends[0][6:] == pytest.approx(ends[1][:3] + ends[1][6:], rel=NORMAL, abs=1e-12)


def test_on_a_target_that_vibrates(made):
    """Whose vibrations have faded when the parameters change."""
    fades = fm.Structure(frequency=["300 Hz"], modal_mass=["0.3 kg"], damping_ratio=0.5, material="bearing steel")
    ball = fm.Sphere("10 mm", "0.5 m/s", material="bearing steel", mass="50 g")
    on = fmu_wrapper.served(fm.Scene(ball, fades, fm.Contact(LAWS["linear-dashpot"])))
    names = ("impactor_velocity", "indentation", "maximum_force", "largest_force")
    with opened(made(on, 2)) as fmu:
        changes = {"gravity": 40.0, "restitution": 0.3}
        found, expected = changed_and_started(fmu, changes, 40e-3, 46e-3, names, {})
    assert found.pop("largest_force") > found["maximum_force"]
    assert found["maximum_force"] == pytest.approx(expected.pop("largest_force"), rel=1e-12)
    assert found == pytest.approx(expected, rel=1e-6)


def test_in_model_exchange_they_change_with_an_event(made):
    on = fmu_wrapper.served(scene("tsuji", restitution=0.8).replace({"contact.friction": None, "impactor.angle": None}))
    with opened(made(on, 3)) as fmu:
        with started(fmu, False, {"initial_gap": 1e-3}, exchange=True) as slave:
            slave.instance.enterEventMode()
            slave.set("gravity", 7.0)
            slave.handle()
            assert slave.get(("impactor_acceleration",))["impactor_acceleration"] == 7.0
        with started(fmu, False, {}, exchange=True) as slave:
            slave.instance.enterEventMode()
            with pytest.raises(FMICallException):
                slave.set("mass", 1.0)
            assert "mass can only be set before the end of Initialization Mode" in fmu.messages.pop()
