"""Derivatives of an FMU's outputs: by inputs and states right after events, and by parameters."""

import math
import re
from ctypes import byref, c_double, c_int, c_size_t, c_uint32

import numpy as np
import pytest
from cases import LAWS, TARGETS, combinations
from cases import scene as scene_as_given
from fmpy.fmi1 import FMICallException
from fmu_resources import on_spring, on_structure, viscoelastic

import film_model as fm
import fmu_wrapper
from fmu_wrapper.comparisons import compared_slopes
from fmu_wrapper.instance import opened, started
from fmu_wrapper.resource import start_values
from fmu_wrapper.variables import NORMAL_STATES as STATES
from fmu_wrapper.variables import OF_FRICTION, VARIABLES, reference

VERSIONS = pytest.mark.parametrize("version", [2, 3])
PATHS = {
    "mass": "impactor.mass",
    "initial_velocity": "impactor.velocity",
    "radius": "impactor.radius",
    "yield_strength": "target.material.yield_strength",
}
"""Parameters of the FMU and the same numbers in a scene."""

OUTPUTS = tuple(
    v.name for v in VARIABLES if v.causality.get("impact") == "output" and v.variability == "continuous" and not v.group
)
RATES = tuple(f"rate_of_{state}" for state in STATES)


def scene(*arguments, **options):
    return fmu_wrapper.served(scene_as_given(*arguments, **options))


def derivative(slave, of, by):
    return slave.instance.getDirectionalDerivative([reference(of)], [reference(by)], [1.0])[0]


def refusal(slave, of, by):
    """What the FMU says."""
    with pytest.raises(FMICallException):
        derivative(slave, of, by)
    return slave.fmu.messages.pop()


def stop_of(fmu):
    return float(fmu.description.defaultExperiment.stopTime)


# ---------------------------------------------------------------- by states and inputs, right after events


class Integration:
    """A Model Exchange instance followed by the classical Runge-Kutta method, which stops right after each event."""

    def __init__(self, slave, step):
        self.slave, self.step, self.time = slave, step, 0.0
        values = (c_double * len(STATES))()
        slave.instance.getContinuousStates(values, len(STATES))
        self.x = np.array(values)

    def put(self, time, x):
        self.slave.instance.setTime(time)
        self.slave.instance.setContinuousStates((c_double * len(STATES))(*x), len(STATES))

    def rates(self, time, x):
        self.put(time, x)
        return np.array(list(self.slave.get(RATES).values()))

    def ahead(self, h):
        k1 = self.rates(self.time, self.x)
        k2 = self.rates(self.time + h / 2, self.x + h / 2 * k1)
        k3 = self.rates(self.time + h / 2, self.x + h / 2 * k2)
        k4 = self.rates(self.time + h, self.x + h * k3)
        return self.x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)

    def due(self, h):
        self.put(self.time + h, self.ahead(h))
        return min(self.slave.indicators(5)) <= 0.0

    def to_event(self):
        """Go past the next event and handle it; its name."""
        while not self.due(self.step):
            self.x, self.time = self.ahead(self.step), self.time + self.step
            self.slave.instance.completedIntegratorStep()
        low, high = 0.0, self.step
        for _ in range(45):
            middle = (low + high) / 2
            low, high = (low, middle) if self.due(middle) else (middle, high)
        self.x, self.time = self.ahead(high), self.time + high
        self.put(self.time, self.x)
        self.slave.instance.enterEventMode()
        self.slave.handle()
        return fm.core.native.EVENTS[int(self.slave.get(("last_event",))["last_event"])]


@combinations(law=["big-alabo", "hertz", "stronge", "tsuji", "linear-dashpot"], version=[3, 2], fast=1)
def test_right_after_an_event_derivatives_are_those_of_what_follows(made, law, version):
    """Against differences on the side where the motion goes on."""
    unknowns = (*OUTPUTS, *RATES)
    with opened(made(scene(law, "plate"), version, initial_gap="1 um")) as fmu, started(fmu, False, {}, True) as slave:
        motion, seen = Integration(slave, stop_of(fmu) / 800), []
        size = dict(zip(STATES, fmu.data.nominal[:3], strict=True))
        while "contact_ends" not in seen:
            seen.append(motion.to_event())
            x, way = motion.x.copy(), math.copysign(1.0, slave.get(("relative_velocity",))["relative_velocity"])
            if seen[-1] in ("contact_begins", "stage_changes"):
                x[0] += 0.01 * size["indentation"]  # where a stage begins its force may be a power with any root
            for k, state in enumerate(STATES):
                h = 1e-4 * size[state] * (way if state == "indentation" else 1.0)
                values = []
                for steps in range(5):
                    moved = x.copy()
                    moved[k] += h * steps
                    motion.put(motion.time, moved)
                    values.append(np.array(list(slave.get(unknowns).values())))
                motion.put(motion.time, x)
                slope = np.array([derivative(slave, of, state) for of in unknowns])
                differences = np.array([-25, 48, -36, 16, -3]) @ np.array(values) / (12 * h)
                rounding = 1e-15 * np.abs(values).max(axis=0) / abs(h)
                assert np.all(np.abs(slope - differences) <= 1e-6 * np.abs(slope) + 100 * rounding), (seen, state)
            motion.put(motion.time, motion.x)
        assert {"contact_begins", "maximum_indentation", "contact_ends"} <= set(seen)
        assert derivative(slave, "contact_force", "indentation") == 0.0
        assert ("stage_changes" in seen) == (law in ("big-alabo", "stronge"))


@combinations(target=["plate", "structure", "spring", "viscoelastic"], law=["big-alabo", "hunt-crossley"], fast=1)
def test_by_inputs_right_after_an_event(made, target, law):
    """In Co-Simulation with event mode: before the event is handled, and after it."""
    if target in ("spring", "viscoelastic") and law == "hunt-crossley":
        pytest.skip("such targets have no damped law")
    special = {"structure": lambda: on_structure(law), "spring": lambda: on_spring(law), "viscoelastic": viscoelastic}
    on = special[target]() if target in special else scene(law, target)
    with opened(made(on, initial_gap="1 um")) as fmu, started(fmu, True, {}) as slave:
        time, seen, step = 0.0, [], stop_of(fmu) / 100
        while "contact_ends" not in seen:
            time, event = slave.step(time, step)
            if not event:
                continue
            slave.instance.enterEventMode()
            for handled in (False, True):
                if handled:
                    slave.handle()
                for known, h in (("external_force", 1.0), ("support_velocity", 1e-5)):
                    given = slave.get((known,))[known]
                    values = []
                    for sign in (-1, 1):
                        slave.set(known, given + sign * h)
                        values.append(np.array(list(slave.get(OUTPUTS).values())))
                    slave.set(known, given)
                    slope = np.array([derivative(slave, of, known) for of in OUTPUTS])
                    assert slope == pytest.approx((values[1] - values[0]) / (2 * h), rel=1e-6, abs=1e-9), (seen, known)
            seen.append(fm.core.native.EVENTS[int(slave.get(("last_event",))["last_event"])])
        assert len(seen) >= 4


@combinations(version=[2, 3], exchange=[False, True], fast=1)
def test_what_happened_does_not_depend_on_inputs_and_states_of_now(made, version, exchange):
    """FMI has the discrete outputs among the unknowns of Step Mode and Event Mode."""
    real = [v for v in VARIABLES if v.type == "Real" and v.variability == "discrete"]
    discrete = [v.name for v in real if v.name not in OF_FRICTION]
    with opened(made(scene("big-alabo", "plate"), version)) as fmu, started(fmu, False, {}, exchange) as slave:
        if not exchange:
            slave.step(0.0, stop_of(fmu))
        knowns = [reference(name) for name in ("external_force", "support_velocity", *STATES)]
        unknowns = [reference(name) for name in discrete]
        found = slave.instance.getDirectionalDerivative(unknowns, knowns, [1.0] * len(knowns))
        assert found == [0.0] * len(discrete)


# ---------------------------------------------------------------- by parameters


@pytest.mark.slow
@combinations(law=sorted(LAWS), target=["half-space", "plate"], fraction=[0.3, 1.0], version=[2, 3], fast=2)
def test_by_parameters_of_what_an_impact_left(made, law, target, fraction, version):
    """In contact and after it: against differences of runs with other parameters."""
    with opened(made(scene(law, target), version, initial_gap="1 um")) as fmu:
        findings = list(compared_slopes(fmu, fraction * stop_of(fmu)))
    assert len(findings) >= 4
    assert [f for f in findings if not f.good] == []


@combinations(law=["hertz", "big-alabo", "jackson-green"], target=["half-space", "plate"], fast=1)
def test_they_are_the_derivatives_of_the_library(made, law, target):
    """Of `simulate`, whose meshes are refined; the FMU has those for an accuracy of 1e-9."""
    contact = fm.Contact(law=law)
    on = fm.Scene(
        scene_as_given("hertz").impactor, TARGETS[target], contact, fm.Effects(gravity=False), fm.Solver(accuracy=1e-9)
    )
    on = fmu_wrapper.served(on)
    of = ("maximum_force", "maximum_indentation", "rebound_velocity", "permanent_indentation")
    with opened(made(on)) as fmu, started(fmu, False, {}) as slave:
        slave.step(0.0, stop_of(fmu))
        paths = {name: path for name, path in PATHS.items() if name in start_values(fmu.data)}
        known = fm.simulate(on, derivatives=list(paths.values())).derivatives.values
        summary = slave.get(of)
        for name, path in paths.items():
            number = start_values(fmu.data)[name]
            for output in of:
                ours = derivative(slave, output, name)
                assert abs(ours - known[output][path]) <= 1e-7 * max(abs(ours), abs(summary[output] / number)), (
                    name,
                    output,
                )


def test_after_many_bounces(made):
    """Of the latest contact of several."""
    on = fmu_wrapper.served(scene_as_given("hertz", velocity=0.05).replace({"effects.gravity": True}))
    with opened(made(on, initial_gap="0.05 mm")) as fmu, started(fmu, False, {}) as slave:
        slave.step(0.0, 0.04)
        left = slave.get(("contact_count", "time_contact_begins"))
        assert left["contact_count"] >= 3
        h, runs = 1e-5, []
        for velocity in (0.05 - h, 0.05 + h):
            with started(fmu, False, {"initial_velocity": velocity}) as other:
                other.step(0.0, 0.04)
                runs.append(other.get(("time_contact_begins", "maximum_force")))
        for name in ("time_contact_begins", "maximum_force"):
            differences = (runs[1][name] - runs[0][name]) / (2 * h)
            assert derivative(slave, name, "initial_velocity") == pytest.approx(differences, rel=1e-5)


@combinations(kind=["impact", "contact"], law=["hertz", "tsuji"], version=[2, 3], exchange=[False, True], fast=2)
def test_by_parameters_at_the_start(made, kind, law, version, exchange):
    """In Initialization Mode: of every output that the description lists there, by every parameter and input."""
    with opened(made(scene(law, "plate"), version, kind=kind, initial_gap="1 um" if kind == "impact" else 0.0)) as fmu:
        from fmu_wrapper.instance import Slave

        slave = Slave(fmu, False, exchange)
        if version == 2:
            slave.instance.setupExperiment(startTime=0.0)
            slave.instance.enterInitializationMode()
        else:
            slave.instance.enterInitializationMode(startTime=0.0)
        if kind == "contact":
            slave.set("indentation", 4e-6)
            slave.set("relative_velocity", 0.1)
        chosen = [v for v in VARIABLES if v.type == "Real" and kind in v.causality and v.name not in OF_FRICTION]
        outputs = [
            v.name for v in chosen if v.causality[kind] == "output" or (v.rate_of and v.causality[kind] == "local")
        ]
        knowns = [
            v.name for v in chosen if v.name in start_values(fmu.data) and v.causality[kind] in ("parameter", "input")
        ]
        assert len(knowns) >= 4
        for known in knowns:
            value = slave.get((known,))[known]
            h = 1e-4 * abs(value) if value else 1e-6
            rows = []
            for moved in (value - h, value + h):
                slave.set(known, moved)
                rows.append(np.array(list(slave.get(outputs).values())))
            slave.set(known, value)
            slope = np.array([derivative(slave, of, known) for of in outputs])
            rounding = 1e-15 * np.abs(rows).max(axis=0) / h
            assert np.all(abs(slope - (rows[1] - rows[0]) / (2 * h)) <= 1e-6 * abs(slope) + 10 * rounding), known
        slave.instance.exitInitializationMode()
        slave.instance.freeInstance()


def test_a_kink_has_no_derivative_by_a_parameter(made):
    """Where the impact just yields; not at another velocity."""
    with opened(made(scene("big-alabo", "plate"))) as fmu:

        def dent(velocity):
            with started(fmu, False, {"initial_velocity": velocity}) as slave:
                slave.step(0.0, 10 * stop_of(fmu))
                try:
                    slope = derivative(slave, "permanent_indentation", "initial_velocity")
                except FMICallException:
                    slope = slave.fmu.messages.pop()
                return slave.get(("permanent_indentation",))["permanent_indentation"], slope

        low, high = 1e-3, 0.25
        assert dent(low) == (0.0, 0.0) and dent(high)[1] > 0.0
        for _ in range(25):
            middle = (low + high) / 2
            low, high = (low, middle) if dent(middle)[0] > 0.0 else (middle, high)
        assert dent(0.99 * low)[1] == 0.0 and dent(1.2 * high)[1] > 0.0
        for velocity in (low, high):
            assert re.search(
                "no derivative by initial_velocity: other events happen within 0.2 % of", dent(velocity)[1]
            )


@combinations(exchange=[False, True], fast=1)
def test_adjoint_derivatives_are_the_transposed_ones(made, exchange):
    knowns = [
        "external_force",
        "support_velocity",
        *STATES,
        *(() if exchange else ("mass", "initial_velocity", "radius")),
    ]
    with opened(made(scene("big-alabo", "plate"))) as fmu, started(fmu, False, {}, exchange) as slave:
        if not exchange:
            slave.step(0.0, 0.5 * stop_of(fmu))
        unknowns = ["maximum_force", "contact_impulse", *(() if not exchange else OUTPUTS)]
        rows, columns = ([reference(name) for name in names] for names in (unknowns, knowns))
        unit = np.eye(len(knowns)).tolist()
        jacobian = np.array([slave.instance.getDirectionalDerivative(rows, columns, seed) for seed in unit]).T
        for row, seed in zip(jacobian, np.eye(len(unknowns)).tolist(), strict=True):
            assert slave.instance.getAdjointDerivative(rows, columns, seed, len(knowns)) == row.tolist()
        seed = np.linspace(-1.0, 2.0, len(knowns)).tolist()
        forward = slave.instance.getDirectionalDerivative(rows, columns, seed)
        assert forward == pytest.approx(jacobian @ seed, rel=1e-13)
        assert jacobian.any()


def test_the_library_and_the_description_name_the_same_dependencies(made):
    """FMI 3.0: discrete outputs depend on parameters."""
    with opened(made(scene("big-alabo", "plate"))) as fmu, started(fmu, False, {}) as slave:
        for output in fmu.description.outputs:
            listed = [v.valueReference for v in output.dependencies]
            if output.variable.type != "Float64":
                continue
            count = c_size_t()
            here = slave.instance.component, output.variable.valueReference
            slave.instance.fmi3GetNumberOfVariableDependencies(*here, byref(count))
            assert count.value == len(listed)
            elements, of = (c_size_t * count.value)(), (c_size_t * count.value)()
            independents, kinds = (c_uint32 * count.value)(), (c_int * count.value)()
            slave.instance.fmi3GetVariableDependencies(*here, elements, independents, of, kinds, count)
            assert list(independents) == listed


def test_what_has_no_derivative_is_refused_in_a_sentence(made):
    on = scene("big-alabo", "plate")
    with opened(made(on)) as fmu:
        with started(fmu, False, {}) as slave:
            slave.step(0.0, stop_of(fmu))
            for of, by, said in (
                (
                    "mean_contact_force",
                    "mass",
                    "mean_contact_force has no derivative by the parameter mass after Initialization Mode",
                ),
                ("maximum_force", "loading_segments", "loading_segments, which is a whole number"),
                ("maximum_force", "hardness", "hardness is neither an input, a state nor a parameter"),
                ("maximum_force", "time", "time is neither an input, a state nor a parameter"),
                ("phase", "external_force", "phase is not a real output"),
                ("mass", "external_force", "mass is not a real output"),
            ):
                assert said in refusal(slave, of, by)
            slave.set("external_force", 5.0)
            assert derivative(slave, "maximum_force", "mass") > 0.0
            slave.step(stop_of(fmu), 1e-6)
            assert "while inputs and tunable parameters are those of the start" in refusal(
                slave, "maximum_force", "mass"
            )
        with started(fmu, False, {}, True) as slave:
            assert "no derivative by the parameter mass after Initialization Mode" in refusal(
                slave, "maximum_force", "mass"
            )
    with opened(made(on, kind="contact")) as fmu, started(fmu, False, {}) as slave:
        assert "of a contact in Co-Simulation it is known in Initialization Mode only" in refusal(
            slave, "contact_force", "radius"
        )
    with opened(made(on_structure("hertz"))) as fmu, started(fmu, False, {}) as slave:
        assert "on a target that vibrates it is known in Initialization Mode only" in refusal(
            slave, "maximum_force", "mass"
        )
