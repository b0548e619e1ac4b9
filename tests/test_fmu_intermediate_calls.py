"""Calls of intermediate updates of FMI 3.0: when they come, what they may do, and that they leave the motion alone."""

import contextlib
import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest
from fmpy.fmi1 import FMICallException
from fmu_resources import CASES, SENSORS, on_structure
from intermediate import MOTION, PARTS, slave_of, updated
from test_fmu_intermediate import INPUTS, driven
from test_fmu_time_derivatives import FINE, hertz

import film_model as fm
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import reference

LEFT = ("maximum_force", "contact_count", "rebound_velocity", "mean_contact_force", "contact_impulse", "external_work")


def nothing(*_):
    """An importer that sets and gets nothing."""


# ---------------------------------------------------------------- when the importer is called


def test_the_importer_is_called_at_parts_and_events(made):
    on, calls = hertz(), []
    duration = fm.simulate(on).duration

    def importer(_, time, may_set, may_get, finished, can_return):
        calls.append((time, may_set, may_get, finished, can_return))

    with opened(made(on, initial_gap="1 um")) as fmu:
        gap = 1e-6 / on.approach_velocity
        size = 2.0 * (gap + duration)
        ends = [size * k / PARTS for k in range(1, PARTS + 1)]
        for required, sets in ((("contact_force",), False), (INPUTS, True)):
            calls.clear()
            with updated(fmu, importer, required, FINE) as slave:
                slave.do_step(0.0, size)
            asked, shown = [c for c in calls if c[1]], [c for c in calls if not c[1]]
            assert sorted({c[0] for c in asked}) == (ends if sets else [])
            assert {c[1:] for c in asked} <= {(True, False, False, False)}
            assert {c[1:] for c in shown} == {(False, True, True, False)}
            times = [c[0] for c in shown]
            assert times == sorted(times)
            inner = [time for time in times if time not in ends]
            assert inner == pytest.approx([gap, gap + 0.5 * duration, gap + 0.5 * duration, gap + duration], rel=1e-4)
            assert [time for time in times if time in ends] == ends[:-1]


@pytest.mark.parametrize(("update", "required"), [(nothing, ()), (None, ("contact_force",)), (None, ())])
def test_without_a_callback_or_variables_nothing_changes(made, update, required):
    on, results = hertz(), []
    size = fm.simulate(on).duration / 3.5
    for given in ((None, ()), (update, required)):
        with opened(made(on)) as fmu, updated(fmu, given[0], given[1]) as slave:
            for n in range(5):
                slave.do_step(n * size, size)
            results.append(slave.get((*MOTION, *LEFT)))
    assert results[0] == results[1] and results[0]["contact_count"] == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["big-alabo", "dropped", "friction", "vibrations", "viscoelastic, on a rod"])
def test_reading_leaves_the_motion_alone(made, name):
    _, on, gap = CASES[name]
    size, seen = fm.simulate(replace(on, effects=fm.Effects())).duration / 3.5, []

    def importer(slave, time, may_set, may_get, *_):
        assert may_get and not may_set
        seen.append((time, slave.get(MOTION)))

    with opened(made(on, initial_gap=gap)) as fmu:
        with updated(fmu, importer, MOTION) as slave:
            for n in range(12):
                slave.do_step(n * size, size)
            found = slave.get((*MOTION, *LEFT))
        with started(fmu, False, {}) as slave:
            for n in range(12):
                slave.step(n * size, size)
            expected = slave.get((*MOTION, *LEFT))
        with started(fmu, False, {}) as slave:
            time = 0.0
            for later, values in seen:
                slave.step(time, later - time)
                time = later
                for key, value in slave.get(MOTION).items():
                    assert values[key] == pytest.approx(value, rel=1e-8, abs=1e-6 if key == "contact_force" else 1e-12)
    assert len(seen) >= 12 * (PARTS - 1)
    for key, value in expected.items():
        assert found[key] == pytest.approx(value, rel=1e-8, abs=1e-12), key


def test_steps_are_repeated_to_the_last_bit(made):
    case = driven()
    size, names = case.end / 7, (*MOTION, *LEFT)
    with opened(made(case.on)) as fmu, updated(fmu, case.importer, INPUTS) as slave:
        for n in range(7):
            state = slave.save()
            slave.do_step(n * size, size)
            once = slave.get(names)
            slave.restore(state)
            slave.do_step(n * size, size)
            assert slave.get(names) == once


# ---------------------------------------------------------------- early return


def test_a_step_returns_early_where_the_importer_asks(made):
    on = hertz()
    size = 2.0 * fm.simulate(on).duration
    part = size / PARTS

    def at(point, end):
        return lambda _s, time, _set, may_get, _f, can_return: end if may_get and can_return and time >= point else None

    with opened(made(on)) as fmu:
        for point, end, reached in ((2 * part, 2 * part, 2 * part), (part, 2.4 * part, 2.4 * part), (part, 0.0, part)):
            with updated(fmu, at(point, end), MOTION, early_return=True) as slave:
                assert slave.do_step(0.0, size) == (False, True, pytest.approx(reached, rel=1e-15))
                found = slave.get(MOTION)
            with started(fmu, False, {}) as slave:
                slave.step(0.0, reached)
                for key, value in slave.get(MOTION).items():
                    assert found[key] == pytest.approx(value, rel=1e-9), key


def test_a_contact_returns_early_too(made):
    ends = iter([3e-6, None])

    def importer(_slave, _time, _set, _get, _finished, can_return):
        return next(ends) if can_return else None

    with (
        opened(made(hertz(), kind="contact")) as fmu,
        updated(fmu, importer, ("indentation", "contact_force"), early_return=True) as slave,
    ):
        assert slave.do_step(0.0, 8e-6) == (False, True, 3e-6)


@pytest.mark.parametrize("early_return", [True, False])
def test_event_mode_comes_before_or_after_updates(made, early_return):
    """With early return the step ends at the event; without, the event waits for the communication point."""
    on, times = hertz(), []
    size = 2.0 * fm.simulate(on).duration

    def importer(slave, time, _set, may_get, *_):
        times.append(time)
        if may_get:
            slave.get(("contact_force",))

    with (
        opened(made(on, initial_gap="1 um")) as fmu,
        updated(fmu, importer, ("contact_force",), event_mode=True, early_return=early_return) as slave,
    ):
        event, early, reached = slave.do_step(0.0, size)
        assert event and early == early_return
        assert reached == pytest.approx(1e-6 / on.approach_velocity if early_return else size)
        assert max(times, default=0.0) < reached
        assert slave.get(("contact_count",))["contact_count"] == 0.0
        slave.instance.enterEventMode()
        slave.handle()
        assert slave.get(("contact_count",))["contact_count"] == 1.0


# ---------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("end", "early_return", "sentence"),
    [
        (1e-6, False, "earlyReturnRequested is true, but canReturnEarly was false"),
        (9e-6, True, "earlyReturnTime 9.0000000000000002e-06 s must be from 0 s to"),
        (-1e-6, True, "must be from 0 s to"),
        (float("nan"), True, "must be from 0 s to"),
    ],
)
def test_an_early_return_elsewhere_is_an_error(made, end, early_return, sentence):
    def importer(_s, _t, _set, may_get, *_):
        return end if may_get else None

    with opened(made(hertz())) as fmu:
        with (
            updated(fmu, importer, ("contact_force",), early_return=early_return) as slave,
            pytest.raises(FMICallException),
        ):
            slave.do_step(0.0, 8e-6)
        assert sentence in fmu.messages[-1]


IN_UPDATE = "called in state Intermediate Update Mode; allowed in: "
REQUIRED = "must be in requiredIntermediateVariables to be "
EARLY = {
    "a parameter": (lambda s: s.set("gravity", 1.0), f"gravity {REQUIRED}set"),
    "an output": (lambda s: s.set("indentation", 1.0), "indentation is an output and cannot be set"),
    "another input": (lambda s: s.set("external_force", 1.0), f"external_force {REQUIRED}set"),
    "an output too early": (
        lambda s: s.get(("indentation",)),
        "indentation must not be read in this intermediate update: intermediateVariableGetAllowed is false",
    ),
    "a rate too early": (lambda s: s.rate("indentation"), "indentation must not be read"),
    "a discrete output": (lambda s: s.get(("phase",)), "phase must not be read"),
    "a step": (lambda s: s.instance.doStep(0.0, 1e-6), f"fmi3DoStep: {IN_UPDATE}Step Mode"),
    "a state": (lambda s: s.save(), f"fmi3GetFMUState: {IN_UPDATE}Instantiated"),
    "reset": (lambda s: s.instance.reset(), f"fmi3Reset: {IN_UPDATE}"),
    "terminate": (lambda s: s.instance.terminate(), f"fmi3Terminate: {IN_UPDATE}"),
    "free": (lambda s: s.instance.fmi3FreeInstance(s.instance.component), f"fmi3FreeInstance: {IN_UPDATE}"),
    "event mode": (lambda s: s.instance.enterEventMode(), f"fmi3EnterEventMode: {IN_UPDATE}Step Mode"),
    "derivatives": (
        lambda s: s.instance.getDirectionalDerivative([reference("contact_force")], [reference("mass")], [1.0]),
        f"fmi3GetDirectionalDerivative: {IN_UPDATE}",
    ),
}
"""Calls where inputs are asked for."""

LATE = {
    "an input too late": (
        lambda s: s.set("support_velocity", 1.0),
        "support_velocity must not be set in this intermediate update: intermediateVariableSetRequested is false",
    ),
    "another output": (lambda s: s.get(("contact_force",)), f"contact_force {REQUIRED}read"),
    "a later discrete output": (lambda s: s.get(("phase",)), f"phase {REQUIRED}read"),
    "another rate": (lambda s: s.rate("contact_force"), f"contact_force {REQUIRED}read"),
}
"""Calls where outputs are shown."""


@pytest.mark.slow
@pytest.mark.parametrize("name", [*EARLY, *LATE])
def test_other_calls_are_errors_after_which_the_step_goes_on(made, name):
    call, sentence = (EARLY | LATE)[name]
    on, said, results = hertz(), [], []
    size = fm.simulate(on).duration / 2

    def importer(slave, _time, may_set, *_):
        if may_set == (name in EARLY):
            with contextlib.suppress(FMICallException):
                call(slave)
            said.append(slave.fmu.messages[-1])

    with opened(made(on)) as fmu:
        for update in (importer, nothing):
            with updated(fmu, update, ("support_velocity", "indentation")) as slave:
                slave.do_step(0.0, size)
                results.append(slave.get(MOTION))
    assert len(said) >= PARTS - 1 and all(sentence in text for text in said), said[0]
    assert results[0] == results[1] and results[0]["contact_force"] > 0.0


# ---------------------------------------------------------------- model description


def instantiates(fmu, number):
    """Whether an importer may require the variable; the refusal names it."""
    slave = slave_of(fmu)
    try:
        slave.instantiate(
            logMessage=lambda _e, _s, category, text: fmu.log(category, text),
            intermediateUpdate=nothing,
            requiredIntermediateVariables=[number],
        )
    except Exception:
        assert f"requiredIntermediateVariables: the value reference {number} is not one of" in fmu.messages[-1]
        return False
    slave.freeInstance()
    return True


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["impact", "contact"])
def test_the_description_lists_what_the_binary_accepts(made, kind):
    on = on_structure("hertz", static_compliance="3e-6 m/N", sensors=SENSORS) if kind == "impact" else hertz()
    with opened(made(on, kind=kind)) as fmu:
        interface, variables = fmu.description.coSimulation, fmu.description.modelVariables
        assert interface.providesIntermediateUpdate and interface.mightReturnEarlyFromDoStep
        assert interface.canReturnEarlyAfterIntermediateUpdate
        root = ET.parse(f"{fmu.folder}/modelDescription.xml").getroot()
        marked = {int(v.get("valueReference")) for v in root.iter("Float64") if v.get("intermediateUpdate") == "true"}
        continuous = {
            v.valueReference for v in variables if v.variability == "continuous" and v.causality in ("input", "output")
        }
        assert marked == continuous
        assert len(marked) == (3 if kind == "contact" else 17)
        numbers = {v.valueReference for v in variables} | {200, 2**32 - 1}
        assert {number for number in numbers if instantiates(fmu, number)} == marked
