"""Damped laws in FMUs: damping follows parameters set after export; Model Exchange agrees with Co-Simulation."""

import ctypes
import html
import math
import random
import zipfile
from dataclasses import dataclass, replace
from typing import ClassVar
from xml.etree import ElementTree

import numpy as np
import pytest
from cases import DAMPED, LAWS, MASS, combinations, scene

import film_model as fm
import fmu_wrapper
from film_model.laws.law import Parameter
from fmu_wrapper import resource
from fmu_wrapper.instance import opened, started
from fmu_wrapper.variables import reference

VERSIONS = pytest.mark.parametrize("version", [2, 3])
BALL = {"radius": "10 mm", "mass": "60.74 g", "velocity": "0.25 m/s", "material": "WC, Big-Alabo 2017"}
CONTACTS = {
    "linear-dashpot of a restitution": {"law": "linear-dashpot", "stiffness": "40 MN/m", "restitution": 0.7},
    "linear-dashpot": {"law": "linear-dashpot", "stiffness": "40 MN/m", "damping": "300 N*s/m"},
    "tsuji": {"law": "tsuji", "restitution": 0.6},
    "hunt-crossley of a restitution": {"law": "hunt-crossley", "restitution": 0.6},
    "hunt-crossley": {"law": "hunt-crossley", "hysteresis_damping": "2 s/m"},
    "kuwabara-kono": {"law": "kuwabara-kono", "dissipation_time": "3 us"},
}
CHANGES = {
    "mass": ("0.02 kg", {"impactor.mass": "0.02 kg"}),
    "initial_velocity": ("0.6 m/s", {"impactor.velocity": "0.6 m/s"}),
    "radius": ("3 mm", {"impactor.radius": "3 mm"}),
    "effective_modulus": ("90 GPa", {"contact.effective_modulus": "90 GPa"}),
}


def entry(name, target="half-space", **impactor):
    """A scene with a named law and its parameters, which Scene.replace can change."""
    body = fm.Sphere(**{**BALL, **impactor})
    targets, effects = scene("hertz", target).target, fm.Effects(gravity=False)
    return fm.Scene(body, targets, fm.Contact(**CONTACTS[name]), effects, solver=fm.Solver(segments=40))


def loaded(name):
    """Without gravity, so that the external force is the only load."""
    return replace(scene(name), effects=fm.Effects(gravity=False))


# ---------------------------------------------------------------- what is set after export


@pytest.mark.slow
@combinations(name=CONTACTS, change=CHANGES)
def test_damping_follows_what_is_set_after_export(made, name, change):
    before, (value, changed) = entry(name), CHANGES[change]
    if change in ("radius", "effective_modulus") and name.startswith("linear"):
        with pytest.raises(ValueError, match=f"no parameter '{change}'"):
            fmu_wrapper.run(made(before), start_values={change: value})
        return
    history = fm.simulate(before.replace(changed))
    ds = fmu_wrapper.run(made(before), start_values={change: value}, stop_time="1 ms", step_size="1 ms")
    for key in ("maximum_force", "maximum_indentation", "contact_duration", "rebound_velocity"):
        assert float(ds[key]) == pytest.approx(history.summary[key], rel=1e-12), key
    assert float(ds.permanent_indentation) == 0.0
    unchanged = fm.simulate(before).summary["coefficient_of_restitution"]
    after = float(ds.coefficient_of_restitution)
    same = {"linear-dashpot": ("initial_velocity",), "hunt-crossley": ("mass", "radius", "effective_modulus")}
    if change in same.get(name, CHANGES if "restitution" in CONTACTS[name] else ()):
        assert after == pytest.approx(unchanged, rel=3e-6)  # the error of the segments
    else:
        assert abs(after - unchanged) > 1e-3


GIVEN = [name for name in CONTACTS if "restitution" in CONTACTS[name]]


@pytest.mark.slow
@combinations(name=GIVEN, exported=[0.6, 1.0, 0.02], restitution=[0.01, 0.35, 0.9, 1.0], version=[2, 3], fast=8)
def test_the_restitution_can_be_set_after_export(made, name, exported, restitution, version):
    before = entry(name, "plate").replace({"contact.restitution": exported})
    changed = {"contact.restitution": restitution, "impactor.velocity": "0.4 m/s", "impactor.mass": "0.05 kg"}
    summary = fm.simulate(before.replace(changed)).summary
    values = {"restitution": restitution, "initial_velocity": "0.4 m/s", "mass": "0.05 kg"}
    ds = fmu_wrapper.run(made(before, version), start_values=values, stop_time="2 ms", step_size="1 ms")
    for key in ("maximum_force", "contact_duration", "rebound_velocity", "coefficient_of_restitution"):
        assert float(ds[key]) == pytest.approx(summary[key], rel=1e-10), key


@pytest.mark.slow
@combinations(name=GIVEN, version=[2, 3], fast=1)
def test_the_restitution_of_a_contact_and_of_model_exchange(made, name, version):
    forces = []
    for exported in (0.6, 0.35):
        path = made(entry(name).replace({"contact.restitution": exported}), version, kind="contact")
        with opened(path) as fmu, started(fmu, False, {"restitution": 0.35}) as slave:
            slave.set("indentation", 5e-6)
            slave.set("relative_velocity", 0.1)
            forces.append(slave.get(("contact_force",))["contact_force"])
    assert forces[0] == pytest.approx(forces[1], rel=1e-10)
    on = entry(name)
    ds = fmu_wrapper.run(made(on, version), mode="exchange", start_values={"restitution": 0.35})
    assert float(ds.coefficient_of_restitution) == pytest.approx(0.35, rel=1e-6)
    with pytest.raises((ValueError, fm.SimulationError), match=r"restitution: .*from 0.01 to 1"):
        fmu_wrapper.run(made(on, version), start_values={"restitution": 0.005})


@pytest.mark.slow
@combinations(name=CONTACTS, fast=3)
def test_mass_velocity_radius_and_modulus_set_together_on_a_plate(made, name):
    """Mass, velocity, radius and modulus of another scene, on a moving target."""
    before, rng = entry(name, "plate"), random.Random(name)
    sphere = not name.startswith("linear")
    for _ in range(3):
        mass, speed, radius, modulus = (
            f"{start * rng.uniform(0.5, 2.0)!r} {unit}"
            for start, unit in ((MASS, "kg"), (0.25, "m/s"), (0.01, "m"), (165e9, "Pa"))
        )
        changed = {"impactor.mass": mass, "impactor.velocity": speed}
        values = {"mass": mass, "initial_velocity": speed}
        if sphere:
            changed |= {"impactor.radius": radius, "contact.effective_modulus": modulus}
            values |= {"radius": radius, "effective_modulus": modulus}
        summary = fm.simulate(before.replace(changed)).summary
        ds = fmu_wrapper.run(made(before), start_values=values, stop_time="2 ms", step_size="1 ms")
        for key in ("maximum_force", "contact_duration", "rebound_velocity", "coefficient_of_restitution"):
            assert float(ds[key]) == pytest.approx(summary[key], rel=1e-12), key


@pytest.mark.slow
def test_restitution_is_relative_to_the_velocity_before_first_touch(made):
    """A dashpot's force jumps at first touch and moves a rod's end at once: the approach velocity is that before it."""
    on = fmu_wrapper.served(scene("linear-dashpot", "rod"))
    history = fm.simulate(on)
    for mode in ("steps", "events", "exchange"):
        ds = fmu_wrapper.run(made(on), mode=mode)
        assert float(ds.coefficient_of_restitution) == pytest.approx(
            history.summary["coefficient_of_restitution"], rel=1e-7
        )
        assert float(ds.event_contact_force[0]) > 0.1 * history.summary["maximum_force"]


@pytest.mark.slow
@VERSIONS
def test_a_restitution_needs_a_positive_approach_velocity(made, version):
    path = made(entry("hunt-crossley of a restitution"), version, initial_gap="1 um")
    for speed in (0.0, -0.1):
        with pytest.raises(fm.SimulationError, match="initial_velocity must be > 0 m/s if"):
            fmu_wrapper.run(path, start_values={"initial_velocity": speed})
    away = fmu_wrapper.run(made(entry("hunt-crossley"), version), start_values={"initial_velocity": -0.1})
    assert away.event.size == 0


@dataclass(frozen=True)
class Sums(fm.AbstractLaw):
    """A custom law: a fitted spring, and a damping factor that is no power of mass or velocity."""

    name: ClassVar[str] = "sums"
    summary: ClassVar[str] = "test law"
    source: ClassVar[str] = "tests"
    parameters: ClassVar[dict[str, Parameter]] = {}
    damped: ClassVar[bool] = True

    stiffness: float = 4e7

    def scales(self, energy):
        return 1e-5, 1e-5 * self.stiffness

    def stages(self):
        spring, dashpot = (lambda x: x * (1.0 + 0.1 * np.tanh(x))), (lambda x: 1.0 + 0.2 * np.exp(-x))
        return (fm.Stage("spring", 0.0, 40.0, spring, damping=dashpot),)

    def damping_factor(self, mass, velocity, length):
        return 100.0 + 2e3 * mass + 200.0 * velocity


@pytest.mark.slow
@combinations(version=[2, 3], fast=1)
def test_parameters_without_a_power_law_in_damping_cannot_be_set(made, version):
    on = fm.Scene(fm.Sphere(**BALL), fm.HalfSpace(), fm.Contact(Sums()), fm.Effects(gravity=False))
    path, history = made(on, version), fm.simulate(on, accuracy=1e-9)
    report = fmu_wrapper.check(path, on)
    assert report.good, [finding for finding in report.findings if not finding.good]
    for mode in ("steps", "exchange"):
        ds = fmu_wrapper.run(path, mode=mode)
        assert float(ds.rebound_velocity) == pytest.approx(history.summary["rebound_velocity"], rel=1e-5)
    for name in ("mass", "initial_velocity"):
        with pytest.raises(ValueError, match=f"no parameter '{name}'; it has initial_gap, stiffness, target_impedance"):
            fmu_wrapper.run(path, start_values={name: 1.0})
    with opened(path) as fmu:
        assert resource.start_values(fmu.data).keys().isdisjoint({"mass", "initial_velocity"})
        setting = started(fmu, False, {"mass": 1.0})
        with pytest.raises(fm.SimulationError, match="mass: this FMU does not have it"), setting:
            pass


# ---------------------------------------------------------------- integrators of the true law


@pytest.mark.slow
@combinations(name=DAMPED, load=[-200.0, 300.0, 3000.0])
def test_model_exchange_under_a_force_has_the_same_events(made, name, load):
    """The largest force, which occurs between events, agrees too."""
    on = loaded(name)
    stop = 4e-4
    path = made(on)
    options = {"inputs": {"external_force": load}, "stop_time": stop, "step_size": 2e-6}
    fine = {"loading_segments": 300, "unloading_segments": 600}
    lined = fmu_wrapper.run(path, start_values=fine, **options)
    integrated = fmu_wrapper.run(path, mode="exchange", **options)
    count = min(lined.event.size, integrated.event.size, 12)
    assert count >= 4
    assert lined.event_kind.values[:count].tolist() == integrated.event_kind.values[:count].tolist()
    once, twice = ((ds.event_time.values[:4], ds.event_time.values[4:count]) for ds in (lined, integrated))
    assert twice[0] == pytest.approx(once[0], rel=1e-5, abs=1e-9)
    assert twice[1] == pytest.approx(once[1], rel=1e-3)  # creeping: the time of the turn is sensitive to errors
    assert float(integrated.maximum_force) == pytest.approx(float(lined.maximum_force), rel=1e-6)
    assert float(lined.contact_force.min()) >= 0.0
    assert float(integrated.contact_force.min()) >= -1e-8 * float(lined.maximum_force)
    until = float(lined.event_time.values[count - 1])
    times = np.linspace(0.0, until, 50)
    for key in ("indentation", "impactor_velocity"):
        one, two = (np.interp(times, ds.t.values, ds[key].values) for ds in (lined, integrated))
        assert one == pytest.approx(two, abs=3e-3 * float(np.abs(one).max())), key


@pytest.mark.slow
@VERSIONS
@pytest.mark.parametrize(("name", "load"), [("tsuji", 280.0), ("kuwabara-kono", 457.12)])
def test_a_contact_resumes_within_its_dent_after_its_force_was_zero(made, name, load, version):
    """A load slows the rebounding ball so much that the contact force is positive again before the ball reverses."""
    options = {"inputs": {"external_force": load}, "stop_time": 2e-4, "step_size": 1e-6}
    fine = {"loading_segments": 300, "unloading_segments": 600}
    names = ["contact_begins", "maximum_indentation", "impactor_stops", "contact_ends", "contact_begins"]
    found = []
    for mode, starts in (("steps", fine), ("exchange", {})):
        ds = fmu_wrapper.run(made(loaded(name), version), mode=mode, start_values=starts, **options)
        assert [fm.core.native.EVENTS[kind] for kind in ds.event_kind.values.tolist()][:5] == names
        ends, again = (ds.isel(event=k) for k in (3, 4))
        assert 0.0 < float(again.event_indentation) < float(ends.event_indentation)
        assert float(again.event_relative_velocity) < 0.0
        assert abs(float(again.event_contact_force)) < 1e-6 * float(ds.maximum_force)
        between = ds.contact_force.values[(ds.t > ends.event_time) & (ds.t < again.event_time)]
        assert between.size >= 2 and (between == 0.0).all()
        found.append([float(again.event_time), float(again.event_indentation), float(again.event_relative_velocity)])
    assert found[0] == pytest.approx(found[1], rel=1e-4)


@pytest.mark.slow
@combinations(name=DAMPED, version=[2, 3])
def test_model_exchange_remembers_the_force_before_an_input_jumps(made, name, version):
    """The importer changes the support velocity in Event Mode: most of the damping force vanishes."""
    from fmpy.fmi2 import FMU2Model
    from fmpy.fmi3 import FMU3Model

    with opened(made(loaded(name), version)) as fmu:
        identity = {"guid": fmu.description.guid, "unzipDirectory": fmu.folder}
        own = (FMU2Model if version == 2 else FMU3Model)(modelIdentifier="impact", instanceName="impact", **identity)
        get, put = (own.getReal, own.setReal) if version == 2 else (own.getFloat64, own.setFloat64)
        update = own.newDiscreteStates if version == 2 else own.updateDiscreteStates
        own.instantiate()
        if version == 2:
            own.setupExperiment(startTime=0.0)
        own.enterInitializationMode()
        own.exitInitializationMode()
        update()
        own.enterContinuousTimeMode()
        own.setTime(1e-5)
        own.setContinuousStates((ctypes.c_double * 3)(2e-6, 0.2, 0.0), 3)
        (force,) = get([reference("contact_force")])
        own.enterEventMode()
        put([reference("support_velocity")], [0.25])
        update()
        own.enterContinuousTimeMode()
        told = get([reference("maximum_indentation"), reference("maximum_force")])
        own.terminate()
        own.freeInstance()
    assert force > 0.0 and told == pytest.approx([2e-6, force], rel=1e-12)


@pytest.mark.slow
@combinations(name=["linear-dashpot", "kuwabara-kono"], version=[2, 3])
def test_a_ball_comes_to_rest_in_every_interface(made, version, name):
    """A falling ball bounces ever lower until its weight keeps the contact closed."""
    on = replace(scene(name), effects=fm.Effects(gravity=True))
    component = fm.ImpactComponent(on, initial_gap="5 um")
    path = made(on, version, initial_gap="5 um")
    stop = 0.1
    expected = component.step(stop)
    for mode in ("steps", "exchange"):
        ds = fmu_wrapper.run(path, mode=mode, stop_time=stop, step_size=stop / 5)
        names = [fm.core.native.EVENTS[kind] for kind in ds.event_kind.values.tolist()]
        ours = [event.name for event in expected.events]
        count = min(len(names), len(ours), 20)
        assert names[:count] == ours[:count]
        touch = -float(ds.t[0])
        for at, event in zip(ds.event_time.values[:count].tolist(), expected.events, strict=False):
            assert at + touch == pytest.approx(event.time, rel=1e-12 if mode == "steps" else 1e-5)
        assert float(ds.event_impactor_velocity[-1]) < 0.25


@pytest.mark.slow
@combinations(name=DAMPED, version=[2, 3])
def test_directional_derivatives_by_velocity(made, name, version):
    """Of the force and of what follows from it, by finite differences in Model Exchange's functions: tests/fmu_check.c.
    Here: kind contact, at rates with a positive force and at one where the force would be tensile."""
    with opened(made(scene(name), version, kind="contact")) as fmu, started(fmu, False, {}) as slave:
        derive = slave.instance.getDirectionalDerivative

        def force(depth, rate):
            slave.set("indentation", depth)
            slave.set("relative_velocity", rate)
            return slave.get(("contact_force",))["contact_force"]

        for depth, rate in ((2e-6, 0.2), (8e-6, 0.05), (5e-6, -0.02)):
            h, g = 1e-5 * depth, 1e-5
            at = force(depth, rate)
            slopes = [
                derive([reference("contact_force")], [reference(of)], [1.0])[0]
                for of in ("indentation", "relative_velocity")
            ]
            by_depth = (force(depth + h, rate) - force(depth - h, rate)) / (2 * h)
            by_rate = (force(depth, rate + g) - force(depth, rate - g)) / (2 * g)
            assert at > 0.0 and slopes == pytest.approx([by_depth, by_rate], rel=1e-6)
        assert force(5e-6, -100.0) == 0.0
        assert derive([reference("contact_force")], [reference("relative_velocity")], [1.0])[0] == 0.0


@pytest.mark.slow
@combinations(name=DAMPED, target=["half-space", "plate"], version=[2, 3])
def test_the_force_follows_the_support_velocity_before_the_step(made, name, target, version):
    """For importers that iterate between FMUs at one time: the force and its derivatives use the same inputs."""
    names = ("contact_force", "impactor_acceleration", "relative_velocity", "target_velocity")
    on = replace(scene(name, target), effects=fm.Effects(gravity=False))
    with opened(made(on, version)) as fmu, started(fmu, False, {}) as slave:
        slave.step(0.0, 2e-5)
        forces = []
        for support in (0.02 - 1e-4, 0.02, 0.02 + 1e-4):
            slave.set("support_velocity", support)
            forces.append(slave.get(names)["contact_force"])
        slave.set("support_velocity", 0.02)
        unknown, known = reference("contact_force"), reference("support_velocity")
        slope = slave.instance.getDirectionalDerivative([unknown], [known], [1.0])[0]
        assert slope < 0.0 and (forces[2] - forces[0]) / 2e-4 == pytest.approx(slope, rel=1e-6)
        heard = slave.get(names)
        slave.step(2e-5, 0.0)
        assert list(heard.values()) == pytest.approx(list(slave.get(names).values()), rel=1e-12)
        slave.set("support_velocity", 20.0)  # receding: the force would be tensile
        assert slave.get(names)["contact_force"] == 0.0
        slave.step(2e-5, 1e-9)
        assert slave.get(names)["contact_force"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["impact", "contact"])
def test_the_description_names_what_the_force_depends_on(made, kind):
    def dependencies(name, variable):
        with zipfile.ZipFile(made(scene(name), 3, kind=kind)) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        rows = {row.get("valueReference"): row for row in root.find("ModelStructure") if row.tag == "Output"}
        exchange = root.find("ModelExchange").get("needsCompletedIntegratorStep")
        return set(rows[str(reference(variable))].get("dependencies").split()), exchange

    rates = {"impact": {"impactor_velocity", "support_velocity"}, "contact": {"relative_velocity"}}[kind]
    plain, damped = (dependencies(name, "contact_force") for name in ("hertz", "tsuji"))
    assert damped[0] - plain[0] == {str(reference(name)) for name in (*rates, "restitution")} and plain[0] < damped[0]
    assert (plain[1], damped[1]) == ("false", "true" if kind == "contact" else "false")


@pytest.mark.slow
@pytest.mark.parametrize("name", DAMPED)
def test_a_support_that_moves(made, name):
    on = replace(scene(name, "plate"), effects=fm.Effects(gravity=False))
    velocity = lambda time: 0.02 * math.sin(4e4 * time)  # noqa: E731
    ds = fmu_wrapper.run(made(on), step_size=2e-6, stop_time=3e-4, inputs={"support_velocity": velocity})
    component = fm.ImpactComponent(on)
    for n in range(150):
        outputs = component.step(2e-6, support_velocity=velocity(n * 2e-6)).outputs
    final = ds.isel(t=-1)
    for key in ("indentation", "relative_velocity", "impactor_velocity", "target_displacement"):
        scale = float(np.abs(ds[key]).max())
        assert float(final[key]) == pytest.approx(getattr(outputs, key), rel=1e-11, abs=1e-11 * scale), key


@pytest.mark.slow
@pytest.mark.parametrize("name", DAMPED)
def test_documentation_describes_the_law(made, name):
    with zipfile.ZipFile(made(scene(name))) as archive:
        page = archive.read("documentation/index.html").decode()
    assert html.escape(LAWS[name].validity) in page
    ends = "end together, without tension" if name == "hunt-crossley" else "until F = 0"
    assert ends in " ".join(page.split())
    assert "Contact ends where the force falls to zero, without tension." in page
    follows = {
        "linear-dashpot": "stiffness, mass, restitution",
        "tsuji": "radius, effective_modulus, mass, restitution",
        "damped-large-slope": "radius, effective_modulus, mass, restitution",
        "hunt-crossley": "radius, effective_modulus, hysteresis_damping",
        "kuwabara-kono": "radius, effective_modulus, dissipation_time",
    }
    assert f"The damping follows the law if {follows[name]} are changed after export." in page


@pytest.mark.slow
def test_documentation_lists_unmodelled_effects(made):
    plate = fm.Plate("mild steel", thickness="30 mm", size=["60 mm", "60 mm"])
    thick = fm.Scene(fm.Sphere(**BALL), plate, fm.Contact(LAWS["tsuji"]), fm.Effects(boundary_reflections=False))
    warnings = fm.simulate(thick).warnings
    assert any("not modelled" in warning for warning in warnings)
    with zipfile.ZipFile(made(thick)) as archive:
        page = archive.read("documentation/index.html").decode()
    for warning in warnings:  # the FMU computes gravity too, which moves the numbers of the other effects a little
        assert f"<strong>Warning:</strong> {html.escape(warning.partition(',')[0])}" in page
