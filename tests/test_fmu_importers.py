"""FMUs in importers of the package index (pip install "film-model[interop]"): libcosim, ecos, CasADi.

Two free masses for couplings are FMUs too: impacts whose own contact is too soft to matter.
"""

import ctypes
import math
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from cases import scene

import film_model as fm
import fmu_wrapper
from fmu_wrapper.variables import reference

pytestmark = pytest.mark.slow
VERSIONS = pytest.mark.parametrize("version", [2, 3])
SOFT = {"effective_modulus": 1.0, "gravity": 0.0}  # Pa: no contact force of its own
VALUES = ("maximum_force", "rebound_velocity", "time_contact_ends", "maximum_indentation")


@pytest.fixture
def history():
    return fm.simulate(fmu_wrapper.served(scene("hertz")), accuracy=1e-6)


def compared(found, history, rel):
    summary = history.summary
    expected = {**summary, "time_contact_ends": summary["contact_duration"]}
    for name, value in found.items():
        assert value == pytest.approx(expected[name], rel=rel), name


# ---------------------------------------------------------------- libcosim


OSP = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <BaseStepSize>{step!r}</BaseStepSize>
  <Algorithm>fixedStep</Algorithm>
  <Simulators>
    <Simulator name="body" source="body.fmu"><InitialValues>{starts}</InitialValues></Simulator>
    <Simulator name="wall" source="wall.fmu"><InitialValues>{rate}</InitialValues></Simulator>
  </Simulators>
  <Functions>
    <LinearTransformation name="reaction" factor="-1.0" offset="0.0"/>
  </Functions>
  <Connections>
    <VariableConnection><Variable simulator="body" name="indentation"/>
      <Variable simulator="wall" name="indentation"/></VariableConnection>
    <VariableConnection><Variable simulator="body" name="relative_velocity"/>
      <Variable simulator="wall" name="relative_velocity"/></VariableConnection>
    <SignalConnection><Variable simulator="wall" name="contact_force"/>
      <Signal function="reaction" name="in"/></SignalConnection>
    <SignalConnection><Signal function="reaction" name="out"/>
      <Variable simulator="body" name="external_force"/></SignalConnection>
  </Connections>
</OspSystemStructure>
"""


def initial(**values):
    entry = '<InitialValue variable="{}"><Real value="{!r}"/></InitialValue>'
    return "".join(entry.format(name, value) for name, value in values.items())


def test_libcosim_runs_an_impact(made, history):
    cosim = pytest.importorskip("libcosimpy")
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    assert cosim
    step = round(1.5e9 * history.duration / 50)
    execution, observer = CosimExecution.from_step_size(step_size=step), CosimObserver.create_last_value()
    execution.add_observer(observer)
    index = execution.add_local_slave(CosimLocalSlave(str(made(history.scene, 2)), "impact"))
    execution.step(51)
    values = observer.last_real_values(index, [reference(name) for name in VALUES])
    compared(dict(zip(VALUES, values, strict=True)), history, 2e-6)
    assert observer.last_integer_values(index, [reference("phase_code"), reference("last_event_code")]) == [5, 5]


def coupled_in_libcosim(made, history, folder, steps):
    """Rebound over approach, and the largest force: a contact and a mass, in so many fixed steps a contact."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    h, speed = round(1e9 * history.duration / steps) * 1e-9, history.scene.approach_velocity
    folder.mkdir()
    (folder / "body.fmu").write_bytes(made(history.scene, 2).read_bytes())
    (folder / "wall.fmu").write_bytes(made(history.scene, 2, kind="contact").read_bytes())
    text = OSP.format(step=h, starts=initial(**SOFT), rate=initial(relative_velocity=speed))
    (folder / "OspSystemStructure.xml").write_text(text, encoding="utf-8")
    execution, observer = CosimExecution.from_osp_config_file(str(folder)), CosimObserver.create_last_value()
    execution.add_observer(observer)
    names = {info.name.decode(): info.index for info in execution.slave_infos()}
    largest = 0.0
    for _ in range(int(1.3 * steps)):
        execution.step()
        (force,) = observer.last_real_values(names["wall"], [reference("contact_force")])
        largest = max(largest, force)
    (after,) = observer.last_real_values(names["body"], [reference("impactor_velocity")])
    return -after / speed, largest


def test_libcosim_couples_a_contact_with_a_mass(made, history, tmp_path):
    """Fixed steps, side by side, without co-operation of the master: of second order and better, 1 % at 50 steps."""
    pytest.importorskip("libcosimpy")
    steps = (50, 100, 200, 400)
    found = [coupled_in_libcosim(made, history, tmp_path / str(count), count) for count in steps]
    errors = [abs(rebound - 1.0) for rebound, _ in found]
    assert errors[0] < 0.01 and np.diff(np.log2(errors)).max() < -2.0, errors
    assert [largest for _, largest in found] == pytest.approx([history.summary["maximum_force"]] * 4, rel=0.01)


# ---------------------------------------------------------------- ecos


def ecos():
    """The module, or a skip where it or the library TBB is missing, which the package index and the system have."""
    for library in Path(sys.prefix).glob("lib/libtbb.so.12"):  # of the package tbb
        ctypes.CDLL(str(library))
    try:
        return pytest.importorskip("ecospy")
    except OSError as error:
        pytest.skip(f"ecospy cannot be loaded: {error}")


@VERSIONS
def test_ecos_runs_an_impact(made, history, version):
    ecospy = ecos()
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("impact", str(made(history.scene, version)))
        with ecospy.EcosSimulation(structure=structure, step_size=1.5 * history.duration / 50) as simulation:
            simulation.init()
            simulation.step(51)
            found = {name: simulation.get_real(f"impact::{name}") for name in VALUES}
            assert simulation.get_integer("impact::phase_code") == 5
            simulation.terminate()
    compared(found, history, 2e-6)


@VERSIONS
@pytest.mark.parametrize("steps", [50, 100, 500])
def test_ecos_couples_a_contact_with_a_mass(made, history, version, steps):
    ecospy = ecos()
    speed, largest = history.scene.approach_velocity, 0.0
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("body", str(made(history.scene, version)))
        structure.add_model("wall", str(made(history.scene, version, kind="contact")))
        structure.make_real_connection("body::indentation", "wall::indentation")
        structure.make_real_connection("body::relative_velocity", "wall::relative_velocity")
        structure.make_real_connection("wall::contact_force", "body::external_force", lambda force: -force)
        starts = {**{f"body::{name}": value for name, value in SOFT.items()}, "wall::relative_velocity": speed}
        structure.add_parameter_set("soft", starts)
        with ecospy.EcosSimulation(structure=structure, step_size=history.duration / steps) as simulation:
            simulation.init(parameter_set="soft")
            for _ in range(int(1.3 * steps)):
                simulation.step(1)
                largest = max(largest, simulation.get_real("wall::contact_force"))
            after = simulation.get_real("body::impactor_velocity")
            simulation.terminate()
    assert -after / speed == pytest.approx(1.0, abs=0.01 * (50 / steps) ** 2)
    assert largest == pytest.approx(history.summary["maximum_force"], rel=0.01)


# ---------------------------------------------------------------- CasADi


@pytest.fixture
def dae(made, tmp_path):
    casadi = pytest.importorskip("casadi")

    def make(on, version, outputs, **options):
        folder = tmp_path / "extracted"
        with zipfile.ZipFile(made(on, version, **options)) as archive:
            archive.extractall(folder)
        builder = casadi.DaeBuilder("fmu", str(folder))
        builder.set_y(list(outputs))
        return builder

    return make


@VERSIONS
def test_casadi_takes_values_jacobians_and_adjoints(dae, version):
    on = fmu_wrapper.served(scene("hertz", "plate"))
    outputs = ("contact_force", "impactor_acceleration", "kinetic_energy", "target_velocity")
    model = dae(on, version, outputs).create("f", ["x", "u"], ["ode", "y"])
    x, u = [5e-6, 0.2, 1e-7], [3.0, 0.01]
    rates, values = model(x, u)
    force, mass = float(values[0]), on.mass
    stiffness = 4 / 3 * on.effective_modulus * math.sqrt(on.effective_radius)
    assert force == pytest.approx(stiffness * x[0] ** 1.5, rel=1e-12)
    assert float(rates[0]) == pytest.approx(x[1] - u[1] - force / on.target_impedance, rel=1e-12)
    assert float(rates[1]) == pytest.approx(9.80665 + (u[0] - force) / mass, rel=1e-12)
    assert float(rates[2]) == pytest.approx(u[1] + force / on.target_impedance, rel=1e-12)
    slope = 1.5 * stiffness * math.sqrt(x[0])
    jacobian = model.factory("J", ["x", "u"], ["jac:ode:x", "jac:y:x", "jac:ode:u"])(x, u)
    assert float(jacobian[0][1, 0]) == pytest.approx(-slope / mass, rel=1e-12)
    assert float(jacobian[1][0, 0]) == pytest.approx(slope, rel=1e-12)
    assert float(jacobian[1][2, 1]) == pytest.approx(mass * x[1], rel=1e-12)
    assert float(jacobian[2][1, 0]) == pytest.approx(1.0 / mass, rel=1e-12)
    adjoint = model.reverse(1)(x, u, rates, values, [0, 1, 0], [0, 0, 0, 0])
    assert float(adjoint[0][0]) == pytest.approx(-slope / mass, rel=1e-12)
    assert float(adjoint[1][0]) == pytest.approx(1.0 / mass, rel=1e-12)


def test_casadi_differentiates_by_parameters(dae):
    """Against central differences of its own values, and adjoint. FMI 2.0 lists no dependencies on parameters."""
    builder = dae(fmu_wrapper.served(scene("big-alabo", "plate")), 3, ("contact_force", "target_velocity"))
    for name in ("mass", "radius", "effective_modulus", "yield_strength", "target_impedance"):
        builder.set_category(name, "p")
    assert builder.p()[-1] == "gravity" and len(builder.p()) == 6
    model, p = builder.create("f", ["x", "u", "p"], ["ode", "y"]), [builder.start(name)[0] for name in builder.p()]
    x, u = [5e-6, 0.2, 1e-7], [3.0, 0.01]
    ode, y = (np.array(found) for found in model.factory("J", ["x", "u", "p"], ["jac:ode:p", "jac:y:p"])(x, u, p))
    for k, value in enumerate(p):
        moved = [[*p[:k], value * (1.0 + 1e-3 * node), *p[k + 1 :]] for node in (-2, -1, 1, 2)]
        values = [np.concatenate([np.array(part)[:, 0] for part in model(x, u, one)]) for one in moved]
        expected = np.array([1, -8, 8, -1]) @ values / (12e-3 * value)
        assert np.concatenate([ode[:, k], y[:, k]]) == pytest.approx(
            expected, rel=1e-8, abs=1e-11 * np.abs(values).max() / value
        )
    adjoint = model.reverse(1)(x, u, p, *model(x, u, p), [0.0, 1.0, 0.0], [0.0, 0.0])
    assert np.array(adjoint[2])[:, 0] == pytest.approx(ode[1], rel=1e-13)


@VERSIONS
def test_casadi_takes_the_derivative_by_a_tunable_parameter(dae, version):
    model = dae(scene("hertz"), version, ("contact_force",)).create("f", ["x", "u", "p"], ["ode", "y"])
    jacobian = model.factory("J", ["x", "u", "p"], ["jac:ode:p"])([5e-6, 0.2, 0.0], [0.0, 0.0], [5.0])
    assert np.array(jacobian)[:, 0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)


@VERSIONS
def test_casadi_takes_real_outputs_as_they_are(made, tmp_path, version):
    """Without them it refuses the file; what the FMU computes is the same."""
    casadi = pytest.importorskip("casadi")
    on, point = scene("hertz", "plate"), ([5e-6, 0.2, 1e-7], [3.0, 0.01])
    builders = {}
    for outputs in ("all", "real"):
        with zipfile.ZipFile(made(on, version, outputs=outputs)) as archive:
            archive.extractall(tmp_path / outputs)
        builders[outputs] = casadi.DaeBuilder("fmu", str(tmp_path / outputs))
    with pytest.raises(RuntimeError):
        builders["all"].create("f", ["x", "u"], ["ode", "y"])(*point)
    names = builders["real"].y()
    assert "contact_force" in names and "stage" not in names and "validity" not in names
    builders["all"].set_y(names)
    found = [builder.create("f", ["x", "u"], ["ode", "y"])(*point) for builder in builders.values()]
    for one, other in zip(*found, strict=True):
        assert np.array_equal(np.array(one), np.array(other))
    with pytest.raises(ValueError, match="outputs: 'whole' is not allowed: 'all' or 'real' is needed"):
        fmu_wrapper.export(on, tmp_path / "x.fmu", outputs="whole")


@VERSIONS
def test_casadi_loads_a_contact(dae, version):
    model = dae(scene("hertz"), version, ("contact_force",), kind="contact").create("f", ["u"], ["y"])
    assert model.size1_out(0) == 1 and model.jacobian().n_out() == 1
