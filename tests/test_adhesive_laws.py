"""Laws that pull: tension, energy of parting, sticking, and the march, steps, batches and sweeps of them."""

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import film_model as fm
from film_model.problem.curve import curve_of
from film_model.solve.batch import simulate_many
from film_model.studies.cost import study as cost_study

MODULUS, RADIUS, WORK, DENSITY = 2e9, 50e-6, 0.05, 1050.0
MASS = DENSITY * 4 / 3 * math.pi * RADIUS**3
LOSS = 7.092195971863958 * (WORK**5 * RADIUS**4 / MODULUS**2) ** (1 / 3)
STICKING = math.sqrt(2 * LOSS / MASS)
LAWS = {"jkr": fm.Jkr(MODULUS, RADIUS, WORK), "dmt": fm.Dmt(MODULUS, RADIUS, WORK)}
PLATE = {"youngs_modulus": "3 GPa", "poissons_ratio": 0.35, "density": "1200 kg/m^3"}


def scene(law="jkr", times=2.0, target=None, **effects):
    """A bead at `times` the sticking velocity."""
    ball = fm.Sphere(f"{RADIUS!r} m", f"{times * STICKING!r} m/s", mass=f"{MASS!r} kg")
    contact = fm.Contact(law, effective_modulus=f"{MODULUS!r} Pa", work_of_adhesion=f"{WORK!r} J/m^2")
    return fm.Scene(ball, target or fm.HalfSpace(), contact, fm.Effects(**{"gravity": False, **effects}))


def plate(thickness):
    return fm.Plate(PLATE, thickness=thickness)


def jkr_at(radius):
    """Indentation and force of a JKR contact at its radius."""
    indentation = radius**2 / RADIUS - math.sqrt(2 * math.pi * WORK * radius / MODULUS)
    return indentation, 4 * MODULUS * radius**3 / (3 * RADIUS) - math.sqrt(8 * math.pi * WORK * MODULUS * radius**3)


LEAST = (math.pi * WORK * RADIUS**2 / (8 * MODULUS)) ** (1 / 3)  # contact radius where the contact lets go
LAST = {"jkr": jkr_at(LEAST)[0], "dmt": 0.0}


def force_of(law, indentation):
    if law == "jkr":
        indentation = max(indentation, LAST["jkr"] * (1 - 1e-15))
        return jkr_at(brentq(lambda radius: jkr_at(radius)[0] - indentation, LEAST, RADIUS, xtol=1e-20, rtol=1e-14))[1]
    return 4 / 3 * MODULUS * math.sqrt(RADIUS) * max(indentation, 0.0) ** 1.5 - 2 * math.pi * WORK * RADIUS


def exact(law, velocity, impedance=math.inf):
    """Largest force, times of the turn and of the end, and final velocity, by an integrator."""

    def motion(_, state):
        force = force_of(law, state[0])
        return [state[1] - force / impedance, -force / MASS]

    def turns(t, state):
        return motion(t, state)[0]

    def ends(t, state):
        return state[0] - LAST[law] if t > 0 else 1.0

    turns.direction, ends.direction, ends.terminal = -1.0, -1.0, True
    depth = (1.25 * MASS * velocity**2 / (4 / 3 * MODULUS * math.sqrt(RADIUS))) ** 0.4
    found = solve_ivp(
        motion, (0, 30 * depth / velocity), [0.0, velocity], "DOP853", events=(turns, ends), rtol=1e-11, atol=1e-20
    )
    return force_of(law, found.y_events[0][0][0]), found.t_events[0][0], found.t_events[1][0], found.y_events[1][0][1]


@pytest.mark.slow
def test_the_tension_is_that_of_force_control():
    for name, factor in (("jkr", 1.5), ("dmt", 2.0)):
        law = LAWS[name]
        curve, (_, force) = curve_of(law), law.scales(0.0)
        grid = np.linspace(curve.native.stage[0].begin, 1.0, 20001)
        least = min(curve.force(xi) for xi in grid.tolist())
        assert least * force == pytest.approx(-factor * math.pi * WORK * RADIUS, rel=1e-7)
        assert curve.native.pull * force == pytest.approx(factor * math.pi * WORK * RADIUS, rel=1e-12)
        assert curve.fit_error < 1e-12


def test_the_jkr_curve_is_that_of_its_contact_radius():
    law = LAWS["jkr"]
    (length, scale), curve = law.scales(0.0), curve_of(law)
    for radius in np.geomspace(1.001 * LEAST, 30 * LEAST, 200).tolist():
        indentation, force = jkr_at(radius)
        assert curve.force(indentation / length) * scale == pytest.approx(force, rel=1e-9, abs=1e-11 * scale)
    assert curve.native.stage[0].begin * length == pytest.approx(LAST["jkr"], rel=1e-12)


@pytest.mark.parametrize("times", [1.001, 1.2, 2.0, 30.0, 1000.0])
def test_the_energy_of_parting(times):
    history = fm.simulate(scene(times=times), accuracy=1e-9)
    summary = history.summary
    assert summary["energy_absorbed"] == pytest.approx(LOSS, rel=1e-6 if times < 100 else 1e-4)
    assert summary["coefficient_of_restitution"] == pytest.approx(math.sqrt(1 - times**-2), rel=1e-6)
    assert summary["permanent_indentation"] == 0.0
    assert summary["contact_radius"] is None


def test_below_the_sticking_velocity_it_stays():
    history = fm.simulate(scene(times=0.999))
    assert history.outcome is fm.Outcome.TIME_LIMIT
    assert history.summary["coefficient_of_restitution"] is None
    assert fm.simulate(scene(times=1.0001)).outcome is fm.Outcome.SEPARATED


@pytest.mark.slow
@pytest.mark.parametrize("law", ["jkr", "dmt"])
@pytest.mark.parametrize(
    ("target", "times"), [("half-space", 1.5), ("half-space", 20.0), ("20 um", 8.0), ("60 um", 4.0)]
)
def test_it_is_the_exact_motion(law, target, times):
    case = scene(law, times, None if target == "half-space" else plate(target), target_motion=target != "half-space")
    summary = fm.simulate(case, accuracy=1e-8).summary
    force, turn, end, nu = exact(law, times * STICKING, case.target_impedance)
    assert summary["maximum_force"] == pytest.approx(force, rel=1e-6)
    assert summary["time_of_maximum_indentation"] == pytest.approx(turn, rel=1e-6)
    assert summary["contact_duration"] == pytest.approx(end, rel=1e-6)
    assert summary["rebound_velocity"] == pytest.approx(nu, rel=1e-6)


def test_dmt_loses_nothing():
    assert fm.simulate(scene("dmt", 3.0), accuracy=1e-9).summary["coefficient_of_restitution"] == pytest.approx(
        1, rel=1e-9
    )


@pytest.mark.parametrize("law", ["jkr", "dmt"])
@pytest.mark.parametrize("target", [None, plate("30 um")])
def test_steps_and_batches_are_the_same_motion(law, target):
    case = scene(law, 5.0, target)
    history = fm.simulate(case, accuracy=1e-6)
    counts = history.accuracy.segments, history.accuracy.unloading_segments
    component = fm.ImpactComponent(case, segments=counts)
    for _ in range(200):
        component.step(history.duration / 150)
    assert component.phase == "separated" and component.outputs.contact_count == 1
    assert component.outputs.impactor_velocity == pytest.approx(history.summary["rebound_velocity"], rel=1e-10)
    speeds = [f"{times * STICKING!r} m/s" for times in (0.5, 1.5, 5.0, 50.0)]
    batch = fm.simulate_batch(case, velocity=speeds, accuracy=1e-6)
    for k, speed in enumerate(speeds):
        alone = fm.simulate(case.replace({"impactor.velocity": speed}), accuracy=1e-6).summary
        for name in ("maximum_force", "contact_duration", "rebound_velocity"):
            many = batch.summary[name][k]
            assert (alone[name] is None and many != many) or many == pytest.approx(alone[name], rel=3e-6), (name, speed)


def test_a_bead_that_sticks_to_a_plate_comes_to_rest():
    component = fm.ImpactComponent(scene(times=0.9, target=plate("5 um"), target_motion=True))
    for _ in range(400):
        component.step("1 us")
    assert component.phase != "separated"
    assert component.outputs.contact_force == pytest.approx(0.0, abs=1e-6 * math.pi * WORK * RADIUS)
    assert component.outputs.indentation == pytest.approx(2 ** (4 / 3) * LAWS["jkr"].scales(0.0)[0], rel=1e-4)


def test_a_pull_by_hand_parts_the_contact_at_the_largest_tension():
    tension = 1.5 * math.pi * WORK * RADIUS
    for part, stays in ((0.999, True), (1.001, False)):
        component = fm.ImpactComponent(scene(times=0.9, target=plate("5 um"), target_motion=True))
        for _ in range(400):
            component.step("1 us")
        for k in range(400):
            component.step("1 us", external_force=-part * tension * min(1.0, (k + 1) / 300))
        assert (component.phase != "separated") is stays


def test_a_sweep_over_the_work_of_adhesion():
    works = np.array([0.01, 0.03, 0.05, 0.08])
    result = simulate_many(scene(times=3.0), {"contact.work_of_adhesion": works})
    loss = 7.092195971863958 * (works**5 * RADIUS**4 / MODULUS**2) ** (1 / 3)
    assert result.summary["energy_absorbed"] == pytest.approx(loss, rel=1e-3)


def test_what_it_needs_and_where_it_is_refused():
    with pytest.raises(fm.SceneError, match="work_of_adhesion"):
        scene().replace({"contact.work_of_adhesion": None})
    with pytest.raises(ValueError, match="must be > 0"):
        fm.Contact(fm.Jkr(MODULUS, RADIUS, 0.0))
    stiff = fm.Plate(PLATE, thickness="30 um", static_stiffness="100 N/m")
    with pytest.raises(fm.SimulationError, match="pull"):
        fm.simulate(scene(target=stiff))
    with pytest.raises(fm.SimulationError, match="which pulls"):
        cost_study(scene())
    beam = fm.Beam(PLATE, length="3 mm", width="0.2 mm", thickness="0.1 mm")
    with pytest.raises(fm.SimulationError, match="pull"):
        fm.simulate(scene(target=beam))


@pytest.mark.slow
@pytest.mark.parametrize("law", ["jkr", "dmt"])
@pytest.mark.parametrize(("target", "version"), [(None, 2), (plate("60 um"), 3)])
def test_an_fmu_is_the_same_motion(law, target, version, tmp_path):
    import fmu_wrapper

    case = scene(law, 4.0, target)
    history = fm.simulate(case, accuracy=1e-9)
    path = fmu_wrapper.export(case, tmp_path / "bead.fmu", version)
    for how, tolerance in (({}, 1e-6), ({"mode": "exchange"}, 1e-6)):
        found = fmu_wrapper.run(path, step_size=history.duration / 20, **how)
        for name in ("maximum_force", "contact_duration", "rebound_velocity"):
            assert float(found[name]) == pytest.approx(history.summary[name], rel=tolerance), (how, name)
        assert float(found["contact_force"].min()) < -0.5 * math.pi * WORK * RADIUS
    assert fmu_wrapper.check(path).good


def test_what_parting_takes_is_no_plastic_work():
    soft = {**PLATE, "yield_strength": "1 MPa", "strain_rate_coefficient": 0.1}
    effects = {effect.name: effect for effect in fm.simulate(scene(times=1.2, target=fm.HalfSpace(soft))).effects}
    assert {effects[name].reason for name in ("rate_hardening", "heating")} == {"nothing yields"}


def test_adhesion_is_not_judged_where_the_law_has_it():
    effects = {effect.name: effect for effect in fm.simulate(scene()).effects}
    assert effects["adhesion"].state == "not needed" and "jkr" in effects["adhesion"].reason
    effects = {effect.name: effect for effect in fm.simulate(scene("hertz", 2.0)).effects}
    assert effects["adhesion"].change == pytest.approx(1 / math.sqrt(1 - 0.25) - 1, rel=0.7)


PRESSURE = 40e6
DENTED = 3.0  # m/s, well beyond yield


def dented_scene(velocity=DENTED, target=None, pressure=PRESSURE, work=WORK, **effects):
    """The bead under the law of Thornton & Ning."""
    given = {"effective_modulus": f"{MODULUS!r} Pa", "work_of_adhesion": f"{work!r} J/m^2"}
    ball = fm.Sphere(f"{RADIUS!r} m", f"{velocity!r} m/s", mass=f"{MASS!r} kg")
    contact = fm.Contact("thornton-ning", yield_pressure=f"{pressure!r} Pa", **given)
    return fm.Scene(ball, target or fm.HalfSpace(), contact, fm.Effects(**{"gravity": False, **effects}))


class Dent:
    """Thornton & Ning's contact in SI, from contact radii: loading, and after a turn at `depth` the way back."""

    def __init__(self, depth):
        def pressure(a):
            return 2 * MODULUS * a / (math.pi * RADIUS) - math.sqrt(2 * WORK * MODULUS / (math.pi * a))

        self.yields = brentq(lambda a: pressure(a) - PRESSURE, LEAST, RADIUS, xtol=1e-18, rtol=1e-14)
        self.first, self.at_first = jkr_at(self.yields)
        self.force = self.at_first + math.pi * RADIUS * PRESSURE * (depth - self.first)
        widest = math.sqrt(self.yields**2 + RADIUS * (depth - self.first))
        cube = MODULUS * widest**3
        self.radius = 4 * cube / (3 * (self.force + math.sqrt(8 * math.pi * WORK * cube)))
        self.left = depth - widest**2 / self.radius + math.sqrt(2 * math.pi * WORK * widest / MODULUS)
        self.depth, self.widest = depth, widest
        self.least = (math.pi * WORK * self.radius**2 / (8 * MODULUS)) ** (1 / 3)

    def stored(self):
        """Work of loading from first touch: ∫F dδ over the contact radius, then under the pressure p_y."""
        touch = (2 * math.pi * WORK * RADIUS**2 / MODULUS) ** (1 / 3)
        elastic = quad(lambda a: jkr_at(a)[1] * slope(a, RADIUS), touch, self.yields, epsabs=0, epsrel=1e-12)[0]
        return elastic + 0.5 * (self.at_first + self.force) * (self.depth - self.first)

    def returned(self):
        """Work of the way back to the end of contact."""

        def rate(a):
            force = 4 * MODULUS * a**3 / (3 * self.radius) - math.sqrt(8 * math.pi * WORK * MODULUS * a**3)
            return force * slope(a, self.radius)

        return quad(rate, self.least, self.widest, epsabs=0, epsrel=1e-12)[0]


def slope(a, radius):
    """dδ/da of a JKR contact."""
    return 2 * a / radius - math.sqrt(math.pi * WORK / (2 * MODULUS * a))


@pytest.mark.parametrize("velocity", [1.0, DENTED, 20.0])
def test_a_dent_holds_the_ball(velocity):
    """Depth, dent, largest tension and energy of an impact beyond yield, from integrals over the contact radius."""
    summary = fm.simulate(dented_scene(velocity), accuracy=1e-9).summary
    dent = Dent(summary["maximum_indentation"])
    assert dent.stored() == pytest.approx(0.5 * MASS * velocity**2, rel=1e-8)
    assert summary["maximum_force"] == pytest.approx(dent.force, rel=1e-8)
    assert summary["permanent_indentation"] == pytest.approx(dent.left, rel=1e-7)
    assert summary["energy_absorbed"] == pytest.approx(dent.stored() - dent.returned(), rel=1e-7)
    restitution = math.sqrt(dent.returned() / (0.5 * MASS * velocity**2))
    assert summary["coefficient_of_restitution"] == pytest.approx(restitution, rel=1e-7)
    component = fm.ImpactComponent(dented_scene(velocity))
    tension = [component.step(summary["contact_duration"] / 4000).outputs.contact_force for _ in range(4001)]
    assert min(tension) == pytest.approx(-1.5 * math.pi * WORK * dent.radius, rel=3e-3)
    assert dent.radius > RADIUS


def test_without_yield_it_is_jkr_and_without_adhesion_thornton():
    hard = fm.simulate(dented_scene(2 * STICKING, pressure=400e6), accuracy=1e-9).summary
    plain = fm.simulate(scene(times=2.0), accuracy=1e-9).summary
    assert hard["contact_duration"] == pytest.approx(plain["contact_duration"], rel=1e-9)
    assert hard["permanent_indentation"] == 0.0
    thornton = dented_scene().replace({"contact.law": "thornton", "contact.work_of_adhesion": None})
    dry = fm.simulate(thornton, accuracy=1e-8).summary
    faint = fm.simulate(dented_scene(work=1e-9), accuracy=1e-8).summary
    for name in ("maximum_force", "permanent_indentation", "coefficient_of_restitution", "contact_duration"):
        assert faint[name] == pytest.approx(dry[name], rel=1e-5), name


def test_yield_raises_the_sticking_velocity():
    """Above the sticking velocity of jkr the ball stays in its dent, and says so; a soft plate brings it to rest."""
    slow = dented_scene(1.05 * STICKING, pressure=17e6)
    history = fm.simulate(slow)
    assert history.outcome is fm.Outcome.TIME_LIMIT and history.summary["coefficient_of_restitution"] is None
    assert fm.simulate(scene(times=1.05)).outcome is fm.Outcome.SEPARATED
    for pressure in (17e6, 20e6, 30e6):
        for times in (1.3, 2.0, 4.0):
            yields = fm.simulate(dented_scene(times * STICKING, pressure=pressure)).summary
            elastic = fm.simulate(scene(times=times)).summary
            assert yields["energy_absorbed"] >= elastic["energy_absorbed"] * (1 - 1e-6), (pressure, times)
    component = fm.ImpactComponent(dented_scene(1.05 * STICKING, plate("5 um"), 17e6, target_motion=True))
    for _ in range(400):
        component.step("1 us")
    assert component.phase != "separated" and component.outputs.indentation > 0.0
    assert component.outputs.contact_force == pytest.approx(0.0, abs=1e-6 * math.pi * WORK * RADIUS)


@pytest.mark.parametrize("target", [None, plate("60 um")])
def test_dents_in_steps_batches_and_sweeps(target):
    case = dented_scene(target=target)
    history = fm.simulate(case, accuracy=1e-6)
    counts = history.accuracy.segments, history.accuracy.unloading_segments
    component = fm.ImpactComponent(case, segments=counts)
    for _ in range(200):
        component.step(history.duration / 150)
    assert component.outputs.impactor_velocity == pytest.approx(history.summary["rebound_velocity"], rel=1e-9)
    names = [event.stage for event in history.events]
    assert names[-3:] == ["unloading", "unloading", ""] and "plastic" in names
    assert set(history.sample_si(np.linspace(0, history.duration, 50)).stage) <= {
        "pulling",
        "pushing",
        "plastic",
        "unloading",
        "",
    }
    speeds = [1.0, DENTED, 20.0]
    batch = fm.simulate_batch(case, velocity=[f"{v!r} m/s" for v in speeds], accuracy=1e-6)
    for k, velocity in enumerate(speeds):
        alone = fm.simulate(dented_scene(velocity, target), accuracy=1e-6).summary
        for name in ("maximum_force", "permanent_indentation", "rebound_velocity"):
            assert batch.summary[name][k] == pytest.approx(alone[name], rel=1e-5), (name, velocity)
    works = np.array([0.02, 0.05, 0.08])
    swept = simulate_many(case, {"contact.work_of_adhesion": works}).summary["rebound_velocity"]
    alone = [fm.simulate(dented_scene(target=target, work=work)).summary["rebound_velocity"] for work in works.tolist()]
    assert swept == pytest.approx(np.array(alone), rel=1e-3)


@pytest.mark.slow
def test_a_dataset_keeps_the_way_back():
    import film_datasets as fd

    history = fm.simulate(dented_scene())
    dataset = fd.to_dataset(history)
    assert fd.validate(dataset) == []
    assert "unloading_along_parting" in dataset["segment_branch"].attrs["flag_meanings"]
    times = np.linspace(0.0, history.duration, 40)
    assert np.array_equal(fd.history_of(dataset).sample_si(times).contact_force, history.sample_si(times).contact_force)


@pytest.mark.parametrize("velocity", [0.3, 1.0, 3.0])
def test_adhesion_is_judged_with_the_radius_of_the_dent(velocity):
    """Under thornton R_p = R F_Hertz(δ_m)/F_m, and the work of parting grows as R_p^{4/3}."""
    dry = fm.simulate(dented_scene(velocity).replace({"contact.law": "thornton"}), accuracy=1e-6)
    hertz = 4 / 3 * MODULUS * math.sqrt(RADIUS) * dry.summary["maximum_indentation"] ** 1.5
    ratio = hertz / dry.summary["maximum_force"]
    effect = next(effect for effect in dry.effects if effect.name == "adhesion")
    assert ratio > 1.1
    assert effect.value == pytest.approx(velocity / (STICKING * ratio ** (2 / 3)), rel=1e-3)


def test_what_yields_by_adhesion_alone_is_refused():
    with pytest.raises(fm.SceneError, match="adhesion alone yields"):
        fm.simulate(dented_scene(pressure=1e6))


@pytest.mark.slow
@pytest.mark.parametrize(("target", "version"), [(None, 3), (plate("60 um"), 2)])
def test_an_fmu_leaves_the_dent(target, version, tmp_path):
    import fmu_wrapper

    case = dented_scene(target=target)
    history = fm.simulate(case, accuracy=1e-9)
    path = fmu_wrapper.export(case, tmp_path / "bead.fmu", version)
    for how in ({}, {"mode": "exchange"}):
        found = fmu_wrapper.run(path, step_size=history.duration / 20, **how)
        for name in ("maximum_force", "contact_duration", "rebound_velocity", "permanent_indentation"):
            assert float(found[name]) == pytest.approx(history.summary[name], rel=1e-6), (how, name)
        assert float(found["contact_force"].min()) < -0.5 * math.pi * WORK * RADIUS
    assert fmu_wrapper.check(path).good
