"""Viscoelastic contact: against solve_ivp, a bed of springs, published limits and the elastic contact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import film_model as fm
from film_model.core import native, relaxing
from film_model.effects.choose import choose
from film_model.effects.effect import NOT_MODELLED, NOT_NEEDED, SIMULATED
from film_model.problem.relaxation import Relaxation, relaxation_of
from film_model.problem.summary import SUMMARY
from film_model.solve.batch import simulate_many
from film_model.studies.relaxation_reference import Ting

OUT = 299
"""Steps of 5 µs after which a contact that began after 1 ms is on the way out."""

APPROACH = math.sqrt(2.0)  # in the units of the march, Hertz's law


def rubber(**changes):
    values = {"youngs_modulus": "50 MPa", "poissons_ratio": 0.49, "density": "1100 kg/m^3"}
    return fm.Material(**{**values, "prony": [[0.4, "0.2 ms"], [0.2, "3 ms"]], **changes})


def scene(velocity="1 m/s", material: fm.Material | None = None, **more):
    ball = fm.Sphere("10 mm", velocity, material=material or rubber())
    return fm.Scene(ball, fm.HalfSpace("granite"), **more)


def impact(terms, tolerance, **start):
    """One contact in the units of the march. terms: pairs of a relative modulus and a relaxation time."""
    relaxation = Relaxation(1.0 - sum(g for g, _ in terms), *zip(*((g, 1.0 / time) for g, time in terms), strict=True))
    given = {"nu": APPROACH, "gamma": 0.0, "load": 0.0, "stop_velocity": -0.0, "time_limit": math.inf, "damping": 0.0}
    status, summary = relaxing.impact(relaxation.law(1.0), native.Start(**{**given, **start}), tolerance)
    assert status == native.EVENT
    return summary


@pytest.mark.parametrize(
    ("terms", "gamma", "load"),
    [
        pytest.param([(0.7, 1.0)], 0.0, 0.0),
        pytest.param([(0.6, 0.1)], 0.0, 0.05, marks=pytest.mark.slow),
        pytest.param([(0.4, 0.3), (0.3, 5.0)], 0.3, 0.0, marks=pytest.mark.slow),
    ],
)
def test_agrees_with_an_integrator(terms, gamma, load):
    exact = Ting(terms, APPROACH, gamma, load)
    found = impact(terms, 1e-6, gamma=gamma, load=load)
    pairs = {
        "maximum_indentation": exact.deepest,
        "time_of_maximum_indentation": exact.turn,
        "contact_duration": exact.end,
        "permanent_indentation": exact.left,
        "final_velocity": exact.final,
    }
    assert {name: getattr(found, name) for name in pairs} == pytest.approx(pairs, rel=1e-7)
    start = native.Start(APPROACH, gamma, load, -0.0, math.inf, 0.0)
    relaxation = Relaxation(exact.rest, tuple(exact.share), tuple(exact.rate))
    record = relaxing.Record(relaxation.law(1.0), start, 1e-6)
    for t in np.linspace(0.02, 0.98, 9) * exact.end:
        on_way_in = t < exact.turn
        y = (exact.way_in if on_way_in else exact.way_out).sol(t)
        force = exact.force_in(y) if on_way_in else exact.force_out(t, y)
        assert record.sample(np.array([t]))[0][0, [0, 2, 3]] == pytest.approx([y[0], force, y[1]], abs=2e-7)


def bed_of_springs(g, time, jump_at=math.inf, jump=0.0, deep=None):
    """Largest force, time, velocity at the end of contact, and the springs then. The velocity gains `jump` at a time.

    Independent springs, each a standard linear solid that touches at ξ = x² and leaves when its force is 0. deep: how
    deep they are at first, without force.

    They are equivalent to a sphere on a half-space (Popov & Heß 2015), and use neither t₁ nor ξ^{3/2}.
    """
    springs, dt = 1000, 1e-3
    x = (np.arange(springs) + 0.5) / springs * 1.5
    fade, late, force = math.exp(-dt / time), time * (1.0 - math.exp(-dt / time)), 0.0
    touched, sprung = np.zeros(springs, np.bool_), np.zeros(springs) if deep is None else deep
    q, recovered = -(1.0 - g) / g * sprung, math.exp(-(1.0 - g) / time * dt)
    xi, nu, t, peak, left = sprung[0], APPROACH, 0.0, 0.0, np.zeros(springs, np.bool_)
    while t < 10.0 and not (t > dt and force == 0.0):
        nu, jump = (nu + jump, 0.0) if t >= jump_at else (nu, jump)
        step = nu * dt - 0.5 * force * dt * dt
        before, xi, t = force, xi + step, t + dt
        touched |= xi - x**2 > sprung
        held = touched & ~left
        moved = np.where(held, xi - x**2, recovered * sprung) - sprung
        sprung = sprung + moved
        q = np.where(held, fade * q + moved * (late / dt), -(1.0 - g) / g * sprung)
        each = np.where(held, (1.0 - g) * sprung + g * q, 0.0)
        left |= held & (each <= 0.0)
        force = 1.5 * float(np.maximum(each, 0.0).sum()) * (x[1] - x[0])  # ∫ 1.5 (ξ − x²) dx = ξ^{3/2}
        nu -= 0.5 * dt * (before + force)
        peak = max(peak, force)
    return [peak, t, nu], sprung


def test_agrees_with_a_bed_of_springs():
    found = impact([(0.6, 0.4)], 1e-5)
    expected = [found.maximum_force, found.contact_duration, found.final_velocity]
    assert bed_of_springs(0.6, 0.4)[0] == pytest.approx(expected, rel=5e-3)


def test_a_contact_that_a_jump_of_velocity_turns():
    law = Relaxation(0.4, (0.6,), (2.5,)).law(1.0)
    motion = relaxing.Motion(law, native.Start(APPROACH, 0.0, 0.0, -0.0, math.inf, 0.0), 1e-5)
    names, peak = list[str](), 0.0
    for event in ("contact_begins", ""):
        assert motion.step(0.5 if not event else 0.0) == (native.EVENT if event else native.OK)
    motion.set_input(0.0, -2.0, 2.0)
    while "contact_ends" not in names:
        assert motion.step(9.0) == native.EVENT
        names.append(native.EVENTS[motion.state.event])
        peak = max(peak, motion.state.peak)
    assert names[0] == "maximum_indentation" and motion.time - 0.5 > 0.1
    found = [peak, motion.time, float(motion.values()[3])]
    assert found == pytest.approx(bed_of_springs(0.6, 0.4, 0.5, -2.0)[0], rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("g", "time"), [(0.6, 0.4), (0.3, 5.0)])
def test_what_is_left_of_a_contact_changes_the_next_by_less(g, time):
    """1 % of the depth that the surface has not yet recovered changes it by 0.4 % at most, as film_relax.h says."""
    first, springs = bed_of_springs(g, time)
    part = 1e-2 * (1.25 * APPROACH**2) ** 0.4 / springs[0]
    second, _ = bed_of_springs(g, time, deep=part * springs)
    changes = np.abs(np.array(second) / first - 1.0)
    assert 1e-3 < changes.max() <= 4e-3


def test_the_surface_recovers_as_a_matrix_exponential():
    """Without force rest w + Σ g p = 0, p' = w' − r p: the core's bound is at most 1.5 times as large."""
    share, rate = np.array([0.4, 0.2]), np.array([5.0, 0.2])
    law = Relaxation(0.4, tuple(share), tuple(rate)).law(1.0)
    motion = relaxing.Motion(law, native.Start(APPROACH, 0.0, 0.0, -0.0, math.inf, 0.0), 1e-5)
    assert motion.left == 0.0
    while motion.state.branch != native.FREE or motion.state.contacts == 0:
        assert motion.step(9.0) == native.EVENT
    p, before = np.array(motion.state.p[:2]), 0.0
    assert motion.left == pytest.approx(motion.values()[0], rel=1e-9)
    for time in (0.1, 1.0, 10.0, 50.0):
        motion.step(time - before)
        before = time
        exact = float(-share @ expm((np.ones((2, 1)) * (share * rate) - np.diag(rate)) * time) @ p / 0.4)
        assert exact <= motion.left <= 1.5 * exact


@pytest.mark.parametrize("time", [1e-7, 1e7])
def test_relaxation_much_faster_or_slower_than_the_contact_leaves_it_elastic(time):
    found, modulus = impact([(0.5, time)], 1e-6), 0.5 if time < 1.0 else 1.0
    depth = (1.25 * APPROACH**2 / modulus) ** 0.4
    assert found.maximum_indentation == pytest.approx(depth, rel=1e-6)
    assert found.maximum_force == pytest.approx(modulus * depth**1.5, rel=1e-6)
    assert found.contact_duration == pytest.approx(2.94327518 * depth / APPROACH, rel=1e-6)
    assert -found.final_velocity / APPROACH == pytest.approx(1.0, abs=1e-6)


def test_fast_relaxation_gives_the_published_series_of_restitution():
    """e = 1 − C₁ A κ^{2/5} V^{1/5} + …, C₁ = 1.15344, κ = (3/2)^{5/2} K/m (Ramírez et al. 1999).

    Their F = K (δ^{3/2} + (3/2) A √δ δ') is the limit of short relaxation times, with A = Σ g τ/(1 − Σ g).
    """
    for time in (1e-3, 1e-4):
        x = 1.15344 * 1.5 * time * 0.5**0.4 * APPROACH**0.2
        assert impact([(0.5, time)], 1e-7).final_velocity / APPROACH == pytest.approx(x - 1.0, abs=3.0 * x**2)


def test_two_bodies_relax_as_one():
    """1/M = 1/M₁ + 1/M₂ in Laplace's variable s; both materials have a relaxation time in common."""
    one, two = (
        rubber(prony=[[0.3, "1 ms"], [0.2, "0.1 s"]]),
        rubber(prony=[[0.5, "1 ms"], [0.2, "3 s"]], poissons_ratio=0.3),
    )
    both = fm.Scene(fm.Sphere("10 mm", "1 m/s", material=one), fm.HalfSpace(two))
    relaxation, modulus = relaxation_of(both), both.effective_modulus
    assert relaxation is not None and modulus is not None
    assert relaxation.rest + sum(relaxation.share) == pytest.approx(1.0, abs=1e-15)
    for s in (1e-3, 1.0, 300.0, 1e6):
        apart = [
            m.youngs_modulus / (1.0 - m.poissons_ratio**2) * (1.0 - sum(g / (1.0 + s * t) for g, t in m.prony or ()))
            for m in (one, two)
        ]
        together = relaxation.rest + sum(
            g * s / (s + r) for g, r in zip(relaxation.share, relaxation.rate, strict=True)
        )
        assert modulus * together == pytest.approx(1.0 / (1.0 / apart[0] + 1.0 / apart[1]), rel=1e-13)


def test_history_keeps_energy_and_momentum():
    history = fm.simulate(scene(effects=fm.Effects(gravity=True), solver=fm.Solver(accuracy=1e-7)))
    t = np.linspace(0.0, history.duration, 4001)
    samples, mass = history.sample_si(t), history.scene.mass
    impulse = np.trapezoid(samples.contact_force, t)
    work = np.trapezoid(samples.contact_force * samples.relative_velocity, t)
    assert history.summary["impulse"] == pytest.approx(impulse, rel=1e-6)
    assert history.summary["energy_absorbed"] == pytest.approx(work, rel=1e-4)
    fall = mass * 9.80665 * samples.indentation[-1]
    lost = 0.5 * mass * (1.0 - samples.impactor_velocity[-1] ** 2) + fall
    assert history.summary["energy_absorbed"] == pytest.approx(lost, rel=1e-9)
    assert history.summary["permanent_indentation"] == 0.0 and samples.indentation[-1] > 0.0
    assert history.accuracy.estimated < 1e-7
    assert history.events[-1].contact_force == 0.0
    names = [event.name for event in history.events]
    assert names == ["contact_begins", "maximum_indentation", "impactor_stops", "contact_ends"] or names[1:3] == [
        "impactor_stops",
        "maximum_indentation",
    ]


def test_the_estimate_bounds_the_error():
    rng = np.random.default_rng(5)
    for _ in range(12):
        terms = [
            (float(g), f"{t} s")
            for g, t in zip(rng.dirichlet([1, 1, 1])[:2], 10 ** rng.uniform(-6, -1, 2), strict=True)
        ]
        drawn = scene(
            f"{10 ** rng.uniform(-2, 0.5)} m/s", rubber(prony=terms), effects=fm.Effects(viscoelasticity=True)
        )
        exact = fm.simulate(drawn, accuracy=1e-9).summary
        for accuracy in (1e-3, 1e-6):
            found = fm.simulate(drawn, accuracy=accuracy)
            off = [
                abs(found.summary[name] / exact[name] - 1.0)
                for name in ("maximum_force", "contact_duration", "impulse")
            ]
            assert max(off) <= found.accuracy.estimated <= accuracy


# ---------------------------------------------------------------- steps, batches, exports


def test_steps_are_the_impact_and_may_be_divided_saved_and_restored():
    whole, component = fm.simulate(scene()), fm.ImpactComponent(scene(), initial_gap="1 mm")
    events = component.step("3.5 ms").events
    begun = events[0].time
    assert [event.name for event in events] == [event.name for event in whole.events]
    for stepped, event in zip(events, whole.events, strict=True):
        assert stepped.time - begun == pytest.approx(event.time, abs=1e-12)
        assert stepped.contact_force == pytest.approx(event.contact_force, abs=1e-9)
    last, saved = component.outputs, None
    component.reset()
    for k in range(700):
        component.step(5e-6)
        if k == OUT:
            assert component.phase == "unloading"
            saved = component.save()
    for value, once in zip(component.outputs, last, strict=True):
        assert value == once if isinstance(once, str) else value == pytest.approx(once, rel=1e-9)
    again = component.outputs
    assert saved is not None
    component.restore(saved)
    for _ in range(699 - OUT):
        component.step(5e-6)
    assert component.outputs == again


def test_contacts_that_cannot_be_solved_are_refused():
    component = fm.ImpactComponent(scene())
    component.step("0.5 ms")
    assert component.phase == "unloading"
    with pytest.raises(fm.SimulationError, match=r"the indentation grows again before contact ends.*; at 500 µs"):
        component.step("1 ms", external_force="1 kN")
    for wait, good in (("1 ms", False), ("60 ms", True)):
        component.reset()
        component.step("3 ms")
        assert component.phase == "separated"
        component.step(wait)
        stop = component.outputs.impactor_velocity
        component.step(0.0, support_velocity=stop - 1.0)
        if good:
            assert "contact_begins" in [
                event.name for event in component.step("3 s", support_velocity=stop - 1.0).events
            ]
        else:
            with pytest.raises(fm.SimulationError, match=r"has forgotten.*with [\d.]+ µm of the surface not yet"):
                component.step("3 s", support_velocity=stop - 1.0)


def test_a_batch_gives_what_single_impacts_give():
    many = fm.simulate_batch(scene(), velocity=["0.05 m/s", "0.3 m/s", "3 m/s"])
    for k, velocity in enumerate(("0.05 m/s", "0.3 m/s", "3 m/s")):
        one = fm.simulate(scene(velocity))
        for name in ("maximum_force", "contact_duration", "coefficient_of_restitution", "energy_absorbed"):
            assert many.summary[name][k] == pytest.approx(one.summary[name], rel=2e-4)
    assert 0.0 < many.estimated < 1e-4 and not many.failed.any()
    together = simulate_many(scene(), {"impactor.velocity": np.linspace(0.5, 2.0, 20)})
    assert len(together.problems) == 1 and together.problems[0].relaxation is not None


def test_a_sweep_of_a_modulus_gives_each_impact_its_own_relaxation():
    moduli = np.array([20e6, 50e6])
    found = simulate_many(scene(), {"impactor.material.youngs_modulus": moduli})
    for k, modulus in enumerate(moduli):
        one = fm.simulate(scene(material=rubber(youngs_modulus=f"{modulus} Pa")))
        assert found.summary["contact_duration"][k] == pytest.approx(one.summary["contact_duration"], rel=1e-5)
    assert (found.status == native.EVENT).all()


def test_derivatives_keep_the_units():
    """Moduli and density 1 % higher: forces and pressures are 1 % higher, and all motion is the same."""
    paths = ["impactor.material.youngs_modulus", "target.material.youngs_modulus", "impactor.material.density"]
    history = fm.simulate(scene(), accuracy=1e-9, derivatives=paths)
    found = history.derivatives
    assert found.warnings == ()
    for name, value in history.summary.items():
        if not value:
            continue
        powers = [(found.values[name][path] or 0.0) * found.entries[path].value / value for path in paths]
        stiffer = SUMMARY[name][0] in ("force", "pressure", "energy", "impulse")
        assert sum(powers) == pytest.approx(1.0 if stiffer else 0.0, abs=1e-8), name
        assert max(found.errors[name][path] or 0.0 for path in paths) < 1e-8, name


# ---------------------------------------------------------------- decisions


def test_it_is_simulated_where_it_matters_and_judged_otherwise():
    def effect_of(of):
        return {effect.name: effect for effect in choose(of).effects}["viscoelasticity"]

    plain = rubber(prony=None)
    assert effect_of(scene(material=plain)).state == NOT_NEEDED
    off = scene(material=plain, effects=fm.Effects(viscoelasticity=False))
    assert fm.simulate(scene(material=plain)).summary == fm.simulate(off).summary
    matters = effect_of(scene())
    assert matters.state == SIMULATED and matters.change is not None and matters.change > 0.1
    assert effect_of(scene(material=rubber(prony=[[0.4, "1000 s"]]))).state == NOT_NEEDED
    off = effect_of(scene(effects=fm.Effects(viscoelasticity=False)))
    assert off.state == NOT_MODELLED and off.change == pytest.approx(matters.change, rel=1e-6)
    assert off.warning is not None and "viscoelasticity = false" in off.warning
    yields = rubber(yield_strength="50 kPa")
    other = effect_of(scene(material=yields, contact=fm.Contact("stronge")))
    assert other.state == NOT_MODELLED and "only law hertz" in other.reason
    with pytest.raises(fm.SimulationError, match="only law hertz relaxes, not stronge"):
        choose(scene(material=yields, contact=fm.Contact("stronge"), effects=fm.Effects(viscoelasticity=True)))


def test_the_same_loss_does_not_count_twice():
    def damping(of):
        return {effect.name: effect for effect in choose(scene(material=of)).effects}["material_damping"]

    assert damping(rubber(loss_factor=0.2, prony=None)).state == SIMULATED
    assert damping(rubber(loss_factor=0.2)).state == NOT_NEEDED


@pytest.mark.parametrize(
    ("prony", "said"),
    [
        ([], "a list of 1 to 12 pairs"),
        ([[0.3]], "a list of 1 to 12 pairs"),
        ([[0.3, "1 ms"], [1.2, "1 s"]], "pair 2: 1.2 is out of range"),
        ([[0.3, "1 mm"]], "pair 1: .*time"),
        ([[0.6, "1 ms"], [0.4, "1 s"]], "add up to 1, which must be < 0.9999"),
    ],
)
def test_a_wrong_series_is_named(prony, said):
    with pytest.raises(fm.SceneError, match=f"Material.prony: .*{said}"):
        rubber(prony=prony)


def test_a_scene_file_keeps_the_series():
    given = scene()
    assert fm.Scene.from_text(given.to_toml()) == given
    relaxation = relaxation_of(given)
    assert relaxation is not None and replace(relaxation) == relaxation_of(fm.Scene.from_text(given.to_toml()))
