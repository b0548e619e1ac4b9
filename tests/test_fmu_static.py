"""FMUs of impacts on a target that follows the contact force by its static stiffness."""

import zipfile
from dataclasses import dataclass, replace

import pytest
from cases import BALL, LAWS, STEEL, combinations

import film_model as fm
import fmu_wrapper
from fmu_wrapper.instance import opened, started
from fmu_wrapper.resource import start_values
from fmu_wrapper.stepping import RECORDED
from fmu_wrapper.variables import reference

SUMMARY = ("maximum_force", "maximum_indentation", "rebound_velocity", "permanent_indentation", "contact_duration")
STIFFNESS = 2e7  # N/m, of the size of the contact's


def on_a_beam(law, stiffness=STIFFNESS, **scene):
    beam = fm.Beam(STEEL, "300 mm", "30 mm", "10 mm", static_stiffness=f"{stiffness!r} N/m")
    effects = fm.Effects(gravity=False, target_inertia=False)
    ball = fm.Sphere(velocity="0.25 m/s", **BALL)
    return fm.Scene(ball, beam, fm.Contact(LAWS.get(law, law)), effects, fm.Solver(segments=40), **scene)


@pytest.mark.slow
@combinations(law=["hertz", "auto", "stronge", "yigit-christoforou"], version=[2, 3], fast=2)
def test_check_agrees(made, law, version):
    report = fmu_wrapper.check(made(on_a_beam(law), version, initial_gap="1 um"))
    assert report.good, [f for f in report.findings if not f.good]


@pytest.mark.slow
@combinations(
    law=["auto", "stronge", "big-alabo"],
    changed=[{"target_stiffness": 5e6}, {"radius": 0.014}, {"yield_strength": 0.8e9, "target_stiffness": 1e8}],
    fast=3,
)
def test_parameters_after_export_are_a_new_scene(made, law, changed):
    """The parameters change the compliance over the law's scales, and of a law with a shape the curve too."""
    on = on_a_beam(law)
    new = on_a_beam(law, changed.get("target_stiffness", STIFFNESS))
    own = fmu_wrapper.served(on).contact.law
    if law == "auto":
        units = {"impactor.radius": "m", "target.material.yield_strength": "Pa"}
        paths = {path.rpartition(".")[2]: path for path in units}
        given = {paths[name]: f"{value!r} {units[paths[name]]}" for name, value in changed.items() if name in paths}
        new = new.replace(given)
    else:
        fields = {name: value for name, value in changed.items() if name != "target_stiffness"}
        new = replace(new, contact=fm.Contact(replace(own, **fields)))
    history = fm.simulate(fmu_wrapper.served(new))
    ds = fmu_wrapper.run(made(on), start_values=changed, stop_time="1 ms", step_size="1 ms")
    for name in SUMMARY:
        assert float(ds[name]) == pytest.approx(history.summary[name], rel=1e-10), name


@pytest.mark.slow
def test_the_parameters_that_there_are(made):
    with opened(made(on_a_beam("hertz"))) as fmu:
        names = start_values(fmu.data)
        assert names["target_stiffness"] == pytest.approx(STIFFNESS, rel=1e-14) and "target_impedance" not in names
    with opened(made(fmu_wrapper.served(on_a_beam("hertz")), kind="contact")) as fmu:
        assert not {"target_stiffness", "target_impedance"} & set(start_values(fmu.data))


@combinations(law=["hertz", "stronge"], fast=1)
def test_energies_balance_and_the_spring_belongs_to_the_target(made, law):
    """Under changing inputs. The deflection is the force over the stiffness."""
    on, names = on_a_beam(law), ("kinetic_energy", "contact_energy", "target_energy", "external_work")
    step, support = fm.simulate(on).duration / 40, 0.0
    motion = ("contact_force", "target_displacement", "target_velocity", "support_velocity")
    with opened(made(on)) as fmu, started(fmu, False, {}) as slave:
        first, largest = slave.get(names)["kinetic_energy"], 0.0
        for n in range(60):
            slave.set("external_force", 20.0 * (n % 3))
            slave.set("support_velocity", 0.01 * (n % 2))
            slave.step(n * step, step)
            support += 0.01 * (n % 2) * step
            now = slave.get((*names, *motion))
            total = now["kinetic_energy"] + now["contact_energy"] + now["target_energy"] - now["external_work"]
            assert total == pytest.approx(first, rel=1e-13)
            bent = now["target_displacement"] - support
            assert bent == pytest.approx(now["contact_force"] / STIFFNESS, rel=1e-9, abs=1e-18)
            largest = max(largest, 0.5 * STIFFNESS * bent**2)
    assert 0.2 * first < largest < first


def test_the_velocity_of_the_target_is_the_derivative_of_its_displacement(made):
    derive = reference("target_velocity"), reference("support_velocity")
    with opened(made(on_a_beam("hertz"))) as fmu, started(fmu, False, {}) as slave:
        slave.step(0.0, 4e-5)
        saved, h, found = slave.instance.getFMUState(), 1e-9, []
        slope = slave.instance.getDirectionalDerivative(derive[:1], derive[1:], [1.0])[0]
        for support in (0.0, 0.01):
            slave.instance.setFMUState(saved)
            slave.set("support_velocity", support)
            now = slave.get(("target_displacement", "target_velocity"))
            slave.step(4e-5, h)
            later = slave.get(("target_displacement",))["target_displacement"]
            assert (later - now["target_displacement"]) / h == pytest.approx(now["target_velocity"], rel=1e-4)
            found.append(now["target_velocity"])
        assert slope == pytest.approx((found[1] - found[0]) / 0.01, rel=1e-9) and 0.0 < slope < 1.0
        slave.instance.freeFMUState(saved)


def test_a_state_is_restored_in_another_instance_with_its_spring(made):
    starts = {"target_stiffness": 6e6, "yield_strength": 0.7e9}
    with opened(made(on_a_beam("auto"))) as fmu, started(fmu, False, starts) as slave:
        slave.step(0.0, 6e-5)
        saved = slave.instance.getFMUState()
        content = slave.instance.serializeFMUState(saved)
        slave.step(6e-5, 9e-4)
        expected = slave.get(RECORDED)
        with started(fmu, False, {}) as other:
            other.restore(other.instance.deserializeFMUState(content))
            other.step(6e-5, 9e-4)
            assert other.get(RECORDED) == expected
        slave.instance.freeFMUState(saved)


@pytest.mark.slow
def test_faster_impacts_make_the_target_vibrate_and_validity_says_so(made):
    """A heavy ball on a small plate follows it statically; a fast one does not."""
    ball = fm.Sphere(radius="10 mm", mass="400 kg", velocity="0.01 m/s", material="mild steel")
    plate = fm.Plate("mild steel", thickness="5 mm", size=["80 mm", "80 mm"])
    on = fm.Scene(ball, plate, fm.Contact("hertz"), fm.Effects(gravity=False, tolerance=0.02))
    assert fm.simulate(fmu_wrapper.served(on)).problem.given.compliance > 0.0
    assert fm.simulate(fmu_wrapper.served(on.replace({"impactor.velocity": "2 m/s"}))).problem.vibrates
    for velocity, expected in ((0.01, 0), (2.0, 1)):
        with opened(made(on)) as fmu, started(fmu, False, {"initial_velocity": velocity}) as slave:
            assert int(slave.get(("validity",))["validity"]) & 1 == expected
            assert any("vibrations of the target" in text for text in fmu.notices) == bool(expected)


@dataclass(frozen=True)
class Softening(fm.AbstractLaw):
    """Linear, then with a force that falls with the indentation."""

    name = "softening"
    summary = "test law"
    source = "tests"

    def scales(self, energy):
        return 1e-5, 500.0

    def stages(self):
        return (
            fm.Stage("up", 0.0, 1.0, fm.Power(slope=1.0)),
            fm.Stage("down", 1.0, 9.0, lambda x: 1.0 - (x - 1.0) / 10.0),
        )


def test_a_stiffness_at_which_the_contact_would_snap_through_is_refused(made):
    on = replace(on_a_beam("hertz"), contact=fm.Contact(Softening()))
    with opened(made(on)) as fmu:
        with started(fmu, False, {"target_stiffness": 5.1e6}):
            pass
        with (
            pytest.raises(
                fm.SimulationError, match=r"target_stiffness: with 4.9e\+06 N/m the contact would snap through"
            ),
            started(fmu, False, {"target_stiffness": 4.9e6}),
        ):
            pass


@pytest.mark.parametrize("version", [2, 3])
def test_there_is_no_model_exchange_and_the_documentation_says_why(made, version):
    path = made(on_a_beam("hertz"), version)
    with zipfile.ZipFile(path) as archive:
        assert b"ModelExchange" not in archive.read("modelDescription.xml")
        assert "<code>target_stiffness</code>, without delay" in archive.read("documentation/index.html").decode()
    with pytest.raises(ValueError, match="has a static stiffness, so there is no mode 'exchange': mode 'steps'"):
        fmu_wrapper.run(path, mode="exchange")
