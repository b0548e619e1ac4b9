"""The estimated error of friction by springs, alone and in batches of any accuracy, against more springs in more steps
beside finer normal motions."""

import numpy as np
import pytest
from cases import knots_of

import film_model as fm
from film_model.core import springs as core
from film_model.oblique.friction import contact_radii, radius_beyond_yield
from film_model.oblique.result import BOUNDS
from film_model.scene import Solver
from film_model.scene.rolling import sliding_of
from film_model.solve.batch import simulate_many
from film_model.solve.simulate import simulate_quietly

LAWS = {
    "elastoplastic": {},
    "thornton": {"yield_pressure": "1.6 GPa"},
    "walton-braun": {"loading_stiffness": "40 MN/m", "unloading_stiffness": "80 MN/m"},
    "linear-dashpot": {"stiffness": "40 MN/m", "restitution": 0.7},
    "tsuji": {"restitution": 0.8},
    "hunt-crossley": {"restitution": 0.8},
    "hertz": {},
}
SPRINGS, STEPS = 768, 6144
NAME = "contact_point_rebound_velocity"


def random_impact(seed):
    rng = np.random.default_rng(seed)
    law = list(LAWS)[seed % len(LAWS)]
    friction = float(10.0 ** rng.uniform(-2.0, 0.0))
    angle = float(np.arctan(1.2 * friction * 10.0 ** rng.uniform(-1.5, 1.0)))
    spin = f"{300.0 * float(rng.normal())!r} rad/s" if rng.random() < 0.3 else None
    speed = float(10.0 ** rng.uniform(-1.0, 1.0))
    ball = fm.Sphere("5 mm", f"{speed!r} m/s", material="bearing steel", angle=f"{angle!r} rad", spin=spin)
    table = [["0 m/s", friction], [f"{speed!r} m/s", friction * rng.uniform(0.3, 1.0)]]
    contact = fm.Contact(law, yield_strength="0.6 GPa", friction=table if law == "hertz" else friction, **LAWS[law])
    target = fm.Body("mild steel", radius="8 mm") if rng.random() < 0.4 else fm.HalfSpace("mild steel")
    return fm.Scene(ball, target, contact, fm.Effects(gravity=False))


def finer(history):
    """The sliding velocity after, m/s: the springs of film_springs.c in NumPy, three times as many."""
    given, times = sliding_of(history.scene), np.linspace(0.0, history.duration, STEPS + 1)
    seen = history.sample_si(times)
    force, depth = np.maximum(seen.contact_force, 0.0), np.asarray(seen.indentation)
    radius, *_ = contact_radii(history.problem, depth, force)
    shape, width, step = core.power(history.problem.curve.native), radius.max() / SPRINGS, times[1]
    at = (np.arange(SPRINGS) + 0.5) ** shape if shape else np.zeros(SPRINGS)
    tops = np.where(radius > 0.0, (radius / width) ** shape, 0.0)
    touching = np.clip(np.ceil(radius / width - 0.5), 0, SPRINGS).astype(int)
    sums, stiffness, u = np.concatenate([[0.0], np.cumsum(at)]), 8.0 * given.modulus * width, np.zeros(SPRINGS)
    v, q = given.velocity, 0.0
    for i in range(1, STEPS + 1):
        friction = given.friction if given.table is None else given.table.at(abs(v - step * q / given.mass))
        v -= 0.5 * step * q / given.mass
        touch, old, grown = touching[i], min(touching[i - 1], touching[i]), max(tops[i] - tops[i - 1], 1e-300)
        u[old:touch] -= v * step * np.maximum(1.0 - (tops[i] - at[old:touch]) / grown, 0.0)
        shares = touch * tops[i] - sums[touch]
        most = (tops[i] - at[:touch]) * (friction * force[i] / (stiffness * shares) if shares > 0.0 else 0.0)
        u[:touch], u[touch:] = np.clip(u[:touch] + v * step, -most, most), 0.0
        q = stiffness * u[:touch].sum()
        v -= 0.5 * step * q / given.mass
    return v


BATCHES = {
    "elastoplastic": {},
    "thornton": {"yield_pressure": "1.6 GPa"},
    "kogut-etsion": {},
    "jackson-green": {},
    "stronge": {},
    "big-alabo": {},
    "walton-braun": LAWS["walton-braun"],
    "tsuji": LAWS["tsuji"],
    "hunt-crossley": LAWS["hunt-crossley"],
    "linear-dashpot": LAWS["linear-dashpot"],
}


def few_and_most(law):
    """1,000 impacts by few springs, by as many as there are beside a motion of 8 times as many samples, and the sliding
    velocities before."""
    rng, count = np.random.default_rng(3), 1000
    ball = fm.Sphere("5 mm", "1 m/s", material="bearing steel", angle="30 deg")
    contact = fm.Contact(law, yield_strength="0.6 GPa", friction=0.3, **BATCHES[law])
    scene = fm.Scene(ball, fm.HalfSpace("mild steel"), contact, fm.Effects(gravity=False, rate_hardening=False))
    columns = {
        "impactor.velocity": 10.0 ** rng.uniform(-1.0, 1.0, count),
        "impactor.angle": np.radians(rng.uniform(2.0, 80.0, count)),
        "contact.friction": rng.uniform(0.05, 0.8, count),
    }
    few, most = (simulate_many(scene, columns, Solver(accuracy)).oblique for accuracy in (1e-4, 1e-8))
    return few, most, columns["impactor.velocity"] * np.sin(columns["impactor.angle"])


@pytest.mark.slow
@pytest.mark.parametrize("law", BATCHES)
def test_the_estimates_of_a_batch_bound_their_errors(law):
    few, most, before = few_and_most(law)
    off = np.abs(few.summary[NAME] - most.summary[NAME]) / before
    assert np.mean(off <= few.estimated + most.estimated) >= 0.99 and off.max() < 4e-3
    assert np.mean(few.regime == most.regime) >= 0.97


@pytest.mark.slow
@pytest.mark.parametrize("law", ["stronge", "jackson-green"])
def test_few_springs_follow_contacts_whose_force_or_radius_has_a_kink_where_they_yield(law):
    few, most, before = few_and_most(law)
    off = np.abs(few.summary[NAME] - most.summary[NAME]) / before
    assert np.mean(off <= few.estimated + most.estimated) >= 0.995 and off.max() < 5e-4
    (low, high), (least, largest) = ([found.summary[name] for name in BOUNDS] for found in (few, most))
    assert np.mean((low <= least) & (largest <= high)) >= 0.99


def test_a_kink_is_a_knot_of_motions_and_cubics_end_there():
    """Forces t, and beyond a kink 1 + 3 (t - 1)², over contacts whose turn is at 1.01 to 30."""
    turn = np.geomspace(1.01, 30.0, 50)
    legs, knots = np.stack([turn, 2.0 * turn, np.ones(50)], axis=1), 32
    times = knots_of(knots, legs)
    assert (np.diff(times[:, : knots + 1]) > 0.0).all() and (times == 1.0).any(axis=1).all()
    force = np.where(times < 1.0, times, 1.0 + 3.0 * (times - 1.0) ** 2)
    force[:, knots + 1 :] = 0.0
    assert core.impulses(force, legs) == pytest.approx(0.5 + (turn - 1.0) + (turn - 1.0) ** 3, rel=1e-4)
    smooth, across = core.roughness(force, legs), core.roughness(force, legs * [1.0, 1.0, 0.0])
    assert (smooth < 2e-4).all() and (across >= smooth).all() and across.max() > 5e-3


def test_the_radius_has_no_jump_where_a_law_departs_from_hertz_s_force():
    """Jackson and Green's is Hertz's up to 1.9 critical indentations, and their force little beside Hertz's beyond."""
    contact = fm.Contact("jackson-green", yield_strength="0.6 GPa", friction=0.3)
    ball = fm.Sphere("5 mm", "0.3 m/s", material="bearing steel", angle="30 deg")
    history = simulate_quietly(fm.Scene(ball, fm.HalfSpace("mild steel"), contact, fm.Effects(gravity=False)))
    times = np.linspace(0.0, history.summary["time_of_maximum_indentation"], 4001)[1:]
    seen = history.sample_si(times)
    depth = np.asarray(seen.indentation)
    square = radius_beyond_yield(history.problem, depth, np.asarray(seen.contact_force)) ** 2
    assert np.diff(square).max() < 1.5 * history.scene.effective_radius * np.diff(depth).max()


def test_a_force_that_meets_hertz_s_by_chance_does_not_narrow_a_contact_that_yields():
    """Walton and Braun's line crosses Hertz's force once, far beyond yield: without a jump of the radius there."""
    contact = fm.Contact("walton-braun", yield_strength="0.6 GPa", friction=0.3, **LAWS["walton-braun"])
    ball = fm.Sphere("5 mm", "3 m/s", material="bearing steel", angle="30 deg")
    history = simulate_quietly(fm.Scene(ball, fm.HalfSpace("mild steel"), contact, fm.Effects(gravity=False)))
    times = np.linspace(0.0, history.summary["time_of_maximum_indentation"], 4001)[1:]
    seen = history.sample_si(times)
    radius = radius_beyond_yield(history.problem, np.asarray(seen.indentation), np.asarray(seen.contact_force))
    assert (np.diff(radius) > 0.0).all()


@pytest.mark.slow
@pytest.mark.parametrize("part", range(2))
def test_the_estimate_bounds_the_error(part):
    """In at least 99 of 100 impacts of laws that yield, are damped or have a table of friction."""
    bounded, worst = [], 0.0
    for seed in range(100 * part, 100 * part + 100):
        scene, accuracy = random_impact(seed), 10.0 ** -(3 + seed // len(LAWS) % 6)
        one = simulate_quietly(scene, accuracy=accuracy).oblique
        if one is None:
            continue
        speed = {"impactor.velocity": np.array([scene.impactor.path_speed])}
        many = simulate_many(scene, speed, Solver(accuracy)).oblique
        true, before = finer(simulate_quietly(scene, accuracy=1e-8)), abs(one.motion["sliding_velocity"][0])
        for value, estimated in ((one.summary[NAME], one.estimated), (many.summary[NAME][0], many.estimated[0])):
            off = abs(value - true) / before
            bounded.append(off <= estimated)
            worst = max(worst, off)
    assert len(bounded) > 190 and sum(bounded) >= 0.99 * len(bounded) and worst < 5e-3
