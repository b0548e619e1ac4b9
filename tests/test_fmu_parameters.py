"""Derivatives of the motion by parameters after Initialization Mode.

In Model Exchange of rates and outputs as functions of states and parameters; in Co-Simulation of the whole motion.
"""

import numpy as np
import pytest
from cases import combinations
from cases import scene as scene_as_given
from fmpy.fmi1 import FMICallException

import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started
from fmu_wrapper.resource import start_values
from fmu_wrapper.variables import NORMAL_STATES as STATES
from fmu_wrapper.variables import VARIABLES, reference

RATES = tuple(f"rate_of_{state}" for state in STATES)
MOTION = tuple(
    v.name for v in VARIABLES if v.causality.get("impact") == "output" and v.variability == "continuous" and not v.group
)
OF_START = ("initial_velocity", "initial_gap")
CENTRAL = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0
NODES = (-2, -1, 1, 2)


def scene(*arguments, **options):
    return fmu_wrapper.served(scene_as_given(*arguments, **options))


def jacobian(slave, of, by):
    rows = [reference(name) for name in of]
    return np.array([slave.instance.getDirectionalDerivative(rows, [reference(name)], [1.0]) for name in by]).T


def said_of(slave, call):
    with pytest.raises((FMICallException, fm.SimulationError)):
        call()
    return slave.fmu.messages[-1]


def parameters_of(fmu):
    """Those that act after the start."""
    known = {v.name for v in VARIABLES if v.causality.get("impact") == "parameter" and v.type == "Real"}
    return {name: value for name, value in start_values(fmu.data).items() if name in known and name not in OF_START}


def put(slave, states):
    for name, value in zip(STATES, states, strict=True):
        slave.set(name, value)


@combinations(law=["hertz", "big-alabo", "stronge", "tsuji", "meyer"], version=[3, 2], fast=2)
def test_in_model_exchange_rates_and_outputs_are_functions_of_parameters(made, law, version):
    with opened(made(scene(law, "plate"), version)) as fmu, started(fmu, False, {}, True) as slave:
        values = parameters_of(fmu)
        put(slave, np.array(fmu.data.nominal[:3]) * [0.3, 0.7, 0.2])
        unknowns = (*RATES, *MOTION)
        found = jacobian(slave, unknowns, values)
        assert {"mass", "target_impedance", "gravity"} < set(values)
        for column, (name, value) in zip(found.T, values.items(), strict=True):
            h, rows = (1e-4 if name == "exponent" else 1e-3) * value, []
            for node in NODES:
                slave.set(name, value + h * node)
                rows.append(list(slave.get(unknowns).values()))
            slave.set(name, value)
            expected = CENTRAL @ np.array(rows) / h
            rounding = 1e-14 * np.abs(rows).max(axis=0) / h
            assert np.all(np.abs(column - expected) <= 1e-8 * np.abs(expected) + rounding), name
            assert np.any(column) or (law, name) == ("meyer", "radius"), name
        assert np.array_equal(jacobian(slave, unknowns, values), found)


def test_a_dent_is_not_that_of_other_parameters(made):
    """The way out of a dent is that of the parameters on the way in."""
    with opened(made(scene("big-alabo", "plate"))) as fmu, started(fmu, False, {}, True) as slave:
        depth, speed, moved = fmu.data.nominal[:3]
        for rate in (speed, -speed):  # in, and out: Event Mode handles the stage and the turn
            put(slave, (0.5 * depth, rate, moved))
            slave.instance.enterEventMode()
            slave.handle()
        put(slave, (0.4 * depth, -speed, moved))
        assert jacobian(slave, ("impactor_acceleration",), ("mass",))[0, 0] > 0.0
        slave.set("mass", 2.0 * fmu.data.start[reference("mass")])
        sentence = (
            "radius cannot change now: the contact remembers an indentation with the parameters that it began with"
        )
        assert sentence in said_of(slave, lambda: jacobian(slave, ("contact_force",), ("radius",)))
        assert sentence in said_of(slave, lambda: slave.set("radius", 0.02))
        assert "initial_gap belongs to the start" in said_of(slave, lambda: slave.set("initial_gap", 1e-6))


def test_a_value_that_is_refused_changes_nothing(made):
    with opened(made(scene("jackson-green", "plate"))) as fmu, started(fmu, False, {}, True) as slave:
        put(slave, np.array(fmu.data.nominal[:3]) * [0.3, 0.7, 0.2])
        before = slave.get(MOTION)
        assert "the law a shape" in said_of(slave, lambda: slave.set("yield_strength", 2.0))
        assert slave.get(MOTION) == before


@combinations(law=["hertz", "big-alabo", "tsuji"], by=["mass", "velocity"], fast=1)
def test_in_co_simulation_the_motion_has_those_of_the_library(made, law, by):
    """At an accuracy of 1e-4, against differences of accurate impacts."""
    on = scene(law, "plate")
    name, path, size, unit = {
        "mass": ("mass", "impactor.mass", on.mass, "kg"),
        "velocity": ("initial_velocity", "impactor.velocity", on.approach_velocity, "m/s"),
    }[by]
    names = ("indentation", "impactor_velocity", "impactor_displacement", "contact_force")
    with opened(made(on)) as fmu, started(fmu, False, {"gravity": 0.0}) as slave:
        times = np.linspace(0.1, 0.9, 5) * float(fmu.description.defaultExperiment.stopTime) / 1.25
        found, here = [], 0.0
        for time in times:
            slave.step(here, time - here)
            found.append(jacobian(slave, names, (name,))[:, 0] * size)
            here = time
    motions = []
    for node in NODES:
        moved = on.replace({path: f"{size * (1.0 + 1e-3 * node)!r} {unit}", "effects.gravity": False})
        samples = fm.simulate(moved, accuracy=1e-8).sample_si(times)
        motions.append([getattr(samples, one) for one in names])
    expected = np.tensordot(CENTRAL, np.array(motions), 1).T / 1e-3
    assert np.abs(np.array(found) - expected).max(axis=0) / np.abs(expected).max(axis=0) == pytest.approx(0.0, abs=2e-3)
