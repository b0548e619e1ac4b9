"""Sensors, free bodies, friction and tunable parameters in importers of the package index.

The values are those of the FMU under FMPy, which other tests compare with the library.
"""

from dataclasses import dataclass, field

import numpy as np
import pytest
from fmu_resources import SENSORS, on_structure
from test_fmu_importers import ecos
from test_stepped_friction import scene as rubbing

import film_model as fm
from fmu_wrapper.instance import opened, started

pytestmark = pytest.mark.slow
LARGEST = ("maximum_force", "largest_force", "largest_indentation")
MOTION = ("impactor_velocity", "indentation", "contact_force", *LARGEST, "target_velocity")
NS = 1e-9


@dataclass(frozen=True)
class Case:
    """steps of `step` ns; outputs; changes: parameters set after half of the steps."""

    on: fm.Scene
    step: int
    outputs: tuple[str, ...] = MOTION
    changes: dict[str, float] = field(default_factory=dict)
    start: dict[str, float] = field(default_factory=dict)
    steps: int = 40


def cases():
    steel, sensors = (
        "bearing steel",
        tuple(f"sensor_{s['name']}_{of}" for s in SENSORS for of in ("displacement", "velocity")),
    )
    free = fm.Scene(fm.Sphere("10 mm", "0.5 m/s", material=steel), fm.Body(steel, "15 mm"), fm.Contact("hertz"))
    tuned = {"gravity": 3e3, "friction": 0.05, "restitution": 0.5}
    along = ("spin", "tangential_velocity", "friction_force")
    return {
        "sensors": Case(
            on_structure("hertz", static_compliance="3e-6 m/N", sensors=SENSORS), 5000, (*MOTION, *sensors)
        ),
        "ringing": Case(
            on_structure("hertz", static_compliance="3e-6 m/N", sensors=SENSORS), 50_000, (*MOTION, *sensors)
        ),
        "free body": Case(free, 5000),
        "tunable": Case(
            *(rubbing("tsuji", restitution=0.8), 40_000, (*MOTION[:6], *along), tuned),
            {"gravity": 2e3, "initial_gap": 1e-6},
        ),
    }


CASES = pytest.mark.parametrize("name", list(cases()))


def of(made, name, version):
    case = cases()[name]
    return case, made(case.on, version)


def expected(path, case):
    with opened(path) as fmu, started(fmu, False, case.start) as slave:
        for n in range(case.steps):
            if n == case.steps // 2:
                for name, value in case.changes.items():
                    slave.set(name, value)
            slave.step(n * case.step * NS, case.step * NS)
        references = {name: fmu.variables[name][0] for name in (*case.outputs, *case.changes, *case.start)}
        return slave.get(case.outputs), references


def compared(found, right):
    assert np.any(list(right.values()))
    for name, value in right.items():
        assert found[name] == pytest.approx(value, rel=1e-11, abs=1e-15), name


@CASES
def test_libcosim(made, name):
    pytest.importorskip("libcosimpy")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    case, path = of(made, name, 2)
    right, references = expected(path, case)
    execution, observer = CosimExecution.from_step_size(step_size=case.step), CosimObserver.create_last_value()
    manipulator = CosimManipulator.create_override()
    execution.add_observer(observer)
    execution.add_manipulator(manipulator)
    index = execution.add_local_slave(CosimLocalSlave(str(path), "impact"))
    for start, value in case.start.items():
        execution.real_initial_value(index, references[start], value)
    execution.step(case.steps // 2)
    for changed, value in case.changes.items():
        manipulator.slave_real_values(index, [references[changed]], [value])
    execution.step(case.steps - case.steps // 2)
    values = observer.last_real_values(index, [references[output] for output in case.outputs])
    compared(dict(zip(case.outputs, values, strict=True)), right)


@CASES
@pytest.mark.parametrize("version", [2, 3])
def test_ecos(made, name, version):
    ecospy = ecos()
    case, path = of(made, name, version)
    right, _ = expected(path, case)
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("impact", str(path))
        structure.add_parameter_set("start", {f"impact::{key}": value for key, value in case.start.items()})
        with ecospy.EcosSimulation(structure=structure, step_size=case.step * NS) as simulation:
            simulation.init(parameter_set="start")
            simulation.step(case.steps // 2)
            for changed, value in case.changes.items():
                simulation.set_real(f"impact::{changed}", value)
            simulation.step(case.steps - case.steps // 2)
            compared({output: simulation.get_real(f"impact::{output}") for output in case.outputs}, right)
            simulation.terminate()
